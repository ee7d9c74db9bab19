"""A sweep's figures as texts, for every table that shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.loops.broken import FORCE
from mptune.robust.family import MARGINS
from mptune.units import number

if TYPE_CHECKING:
    from mptune.robust.family import MarginFigure
    from mptune.robust.place import PlantPoint
    from mptune.robust.result import SweepResult

EQUATIONS = {"velocity": "Eq. 17", "position": "Eq. 21"}


def place_text(at: PlantPoint | None) -> str:
    """Return a plant and a frequency in one line for print."""
    return "—" if at is None else at.headline


def undecided_text(sweep: SweepResult) -> str | None:
    """Return which measured responses leave stability undecided, and what would decide it."""
    names: set[str] = set()
    for family in sweep.families:
        first = len(family.decided) - len(family.responses)
        pairs = zip(family.responses, family.decided[first:], strict=True)
        names.update(name for name, decided in pairs if not decided)
    if not names:
        return None
    return (
        f"UNDECIDED around measured {', '.join(sorted(names))}: not taken for stable. The loop has "
        "to be above 2 at the start of the band and below 1/2 at its end, and the measured points "
        "dense enough to tell on which side of the critical point it passes."
    )


def margin_rows(sweep: SweepResult) -> list[tuple[str, list[str]]]:
    """Return a label and seven cells per margin.

    The cells are the worst values of the velocity loop, of the position loop and at F_ref, each
    without and with the measurement path; then at F_ref as it runs, sampled.
    """
    rows = []
    for figure in MARGINS:
        cells = [
            number(figure.factor * family.worst(figure.name, loop)[0], 3)
            for loop in range(3)
            for family in sweep.families
        ]
        rows.append((figure.label, [*cells, _sampled_cell(sweep, figure)]))
    return rows


def _sampled_cell(sweep: SweepResult, figure: MarginFigure) -> str:
    if sweep.sampled is None or figure.name == "delay_margin":
        return "—"
    return number(figure.factor * sweep.sampled.worst(figure.name, FORCE)[0], 3)
