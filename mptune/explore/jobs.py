"""The slow computations of the page: certified verdict, tuning, and the file with both verdicts.

They run in a process of their own, see ``mptune.explore.worker``. Each loads the study anew with
the setting as its ``--set`` texts, so that what it finds is what ``mptune sweep`` and ``mptune
tune`` find for the same texts.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.files import is_there, make_folder, write_whole
from mptune.job.gains import gains_file
from mptune.params.gains import write_gains
from mptune.params.load import load_study
from mptune.robust.chain import Link, chain
from mptune.robust.headline import Judgement, judge
from mptune.robust.sweep import sweep
from mptune.sim.sampled import linear_moves
from mptune.tune.tuner import tune
from mptune.verify.checks import machine_checks
from mptune.verify.gain_limit import machine_reserve
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.progress import Progress
    from mptune.robust.result import Check, SweepResult


@dataclass(frozen=True)
class Ask:
    """A study with a setting: its file, the setting's ``--set`` texts, the uncertainty set."""

    path: Path
    overrides: tuple[str, ...]
    uncertainty: str


@dataclass(frozen=True)
class CertifiedFigures:
    """What ``mptune sweep`` says of a setting."""

    judgement: Judgement
    checks: tuple[Check, ...]
    links: tuple[Link, ...]


@dataclass(frozen=True)
class TunedSetting:
    """What ``mptune tune`` says of a setting: values by dotted key, and a line on how it went."""

    values: dict[str, float]
    words: str


def certified(ask: Ask, progress: Progress) -> CertifiedFigures:
    """Return verdict, requirements and chain, guaranteed over the whole box.

    Raises
    ------
    InputError
        If the setting is no study.
    """
    progress("certify", 0.0)
    swept, links = _swept(ask)
    return CertifiedFigures(judge(swept.checks, links), swept.checks, links)


def tuned(ask: Ask, progress: Progress) -> TunedSetting:
    """Return gains tuned from where the sliders stand.

    Raises
    ------
    InputError
        If the setting is no study.
    """
    progress("tune", 0.0)
    found = tune(load_study(ask.path, ask.overrides, ask.uncertainty), progress)
    values = {
        f"{name}.{key}": float(value)
        for name, section in (("gains", found.gains), ("feedforward", found.feedforward))
        for key, value in section.model_dump().items()
        if not isinstance(value, bool)
    }
    blocked = f"; {found.blocking.requirement}: {found.blocking.remedy}" if found.blocking else ""
    return TunedSetting(values, f"{found.headline}{blocked}")


def saved(ask: Ask, path: Path, progress: Progress, *, over: bool) -> str:
    """Write ``gains.toml`` with the verdict of the linear models and that of the machine.

    Returns
    -------
    str
        What the file says of the verdicts.

    Raises
    ------
    InputError
        If the setting is no study, or there is a file of that name and ``over`` is False.
    OutputError
        If the file cannot be written.
    """
    refuse_to_overwrite(path, over=over)
    make_folder(path.parent)
    progress("certify", 0.0)
    swept, links = _swept(ask)
    progress("verify", 0.0)
    study = swept.study
    verified = verify(study, progress=progress)
    links = (*links, machine_reserve(verified, progress))
    judgement = judge((*swept.checks, *machine_checks(verified)), links)
    moves = linear_moves(study)
    file = gains_file(swept, study.study.feedforward, moves, verified, judgement)
    refuse_to_overwrite(path, over=over)  # verifying took its time
    write_gains(path, file)
    return file.verdicts


def drawn(ask: Ask, out: Path, progress: Progress) -> Path:
    """Write the sweep's figures as SVG; return their folder, named after what is drawn.

    Raises
    ------
    InputError
        If the setting is no study, or the folder cannot be written to.
    OutputError
        If a figure cannot be written.
    """
    from mptune.figures.chain import gain_chain
    from mptune.figures.style import to_svg

    progress("certify", 0.0)
    swept, links = _swept(ask)
    name = hashlib.sha256(repr(ask).encode()).hexdigest()[:8]
    folder = make_folder(out / swept.study.name / f"explore-{name}")
    progress("figures", 0.0)
    for drawing in swept.drawings:
        write_whole(folder / f"{drawing}.svg", to_svg(swept.plot(drawing)))
    write_whole(folder / "chain.svg", to_svg(gain_chain(links)))
    return folder


def refuse_to_overwrite(path: Path, *, over: bool) -> None:
    """Refuse to write over a file, unless that was asked for, or where no gains file belongs.

    Raises
    ------
    InputError
        Naming the file.
    """
    if path.suffix != ".toml":
        raise InputError(path, Fault("", "", "is no name of a gains file", "let it end in .toml"))
    if is_there(path) and not over:
        raise InputError(path, Fault("", "", "exists", "confirm to write over it, or rename"))


@lru_cache(maxsize=1)
def _swept(ask: Ask) -> tuple[SweepResult, tuple[Link, ...]]:
    """Return a setting's sweep and chain; the last one is kept, for saving what is shown."""
    swept = sweep(load_study(ask.path, ask.overrides, ask.uncertainty))
    return swept, chain(swept)


def run(kind: str, arguments: tuple[Any, ...], progress: Progress) -> Any:
    """Run one of the jobs by its name."""
    if kind == "certified":
        return certified(arguments[0], progress)
    if kind == "tuned":
        return tuned(arguments[0], progress)
    if kind == "drawn":
        return drawn(arguments[0], arguments[1], progress)
    if kind == "saved":
        ask, path, over = arguments
        return saved(ask, path, progress, over=over)
    raise ValueError(f"no job is called {kind}")
