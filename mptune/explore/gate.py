"""Who may speak to the page: a browser of this machine that was given the address.

Every path begins with a token that nobody can guess. A page of another site cannot read it, but it
could have its own name resolved to the loopback address, or send requests blindly: a foreign
``Host`` or ``Origin`` is refused before anything looks at the path.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tornado.routing import Router
from tornado.web import Application, OutputTransform, RequestHandler

if TYPE_CHECKING:
    from tornado.httputil import HTTPHeaders, HTTPMessageDelegate, HTTPServerRequest

LOOPBACK = "127.0.0.1"
_NAMES = (LOOPBACK, "localhost")


class Gate(Router):
    """The router in front of an application that answers requests of its own address alone.

    Parameters
    ----------
    application
        What answers them.
    port
        The port that the server listens on.
    """

    def __init__(self, application: Application, port: int) -> None:
        self._application = application
        self._refusal = Application([(r".*", Refusal)], log_function=_say_nothing)
        self._icon = Application([(r".*", NoIcon)], log_function=_say_nothing)
        self._hosts = frozenset(f"{name}:{port}" for name in _NAMES)

    def admits(self, headers: HTTPHeaders) -> bool:
        """Return whether a request names this server, and comes from it where it says whence."""
        if headers.get("Host", "").lower() not in self._hosts:
            return False
        origins = headers.get_list("Origin") + headers.get_list("Sec-WebSocket-Origin")
        return all(origin.lower().removeprefix("http://") in self._hosts for origin in origins)

    def find_handler(self, request: HTTPServerRequest, **_: Any) -> HTTPMessageDelegate | None:
        """Return what answers a request: the application, or a refusal."""
        if not self.admits(request.headers):
            return self._refusal.find_handler(request)
        wanted = self._icon if request.path.endswith("/favicon.ico") else self._application
        return wanted.find_handler(request)


class Refusal(RequestHandler):
    """The answer to a request that does not belong here."""

    def prepare(self) -> None:
        """Answer 403 and nothing else, whatever was asked."""
        self.set_status(403)
        self.finish("refused\n")

    def check_xsrf_cookie(self) -> None:
        """Ask for no cookie: the refusal stands anyway."""


class NoIcon(RequestHandler):
    """The answer to browsers that ask for an icon."""

    def get(self) -> None:
        """Answer that there is none."""
        self.set_status(204)


def _say_nothing(_handler: RequestHandler) -> None:
    """Keep refusals out of the log, where anybody could write."""


class GuardedHeaders(OutputTransform):
    """Headers with which the browser itself keeps the page from reaching anything else."""

    def transform_first_chunk(
        self,
        status_code: int,
        headers: HTTPHeaders,
        chunk: bytes,
        finishing: bool,  # noqa: FBT001 - tornado's
    ) -> tuple[int, HTTPHeaders, bytes]:
        """Add the headers."""
        del finishing
        headers["Content-Security-Policy"] = (
            "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; "
            "frame-ancestors 'none'; form-action 'none'; base-uri 'self'"
        )
        headers["Referrer-Policy"] = "no-referrer"
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Cross-Origin-Resource-Policy"] = "same-origin"
        return status_code, headers, chunk
