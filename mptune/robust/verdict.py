"""The study's requirements, held against what a sweep found."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.result import Grounds, Stability
from mptune.loops.broken import FORCE
from mptune.robust.certificates import Certificates, against, margin_against, place_of
from mptune.robust.result import Check, Condition, Status
from mptune.robust.tables import EQUATIONS
from mptune.units import exact

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.requirements import RatioCurve
    from mptune.robust.family import Family
    from mptune.robust.model import LinearModel
    from mptune.robust.place import PlantPoint


_NOISE_UNIT = {"noise_gain": "N/m", "noise_force": "N"}
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
    model: LinearModel,
    conditions: tuple[Condition, Condition],
    true: Family,
    sampled: Family | None,
    noises: dict[str, float],
    proofs: Certificates | None,
) -> tuple[Check, ...]:
    """Return every requirement with its status.

    Parameters
    ----------
    model
        The linear model, with what the study asks for.
    conditions
        Eq. 17 and Eq. 21.
    true
        The true family with the measurement path that the study's model includes.
    sampled
        The true family as it runs; None where some delay leaves no room for the hold.
    noises
        ``"noise_gain"`` [N/m] and ``"noise_force"`` [N].
    proofs
        What is guaranteed over the box; None where measured responses stand in its place.
    """
    requirements = model.requirements
    checks = [
        _ratio_check(condition, limit)
        for condition, limit in zip(conditions, model.limits, strict=True)
        if condition.binding
    ]
    checks.append(_stability_check(true, proofs))
    for key, family, margin in _MARGIN_CHECKS:
        limit = getattr(requirements, key)
        if limit is not None:
            asked = true if family == "true" else sampled
            checks.append(_margin_check(asked, key, margin, limit, proofs))
    for key, noise in noises.items():
        limit = getattr(requirements, key)
        if limit is not None:
            status = Status.SATISFIED if noise <= limit else Status.VIOLATED
            text = f"≤ {exact(limit)} {_NOISE_UNIT[key]}"
            checks.append(Check(key, key, text, noise, status, None))
    return tuple(checks)


def _ratio_check(condition: Condition, limit: float | RatioCurve) -> Check:
    if isinstance(limit, float):
        text, found, at = f"≤ {exact(limit)}", condition.worst_ratio, condition.at
    else:
        text, found, at = "≤ 1 of the curve", condition.worst_use, condition.worst_use_at
    key = f"{condition.name}_ratio"
    label = f"{key} ({EQUATIONS[condition.name]})"
    return Check(key, label, text, found, condition.status, at, condition.grounds)


def _stability_check(true: Family, proofs: Certificates | None) -> Check:
    """Return whether the grid's plants, and all others of the box, are stable."""
    label, count, at = "unstable plants of the true family", true.unstable_count, None
    box = proofs.stable("force_reference", true.path) if proofs else None
    status, grounds = Status.SATISFIED, Grounds.GRID
    if not true.decided.all():
        status, at = Status.UNDECIDED, true.first_unstable()
    elif count:
        status, at = Status.UNSTABLE, true.first_unstable()
    elif box is not None and box.status is Stability.UNSTABLE:
        status, count, at = Status.UNSTABLE, 1, place_of(box.witness)
    elif box is not None and box.status is Stability.UNDECIDED:
        status, grounds, at = Status.UNDECIDED, Grounds.OPEN, place_of(box.suspect)
    elif box is not None and not true.responses:
        grounds = Grounds.CERTIFIED
    return Check("unstable_plants", label, "= 0", count, status, at, grounds)


def _margin_check(
    family: Family | None, key: str, margin: str, limit: float, proofs: Certificates | None
) -> Check:
    least = margin == "gain_margin"
    text = f"{'≥' if least else '≤'} {exact(limit)}"
    if family is None:
        return Check(key, key, text, float("nan"), Status.NOT_EVALUATED, None)
    found, at = family.worst(margin, FORCE)
    if np.isnan(found):
        return Check(key, key, text, found, Status.UNSTABLE, family.first_unstable(), Grounds.GRID)
    guaranteed, grounds = found, Grounds.GRID
    if proofs is not None:
        attained, guaranteed, place, grounds = _certified_margin(proofs, family.path, margin, limit)
        if attained < found if least else attained > found:
            found, at = attained, place
        if family.responses:  # measured members, of which nothing is proved
            guaranteed, grounds = found, Grounds.GRID
    if not np.isfinite(found) and not least:
        return Check(key, key, text, found, Status.UNSTABLE, at, grounds)
    broken = found < limit if least else found > limit
    kept = guaranteed >= limit if least else guaranteed <= limit
    open_or_kept = Status.SATISFIED if kept else Status.UNDECIDED
    return Check(key, key, text, found, Status.VIOLATED if broken else open_or_kept, at, grounds)


def _certified_margin(
    proofs: Certificates, path: str, margin: str, limit: float
) -> tuple[float, float, PlantPoint | None, Grounds]:
    """Return a margin at F_ref as attained and as guaranteed, its place, and what it rests on."""
    if margin == "gain_margin":
        bracket, grounds = margin_against(proofs.problem, margin, limit)
        return bracket.upper, bracket.lower, place_of(bracket.at), grounds
    found = proofs.of("force_reference", path, margin)
    if found is None:
        raise ValueError(f"{margin} with path {path!r} is not among the certificates")
    found, grounds = against(proofs.problem, found, limit)
    return found.attained, found.bound, place_of(found.at), grounds
