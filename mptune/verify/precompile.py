"""The simulator's kernels, compiled in a process of its own while this one sweeps and tunes.

Compiling the closed loop takes as long as all other work of a first run together, and one process
compiles one kernel at a time. A second process fills the same cache on the second core. Later runs
find the cache filled and start no process.
"""

from __future__ import annotations

import subprocess
import sys
from contextlib import contextmanager, suppress
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from mptune.kernel_cache import is_compiled
from mptune.sim.closed_loop import run_ticks

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_MOST = 300.0  # s: then the kernels are compiled here after all


@contextmanager
def precompiling() -> Iterator[Callable[[], None]]:
    """Compile the simulator beside the block; yield a function that waits until that is done.

    Whatever becomes of the other process, nothing is lost but time: what it has not compiled is
    compiled here when it is needed.
    """
    if is_compiled(run_ticks):
        yield lambda: None
        return
    command = [sys.executable, "-m", "mptune.verify.precompile"]
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


def main() -> None:
    """Run the template study's machine through one movement set."""
    from mptune.params.load import load_study
    from mptune.verify.verify import cases_of, run_case

    with resources.as_file(resources.files("mptune.params").joinpath("template.toml")) as path:
        study = load_study(Path(path), ["verification.repeats=1", "verification.seeds=[1]"])
    run_case(study, cases_of(study)[0], study.study.gains, study.study.feedforward)


if __name__ == "__main__":
    main()
