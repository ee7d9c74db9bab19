"""A whole study like another one: its bases laid together, its files beside it, keys explained.

What a study was based on may be out of reach where it is copied to, and its comments would not
fit what lies over them. So the values are written anew, as they stand in the files, each with the
symbol and the meaning that its field has.
"""

from __future__ import annotations

from types import UnionType
from typing import TYPE_CHECKING, Any, get_args

import tomlkit

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.params.format import FORMAT_KEY, STUDY_FORMAT
from mptune.params.load import load_study, read_layers
from mptune.params.study import Study

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from pydantic.fields import FieldInfo
    from tomlkit.items import AoT, Item, Table

    from mptune.params.layers import Layers

_ALIKE = "after another study, whole: replace what your machine has otherwise"


def write_alike(path: Path, source: Path) -> Path:
    """Write a study's values, and the files that they name, to a new study's file.

    Its title is the new study's name. The studies that it is compared with, ``systems.beside``,
    are left out: they belong to the machine that it was.

    Parameters
    ----------
    path
        The file to write, its folder made where there is none.
    source
        The study's file.

    Raises
    ------
    InputError
        If the study cannot be loaded, or a file that it names is there already under that name.
    OutputError
        If a file cannot be written.
    """
    load_study(source)  # says what is wrong with it
    layers = read_layers(source)
    layers.values["title"] = path.parent.name
    layers.values.get("systems", {}).pop("beside", None)
    copies = dict(_take_files(layers))
    for name in copies:
        if (path.parent / name).exists():
            fault = Fault("", "", "exists already", f"move it: {source} has a file of that name")
            raise InputError(path.parent / name, fault)
    make_folder(path.parent)
    for name, file in copies.items():
        write_whole(path.parent / name, file.read_bytes())
    document = tomlkit.document()
    document.add(tomlkit.comment(f"{path.parent.name}, {_ALIKE}."))
    document.add(tomlkit.comment("Say under [sources] where your values come from."))
    document.add(tomlkit.nl())
    document.add(FORMAT_KEY, STUDY_FORMAT.newest)
    _fill(document, layers.values, Study)
    return write_whole(path, tomlkit.dumps(document))


def _take_files(layers: Layers) -> Iterator[tuple[str, Path]]:
    """Yield the files that a study names, each under the name that takes its place, put there."""
    taken: dict[Path, str] = {}
    for key, holder, place in _names(layers.values):
        file = (layers.folder_of(key) / holder[place]).resolve()
        if file not in taken:
            alike = sum(one.name == file.name for one in taken)
            taken[file] = f"{file.stem}-{alike + 1}{file.suffix}" if alike else file.name
            yield taken[file], file
        holder[place] = taken[file]


def _names(values: dict[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    """Yield every file's name in a loaded study: its writer's key, and what holds it where."""
    for move in values["manoeuvre"]:
        if "file" in move:
            yield "manoeuvre", move, "file"
    if isinstance(values["load"].get("table"), str):
        yield "load.table", values["load"], "table"
    box = values["uncertainty"]
    boxes = {"uncertainty": box}
    boxes |= {f"uncertainty.sets.{name}": one for name, one in box.get("sets", {}).items()}
    for key, one in boxes.items():
        files = one.get("measured", [])
        for number, file in enumerate(files):
            if isinstance(file, str):
                yield f"{key}.measured", files, number


def _fill(table: Table | tomlkit.TOMLDocument, values: dict[str, Any], kind: Any) -> None:
    """Fill a table with values in the order of their kind's fields, those that are no table first.

    ``kind`` is a section, or a ``dict`` of names, as of sets and sources.
    """
    fields = getattr(kind, "model_fields", {})
    known = [*fields]
    ordered = sorted(values, key=lambda key: known.index(key) if key in fields else len(known))
    for key in ordered:
        if not _holds_tables(values[key]):
            table.add(key, _explained(values[key], fields.get(key)))
    for key in ordered:
        if _holds_tables(values[key]):
            inner = fields[key].annotation if key in fields else (None, *get_args(kind))[-1]
            table.add(key, _as_table(values[key], inner))


def _holds_tables(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and isinstance(value[0], dict))


def _as_table(value: Any, kind: Any) -> Table | AoT:
    """Return a dictionary as a table, or a list of them as one table each."""
    if isinstance(value, list):
        tables = tomlkit.aot()
        for number, one in enumerate(value):  # explained once
            tables.append(_as_table(one, None if number else get_args(kind)[0]))
        return tables
    table = tomlkit.table()
    _fill(table, value, get_args(kind)[0] if isinstance(kind, UnionType) else kind)
    return table


def _explained(value: Any, field: FieldInfo | None) -> Item:
    """Return a value with symbol and meaning as its comment."""
    item: Item = tomlkit.item(value)
    extra = field.json_schema_extra if field is not None else None
    symbol = f"{extra['symbol']}, " if isinstance(extra, dict) and "symbol" in extra else ""
    if field is not None and field.description:
        item.comment(f"{symbol}{field.description}")
    return item
