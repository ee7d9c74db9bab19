"""What the paper's own frame alone would give on the machine: a comparison, not the result."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.report.blocks import Chapter, Note, Prose, Row, Tabular, left, right
from mptune.report.content.before_after import heading, pair_text
from mptune.verify.before_after import FIGURES

if TYPE_CHECKING:
    from mptune.report.results import Results
    from mptune.verify.beside import PapersFrame


def papers_frame(results: Results) -> Chapter | None:
    """Return gains tuned in the paper's own frame, on the machine beside the study's own."""
    frame = results.papers_frame
    if frame is None:
        return None
    table = machine_table(frame)
    return Chapter.of(
        table.title,
        Prose(f"{frame.headline}"),
        table,
        Note(
            "The same machines with the same seeds, the first movement sets of each. The "
            "continuous loop knows neither filters nor sampling nor sensor noise, so that what is "
            "gained there is lost on the machine."
        ),
    )


def machine_table(frame: PapersFrame) -> Tabular:
    """Return each figure of each mass, with the study's own gains and with those."""
    by_place = {(one.key, one.mass_kg): one for one in frame.changes}
    masses = sorted({mass for _, mass in by_place})
    rows: list[Row] = [
        [heading(key), *(pair_text(by_place[key, mass]) for mass in masses)] for key in FIGURES
    ]
    columns = left("Study's own → tuned so") + right(*(f"{mass / 1e3:g} t" for mass in masses))
    return Tabular("Tuned in the paper's own frame", columns, rows)
