"""The first tuner: the largest velocity gain, then a bounded search of the position controller."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.loops.family import plants_of
from mptune.params.controller import Gains
from mptune.params.pack import LoopGains, NominalPlant, Plants, pack_gains, pack_nominal, pack_path
from mptune.robust.result import PlantPoint, Status, SweepResult, plant_point
from mptune.robust.sweep import sweep
from mptune.tune.objective import Figures, Judge, weights_of
from mptune.tune.position import NAMES, Envelope, search_position_gains
from mptune.tune.velocity import largest_velocity_gain

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.study import ResolvedStudy
    from mptune.tune.velocity import VelocityGain


class TuneStatus(StrEnum):
    """How the tuning came out."""

    FEASIBLE = "feasible"  # every requirement met; a bounded search proves no optimum
    NOT_CONVERGED = "feasible, not converged"  # the same, and the search was still moving
    INFEASIBLE = "infeasible"  # some requirement cannot be met; ``blocking`` says which


@dataclass(frozen=True)
class Blocking:
    """The requirement that stands in the way, and how far it would have to give."""

    requirement: str
    least_found: float
    at: PlantPoint | None
    remedy: str


@dataclass(frozen=True)
class TuneResult:
    """Tuned gains, with the sweep that judges them over the whole family.

    Attributes
    ----------
    gains, before
        The tuned gains and the study's own.
    figures, figures_before
        Their figures of merit.
    velocity
        What limits the velocity gain.
    sweep
        The verdict over the whole family.
    evaluations
        Candidates that the search looked at.
    """

    status: TuneStatus
    gains: Gains
    before: Gains
    figures: Figures
    figures_before: Figures
    velocity: VelocityGain
    sweep: SweepResult
    blocking: Blocking | None
    evaluations: int

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys; gains keep the study's keys."""
        return {
            "status": self.status.value,
            "gains": self.gains.model_dump(),
            "gains_before": self.before.model_dump(),
            "velocity_worst_ratio": self.sweep.velocity.worst_ratio,
            "position_worst_ratio": self.sweep.position.worst_ratio,
            "satisfied": self.sweep.satisfied,
            "objective": {
                "before": _figures_json(self.figures_before),
                "after": _figures_json(self.figures),
            },
            "velocity_gain_limited_by": self.velocity.limited_by,
            "blocking": _blocking_json(self.blocking),
            "evaluations": self.evaluations,
        }


def tune(
    study: ResolvedStudy, progress: Callable[[float], None] = lambda _share: None
) -> TuneResult:
    """Return gains that satisfy the study's requirements, and how well they do.

    Parameters
    ----------
    study
        The study; its own gains are the starting point.
    progress
        Called with the share of the work that is done.
    """
    plants, nominal, path = plants_of(study), pack_nominal(study), pack_path(study)
    share_a, start = study.study.cylinder.share_a, pack_gains(study.study.gains)
    requirements = study.study.requirements
    upper = requirements.bounds.k_p_vel[1] if requirements.bounds.k_p_vel else np.inf
    velocity = largest_velocity_gain(
        plants, nominal, share_a, start, path, requirements.velocity_ratio, upper
    )
    judge = Judge(plants, nominal, share_a, path, study.study.manoeuvre)
    before = judge.figures(start)
    least = requirements.bounds.k_p_vel[0] if requirements.bounds.k_p_vel else 0.0
    if velocity.k_p_vel <= least:
        blocking = _velocity_blocking(plants, nominal, velocity)
        return _result(study, TuneStatus.INFEASIBLE, start, before, judge, velocity, blocking, 0)

    start = start._replace(k_p_vel=velocity.k_p_vel)
    envelope = Envelope(plants, nominal, share_a, start, path, requirements.position_ratio)
    weights = weights_of(study.study.objective)
    found = search_position_gains(
        envelope,
        start,
        _bounds(study, start, nominal),
        lambda gains: judge.cost(gains, before, weights),
        progress,
    )
    status = TuneStatus.FEASIBLE if found.converged else TuneStatus.NOT_CONVERGED
    if not found.feasible:
        status = TuneStatus.INFEASIBLE
    return _result(study, status, found.gains, before, judge, velocity, None, found.evaluations)


def _result(
    study: ResolvedStudy,
    status: TuneStatus,
    packed: LoopGains,
    before: Figures,
    judge: Judge,
    velocity: VelocityGain,
    blocking: Blocking | None,
    evaluations: int,
) -> TuneResult:
    gains = Gains.model_validate(packed._asdict(), context={"si": True})
    judged = sweep(study, gains)
    if blocking is None and not judged.satisfied:
        status = TuneStatus.INFEASIBLE
        blocking = _sweep_blocking(judged)
    return TuneResult(
        status=status,
        gains=gains,
        before=study.study.gains,
        figures=judge.figures(packed),
        figures_before=before,
        velocity=velocity,
        sweep=judged,
        blocking=blocking,
        evaluations=evaluations,
    )


def _velocity_blocking(plants: Plants, nominal: NominalPlant, velocity: VelocityGain) -> Blocking:
    at = plant_point(plants, velocity.plant, velocity.frequency)
    least = abs(nominal.mass / at.mass_kg - 1)
    return Blocking(
        requirement="velocity_ratio",
        least_found=least,
        at=at,
        remedy=(
            f"as the frequency vanishes the left/right ratio of Eq. 17 tends to {least:.3g} at any "
            "gain; allow more, narrow the mass range or move uncertainty.nominal.mass inside it"
        ),
    )


def _sweep_blocking(judged: SweepResult) -> Blocking:
    """Return the first requirement that the best gains found do not meet."""
    check = next(check for check in judged.checks if check.status is not Status.SATISFIED)
    if check.status is Status.NOT_EVALUATED:
        remedy = "this version cannot check it; remove it from the study's requirements"
    else:
        remedy = f"the best gains found reach {check.found:.3g} where {check.limit} is asked"
    return Blocking(check.name, check.found, check.at, remedy)


def _bounds(
    study: ResolvedStudy, start: LoopGains, nominal: NominalPlant
) -> dict[str, tuple[float, float]]:
    """Return the search box: the study's bounds, else a wide one about the velocity crossover.

    τ is at least half a sampling period, below which Tustin's approximation rings.
    """
    crossover = start.k_p_vel / nominal.mass
    half_period = study.study.controller.sampling_period / 2
    default = {
        "k_p_pos": (0.02 * crossover, 2 * crossover),
        "k_i_pos": (1e-4 * crossover**2, crossover**2),
        "omega": (0.2 * crossover, 20 * crossover),
        "xi": (0.05, 3.0),
        "tau": (half_period, max(10 * half_period, 2 / crossover)),
    }
    stated = study.study.requirements.bounds
    bounds = {name: getattr(stated, name) or default[name] for name in NAMES}
    tiny = {name: 1e-3 * default[name][0] for name in NAMES}  # logarithmic scales start above 0
    return {name: (max(low, tiny[name]), high) for name, (low, high) in bounds.items()}


def _figures_json(figures: Figures) -> dict[str, float]:
    return {
        "tracking_index_s": figures.tracking,
        "k_i_pos": figures.integral_gain,
        "bandwidth_rad_s": figures.bandwidth,
    }


def _blocking_json(blocking: Blocking | None) -> dict[str, Any] | None:
    if blocking is None:
        return None
    return {
        "requirement": blocking.requirement,
        "least_found": blocking.least_found,
        "at": blocking.at.values() if blocking.at else None,
        "remedy": blocking.remedy,
    }
