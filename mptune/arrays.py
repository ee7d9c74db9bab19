"""Array types, the letters of their shapes, and the decorators of compiled kernels.

Shapes are written with these letters everywhere:

``N``
    plants of a family
``F``
    frequencies
``T``
    instants of time

Kernels are compiled by numba without fast-math. Numba notices changes in a kernel's own file but
not in the functions it calls in other files, so the compiled code is kept in a folder named after
a hash of every source file that kernels are made of: a change in any starts a fresh cache.
"""

from __future__ import annotations

import hashlib
import os
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numba
import numpy as np
import platformdirs
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Callable

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Equations are written once, for a number inside a kernel and for arrays of any shape alike.
Complex = Any
Real = Any

_Function = TypeVar("_Function", bound="Callable[..., Any]")

_DEFINES_KERNEL = re.compile(r"^@(?:\w+_)?kernel\b", re.MULTILINE)
_IMPORTED = re.compile(r"^\s*from (mptune[\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


@cache
def source_hash(package: Path = Path(__file__).parent) -> str:
    """Return a short hash of the files that define kernels and of all of mptune that they import.

    Imports for type checking count too: they name the tuples whose layout is compiled in.
    """
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(package.rglob("*.py"))}
    todo = {path for path, text in texts.items() if _DEFINES_KERNEL.search(text)}
    done: set[Path] = set()
    while todo:
        path = todo.pop()
        done.add(path)
        for module, names in _IMPORTED.findall(texts[path]):
            place = package.joinpath(*module.split(".")[1:])
            for name in ("__init__", *re.findall(r"\w+", names)):
                todo |= {place / f"{name}.py", place.with_suffix(".py")} & texts.keys() - done
    digest = hashlib.sha256()
    for path in sorted(done):
        digest.update(str(path.relative_to(package)).encode())
        digest.update(texts[path].encode())
    return digest.hexdigest()[:16]


@cache
def _cache_folder() -> str | None:
    """Return the folder for compiled kernels, or None where nothing can be written."""
    base = os.environ.get("NUMBA_CACHE_DIR") or platformdirs.user_cache_dir("mptune")
    folder = Path(base) / f"kernels-{source_hash()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return str(folder) if os.access(folder, os.W_OK) else None


def is_compiled(name: str) -> bool:
    """Return whether the cache holds a kernel of that name, or there is no cache to fill."""
    folder = _cache_folder()
    return folder is None or any(Path(folder).rglob(f"*.{name}-*.nbi"))


def _compiled(function: _Function, *, parallel: bool = False, inline: str = "never") -> _Function:
    folder = _cache_folder()
    # Numba reads its cache folder when a function is decorated; other users of numba in this
    # process keep theirs.
    settings: Any = numba.config
    previous = settings.CACHE_DIR
    settings.CACHE_DIR = folder or previous
    try:
        njit: Any = numba.njit
        decorate = njit(
            cache=folder is not None,
            nogil=True,
            error_model="numpy",
            parallel=parallel,
            inline=inline,
        )
        return cast("_Function", decorate(function))
    finally:
        settings.CACHE_DIR = previous


def kernel(function: _Function) -> _Function:
    """Compile a function of plain numbers, tuples and arrays."""
    return _compiled(function)


def inlined_kernel(function: _Function) -> _Function:
    """Compile a function into each of its callers: for inner loops that a call would slow down."""
    return _compiled(function, inline="always")


def parallel_kernel(function: _Function) -> _Function:
    """Compile a function whose ``numba.prange`` loops run on all cores."""
    return _compiled(function, parallel=True)


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array, marked read-only, for use inside frozen results."""
    array.setflags(write=False)
    return array
