"""The study's requirements, held against what a sweep found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE
from mptune.robust.result import Check, Condition, Family, Status
from mptune.robust.tables import EQUATIONS

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.requirements import RatioCurve, Requirements


def allowed_ratio(limit: float | RatioCurve, omega: FloatArray) -> FloatArray:
    """Return the largest allowed ratio at each frequency, ``(F,)``.

    A curve is interpolated over the logarithm of frequency and held constant beyond its ends.
    """
    if isinstance(limit, float):
        return np.full(len(omega), limit)
    frequency, ratio = np.array(limit).T
    return np.asarray(np.interp(np.log(omega), np.log(frequency), ratio))


def check_requirements(
    requirements: Requirements, conditions: tuple[Condition, Condition], true: Family
) -> tuple[Check, ...]:
    """Return every requirement with its status.

    Parameters
    ----------
    requirements
        What the study asks for.
    conditions
        Eq. 17 and Eq. 21.
    true
        The true family with the measurement path that the study's model includes.
    """
    checks = [
        _ratio_check(condition, limit)
        for condition, limit in zip(
            conditions, (requirements.velocity_ratio, requirements.position_ratio), strict=True
        )
    ]
    checks.append(_stability_check(true))
    for name, limit in (
        ("sensitivity_peak", requirements.sensitivity_peak),
        ("complementary_peak", requirements.complementary_peak),
    ):
        if limit is not None:
            checks.append(_peak_check(true, name, limit))
    for name, limit in (
        ("gain_margin", requirements.gain_margin),
        ("noise_gain", requirements.noise_gain),
    ):
        if limit is not None:
            sign = "≥" if name == "gain_margin" else "≤"
            text = f"{sign} {limit:g}"
            checks.append(Check(name, text, float("nan"), Status.NOT_EVALUATED, None))
    return tuple(checks)


def _ratio_check(condition: Condition, limit: float | RatioCurve) -> Check:
    if isinstance(limit, float):
        text, found, at = f"≤ {limit:g}", condition.worst_ratio, condition.at
    else:
        text, found, at = "≤ 1 of the curve", condition.worst_use, condition.worst_use_at
    name = f"{condition.name}_ratio ({EQUATIONS[condition.name]})"
    return Check(name, text, found, condition.status, at)


def _stability_check(true: Family) -> Check:
    count = true.unstable_count
    if not true.decided.all():
        status = Status.UNDECIDED
    else:
        status = Status.UNSTABLE if count else Status.SATISFIED
    return Check("unstable plants of the true family", "= 0", count, status, true.first_unstable())


def _peak_check(true: Family, name: str, limit: float) -> Check:
    found, at = true.worst(name, FORCE)
    if np.isnan(found):
        return Check(name, f"≤ {limit:g}", found, Status.UNSTABLE, true.first_unstable())
    status = Status.SATISFIED if found <= limit else Status.VIOLATED
    return Check(name, f"≤ {limit:g}", found, status, at)
