"""One writer at a time: a task claims its files, and whoever comes second is told who has them.

The claim is a lock of the operating system on a file beside the results. It ends with its process,
however that ends: a file that a kill leaves behind claims nothing.
"""

from __future__ import annotations

import contextlib
import datetime as dt
import os
import platform
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_OWNER_BYTES = 400
_BEYOND = 1 << 20  # Windows keeps others from reading what is locked: a byte behind the text is


@contextmanager
def claimed(folder: Path, task: str, what: str) -> Iterator[None]:
    """Claim a folder for one task; several tasks may work in it, each of them once.

    Where the file system has no locks, as some network shares, nothing is claimed.

    Parameters
    ----------
    folder
        The folder of the task's results.
    task
        Its name, one for all that write the same files.
    what
        What is under way, in words for whoever comes second.

    Raises
    ------
    InputError
        If another process is at it, with that process's own words.
    """
    path = folder / f".{task}.lock"
    stream: BinaryIO | None = None
    with contextlib.suppress(OSError):  # no folder to write to: the task itself will say so
        stream = _opened(path, folder)
    if stream is None:
        yield
        return
    since = dt.datetime.now(dt.UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    owner = f"{what}, process {os.getpid()} on {platform.node()}, since {since}"
    try:
        with contextlib.suppress(OSError):  # a full disk: the claim holds, without its words
            stream.truncate(0)
            stream.seek(0)
            stream.write(owner.encode()[:_OWNER_BYTES])
            stream.flush()
        yield
    finally:
        _remove(path, stream)


def _opened(path: Path, folder: Path) -> BinaryIO:
    """Return the lock's file, locked; refuse where another process has it."""
    while True:
        stream = path.open("a+b")
        try:
            _lock(stream)
        except (BlockingIOError, PermissionError) as error:
            stream.seek(0)
            owner = stream.read(_OWNER_BYTES).decode(errors="replace") or "another process"
            stream.close()
            rule = f"is being written to by {owner}"
            remedy = "wait for its end, or choose another folder with --out"
            raise InputError(folder, Fault("", "", rule, remedy)) from error
        except OSError:  # no locks here
            return stream
        if _is_at(path, stream):
            return stream
        stream.close()  # its owner has removed it between our opening and our locking it


def _is_at(path: Path, stream: BinaryIO) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(stream.fileno()))
    except FileNotFoundError:
        return False


def _lock(stream: BinaryIO) -> None:
    """Lock a file without waiting; raise an error of PermissionError's kind where it is locked."""
    if sys.platform == "win32":
        import msvcrt

        stream.seek(_BEYOND)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _remove(path: Path, stream: BinaryIO) -> None:
    """Remove the lock's file, then let go of it: in the other order it might be another's."""
    if sys.platform == "win32":  # where an open file cannot be removed
        stream.close()
        with contextlib.suppress(OSError):
            path.unlink()
        return
    with contextlib.suppress(OSError):
        path.unlink()
    stream.close()
