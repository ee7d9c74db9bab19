"""Gains beside gains: files and studies on one model, or each on its own.

With ``--study`` all are judged on that study's model: the same controller on any grid, set or box.
Without it, each study that is named stands for its own gains on its own model, and each gains file
is judged on the named study whose model it was made for, else on the first of its name, else on the
first. What differs from the model that it was made for is said; another controller is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.escaping import printable
from mptune.files import make_folder, read_text, write_whole
from mptune.params.gains import GainsFile, gains_for, read_gains
from mptune.params.judged_on import differences, judged_on, refuse_other_controller
from mptune.params.load import load_study
from mptune.params.study import CHOSEN
from mptune.params.toml_text import parse_toml
from mptune.progress import silent
from mptune.robust.headline import judge_sweep
from mptune.robust.sweep import sweep
from mptune.sim.sampled import linear_moves

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.controller import Feedforward
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.headline import Judgement
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove

_REMEDY = "check the path: `mptune tune STUDY` writes gains, `mptune new NAME` starts a study"


@dataclass(frozen=True)
class Compared:
    """One set of gains, judged.

    Attributes
    ----------
    label
        Its name among the others.
    source
        The file that it comes from.
    sweep, moves
        What was found over the family, and the sampled linear loop.
    judgement
        The verdict on every linear model.
    differs
        In what the model differs from the one that they were made for.
    recorded
        What a gains file records of its own closed loop on the nonlinear machine; else empty.
    """

    label: str
    source: Path
    feedforward: Feedforward
    sweep: SweepResult
    moves: tuple[LinearMove, ...]
    judgement: Judgement
    differs: tuple[Difference, ...]
    recorded: dict[str, Any]

    @property
    def index_ms(self) -> dict[float, float]:
        """The largest linear-check index by mass [kg]; infinite where a case is not stable."""
        found: dict[float, float] = {}
        for case in self.moves:
            found[case.mass_kg] = max(found.get(case.mass_kg, 0.0), case.badness)
        return found

    def json(self) -> dict[str, Any]:
        """Return the entry in SI, units in the keys; indices keep §7's unit."""
        return {
            **self.judgement.json(),
            "label": self.label,
            "source": str(self.source),
            "study": self.sweep.study.name,
            "study_hash": self.sweep.study.hash(),
            "gains": self.sweep.gains.model_dump(),
            "feedforward": self.feedforward.model_dump(),
            "sweep": self.sweep.json(),
            "linear_check_index_ms": {
                f"{mass:.0f}_kg": index for mass, index in self.index_ms.items()
            },
            "differs": [one.json() for one in self.differs],
            "recorded": self.recorded,
        }


@dataclass(frozen=True)
class _Entry:
    source: Path
    study: ResolvedStudy
    file: GainsFile | None = None
    differs: tuple[Difference, ...] = ()


def compare(
    sources: Sequence[str | Path],
    study: str | Path | None,
    out: str | Path,
    progress: Progress = silent,
    *,
    overrides: Sequence[str] = (),
    uncertainty: str = "",
) -> tuple[tuple[Compared, ...], tuple[Path, ...]]:
    """Judge two or more sets of gains, and draw them over one another.

    Parameters
    ----------
    sources
        Gains files and study files.
    study
        The study on whose model all are judged; None for each on its own.
    out, progress
        Folder for results, and what is told how far it is.
    overrides, uncertainty
        For every study, as in ``load_study``.

    Raises
    ------
    InputError
        If there are fewer than two, some gains file has no study to be judged on, or some are of
        another controller.
    """
    from mptune.figures.compare import compared_gains
    from mptune.figures.style import to_svg

    if len(sources) < 2:
        remedy = "name two or more gains files or studies"
        raise InputError("command line", Fault("", "", "has nothing to compare with", remedy))
    entries = _entries([Path(source) for source in sources], study, overrides, uncertainty)
    folder = make_folder(out)
    labels = _labels(entries)
    found = []
    for n, (label, entry) in enumerate(zip(labels, entries, strict=True)):
        progress("compare", n / len(entries))
        found.append(_judged(label, entry))
    progress("figures", 0.0)
    path = write_whole(folder / "compare.svg", to_svg(compared_gains(_drawn(found))))
    progress("figures", 1.0)
    return tuple(found), (path,)


def _entries(
    sources: Sequence[Path],
    study: str | Path | None,
    overrides: Sequence[str],
    uncertainty: str,
) -> list[_Entry]:
    """Return what each source stands for; studies first, as gains files may need them."""
    frame = load_study(study, overrides, uncertainty) if study else None
    texts = {path: parse_toml(path, read_text(path, _REMEDY)) for path in sources}
    files = {path: read_gains(path) for path, values in texts.items() if "study_hash" in values}
    studies = {
        path: load_study(path, overrides, uncertainty) for path in sources if path not in files
    }
    entries = []
    for path in sources:
        if path in studies:
            entries.append(_of_study(path, studies[path], frame))
            continue
        own = _home(path, files[path], frame, list(studies.values()))
        file, differs = gains_for(own, path)
        entries.append(_Entry(path, file.put_over(own), file, differs))
    return entries


def _of_study(path: Path, study: ResolvedStudy, frame: ResolvedStudy | None) -> _Entry:
    """Return a study's own gains, on its own model or on that of ``--study``."""
    if frame is None or frame.hash() == study.hash():
        return _Entry(path, study)
    differs = differences(judged_on(study), frame)
    refuse_other_controller(path, differs)
    chosen = {name: getattr(study.study, name) for name in CHOSEN}
    moved = frame.study.model_copy(update=chosen)
    return _Entry(path, frame.model_copy(update={"study": moved}), None, differs)


def _home(
    path: Path, file: GainsFile, frame: ResolvedStudy | None, named: Sequence[ResolvedStudy]
) -> ResolvedStudy:
    """Return the study on whose model a gains file is judged."""
    if frame is not None:
        return frame
    if not named:
        made = f"{file.study_hash[:12]}…"
        which = f"study {file.study}, uncertainty set {file.uncertainty or 'default'}"
        fault = Fault("study_hash", made, "needs its model", f"name it: --study ({which})")
        raise InputError(path, fault)
    same = [one for one in named if one.hash() == file.study_hash]
    namesakes = [one for one in named if one.name == file.study]
    return (*same, *namesakes, *named)[0]


def _labels(entries: Sequence[_Entry]) -> list[str]:
    """Return a name for each entry: its file's or folder's, numbered where not its own."""
    names = []
    for entry in entries:
        path = entry.source.resolve()
        common = path.stem in {"gains", "study"}
        name = printable(path.parent.name if common else path.stem)
        names.append(f"{name}, study's own" if entry.file is None else name)
    return [
        f"{name} ({names[: n + 1].count(name)})" if names.count(name) > 1 else name
        for n, name in enumerate(names)
    ]


def _judged(label: str, entry: _Entry) -> Compared:
    study, file = entry.study, entry.file
    swept = sweep(study)
    return Compared(
        label=label,
        source=entry.source,
        feedforward=study.study.feedforward,
        sweep=swept,
        moves=linear_moves(study),
        judgement=judge_sweep(swept),
        differs=entry.differs,
        recorded=_recorded(file) if file else {},
    )


def _recorded(file: GainsFile) -> dict[str, Any]:
    """Return the numbers that a gains file records; whatever else stands there is none."""
    found = file.figures.get("closed_loop", {})
    return {key: value for key, value in found.items() if isinstance(value, int | float)}


def _drawn(found: Sequence[Compared]) -> list[tuple[str, SweepResult, tuple[LinearMove, ...]]]:
    return [(one.label, one.sweep, one.moves) for one in found]
