"""A run's figures, and its report as PDF and for the browser."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from mptune.job.leftovers import leftovers
from mptune.report.content.closed_loop import machine_figure
from mptune.report.results import Results
from mptune.robust.encirclements import encirclements
from mptune.robust.one_at_a_time import one_at_a_time

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mptune.job.result import JobResult
    from mptune.robust.chain import Link
    from mptune.robust.encirclements import Encirclements
    from mptune.robust.one_at_a_time import Influence
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.verify.result import VerifyResult


class LinearPart(NamedTuple):
    """What the report shows of the linear models, ready before the machine has run.

    Attributes
    ----------
    counts
        Encirclements of the loops drawn.
    influences
        What drives each worst case.
    figures
        SVG by name.
    picture
        The four panels as PNG.
    """

    counts: tuple[Encirclements, ...]
    influences: tuple[Influence, ...]
    figures: dict[str, bytes]
    picture: bytes


def linear_part(swept: SweepResult, moves: tuple[LinearMove, ...]) -> LinearPart:
    """Return what the report shows of the linear models.

    It may be made in a thread beside the simulation, which runs none of the kernels that it uses:
    those with threads of their own must not run twice at once.
    """
    from mptune.figures.bode import bode_plots
    from mptune.figures.certificates import certified_worst_cases
    from mptune.figures.moves import move_traces
    from mptune.figures.nyquist import nyquist_plots
    from mptune.figures.panels import four_panels
    from mptune.figures.sensitivity import load_response, sensitivity_functions
    from mptune.figures.style import to_png, to_svg

    counts, panels = encirclements(swept), four_panels(swept)
    figures = {
        "panels": to_svg(panels),
        "bode": to_svg(bode_plots(swept)),
        "nyquist": to_svg(nyquist_plots(swept, counts)),
        "sensitivity": to_svg(sensitivity_functions(swept)),
        "load": to_svg(load_response(swept)),
        "moves": to_svg(move_traces(moves)),
    }
    if swept.certificates is not None:
        figures["certificates"] = to_svg(certified_worst_cases(swept))
    return LinearPart(counts, one_at_a_time(swept), figures, to_png(panels))


def draw_chain(links: tuple[Link, ...]) -> dict[str, bytes]:
    """Return the chain of gain factors as SVG, by name."""
    from mptune.figures.chain import gain_chain
    from mptune.figures.style import to_svg

    return {"chain": to_svg(gain_chain(links))}


def draw_machine(verified: VerifyResult) -> dict[str, bytes]:
    """Return the worst machine of each mass as SVG, by name."""
    from mptune.figures.machine import machine_traces
    from mptune.figures.style import to_svg

    return {
        machine_figure(case.mass_kg): to_svg(machine_traces(case, verified.feedforward))
        for case in verified.worst_per_mass()
    }


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


def results_of(out: Path, result: JobResult, linear: LinearPart) -> Results:
    """Return what the report of a run shows, with what other commands have left in the folder."""
    return replace(
        found_by(result),
        encirclements=linear.counts,
        influences=linear.influences,
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
