"""The last link of the chain: the nonlinear machine, and how far its gain at F_ref may rise."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from joblib import Parallel, delayed

from mptune.certify.result import Stability
from mptune.progress import silent
from mptune.robust.chain import GAIN_RESERVE, Link, gain_limit
from mptune.verify.verify import cases_of, run_case

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.verify.result import VerifyResult

MACHINE = "nonlinear machine"
_SETS = 3  # per machine; the first one is not judged
_CLOSE = 0.02  # relative width of the bracket: seeds differ by more
_TRIALS = 9  # about as many as a bisection from 1 to a factor below 2 takes


def machine_gain_limit(
    study: ResolvedStudy,
    gains: Gains,
    feedforward: Feedforward,
    progress: Progress = silent,
) -> Link:
    """Return the largest factor on K_P,vel with which every machine still verifies as stable.

    The machines are those of the study's ``[verification]``, each with its first seed and a few
    movement sets: more of them could only lower the factor, so that it errs on the high side.
    """
    return Link(MACHINE, gain_limit(_holds(study, gains, feedforward, progress), _CLOSE), None)


def machine_reserve(verified: VerifyResult, progress: Progress = silent) -> Link:
    """Return the machine's link, searched no further than to the reserve that a verdict asks for.

    The factor is a lower limit where the machines bear the reserve.
    """
    holds = _holds(verified.study, verified.gains, verified.feedforward, progress)
    if not verified.satisfied or holds(GAIN_RESERVE):
        return as_verified(Link(MACHINE, GAIN_RESERVE, None, note="at least"), verified)
    return as_verified(Link(MACHINE, gain_limit(holds, _CLOSE), None), verified)


def as_verified(link: Link, verified: VerifyResult) -> Link:
    """Return the machine's link with what its whole verification found."""
    failed = [case for case in verified.cases if not case.stable]
    if not failed:
        return link
    note = f"{len(failed)} of {len(verified.cases)} runs not stable, such as {failed[0].headline}"
    factor = link.factor if link.factor < 1 else float("nan")  # not even as it is
    return replace(link, factor=factor, stability=Stability.UNSTABLE, note=note)


def _holds(
    study: ResolvedStudy, gains: Gains, feedforward: Feedforward, progress: Progress
) -> Callable[[float], bool]:
    """Return what tells of a factor on K_P,vel whether every machine is stable with it."""
    asked = study.study.verification
    fewer = asked.model_copy(update={"repeats": min(_SETS, asked.repeats)})
    short = study.model_copy(
        update={"study": study.study.model_copy(update={"verification": fewer})}
    )
    cases = [case for case in cases_of(short) if case.seed == asked.seeds[0]]
    trials = 0

    def holds(factor: float) -> bool:
        nonlocal trials
        trials += 1
        progress("chain", min(trials / _TRIALS, 1.0))
        scaled = gains.model_copy(update={"k_p_vel": factor * gains.k_p_vel})
        jobs = (delayed(run_case)(short, case, scaled, feedforward) for case in cases)
        return all(one.stable for one in Parallel(n_jobs=-1, prefer="threads")(jobs))

    return holds
