"""Texts in the characters that a terminal's encoding has: what it lacks is spelt out."""

from __future__ import annotations

import codecs
import re
import unicodedata

SPELLING = "mptune.spelling"
"""Name of the error handler that ``register`` gives the codecs."""

_RAISED = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"
_LEVEL = str.maketrans(_RAISED, "-0123456789")
_POWERS = re.compile(f"[{_RAISED}]+")
_HAT = "\u0302"  # combining, as in B̂
_WORDS = {
    "–": "-",
    "—": "-",
    "−": "-",
    "…": "...",
    "·": "*",
    "×": "x",
    "°": "deg",
    "√": "sqrt",
    "∞": "inf",
    "∑": "sum",
    "∈": "in",
    "≤": "<=",
    "≥": ">=",
    "≈": "~",
    "±": "+/-",
    "→": "->",
    "µ": "u",
    "μ": "u",
    "§": "sec. ",
    "′": "'",
    _HAT: "_hat",
    "\N{REPLACEMENT CHARACTER}": "?",
    **dict.fromkeys("‘’", "'"),
    **dict.fromkeys("“”„", '"'),
}


def spelt(text: str, encoding: str) -> str:
    """Return a text with every character that the encoding lacks spelt out: ``τ`` as ``tau``.

    Laid out after this, a table keeps its columns. A power is spelt whole or not at all.
    """
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        whole = _POWERS.sub(lambda power: _power(power[0], encoding), text)
        return whole.encode(encoding, SPELLING).decode(encoding)
    return text


def register() -> None:
    """Make the spelling known to every stream, as the error handler ``mptune.spelling``."""
    codecs.register_error(SPELLING, _spell)


def _power(text: str, encoding: str) -> str:
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return f"^{text.translate(_LEVEL)}"
    return text


def _spell(error: UnicodeError) -> tuple[str, int]:
    """Spell what could not be encoded; Python asks for its replacement, and where to go on."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end]
    return "".join(map(_word, lacking)), error.end


def _word(character: str) -> str:
    """Return one character in ASCII."""
    if character in _WORDS:
        return _WORDS[character]
    if character in _RAISED:
        return f"^{character.translate(_LEVEL)}"
    name = unicodedata.name(character, "")
    if name.startswith("GREEK") and " LETTER " in name:
        letter = name.split(" LETTER ")[1].split()[0].lower()
        return letter.capitalize() if character.isupper() else letter
    if name.startswith(("BRAILLE", "BOX DRAWINGS")):  # of progress bars and rules
        return "-"
    plain = unicodedata.normalize("NFKD", character)
    kept = "".join(one for one in plain if one.isascii())
    return kept or character.encode("ascii", "backslashreplace").decode("ascii")


register()
