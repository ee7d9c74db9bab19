"""The PDF: the template, the content and the figures, compiled by Typst without a network.

All texts reach the template as JSON strings and are printed as strings. A study's title that looks
like markup is therefore printed as it stands.
"""

from __future__ import annotations

import json
import tempfile
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from mptune.errors import OutputError
from mptune.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping

_TEMPLATE, _EQUATIONS = "report.typ", "equations.typ"


def write_pdf(path: str | Path, document: Mapping[str, Any], figures: Mapping[str, bytes]) -> Path:
    """Write the report, whole or not at all.

    Parameters
    ----------
    path
        The PDF file.
    document
        What it says, see ``mptune.report.content``.
    figures
        SVG bytes by name.

    Raises
    ------
    OutputError
        If the file cannot be written, or the template does not compile.
    """
    files = {f"{name}.svg": svg for name, svg in figures.items()}
    files["content.json"] = json.dumps(document).encode()
    (pdf,) = compiled(path, (_TEMPLATE, _EQUATIONS), files, "pdf")
    return write_whole(path, pdf)


def compiled(
    path: str | Path,
    templates: tuple[str, ...],
    files: Mapping[str, bytes],
    kind: Literal["pdf", "svg"],
) -> list[bytes]:
    """Return what Typst makes of the first template: one PDF, or one SVG per page.

    Raises
    ------
    OutputError
        If it does not compile; ``path`` is what was to be written.
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
            raise OutputError(f"{path}: the report did not compile: {error.message}") from error
        return [page.read_bytes() for page in sorted(root.glob(f"page*.{kind}"))]
