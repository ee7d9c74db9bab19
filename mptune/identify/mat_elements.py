"""The elements that a MAT file of version 5 is made of, walked before its reader sees them.

SciPy's reader takes an element's type for a place in a table without looking whether the table goes
that far: one wrong byte, and the process is gone. So types and lengths are checked here.
"""

from __future__ import annotations

import struct
import zlib
from typing import Final

_HEADER: Final = 128  # bytes
_TAG: Final = 8
_SMALL: Final = 4  # most bytes of an element within its own tag
_MATRIX, _COMPRESSED = 14, 15
_KNOWN: Final = frozenset({1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 16, 17, 18})  # numbers and text
_FEWEST_PARTS: Final = 3  # of a matrix: flags, dimensions, name
_DEEPEST: Final = 64


class BrokenElementError(ValueError):
    """An element of no known type, or longer than what holds it."""


def check_elements(content: bytes) -> None:
    """Refuse a file whose elements do not fit into one another.

    Files of other versions than 5 pass: their reader is another.

    Raises
    ------
    BrokenElementError
        At the first element that does not fit.
    """
    order = {b"IM": "<", b"MI": ">"}.get(content[_HEADER - 2 : _HEADER])
    if order is None:
        return
    place = _HEADER
    while place < len(content):
        kind, begin, end, _ = _element(content, place, len(content), order)
        if kind == _COMPRESSED:
            unpacking = zlib.decompressobj()
            inner = unpacking.decompress(content[begin:end])
            if not unpacking.eof:
                raise BrokenElementError("a packed element has no end")
            _check_matrix(inner, 0, len(inner), order, 0)
        else:
            _check_matrix(content, place, end, order, 0)
        place = end


def _check_matrix(content: bytes, place: int, most: int, order: str, depth: int) -> None:
    """Refuse an element that is no matrix, or whose parts do not fit into it."""
    kind, begin, end, _ = _element(content, place, most, order)
    if kind != _MATRIX or depth > _DEEPEST:
        raise BrokenElementError(f"an element of type {kind} stands where a matrix belongs")
    parts = 0
    while begin < end:
        kind, first, last, following = _element(content, begin, end, order)
        if kind == _MATRIX:
            if last > first:  # an empty cell has no parts
                _check_matrix(content, begin, end, order, depth + 1)
        elif kind not in _KNOWN:
            raise BrokenElementError(f"an element has the unknown type {kind}")
        begin, parts = following, parts + 1
    if parts < _FEWEST_PARTS:
        raise BrokenElementError("a matrix lacks flags, dimensions or name")


def _element(content: bytes, place: int, most: int, order: str) -> tuple[int, int, int, int]:
    """Return an element's type, begin and end of its content, and where the next one begins."""
    if place + _TAG > most:
        raise BrokenElementError("an element is cut off")
    kind, length = struct.unpack_from(f"{order}II", content, place)
    if kind >> 16:  # a small one: its length beside its type, its content in the tag
        kind, length = kind & 0xFFFF, kind >> 16
        begin, following = place + _SMALL, place + _TAG
        if length > _SMALL:
            raise BrokenElementError(f"a small element has {length} bytes")
    else:
        begin = place + _TAG
        padding = 0 if kind == _COMPRESSED else -length % _TAG
        following = min(begin + length + padding, most)
    if begin + length > most:
        raise BrokenElementError("an element is longer than what holds it")
    return kind, begin, begin + length, following
