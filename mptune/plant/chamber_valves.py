"""What each chamber of a machine that has more than two has open towards the lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, lending_kernel
from mptune.params.packed import LINE_ROWS, SIZE

if TYPE_CHECKING:
    from mptune.plant.valve import ValveState


@lending_kernel
def open_valves_of_chambers(
    valves: ValveState,
    edge: FloatArray,
    lines: FloatArray,
    chambers: FloatArray,
    opened: FloatArray,
) -> None:
    """Fill the table of all lines with what each chamber has open towards them.

    Parameters
    ----------
    valves
        Where every valve stands, chamber by chamber.
    edge
        ``(2, W/C)`` line and size [K_v] of each valve of a chamber, line by line.
    lines
        ``(LINE_ROWS, L)``, see ``mptune.params.packed``.
    chambers
        ``(CHAMBER_ROWS, C)``.
    opened
        ``(LINE_ROWS + C, L)``, filled: a row of open valves [K_v] for each chamber.
    """
    each = edge.shape[1]
    for line in range(lines.shape[1]):
        for row in range(LINE_ROWS):
            opened[row, line] = lines[row, line]
        for i in range(chambers.shape[1]):
            opened[LINE_ROWS + i, line] = 0.0
    for i in range(chambers.shape[1]):
        for k in range(each):
            size = chambers[SIZE, i] * edge[1, k]
            opened[LINE_ROWS + i, int(edge[0, k])] += size * valves.opening[each * i + k]
