"""Requirements on the loop as it runs: margins, compliance, steps and tracking, each a check.

Margins and compliance carry certified values where the box is certified. Steps and tracking are
judged on the family's plants alone, which can only miss worse ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.certify.result import Grounds
from mptune.robust.certificates import against, margin_against, place_of
from mptune.robust.place import PlantPoint, plant_point
from mptune.robust.result import Check, Status
from mptune.robust.running import RunningFigures, family_figures
from mptune.robust.tracking import family_tracking
from mptune.sim.running import step_figures

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Feedforward
    from mptune.params.packed import LoopGains, Plants
    from mptune.robust.certificates import Certificates
    from mptune.robust.model import LinearModel

_LOWEST = 0.05  # rad/s
_AT_LEAST = ("disk_margin", "phase_margin", "delay_margin")
_OF_LOOPS = (*_AT_LEAST, "peak_compliance")
_UNITS = {"phase_margin": "rad", "delay_margin": "s", "peak_compliance": "m/N"}
_OF_STEPS = ("overshoot", "settling_time")


class _Proved(NamedTuple):
    """A figure over the box: attained where, guaranteed, and what that rests on."""

    attained: float
    guaranteed: float
    at: PlantPoint | None
    grounds: Grounds


def running_checks(
    model: LinearModel,
    gains: LoopGains,
    feedforward: Feedforward,
    proofs: Certificates | None,
) -> tuple[Check, ...]:
    """Return the requirements on the loop as it runs, each with its status.

    Parameters
    ----------
    model
        The linear model, with what the study asks for.
    gains, feedforward
        What is judged.
    proofs
        What is guaranteed over the box; None where nothing is.
    """
    asked = {name: getattr(model.requirements, name) for name in (*_OF_LOOPS, *_OF_STEPS)}
    asked = {name: limit for name, limit in asked.items() if limit is not None}
    checks: list[Check] = []
    if asked and not model.runs:
        nothing = float("nan")
        checks += [_check(name, asked[name], nothing, Status.NOT_EVALUATED) for name in asked]
    elif asked:
        checks += _of_loops(model, gains, asked, proofs)
        checks += _of_steps(model, gains, asked)
    index = model.requirements.tracking_index
    if index is not None:
        peaks = family_tracking(model, gains, feedforward).max(axis=(1, 2))
        sampled = model.study.study.objective.tracking_loop == "sampled"
        plants = model.as_it_runs(gains).plants if sampled else model.plants
        checks.append(_largest("tracking_index", index, peaks, plants, "s"))
    return tuple(checks)


def _of_loops(
    model: LinearModel, gains: LoopGains, asked: dict[str, float], proofs: Certificates | None
) -> list[Check]:
    wanted = [name for name in _OF_LOOPS if name in asked]
    if not wanted:
        return []
    loops = model.as_it_runs(gains)
    figures = family_figures(loops, model.period, _LOWEST)
    return [_of_loop(name, asked[name], figures, loops.plants, proofs) for name in wanted]


def _of_loop(
    name: str,
    limit: float,
    figures: RunningFigures,
    plants: Plants,
    proofs: Certificates | None,
) -> Check:
    values, least = getattr(figures, name), name in _AT_LEAST
    unstable = np.flatnonzero(figures.stable == 0)
    if len(unstable):
        at = plant_point(plants, int(unstable[0]), float("nan"))
        return _check(name, limit, float("nan"), Status.UNSTABLE, at, Grounds.GRID)
    worst = int(np.argmin(values) if least else np.argmax(values))
    key = "compliance_frequency" if not least else name.replace("margin", "frequency")
    found, guaranteed, grounds = float(values[worst]), float(values[worst]), Grounds.GRID
    at = plant_point(plants, worst, float(getattr(figures, key)[worst]))
    if proofs is not None:
        proved = _proved(proofs, name, limit)
        guaranteed, grounds = proved.guaranteed, proved.grounds
        # With delay alone the grid's margin is an approximation, the certificate's is none.
        if name == "delay_margin" or (proved.attained < found) == least:
            found, at = proved.attained, proved.at or at
    if not np.isfinite(found) and not least:
        return _check(name, limit, found, Status.UNSTABLE, at, grounds)
    broken = found < limit if least else found > limit
    kept = guaranteed >= limit if least else guaranteed <= limit
    open_or_kept = Status.SATISFIED if kept else Status.UNDECIDED
    return _check(name, limit, found, Status.VIOLATED if broken else open_or_kept, at, grounds)


def _proved(proofs: Certificates, name: str, limit: float) -> _Proved:
    if name in {"phase_margin", "delay_margin"}:
        bracket, grounds = margin_against(proofs.problem, name, limit)
        return _Proved(bracket.upper, bracket.lower, place_of(bracket.at), grounds)
    found = proofs.of("force_reference", "sampled", name)
    if found is None:
        raise ValueError(f"{name} of the loop as it runs is not among the certificates")
    found, grounds = against(proofs.problem, found, limit)
    return _Proved(found.attained, found.bound, place_of(found.at), grounds)


def _of_steps(model: LinearModel, gains: LoopGains, asked: dict[str, float]) -> list[Check]:
    wanted = [name for name in _OF_STEPS if name in asked]
    if not wanted:
        return []
    loops = model.as_it_runs(gains)
    steps = step_figures(loops, model.period, asked.get("settling_time", 0.0))
    units = {"overshoot": "", "settling_time": "s"}
    return [
        _largest(name, asked[name], getattr(steps, name), loops.plants, units[name])
        for name in wanted
    ]


def _largest(name: str, limit: float, values: FloatArray, plants: Plants, unit: str) -> Check:
    worst = int(np.argmax(np.nan_to_num(values, nan=np.inf)))
    found = float(values[worst])
    status = Status.SATISFIED if found <= limit else Status.VIOLATED
    at = plant_point(plants, worst, float("nan"))
    return Check(name, name, f"≤ {limit:g} {unit}".rstrip(), found, status, at, Grounds.GRID)


def _check(
    name: str,
    limit: float,
    found: float,
    status: Status,
    at: PlantPoint | None = None,
    grounds: Grounds | None = None,
) -> Check:
    sign = "≥" if name in _AT_LEAST else "≤"
    text = f"{sign} {limit:g} {_UNITS.get(name, '')}".rstrip()
    return Check(name, name, text, found, status, at, grounds)
