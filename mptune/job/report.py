"""A run's figures, and its report as PDF and for the browser."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from mptune.job.leftovers import leftovers
from mptune.report.content.closed_loop import machine_figure
from mptune.report.results import Results
from mptune.robust.one_at_a_time import one_at_a_time

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mptune.job.result import JobResult
    from mptune.robust.encirclements import Encirclements


def draw(result: JobResult, counts: tuple[Encirclements, ...]) -> tuple[dict[str, bytes], bytes]:
    """Return the figures of a run as SVG, by name, and the four panels as PNG."""
    from mptune.figures.bode import bode_plots
    from mptune.figures.certificates import certified_worst_cases
    from mptune.figures.chain import gain_chain
    from mptune.figures.machine import machine_traces
    from mptune.figures.moves import move_traces
    from mptune.figures.nyquist import nyquist_plots
    from mptune.figures.panels import four_panels
    from mptune.figures.sensitivity import load_response, sensitivity_functions
    from mptune.figures.style import to_png, to_svg

    swept = result.tuned.sweep
    panels = four_panels(swept)
    figures = {
        "panels": to_svg(panels),
        "bode": to_svg(bode_plots(swept)),
        "nyquist": to_svg(nyquist_plots(swept, counts)),
        "sensitivity": to_svg(sensitivity_functions(swept)),
        "load": to_svg(load_response(swept)),
        "chain": to_svg(gain_chain(result.chain)),
        "moves": to_svg(move_traces(result.moves)),
    }
    if swept.certificates is not None:
        figures["certificates"] = to_svg(certified_worst_cases(swept))
    fed = result.verified.feedforward if result.verified else None
    for case in result.verified.worst_per_mass() if result.verified else ():
        figures[machine_figure(case.mass_kg)] = to_svg(machine_traces(case, fed))
    return figures, to_png(panels)


def report(out: Path, results: Results, figures: Mapping[str, bytes]) -> tuple[Path, Path]:
    """Write the report of what ``results_of`` a run has gathered, figures left behind included.

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    from mptune.report.document import write_report

    drawn = {**figures, **(results.leftovers.figures or {})}
    return write_report(out / results.study.name, results, drawn)


def results_of(out: Path, result: JobResult, counts: tuple[Encirclements, ...]) -> Results:
    """Return what the report of a run shows, with what other commands have left in the folder."""
    return replace(
        found_by(result),
        encirclements=counts,
        influences=one_at_a_time(result.tuned.sweep),
        leftovers=leftovers(out / result.study.name, result.study),
    )


def found_by(result: JobResult) -> Results:
    """Return what a run has found itself, for the report and the terminal."""
    return Results(
        study=result.study,
        sweep=result.tuned.sweep,
        published=result.published,
        feedforward=result.tuned.feedforward,
        tuned=result.tuned,
        moves=result.moves,
        moves_before=result.moves_before,
        verified=result.verified,
        verified_before=result.verified_before,
        chain=result.chain,
        judgement=result.judgement,
        changes=result.changes,
        papers_frame=result.papers_frame,
    )
