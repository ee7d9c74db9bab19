"""The comparison: every system by its literature's controller and the best one, on every mass."""

from __future__ import annotations

from functools import partial
from itertools import product
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from mptune.progress import silent
from mptune.systems.bench import LoadCase
from mptune.systems.outcome import INDEX, LOSS
from mptune.systems.result import CalibratedValue, SystemRun, SystemsResult
from mptune.systems.rule import best_of, candidates, judged

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.systems.contender import Contender, Tuned
    from mptune.systems.outcome import Outcome

CHANGE = 0.2  # of a calibrated value, down and up
_T = TypeVar("_T")


def load_cases(study: ResolvedStudy) -> tuple[LoadCase, ...]:
    """Return a case per mass: the middle one of the oils, the first load force and seed."""
    asked = study.study.verification
    oils = sorted(asked.oil_bulk_moduli)
    oil = oils[len(oils) // 2]
    repeats = study.study.systems.repeats
    return tuple(
        LoadCase(mass, oil, asked.load_forces[0], asked.seeds[0], repeats) for mass in asked.masses
    )


def contest(
    study: ResolvedStudy,
    build: Callable[[ResolvedStudy], Iterable[Contender]],
    progress: Progress = silent,
) -> SystemsResult:
    """Find each system's best controller, run everything, vary what was calibrated.

    Parameters
    ----------
    study
        The study.
    build
        Returns the systems of a study.
    progress
        Told of the stages ``"best controllers"``, ``"systems"`` and ``"calibrated values"``.
    """
    cases, entrants = load_cases(study), tuple(build(study))
    margin = study.study.systems.gain_margin
    tried = [one for contender in entrants for one in candidates(contender)]
    worsts = _all(
        [partial(judged, one, cases, margin) for one in tried], progress, "best controllers"
    )
    shown: list[tuple[Contender, Tuned, bool]] = []
    for contender in entrants:
        count = len(candidates(contender))
        mine, worsts = worsts[:count], worsts[count:]
        best = best_of(contender, mine)
        shown.append((contender, contender.literature, best is contender.literature))
        if best is not None and best is not contender.literature:
            shown.append((contender, best, True))
    pairs = list(product(shown, cases))
    outcomes = _all(
        [partial(tuned.run, case, 1.0) for (_, tuned, _), case in pairs],
        progress,
        "systems",
    )
    runs = tuple(
        SystemRun(
            contender.key, contender.title, contender.boundary, tuned.name, tuned.gains, best,
            case.mass, outcome,
        )
        for ((contender, tuned, best), case), outcome in zip(pairs, outcomes, strict=True)
    )  # fmt: skip
    return SystemsResult(study, runs, _calibrated(study, build, runs, cases, progress))


def _calibrated(
    study: ResolvedStudy,
    build: Callable[[ResolvedStudy], Iterable[Contender]],
    runs: Sequence[SystemRun],
    cases: Sequence[LoadCase],
    progress: Progress,
) -> tuple[CalibratedValue, ...]:
    """Return every calibrated value with the figures about it: largest mass, literature's gains."""
    heaviest = max(cases, key=lambda case: case.mass)
    keys = calibrated_keys(study)
    changed = [
        with_value(study, key, factor) for key in keys for factor in (1 - CHANGE, 1 + CHANGE)
    ]
    jobs = []
    for key, other in zip(np.repeat(keys, 2), changed, strict=True):
        name = str(key).split(".")[1]
        contender = next(one for one in build(other) if one.key == name)
        jobs.append(partial(contender.literature.run, heaviest, 1.0))
    outcomes = _all(jobs, progress, "calibrated values")
    found = []
    for number, key in enumerate(keys):
        low, high = outcomes[2 * number : 2 * number + 2]
        own = next(
            run.outcome
            for run in runs
            if run.key == key.split(".")[1] and run.mass_kg == heaviest.mass
        )
        three = (low, own, high)
        value, unit = _value_and_unit(study, key)
        found.append(
            CalibratedValue(
                key, value, unit, study.study.source_of(key), CHANGE,
                _three(three, INDEX), _three(three, LOSS),
            )
        )  # fmt: skip
    return tuple(found)


def _three(outcomes: Sequence[Outcome], figure: str) -> tuple[float, float, float]:
    low, own, high = (one.mean(figure) if one.stable else np.nan for one in outcomes)
    return low, own, high


def calibrated_keys(study: ResolvedStudy) -> tuple[str, ...]:
    """Return the keys of all single values of ``[systems]`` that are calibrated."""
    keys = (
        f"systems.{name}.{key}"
        for name, part in study.study.systems.parts().items()
        for key, *_ in part.quantities()
    )
    return tuple(key for key in keys if study.study.source_of(key).startswith("calibrated"))


def with_value(study: ResolvedStudy, key: str, factor: float) -> ResolvedStudy:
    """Return the study with one value of ``[systems]`` times a factor."""
    _, name, field = key.split(".")
    part = getattr(study.study.systems, name)
    part = part.model_copy(update={field: factor * getattr(part, field)})
    systems = study.study.systems.model_copy(update={name: part})
    return study.model_copy(update={"study": study.study.model_copy(update={"systems": systems})})


def _value_and_unit(study: ResolvedStudy, key: str) -> tuple[float, str]:
    _, name, field = key.split(".")
    part = getattr(study.study.systems, name)
    unit = next(unit for one, unit, *_ in part.quantities() if one == field)
    return float(getattr(part, field)), unit


def _all(jobs: Sequence[Callable[[], _T]], progress: Progress, stage: str) -> list[_T]:
    """Run jobs on all cores and return what they return, in their order."""
    from joblib import Parallel, delayed

    found: list[_T] = []
    progress(stage, 0.0)
    made = Parallel(n_jobs=-1, prefer="threads", return_as="generator")(
        delayed(job)() for job in jobs
    )
    for one in made:
        found.append(one)
        progress(stage, len(found) / len(jobs))
    return found
