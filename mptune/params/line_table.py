"""The table of lines that machine and controller share: where pressures and oil come from.

``mptune.params.packed`` says what its rows hold.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import frozen
from mptune.params.lines import PAPER_LINES, nominal_pressures
from mptune.params.packed import (
    BASE,
    FROM_LOWEST,
    FROM_STEADY,
    LINE_ROWS,
    MADE_BY,
    RESTS,
    SHARE,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import FloatArray
    from mptune.params.lines import SupplyLine


def paper_table(low: float = 0.0) -> FloatArray:
    """Return the table of the paper's six lines above a low pressure [Pa].

    Converter i, of four, makes line i + 1 at i/5 of the way from the tank line to the accumulator.
    """
    table = np.zeros((LINE_ROWS, PAPER_LINES))
    table[BASE], table[RESTS], table[MADE_BY] = low, 1.0, -1.0
    table[SHARE] = np.arange(PAPER_LINES) / 5.0  # FINDINGS: α = 0, 0.2 … 1
    table[FROM_LOWEST] = 1 - table[SHARE]
    table[MADE_BY, 1:-1] = np.arange(PAPER_LINES - 2)
    return frozen(table)


def line_table(lines: Sequence[SupplyLine], low: float) -> FloatArray:
    """Return the table of lines ``(LINE_ROWS, L)``, see ``mptune.params.packed``.

    Parameters
    ----------
    lines
        The lines; none for the paper's six.
    low
        Pressure of the lowest [Pa].
    """
    if not lines:
        return paper_table(low)
    pressures, last = nominal_pressures(lines), len(lines) - 1
    table = np.zeros((LINE_ROWS, len(lines)))
    table[MADE_BY] = -1.0
    converters = 0
    for number, line in enumerate(lines):
        parts = {number: 1.0}  # which lines give its oil, and how much each
        if line.between is not None and line.share is not None:
            below, above = (one - 1 for one in line.between)
            parts = {below: 1 - line.share, above: line.share}
            table[MADE_BY, number] = converters
            converters += 1
        share, lowest = parts.get(last, 0.0), parts.get(0, 0.0)
        steady = {one: part for one, part in parts.items() if one not in {0, last}}
        table[SHARE, number], table[FROM_LOWEST, number] = share, lowest
        table[FROM_STEADY, number] = sum(pressures[one] * part for one, part in steady.items())
        # Where the share counts from: the lowest line, or what lies between.
        rests = not steady
        table[RESTS, number] = float(rests)
        rest = 1 - share
        base = (
            pressures[number] if share == 0 else table[FROM_STEADY, number] / rest if rest else 0.0
        )
        table[BASE, number] = low if rests else base
    return frozen(table)
