"""The PDF: the template, the content and the figures, compiled by Typst without a network.

All texts reach the template as JSON strings and are printed as strings. A study's title that looks
like markup is therefore printed as it stands.
"""

from __future__ import annotations

import json
import tempfile
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from mptune.errors import OutputError
from mptune.files import write_whole
from mptune.report.content import content

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.report.content import Results

_TEMPLATE = "report.typ"


def write_report(path: Path, results: Results, figures: Mapping[str, bytes]) -> Path:
    """Write the report, whole or not at all.

    Parameters
    ----------
    path
        The PDF file.
    results
        What the run has produced.
    figures
        SVG bytes by name; a section whose figure is missing is left out.

    Raises
    ------
    OutputError
        If the file cannot be written, or the template does not compile.
    """
    import typst

    values = content(results)
    values["figures"] = sorted(figures)
    with tempfile.TemporaryDirectory(prefix="mptune-") as folder:
        root = Path(folder)
        template = resources.files("mptune.report").joinpath(_TEMPLATE).read_bytes()
        (root / _TEMPLATE).write_bytes(template)
        (root / "content.json").write_text(json.dumps(values), encoding="utf-8")
        for name, svg in figures.items():
            (root / f"{name}.svg").write_bytes(svg)
        try:
            pdf = typst.compile(root / _TEMPLATE, root=root, ignore_system_fonts=True)
        except typst.TypstError as error:
            raise OutputError(f"{path}: the report did not compile: {error.message}") from error
    return write_whole(path, pdf)
