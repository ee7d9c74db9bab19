"""Pages that the program itself can write: its commands, the keys of a study, the public names."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, get_args

import typer
from mkdocs.structure.files import File, Files

import mptune
from mptune.cli.main import app
from mptune.params.section import Section
from mptune.params.study import Study
from mptune.units import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mkdocs.config.defaults import MkDocsConfig

_KEYS, _COMMANDS, _NAMES = "[[keys of a study]]", "[[commands]]", "[[public names]]"


def on_page_markdown(markdown: str, **_: object) -> str:
    """Put the generated parts where pages ask for them."""
    if _KEYS in markdown:
        markdown = markdown.replace(_KEYS, "\n".join(_keys(Study, "")))
    if _COMMANDS in markdown:
        markdown = markdown.replace(_COMMANDS, "\n".join(_commands()))
    return markdown


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page of the public names for each room that holds some, and what lies at the root."""
    for room, names in _rooms().items():
        lines = [f"# {room}\n"]
        for name, home in names:
            lines.append(f"::: {home}\n    options:\n      heading: mptune.{name}\n")
        files.append(File.generated(config, f"python/{room}.md", content="\n".join(lines)))
    return files


def _rooms() -> dict[str, list[tuple[str, str]]]:
    """Return the public names with where they live, by the room they live in."""
    rooms: dict[str, list[tuple[str, str]]] = {}
    for name, (module, there) in sorted(mptune._HOMES.items()):
        parts = module.split(".")
        room = parts[1] if len(parts) > 2 else "common"
        rooms.setdefault(room, []).append((name, f"{module}.{there}"))
    return rooms


def _keys(section: type[Section], place: str) -> Iterator[str]:
    """Yield the tables of a section and of those within it, in the order of the program."""
    plain, within = [], []
    for name, field in section.model_fields.items():
        inner = next((one for one in _members(field.annotation) if _is_section(one)), None)
        (within if inner else plain).append((name, field, inner))
    if plain and place:
        yield f"\n### `{place}`\n\n{_first(section.__doc__)}\n"
        yield "| key | unit | symbol | meaning | allowed | default |\n|---|---|---|---|---|---|"
        yield from (_row(section, name, field) for name, field, _ in plain)
    for name, field, inner in within:
        many = "[[" if "tuple" in str(field.annotation) else "["
        inside = f"{place.strip('[]')}.{name}" if place else name
        named = f"{inside}.NAME" if "dict" in str(field.annotation) else inside
        if inner is not None and inner.__name__ != "UncertaintySet":  # the keys above, once more
            yield from _keys(inner, f"{many}{named}{many.replace('[', ']')}")


def _members(annotation: Any) -> Iterator[Any]:
    """Yield an annotation and all that it is made of."""
    yield annotation
    for one in get_args(annotation):
        yield from _members(one)


def _is_section(one: Any) -> bool:
    return isinstance(one, type) and issubclass(one, Section)


def _row(section: type[Section], name: str, field: Any) -> str:
    extra = field.json_schema_extra or {}
    unit = str(extra.get("unit", ""))
    cells = [
        f"`{name}`",
        "–" if unit in {"", "1"} else unit,
        str(extra.get("symbol", "")),
        field.description or "",
        _allowed(section, name, unit) if unit else _choices(field.annotation),
        _default(section, name, field, unit),
    ]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _allowed(section: type[Section], name: str, unit: str) -> str:
    low, high = (shown(end, unit) for end in section.bounds_of(name))
    kind = "pair, " if section.is_range(name) else ""
    return kind + (f"from {low}" if "∞" in high else f"{low} to {high}")


def _choices(annotation: Any) -> str:
    words = [one for one in _members(annotation) if isinstance(one, str)]
    return ", ".join(f"`{word}`" for word in words)


def _default(section: type[Section], name: str, field: Any, unit: str) -> str:
    if field.is_required():
        return "must be given"
    value = field.get_default(call_default_factory=True)
    if value is None or value in ("", (), {}):
        return "none"
    if unit:
        return shown(value, unit, ranged=section.is_range(name))
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


def _first(text: str | None) -> str:
    return " ".join((text or "").split("\n\n", maxsplit=1)[0].split())


def _commands() -> Iterator[str]:
    """Yield each command with its arguments and options."""
    group: Any = typer.main.get_command(app)
    context = group.make_context("mptune", [], resilient_parsing=True)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        arguments = [one.metavar for one in command.params if one.param_type_name == "argument"]
        usage = " ".join(["mptune", name, *arguments, "[OPTIONS]"])
        yield f"\n## mptune {name}\n\n{command.help}\n\n```text\n{usage}\n```\n"
        yield "| argument or option | meaning |\n|---|---|"
        for one in command.params:
            if one.param_type_name == "argument":
                yield f"| `{one.metavar}` | {_in_a_cell(one.help)} |"
            else:
                names, words = one.get_help_record(context)
                yield f"| `{names}` | {_in_a_cell(words)} |"


def _in_a_cell(text: str | None) -> str:
    return re.sub(r"([|\[\]])", r"\\\1", text or "")
