"""The sweep: both sides of Eq. 17 and Eq. 21 over the family, and the true family's margins."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, frozen
from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.family import FamilyLoops, nominal_plants, plants_of
from mptune.loops.noise import noise_gain
from mptune.loops.sampled import stable_as_sampled
from mptune.loops.stability import PoleCount, count_unstable_poles
from mptune.params.pack import (
    NO_PATH,
    LoopGains,
    MeasurementPath,
    NominalPlant,
    Plants,
    pack_filters,
    pack_gains,
    pack_nominal,
    pack_path,
)
from mptune.robust.condition import Sides, sides
from mptune.robust.grid import first_grid, frequency_range, refinement
from mptune.robust.margins import Margins, family_margins, sampled_margins
from mptune.robust.measured import Members, members_of, whole_family
from mptune.robust.place import plant_point
from mptune.robust.result import Condition, Family, Status, SweepResult
from mptune.robust.verdict import allowed_ratio, check_requirements

if TYPE_CHECKING:
    from mptune.params.controller import Gains
    from mptune.params.requirements import RatioCurve
    from mptune.params.study import ResolvedStudy

CONVERGED = 1e-4  # relative change of the worst ratio between refinements
_NARROW = 1e-3  # of the frequency: a maximum is bracketed at least so closely
_ROUNDS = 40


def sweep(study: ResolvedStudy, gains: Gains | None = None) -> SweepResult:
    """Sweep mass × delay × τ_A × τ_B × frequency for one set of gains.

    Parameters
    ----------
    study
        The study.
    gains
        The gains; the study's own where None.

    Returns
    -------
    SweepResult
        Both conditions, the true family's margins without and with the measurement path, and the
        study's requirements checked.
    """
    gains = gains or study.study.gains
    plants, nominal = plants_of(study), pack_nominal(study)
    packed, path = pack_gains(gains), pack_path(study)
    share_a = study.study.cylinder.share_a
    members = members_of(study, plants)
    limits = (study.study.requirements.velocity_ratio, study.study.requirements.position_ratio)

    omega, found, converged = _refined_sides(
        plants, nominal, share_a, packed, path, limits, members
    )
    paths = {"none": NO_PATH, "filters": pack_filters(study.study.controller)}
    families = tuple(
        _family(name, omega, plants, share_a, packed, one, members) for name, one in paths.items()
    )
    true = next(family for family in families if paths[family.path] == path)
    period = study.study.controller.sampling_period
    sampled = _sampled_family(omega, plants, share_a, packed, paths["filters"], period)
    noise = noise_gain(packed, paths["filters"])
    whole, names = whole_family(plants, members), members.names if members else ()
    premises = _premises(nominal, packed, path, true)
    conditions = _conditions(omega, found, whole, names, limits, converged, premises)
    return SweepResult(
        study=study,
        gains=gains,
        omega=frozen(omega),
        plants=plants,
        velocity=conditions[0],
        position=conditions[1],
        families=families,
        sampled=sampled,
        noise_gain=noise,
        checks=check_requirements(study.study.requirements, conditions, true, sampled, noise),
        members=members,
    )


def _refined_sides(
    plants: Plants,
    nominal: NominalPlant,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
    limits: tuple[float | RatioCurve, ...],
    members: Members | None,
) -> tuple[FloatArray, Sides, tuple[bool, bool]]:
    """Evaluate both conditions on a grid that is refined until the worst ratios stand still."""
    low, high = frequency_range(plants, nominal, gains)
    omega = first_grid(low, high)
    if members is not None:
        omega = np.union1d(omega, members.omega)  # where interpolated curves have their corners
    found = sides(omega, plants, nominal, share_a, gains, path, members)
    quiet = np.zeros(4, np.int64)  # rounds in a row in which a maximum stood still
    for _ in range(_ROUNDS):
        curves = _curves(found, omega, limits)
        new = [refinement(omega, curve) for curve in curves]
        if any(int(np.argmax(curve)) == 0 for curve in curves):
            new.append(omega[0] / np.array([10.0, 3.0]))  # the worst may lie lower still
        before = curves.max(axis=1)
        added = np.unique(np.concatenate(new))
        omega = np.concatenate([omega, added])
        order = np.argsort(omega)
        omega = omega[order]
        finer = sides(added, plants, nominal, share_a, gains, path, members)
        found = _merged(found, finer, order)
        curves = _curves(found, omega, limits)
        after = curves.max(axis=1)
        narrow = np.array([_bracket(omega, curve) <= _NARROW for curve in curves])
        still = narrow & (np.abs(after - before) <= CONVERGED / 10 * after)
        quiet = np.where(still, quiet + 1, 0)
        if np.all(quiet >= 2):
            break
    settled = quiet >= 2
    return omega, found, (bool(settled[0] and settled[2]), bool(settled[1] and settled[3]))


def _curves(found: Sides, omega: FloatArray, limits: tuple[float | RatioCurve, ...]) -> FloatArray:
    """Return both ratios, and both over what is allowed, ``(4, F)``."""
    allowed = np.stack([allowed_ratio(limit, omega) for limit in limits])
    return np.concatenate([found.ratio, found.ratio / allowed])


def _bracket(omega: FloatArray, curve: FloatArray) -> float:
    """Return the width, relative to frequency, in which the maximum is known to lie."""
    worst = int(np.argmax(curve))
    if worst == 0:
        return 0.0  # the limit of vanishing frequency has no lower end
    return float((omega[min(worst + 1, len(omega) - 1)] - omega[worst - 1]) / omega[worst])


def _merged(old: Sides, new: Sides, order: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Sides:
    """Return two evaluations of one family as one, frequencies in the given order."""
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    count = old.left.shape[1]
    better = new.plant_ratio > old.plant_ratio
    frequency = np.where(better, new.plant_frequency + count, old.plant_frequency)
    return Sides(
        left=np.concatenate([old.left, new.left], axis=1)[:, order],
        plant=np.concatenate([old.plant, new.plant], axis=1)[:, order],
        right=np.concatenate([old.right, new.right], axis=1)[:, order],
        plant_ratio=np.maximum(old.plant_ratio, new.plant_ratio),
        plant_frequency=place[frequency],
    )


def _family(
    name: str,
    omega: FloatArray,
    plants: Plants,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
    members: Members | None,
) -> Family:
    """Return stability and margins of the true family with one measurement path.

    Where measured members stand instead of the box, the box's plants are not asked: what lies
    beyond the measured band then rests on the loop being small at its end.
    """
    parts = []
    if members is None or not members.instead:
        counts = [
            count_unstable_poles(FamilyLoops(which, plants, share_a, gains, path))
            for which in (VELOCITY, FORCE)
        ]
        margins = family_margins(omega, plants, share_a, gains, path)
        parts.append(_part(name, plants, counts, margins))
    if members is not None:
        from mptune.robust.measured_loops import count_members, member_margins

        counts = [count_members(which, members, gains, path) for which in (VELOCITY, FORCE)]
        margins = member_margins(members, gains, path)
        parts.append(_part(name, members.plants(), counts, margins, members.names))
    return parts[0] if len(parts) == 1 else parts[0].joined(parts[1])


def _part(
    name: str,
    plants: Plants,
    counts: list[PoleCount],
    margins: Margins,
    responses: tuple[str, ...] = (),
) -> Family:
    velocity, whole = counts
    unstable = np.stack([~velocity.stable, ~whole.stable, ~whole.stable])
    masked = Margins(*(frozen(np.where(unstable, np.nan, figure)) for figure in margins))
    return Family(
        path=name,
        plants=plants,
        velocity_stable=frozen(velocity.stable),
        stable=frozen(whole.stable),
        decided=frozen(velocity.decided & whole.decided),
        margins=masked,
        responses=responses,
    )


def _sampled_family(
    omega: FloatArray,
    plants: Plants,
    share_a: float,
    gains: LoopGains,
    path: MeasurementPath,
    period: float,
) -> Family | None:
    """Return stability and margins of the true family as it runs.

    None where some plant's total delay is below half a sampling period: no hold fits into it.
    """
    if plants.delay.min() < period / 2:
        return None
    stable, decided = stable_as_sampled(plants, share_a, gains, path, period)
    margins = sampled_margins(omega, plants, share_a, gains, path, period)
    masked = Margins(*(frozen(np.where(stable, figure, np.nan)) for figure in margins))
    return Family(
        path="sampled",
        plants=plants,
        velocity_stable=frozen(stable),
        stable=frozen(stable),
        decided=frozen(decided),
        margins=masked,
    )


class _Premise(NamedTuple):
    """What a condition rests on: the nominal loop's poles, and the same number in all open loops.

    ``known`` is False where no open loop has been found to differ, but some are undecided.
    """

    nominal: PoleCount
    equal: bool
    known: bool


def _premises(
    nominal: NominalPlant, gains: LoopGains, path: MeasurementPath, true: Family
) -> tuple[_Premise, _Premise]:
    """Return the premises of each condition.

    The velocity plants of Eq. 14 and 15 have no open-loop pole right of the origin at all, and a
    response can only be measured where that is so. Those of the position loop, Eq. 19, are the
    closed-loop poles of the velocity loops.
    """
    one = nominal_plants(nominal)
    velocity = count_unstable_poles(FamilyLoops(VELOCITY, one, 0.5, gains, path))
    position = count_unstable_poles(FamilyLoops(FORCE, one, 0.5, gains, path))
    equal = bool(velocity.stable[0] and true.velocity_stable.all())
    known = equal or bool(np.any(~true.velocity_stable & true.decided))
    return (
        _Premise(velocity, equal=True, known=True),
        _Premise(position, equal=equal, known=known),
    )


def _conditions(
    omega: FloatArray,
    found: Sides,
    plants: Plants,
    responses: tuple[str, ...],
    limits: tuple[float | RatioCurve, ...],
    converged: tuple[bool, bool],
    premises: tuple[_Premise, _Premise],
) -> tuple[Condition, Condition]:
    conditions = []
    for loop, name in enumerate(("velocity", "position")):
        allowed = allowed_ratio(limits[loop], omega)
        ratio = found.ratio[loop]
        worst, use = int(np.argmax(ratio)), int(np.argmax(ratio / allowed))
        premise = premises[loop]
        worst_use = float(ratio[use] / allowed[use])
        conditions.append(
            Condition(
                name=name,
                left=frozen(found.left[loop]),
                right=frozen(found.right[loop]),
                plant=frozen(found.plant[loop]),
                plant_ratio=frozen(found.plant_ratio[loop]),
                allowed=frozen(allowed),
                worst_ratio=float(ratio[worst]),
                at=plant_point(plants, found.plant[loop, worst], omega[worst], responses),
                worst_use=worst_use,
                worst_use_at=plant_point(plants, found.plant[loop, use], omega[use], responses),
                low_frequency_limit=worst == 0,
                nominal_stable=bool(premise.nominal.stable[0]),
                poles_equal=premise.equal,
                status=_status(premise, worst_use, converged=converged[loop]),
            )
        )
    return conditions[0], conditions[1]


def _status(premise: _Premise, worst_use: float, *, converged: bool) -> Status:
    nominal = premise.nominal
    if not nominal.decided[0] or (nominal.stable[0] and not premise.known):
        return Status.UNDECIDED
    if not nominal.stable[0] or not premise.equal:
        return Status.UNSTABLE
    if worst_use > 1:
        return Status.VIOLATED
    return Status.SATISFIED if converged else Status.NOT_CONVERGED
