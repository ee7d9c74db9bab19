"""The frequency domain: both inequalities, what drives them, the loops, and the chain at F_ref."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE, VELOCITY
from mptune.report.blocks import (
    Cell,
    Chapter,
    Column,
    Figure,
    Note,
    Prose,
    Row,
    Tabular,
    equations,
    left,
    right,
    symbol,
    verdict,
    wide,
)
from mptune.robust.one_at_a_time import PARAMETERS
from mptune.robust.tables import EQUATIONS, margin_rows, place_text
from mptune.units import exact, number, number_beside, shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.report.results import Results
    from mptune.robust.result import Condition, SweepResult

_PATHS = {"none": "without", "filters": "with path", "estimator": "with state estimator"}
_OF_CONDITIONS = (
    "Ratio: largest left over right side, attained; at most: never exceeded. Premises: the nominal "
    "loop is stable, and both plants have as many unstable poles."
)
_OF_MARGINS = (
    "M_S, M_T: peaks of |S| and |T|. Gain margin: factor up to which the loop's gain may rise; "
    "gain reduction: factor down to which it may fall, 0 where as far as one likes. Delay margin: "
    "further dead time. Disk margin α: gain and phase change at once. —: not asked of this model."
)


def inequalities(results: Results) -> Chapter:
    """Return Eq. 17 and Eq. 21 over the family, and what drives the worst cases."""
    swept = {"study's own": results.published}
    if results.tuned is not None:
        swept["tuned"] = results.sweep
    return Chapter.of(
        "Both inequalities and step responses",
        Prose("Nominal and true velocity plant, the true one with the force loop of Eq. 11:"),
        equations("eq14 eq15", "eq11"),
        Prose("Nominal and true position plant, with the velocity loop closed:"),
        equations("eq19"),
        Prose(
            "The loops stay stable over the whole family if the nominal closed loop is stable, "
            "nominal and true open loops have equally many unstable poles, and, at all "
            "frequencies ω > 0, the relative error of the plant stays below the right-hand side:"
        ),
        equations("eq16 eq20", "eq17 eq21"),
        Figure(
            "Both sides of Eq. 17 and Eq. 21, and the step responses of the linear model with "
            "exact dead time. Band: the family; on the left, all up to its largest. The thin "
            "vertical line marks the worst ratio.",
            "panels",
        ),
        conditions(swept),
        Note(
            "Ratio: left over right side; margin: its inverse. The premises (nominal closed loop "
            "stable, equally many unstable open-loop poles) are counted by encirclements. "
            "Certified ratios hold over the whole box and all frequencies, up to the bound beside "
            "them; a grid's can only miss higher ones."
        ),
        *_influences(results).titled(_DRIVEN),
        new_page=True,
    )


def conditions(swept: Mapping[str, SweepResult]) -> Tabular:
    """Return both conditions of one or more sets of gains, by name."""
    rows = [
        [*([label] if len(swept) > 1 else []), *_condition(condition)]
        for label, sweep in swept.items()
        for condition in sweep.conditions
    ]
    columns = left("Gains", "Condition") if len(swept) > 1 else left("Condition")
    columns += [
        *right("Ratio", "at most", "Margin"),
        wide("Worst at"),
        *left("Premises", "Verdict"),
    ]
    return Tabular("Robust stability over the family", columns, rows, legend=_OF_CONDITIONS)


def _condition(condition: Condition) -> list[str | Cell]:
    premises = {
        "nominal loop unstable": condition.nominal_stable,
        "unequal poles": condition.poles_equal,
    }
    broken = ", ".join(words for words, holds in premises.items() if not holds)
    return [
        f"{EQUATIONS[condition.name]} ({condition.name})",
        ratio_text(condition),
        f"{condition.certified.bound:.4f}" if condition.certified else "—",
        f"{condition.margin:.3f}",
        Cell(_worst_at(condition), "small"),
        verdict(broken or "hold", good=not broken),
        verdict(f"{condition.status}, {condition.grounds}", good=condition.satisfied),
    ]


def ratio_text(condition: Condition) -> str:
    """Return a worst ratio for print, with digits enough to differ from a limit that is one."""
    limits = np.unique(condition.allowed)
    beside = exact(float(limits[0])) if len(limits) == 1 else "1"
    text = f"{condition.worst_ratio:.4f}"
    return text if float(text) != float(beside) else number_beside(condition.worst_ratio, beside)


def _worst_at(condition: Condition) -> str:
    limit = condition.low_frequency_limit
    return "limit of vanishing frequency" if limit else place_text(condition.at)


def condition_text(condition: Condition) -> str:
    """Return one condition in a line."""
    return (
        f"{EQUATIONS[condition.name]}: margin {condition.margin:.3f}, worst at "
        f"{_worst_at(condition)}."
    )


def _influences(results: Results) -> Tabular:
    words = {name: (unit, mark, meaning) for name, unit, mark, meaning in PARAMETERS}
    rows: list[Row] = []
    for one in results.influences:
        unit, mark, meaning = words[one.parameter]
        low, high = one.ratios
        worst = max(results.sweep.conditions, key=lambda c: c.name == one.condition).worst_ratio
        rows.append(
            [
                EQUATIONS[one.condition],
                symbol(mark),
                meaning,
                shown(one.worst, unit),
                shown(one.ends, unit, ranged=True),
                f"{low:.4f}",
                f"{high:.4f}",
                f"{max(100 * (1 - min(low, high) / worst), 0):.1f} %",
            ]
        )
    columns = [*left("Condition", ""), wide("Parameter"), *right("Worst plant", "Range")]
    columns += right("Ratio, low end", "high end", "lower by")
    return Tabular("Binding plants and what drives them", columns, rows)


_DRIVEN = Note(
    "From each condition's worst plant one parameter at a time is moved to either end of its "
    "range: the worst ratio over frequency there, and how far the lesser one lies below the worst "
    "plant's. The strongest driver stands first."
)


def loop_plots(results: Results) -> Chapter:
    """Return the loops' Bode and Nyquist plots, encirclements and margins."""
    return Chapter.of(
        "Bode and Nyquist plots, margins",
        Figure(
            "Loop gains over the family: velocity loop, and position loop with the velocity loop "
            "closed. Dotted: the worst plant once median, position filter and Eq. 23 are in the "
            "loop.",
            "bode",
        ),
        Figure(
            "Nyquist plots of the velocity loop and of the loop broken at F_ref, about the "
            "critical point. Thin: the corners of the family. The circle is where the "
            "sensitivity's magnitude is 2. Positive frequencies only.",
            "nyquist",
        ),
        *_encirclements(results).titled(_COUNTED),
        *margins(results.sweep).titled(),
        Note(
            "Smallest or largest over all plants; the delay margin is the least φ(ω)/ω over the "
            "crossovers, α the symmetric disk margin, the compliance the largest |S|/(mω²), "
            "position over load force, which only the loop at F_ref has. Another dash: some plant "
            "is unstable, so that the family has no such margin. At F_ref: both loops closed, "
            "broken at the force reference; sampled: as the target runs it, held and decided at "
            "the sampling period."
        ),
        new_page=True,
    )


def _encirclements(results: Results) -> Tabular:
    rows: list[Row] = [
        [
            symbol("velocity loop" if one.loop == VELOCITY else "loop at F_ref"),
            _PATHS[one.path],
            _none_wanted(one.nominal),
            "—" if one.worst is None else _none_wanted(one.worst),
            _none_wanted(one.most),
            _none_wanted(one.unstable_plants, f" of {one.plants}"),
            str(one.undecided_plants),
        ]
        for one in results.encirclements
    ]
    columns = [wide("Loop"), *left("Measurement path")]
    columns += right("nominal", "worst plant", "most in family", "unstable plants", "undecided")
    return Tabular("Encirclements of −1", columns, rows)


_COUNTED = Note(
    "Clockwise encirclements over all frequencies, positive and negative. No plant has an "
    "open-loop pole right of the imaginary axis, so these are the unstable closed-loop poles; each "
    "count is certain, or the plant is listed as undecided."
)


def _none_wanted(count: int, of: str = "") -> Cell:
    return verdict(f"{count}{of}", good=count == 0)


def margins(swept: SweepResult) -> Tabular:
    """Return the worst margins of the true family, and how many plants are not stable."""
    counts = [
        _none_wanted(int((~(family.stable if loop else family.velocity_stable)).sum()))
        for loop in range(3)
        for family in swept.families
    ]
    sampled = _none_wanted(swept.sampled.unstable_count) if swept.sampled else "—"
    rows: list[Row] = [[symbol(label), *cells] for label, cells in margin_rows(swept)]
    rows.append(["unstable plants", *counts, sampled])
    paths = ("no path", "with path")
    columns = [Column("Margin"), *right(*(f"velocity\n{path}" for path in paths))]
    columns += right(*(f"position\n{path}" for path in paths))
    columns += right(*(f"at F_ref\n{path}" for path in (*paths, "sampled")))
    return Tabular("Worst margins of the true family", columns, rows, legend=_OF_MARGINS)


def sensitivities(results: Results) -> Chapter:
    """Return sensitivity functions and the load step."""
    peaks = [
        number(family.worst("sensitivity_peak", FORCE)[0], 3) for family in results.sweep.families
    ]
    measured = "state estimator" if results.sweep.model.estimated else "measurement path"
    return Chapter.of(
        "Sensitivity functions and load step",
        Figure(
            "|S| and |T| of the velocity loop, of the position loop and of the loop at F_ref over "
            f"the family. Dotted: the plant with the highest |S| once the {measured} is in the "
            "loop.",
            "sensitivity",
        ),
        Prose(
            f"Worst M_S at F_ref over the family: {peaks[0]} without the {measured}, "
            f"{peaks[1]} with it (a dash: some plant is unstable)."
        ),
        Figure(
            "Position after a step of the load force, per kilonewton, on the linear model with "
            "exact dead time.",
            "load",
        ),
    )
