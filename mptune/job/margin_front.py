"""The front of tracking against disk margin, each point run on the nonlinear machine as well."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.files import write_whole
from mptune.job.leftovers import keep
from mptune.progress import silent
from mptune.strict import strict
from mptune.tune.margin_front import LARGEST, margin_front
from mptune.verify.verify import verify

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.tune.margin_front import MarginPoint
    from mptune.tune.space import Choice


def margin_front_files(
    study: ResolvedStudy,
    folder: Path,
    count: int,
    progress: Progress = silent,
    largest: float = LARGEST,
    start: Choice | None = None,
) -> tuple[list[dict[str, Any]], tuple[Path, Path]]:
    """Find the front, run its points on the machine, draw it, and leave it for the report.

    Parameters
    ----------
    study
        The study.
    folder
        The study's folder for results.
    count, largest, progress, start
        As of ``mptune.tune.margin_front.margin_front``.

    Returns
    -------
    tuple
        The points' rows, and the files written.
    """
    from mptune.figures.margin_front import index_over_margin
    from mptune.figures.style import to_svg

    points = margin_front(study, count, largest, progress, start)
    rows = [on_the_machine(study, one) for one in points]
    drawn = write_whole(folder / "margins.svg", to_svg(index_over_margin(rows)))
    return rows, (drawn, keep(folder, "margins", study, rows))


def on_the_machine(study: ResolvedStudy, point: MarginPoint) -> dict[str, Any]:
    """Return a point's row: the machine's index on each mass, and at worst, beside the linear ones.

    Parameters
    ----------
    study
        Whose machine.
    point
        A point of the front.
    """
    cases = verify(point.put_over(study)).cases
    by_mass = [
        {
            "mass_kg": mass,
            "performance_index_ms": float(
                np.mean([case.badness for case in cases if case.mass_kg == mass])
            ),
        }
        for mass in sorted({case.mass_kg for case in cases})
    ]
    worst = max((case.badness for case in cases), default=float("nan"))
    return strict({**point.json(), "performance_index_ms": worst, "by_mass": by_mass})
