"""§5.4's order: W_conv first, for the converter pistons; then W_loss and W_sw, for the energy.

The paper says by hand and eye what stands here as rules. What counts as too large an error is
assumed: a tenth more of the performance index and a quarter more of the force-error integral than
without the weight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mptune.tune.weights.trial import Bench, Trial, Weights

_CONVERTER_SHARE = 0.8  # of the travel: how far pistons may go
_INDEX_GROWTH, _FORCE_ERROR_GROWTH = 1.1, 1.25
_CONVERTER = tuple(2e9 * 10**k for k in (0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5))  # N s/m⁶
_LOSS = tuple(10.0 * 2**k for k in range(7))  # N/J
_SWITCHING = tuple(12.5 * 2**k for k in range(7))  # N
STEPS = len(_CONVERTER) + len(_LOSS) + len(_SWITCHING)  # at most


class Step(NamedTuple):
    """One trial of the procedure, and whether its weight was kept."""

    weight: str
    trial: Trial
    kept: bool


def by_the_papers_order(
    bench: Bench, start: Weights, progress: Callable[[], None] = lambda: None
) -> tuple[Weights, tuple[Step, ...]]:
    """Find the three weights one after another.

    Parameters
    ----------
    bench
        Where weights are tried.
    start
        Sampling period and tolerances; its weights are not used.
    progress
        Called after each trial.

    Returns
    -------
    The weights, and every step on the way.
    """
    travel = bench.study.study.supplies.converter_travel
    steps: list[Step] = []

    def keeps_off(trial: Trial) -> bool:
        return trial.unstable == 0 and trial.converter_peak <= _CONVERTER_SHARE * travel

    def tried(weight: str, weights: Weights, keeps: Callable[[Trial], bool]) -> Step:
        trial = bench.tried(weights)
        progress()
        steps.append(Step(weight, trial, keeps(trial)))
        return steps[-1]

    # The least W_conv that keeps the pistons off; where none does, the largest.
    weights = start._replace(weight_loss=0.0, weight_switching=0.0)
    for value in _CONVERTER:
        weights = weights._replace(weight_converter=value)
        if tried("weight_converter", weights, keeps_off).kept:
            break
    # The largest W_loss, then W_sw, before an error grows too large.
    without = steps[-1].trial

    def both(trial: Trial) -> bool:
        return keeps_off(trial) and _small(trial, without)

    ladders: tuple[tuple[str, Iterable[float]], ...] = (
        ("weight_loss", _LOSS),
        ("weight_switching", _SWITCHING),
    )
    for name, ladder in ladders:
        best = weights
        for value in ladder:
            candidate = weights._replace(**{name: value})
            if not tried(
                name, candidate, lambda trial: keeps_off(trial) and _small(trial, without)
            ).kept:
                break
            best = candidate
        weights = best
    return weights, tuple(steps)


def _small(trial: Trial, without: Trial) -> bool:
    growths = {
        "performance_index_ms": _INDEX_GROWTH,
        "force_error_integral_kn2s": _FORCE_ERROR_GROWTH,
    }
    return all(
        trial.mean(figure) <= growth * without.mean(figure) for figure, growth in growths.items()
    )
