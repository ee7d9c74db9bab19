"""All kernels of a run and of ``identify`` compiled ahead, so that the first command is as fast.

Compiled kernels are kept in the user's cache folder, or where NUMBA_CACHE_DIR points: an image that
is built once ships them so.
"""

from __future__ import annotations

import tempfile
from importlib import resources
from typing import TYPE_CHECKING

from mptune.identify.identify import identify
from mptune.job.run import run
from mptune.kernel_cache import folder_of
from mptune.params.load import load_study
from mptune.progress import Progress, silent
from mptune.sim.closed_loop import run_ticks

if TYPE_CHECKING:
    from pathlib import Path

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


def warm(progress: Progress = silent) -> Path | None:
    """Run a small study whole, and throw its results away; return where its kernels are kept.

    Whatever a run compiles is compiled then, whichever way it goes: there is no list of kernels to
    keep in step. None where no folder can be written, and nothing is gained.

    Parameters
    ----------
    progress
        Told of the stages of ``run``, then of ``"identify"``.
    """
    template = resources.files("mptune.params").joinpath("template.toml")
    with resources.as_file(template) as path, tempfile.TemporaryDirectory() as place:
        study = load_study(path, _SMALL)
        run(study, place, progress)
        identify(study, progress=progress)
    folder = folder_of(run_ticks)
    return None if folder is None else folder.parent
