"""Kernels compiled in a process of its own while this one sweeps and tunes.

Compiling takes longer than all other work of a first run together, and one process compiles one
kernel at a time. A second process fills the same cache on the second core: with those that prove,
which a sweep comes to after its grids' own, then with the simulator's. Later runs find the cache
filled and start no process.
"""

from __future__ import annotations

import subprocess
import sys
from contextlib import contextmanager, suppress
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from mptune.certify.bounds import bound
from mptune.certify.problem import BoxedLoop
from mptune.certify.search import search
from mptune.force.select import decide
from mptune.kernel_cache import is_compiled
from mptune.params.chambers import NUMBERS, Side
from mptune.sim.closed_loop import decide_for_more, run_ticks

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mptune.params.study import ResolvedStudy

_MOST = 300.0  # s: then the kernels are compiled here after all
_SMALL = ("verification.repeats=1", "verification.seeds=[1]")
_PROOFS, _MORE = "--proofs", "--more-chambers"
# Four chambers in the place of the template's two: no size is compiled in.
_PAIR = ", ".join(f'{{side="{one}", area="40 cm^2", dead_volume="0.4 dm^3"}}' for one in Side)
_CHAMBERS = (f"chambers=[{_PAIR}, {_PAIR}]", 'edges.states=["all"]')


@contextmanager
def precompiling(study: ResolvedStudy, *, proofs: bool = True) -> Iterator[Callable[[], None]]:
    """Compile a study's simulator, and ``proofs``, beside the block; yield what waits for its end.

    Whatever becomes of the other process, nothing is lost but time: what it has not compiled is
    compiled here when it is needed.
    """
    more = len(study.study.all_chambers) > NUMBERS[0]
    loop = (decide_for_more,) if more else (run_ticks, decide)
    if all(is_compiled(one) for one in (*loop, *((search,) if proofs else ()))):
        yield lambda: None
        return
    command = [sys.executable, "-m", "mptune.job.precompile"]
    command += [option for option, wanted in ((_PROOFS, proofs), (_MORE, more)) if wanted]
    silent = subprocess.DEVNULL
    process = subprocess.Popen(command, stdin=silent, stdout=silent, stderr=silent)  # noqa: S603 - our own module

    def wait() -> None:
        with suppress(subprocess.TimeoutExpired):
            process.wait(_MOST)

    try:
        yield wait
    finally:
        process.kill()
        process.wait()


def compile_proofs() -> None:
    """Bound one figure over the template study's box: all figures share their kernels."""
    bound(BoxedLoop.of(_template()), "force_reference", "none", "sensitivity_peak")


def compile_simulator(*, more: bool) -> None:
    """Run the template study's machine, or one of four chambers, through one movement set."""
    from mptune.verify.verify import cases_of, run_case

    study = _template(*_SMALL, *(_CHAMBERS if more else ()))
    run_case(study, cases_of(study)[0], study.study.gains, study.study.feedforward)


def _template(*changes: str) -> ResolvedStudy:
    from mptune.params.load import load_study

    with resources.as_file(resources.files("mptune.params").joinpath("template.toml")) as path:
        return load_study(Path(path), changes)


if __name__ == "__main__":
    if _PROOFS in sys.argv[1:]:
        compile_proofs()
    compile_simulator(more=_MORE in sys.argv[1:])
