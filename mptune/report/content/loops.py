"""The frequency domain: both inequalities, what drives them, the loops, and the chain at F_ref."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.loops.broken import FORCE, VELOCITY
from mptune.report.blocks import (
    Block,
    Cell,
    equations,
    figure,
    heading,
    left,
    note,
    prose,
    right,
    section,
    symbol,
    table,
    verdict,
    wide,
)
from mptune.robust.chain import factor_text
from mptune.robust.one_at_a_time import PARAMETERS
from mptune.robust.tables import EQUATIONS, margin_rows, place_text
from mptune.units import number, shown

if TYPE_CHECKING:
    from mptune.report.results import Results
    from mptune.robust.result import Condition

_PATHS = {"none": "without", "filters": "with path"}


def inequalities(results: Results) -> dict[str, Any]:
    """Return Eq. 17 and Eq. 21 over the family, and what drives the worst cases."""
    return section(
        "Both inequalities and step responses",
        prose("Nominal and true velocity plant, the true one with the force loop of Eq. 11:"),
        equations("eq14 eq15", "eq11"),
        prose("Nominal and true position plant, with the velocity loop closed:"),
        equations("eq19"),
        prose(
            "The loops stay stable over the whole family if the nominal closed loop is stable, "
            "nominal and true open loops have equally many unstable poles, and, at all "
            "frequencies ω > 0, the relative error of the plant stays below the right-hand side:"
        ),
        equations("eq16 eq20", "eq17 eq21"),
        figure(
            "panels",
            "Both sides of Eq. 17 and Eq. 21, and the step responses of the linear model with "
            "exact dead time. Band: the family; on the left, all up to its largest. The thin "
            "vertical line marks the worst ratio.",
        ),
        table(
            [
                *left("Gains", "Condition"),
                *right("Ratio", "Margin"),
                wide("Worst at"),
                *left("Nominal", "Poles", "Verdict"),
            ],
            _conditions(results),
            keep=True,
        ),
        note(
            "Ratio: left over right side; margin: its inverse. The premises (nominal closed loop "
            "stable, equally many unstable open-loop poles) are counted by encirclements. A finite "
            "grid of plants and frequencies can only miss higher ratios: the figures err on the "
            "optimistic side, along frequency by less than 10⁻⁴."
        ),
        *_influences(results),
        new_page=True,
    )


def _conditions(results: Results) -> list[list[str | Cell]]:
    swept = {"study's own": results.published}
    if results.tuned is not None:
        swept["tuned"] = results.sweep
    return [
        _condition(label, condition)
        for label, sweep in swept.items()
        for condition in sweep.conditions
    ]


def _condition(label: str, condition: Condition) -> list[str | Cell]:
    limit = "limit of vanishing frequency"
    stable, equal = condition.nominal_stable, condition.poles_equal
    return [
        label,
        EQUATIONS[condition.name],
        f"{condition.worst_ratio:.4f}",
        f"{condition.margin:.3f}",
        Cell(limit if condition.low_frequency_limit else place_text(condition.at), "small"),
        verdict("stable" if stable else "not stable", good=stable),
        verdict("equal" if equal else "unequal", good=equal),
        verdict(condition.status.value, good=condition.satisfied),
    ]


def _influences(results: Results) -> list[Block]:
    if not results.influences:
        return []
    words = {name: (unit, mark, meaning) for name, unit, mark, meaning in PARAMETERS}
    rows: list[list[str | Cell]] = []
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
    return [
        heading("Binding plants and what drives them"),
        table(columns, rows, keep=True),
        note(
            "From each condition's worst plant one parameter at a time is moved to either end of "
            "its range: the worst ratio over frequency there, and how far the lesser one lies "
            "below the worst plant's. The strongest driver stands first."
        ),
    ]


def loop_plots(results: Results) -> dict[str, Any]:
    """Return the loops' Bode and Nyquist plots, encirclements and margins."""
    margins: list[list[str | Cell]] = [
        [symbol(label), *cells] for label, cells in margin_rows(results.sweep)
    ]
    columns = [wide("Margin"), *right("velocity", "with path", "position", "with path")]
    columns += right("at F_ref", "with path", "sampled")
    return section(
        "Bode and Nyquist plots, margins",
        figure(
            "bode",
            "Loop gains over the family: velocity loop, and position loop with the velocity loop "
            "closed. Dotted: the worst plant once median, position filter and Eq. 23 are in the "
            "loop.",
        ),
        figure(
            "nyquist",
            "Nyquist plots of the velocity loop and of the loop broken at F_ref, about the "
            "critical point. Thin: the corners of the family. The circle is where the "
            "sensitivity's magnitude is 2. Positive frequencies only.",
        ),
        *_encirclements(results),
        heading("Worst margins of the true family"),
        table(columns, margins, keep=True),
        note(
            "Smallest or largest over all plants; the delay margin is the least φ(ω)/ω over the "
            "crossovers, α the symmetric disk margin. A dash: some plant is unstable, so that the "
            "family has no such margin. At F_ref: both loops closed, broken at the force "
            "reference; sampled: as the target runs it, held and decided at the sampling period."
        ),
        new_page=True,
    )


def _encirclements(results: Results) -> list[Block]:
    if not results.encirclements:
        return []
    rows: list[list[str | Cell]] = [
        [
            symbol("velocity loop" if one.loop == VELOCITY else "loop at F_ref"),
            _PATHS[one.path],
            verdict(str(one.nominal), good=one.nominal == 0),
            "—" if one.worst is None else verdict(str(one.worst), good=one.worst == 0),
            verdict(str(one.most), good=one.most == 0),
            verdict(f"{one.unstable_plants} of {one.plants}", good=one.unstable_plants == 0),
            str(one.undecided_plants),
        ]
        for one in results.encirclements
    ]
    columns = [wide("Loop"), *left("Measurement path")]
    columns += right("nominal", "worst plant", "most in family", "unstable plants", "undecided")
    return [
        heading("Encirclements of −1"),
        table(columns, rows, keep=True),
        note(
            "Clockwise encirclements over all frequencies, positive and negative. No plant has an "
            "open-loop pole right of the imaginary axis, so these are the unstable closed-loop "
            "poles; each count is certain, or the plant is listed as undecided."
        ),
    ]


def sensitivities(results: Results) -> dict[str, Any]:
    """Return sensitivity functions and the load step."""
    peaks = [
        number(family.worst("sensitivity_peak", FORCE)[0], 3) for family in results.sweep.families
    ]
    return section(
        "Sensitivity functions and load step",
        figure(
            "sensitivity",
            "|S| and |T| of the velocity loop, of the position loop and of the loop at F_ref over "
            "the family. Dotted: the plant with the highest |S| once the measurement path is in "
            "the loop.",
        ),
        prose(
            f"Worst M_S at F_ref over the family: {peaks[0]} without the measurement path, "
            f"{peaks[1]} with it (a dash: some plant is unstable)."
        ),
        figure(
            "load",
            "Position after a step of the load force, per kilonewton, on the linear model with "
            "exact dead time.",
        ),
    )


def gain_chain(results: Results) -> dict[str, Any] | None:
    """Return how far the gain at F_ref may rise, model by model."""
    if not results.chain:
        return None
    rows: list[list[str | Cell]] = [
        [link.name, factor_text(link.factor), Cell(place_text(link.at), "small")]
        for link in results.chain
    ]
    return section(
        "How far the gain at F_ref may rise",
        figure(
            "chain",
            "Factor on K_P,vel, which multiplies all of F_ref, at which stability is lost, or for "
            "Eq. 17 and Eq. 21 no longer guaranteed. Hatched, left of 1: lost as it is.",
        ),
        table([*left("Model"), *right("Factor"), wide("Limited by")], rows, keep=True),
        note(
            "Each model is more complete than the one before; the machine is the study's "
            "verification cases, which are not the family's corners. A finite grid, and on the "
            "machine few movement sets, can only miss what limits sooner: the factors err on the "
            "high side."
        ),
    )
