"""The report: what it says, put together from its chapters and written for print and browser.

A further chapter is a function from ``Results`` to a chapter, or to None where there is nothing to
show, entered in ``CHAPTERS``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mptune.files import write_whole
from mptune.params.gains import now, version
from mptune.report.blocks import Chapter, Document, Figure, Tabular
from mptune.report.content.certificates import certificates
from mptune.report.content.closed_loop import linear_check, nonlinear_machine
from mptune.report.content.controller import controller
from mptune.report.content.front import front_page
from mptune.report.content.gain_chain import gain_chain
from mptune.report.content.identification import identification
from mptune.report.content.loops import inequalities, loop_plots, sensitivities
from mptune.report.content.papers_frame import papers_frame
from mptune.report.content.parameters import ledger, parameters
from mptune.report.content.studies import studies
from mptune.report.content.systems import systems
from mptune.report.content.tradeoff import comparison, front, margins
from mptune.report.content.weights import weights
from mptune.report.pdf import pdf
from mptune.report.web import web_page

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping
    from pathlib import Path

    from mptune.report.blocks import Block
    from mptune.report.results import Results

CHAPTERS: tuple[Callable[[Results], Chapter | None], ...] = (
    inequalities,
    certificates,
    loop_plots,
    sensitivities,
    gain_chain,
    controller,
    linear_check,
    nonlinear_machine,
    papers_frame,
    comparison,
    front,
    margins,
    weights,
    systems,
    studies,
    identification,
    parameters,
    ledger,
)


def document(results: Results, figures: Collection[str]) -> Document:
    """Return everything that is printed; figures that are not there are left out."""
    study, date, model = results.study, now(), results.study.hash()
    page = front_page(results)
    stamp = f"mptune {version()} · {date} · model {model[:16]}"
    made = (make(results) for make in CHAPTERS)
    chapters = [_with(figures, chapter) for chapter in made if chapter is not None]
    return Document(
        title=study.title,
        running=f"{study.name} · mptune {version()} · model {model[:12]} · {date[:10]}",
        satisfied=results.verdict.met,
        front=replace(
            page, about=(*page.about, stamp), blocks=[_filled(block) for block in page.blocks]
        ),
        chapters=[chapter for chapter in chapters if chapter.blocks],
    )


def _with(figures: Collection[str], chapter: Chapter) -> Chapter:
    blocks = [
        block for block in chapter.blocks if not isinstance(block, Figure) or block.name in figures
    ]
    return replace(chapter, blocks=[_filled(block) for block in blocks])


def _filled(block: Block) -> Block:
    return block.filled() if isinstance(block, Tabular) else block


def write_report(stem: Path, results: Results, figures: Mapping[str, bytes]) -> tuple[Path, Path]:
    """Write the report as PDF and for the browser, each whole or not at all.

    Parameters
    ----------
    stem
        The files without ``.pdf`` and ``.html``.
    results
        What they show.
    figures
        SVG bytes by name.

    Raises
    ------
    OutputError
        If a file cannot be written, or a template does not compile.
    """
    words = document(results, figures)
    folder, name = stem.parent, stem.name
    return (
        write_whole(folder / f"{name}.pdf", pdf(words, figures)),
        write_whole(folder / f"{name}.html", web_page(words, figures)),
    )
