"""Margins of the numbers as written, held against those of the gains as tuned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mptune.robust.chain import chain
from mptune.robust.headline import judge
from mptune.robust.result import Check, Status
from mptune.robust.sweep import sweep
from mptune.units import exact

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.export.as_written import Written
    from mptune.params.controller import Gains
    from mptune.params.requirements import GainBounds
    from mptune.params.study import ResolvedStudy
    from mptune.robust.headline import Judgement
    from mptune.robust.result import SweepResult

_SLACK = 1e-6  # relative, of bounds on gains: single precision tells numbers no closer apart
DEVIATION = 1e-4  # of the position controller; ratios, known to 1e-4, move by about as much


@dataclass(frozen=True)
class WrittenMargins:
    """Every requirement before and after writing.

    Attributes
    ----------
    tuned, written
        The sweeps of the gains as tuned, and of what was written.
    before, checks
        The requirements of both. As written, it is also one that the coefficients are gains at
        all, closely enough to be swept as such.
    judgement
        The verdict on what was written, on every linear model.
    """

    tuned: SweepResult
    written: SweepResult
    before: tuple[Check, ...]
    checks: tuple[Check, ...]
    judgement: Judgement

    @property
    def broken(self) -> tuple[Check, ...]:
        """Requirements that held for the gains as tuned and do not hold as written."""
        failed = {check.key for check in self.before if check.status is not Status.SATISFIED}
        return tuple(
            check
            for check in self.checks
            if check.key not in failed and check.status is not Status.SATISFIED
        )

    @property
    def satisfied(self) -> bool:
        """Whether the verdict on what was written is *met*."""
        return self.judgement.met


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
    before, after = sweep(study, tuned), sweep(written.study(study), written.gains)
    bounds = study.study.requirements.bounds
    checks = (*after.checks, *_bound_checks(bounds, written.gains), _fidelity(written))
    return WrittenMargins(
        tuned=before,
        written=after,
        before=(*before.checks, *_bound_checks(bounds, tuned)),
        checks=checks,
        judgement=judge(checks, chain(after)),
    )


def _bound_checks(bounds: GainBounds, gains: Gains) -> Iterator[Check]:
    for key, unit, _, _ in gains.quantities():
        bound = getattr(bounds, key)
        if bound is not None:
            (low, high), found = bound, getattr(gains, key)
            kept = low * (1 - _SLACK) <= found <= high * (1 + _SLACK)
            limit = f"{exact(low)} … {exact(high)} {unit if unit != '1' else ''}".rstrip()
            yield Check(key, key, limit, found, _status(kept=kept), None)


def _fidelity(written: Written) -> Check:
    label, kept = "written coefficients against their gains", written.deviation <= DEVIATION
    limit, status = f"≤ {DEVIATION:g}", _status(kept=kept)
    return Check("written_coefficients", label, limit, written.deviation, status, None)


def _status(*, kept: bool) -> Status:
    return Status.SATISFIED if kept else Status.VIOLATED
