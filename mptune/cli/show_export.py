"""What ``mptune export`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import elsewhere
from mptune.cli.terminal import files, say, show
from mptune.export.controller import WARNING
from mptune.report.blocks import verdict
from mptune.report.content.front import gains, requirements

if TYPE_CHECKING:
    from mptune.job.export import ExportResult


def exported(result: ExportResult) -> None:
    """Print the gains as written, their requirements and the files."""
    controller = result.controller
    line = f"Verdict: {controller.word}: {controller.reason}"
    say(verdict(line, good=controller.trusted))
    carried = controller.source
    say(
        f"The files carry: {controller.word}; margins {controller.verdict}; closed loop on the "
        f"nonlinear machine {carried.closed_loop}. In the gains file: {carried.verdicts}."
    )
    elsewhere(controller.differs)
    written, source = controller.margins.written.gains, controller.source.gains
    show(gains((written,), (source,), "In the gains file"), requirements(controller.margins.checks))
    if not result.files:
        names = ", ".join(check.label for check in controller.margins.broken)
        say(
            verdict("Nothing was written:", good=False),
            f"as written, these requirements no longer hold: {names}.",
        )
        say("Keep more digits (--digits), take --precision double, or tune with a reserve.")
        return
    if not controller.trusted:
        say(verdict(" ".join(WARNING), good=False))
    files(result.files)
