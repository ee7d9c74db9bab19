"""Everything that the page draws of one setting while it is turned: grid figures, quickly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numba

from mptune.explore.curves import LoopView, StepView, loop_view, step_view
from mptune.explore.lamps import grid_checks
from mptune.explore.links import corner_chain
from mptune.explore.looking import Looked, corner_model, looked_at
from mptune.explore.sides import GridSides, grid_sides
from mptune.robust.model import LinearModel

if TYPE_CHECKING:
    from mptune.explore.setting import HandSetting
    from mptune.params.study import ResolvedStudy
    from mptune.robust.chain import Link
    from mptune.robust.result import Check


@dataclass(frozen=True)
class Picture:
    """One setting's grid figures.

    Attributes
    ----------
    study
        The study that the setting makes.
    sides
        Both inequalities over the whole family.
    looked
        The plants that are looked at.
    checks
        The requirements, as the grid has them.
    loops, steps
        Their loops and steps; None where they were not asked for.
    """

    study: ResolvedStudy
    sides: GridSides
    looked: Looked
    checks: tuple[Check, ...]
    loops: LoopView | None
    steps: StepView | None

    @property
    def corners(self) -> LinearModel:
        """The model whose family is the corners of the box."""
        return corner_model(self.sides.model)

    def chain(self) -> tuple[Link, ...]:
        """Return the chain of gain factors on the corners of the box."""
        return corner_chain(self.corners, self.sides.omega)


def picture(
    study: ResolvedStudy, setting: HandSetting, *, loops: bool = True, steps: bool = True
) -> Picture:
    """Return what is drawn of a setting.

    Parameters
    ----------
    study
        The study as it is written.
    setting
        What is turned, and what is looked at.
    loops, steps
        Whether loops and steps are drawn.

    Raises
    ------
    InputError
        If the setting is no study.
    """
    numba.set_num_threads(1)  # threads cost more than they bring where few plants are asked
    made = setting.put_over(study)
    model = LinearModel.of(made)
    sides = grid_sides(model)
    looked = looked_at(sides, setting.plant, with_path=setting.path == "with")
    return Picture(
        study=made,
        sides=sides,
        looked=looked,
        checks=grid_checks(sides, corner_model(model)),
        loops=loop_view(model.gains, looked, setting.loop) if loops else None,
        steps=step_view(model.gains, looked) if steps else None,
    )
