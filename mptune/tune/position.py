"""The position controller: a bounded search under Eq. 21's requirement.

The five parameters of Eq. 22 are searched on logarithmic scales, by differential evolution and,
from its best point, by COBYQA. Eq. 21 needs one curve per velocity gain, the envelope
max|Δ_pos|(ω); the first search holds each candidate against it and simulates only one that passes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import Bounds, NonlinearConstraint, differential_evolution, minimize

from mptune.loops.position import position_controller
from mptune.params.pack import LoopGains, MeasurementPath, NominalPlant, Plants
from mptune.robust.condition import nominal_loops, sides
from mptune.robust.grid import frequency_range
from mptune.robust.sweep import CONVERGED
from mptune.robust.verdict import allowed_ratio

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import ComplexArray, FloatArray
    from mptune.params.requirements import RatioCurve

POINTS = 1000  # frequencies of the envelope
_POPULATION, _GENERATIONS = 10, 40
_POLISH = 400  # evaluations
_PENALTY = 1e3  # any infeasible candidate is worse than any feasible one
NAMES = ("k_p_pos", "k_i_pos", "omega", "xi", "tau")


@dataclass(frozen=True)
class PositionGains:
    """What the search found.

    Attributes
    ----------
    gains
        The best gains, or those nearest to the requirement where none meets it.
    feasible
        Whether they meet the requirement.
    converged
        Whether the polish closed in on one point.
    evaluations
        Candidates looked at.
    """

    gains: LoopGains
    feasible: bool
    converged: bool
    evaluations: int


class Envelope:
    """Eq. 21 at one velocity gain, as a function of the position controller alone."""

    def __init__(
        self,
        plants: Plants,
        nominal: NominalPlant,
        share_a: float,
        start: LoopGains,
        path: MeasurementPath,
        limit: float | RatioCurve,
    ) -> None:
        self._omega = np.geomspace(*frequency_range(plants, nominal, start), POINTS)
        self._left = sides(self._omega, plants, nominal, share_a, start, path).left[1]
        self._allowed = allowed_ratio(limit, self._omega) * (1 - 5 * CONVERGED)
        # With ω = ξ = τ = 1 and no I-term Eq. 22 is 1: what is left is the plant.
        one = start._replace(k_p_pos=1.0, k_i_pos=0.0, omega=1.0, xi=1.0, tau=1.0)
        self._plant: ComplexArray = nominal_loops(self._omega, nominal, one, path)[1]

    def use(self, gains: LoopGains) -> float:
        """Return the largest quotient of left/right ratio and allowed ratio."""
        controller = position_controller(
            1j * self._omega, gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi, gains.tau
        )
        loop = self._plant * controller
        return float((self._left * np.abs(loop / (1 + loop)) / self._allowed).max())


def search_position_gains(
    envelope: Envelope,
    start: LoopGains,
    bounds: dict[str, tuple[float, float]],
    cost: Callable[[LoopGains], float],
    progress: Callable[[float], None],
) -> PositionGains:
    """Return the gains of least cost that keep Eq. 21's requirement.

    Parameters
    ----------
    envelope
        Eq. 21 at the chosen velocity gain.
    start
        A first candidate, with the velocity gain to keep.
    bounds
        Smallest and largest value by the names of ``NAMES``, in SI, all above 0.
    cost
        What to make small.
    progress
        Called with the share of the work that is done.
    """
    low, high = np.log([bounds[name] for name in NAMES]).T

    def gains_at(point: FloatArray) -> LoopGains:
        values = np.exp(np.clip(point, low, high))
        return LoopGains(start.k_p_vel, *(float(value) for value in values))

    def value(point: FloatArray) -> float:
        gains = gains_at(point)
        use = envelope.use(gains)
        return _PENALTY * use if use > 1 else min(cost(gains), _PENALTY)

    generation = 0

    def count(*_: object, **__: object) -> None:
        nonlocal generation
        generation += 1
        progress(generation / _GENERATIONS)

    inside = 1e-6 * (high - low)  # scipy wants the first candidate off the edges
    first = np.clip(
        np.log([max(getattr(start, name), 1e-12) for name in NAMES]), low + inside, high - inside
    )
    rough = differential_evolution(
        value,
        list(zip(low, high, strict=True)),
        x0=first,
        popsize=_POPULATION,
        maxiter=_GENERATIONS,
        tol=1e-5,
        rng=np.random.default_rng(0),
        polish=False,
        callback=count,
    )
    if envelope.use(gains_at(rough.x)) > 1:
        return PositionGains(
            gains_at(rough.x), feasible=False, converged=False, evaluations=int(rough.nfev)
        )
    fine = minimize(
        lambda point: cost(gains_at(point)),
        rough.x,
        method="COBYQA",
        bounds=Bounds(low, high),
        constraints=NonlinearConstraint(lambda point: envelope.use(gains_at(point)), -np.inf, 1.0),
        options={"maxfev": _POLISH, "initial_tr_radius": 0.05, "final_tr_radius": 1e-5},
    )
    best = min(rough.x, fine.x, key=value)
    return PositionGains(
        gains_at(best),
        feasible=True,
        converged=bool(fine.success),
        evaluations=int(rough.nfev + fine.nfev),
    )
