"""What the tuner improves: tracking, disturbance rejection, bandwidth, or a mixture."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.family import FamilyLoops
from mptune.robust.condition import nominal_loops
from mptune.robust.running import family_figures, running_figures
from mptune.robust.tracking import family_tracking, tracked_plants
from mptune.sim.response import farthest, load_step
from mptune.tune.asked import AskedPlants

if TYPE_CHECKING:
    from mptune.arrays import FloatArray, IntArray
    from mptune.params.packed import LoopGains
    from mptune.params.requirements import Objective
    from mptune.robust.model import LinearModel
    from mptune.robust.running import RunningFigures
    from mptune.tune.space import Choice

_LOAD_TIME = 12.0  # over K_P,pos: long after the peak
_LONGEST_LOAD_TIME = 30.0  # s
_LOAD_SAMPLES = 400
_SLOW = 0.7  # of the slowest corner's index: corners below it are left to ``grow``
_GROWN = 1e-4  # of a disk margin: a plant that is worse by less is not added
_LOWEST = 0.05  # rad/s, of the loops as they run
KINDS = ("tracking", "disturbance", "load-step", "bandwidth", "robustness")


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
    disk_margin, peak_compliance
        Smallest α, negative where a loop is unstable, and largest |S|/(mω²) [m/N] of the loop as it
        runs over the plants asked; NaN where there is none.
    """

    tracking: float
    integral_gain: float
    load_step: float
    bandwidth: float
    disk_margin: float = float("nan")
    peak_compliance: float = float("nan")

    def json(self) -> dict[str, float]:
        """Return the figures in SI, units in the keys."""
        keys = (
            "tracking_index_s",
            "k_i_pos",
            "load_step_m_per_n",
            "bandwidth_rad_s",
            "disk_margin",
            "peak_compliance_m_per_n",
        )
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
    too; free feed-forward decides itself which of them are slow. Tracking of the machines of
    [verification] is asked of all of them.
    """

    def __init__(self, model: LinearModel, start: Choice) -> None:
        self._model = model
        self._tracking = self._loaded = self._running = model.corners()
        self._ask_running()
        objective = model.study.study.objective
        if objective.tracking_plants == "verification":
            self._tracking = np.arange(tracked_plants(model).number)
            return
        peaks = self.tracking_peaks(start).max(axis=(1, 2))
        if np.isfinite(peaks).all() and not objective.turned:
            self._tracking = self._tracking[peaks >= _SLOW * peaks.max()]

    @property
    def plants(self) -> int:
        """Number of plants that are asked."""
        return len(np.unique(np.concatenate([self._tracking, self._loaded, self._running])))

    def figures(self, choice: Choice) -> Figures:
        """Return the figures of merit of one candidate."""
        running = self._run(choice)
        return Figures(
            tracking=float(self.tracking_peaks(choice).max()),
            integral_gain=choice.gains.k_i_pos,
            load_step=float(self.load_peaks(choice.gains).max()),
            bandwidth=self.bandwidth(choice.gains),
            disk_margin=float(running.disk_margin.min()) if running else np.nan,
            peak_compliance=float(running.peak_compliance.max()) if running else np.nan,
        )

    def tracking_peaks(
        self, choice: Choice, rows: IntArray | None = None, *, running_away: bool = False
    ) -> FloatArray:
        """Return each plant's, move's and time window's peak error over its peak velocity [s].

        See ``mptune.robust.tracking``.
        """
        rows = self._tracking if rows is None else rows
        model, ahead = choice.put_over(self._model), choice.feedforward
        return family_tracking(model, choice.gains, ahead, rows, running_away=running_away)

    def disk_margins(self, choice: Choice) -> FloatArray:
        """Return each plant's disk margin as it runs, negative where unstable; empty if none."""
        running = self._run(choice)
        return running.disk_margin if running else np.zeros(0)

    def ask(self, model: LinearModel) -> None:
        """Ask a model whose family holds one plant more, as the last."""
        last = [len(model.plants.mass) - 1]
        self._model = model
        self._running = np.union1d(self._running, last)
        self._ask_running()

    def _ask_running(self) -> None:
        self._asked = AskedPlants(self._model, self._running, _LOWEST)

    def _run(self, choice: Choice) -> RunningFigures | None:
        if not self._model.runs:
            return None
        by = choice.put_over(self._model).filters
        return running_figures(self._asked.by(by), choice.gains)

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
            tracked = np.arange(tracked_plants(self._model).number)
            peaks = self.tracking_peaks(choice, tracked).max(axis=(1, 2))
            worst["tracking"] = float(peaks.max())
            if peaks.max() > 1.001 * peaks[self._tracking].max():
                self._tracking, added = np.union1d(self._tracking, [int(np.argmax(peaks))]), True
        if "load-step" in kinds:
            peaks = self.load_peaks(choice.gains, every)
            worst["load-step"] = float(peaks.max())
            if peaks.max() > 1.001 * peaks[self._loaded].max():
                self._loaded, added = np.union1d(self._loaded, [int(np.argmax(peaks))]), True
        if "robustness" in kinds:
            loops = choice.put_over(self._model).as_it_runs(choice.gains)
            found = family_figures(loops, self._model.period, _LOWEST).disk_margin
            worst["robustness"] = float(found.min())
            if found.min() < found[self._running].min() - _GROWN:
                self._running, added = np.union1d(self._running, [int(np.argmin(found))]), True
                self._ask_running()
        return worst, added
