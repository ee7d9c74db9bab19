"""What the tuner improves: tracking, disturbance rejection, bandwidth, or a mixture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.params.pack import LoopGains, MeasurementPath, NominalPlant, Plants
from mptune.robust.condition import nominal_loops
from mptune.sim.moves import Moves, moves_of
from mptune.sim.response import tracking

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import FloatArray
    from mptune.params.manoeuvre import Manoeuvre
    from mptune.params.requirements import Objective

_SAMPLES_PER_MOVE = 200


@dataclass(frozen=True)
class Figures:
    """The three figures of merit of one set of gains.

    Attributes
    ----------
    tracking
        Worst performance index over the plants: peak position error over peak velocity [s].
    integral_gain
        K_I,pos [1/s²], which sets how fast a load step is carried.
    bandwidth
        Frequency where the nominal closed position loop falls below −3 dB [rad/s].
    """

    tracking: float
    integral_gain: float
    bandwidth: float


def weights_of(objective: Objective) -> tuple[float, float, float]:
    """Return the weights of tracking, disturbance and bandwidth."""
    kinds = ("tracking", "disturbance", "bandwidth")
    if objective.kind is not None:
        return tuple(float(kind == objective.kind) for kind in kinds)  # type: ignore[return-value]
    return objective.tracking or 0.0, objective.disturbance or 0.0, objective.bandwidth or 0.0


class Judge:
    """Computes the figures of merit for one family and movement set.

    The index is the largest over the moves, each from rest, and over the family's corners with
    the least and the largest mass and lags: it hardly depends on anything else, and the family as
    a whole is checked at the end.
    """

    def __init__(
        self,
        plants: Plants,
        nominal: NominalPlant,
        share_a: float,
        path: MeasurementPath,
        manoeuvres: Sequence[Manoeuvre],
    ) -> None:
        self._plants = corners(plants)
        self._nominal = nominal
        self._share_a = share_a
        self._path = path
        # The loop is linear: moves that differ by their distance only have the same index.
        alike = {
            move if move.kind == "file" else move.model_copy(update={"distance": 1.0})
            for move in manoeuvres
        }
        self._moves = [moves_of([move]) for move in sorted(alike, key=repr)]

    def figures(self, gains: LoopGains) -> Figures:
        """Return the figures of merit of one set of gains."""
        return Figures(self.index(gains), gains.k_i_pos, self.bandwidth(gains))

    def cost(
        self, gains: LoopGains, baseline: Figures, weights: tuple[float, float, float]
    ) -> float:
        """Return the weighted sum of the figures relative to the baseline's; less is better."""
        cost = 0.0
        if weights[0] > 0:
            cost += weights[0] * self.index(gains) / baseline.tracking
        if weights[1] > 0:
            cost += weights[1] * max(baseline.integral_gain, 1e-9) / gains.k_i_pos
        if weights[2] > 0:
            cost += weights[2] * baseline.bandwidth / self.bandwidth(gains)
        return cost

    def index(self, gains: LoopGains) -> float:
        """Return the worst performance index over corners and moves [s]."""
        return max(
            float(family_index(self._plants, self._share_a, gains, self._path, move).max())
            for move in self._moves
        )

    def bandwidth(self, gains: LoopGains) -> float:
        """Return the −3 dB bandwidth of the nominal closed position loop [rad/s]."""
        crossover = gains.k_p_vel / self._nominal.mass
        omega = np.geomspace(1e-3 * crossover, 10 * crossover, 400)
        loop = nominal_loops(omega, self._nominal, gains, self._path)[1]
        below = np.flatnonzero(np.abs(loop / (1 + loop)) < 2**-0.5)
        return float(omega[below[0]]) if len(below) else float(omega[-1])


def corners(plants: Plants) -> Plants:
    """Return the plants with the least and largest mass, all lags smallest or all largest."""
    lags = np.stack([plants.delay, plants.tau_a, plants.tau_b])
    small = np.all(lags == lags.min(axis=1, keepdims=True), axis=0)
    large = np.all(lags == lags.max(axis=1, keepdims=True), axis=0)
    light, heavy = plants.mass == plants.mass.min(), plants.mass == plants.mass.max()
    keep = (small | large) & (light | heavy)
    return Plants(*(np.ascontiguousarray(column[keep]) for column in plants))


def family_index(
    plants: Plants, share_a: float, gains: LoopGains, path: MeasurementPath, move: Moves
) -> FloatArray:
    """Return each plant's peak position error over its peak velocity [s] for one move, ``(N,)``.

    Continuous controller, exact dead time, velocity feed-forward (§7.2).
    """
    time = np.linspace(0, move.duration, _SAMPLES_PER_MOVE + 1)
    wanted = move.sampled(_SAMPLES_PER_MOVE)
    position, velocity = tracking(plants, share_a, gains, path, time, move.pieces)
    error = np.abs(position - wanted).max(axis=1)
    return np.asarray(error / np.abs(velocity).max(axis=1))
