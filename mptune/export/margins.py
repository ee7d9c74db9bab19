"""Margins of the numbers as written, held against those of the gains as tuned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mptune.robust.result import Check, Status
from mptune.robust.sweep import sweep

if TYPE_CHECKING:
    from mptune.export.written import Written
    from mptune.params.controller import Gains
    from mptune.params.study import ResolvedStudy
    from mptune.robust.result import SweepResult

DEVIATION = 1e-4  # of the position controller; ratios, known to 1e-4, move by about as much


@dataclass(frozen=True)
class WrittenMargins:
    """Every requirement before and after writing.

    Attributes
    ----------
    tuned, written
        The sweeps of the gains as tuned, and of what was written.
    fidelity
        Whether the written coefficients are gains at all, closely enough to be swept as such.
    """

    tuned: SweepResult
    written: SweepResult
    fidelity: Check

    @property
    def checks(self) -> tuple[Check, ...]:
        """The requirements of what was written."""
        return (*self.written.checks, self.fidelity)

    @property
    def broken(self) -> tuple[Check, ...]:
        """Requirements that held for the gains as tuned and do not hold as written."""
        held = {check.name for check in self.tuned.checks if check.status is Status.SATISFIED}
        held.add(self.fidelity.name)
        return tuple(
            check
            for check in self.checks
            if check.name in held and check.status is not Status.SATISFIED
        )

    @property
    def satisfied(self) -> bool:
        """Whether what was written meets every requirement."""
        return all(check.status is Status.SATISFIED for check in self.checks)


def written_margins(study: ResolvedStudy, tuned: Gains, written: Written) -> WrittenMargins:
    """Sweep gains as tuned and as written.

    Parameters
    ----------
    study
        The study.
    tuned
        The gains before rounding.
    written
        What the written numbers stand for; their filter counts as well.
    """
    status = Status.SATISFIED if written.deviation <= DEVIATION else Status.VIOLATED
    fidelity = Check(
        "written coefficients against their gains",
        f"≤ {DEVIATION:g}",
        written.deviation,
        status,
        None,
    )
    return WrittenMargins(sweep(study, tuned), sweep(written.study(study), written.gains), fidelity)
