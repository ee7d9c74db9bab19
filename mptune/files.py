"""Files are written whole or not at all, and read with errors that say what to do.

A file is first written beside its final place, flushed to the disk and then renamed, so that a
full disk, a lost permission or an interrupt leaves the earlier file as it was.
"""

from __future__ import annotations

import contextlib
import glob
import hashlib
import os
import platform
import secrets
import stat
import tempfile
from pathlib import Path

from mptune.errors import Fault, InputError, OutputError

LARGEST_TEXT = 20_000_000  # bytes: half a million rows, read in seconds
_MACHINE = hashlib.sha256(platform.node().encode()).hexdigest()[:8]


def read_text(path: str | Path, remedy: str = "check the path") -> str:
    """Return the text of a UTF-8 file, without the byte-order mark that some editors write.

    Parameters
    ----------
    path
        The file.
    remedy
        What to do where there is no such file, or nothing in it: who writes it, say.

    Raises
    ------
    InputError
        If the path is missing, is no regular file, is larger than ``LARGEST_TEXT``, may not be
        read, is empty or is not UTF-8 text.
    """
    try:
        _refuse_what_has_no_end(path)
        text = Path(path).read_bytes().decode("utf-8-sig")
    except FileNotFoundError as error:
        raise InputError(path, Fault("", "", "does not exist", remedy)) from error
    except IsADirectoryError as error:
        fault = Fault("", "", "is a folder, not a file", "name the file inside it")
        raise InputError(path, fault) from error
    except UnicodeDecodeError as error:
        fault = Fault("", "", f"is not UTF-8 text (byte {error.start})", "save it as UTF-8")
        raise InputError(path, fault) from error
    except OSError as error:
        fault = Fault("", "", f"cannot be read: {error.strerror}", "check its permissions")
        raise InputError(path, fault) from error
    except ValueError as error:  # NUL, or halves of pairs
        fault = Fault("", repr(str(path)), "is no path that a file can have", "check the path")
        raise InputError("path", fault) from error
    if not text.strip():
        raise InputError(path, Fault("", "", "is empty", remedy))
    return text


def _refuse_what_has_no_end(path: str | Path) -> None:
    """Refuse devices and pipes, of which a study may name one, and files too large to be text."""
    found = Path(path).stat()
    if stat.S_ISDIR(found.st_mode):
        return  # reading it says so
    if not stat.S_ISREG(found.st_mode):
        fault = Fault("", "", "is no regular file", "write its content into a file, and name that")
        raise InputError(path, fault)
    if found.st_size > LARGEST_TEXT:
        size = f"is {found.st_size / 1e6:.0f} MB of text, {LARGEST_TEXT / 1e6:g} MB at most"
        raise InputError(path, Fault("", "", size, "shorten it, or record as MAT 7.3 or MDF 4"))


def is_there(path: str | Path) -> bool:
    """Return whether there is a file, or a folder, of that name.

    Raises
    ------
    InputError
        If no file can have that name: it is too long, say.
    """
    try:
        Path(path).stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError) as error:  # too long; NUL, or halves of pairs
        why = f": {error.strerror}" if isinstance(error, OSError) else ""
        fault = Fault("", repr(str(path)), f"is no path that a file can have{why}", "rename it")
        raise InputError("path", fault) from error
    return True


def make_folder(path: str | Path) -> Path:
    """Create a folder for results and check that it can be written to, before any long work.

    Raises
    ------
    InputError
        If the folder cannot be created, or nothing can be written into it.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        rule = f"cannot hold results: {error.strerror or error}"
        fault = Fault("", "", rule, "choose another folder with --out, or mend its permissions")
        raise InputError(path, fault) from error
    return path


def _clear_after_kills(path: Path) -> None:
    """Remove what writers of a file have left half-written beside it that were killed at it."""
    if os.name != "posix":  # elsewhere to ask for a process may end it
        return
    for left in path.parent.glob(f".{glob.escape(path.stem)}.{_MACHINE}-*.part*"):
        owner = left.name.rpartition(f".{_MACHINE}-")[2].partition("-")[0]
        if owner.isdecimal() and not _runs(int(owner)):
            left.unlink(missing_ok=True)


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # another user's, or none that there can be
        return True
    return True


def write_whole(path: str | Path, content: bytes | str) -> Path:
    """Write a file whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written; an earlier file of that name is then untouched.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    path = Path(path)
    # Among machines that share a folder, and among threads, a process's number is not unique.
    mark = f"{_MACHINE}-{os.getpid()}-{secrets.token_hex(4)}"
    beside = path.with_name(f".{path.stem}.{mark}.part{path.suffix}")
    try:
        _clear_after_kills(path)
        with beside.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        beside.replace(path)
    except OSError as error:
        raise OutputError(
            f"{path}: could not be written ({error.strerror or error}); nothing was changed; "
            "free some space or choose another folder with --out"
        ) from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
    return path
