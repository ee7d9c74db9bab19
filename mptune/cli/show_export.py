"""What ``mptune export`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, files, gains, requirements, verdict
from mptune.export.controller import WARNING

if TYPE_CHECKING:
    from mptune.job.export import ExportResult


def exported(result: ExportResult) -> None:
    """Print the gains as written, their requirements and the files."""
    controller = result.controller
    gains(controller.margins.written.gains, controller.source.gains, "in the gains file")
    requirements(controller.margins.checks)
    if not result.files:
        names = ", ".join(check.label for check in controller.margins.broken)
        console.print(verdict("Nothing was written:", good=False), end=" ")
        console.print(f"as written, these requirements no longer hold: {names}.")
        console.print(
            "Keep more digits (--digits), take --precision double, or tune with a reserve."
        )
        return
    if not controller.trusted:
        console.print(verdict(" ".join(WARNING), good=False))
    files(result.files)
