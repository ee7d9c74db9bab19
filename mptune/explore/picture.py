"""Everything that the page draws of one setting while it is turned: grid figures, quickly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
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
    """One setting's grid figures; what a view does not ask for is not made.

    Attributes
    ----------
    study
        The study that the setting makes.
    sides
        Both inequalities over the whole family.
    setting
        What is turned, and what is looked at.
    """

    study: ResolvedStudy
    sides: GridSides
    setting: HandSetting

    @cached_property
    def corners(self) -> LinearModel:
        """The model whose family is the corners of the box."""
        return corner_model(self.sides.model)

    @cached_property
    def checks(self) -> tuple[Check, ...]:
        """The requirements, as the grid has them."""
        return grid_checks(self.sides, self.corners)

    @cached_property
    def looked(self) -> Looked:
        """The plants that are looked at."""
        setting = self.setting
        with_path = setting.path == "with"
        return looked_at(self.sides, self.corners, setting.plant, with_path=with_path)

    @cached_property
    def loops(self) -> LoopView:
        """The chosen loop of the plants that are looked at."""
        return loop_view(self.sides.model.gains, self.looked, self.setting.loop)

    @cached_property
    def steps(self) -> StepView:
        """Their steps."""
        return step_view(self.sides.model.gains, self.looked)

    def chain(self) -> tuple[Link, ...]:
        """Return the chain of gain factors on the corners of the box."""
        return corner_chain(self.corners, self.sides.omega)


def picture(study: ResolvedStudy, setting: HandSetting) -> Picture:
    """Return what is drawn of a setting.

    Parameters
    ----------
    study
        The study as it is written.
    setting
        What is turned, and what is looked at.

    Raises
    ------
    InputError
        If the setting is no study.
    """
    numba.set_num_threads(1)  # threads cost more than they bring where few plants are asked
    made = setting.put_over(study)
    return Picture(made, grid_sides(LinearModel.of(made)), setting)
