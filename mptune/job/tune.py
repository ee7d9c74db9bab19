"""A study tuned, and its ``gains.toml`` written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.files import make_folder
from mptune.job.gains import gains_file
from mptune.params.gains import write_gains
from mptune.sim.sampled import linear_moves
from mptune.tune.tuner import tune

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from mptune.params.study import ResolvedStudy
    from mptune.tune.result import TuneResult


def tune_study(
    study: ResolvedStudy, out: Path, progress: Callable[[str, float], None] = lambda *_: None
) -> tuple[TuneResult, tuple[Path, ...]]:
    """Tune a study, check the gains on the sampled linear loop, and write ``gains.toml``."""
    folder = make_folder(out / study.name)
    progress("tune", 0.0)
    tuned = tune(study, lambda share: progress("tune", share))
    moves = linear_moves(study, tuned.gains, tuned.feedforward)
    file = gains_file(tuned.sweep, tuned.feedforward, moves, None)
    return tuned, (write_gains(folder / "gains.toml", file),)
