"""What ``mptune run`` prints: the report's first page on one screen, or all the details."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.terminal import files, say, show
from mptune.params.headline import Headline
from mptune.report.blocks import Tabular, verdict
from mptune.report.content.closed_loop import machines, movement_sets
from mptune.report.content.front import NOT_RUN, doubts, front_page, tuning
from mptune.report.content.gain_chain import factors_text, gain_factors
from mptune.report.content.papers_frame import machine_table
from mptune.verify.before_after import in_a_sentence

if TYPE_CHECKING:
    from mptune.job.result import JobResult


def summary(result: JobResult) -> None:
    """Print what matters of a whole job on one screen: gains, requirements, figures, files."""
    from mptune.job.report import found_by

    page, tuned = front_page(found_by(result)), result.tuned
    first, *gained = tuning(tuned)
    run = in_a_sentence(result.changes) if result.verified else NOT_RUN
    say(verdict(first, good=tuned.blocking is None), " ".join(gained))
    judged = result.judgement  # the verdict's own line names the unstable plant
    said = judged.word is Headline.ON_PAPER and judged.witness is not None
    on_stderr = doubts(result.study)
    mind = [] if said else [one for one in page.warnings if one not in on_stderr]
    mind += result.left_out
    frame = [result.papers_frame.brief] if result.papers_frame else []
    for text in (factors_text(result.chain), run, *frame):
        say(text)
    for text in mind:
        say(verdict(text, good=False))
    say("")
    tables = [block for block in page.blocks if isinstance(block, Tabular)]
    if judged.met:  # the first line says that every requirement is
        tables = [table for table in tables if table.title != "Requirements"]
    show(*(table.brief() for table in tables))
    named = {".pdf": 0, ".html": 1, ".toml": 2}
    shown = [path for path in result.files if path.suffix in named]
    files(sorted(shown, key=lambda path: named[path.suffix]))
    others = len(result.files) - len(shown)
    say(f"and {others} figures and data files beside; -v lists them and all the details")


def details(result: JobResult) -> None:
    """Print what the whole job found beyond its tuning."""
    show(movement_sets(result.moves_before, result.moves))
    if result.verified:
        say(in_a_sentence(result.changes))
        if result.papers_frame:
            say(result.papers_frame.headline)
            show(machine_table(result.papers_frame))
        show(machines(result.verified))
    else:
        say(NOT_RUN, "")
    for text in result.left_out:
        say(verdict(text, good=False))
    show(gain_factors(result.chain))
