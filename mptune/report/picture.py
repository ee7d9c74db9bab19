"""Pictures of other commands, made anew of what a figure needs: shapes, texts, and nothing else.

An SVG can run scripts, fetch files and restyle the page that it stands in. What was found in a
folder may come from anywhere, so that its elements, attributes and values are copied by name from
an allowed set, and what is not in it is left out.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

_SVG: Final = "http://www.w3.org/2000/svg"
_XLINK: Final = "http://www.w3.org/1999/xlink"
LARGEST: Final = 20_000_000  # bytes
_DEEPEST: Final = 100  # elements within elements
_ELEMENTS: Final = frozenset(
    {"svg", "g", "defs", "pattern", "path", "use", "text", "tspan", "clipPath", "image"}
    | {"rect", "circle", "ellipse", "line", "polyline", "polygon"}
)
_ATTRIBUTES: Final = frozenset(
    {"id", "d", "x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "dx", "dy"}
    | {"width", "height", "viewBox", "version", "transform", "points", "preserveAspectRatio"}
    | {"clip-path", "clip-rule", "fill-rule", "patternUnits"}
)
_PROPERTIES: Final = frozenset(
    {"fill", "stroke", "opacity", "stroke-width", "stroke-opacity", "fill-opacity"}
    | {"stroke-linejoin", "stroke-linecap", "stroke-dasharray", "stroke-dashoffset"}
    | {"stroke-miterlimit", "text-anchor", "font", "font-family", "font-size", "font-weight"}
    | {"font-style", "image-rendering"}
)
_VALUE: Final = re.compile(r"(?:url\(#[\w.-]+\)|[\w\s#.,:;%+'\"-]|\((?=[\w\s.,+%-]*\))|\))*")
_JOINED: Final = {"stroke-linejoin": "round", "stroke-linecap": "butt"}
_OWN: Final = re.compile(r"#[\w.-]+")
_PIXELS: Final = re.compile(r"data:image/png;base64,[A-Za-z0-9+/=\s]*")

ET.register_namespace("", _SVG)
ET.register_namespace("xlink", _XLINK)


def safe_picture(svg: bytes) -> bytes:
    """Return an SVG that holds shapes and texts only, whatever the one given holds.

    Raises
    ------
    ValueError
        If it is no SVG, or declares entities, or is larger than any figure of ours, or cannot be
        drawn.
    """
    if len(svg) > LARGEST:
        raise ValueError(f"is larger than {LARGEST / 1e6:g} MB")
    if b"<!ENTITY" in svg or b"\0" in svg:
        raise ValueError("declares entities, or is not UTF-8")
    try:
        root = ET.fromstring(svg)  # noqa: S314 - without entities; a document of 20 MB at most
    except (ET.ParseError, RecursionError, LookupError) as error:
        raise ValueError(f"is no XML: {error}") from error
    if _local(root.tag) != "svg":
        raise ValueError("is no SVG")
    copy = _copied(root)
    copy.attrib |= _JOINED  # as our figures say in a style for everything
    found = ET.tostring(copy, "unicode").encode()
    _check_drawable(found)
    return found


def _check_drawable(svg: bytes) -> None:
    """Refuse a picture that the report would not compile with: one without a size, say."""
    import typst

    with tempfile.TemporaryDirectory(prefix="mptune-") as folder:
        path = Path(folder) / "one.typ"
        (path.parent / "one.svg").write_bytes(svg)
        path.write_text('#image("one.svg")')
        try:
            typst.compile(path, root=path.parent, ignore_system_fonts=True)
        except typst.TypstError as error:
            raise ValueError(f"cannot be drawn: {error.message}") from error


def _copied(element: ET.Element) -> ET.Element:
    """Return what is allowed of an element and of those within it; the walk is a loop."""
    top = _bare(element)
    waiting = [(element, top, 0)]
    while waiting:
        before, after, depth = waiting.pop()
        if depth > _DEEPEST:
            raise ValueError("is nested deeper than any figure")
        for inner in before:
            if _local(inner.tag) in _ELEMENTS:
                copy = _bare(inner)
                after.append(copy)
                waiting.append((inner, copy, depth + 1))
    return top


def _bare(element: ET.Element) -> ET.Element:
    name = _local(element.tag)
    copy = ET.Element(f"{{{_SVG}}}{name}")
    if name in {"text", "tspan"}:
        copy.text = element.text
    copy.tail = element.tail if name == "tspan" else None
    for key, value in element.attrib.items():
        local = _local(key)
        if local == "href":
            allowed = _PIXELS if name == "image" else _OWN
            if allowed.fullmatch(value):
                copy.set(f"{{{_XLINK}}}href", value)
        elif key == "style":
            copy.set(key, _style(value))
        elif key in _ATTRIBUTES | _PROPERTIES and _VALUE.fullmatch(value):
            copy.set(key, value)
    return copy


def _style(text: str) -> str:
    """Return the declarations that draw; none that would place a picture over the page."""
    pairs = (one.partition(":") for one in text.split(";"))
    allowed = (
        f"{name.strip()}: {value.strip()}"
        for name, _, value in pairs
        if name.strip() in _PROPERTIES and _VALUE.fullmatch(value)
    )
    return "; ".join(allowed)


def _local(tag: object) -> str:
    """Return a name without its namespace; nothing for comments and instructions."""
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""
