"""The server behind the page: on the loopback interface, at an address that nobody can guess."""

from __future__ import annotations

import asyncio
import logging
import secrets
import signal
import time
from typing import TYPE_CHECKING, Any

from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from panel.io.application import build_applications
from panel.io.server import get_static_routes
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop, PeriodicCallback
from tornado.iostream import StreamClosedError
from tornado.netutil import bind_sockets
from tornado.websocket import WebSocketClosedError

from mptune.explore.gate import LOOPBACK, Gate, GuardedHeaders

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop
    from collections.abc import Callable

    from panel.viewable import Viewable

_GLANCE = 250  # ms, between looks at how many tabs are open
# ms, that a session may wait for its tab to connect, or outlives it, and between looks. A session
# that is made anew because its tab came too late, behind kernels that were being compiled, would
# look for Panel's styles elsewhere.
_LIFETIME, _CHECK = 300_000, 5_000
# s, that a page's token counts. It is given out before the page is made, and kernels that are kept
# nowhere are compiled meanwhile: minutes on a busy machine, after which a tab would stay empty.
_TOKEN = 24 * 3600


class PageServer:
    """One page, served to tabs of this machine's browsers.

    Parameters
    ----------
    page
        Makes what a tab shows; called once per tab.
    title
        The page's title.
    grace
        Seconds after which the server ends when the last tab has closed; None for never.
    """

    def __init__(self, page: Callable[[], Viewable], title: str, grace: float | None) -> None:
        self._loop, self._grace = IOLoop.current(), grace
        self._seen, self._alone_since = False, time.monotonic()
        sockets = bind_sockets(0, LOOPBACK)
        port = sockets[0].getsockname()[1]
        prefix = f"/{secrets.token_urlsafe(24)}"
        self.address = f"http://{LOOPBACK}:{port}{prefix}/"
        application = BokehTornado(
            build_applications({"/": page}, title=title),
            prefix=prefix,
            extra_websocket_origins=[f"{LOOPBACK}:{port}", f"localhost:{port}"],
            extra_patterns=get_static_routes({}),
            unused_session_lifetime_milliseconds=_LIFETIME,
            check_unused_sessions_milliseconds=_CHECK,
            session_token_expiration=_TOKEN,
            use_index=False,
            redirect_root=False,
        )
        application.add_transform(GuardedHeaders)
        web = HTTPServer(Gate(application, port))
        web.add_sockets(sockets)
        self._server = BaseServer(self._loop, application, web)

    def tabs(self) -> int:
        """Return how many tabs are connected."""
        return sum(session.connection_count for session in self._server.get_sessions())

    def run(self, listening: Callable[[str], None]) -> None:
        """Serve until Ctrl-C, a request to end, or the last tab's end where that is asked for.

        Parameters
        ----------
        listening
            Told the address as soon as the server answers.
        """
        for name in (signal.SIGINT, signal.SIGTERM):
            signal.signal(name, lambda *_: self._loop.add_callback_from_signal(self._loop.stop))
        logging.getLogger("tornado.access").setLevel(logging.WARNING)
        self._loop.add_callback(_forgive_closed_tabs)
        self._server.start()
        if self._grace is not None:
            PeriodicCallback(self._look, _GLANCE).start()
        self._loop.add_callback(listening, self.address)
        try:
            self._loop.start()
        finally:
            self._server.stop(wait=False)

    def _look(self) -> None:
        """End where no tab has been open for the grace time, once there was one."""
        now = time.monotonic()
        if self.tabs():
            self._seen, self._alone_since = True, now
        elif self._seen and now - self._alone_since >= (self._grace or 0.0):
            self._loop.stop()


def _forgive_closed_tabs() -> None:
    """Let the running loop report what failed unseen, but not that a tab had closed."""
    asyncio.get_running_loop().set_exception_handler(_unless_a_tab_closed)


def _unless_a_tab_closed(loop: AbstractEventLoop, context: dict[str, Any]) -> None:
    if not isinstance(context.get("exception"), WebSocketClosedError | StreamClosedError):
        loop.default_exception_handler(context)
