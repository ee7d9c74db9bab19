"""§5.4's order: W_conv first, for the converter pistons; then W_loss and W_sw, for the energy.

The paper says by hand and eye what stands here as rules. What counts as too large an error is
assumed: a tenth more of the performance index, or a quarter more of the force-error integral, than
the least seen on the way. W_loss and W_sw draw the pistons out again; W_conv is then raised.
A machine without converters has W_loss and W_sw alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from mptune.progress import silent
from mptune.weigh.ladders import LADDERS, ladder

if TYPE_CHECKING:
    from mptune.progress import Progress
    from mptune.weigh.trial import Bench, Trial, Weights

_CONVERTER_SHARE = 0.8  # of the travel: how far pistons may go
_INDEX_GROWTH, _FORCE_ERROR_GROWTH = 1.1, 1.25
STAGE = "weights by the paper's order"
STEPS = sum(map(len, LADDERS.values()))  # at most


class Stage(NamedTuple):
    """One trial of the procedure, and whether its weight was kept."""

    weight: str
    trial: Trial
    kept: bool


class _Walk:
    """The procedure under way."""

    def __init__(self, bench: Bench, start: Weights, progress: Progress) -> None:
        self._bench = bench
        self._farthest = _CONVERTER_SHARE * bench.study.study.supplies.converter_travel
        self._progress = progress
        self._tried = 0
        self._converter = iter(ladder(bench.study, "weight_converter"))  # only ever raised
        self.weights = start._replace(weight_loss=0.0, weight_switching=0.0)
        if bench.study.study.converters:
            self.weights = self.weights._replace(weight_converter=next(self._converter))
        self.steps: list[Stage] = []

    def keep_pistons_off(self, name: str, weights: Weights) -> bool:
        """Try weights, with as much more W_conv as the pistons need; keep them if errors allow."""
        while True:
            trial = self._bench.tried(weights)
            self._tried += 1
            self._progress(STAGE, min(self._tried / STEPS, 1.0))
            off = trial.unstable == 0 and trial.converter_peak <= self._farthest
            kept = off and self._small(trial)
            self.steps.append(Stage(name, trial, kept))
            if kept:
                self.weights = weights
            more = None if off else next(self._converter, None)
            if more is None:
                return kept
            name, weights = "weight_converter", weights._replace(weight_converter=more)

    def _small(self, trial: Trial) -> bool:
        growths = {
            "performance_index_ms": _INDEX_GROWTH,
            "force_error_integral_kn2s": _FORCE_ERROR_GROWTH,
        }
        return all(
            trial.mean(figure) <= growth * min(step.trial.mean(figure) for step in self.steps)
            for figure, growth in growths.items()
            if self.steps
        )


def by_the_papers_order(
    bench: Bench, start: Weights, progress: Progress = silent
) -> tuple[Weights, tuple[Stage, ...]]:
    """Find the three weights one after another.

    Parameters
    ----------
    bench
        Where weights are tried.
    start
        Sampling period and tolerances; its weights are not used.
    progress
        Told of the stage ``STAGE`` after each trial.

    Returns
    -------
    The weights, and every step on the way.
    """
    walk = _Walk(bench, start, progress)
    first = "weight_converter" if bench.study.study.converters else "weight_loss"  # from 0 on
    walk.keep_pistons_off(first, walk.weights)
    for name in ("weight_loss", "weight_switching"):
        for value in ladder(bench.study, name):
            more: dict[str, Any] = {name: value}
            if not walk.keep_pistons_off(name, walk.weights._replace(**more)):
                break
    return walk.weights, tuple(walk.steps)
