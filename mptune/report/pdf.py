"""The PDF: the template, the content and the figures, compiled by Typst without a network.

All texts reach the template as JSON strings and are printed as strings. A study's title that looks
like markup is therefore printed as it stands.
"""

from __future__ import annotations

import json
import tempfile
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from mptune.errors import OutputError
from mptune.escaping import printable_values
from mptune.report.blocks import plain

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.report.blocks import Document

_TEMPLATE, _EQUATIONS = "report.typ", "equations.typ"


def pdf(document: Document, figures: Mapping[str, bytes]) -> bytes:
    """Return the report as PDF, its figures from SVG bytes by name.

    Raises
    ------
    OutputError
        If the template does not compile.
    """
    files = {f"{name}.svg": svg for name, svg in figures.items()}
    files["content.json"] = json.dumps(
        printable_values(json.loads(json.dumps(document, default=plain)))
    ).encode()
    return compiled((_TEMPLATE, _EQUATIONS), files, "pdf")[0]


def compiled(
    templates: tuple[str, ...], files: Mapping[str, bytes], kind: Literal["pdf", "svg"]
) -> list[bytes]:
    """Return what Typst makes of the first template: one PDF, or one SVG per page.

    Raises
    ------
    OutputError
        If it does not compile.
    """
    import typst

    with tempfile.TemporaryDirectory(prefix="mptune-") as folder:
        root = Path(folder)
        for name in templates:
            content = resources.files("mptune.report").joinpath(name).read_bytes()
            (root / name).write_bytes(content)
        for name, content in files.items():
            (root / name).write_bytes(content)
        made = root / ("page-{0p}.svg" if kind == "svg" else "page.pdf")
        first = root / templates[0]
        try:
            typst.compile(first, output=made, root=root, ignore_system_fonts=True, format=kind)
        except typst.TypstError as error:
            raise OutputError(f"the report did not compile: {error.message}") from error
        return [page.read_bytes() for page in sorted(root.glob(f"page*.{kind}"))]
