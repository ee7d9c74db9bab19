"""What a campaign found: every run's parameters, figures and fate."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mptune.campaign.draw import PARAMETER_UNITS
from mptune.campaign.guarantee import Guarantee, guarantee
from mptune.campaign.simulate import FIGURES
from mptune.interop import Drawn, Labelled
from mptune.sim.judge import per_year
from mptune.sim.merit import merit
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.verify.result import CaseStatus

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.arrays import BoolArray, FloatArray
    from mptune.campaign.draw import Draw
    from mptune.campaign.plan import Plan

QUANTILES = (0.0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
_LISTED = 100  # failed runs by number; the file holds them all
_KEY_UNITS = {"kg": "_kg", "s": "_s", "Pa": "_pa", "N": "_n", "K": "_k", "m": "_m", "1": ""}


@dataclass(frozen=True, repr=False)
class CampaignResult(Summarised, Drawn, Labelled):
    """All runs of a campaign, in the order of their numbers.

    Attributes
    ----------
    plan
        What was run; its ``points`` hold the parameters.
    figures
        ``(R, 15)`` in the order of ``FIGURES``, §7's units; NaN where a run has none.
    status, reason
        ``(R,)`` how each closed loop behaved, and why a run failed (empty where it did not).
    """

    drawings: ClassVar[Mapping[str, str]] = {
        "distributions": "mptune.figures.campaign:campaign_figure"
    }
    dataset: ClassVar[str] = "mptune.campaign.store:to_dataset"

    plan: Plan
    figures: FloatArray
    status: np.ndarray[tuple[int], np.dtype[np.str_]]
    reason: np.ndarray[tuple[int], np.dtype[np.str_]]

    @property
    def headline(self) -> str:
        """How many runs failed, and what that guarantees."""
        text = f"{self.plan.headline}: {self.failures} failed"
        found = self.guarantee
        if found is None:
            return text
        bound = f"{found.failure_probability:.3g} with doubt {found.doubt:g}"
        return f"{text}, failure probability below {bound}"

    def to_pandas(self) -> pd.DataFrame:
        """Return one row per run: its parameters in SI, figures in §7's units, status, reason."""
        frame: pd.DataFrame = self.to_xarray().to_dataframe()
        return frame

    @property
    def failed(self) -> BoolArray:
        """Which runs failed, ``(R,)``."""
        return np.asarray(self.reason != "")

    @property
    def failures(self) -> int:
        """How many runs failed."""
        return int(self.failed.sum())

    @property
    def guarantee(self) -> Guarantee | None:
        """What the runs say about the probability to fail; None where they are no random draws."""
        asked = self.plan.study.study.campaign
        if asked.method != "monte carlo":
            return None
        return guarantee(self.plan.runs, self.failures, asked.doubt)

    @property
    def satisfied(self) -> bool:
        """Whether the wanted failure probability is undercut, or no run failed where none is."""
        wanted = self.plan.study.study.campaign.failure_probability
        found = self.guarantee
        if wanted is None or found is None:
            return self.failures == 0
        return found.failure_probability <= wanted

    def column(self, figure: str) -> FloatArray:
        """Return one figure of every run, ``(R,)``."""
        return np.asarray(self.figures[:, FIGURES.index(figure)])

    def quantiles(self, figure: str) -> FloatArray:
        """Return a figure's quantiles over the runs that have it, as ``QUANTILES`` lists them."""
        values = self.column(figure)
        values = values[np.isfinite(values)]
        if not len(values):
            return np.full(len(QUANTILES), np.nan)
        return np.asarray(np.quantile(values, QUANTILES))

    def worst_run(self, figure: str) -> int | None:
        """Return the number of the run with the worst value of a figure; None where none has it."""
        values = self.column(figure)
        values = np.where(np.isfinite(values), values, np.nan)
        if np.isnan(values).all():
            return None
        return int(np.nanargmax(merit(figure).badness(values)))

    @property
    def busiest_per_year(self) -> float:
        """The most switches of one valve in a year at the study's duty, over all runs."""
        worst = float(self.quantiles("busiest_valve_per_s")[-1])
        return per_year(worst, self.plan.study.study.verification.duty)

    def correlations(self, figure: str) -> dict[str, float]:
        """Return Spearman's rank correlation of each parameter that varies with a figure.

        Over the runs that have the figure; NaN where it is the same in all. In R independent runs
        chance alone stays below 2/√R in about 95 of 100 cases.
        """
        from scipy.stats import rankdata

        values, places = self.column(figure), self.plan.box.varying
        has = np.isfinite(values)
        ranks = rankdata(np.column_stack([values, self.plan.points[:, places]])[has], axis=0)
        ranks = ranks - ranks.mean(axis=0) if len(ranks) else ranks
        scale = np.sqrt((ranks**2).sum(axis=0))
        with np.errstate(invalid="ignore"):
            found = ranks[:, 0] @ ranks[:, 1:] / (scale[0] * scale[1:])
        return dict(zip(self.plan.box.names, map(float, found), strict=True))

    def reasons(self) -> dict[str, int]:
        """Return how many runs failed in which way, most frequent first."""
        kinds = Counter(
            str(status) if status != CaseStatus.STABLE else f"{reason.split()[0]} above its limit"
            for status, reason in zip(self.status, self.reason, strict=True)
            if reason
        )
        return dict(kinds.most_common())

    def json(self) -> dict[str, Any]:
        """Return what the campaign concludes; figures keep §7's units."""
        asked, box, found = self.plan.study.study.campaign, self.plan.box, self.guarantee
        values = {
            "satisfied": self.satisfied,
            "identity": self.plan.identity(),
            "method": asked.method,
            "seed": asked.seed,
            "runs": self.plan.runs,
            "failures": self.failures,
            "reasons": self.reasons(),
            "first_failures": np.flatnonzero(self.failed)[:_LISTED].tolist(),
            "guarantee": found._asdict() if found else None,
            "parameters": {
                f"{name}{_KEY_UNITS[unit]}": [float(low), float(high)]
                for (name, unit), low, high in zip(
                    PARAMETER_UNITS.items(), box.low, box.high, strict=True
                )
            },
            "figures": {figure: self._figure_json(figure) for figure in FIGURES},
            "duty": self.plan.study.study.verification.duty,
            "busiest_valve_per_year": self.busiest_per_year,
        }
        return strict(values)

    def _figure_json(self, figure: str) -> dict[str, Any]:
        worst = self.worst_run(figure)
        shares = [f"{share:g}" for share in QUANTILES]
        return {
            "quantiles": dict(zip(shares, self.quantiles(figure).tolist(), strict=True)),
            "worst_run": worst,
            "worst": None if worst is None else float(self.column(figure)[worst]),
            "worst_at": None if worst is None else draw_json(self.plan.draw(worst)),
            "rank_correlations": self.correlations(figure),
        }


def draw_json(draw: Draw) -> dict[str, float]:
    """Return the parameters of one run in SI, units in the keys; factors have none."""
    return {
        f"{name}{_KEY_UNITS[unit]}": value
        for (name, unit), value in zip(PARAMETER_UNITS.items(), draw, strict=True)
    }
