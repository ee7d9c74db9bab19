"""mptune: robust-control design and tuning for multi-pressure hydraulic cylinders.

Where each equation of the paper stands:

=========  ==========================================================
Equation   Module
=========  ==========================================================
1          ``mptune.plant.machine``
2, 3       ``mptune.plant.flow``, ``mptune.force.search_space``
4          ``mptune.plant.bulk``
5          ``mptune.force.estimator``
6          ``mptune.force.search_space``
7, 8       ``mptune.force.cost``, ``mptune.force.select``
9, 10      ``mptune.force.stop``
11, 12     ``mptune.loops.force_dynamics``
14-16, 18  ``mptune.loops.velocity``
17, 21     ``mptune.robust.condition``
19, 20     ``mptune.loops.position``
22         ``mptune.loops.position``; discrete in ``mptune.signals.tustin``
23         ``mptune.signals.differentiator``
=========  ==========================================================

Table 1 and 2 and §5.1 are values of ``studies/boom/study.toml``; where mptune differs from the
paper, and why, stands in ``mptune.params.paper``.

The public names below are imported when they are first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mptune.errors import InputError, MptuneError, OutputError
    from mptune.force.controller import ForceController
    from mptune.job.run import run
    from mptune.params.gains import read_gains, write_gains
    from mptune.params.load import load_study
    from mptune.params.paper import LEDGER, PUBLISHED_GAINS
    from mptune.robust.sweep import sweep
    from mptune.sim.sampled import linear_moves
    from mptune.tune.tuner import tune
    from mptune.verify.verify import verify

_HOMES = {
    "ForceController": "mptune.force.controller",
    "InputError": "mptune.errors",
    "LEDGER": "mptune.params.paper",
    "MptuneError": "mptune.errors",
    "OutputError": "mptune.errors",
    "PUBLISHED_GAINS": "mptune.params.paper",
    "linear_moves": "mptune.sim.sampled",
    "load_study": "mptune.params.load",
    "read_gains": "mptune.params.gains",
    "run": "mptune.job.run",
    "sweep": "mptune.robust.sweep",
    "tune": "mptune.tune.tuner",
    "verify": "mptune.verify.verify",
    "write_gains": "mptune.params.gains",
}

__all__ = [
    "LEDGER",
    "PUBLISHED_GAINS",
    "ForceController",
    "InputError",
    "MptuneError",
    "OutputError",
    "linear_moves",
    "load_study",
    "read_gains",
    "run",
    "sweep",
    "tune",
    "verify",
    "write_gains",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its home on first use."""
    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'mptune' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the public names."""
    return __all__
