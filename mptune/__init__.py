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
22         ``mptune.loops.position``; discrete in ``mptune.signals.tustin``;
           the loop as it runs in ``mptune.loops.sampled``
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
    from mptune.campaign.campaign import run_campaign
    from mptune.errors import InputError, MptuneError, OutputError
    from mptune.force.controller import ForceController
    from mptune.identify.fit import fit as fit_response
    from mptune.identify.identify import identify as identify_loop
    from mptune.job.run import run
    from mptune.params.gains import read_gains, write_gains
    from mptune.params.load import load_study
    from mptune.params.paper import LEDGER, PUBLISHED_GAINS
    from mptune.robust.chain import chain
    from mptune.robust.sweep import sweep
    from mptune.shape.design import design
    from mptune.sim.sampled import linear_moves
    from mptune.tune.tuner import tune as tune_gains
    from mptune.verify.verify import verify as verify_gains

# Where each name lives, and what it is called there. Rooms are packages of mptune, so that no
# public name may be that of a room.
_HOMES = {
    "ForceController": ("mptune.force.controller", "ForceController"),
    "InputError": ("mptune.errors", "InputError"),
    "LEDGER": ("mptune.params.paper", "LEDGER"),
    "MptuneError": ("mptune.errors", "MptuneError"),
    "OutputError": ("mptune.errors", "OutputError"),
    "PUBLISHED_GAINS": ("mptune.params.paper", "PUBLISHED_GAINS"),
    "chain": ("mptune.robust.chain", "chain"),
    "design": ("mptune.shape.design", "design"),
    "fit_response": ("mptune.identify.fit", "fit"),
    "identify_loop": ("mptune.identify.identify", "identify"),
    "linear_moves": ("mptune.sim.sampled", "linear_moves"),
    "load_study": ("mptune.params.load", "load_study"),
    "read_gains": ("mptune.params.gains", "read_gains"),
    "run": ("mptune.job.run", "run"),
    "run_campaign": ("mptune.campaign.campaign", "run_campaign"),
    "sweep": ("mptune.robust.sweep", "sweep"),
    "tune_gains": ("mptune.tune.tuner", "tune"),
    "verify_gains": ("mptune.verify.verify", "verify"),
    "write_gains": ("mptune.params.gains", "write_gains"),
}

__all__ = [
    "LEDGER",
    "PUBLISHED_GAINS",
    "ForceController",
    "InputError",
    "MptuneError",
    "OutputError",
    "chain",
    "design",
    "fit_response",
    "identify_loop",
    "linear_moves",
    "load_study",
    "read_gains",
    "run",
    "run_campaign",
    "sweep",
    "tune_gains",
    "verify_gains",
    "write_gains",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its home on first use."""
    if name in _HOMES:
        home, there = _HOMES[name]
        return getattr(importlib.import_module(home), there)
    raise AttributeError(f"module 'mptune' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the public names."""
    return __all__
