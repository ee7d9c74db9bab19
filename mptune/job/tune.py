"""A study tuned: its ``gains.toml``, and what the gains are compared with."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.job.gains import gains_file
from mptune.job.leftovers import keep
from mptune.job.margin_front import margin_front_files
from mptune.params.gains import write_gains
from mptune.params.pack import pack_gains
from mptune.progress import silent
from mptune.robust.headline import judge_sweep
from mptune.sim.sampled import linear_moves
from mptune.tune.baselines import Baseline, baselines
from mptune.tune.front import Front, front
from mptune.tune.space import STRUCTURES, Choice
from mptune.tune.tuner import tune

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.headline import Judgement
    from mptune.tune.result import TuneResult

ALONG = ("k_i_pos", "disk_margin")
"""What a front of tracking may run along."""


@dataclass(frozen=True)
class Tuning:
    """A tuning with its verdict, and what was compared with it: empty, None where not asked for."""

    tuned: TuneResult
    judgement: Judgement
    compared: tuple[Baseline, ...]
    front: Front | None
    margins: tuple[dict[str, Any], ...]
    files: tuple[Path, ...]

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        values = {**self.judgement.json(), **self.tuned.json()}
        if self.compared:
            values["compared"] = [one.json() for one in self.compared]
        if self.front is not None:
            values["front"] = self.front.json()
        if self.margins:
            values["margins"] = list(self.margins)
        return values


def tune_study(
    study: ResolvedStudy,
    out: str | Path,
    progress: Progress = silent,
    *,
    structure: str = "eq22",
    compare: bool = False,
    points: int = 0,
    along: str = ALONG[0],
) -> Tuning:
    """Tune a study, check the gains on the sampled linear loop, and write ``gains.toml``.

    Parameters
    ----------
    study, out, progress
        The study, the folder for results, and what is told how far it is.
    structure
        Structure of the position controller.
    compare
        Whether to tune P, PI and PID as well.
    points
        Number of points of the front of tracking against what ``along`` names.
    along
        One of ``ALONG``: the integral gain, or the disk margin, at which the machine runs too.

    Raises
    ------
    InputError
        If there is no such structure or front.
    OutputError
        If results cannot be written.
    """
    if structure not in STRUCTURES:
        remedy = f"choose one of {', '.join(STRUCTURES)}"
        raise InputError("command line", Fault("--structure", structure, "is not known", remedy))
    if along not in ALONG:
        remedy = f"choose one of {', '.join(ALONG)}"
        raise InputError("command line", Fault("--along", along, "is not known", remedy))
    folder = make_folder(Path(out) / study.name)
    progress("tune", 0.0)
    tuned = tune(study, progress, structure=structure)
    moves = linear_moves(tuned.sweep.study, tuned.gains, tuned.feedforward)
    judgement = judge_sweep(tuned.sweep)
    file = gains_file(tuned.sweep, tuned.feedforward, moves, None, judgement)
    files = [write_gains(folder / "gains.toml", file)]
    compared: tuple[Baseline, ...] = ()
    if compare:
        progress("compare", 0.0)
        compared = baselines(study, tuned, progress)
        files += compared_files(folder, study, compared)
    found: Front | None = None
    margins: tuple[dict[str, Any], ...] = ()
    if points and along == "disk_margin":
        progress("front", 0.0)
        best = Choice(pack_gains(tuned.gains), tuned.feedforward, tuned.estimator)
        rows, more = margin_front_files(study, folder, points, progress, start=best)
        margins, files = tuple(rows), [*files, *more]
    elif points:
        progress("front", 0.0)
        found = front(study, points, progress)
        files.append(_drawn(folder / "front.svg", found))
        files.append(keep(folder, "front", study, found.json()))
    return Tuning(tuned, judgement, compared, found, margins, tuple(files))


def compared_files(
    folder: Path, study: ResolvedStudy, compared: tuple[Baseline, ...]
) -> tuple[Path, Path]:
    """Draw and store compared controllers; a report of the same model takes them up."""
    rows = [one.json() for one in compared]
    drawn = _drawn(folder / "controllers.svg", compared)
    return drawn, keep(folder, "comparison", study, rows)


def _drawn(path: Path, what: tuple[Baseline, ...] | Front) -> Path:
    from mptune.figures.style import to_svg
    from mptune.figures.tradeoff import compared_controllers, pareto_front

    drawn = pareto_front(what) if isinstance(what, Front) else compared_controllers(what)
    return write_whole(path, to_svg(drawn))
