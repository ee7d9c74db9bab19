"""``explore``: the page of a study, served until it is ended."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.explore.library import Library

if TYPE_CHECKING:
    from collections.abc import Callable

    from panel.viewable import Viewable

_EXTRA = "needs the extra `explore`", "pip install 'mptune[explore]'"


def explore(
    path: Path,
    overrides: tuple[str, ...] = (),
    uncertainty: str = "",
    out: Path = Path("reports"),
    *,
    grace: float | None = None,
    listening: Callable[[str], None] = print,
) -> None:
    """Serve the page of a study on the loopback interface, until Ctrl-C.

    Parameters
    ----------
    path, overrides, uncertainty
        The study, as of ``mptune.params.load.load_study``.
    out
        The folder for results.
    grace
        Seconds after which the server ends when the last tab has closed; None for never.
    listening
        Told the page's address as soon as the server answers.

    Raises
    ------
    InputError
        If the study cannot be loaded, or the extra ``explore`` is not installed.
    """
    library = Library.around(path, overrides, uncertainty)
    try:
        import panel as pn

        from mptune.explore.page import style
        from mptune.explore.server import PageServer
        from mptune.explore.session import Session
    except ImportError as error:
        raise InputError("explore", Fault("", "", *_EXTRA)) from error
    pn.extension(raw_css=[style("page.css")])

    def page() -> Viewable:
        location = pn.state.location
        session = Session(library, out, (location.search or "") if location else "")
        pn.state.on_session_destroyed(lambda _: session.close())
        return session.page.root

    server = PageServer(page, f"mptune explore: {library.names[0]}", grace)
    server.run(listening)
