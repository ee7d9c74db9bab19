"""What the page says in words: the verdict, the lamps, the progress of slow work."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.certify.result import Grounds
from mptune.escaping import html_text
from mptune.robust.result import Status
from mptune.robust.tables import place_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.robust.headline import Judgement
    from mptune.robust.result import Check

_SIGNS = {Status.SATISFIED: "✓", Status.VIOLATED: "✗", Status.UNSTABLE: "✗"}
_CLASSES = {Status.SATISFIED: "good", Status.VIOLATED: "bad", Status.UNSTABLE: "bad"}


def lamps(checks: Sequence[Check], proved: Sequence[Check] = (), kept: Sequence[Check] = ()) -> str:
    """Return the requirements as a list of lamps.

    Parameters
    ----------
    checks
        The grid's.
    proved
        The certified ones, which take their places where they are there.
    kept
        Those of the setting kept as A, beside them.
    """
    certified = {check.key: check for check in proved}
    others = {check.key: check for check in kept}
    shown = [certified.pop(check.key, check) for check in checks]
    shown += certified.values()
    items = "".join(_lamp(check, others.get(check.key)) for check in shown)
    return f'<ul class="lamps">{items}</ul>'


def _lamp(check: Check, kept: Check | None) -> str:
    sign, look = _SIGNS.get(check.status, "?"), _CLASSES.get(check.status, "open")
    grounds = check.grounds.value if check.grounds else "exact"
    beside = f'<span class="kept">A: {html_text(kept.found_text)}</span>' if kept else ""
    mark = "proved" if check.grounds is Grounds.CERTIFIED else "grid"
    return (
        f'<li class="lamp {look}" data-key="{html_text(check.key)}" data-grounds="{mark}" '
        f'data-status="{html_text(check.status.value)}" title="{html_text(place_text(check.at))}">'
        f'<span class="sign" aria-hidden="true">{sign}</span>'
        f'<span class="what">{html_text(check.label)} {html_text(check.limit)}</span>'
        f'<span class="found">{html_text(check.found_text)}</span>'
        f'<span class="grounds">{html_text(check.status.value)}, {html_text(grounds)}</span>'
        f"{beside}</li>"
    )


def verdict(judgement: Judgement | None, note: str) -> str:
    """Return the verdict's line: certified, or what is known while it is being made."""
    if judgement is None:
        return f'<p class="verdict open" role="status">{html_text(note)}</p>'
    look = "good" if judgement.met else "bad"
    return (
        f'<p class="verdict {look}" role="status"><strong>{html_text(judgement.word.value)}'
        f"</strong> (certified): {html_text(judgement.because)}</p>"
    )


def working(text: str, share: float | None) -> str:
    """Return a line on slow work, with a bar where its share is known."""
    bar = "<progress></progress>" if share is None else f'<progress value="{share:.3f}"></progress>'
    return f'<p class="working" role="status">{html_text(text)} {bar}</p>'


def moves(now: str, published: str) -> str:
    """Return how a simulated move went, with these gains and with the published ones."""
    return (
        f"<p><strong>Simulated move</strong>, these gains: {html_text(now)}.<br>"
        f"Published gains: {html_text(published)}.</p>"
    )


def said(text: str, *, wrong: bool = False) -> str:
    """Return a message; nothing for an empty one."""
    look = "wrong" if wrong else "note"
    return f'<p class="{look}" role="alert">{html_text(text)}</p>' if text else ""
