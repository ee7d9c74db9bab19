"""What ``mptune systems`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.terminal import say, show
from mptune.report.content.systems import RULE, boundaries, calibrated, compared

if TYPE_CHECKING:
    from mptune.systems.result import SystemsResult


def systems(result: SystemsResult) -> None:
    """Print the comparison, and what was calibrated."""
    rows = result.rows()
    tables = compared(rows).brief(), boundaries(rows), calibrated(rows)
    show(*(table for table in tables if table.rows))  # not every study calibrates
    say(RULE)
