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
    from mptune.progress import Progress
    from mptune.verify.result import VerifyResult
    from mptune.verify.verify import Case

MACHINE = "nonlinear machine"
_SETS = 3  # per machine; the first one is not judged
_CLOSE = 0.02  # relative width of the bracket: seeds differ by more
_TRIALS = 9  # about as many as a bisection from 1 to a factor below 2 takes


def machine_gain_limit(verified: VerifyResult, progress: Progress = silent) -> Link:
    """Return the largest factor on K_P,vel with which every machine still verifies as stable.

    The machines are those of the study's ``[verification]``, each with its first seed and a few
    movement sets: more of them could only lower the factor, so that it errs on the high side.
    """
    return Link(MACHINE, gain_limit(_Trials(verified, progress).hold, _CLOSE), None)


def machine_reserve(verified: VerifyResult, progress: Progress = silent) -> Link:
    """Return the machine's link, searched no further than to the reserve that a verdict asks for.

    The factor is a lower limit where the machines bear the reserve.
    """
    trials = _Trials(verified, progress)
    if not verified.satisfied or trials.hold(GAIN_RESERVE):
        return as_verified(Link(MACHINE, GAIN_RESERVE, None, note="at least"), verified)
    return as_verified(Link(MACHINE, gain_limit(trials.hold, _CLOSE), None), verified)


def as_verified(link: Link, verified: VerifyResult) -> Link:
    """Return the machine's link with what its whole verification found."""
    failed = [case for case in verified.cases if not case.stable]
    if not failed:
        return link
    note = f"{len(failed)} of {len(verified.cases)} runs not stable, such as {failed[0].headline}"
    factor = link.factor if link.factor < 1 else float("nan")  # not even as it is
    return replace(link, factor=factor, stability=Stability.UNSTABLE, note=note)


class _Trials:
    """Tells of factors on K_P,vel whether every machine is stable with them.

    A trial ends with the first machine that is not. The next begins with that machine, which most
    likely fails again: the answer is the same in any order.
    """

    def __init__(self, verified: VerifyResult, progress: Progress) -> None:
        study = verified.study
        asked = study.study.verification
        fewer = asked.model_copy(update={"repeats": min(_SETS, asked.repeats)})
        self._study = study.model_copy(
            update={"study": study.study.model_copy(update={"verification": fewer})}
        )
        first = asked.seeds[0]
        self._cases = [case for case in cases_of(study) if case.seed == first]
        self._verified, self._progress, self._tried = verified, progress, 0
        # Of each run of the verification these sets are the first ones.
        self._as_it_is = all(one.stable for one in verified.cases if one.seed == first)

    def hold(self, factor: float) -> bool:
        """Return whether every machine is stable with K_P,vel multiplied."""
        self._tried += 1
        self._progress("chain", min(self._tried / _TRIALS, 1.0))
        if factor == 1 and self._as_it_is:
            return True
        gains = self._verified.gains
        scaled = gains.model_copy(update={"k_p_vel": factor * gains.k_p_vel})
        failed: list[Case] = []

        def run(case: Case) -> None:
            if failed:
                return
            fed = self._verified.feedforward
            if not run_case(self._study, case, scaled, fed, while_stable=True).stable:
                failed.append(case)

        Parallel(n_jobs=-1, prefer="threads")(delayed(run)(case) for case in self._cases)
        self._cases.sort(key=lambda case: case not in failed)
        return not failed
