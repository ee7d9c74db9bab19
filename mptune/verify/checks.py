"""Requirements on the machine, judged after it ran: no search of gains asks them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.robust.result import Check, Status
from mptune.sim.merit import merit

if TYPE_CHECKING:
    from mptune.verify.result import CaseResult, VerifyResult


class _Demand(NamedTuple):
    """A requirement's key in the study, the figure that it bounds, and the unit of its limit."""

    key: str
    figure: str
    unit: str


_DEMANDS = (
    _Demand("performance_index", "performance_index_ms", "s"),
    _Demand("final_error", "final_error_mm", "m"),
    _Demand("force_error", "force_error_integral_kn2s", "N² s"),
)


def machine_checks(verified: VerifyResult) -> tuple[Check, ...]:
    """Return the study's requirements on the machine, each with its status, in SI.

    What counts is the worst machine: the mean over its movement sets, of the final error the
    largest. A machine whose loop is not stable has none of these figures.

    Parameters
    ----------
    verified
        What a verification found, with the study that asks.
    """
    requirements = verified.study.study.requirements
    return tuple(
        _check(demand, limit, verified)
        for demand in _DEMANDS
        if (limit := getattr(requirements, demand.key)) is not None
    )


def _check(demand: _Demand, limit: float, verified: VerifyResult) -> Check:
    text = f"≤ {limit:g} {demand.unit}"
    lost = next((case for case in verified.cases if not case.stable), None)
    if not verified.cases or lost is not None:
        status = Status.UNSTABLE if lost else Status.NOT_EVALUATED
        return Check(demand.key, _label(demand, lost), text, float("nan"), status, None)
    found = [merit(demand.figure).factor * case.figure(demand.figure) for case in verified.cases]
    worst = int(np.argmax(np.nan_to_num(found, nan=np.inf)))
    status = Status.SATISFIED if found[worst] <= limit else Status.VIOLATED
    return Check(
        demand.key, _label(demand, verified.cases[worst]), text, found[worst], status, None
    )


def _label(demand: _Demand, case: CaseResult | None) -> str:
    """Return what people read: the requirement and the machine that is worst in it."""
    if case is None:
        return f"{demand.key} of the machine"
    delays = "–".join(f"{1e3 * end:g}" for end in dict.fromkeys(case.valve_delay_s))
    return (
        f"{demand.key} of the machine ({case.mass_kg / 1e3:g} t, "
        f"oil {case.oil_bulk_modulus_pa / 1e6:g} MPa, valves {delays} ms, "
        f"load {case.load_force_n / 1e3:g} kN, seed {case.seed})"
    )
