"""Some plants of a family as they run, their responses kept for what measures them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.loops.running import running_family

if TYPE_CHECKING:
    from mptune.arrays import IntArray
    from mptune.loops.running import RunningFamily
    from mptune.params.packed import MeasurementPath
    from mptune.robust.model import LinearModel

_KEPT = 4  # families: a gradient by the estimator's own numbers moves away and back


class AskedPlants:
    """Plants of a model's family, whose responses as they run the gains leave alone.

    A search that turns the gains alone computes them once; where it turns what measures as well,
    they are computed for each of its measurement paths, of which the last few are kept.

    Parameters
    ----------
    model
        The study's linear model.
    rows
        The plants.
    low
        The lowest frequency [rad/s].
    """

    def __init__(self, model: LinearModel, rows: IntArray, low: float) -> None:
        self._plants, self._period, self._low = model.explicit.picked(rows), model.period, low
        self._kept: dict[MeasurementPath, RunningFamily] = {}

    def by(self, path: MeasurementPath) -> RunningFamily:
        """Return the plants' responses through a measurement path as it runs."""
        found = self._kept.pop(path, None)
        if found is None:
            found = running_family(self._low, self._plants, path, self._period)
        self._kept[path] = found  # the last one asked stands last
        if len(self._kept) > _KEPT:
            del self._kept[next(iter(self._kept))]
        return found
