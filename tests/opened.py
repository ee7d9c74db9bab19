"""A table of the lines that have an open valve, with so many valves open to each chamber."""

import numpy as np

from mptune.params.packed import OPEN_ROWS
from mptune.plant.valve import add_open


def opened(lines, open_a, open_b):
    """Return the table ``(OPEN_ROWS, L)`` of the open valves of each line [K_v]."""
    table, found = np.zeros((OPEN_ROWS, lines.shape[1])), 0
    pairs = zip(*(np.broadcast_to(one, lines.shape[1]) for one in (open_a, open_b)), strict=True)
    for line, (a, b) in enumerate(pairs):
        if a != 0 or b != 0:
            add_open(line, float(a), float(b), found, lines, table)
            found += 1
    return table
