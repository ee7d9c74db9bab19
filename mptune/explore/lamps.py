"""The study's requirements as lamps: on a grid while a slider moves, certified when it rests.

The grid's figures are optimistic: both inequalities are asked of the whole family, stability and
margins of the corners of the box alone, where the worst usually stands, and nothing is proved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.result import Grounds
from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.sampled import stable_as_sampled
from mptune.loops.stability import count_unstable_poles
from mptune.robust.demands import running_checks
from mptune.robust.families import as_sampled, true_family
from mptune.robust.family import Family
from mptune.robust.margins import Margins
from mptune.robust.place import PlantPoint, plant_point
from mptune.robust.result import Check, Condition, Status
from mptune.robust.sweep import noises_of
from mptune.robust.verdict import allowed_ratio, check_requirements

if TYPE_CHECKING:
    from mptune.arrays import BoolArray
    from mptune.explore.sides import GridSides
    from mptune.params.packed import Plants
    from mptune.robust.model import LinearModel

_OF_TRUE = ("sensitivity_peak", "complementary_peak")
_OF_SAMPLED = ("sampled_sensitivity_peak", "gain_margin")


def grid_checks(sides: GridSides, corners: LinearModel) -> tuple[Check, ...]:
    """Return every requirement of the study that a grid can judge, and stability as it runs.

    Parameters
    ----------
    sides
        Both inequalities over the whole family.
    corners
        The model whose family is the corners of the box.
    """
    model, asked = sides.model, sides.model.requirements
    gains, ahead = model.gains, model.study.study.feedforward
    conditions = condition_on_grid(sides, 0), condition_on_grid(sides, 1)
    if any(getattr(asked, key) is not None for key in _OF_TRUE):
        true = true_family(corners, gains, corners.judged_path, sides.omega)
    else:
        true = _stability_only(corners)
    sampled = None
    if any(getattr(asked, key) is not None for key in _OF_SAMPLED):
        sampled = as_sampled(corners, gains, sides.omega)
    noises = noises_of(model, gains)
    checks = check_requirements(model, conditions, true, sampled, noises, None)
    checks += running_checks(corners, gains, ahead, None)
    return (*checks, *_as_it_runs(corners))


def condition_on_grid(sides: GridSides, loop: int) -> Condition:
    """Return Eq. 17 (0) or Eq. 21 (1) as the grid has it."""
    model, found, omega = sides.model, sides.found, sides.omega
    allowed = allowed_ratio(model.limits[loop], omega)
    use = found.ratio[loop] / allowed
    place = int(np.argmax(use))
    ratio, at = sides.worst(loop)
    nominal = count_unstable_poles(
        model.nominal_loop(model.gains, which=VELOCITY if loop == 0 else FORCE)
    )
    status = Status.VIOLATED if use[place] > 1 else Status.SATISFIED
    if not nominal.stable[0]:
        status = Status.UNSTABLE if nominal.decided[0] else Status.UNDECIDED
    return Condition(
        name=("velocity", "position")[loop],
        left=found.left[loop],
        right=found.right[loop],
        plant=found.plant[loop],
        plant_ratio=found.plant_ratio[loop],
        allowed=allowed,
        worst_ratio=ratio,
        at=at,
        worst_use=float(use[place]),
        worst_use_at=model.point(int(found.plant[loop, place]), float(omega[place])),
        low_frequency_limit=bool(at.frequency_rad_s <= omega[0]),
        nominal_stable=bool(nominal.stable[0]),
        poles_equal=True,
        status=status,
        binding=not model.estimated,
    )


def _stability_only(corners: LinearModel) -> Family:
    """Return the corners' stability with the judged path, without any margins."""
    path = corners.judged_path
    loops = corners.loops(corners.gains, corners.path_of(path))
    count = count_unstable_poles(loops)
    nothing = np.full((3, loops.plants.number), np.nan)
    margins = Margins(*(nothing for _ in Margins._fields))
    return Family(path, loops.plants, count.stable, count.stable, count.decided, margins)


def _as_it_runs(corners: LinearModel) -> tuple[Check, ...]:
    """Return whether the corners are stable with the measurement path, and sampled."""
    loops = corners.as_it_runs(corners.gains)
    count = count_unstable_poles(loops)
    named = "state estimator" if corners.estimated else "measurement path"
    checks = [_stable(f"unstable corners with {named}", count.stable, count.decided, loops.plants)]
    if corners.runs:
        stable, decided = stable_as_sampled(loops, corners.period)
        checks.append(_stable("unstable corners as it runs", stable, decided, loops.plants))
    return tuple(checks)


def _stable(label: str, stable: BoolArray, decided: BoolArray, plants: Plants) -> Check:
    failing, at = np.flatnonzero(~stable), None
    status = Status.SATISFIED
    if len(failing):
        at = _place(plants, int(failing[0]))
        status = Status.UNSTABLE if decided[failing].any() else Status.UNDECIDED
    key = label.replace(" ", "_")
    return Check(key, label, "= 0", float(len(failing)), status, at, Grounds.GRID)


def _place(plants: Plants, row: int) -> PlantPoint:
    return plant_point(plants, row, float("nan"))
