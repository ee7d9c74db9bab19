"""What ``mptune compare`` prints: one column per set of gains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, new_table, verdict
from mptune.loops.broken import FORCE
from mptune.robust.tables import EQUATIONS
from mptune.units import number, shown

if TYPE_CHECKING:
    from rich.text import Text

    from mptune.job.compare import Compared


def compared(found: tuple[Compared, ...]) -> None:
    """Print gains, ratios, margins and indices side by side."""
    table = new_table("Gains compared")
    table.add_column("")
    for one in found:
        table.add_column(one.label, justify="right")
    for name, cells in _rows(found):
        table.add_row(name, *cells)
    console.print(table)


def _rows(found: tuple[Compared, ...]) -> list[tuple[str, list[str | Text]]]:
    rows: list[tuple[str, list[str | Text]]] = [("study", [one.sweep.study.name for one in found])]
    rows.append(("model", [f"{one.sweep.study.hash()[:12]}…" for one in found]))
    for key, unit, mark, _ in found[0].sweep.gains.quantities():
        values: list[str | Text] = [shown(getattr(one.sweep.gains, key), unit) for one in found]
        rows.append((mark, values))
    for key, unit, mark, _ in found[0].feedforward.quantities():
        if any(getattr(one.feedforward, key) for one in found):
            rows.append((mark, [shown(getattr(one.feedforward, key), unit) for one in found]))
    for n, name in enumerate(EQUATIONS.values()):
        conditions = [one.sweep.conditions[n] for one in found]
        ratios: list[str | Text] = [
            verdict(f"{condition.worst_ratio:.4f}", good=condition.satisfied)
            for condition in conditions
        ]
        rows += [(f"{name} left/right", ratios)]
    rows.append(("gain margin at F_ref, with path", [_margin(one, "filters") for one in found]))
    rows.append(("gain margin at F_ref, sampled", [_margin(one, "sampled") for one in found]))
    rows.append(("noise gain [N/m]", [number(one.sweep.noise_gain) for one in found]))
    for mass in sorted({mass for one in found for mass in one.index_ms}):
        indices: list[str | Text] = [_index(one, mass) for one in found]
        rows.append((f"linear index at {mass / 1e3:g} t [ms]", indices))
    for key in sorted({key for one in found for key in one.recorded if key[:6] != "linear"}):
        recorded: list[str | Text] = [
            number(float(one.recorded.get(key, float("nan")))) for one in found
        ]
        rows.append((f"recorded: {key}", recorded))
    met = [one.sweep.satisfied for one in found]
    words: list[str | Text] = [verdict("met" if ok else "not met", good=ok) for ok in met]
    rows.append(("requirements", words))
    return rows


def _margin(one: Compared, path: str) -> str:
    family = one.sweep.sampled if path == "sampled" else one.sweep.family(path)
    return number(family.worst("gain_margin", FORCE)[0], 3) if family else "—"


def _index(one: Compared, mass: float) -> str | Text:
    index = one.index_ms.get(mass)
    if index is None:
        return "—"
    return f"{index:.1f}" if index < float("inf") else verdict("unstable", good=False)
