"""The sweep: both sides of Eq. 17 and Eq. 21 over the family, and the true family's margins."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, frozen
from mptune.certify.result import Grounds, Stability
from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.noise import noise_force, noise_gain
from mptune.loops.stability import PoleCount, count_unstable_poles
from mptune.params.pack import force_noise
from mptune.robust.certificates import (
    EQUATION_OF,
    Certificates,
    against,
    certify,
    place_of,
    radii_of,
    use_of_curve,
)
from mptune.robust.condition import Sides
from mptune.robust.demands import running_checks
from mptune.robust.families import as_sampled, true_family
from mptune.robust.grid import first_grid, frequency_range, refinement
from mptune.robust.model import LinearModel
from mptune.robust.result import Condition, Status, SweepResult
from mptune.robust.verdict import allowed_ratio, check_requirements

if TYPE_CHECKING:
    from mptune.certify.result import Bound
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.packed import LoopGains
    from mptune.params.requirements import RatioCurve
    from mptune.params.study import ResolvedStudy
    from mptune.robust.family import Family
    from mptune.robust.place import PlantPoint

CONVERGED = 1e-4  # relative change of the worst ratio between refinements
_NARROW = 1e-3  # of the frequency: a maximum is bracketed at least so closely
_ROUNDS = 40
_NOTHING = 1e-12  # a ratio that rounding alone can have


def sweep(
    study: ResolvedStudy | LinearModel,
    gains: Gains | None = None,
    feedforward: Feedforward | None = None,
) -> SweepResult:
    """Sweep mass × delay × τ_A × τ_B × frequency for one set of gains.

    Parameters
    ----------
    study
        The study, or its linear model where that is at hand.
    gains, feedforward
        What is judged; the study's own where None. Feed-forward counts for tracking alone.

    Returns
    -------
    SweepResult
        Both conditions, the true family's margins without and with the measurement path, and the
        study's requirements checked.
    """
    model = study if isinstance(study, LinearModel) else LinearModel.of(study)
    gains = gains or model.study.study.gains
    packed = model.loops(gains).gains
    omega, found, converged = refined_sides(model, packed)
    families = tuple(true_family(model, packed, path, omega) for path in model.paths)
    by_path = {family.path: family for family in families}
    true, of_equations = by_path[model.judged_path], by_path[model.path_name]
    sampled = as_sampled(model, packed, omega)
    noises = noises_of(model, packed)
    proofs = certify(model, packed)
    premises = _premises(model, packed, of_equations, proofs)
    conditions = _conditions(model, omega, found, converged, premises, proofs)
    ahead = feedforward or model.study.study.feedforward
    checks = check_requirements(model, conditions, true, sampled, noises, proofs)
    return SweepResult(
        model=model,
        gains=gains,
        omega=frozen(omega),
        velocity=conditions[0],
        position=conditions[1],
        families=families,
        sampled=sampled,
        **noises,
        checks=checks + running_checks(model, packed, ahead, proofs),
        certificates=proofs,
    )


def noises_of(model: LinearModel, gains: LoopGains) -> dict[str, float]:
    """Return what noise makes of F_ref: ``"noise_gain"`` [N/m] and ``"noise_force"`` [N] rms."""
    of_place = model.study.study.controller.position_noise
    return {
        "noise_gain": noise_gain(gains, model.filters),
        "noise_force": noise_force(gains, model.filters, of_place, force_noise(model.study)),
    }


def with_radii(swept: SweepResult) -> SweepResult:
    """Return a sweep with the factors by which its box may grow, where anything is certified."""
    proofs = swept.certificates
    if proofs is None:
        return swept
    radii = radii_of(proofs, swept.model.path_name)
    return replace(swept, certificates=replace(proofs, radii=radii))


def refined_sides(
    model: LinearModel, gains: LoopGains
) -> tuple[FloatArray, Sides, tuple[bool, bool]]:
    """Evaluate both conditions on a grid that is refined until the worst ratios stand still.

    Parameters
    ----------
    model, gains
        What is swept.

    Returns
    -------
    omega
        ``(F,)`` frequencies [rad/s], rising.
    found
        Both sides at each of them.
    converged
        Whether the worst ratio of Eq. 17 and of Eq. 21 stood still within the budget of rounds.
    """
    low, high = frequency_range(model.plants, model.nominal, gains)
    omega = first_grid(low, high)
    if model.members is not None:
        omega = np.union1d(omega, model.members.omega)  # where interpolated curves have corners
    found = model.sides(omega, gains)
    quiet = np.zeros(4, np.int64)  # rounds in a row in which a maximum stood still
    for _ in range(_ROUNDS):
        curves = _curves(found, omega, model.limits)
        new = [refinement(omega, curve) for curve in curves]
        tops = {int(np.argmax(curve)) for curve in curves}
        if 0 in tops:
            new.append(omega[0] / np.array([10.0, 3.0]))  # the worst may lie lower still
        if len(omega) - 1 in tops:
            new.append(omega[-1] * np.array([1.5, 3.0, 10.0]))  # or higher
        before = curves.max(axis=1)
        added = np.unique(np.concatenate(new))
        omega = np.concatenate([omega, added])
        order = np.argsort(omega)
        omega = omega[order]
        found = _merged(found, model.sides(added, gains), order)
        curves = _curves(found, omega, model.limits)
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
    if worst == len(omega) - 1:
        return np.inf  # a maximum at the upper end may lie beyond it
    return float((omega[worst + 1] - omega[worst - 1]) / omega[worst])


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


class _Premise(NamedTuple):
    """What a condition rests on: the nominal loop's poles, and the same number in all open loops.

    ``known`` is False where no open loop has been found to differ, but some are undecided.
    """

    nominal: PoleCount
    equal: bool
    known: bool


def _premises(
    model: LinearModel, gains: LoopGains, true: Family, proofs: Certificates | None
) -> tuple[_Premise, _Premise]:
    """Return the premises of each condition.

    The velocity plants of Eq. 14 and 15 have no open-loop pole right of the origin at all, and a
    response can only be measured where that is so. Those of the position loop, Eq. 19, are the
    closed-loop poles of the velocity loops.
    """
    velocity, position = (
        count_unstable_poles(model.nominal_loop(gains, which=which)) for which in (VELOCITY, FORCE)
    )
    box = proofs.stable("velocity", model.path_name) if proofs else None
    failed = box is not None and box.status is Stability.UNSTABLE
    proved = box is None or box.status is Stability.STABLE
    equal = bool(velocity.stable[0] and true.velocity_stable.all() and not failed)
    known = (equal and proved) or failed or bool(np.any(~true.velocity_stable & true.decided))
    return (
        _Premise(velocity, equal=True, known=True),
        _Premise(position, equal=equal, known=known),
    )


class _Worst(NamedTuple):
    """A largest ratio, or use of what is allowed: attained where, proved to be at most what."""

    attained: float
    at: PlantPoint
    proved: float  # infinite where nothing is


def _conditions(
    model: LinearModel,
    omega: FloatArray,
    found: Sides,
    converged: tuple[bool, bool],
    premises: tuple[_Premise, _Premise],
    proofs: Certificates | None,
) -> tuple[Condition, Condition]:
    conditions = []
    for loop, name in enumerate(("velocity", "position")):
        limit = model.limits[loop]
        allowed = allowed_ratio(limit, omega)
        certified = proofs.of(name, model.path_name, EQUATION_OF[name]) if proofs else None
        ratio = _on_grid(model, omega, found, loop, found.ratio[loop])
        use = _on_grid(model, omega, found, loop, found.ratio[loop] / allowed)
        if proofs is not None and certified is not None:
            if isinstance(limit, float):
                certified, _ = against(proofs.problem, certified, limit)
                ratio = _proved(ratio, certified)
                use = _Worst(ratio.attained / limit, ratio.at, ratio.proved / limit)
            else:
                ratio = _proved(ratio, certified)
                names = (name, model.path_name, EQUATION_OF[name])
                use = _proved(use, use_of_curve(proofs.problem, names, limit))
        premise = premises[loop]
        status, grounds = _status(premise, use, converged=converged[loop])
        conditions.append(
            Condition(
                name=name,
                left=frozen(found.left[loop]),
                right=frozen(found.right[loop]),
                plant=frozen(found.plant[loop]),
                plant_ratio=frozen(found.plant_ratio[loop]),
                allowed=frozen(allowed),
                worst_ratio=ratio.attained,
                at=ratio.at,
                worst_use=use.attained,
                worst_use_at=use.at,
                low_frequency_limit=bool(ratio.at.frequency_rad_s <= omega[0]),
                nominal_stable=bool(premise.nominal.stable[0]),
                poles_equal=premise.equal,
                status=status,
                certified=certified,
                binding=not model.estimated,
                grounds=grounds if certified is None or model.members is None else Grounds.GRID,
            )
        )
    return conditions[0], conditions[1]


def _on_grid(
    model: LinearModel, omega: FloatArray, found: Sides, loop: int, values: FloatArray
) -> _Worst:
    """Return the grid's largest value, of which nothing is proved."""
    worst = int(np.argmax(values))
    at = model.point(int(found.plant[loop, worst]), float(omega[worst]))
    return _Worst(float(values[worst]), at, np.inf)


def _proved(grid: _Worst, certified: Bound) -> _Worst:
    """Return the certificate's worst case, or the grid's where a measured member is worse."""
    at = place_of(certified.at)
    if at is None or (grid.at.response is not None and grid.attained > certified.attained):
        return grid._replace(proved=max(certified.bound, grid.attained))
    attained = certified.attained if certified.attained > _NOTHING else 0.0
    return _Worst(attained, at, certified.bound)


def _status(premise: _Premise, use: _Worst, *, converged: bool) -> tuple[Status, Grounds]:
    """Return how a condition came out, and what that rests on."""
    nominal, proved = premise.nominal, np.isfinite(use.proved)
    if not nominal.decided[0] or (nominal.stable[0] and not premise.known):
        return Status.UNDECIDED, Grounds.OPEN
    if not nominal.stable[0] or not premise.equal:
        return Status.UNSTABLE, Grounds.CERTIFIED if proved else Grounds.GRID
    if use.attained > 1:
        return Status.VIOLATED, Grounds.CERTIFIED if proved else Grounds.GRID
    if use.proved <= 1:
        return Status.SATISFIED, Grounds.CERTIFIED
    if proved:
        return Status.UNDECIDED, Grounds.OPEN
    return Status.SATISFIED if converged else Status.NOT_CONVERGED, Grounds.GRID
