"""Runs of a campaign, one by one: what workers do, here or on a cluster."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.campaign.draw import rig_of_draw
from mptune.campaign.plan import noise_of
from mptune.errors import MptuneError
from mptune.params.campaign import CampaignLimits
from mptune.params.gains import version
from mptune.sim.merit import MERITS
from mptune.verify.result import CaseStatus
from mptune.verify.verify import run_rig

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.arrays import FloatArray
    from mptune.campaign.draw import Draw
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy
    from mptune.verify.result import CaseResult

# §7's figures of a run, in §7's units: means over its sets, or the worst of them.
FIGURES = tuple(one.key for one in MERITS)
ERROR = "error"  # the status of a run that could not be simulated
_LIMITED = tuple(one for one in MERITS if one.name in CampaignLimits.model_fields)


class Controlled(NamedTuple):
    """What every run of a campaign shares."""

    study: ResolvedStudy
    gains: Gains
    feedforward: Feedforward


class RunRows(NamedTuple):
    """Runs as they are stored."""

    number: list[int]
    figures: FloatArray  # (b, 15) in the order of FIGURES; NaN where there are none
    status: list[str]
    reason: list[str]  # why a run failed; empty where it did not


def simulate(shared: Controlled, draw: Draw, index: int) -> CaseResult:
    """Run one draw, exactly as any other time that the same run is made."""
    study = shared.study
    asked = study.study.campaign
    case, rig = rig_of_draw(study, draw, shared.gains, shared.feedforward, index)
    return run_rig(study, case, rig, noise_of(asked.seed, index), asked.sets)


def simulate_rows(
    shared: Controlled, draws: Iterable[tuple[int, Draw]], wanted_version: str
) -> RunRows:
    """Run some draws.

    Raises
    ------
    MptuneError
        If this worker has another version of mptune than the one that sent the work.
    """
    if version() != wanted_version:
        raise MptuneError(
            f"a worker has mptune {version()} where {wanted_version} is needed; install the same "
            "version on every worker"
        )
    numbers, figures, status, reason = [], [], [], []
    for number, draw in draws:
        numbers.append(number)
        try:
            case = simulate(shared, draw, number)
        except (ArithmeticError, ValueError) as error:
            figures.append(np.full(len(FIGURES), np.nan))
            status.append(ERROR)
            reason.append(f"{type(error).__name__}: {error}")
            continue
        figures.append(figures_of(case))
        status.append(case.status.value)
        reason.append(reason_of(case, shared.study.study.campaign.limits))
    return RunRows(numbers, np.array(figures).reshape(-1, len(FIGURES)), status, reason)


def figures_of(case: CaseResult) -> FloatArray:
    """Return a run's figures ``(15,)``."""
    return np.array([case.figure(name) for name in FIGURES], np.float64)


def reason_of(case: CaseResult, limits: CampaignLimits) -> str:
    """Return why a run has failed; nothing where it has not."""
    if case.status is not CaseStatus.STABLE:
        where = f": {case.broken} from {case.broken_at_s:.2f} s on" if case.broken else ""
        return f"{case.status.value}{where}"
    for one in _LIMITED:
        limit, found = getattr(limits, one.name), case.figure(one.key)
        if limit is not None and not found * one.factor <= limit:
            unit = one.printed_unit
            return f"{one.name} {found:.4g} {unit} is above {limit / one.factor:.4g} {unit}"
    return ""
