"""The study's requirements, held against what a sweep found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE
from mptune.robust.result import Check, Condition, Status
from mptune.robust.tables import EQUATIONS

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.requirements import RatioCurve, Requirements
    from mptune.robust.family import Family


_MARGIN_CHECKS = (  # key of the requirement, family that it holds for, margin
    ("sensitivity_peak", "true", "sensitivity_peak"),
    ("complementary_peak", "true", "complementary_peak"),
    ("sampled_sensitivity_peak", "sampled", "sensitivity_peak"),
    ("gain_margin", "sampled", "gain_margin"),
)


def allowed_ratio(limit: float | RatioCurve, omega: FloatArray) -> FloatArray:
    """Return the largest allowed ratio at each frequency, ``(F,)``.

    A curve is interpolated over the logarithm of frequency and held constant beyond its ends.
    """
    if isinstance(limit, float):
        return np.full(len(omega), limit)
    frequency, ratio = np.array(limit).T
    return np.asarray(np.interp(np.log(omega), np.log(frequency), ratio))


def check_requirements(
    requirements: Requirements,
    conditions: tuple[Condition, Condition],
    true: Family,
    sampled: Family | None,
    noise: float,
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
    sampled
        The true family as it runs; None where some delay leaves no room for the hold.
    noise
        The noise gain [N/m].
    """
    checks = [
        _ratio_check(condition, limit)
        for condition, limit in zip(
            conditions, (requirements.velocity_ratio, requirements.position_ratio), strict=True
        )
    ]
    checks.append(_stability_check(true))
    for name, family, margin in _MARGIN_CHECKS:
        limit = getattr(requirements, name)
        if limit is not None:
            found = true if family == "true" else sampled
            checks.append(_margin_check(found, name, margin, limit))
    if requirements.noise_gain is not None:
        met = noise <= requirements.noise_gain
        status = Status.SATISFIED if met else Status.VIOLATED
        limit = f"≤ {requirements.noise_gain:.4g}"
        checks.append(Check("noise_gain", "noise_gain", limit, noise, status, None))
    return tuple(checks)


def _ratio_check(condition: Condition, limit: float | RatioCurve) -> Check:
    if isinstance(limit, float):
        text, found, at = f"≤ {limit:g}", condition.worst_ratio, condition.at
    else:
        text, found, at = "≤ 1 of the curve", condition.worst_use, condition.worst_use_at
    key = f"{condition.name}_ratio"
    label = f"{key} ({EQUATIONS[condition.name]})"
    return Check(key, label, text, found, condition.status, at)


def _stability_check(true: Family) -> Check:
    count = true.unstable_count
    if not true.decided.all():
        status = Status.UNDECIDED
    else:
        status = Status.UNSTABLE if count else Status.SATISFIED
    label = "unstable plants of the true family"
    return Check("unstable_plants", label, "= 0", count, status, true.first_unstable())


def _margin_check(family: Family | None, key: str, margin: str, limit: float) -> Check:
    least = margin == "gain_margin"
    text = f"{'≥' if least else '≤'} {limit:g}"
    if family is None:
        return Check(key, key, text, float("nan"), Status.NOT_EVALUATED, None)
    found, at = family.worst(margin, FORCE)
    if np.isnan(found):
        return Check(key, key, text, found, Status.UNSTABLE, family.first_unstable())
    met = found >= limit if least else found <= limit
    return Check(key, key, text, found, Status.SATISFIED if met else Status.VIOLATED, at)
