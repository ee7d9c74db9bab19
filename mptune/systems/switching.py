"""On/off valves of a system: commands with drawn delays, and openings over a step."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import FloatArray, kernel
from mptune.plant.valve import ValveState, advance, command

if TYPE_CHECKING:
    import numpy as np

    from mptune.params.section import Range


class Timing(NamedTuple):
    """Pure delays [s], drawn between the two at each switching, and the opening ramp."""

    least: float
    largest: float
    ramp: float


def timing_of(delay: Range, ramp: float) -> Timing:
    """Return the timing of valves whose delay [s] holds their ramp [s]."""
    return Timing(delay[0] - ramp, delay[1] - ramp, ramp)


@kernel
def ones(number: int) -> int:
    """Return how many bits of a number are set: of a level, how many valves are open."""
    count = 0
    while number:
        count += number & 1
        number >>= 1
    return count


@kernel
def switch(
    valves: ValveState,
    valve: int,
    wanted: float,
    now: float,
    timing: Timing,
    random: np.random.Generator,
) -> None:
    """Command one valve; nothing is drawn for one that stands as it should."""
    if wanted != valves.commanded[valve]:
        delay = timing.least + (timing.largest - timing.least) * random.random()
        command(valves, valve, wanted, now + delay)


@kernel
def gather(valves: ValveState, weights: FloatArray, opened: FloatArray) -> None:
    """Fill ``opened`` ``(G,)`` with the openings of groups of valves.

    ``weights`` ``(G, K)`` says what each of a group's K valves is worth; valves are numbered group
    by group.
    """
    groups, each = weights.shape
    for group in range(groups):
        total = 0.0
        for k in range(each):
            total += weights[group, k] * valves.opening[each * group + k]
        opened[group] = total


@kernel
def openings(
    valves: ValveState,
    weights: FloatArray,
    now: float,
    step: float,
    ramp: float,
    opened: FloatArray,
) -> None:
    """Move the valves over a step [s]; fill ``opened`` ``(3, G)`` at its start, middle and end.

    What stood at the end of the step before stands at the start of this one.
    """
    for group in range(len(weights)):
        opened[0, group] = opened[2, group]
    if advance(valves, now, 0.5 * step, ramp):
        gather(valves, weights, opened[1])
    else:
        opened[1] = opened[0]
    if advance(valves, now + 0.5 * step, 0.5 * step, ramp):
        gather(valves, weights, opened[2])
    else:
        opened[2] = opened[1]
