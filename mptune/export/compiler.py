"""A C compiler, where there is one."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

from mptune.errors import MptuneError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def find_compiler() -> tuple[str, ...]:
    """Return the command of the system's C compiler, or of zig's where that is installed.

    Raises
    ------
    MptuneError
        If there is none.
    """
    for name in ("cc", "gcc", "clang"):
        found = shutil.which(name)
        if found:
            return (found,)
    if importlib.util.find_spec("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc")
    raise MptuneError(
        "no C compiler was found (cc, gcc, clang, or zig's in the package ziglang); a function "
        "mock-up unit needs one: install one, or export the sources with --to c"
    )


def compile_library(sources: Sequence[Path], library: Path, flags: Sequence[str]) -> Path:
    """Compile sources into a shared library.

    Raises
    ------
    MptuneError
        If there is no compiler, or it refuses the sources.
    """
    command = [*find_compiler(), *flags, "-fPIC", "-shared", "-o", str(library)]
    command += [*(str(source) for source in sources), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - no shell, own files
    if done.returncode != 0:
        raise MptuneError(f"{command[0]} could not compile the controller:\n{done.stderr.strip()}")
    return library
