"""One set of gains, swept, stored and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mptune.files import make_folder, write_whole
from mptune.progress import silent
from mptune.robust.chain import chain, other_reading
from mptune.robust.store import write_sweep
from mptune.robust.sweep import sweep, with_radii

if TYPE_CHECKING:
    from mptune.params.controller import Gains
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.chain import Link
    from mptune.robust.result import SweepResult


def sweep_study(
    study: ResolvedStudy,
    gains: Gains | None,
    out: str | Path,
    progress: Progress = silent,
) -> tuple[SweepResult, tuple[Link, ...], tuple[Path, ...]]:
    """Sweep one set of gains (the study's own where None), store it and draw its panels.

    The linear links of the chain come with it, and those of the other reading of the delays.
    """
    from mptune.figures.certificates import certified_worst_cases
    from mptune.figures.panels import four_panels
    from mptune.figures.style import to_svg

    folder = make_folder(Path(out) / study.name)
    progress("sweep", 0.0)
    swept = sweep(study, gains)
    progress("radius", 0.0)
    swept = with_radii(swept)
    progress("chain", 0.0)
    links = (*chain(swept), *other_reading(swept))
    progress("figures", 0.0)
    files = [
        write_sweep(folder / "sweep.nc", swept),
        write_whole(folder / "panels.svg", to_svg(four_panels(swept))),
    ]
    if swept.certificates is not None:
        svg = to_svg(certified_worst_cases(swept))
        files.append(write_whole(folder / "certificates.svg", svg))
    return swept, links, tuple(files)
