"""What the paper's own frame alone would give, verified beside a study's own gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.params.controller import Feedforward
from mptune.progress import silent
from mptune.verify.beside import PapersFrame, beside
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.tune.result import TuneResult
    from mptune.verify.result import VerifyResult

_SETS = 6  # the first is left out of figures; more would tell nothing else, and take their time


def papers_frame(
    study: ResolvedStudy,
    before: VerifyResult,
    tuned_so: Callable[[], TuneResult],
    progress: Progress = silent,
) -> PapersFrame | None:
    """Verify what tuning a study in the paper's frame gives on its machines.

    Parameters
    ----------
    study
        The study.
    before
        Its machines under its own gains.
    tuned_so
        Gives what tuning in that frame has found, see ``mptune.tune.papers_frame``.
    progress
        Told of the stage ``"paper's frame"``.

    Returns
    -------
    PapersFrame or None
        None where the paper's own requirements cannot be met.
    """
    progress("paper's frame", 0.0)
    tuned = tuned_so()
    if tuned.blocking is not None:
        return None
    few = min(study.study.verification.repeats, _SETS)
    asked = study.study.verification.model_copy(update={"repeats": few})
    short = study.model_copy(
        update={"study": study.study.model_copy(update={"verification": asked})}
    )
    verified = verify(
        short,
        tuned.gains,
        Feedforward(),
        lambda _, share: progress("paper's frame", 0.3 + 0.7 * share),
    )
    index = tuned.figures_before.tracking, tuned.figures.tracking
    return beside(before, tuned.gains, index, verified)
