"""Bad inputs by rule: every key of a study, of each kind of field, times each way of being wrong.

The keys come from the models themselves, so that a new field is tried on the day it is declared.
"""

from __future__ import annotations

from typing import NamedTuple

from extremes import model_within

from mptune.params.study import Study


class Bad(NamedTuple):
    """One bad input: its kind, and the override that makes it."""

    kind: str
    override: str


DEEP = 3000
NUMBERS = {
    "no unit": "3",
    "wrong dimension": '"3 kg^3"',
    "unknown unit": '"3 furlwongs"',
    "words": '"many"',
    "nothing": '""',
    "not a number": '"nan m"',
    "infinite": "inf",
    "beyond floats": '"1e400 m"',
    "far below 0": '"-1e300 m"',
    "a date": "2020-01-01",
    "a time": "12:30:00",
    "a truth": "true",
    "a table": "{a = 1}",
    "an empty list": "[]",
    "a list of lists": "[[[1]]]",
    "5000 digits": "9" * 5000,
    "an integer of 80 bits": "0x" + "f" * 20,
    "NUL": '"\\u0000"',
    "a long text": '"' + "7" * 100_000 + '"',
    "nested lists": "[" * DEEP + "]" * DEEP,
    "nested tables": "{a = " * DEEP + "1" + "}" * DEEP,
}
OTHERS = {
    "a number": "3",
    "a date": "2020-01-01",
    "an unknown word": '"wrong"',
    "a long word": '"' + "w" * 100_000 + '"',
    "NUL": '"a\\u0000b"',
    "a table": "{a = 1}",
    "a list": "[1, true]",
    "a large integer": "0x" + "f" * 20,
    "nested lists": "[" * 40 + "]" * 40,
}


def fields(prefix="", model=Study):
    """Yield the dotted key of every field, and whether it is a quantity."""
    for name, field in model.model_fields.items():
        kind, extra = field.annotation, field.json_schema_extra
        within = model_within(kind)
        if within is not None:
            yield from fields(f"{prefix}{name}.", within)
        yield f"{prefix}{name}", isinstance(extra, dict) and "unit" in extra


def spoilt():
    """Return a bad input for each key and each way of being wrong, and what has no key."""
    found = [
        Bad(kind, f"{key}={text}")
        for key, quantity in fields()
        for kind, text in (NUMBERS if quantity else OTHERS).items()
        if key != "title" or kind not in {"an unknown word", "a long word", "NUL"}
    ]
    return [*found, *misspelt(), *tables()]


def misspelt():
    """Return keys that are none."""
    for key, _ in fields():
        yield Bad("an unknown key", f"{key}_=3")
        yield Bad("a key within a value", f"{key}.a.b.c=3")
    yield Bad("a deep key", "a." * DEEP + "a=3")
    yield Bad("a long key", "a" * 100_000 + "=3")
    many = ", ".join(f"k{n} = {n}" for n in range(2000))
    yield Bad("2000 unknown keys", f"oil={{{many}}}")


def tables():
    """Return tables written in place, which no file's reader has checked."""
    four = "[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]"
    for rows in ("[[0.0, 0.0]]", f"[[4.0, 0.0], {four}]", f"[[1.0, 0.0], {four}]", "[[0, nan]]"):
        move = f'[{{kind = "file", samples = {rows}, duration = "3 s", rest = "1 s"}}]'
        yield Bad("samples in place", f"manoeuvre={move}")
    wrong = '[{kind = "file", samples = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]], '
    yield Bad("samples in place", f'manoeuvre={wrong}duration = "9 s", rest = "1 s"}}]')
    for file in (
        "\\u0000",
        "a\\u0000.csv",
        "x" * 5000,
        "/",
        ".",
        "\\ud7ff",
        "../" * 2000 + "a.csv",
    ):
        yield Bad("a file's name", f'manoeuvre=[{{kind = "file", file = "{file}", rest = "1 s"}}]')
        yield Bad("a file's name", f'uncertainty.measured=["{file}"]')
        yield Bad("a file's name", f'load.table="{file}"')
    for rows in (
        "[[0.0, 0.0, 1.0]]",
        "[[1.0, 0.0, 1.0], [0.0, 0.0, 1.0]]",
        "[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]",
        "[[0.0, 0.0, 1.0], [1.0, 0.0, -1.0]]",
        "[[0.0, 0.0, 1.0], [1.0, 0.0, inf]]",
    ):
        yield Bad("a load's table in place", f"load.table={rows}")
    for rows in (
        "[]",
        "[[1, 1, 0]]",
        "[[0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0]]",
        "[[-1, 1, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0]]",
        "[[2, 1, 0], [1, 1, 0], [3, 1, 0], [4, 1, 0]]",
        "[[1, 1, nan], [2, 1, 0], [3, 1, 0], [4, 1, 0]]",
    ):
        yield Bad("a response in place", f'uncertainty.measured=[{{name = "r", rows = {rows}}}]')
    for seed in ("[-1]", "[100000000000000000000000]", "[0.5]", "[]"):
        yield Bad("seeds", f"verification.seeds={seed}")
