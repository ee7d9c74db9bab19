"""A campaign's distributions, its worst runs, and which parameter goes with which figure."""

from __future__ import annotations

from itertools import zip_longest
from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.style import LIMIT, NOMINAL, WORST, legend_below, new_figure, style
from mptune.sim.merit import OF_CONVERTERS, TABULATED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from mptune.campaign.result import CampaignResult
    from mptune.sim.merit import Merit


def campaign_figure(result: CampaignResult) -> Figure:
    """Draw the distribution of up to six figures, and below the rank correlations."""
    with style():
        varying = result.plan.box.names
        figure = new_figure(4.6 + 0.24 * len(varying))
        heights = 4.4, 0.7 + 0.24 * len(varying)
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=heights)[:, 0]
        axes = upper.subplots(2, 3, sharey=True)
        for one, shown in zip_longest(axes.ravel(), _shown(result)):
            if shown is None:
                one.set_axis_off()
            else:
                _distribution(one, result, shown)
        for one in axes[:, 0]:
            one.set_ylabel("Share of runs [–]")
        axes[0, 0].set_title(f"{result.plan.runs} runs, {result.failures} failed", loc="left")
        legend_below(upper, axes[0, 0])
        if varying:
            _ranks(lower.subplots(), result)
    return figure


def _shown(result: CampaignResult) -> list[Merit]:
    """Return what is drawn: nothing of converters where there are none."""
    converters = result.plan.study.study.converters
    return [one for one in TABULATED if converters or one is not OF_CONVERTERS]


def _distribution(axes: Axes, result: CampaignResult, shown: Merit) -> None:
    values = result.column(shown.key)
    values = np.sort(values[np.isfinite(values)])
    shares = np.arange(1, len(values) + 1) / max(len(values), 1)
    axes.step(values, shares, where="post", label="share at or below", **NOMINAL)
    if len(values):
        worst = {**WORST, "linestyle": "", "marker": "v", "markersize": 5}
        axes.plot(values[-1:], shares[-1:], label="worst run", clip_on=False, **worst)
    limit = np.quantile(values, 0.95) if len(values) else np.nan
    axes.axvline(limit, label="95 % of runs", **{**LIMIT, "linewidth": 0.9})
    axes.set(xlabel=shown.axis, ylim=(0, 1))


def _ranks(axes: Axes, result: CampaignResult) -> None:
    """Draw rank correlations as a map with its numbers written in."""
    names = result.plan.box.names
    figures = _shown(result)
    columns = [list(result.correlations(one.key).values()) for one in figures]
    table = np.array(columns).T
    axes.imshow(np.abs(table), cmap="Greys", vmin=0, vmax=1.6, aspect="auto")
    for (row, column), value in np.ndenumerate(table):
        text = "–" if np.isnan(value) else f"{value:+.2f}"
        axes.text(column, row, text, ha="center", va="center", fontsize=7.5)
    axes.set_xticks(range(len(columns)), [one.short for one in figures])
    axes.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    axes.grid(visible=False)
    axes.tick_params(length=0)
    axes.set_title("Rank correlation of parameter and figure", loc="left")
