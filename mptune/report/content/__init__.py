"""What the report says: sections of plain data, each present where its results are.

A further section is a function from ``Results`` to a section, or to None where there is nothing to
show, entered in ``SECTIONS``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mptune.params.gains import now, version
from mptune.report.content.closed_loop import linear_check, nonlinear_machine
from mptune.report.content.controller import controller
from mptune.report.content.front import front_page
from mptune.report.content.identification import identification
from mptune.report.content.loops import gain_chain, inequalities, loop_plots, sensitivities
from mptune.report.content.parameters import ledger, parameters
from mptune.report.content.tradeoff import comparison, front
from mptune.report.content.weights import weights

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from mptune.report.results import Results

SECTIONS: tuple[Callable[[Results], dict[str, Any] | None], ...] = (
    inequalities,
    loop_plots,
    sensitivities,
    gain_chain,
    controller,
    linear_check,
    nonlinear_machine,
    comparison,
    front,
    weights,
    identification,
    parameters,
    ledger,
)


def document(results: Results, figures: Collection[str]) -> dict[str, Any]:
    """Return everything that a template prints; figures that are not there are left out."""
    study = results.study
    made = (make(results) for make in SECTIONS)
    sections = [_with(figures, section) for section in made if section is not None]
    return {
        "title": study.title,
        "study": study.name,
        "version": version(),
        "hash": study.hash(),
        "date": now(),
        "satisfied": results.satisfied,
        "front": front_page(results),
        "sections": [section for section in sections if section["blocks"]],
    }


def _with(figures: Collection[str], section: dict[str, Any]) -> dict[str, Any]:
    blocks = [
        block
        for block in section["blocks"]
        if block["kind"] != "figure" or block["name"] in figures
    ]
    return {**section, "blocks": blocks}
