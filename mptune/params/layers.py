"""A study's files laid over one another, and which of them wrote what.

``base = "../boom/study.toml"`` at the top of a study takes all keys and sources of another one;
what the study writes itself lies over them. Tables are merged key by key; all else, lists too, is
replaced whole. The command line lies over the files.

A source speaks of what its own file has written. So values that stay as they were keep theirs
where a study above states another one for their section, and a value that a study writes anew
without a source is not left under its base's.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_SOURCES = "sources"
_COMMAND_LINE = "--set"


@dataclass
class Layers:
    """The values of a study, as its files and the command line have written them.

    Built up here, then read by ``load_study``, which turns the names of files within into what
    those hold.

    Attributes
    ----------
    files
        Base first, the study's own file last.
    values
        What they say together.
    writers
        Which of the files wrote a value, by its dotted key; beyond the last is the command line.
    """

    files: tuple[Path, ...]
    values: dict[str, Any] = field(default_factory=dict)
    writers: dict[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, written: Sequence[tuple[Path, dict[str, Any]]]) -> Layers:
        """Lay the values of files over one another, the base's first."""
        layers = cls(tuple(path for path, _ in written))
        for number, (_, over) in enumerate(written):
            layers._settle_sources(number, over)
            layers._lay(number, over, layers.values, "")
        return layers

    def override(self, parts: Sequence[str], value: Any) -> None:
        """Set one value from the command line; a table, too, is replaced whole.

        Raises
        ------
        InputError
            If a part of the key before its last holds a value and no table.
        """
        key = ".".join(parts)
        section = self.values
        for part in parts[:-1]:
            section = section.setdefault(part, {})
            if not isinstance(section, dict):
                fault = Fault(key, "", "is not inside a section", f"`{part}` holds a value")
                raise InputError(_COMMAND_LINE, fault)
        self._put(len(self.files), section, parts[-1], key, value)

    def folder_of(self, key: str) -> Path:
        """Return the folder from which a value's file names are taken: that of its writer.

        On the command line they are taken from the study's.
        """
        last = len(self.files) - 1
        return self.files[min(self.writers.get(key, last), last)].parent

    def refusal(self, *faults: Fault) -> InputError:
        """Return the error that names, for each fault, the file that wrote the value at fault.

        Where several files wrote parts of it, that is the last of them; where nobody did, for it
        is missing, it is the study's own.
        """
        places = [self._place_of(fault.key) for fault in faults]
        if len(set(places)) == 1:
            return InputError(places[0], *faults)
        pairs = zip(faults, places, strict=True)
        return InputError(self.files[-1], *(replace(one, where=place) for one, place in pairs))

    def _place_of(self, key: str) -> str:
        own = len(self.files) - 1
        key = key.partition("[")[0]  # a list has one writer
        found = [
            number
            for written, number in self.writers.items()
            if _is_within(written, key) or _is_within(key, written)
        ]
        number = max(found, default=own)
        return str(self.files[number]) if number <= own else _COMMAND_LINE

    def _lay(self, number: int, over: dict[str, Any], under: dict[str, Any], prefix: str) -> None:
        for name, value in over.items():
            beneath, key = under.get(name), f"{prefix}{name}"
            if isinstance(value, dict) and isinstance(beneath, dict):
                self._lay(number, value, beneath, f"{key}.")
            else:
                self._put(number, under, name, key, value)

    def _put(self, number: int, section: dict[str, Any], name: str, key: str, value: Any) -> None:
        if isinstance(section.get(name), dict):
            for written in [one for one in self.writers if _is_within(one, key)]:
                del self.writers[written]
        section[name] = value
        self.writers.pop(key, None)
        self.writers.update(dict.fromkeys(_leaves(value, key), number))

    def _settle_sources(self, number: int, over: dict[str, Any]) -> None:
        """Let each source so far speak of what was written so far, and of nothing else."""
        sources, stated = self.values.get(_SOURCES), over.get(_SOURCES, {})
        if not isinstance(sources, dict) or not isinstance(stated, dict):
            return
        under, above = _sourced(self.values), _sourced(over)
        restated = {key for key in stated if isinstance(sources.get(key), str)}
        for key in under.keys() - above.keys() - sources.keys():
            section = _section_of(key)
            if section in restated and sources[section] != stated[section]:
                writer = self.writers.get(f"{_SOURCES}.{section}", number)
                self._put(writer, sources, key, f"{_SOURCES}.{key}", sources[section])
        for key, value in above.items():
            section = _section_of(key)
            if section in stated:
                sources.pop(key, None)
                self.writers.pop(f"{_SOURCES}.{key}", None)
            elif under.get(key) != value and (key in sources or section in sources):
                file = self.files[number].resolve()
                text = f"assumed: set in {file.parent.name}/{file.name}, which states no source"
                self._put(number, sources, key, f"{_SOURCES}.{key}", text)


def _sourced(values: dict[str, Any]) -> dict[str, Any]:
    """Return every value that a source may speak of, by its dotted key."""
    return _leaves({name: value for name, value in values.items() if name != _SOURCES})


def _leaves(value: Any, key: str = "") -> dict[str, Any]:
    """Return every value that is no table, by its dotted key."""
    return dict(_each_leaf(value, key))


def _each_leaf(value: Any, key: str) -> Iterator[tuple[str, Any]]:
    if not isinstance(value, dict):
        yield key, value
        return
    for name, inner in value.items():
        yield from _each_leaf(inner, f"{key}.{name}" if key else name)


def _is_within(key: str, other: str) -> bool:
    """Return whether a dotted key is another one, or stands under it."""
    return key == other or key.startswith(f"{other}.")


def _section_of(key: str) -> str:
    return key.rsplit(".", 1)[0]
