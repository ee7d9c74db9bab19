"""All kernels of a run and of ``identify`` compiled ahead, so that the first command is as fast.

Compiled kernels are kept in the user's cache folder, or where NUMBA_CACHE_DIR points: an image that
is built once ships them so.
"""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from importlib import resources
from typing import TYPE_CHECKING

from mptune.identify.identify import identify
from mptune.job.precompile import precompiling
from mptune.job.run import run
from mptune.kernel_cache import folder_of
from mptune.params.chambers import NUMBERS
from mptune.params.load import load_study
from mptune.progress import Progress, silent
from mptune.sim.closed_loop import run_ticks

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.params.study import ResolvedStudy

_SMALL = (
    "uncertainty.points=2",
    "verification.repeats=1",
    "verification.seeds=[1]",
    'verification.masses=["20 t"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
    "identification.frequencies=2",
    'identification.positions=["0.15 m"]',
    'identification.velocities=["0 m/s"]',
    'identification.pressures=["6 MPa"]',
    'identification.oil_bulk_moduli=["1200 MPa"]',
)


def warm(progress: Progress = silent, study: ResolvedStudy | None = None) -> Path | None:
    """Run a small study whole, and throw its results away; return where its kernels are kept.

    Whatever a run compiles is compiled then, whichever way it goes: there is no list of kernels to
    keep in step. None where no folder can be written, and nothing is gained.

    Parameters
    ----------
    progress
        Told of the stages of ``run``, then of ``"identify"``.
    study
        A study whose machine is to be simulated: one of more than two chambers has kernels of its
        own, which a process compiles beside.
    """
    template = resources.files("mptune.params").joinpath("template.toml")
    with ExitStack() as stack:
        path = stack.enter_context(resources.as_file(template))
        place = stack.enter_context(tempfile.TemporaryDirectory())
        ready = None
        if study is not None and len(study.study.all_chambers) > NUMBERS[0]:
            ready = stack.enter_context(precompiling(study, proofs=False))  # the run's own are
        small = load_study(path, _SMALL)
        run(small, place, progress)
        identify(small, progress=progress)
        if ready is not None:
            ready()
    folder = folder_of(run_ticks)
    return None if folder is None else folder.parent
