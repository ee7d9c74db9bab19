"""Standard output and error that bear what a shell does to them.

* A stream that was closed before the start (``>&-``) leads nowhere. Its number is taken at once,
  or the next file that is opened would get it, and with it whatever is printed.
* A pipe whose reader has gone (``| head -1``) leads nowhere from then on: what the command found,
  and so its exit status, is the same.
* A full disk behind standard output is no defect but a result that could not be written.
* Characters that the encoding lacks are spelt out.
"""

from __future__ import annotations

import errno
import io
import os
import sys
from typing import TYPE_CHECKING, Any, TextIO

from mptune.cli.spelling import SPELLING

if TYPE_CHECKING:
    from typing_extensions import Buffer

_LAST_STANDARD = 2  # stdin, stdout, stderr
_GONE = {errno.EPIPE, errno.ESHUTDOWN, errno.EBADF}


def take_streams() -> Outlet:
    """Put streams that bear everything in the places of stdout and stderr; return stdout's end."""
    _fill_closed()
    out, err = (_outlet(stream) for stream in (sys.stdout, sys.stderr))
    sys.stdout, sys.stderr = _text(out, sys.stdout), _text(err, sys.stderr)
    return out


class Outlet(io.RawIOBase):
    """The end of a stream: it takes everything, and notes what could not be written.

    Attributes
    ----------
    failure
        The first error that is not a reader's leaving; None where there was none.
    """

    def __init__(self, raw: Any) -> None:
        super().__init__()
        self._raw = raw  # None where the stream was closed from the start
        self._open = raw is not None
        self.failure: OSError | None = None

    def write(self, data: Buffer) -> int:
        """Write bytes; say that all are written where nobody can take them."""
        if self._open:
            try:
                written: int | None = self._raw.write(data)
            except OSError as error:
                self._open = False
                if error.errno not in _GONE and not (os.name == "nt" and _is_invalid(error)):
                    self.failure = error
            else:
                return written or 0
        return memoryview(data).nbytes

    def writable(self) -> bool:
        """Return True: a stream that leads nowhere takes everything."""
        return True

    def isatty(self) -> bool:
        """Return whether a terminal is at the end."""
        return self._raw is not None and bool(self._raw.isatty())

    def fileno(self) -> int:
        """Return the stream's number."""
        if self._raw is None:
            raise io.UnsupportedOperation("fileno")
        return int(self._raw.fileno())


def _is_invalid(error: OSError) -> bool:
    """Return whether this is how Windows says that a pipe's reader has gone."""
    return error.errno == errno.EINVAL


def _outlet(stream: TextIO | None) -> Outlet:
    buffer = getattr(stream, "buffer", None)
    return Outlet(getattr(buffer, "raw", buffer))


def _text(outlet: Outlet, stream: TextIO | None) -> TextIO:
    """Return a text stream with the encoding and the buffering of another one."""
    if stream is not None:
        stream.flush()
    return io.TextIOWrapper(
        io.BufferedWriter(outlet),
        encoding=getattr(stream, "encoding", None) or "utf-8",
        errors=SPELLING,
        line_buffering=outlet.isatty() or stream is sys.stderr,
        write_through=bool(getattr(stream, "write_through", False)),
    )


def _fill_closed() -> None:
    """Let the numbers of closed standard streams lead nowhere, here and in child processes."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= _LAST_STANDARD:
        os.set_inheritable(number, True)
    os.close(number)
