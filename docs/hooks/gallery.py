"""Each script of ``docs/examples`` as a page: its words, its code, what it prints and draws.

The scripts are run while the site is built, one after another, so that no picture can be older than
the program; one that fails stops the build.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jupytext
from mkdocs.structure.files import File, Files

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mkdocs.config.defaults import MkDocsConfig

ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "docs" / "examples"
PICTURES = ROOT / "reports" / "examples"
SAMPLE = ROOT / "docs" / "sample"
ORDER = (
    *("figure_3", "figure_5", "figures_6_and_7", "tune_and_certify"),
    *("own_loop", "record_to_gains", "onto_a_target"),
)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page per script, its pictures, a page that shows them all, and the sample report."""
    if {path.stem for path in SCRIPTS.glob("*.py")} != set(ORDER):
        raise ValueError("docs/hooks/gallery.py names other scripts than there are")
    overview = [
        "# Gallery\n\nEvery picture is made by the script below it, while this site is built.\n"
    ]
    for name in ORDER:
        page, pictures = _run(SCRIPTS / f"{name}.py")
        files.append(File.generated(config, f"examples/{name}.md", content=page))
        for picture in pictures:
            place = f"examples/{picture.name}"
            files.append(File.generated(config, place, abs_src_path=str(picture)))
        title = page.split("\n", 1)[0].removeprefix("# ")
        overview.append(f"## [{title}]({name}.md)\n")
        overview += [f"[![{title}]({picture.name})]({name}.md)\n" for picture in pictures[:1]]
    files.append(File.generated(config, "examples/index.md", content="\n".join(overview)))
    for path in SAMPLE.iterdir():
        files.append(File.generated(config, f"sample/{path.name}", abs_src_path=str(path)))
    return files


def _run(script: Path) -> tuple[str, list[Path]]:
    """Return the page of one script, and the pictures that it drew."""
    print(f"running {script.relative_to(ROOT)}", file=sys.stderr)  # noqa: T201 - takes seconds
    page, drawn, names = [], [], {"__name__": script.stem, "__file__": str(script)}
    with _at_the_root():
        for cell in jupytext.read(script).cells:
            if cell.cell_type == "markdown":
                page.append(cell.source)
                continue
            page.append(f"```python\n{cell.source}\n```")
            before = _pictures()
            printed = _printed(compile(cell.source, str(script), "exec"), names)
            if printed:
                page.append(f"```text\n{printed}\n```")
            now = _pictures()
            new = sorted(path for path in now if now[path] != before.get(path))
            page += [f"![{path.stem}]({path.name})" for path in new]
            drawn += new
    return "\n\n".join(page) + "\n", drawn


def _printed(code: Any, names: dict[str, Any]) -> str:
    """Run one cell and return what it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, names)  # noqa: S102 - the repository's own examples
    return printed.getvalue().rstrip()


def _pictures() -> dict[Path, int]:
    """Return every picture, with the time at which it was written [ns]."""
    return {path: path.stat().st_mtime_ns for path in PICTURES.rglob("*.svg")}


@contextlib.contextmanager
def _at_the_root() -> Iterator[None]:
    """Return the context of the repository's root, where the scripts are run."""
    here = Path.cwd()
    os.chdir(ROOT)
    os.environ["COLUMNS"] = "96"  # as wide as a page's text
    try:
        yield
    finally:
        os.chdir(here)
