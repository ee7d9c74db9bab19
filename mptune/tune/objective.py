"""What the tuner improves: tracking, disturbance rejection, bandwidth, or a mixture."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.family import FamilyLoops
from mptune.params.pack import pack_feedforward
from mptune.params.packed import LoopGains, Plant, Plants
from mptune.robust.condition import nominal_loops
from mptune.sim.moves import distinct_moves
from mptune.sim.response import farthest, load_step, tracking
from mptune.sim.sampled import run_linear

if TYPE_CHECKING:
    from mptune.arrays import FloatArray, IntArray
    from mptune.params.requirements import Objective
    from mptune.robust.model import LinearModel
    from mptune.sim.moves import Moves
    from mptune.tune.space import Choice

BINS = 16  # of time: the error's peak in each is a smooth function of the gains
_SAMPLES_PER_MOVE = 20 * BINS
_LOAD_TIME = 12.0  # over K_P,pos: long after the peak
_LONGEST_LOAD_TIME = 30.0  # s
_LOAD_SAMPLES = 400
_SLOW = 0.7  # of the slowest corner's index: corners below it are left to ``grow``
KINDS = ("tracking", "disturbance", "load-step", "bandwidth")


@dataclass(frozen=True)
class Figures:
    """The figures of merit of one candidate.

    Attributes
    ----------
    tracking
        Worst performance index over the plants asked: peak position error over peak velocity [s].
    integral_gain
        K_I,pos [1/s²], which sets how fast a load step is carried.
    load_step
        Largest peak of the position's deviation per newton of a load step [m/N].
    bandwidth
        Frequency where the nominal closed position loop falls below −3 dB [rad/s].
    """

    tracking: float
    integral_gain: float
    load_step: float
    bandwidth: float

    def json(self) -> dict[str, float]:
        """Return the figures in SI, units in the keys."""
        keys = ("tracking_index_s", "k_i_pos", "load_step_m_per_n", "bandwidth_rad_s")
        return {
            key: getattr(self, field.name) for key, field in zip(keys, fields(self), strict=True)
        }


def weights_of(objective: Objective) -> dict[str, float]:
    """Return the weight of each kind of objective that has one."""
    if objective.kind is not None:
        return {objective.kind: 1.0}
    weights = {kind: getattr(objective, kind.replace("-", "_")) or 0.0 for kind in KINDS}
    return {kind: weight for kind, weight in weights.items() if weight > 0}


class Judge:
    """Computes the figures of merit of one study, on the plants that are worst in them.

    It starts with the family's corners, and ``grow`` asks the whole family. Where feed-forward is
    not free, the corners that are fast in tracking with the given candidate are left to ``grow``
    too; free feed-forward decides itself which of them are slow.
    """

    def __init__(self, model: LinearModel, start: Choice) -> None:
        self._model, self._moves = model, distinct_moves(model.study.study.manoeuvre)
        self._sampled = model.study.study.objective.tracking_loop == "sampled"
        self._tracking = self._loaded = model.corners()
        peaks = self.tracking_peaks(start).max(axis=(1, 2))
        free = model.study.study.objective.free_feedforward
        if np.isfinite(peaks).all() and not free:
            self._tracking = self._tracking[peaks >= _SLOW * peaks.max()]

    @property
    def plants(self) -> int:
        """Number of plants that are asked."""
        return len(np.union1d(self._tracking, self._loaded))

    def figures(self, choice: Choice) -> Figures:
        """Return the figures of merit of one candidate."""
        return Figures(
            tracking=float(self.tracking_peaks(choice).max()),
            integral_gain=choice.gains.k_i_pos,
            load_step=float(self.load_peaks(choice.gains).max()),
            bandwidth=self.bandwidth(choice.gains),
        )

    def tracking_peaks(self, choice: Choice, rows: IntArray | None = None) -> FloatArray:
        """Return each plant's, move's and time window's peak error over its peak velocity [s].

        Shape ``(n, M, BINS)``. The continuous loop has velocity feed-forward alone, exact dead
        time, and the measurement path of the study's model; the sampled one is the loop as it
        runs, feed-forward included.
        """
        plants = self._model.plants.picked(self._tracking if rows is None else rows)
        found = _as_sampled if self._sampled else _continuous
        peaks = [found(self._model, plants, choice, move) for move in self._moves]
        return np.asarray(np.stack(peaks, axis=1))

    def load_peaks(self, gains: LoopGains, rows: IntArray | None = None) -> FloatArray:
        """Return each plant's largest position deviation per newton of a load step [m/N]."""
        model, plants = (
            self._model,
            self._model.plants.picked(self._loaded if rows is None else rows),
        )
        end = _LOAD_TIME / max(gains.k_p_pos, _LOAD_TIME / _LONGEST_LOAD_TIME)
        loops = FamilyLoops(plants, gains, model.path)
        time = np.linspace(0, min(end, farthest(loops)), _LOAD_SAMPLES)
        return np.asarray(np.abs(load_step(loops, time)).max(axis=1))

    def bandwidth(self, gains: LoopGains) -> float:
        """Return the −3 dB bandwidth of the nominal closed position loop [rad/s]."""
        crossover = gains.k_p_vel / self._model.nominal.mass
        omega = np.geomspace(1e-3 * crossover, 10 * crossover, 400)
        loop = nominal_loops(omega, self._model.nominal, gains, self._model.path)[1]
        closed = np.log(np.maximum(np.abs(loop / (1 + loop)), 1e-300)) + 0.5 * np.log(2)
        below = np.flatnonzero(closed < 0)
        if len(below) == 0 or below[0] == 0:
            return float(omega[-1] if len(below) == 0 else omega[0])
        last, first = below[0] - 1, below[0]
        share = closed[last] / (closed[last] - closed[first])
        return float(omega[last] * (omega[first] / omega[last]) ** share)

    def grow(self, choice: Choice, kinds: tuple[str, ...]) -> tuple[dict[str, float], bool]:
        """Ask the whole family; add the plant that is worst where it is not known yet.

        Returns
        -------
        tuple
            The worst value by kind, over the whole family, and whether a plant was added.
        """
        every, worst, added = np.arange(len(self._model.plants.mass)), {}, False
        if "tracking" in kinds:
            peaks = self.tracking_peaks(choice, every).max(axis=(1, 2))
            worst["tracking"] = float(peaks.max())
            if peaks.max() > 1.001 * peaks[self._tracking].max():
                self._tracking, added = np.union1d(self._tracking, [int(np.argmax(peaks))]), True
        if "load-step" in kinds:
            peaks = self.load_peaks(choice.gains, every)
            worst["load-step"] = float(peaks.max())
            if peaks.max() > 1.001 * peaks[self._loaded].max():
                self._loaded, added = np.union1d(self._loaded, [int(np.argmax(peaks))]), True
        return worst, added


def _continuous(model: LinearModel, plants: Plants, choice: Choice, move: Moves) -> FloatArray:
    time = np.linspace(0, move.duration, _SAMPLES_PER_MOVE + 1)
    wanted = move.sampled(_SAMPLES_PER_MOVE)
    loops = FamilyLoops(plants, choice.gains, model.path)
    position, velocity = tracking(loops, time, move.pieces)
    error = np.abs(position - wanted)[:, 1:].reshape(len(plants.mass), BINS, -1).max(axis=2)
    return np.asarray(error / np.abs(velocity).max(axis=1)[:, None])


def _as_sampled(model: LinearModel, plants: Plants, choice: Choice, move: Moves) -> FloatArray:
    fast = model.filters.sample_time
    ahead = pack_feedforward(choice.feedforward, fast)
    ticks = round(move.duration / fast) // BINS * BINS
    found = np.empty((len(plants.mass), BINS))
    for n, plant in enumerate(map(Plant._make, zip(*plants, strict=True))):
        wanted, position, velocity, _ = run_linear(
            plant, choice.gains, model.filters, model.period, move.pieces, ahead, ticks
        )
        error = np.abs(wanted - position).reshape(BINS, -1).max(axis=1)
        found[n] = error / np.abs(velocity).max()
    return found
