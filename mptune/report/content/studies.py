"""Studies side by side, beside what the paper measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.params.paper import (
    MEASURED_FINAL_ERROR,
    MEASURED_FORCE_ERROR,
    MEASURED_INDEX_RANGE,
    MEASURED_LOSS,
)
from mptune.report.blocks import NOTHING, Cell, Chapter, Figure, Row, Tabular, left, right, wide
from mptune.sim.merit import merit
from mptune.units import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.report.results import Results

OWN, TUNED, PAPER = "own", "tuned", "the paper, measured"
_MACHINE = (
    ("performance_index_ms", 3),
    ("energy_loss_j_per_mm", 3),
    ("force_error_integral_kn2s", 3),
    ("valve_switches", 3),
    ("final_error_mm", 2),
)
_LINEAR = (("gain_margin", 3), ("disk_margin", 2), ("disk_margin_guaranteed", 2))


def studies(results: Results) -> Chapter | None:
    """Return the last stored comparison of this study with others, where one was made."""
    rows = results.leftovers.studies
    if not rows:
        return None
    table = compared_studies(rows)
    return Chapter.of(
        table.title,
        Figure(
            "Energy loss, a calibrated figure, over performance index, a predicted one: open under "
            "a study's own gains, filled under the tuned ones; bars, what §7 measured.",
            "studies",
        ),
        table,
    )


def compared_studies(rows: Sequence[dict[str, Any]]) -> Tabular:
    """Return the table of all studies, gains and masses, the paper's measurements first.

    Parameters
    ----------
    rows
        As ``mptune.job.studies.rows_of`` has them.
    """
    body: list[Row] = [_measured(mass) for mass in sorted(MEASURED_LOSS)]
    body += [_row(one) for one in rows]
    titles = [merit(key).title("\n") for key, _ in _MACHINE]
    columns = [
        wide("Study", 2),
        *left("Gains"),
        *right("Mass\n[t]", *titles, "Gain\nmargin", "Disk\nmargin", "guar-\nanteed"),
        *right("Noise\n[N]"),
    ]
    legend = (
        "Means over oils, seeds and movement sets; final error: the largest. Margins and noise at "
        "F_ref as it runs, of the grid; guaranteed: the disk margin over the whole box. Predicted: "
        "index, switches, final error, margins. Calibrated: loss, force error."
    )
    return Tabular("Studies beside the paper", columns, body, keep=False, legend=legend)


def markdown(table: Tabular) -> str:
    """Return a table in Markdown, its title above and its legend below.

    Parameters
    ----------
    table
        Any table of the report.
    """
    headings = [one.text.replace("-\n", "").replace("\n", " ") for one in table.columns]
    sides = ["--:" if one.align == "right" else "---" for one in table.columns]
    rows = [[str(getattr(cell, "text", cell)) for cell in row] for row in table.rows]
    body = "\n".join(f"| {' | '.join(cells)} |" for cells in (headings, sides, *rows))
    return f"## {table.title}\n\n{body}\n\n{table.legend}\n"


def _measured(mass: float) -> Row:
    """Return what §7 measured on a mass [kg]."""
    least, largest = MEASURED_INDEX_RANGE[mass]
    force = number(MEASURED_FORCE_ERROR, 3) if mass == max(MEASURED_LOSS) else NOTHING
    index = f"{number(1e3 * least, 3)}–{number(1e3 * largest, 3)}"
    figures = (index, number(MEASURED_LOSS[mass], 3), force, NOTHING, f"≤ {MEASURED_FINAL_ERROR:g}")
    return [PAPER, "published", f"{mass / 1e3:g}", *figures, *(NOTHING,) * (len(_LINEAR) + 1)]


def _row(one: dict[str, Any]) -> Row:
    machine: list[str | Cell] = [_text(one[key], digits) for key, digits in _MACHINE]
    if one["stable"] is False:
        machine[0] = Cell("not stable", "bad")
    mass = NOTHING if one["mass_kg"] is None else f"{one['mass_kg'] / 1e3:g}"
    margins = [_text(one[key], digits) for key, digits in _LINEAR]
    return [one["study"], one["gains"], mass, *machine, *margins, _text(one["noise_force_n"], 3)]


def _text(value: float | None, digits: int) -> str:
    return NOTHING if value is None else number(value, digits)
