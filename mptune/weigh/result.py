"""What the search over the weights found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from mptune.interop import Drawn
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.weigh.trial import OBJECTIVES

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.params.study import ResolvedStudy
    from mptune.weigh.procedure import Stage
    from mptune.weigh.recommend import Recommendation
    from mptune.weigh.trial import Limits, Trial, Weights

_KEYS = (
    "_n",
    "_n_per_j",
    "_n_s_per_m6",
    "_s",
    "_m",
    "_m",
    "_n",
    "",
    "_n_per_pa",
    "_n_per_j",
)  # units of ``Weights``


@dataclass(frozen=True, repr=False)
class WeightsResult(Summarised, Drawn):
    """The paper's order, the search's trials and what follows.

    Attributes
    ----------
    by_order, steps
        What §5.4's order ends with, and its trials.
    trials
        Of the search; the first is the study's own weights.
    front
        Places of the trials on the Pareto front.
    """

    drawings: ClassVar[Mapping[str, str]] = {"trials": "mptune.figures.weights:weights_figure"}

    study: ResolvedStudy
    by_order: Weights
    steps: tuple[Stage, ...]
    trials: tuple[Trial, ...]
    front: tuple[int, ...]
    limits: Limits
    recommendation: Recommendation

    @property
    def satisfied(self) -> bool:
        """Whether weights were found that dominate the study's own."""
        return self.recommendation.dominates

    @property
    def headline(self) -> str:
        """Study, number of trials, and what follows."""
        return (
            f"Weights of {self.study.name}: {len(self.trials)} trials; {self.recommendation.reason}"
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return one row per trial: weights in SI, figures in §7's units."""
        import pandas as pd

        rows = [
            {**_said(trial), "usable": self.limits.keeps(trial), "front": place in self.front}
            for place, trial in enumerate(self.trials)
        ]
        return pd.json_normalize(rows)

    def json(self) -> dict[str, Any]:
        """Return weights in SI, figures in §7's units."""
        found = self.recommendation
        values = {
            "satisfied": self.satisfied,
            "reason": found.reason,
            "recommended": _said(found.trial),
            "own": _said(found.own),
            "spreads": dict(zip(OBJECTIVES, found.spreads.tolist(), strict=True)),
            "by_the_papers_order": weights_json(self.by_order),
            "steps": [
                {"weight": step.weight, "kept": step.kept, **_said(step.trial)}
                for step in self.steps
            ],
            "trials": len(self.trials),
            "usable_trials": sum(self.limits.keeps(trial) for trial in self.trials),
            "front": [{"trial": k, **_said(self.trials[k])} for k in self.front],
        }
        return strict(values)


def weights_json(weights: Weights) -> dict[str, float]:
    """Return weights with their units in the keys."""
    items = zip(weights._asdict().items(), _KEYS, strict=True)
    return {f"{name}{unit}": value for (name, value), unit in items}


def _said(trial: Trial) -> dict[str, Any]:
    return {
        "weights": weights_json(trial.weights),
        **{figure: trial.mean(figure) for figure in OBJECTIVES},
        "converter_peak_mm": 1e3 * trial.converter_peak,
        "pressure_min_mpa": trial.mean("pressure_min_mpa"),
        "pressure_max_mpa": trial.mean("pressure_max_mpa"),
        "unstable": trial.unstable,
    }
