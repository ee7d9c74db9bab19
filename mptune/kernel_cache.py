"""Where compiled kernels are kept: one folder for each state of what a kernel is made of.

Numba notices changes in a kernel's own file but not in the functions it calls in other files, and
takes a file that was copied elsewhere for another. Here a kernel's folder is named after the text
of its file and of every file of mptune that it imports, directly or not: a change in any starts a
fresh folder, nothing else does, and every copy of the same text shares what is compiled.
"""

from __future__ import annotations

import hashlib
import os
import re
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numba
import platformdirs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_PACKAGE = Path(__file__).resolve().parent
_IMPORTED = re.compile(r"^\s*from (mptune[\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


@cache
def _imported(file: Path, package: Path) -> frozenset[Path]:
    """Return the files of the package that a file imports.

    Imports for type checking count too: they name the tuples whose layout is compiled in. What
    else stands in ``params`` are objects of Python, which no kernel takes.
    """
    found: set[Path] = set()
    for module, names in _IMPORTED.findall(file.read_text(encoding="utf-8")):
        place = package.joinpath(*module.split(".")[1:])
        candidates = {place / f"{name}.py" for name in re.findall(r"\w+", names)}
        found |= candidates | {place / "__init__.py", place.with_suffix(".py")}
    data = package / "params"
    return frozenset(
        path for path in found if path.is_file() and (path.parent != data or path.stem == "packed")
    )


@cache
def source_hash(file: Path, package: Path = _PACKAGE) -> str:
    """Return a short hash of a file and of all of the package that it imports."""
    todo, done = {file}, set[Path]()
    while todo:
        path = todo.pop()
        done.add(path)
        todo |= _imported(path, package) - done
    digest = hashlib.sha256()
    for path in sorted(done):
        digest.update(str(path.relative_to(package)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def _base() -> Path | None:
    """Return the folder of all kernels' folders, or None where nothing can be written."""
    place = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("mptune")
    folder = Path(place) / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None


def _file_of(function: Callable[..., Any]) -> Path:
    return Path(function.__code__.co_filename).resolve()


def folder_of(function: Callable[..., Any]) -> Path | None:
    """Return the folder of a function's compiled code, or None where there can be none."""
    base = _base()
    return None if base is None else base / source_hash(_file_of(function))


def is_compiled(kernel: Callable[..., Any]) -> bool:
    """Return whether the cache holds a kernel, or there is no cache to fill."""
    function = getattr(kernel, "py_func", kernel)
    folder = folder_of(function)
    return folder is None or any(folder.glob(f"*.{function.__name__}-*.nbi"))


class KernelLocator:
    """Numba's way to a kernel's folder: its protocol of cache locators."""

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self._line = function.__code__.co_firstlineno
        self._folder = folder

    @classmethod
    def from_function(cls, function: Callable[..., Any], _file: str) -> KernelLocator | None:
        """Return the locator of one function, or None where nothing can be written."""
        folder = folder_of(function)
        if folder is None:
            return None
        locator = cls(function, folder)
        try:
            locator.ensure_cache_path()
        except OSError:
            return None
        return locator

    def ensure_cache_path(self) -> None:
        """Make the folder; raise OSError where that fails."""
        self._folder.mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return what tells one state of the source from another: the folder's name."""
        return self._folder.name

    def get_disambiguator(self) -> str:
        """Return what tells apart functions of one name in one file: the line."""
        return str(self._line)


@contextmanager
def kept_for(function: Callable[..., Any]) -> Iterator[bool]:
    """Point numba to a function's folder while it is decorated; yield whether there is one.

    Other users of numba in this process keep their own folders. A numba that knows no locators
    uses the folder all the same, and only takes copies of a file for files of their own.
    """
    folder = folder_of(function)
    settings: Any = numba.config
    theirs = {name: getattr(settings, name, "") for name in ("CACHE_DIR", "CACHE_LOCATOR_CLASSES")}
    if folder is not None:
        settings.CACHE_DIR = str(folder)
        settings.CACHE_LOCATOR_CLASSES = f"{__name__}.{KernelLocator.__name__}"
    try:
        yield folder is not None
    finally:
        for name, value in theirs.items():
            setattr(settings, name, value)
