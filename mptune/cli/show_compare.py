"""What ``mptune compare`` prints: one column per set of gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.terminal import say, show
from mptune.loops.broken import FORCE
from mptune.report.blocks import Cell, Row, Tabular, left, right, verdict
from mptune.report.content.front import differs
from mptune.report.content.loops import ratio_text
from mptune.robust.tables import EQUATIONS
from mptune.units import number, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.job.compare import Compared
    from mptune.params.section import Section


def told(found: tuple[Compared, ...]) -> None:
    """Print the verdict on each set of gains, a line each."""
    for one in found:
        say(verdict(f"{one.label}: {one.judgement.line}", good=one.judgement.met))
    say("")


def compared(found: tuple[Compared, ...]) -> None:
    """Print gains, ratios, margins and indices side by side."""
    columns = [*left(""), *right(*(one.label for one in found))]
    show(Tabular("Gains compared", columns, list(_rows(found))))
    for one in found:
        if one.differs:
            show(differs(one.differs, f"{one.label}: made for another model"))


def _rows(found: tuple[Compared, ...]) -> Iterator[Row]:
    yield ["study", *(one.sweep.study.name for one in found)]
    yield ["model", *(f"{one.sweep.study.hash()[:12]}…" for one in found)]
    yield from _quantities([one.sweep.gains for one in found])
    yield from _quantities([one.feedforward for one in found], used=True)
    for n, name in enumerate(EQUATIONS.values()):
        conditions = [one.sweep.conditions[n] for one in found]
        yield [
            f"{name} left/right",
            *(verdict(ratio_text(one), good=one.satisfied) for one in conditions),
        ]
    yield [
        "gain margin at F_ref, with path",
        *(_margin(one, one.sweep.model.paths[1]) for one in found),
    ]
    yield ["gain margin at F_ref, sampled", *(_margin(one, "sampled") for one in found)]
    yield ["noise gain [N/m]", *(number(one.sweep.noise_gain) for one in found)]
    for mass in sorted({mass for one in found for mass in one.index_ms}):
        yield [
            f"linear-check index at {mass / 1e3:g} t [ms]",
            *(_index(one, mass) for one in found),
        ]
    for key in sorted(
        {key for one in found for key in one.recorded if not key.startswith("linear")}
    ):
        recorded = (number(float(one.recorded.get(key, float("nan")))) for one in found)
        yield [f"recorded: {key}", *recorded]
    judged = [one.judgement for one in found]
    yield ["verdict", *(verdict(one.word.value, good=one.met) for one in judged)]


def _quantities(found: list[Section], *, used: bool = False) -> Iterator[Row]:
    """Yield a row per gain, with ``used`` only of those that are not off everywhere."""
    for key, unit, mark, _ in found[0].quantities():
        values = [getattr(one, key) for one in found]
        if any(values) or not used:
            yield [mark, *(shown(value, unit) for value in values)]


def _margin(one: Compared, path: str) -> str:
    family = one.sweep.sampled if path == "sampled" else one.sweep.family(path)
    return number(family.worst("gain_margin", FORCE)[0], 3) if family else "—"


def _index(one: Compared, mass: float) -> str | Cell:
    index = one.index_ms.get(mass)
    if index is None:
        return "—"
    return f"{index:.1f}" if index < float("inf") else verdict("unstable", good=False)
