"""The force loop identified, stored and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mptune.files import make_folder, write_whole
from mptune.identify.identify import check, identify
from mptune.identify.store import write_identification
from mptune.progress import silent

if TYPE_CHECKING:
    from mptune.identify.excitation import Excitation
    from mptune.identify.result import IdentifyResult
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress


def identify_study(
    study: ResolvedStudy,
    excitation: Excitation,
    out: str | Path,
    progress: Progress = silent,
) -> tuple[IdentifyResult, tuple[Path, ...]]:
    """Simulate the force loop's frequency response, store it, and draw Fig. 3.

    There is a figure for each valve delay.
    """
    from mptune.figures.identification import bode_panels
    from mptune.figures.style import to_svg

    check(study)
    folder = make_folder(Path(out) / study.name)
    progress("identify", 0.0)
    result = identify(study, excitation, progress)
    progress("figures", 0.0)
    files = [write_identification(folder / "identification.nc", result)]
    for delay in study.study.identification.valve_delays:
        panels = tuple(panel for panel in result.panels if panel.valve_delay_s == delay)
        svg = to_svg(bode_panels(panels))
        files.append(write_whole(folder / f"{figure_name(delay)}.svg", svg))
    progress("figures", 1.0)
    return result, tuple(files)


def figure_name(valve_delay: float) -> str:
    """Return the name of the figure of one valve delay [s]."""
    return f"identification-{1e3 * valve_delay:g}ms" if valve_delay else "identification"
