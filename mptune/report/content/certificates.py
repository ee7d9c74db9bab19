"""What is guaranteed over the whole box: certified worst cases, and how far the box may grow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.report.blocks import (
    Cell,
    Chapter,
    Figure,
    Note,
    Prose,
    Row,
    Tabular,
    left,
    right,
    verdict,
    wide,
)
from mptune.robust.certificates import place_of
from mptune.robust.tables import place_text
from mptune.units import number

if TYPE_CHECKING:
    from mptune.certify.result import Bound
    from mptune.report.results import Results
    from mptune.robust.certificates import Certificates

_PATHS = {
    "none": "without path",
    "filters": "with path",
    "estimator": "with state estimator",
    "sampled": "sampled",
}
_LOOPS = {"velocity": "velocity loop", "position": "position loop", "force_reference": "F_ref"}
_FIGURES = {
    "equation_17": "Eq. 17",
    "equation_21": "Eq. 21",
    "sensitivity_peak": "M_S",
    "complementary_peak": "M_T",
    "disk_margin": "disk margin α",
    "peak_compliance": "peak compliance [mm/kN]",
}
_SCALES = {"peak_compliance": 1e6}  # m/N in mm/kN
_FAILS = {
    "equation_17": "Eq. 17 reaches 1",
    "equation_21": "Eq. 21 reaches 1",
    "true": "true loop unstable, without path",
    "with_path": "true loop unstable, with path",
    "sampled": "loop as it runs unstable",
}
_LEGEND = (
    "Some plant attains the first value; none of the box is beyond the second at any frequency. "
    "—: no figure of this model."
)


def certificates(results: Results) -> Chapter | None:
    """Return the certified worst cases of the final gains; none where nothing is certified."""
    found = results.sweep.certificates
    if found is None:
        return None
    return Chapter.of(
        "Certified worst cases",
        Prose(
            "Over the whole continuous box of mass, delay and time constants and all frequencies, "
            "with exact dead time: a value that some plant attains, and a bound that none exceeds, "
            "proved by branch and bound in floating point with its rounding counted."
        ),
        Figure(
            "Left: the ratio of Eq. 17 and of Eq. 21, certified on intervals of frequency (steps) "
            "above the grid's (lines). Right: the factor by which the box may grow about the "
            "nominal plant until a model fails; 1 is the box as it is.",
            "certificates",
        ),
        *bounds(found).titled(),
        Note(
            "∞: the box holds an unstable plant. "
            "What could not be closed within its budget is marked open; both bounds then hold."
        ),
        *radii(found).titled(),
    )


def bounds(found: Certificates) -> Tabular:
    """Return attained and guaranteed values: a row for each figure of a loop, a column per path."""
    named = dict.fromkeys((one.loop, one.figure) for one in found.bounds)
    paths = ("none", found.problem.measured, "sampled")
    rows: list[Row] = [
        [
            f"{_FIGURES[figure]}, {_LOOPS[loop]}",
            *(_bound(found.of(loop, path, figure)) for path in paths),
        ]
        for loop, figure in named
    ]
    columns = [*left("Figure"), *right(*(_PATHS[path] for path in paths))]
    return Tabular("Certified over the whole box", columns, rows, legend=_LEGEND)


def _bound(one: Bound | None) -> str | Cell:
    if one is None:
        return "—"
    if one.figure == "disk_margin" and one.attained == 0:
        return verdict("0, unstable", good=False)
    if not np.isfinite(one.attained):
        return verdict("∞", good=False)
    sign = "≥" if one.figure == "disk_margin" else "≤"
    scale = _SCALES.get(one.figure, 1.0)
    text = f"{scale * one.attained:.4f} {sign} {scale * one.bound:.4f}"
    return text if one.closed else verdict(f"{text}, open", good=False)


def radii(found: Certificates) -> Tabular:
    """Return the factors by which the box may grow, with what fails first."""
    rows: list[Row] = [
        [
            _FAILS[name],
            "—" if one.unproved else number(one.lower, 4),
            number(one.upper, 4),
            Cell(place_text(place_of(one.at)), "small"),
        ]
        for name, one in found.radii.items()
    ]
    columns = [wide("The box may grow until"), *right("safe up to", "fails at")]
    return Tabular("How far the box may grow", [*columns, wide("Where", detail=True)], rows)
