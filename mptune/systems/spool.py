"""A mobile proportional valve: dead time, play, a slow spool with a dead band, metering edges."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import kernel
from mptune.plant.flow import orifice

if TYPE_CHECKING:
    from mptune.arrays import FloatArray


class Spool(NamedTuple):
    """The valve, openings from −1 to 1, SI."""

    inlet: float  # m³/(s Pa^0.5), of the fully open inlet edge
    outlet: float
    compensated: float  # Pa, over the inlet edge
    frequency: float  # rad/s
    damping: float
    dead_time: float  # s
    rate: float  # 1/s, the largest
    play: float
    dead_band: float
    known_band: float  # of it, what the controller steps across
    transition: float  # Pa, see ``mptune.plant.flow``


@kernel
def spool_rates(command: float, place: float, rate: float, valve: Spool) -> tuple[float, float]:
    """Return the slopes of a spool's place and rate; its rate is limited."""
    limited = min(max(rate, -valve.rate), valve.rate)
    pulled = valve.frequency * (valve.frequency * (command - place) - 2 * valve.damping * limited)
    if (rate >= valve.rate and pulled > 0) or (rate <= -valve.rate and pulled < 0):
        pulled = 0.0
    return limited, pulled


@kernel
def opening_of(place: float, valve: Spool) -> float:
    """Return the opening of the edges, signed: nothing opens within the dead band."""
    open_share = (abs(place) - valve.dead_band) / (1 - valve.dead_band)
    return math.copysign(min(max(open_share, 0.0), 1.0), place)


@kernel
def inlet_flow(opening: float, supply: float, chamber: float, valve: Spool) -> float:
    """Return the flow into a chamber [m³/s] at an opening ≥ 0; it never flows back.

    The compensator holds its pressure over the edge as long as there is that much to hold.
    """
    over = min(max(supply - chamber, 0.0), valve.compensated)
    return valve.inlet * opening * orifice(over, valve.transition)


@kernel
def command_for(flow: float, valve: Spool) -> float:
    """Return the command [-] that asks for a flow [m³/s], across what is known of the dead band.

    What is not known is missing from the opening, most of all at low speed.
    """
    if flow == 0:
        return 0.0
    share = min(abs(flow) / (valve.inlet * math.sqrt(valve.compensated)), 1.0)
    return math.copysign(valve.known_band + (1 - valve.dead_band) * share, flow)


@kernel
def delayed(buffer: FloatArray, tick: int, command: float) -> float:
    """Put a command into a ring of ticks and return the one that leaves it."""
    place = tick % len(buffer)
    old: float = buffer[place]
    buffer[place] = command
    return old
