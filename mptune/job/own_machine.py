"""The machine under a study's own gains, simulated while others are searched for.

What it does does not depend on what is found, and the search leaves cores idle. Where nothing is
found that is worth running on the machine, it ends with the runs that are under way.
"""

from __future__ import annotations

import warnings
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from typing import TYPE_CHECKING

from mptune.job.precompile import precompiling
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.verify.result import VerifyResult

_GLANCE = 0.2  # s, between looks at how far it is


class _DroppedError(Exception):
    """Ends a verification that is not asked for any more."""


class OwnMachine:
    """A verification that goes on beside other work."""

    def __init__(
        self, study: ResolvedStudy, ready: Callable[[], None], pool: ThreadPoolExecutor
    ) -> None:
        self._share, self._dropped = 0.0, False
        self._found = pool.submit(self._run, study, ready)

    def result(self, progress: Progress) -> VerifyResult:
        """Wait for the verification, telling how far it is; raise what ``verify`` raises."""
        while not wait([self._found], _GLANCE).done:
            progress("verify own", self._share)
        return self._found.result()

    def drop(self) -> None:
        """Start no further run."""
        self._dropped = True

    def _run(self, study: ResolvedStudy, ready: Callable[[], None]) -> VerifyResult:
        ready()
        self._note("", 0.0)
        return verify(study, progress=self._note)

    def _note(self, _stage: str, share: float) -> None:
        if self._dropped:
            # joblib would tell people that runs were given up.
            warnings.filterwarnings("ignore", r"\d+ tasks have been", UserWarning)
            raise _DroppedError
        self._share = share


@contextmanager
def own_machine(study: ResolvedStudy) -> Iterator[OwnMachine]:
    """Simulate a study's machines under its own gains beside the block, compiled if need be."""
    with ThreadPoolExecutor(1, "own gains") as pool, precompiling(study) as ready:
        own = OwnMachine(study, ready, pool)
        try:
            yield own
        finally:
            own.drop()
