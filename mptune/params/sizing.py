"""How large supplies, filters and friction are for a machine and its moves: by rules.

Each rule follows from a balance of oil, energy or time, is rough, and says where it errs. None is
the paper's; what the paper's machine has lies within all of them. ``mptune.params.advice`` tells
which of them a study leaves, and the bundled studies of other machines are sized by them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mptune.params.chambers import Side

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.manoeuvre import Manoeuvre
    from mptune.params.section import Range
    from mptune.params.study import Study

SWING: Final = 0.1
"""Of the pump's starting pressure: how far one way may lower it, and the force with it."""
CONVERTER_RESERVE: Final = 1.25
"""On what one converter takes. Without it the rule is 1.1 times what pistons do on the simulated
machines of the paper and of studies/crane, and 0.7 times on that of studies/fast: may err low."""
FRICTION_SHARE: Final = 0.05
"""Of the piston's force at the highest pressure: what the stiction of seals stays below."""
USUAL_FRICTION: Final = 0.02
"""Of the same, as the paper's machine has it."""


@dataclass(frozen=True)
class Taken:
    """Oil that one move takes from the highest line.

    Attributes
    ----------
    move
        Its index.
    way
        Oil of one way across its reach, at the heaviest load [m³].
    flow
        Oil of all its ways over its time and rest [m³/s].
    """

    move: int
    way: float
    flow: float


def pressure_step(study: Study) -> float:
    """Return the mean step between neighbouring lines [Pa]."""
    return _span(study) / (len(study.edge_rule.sizes) - 1)


def lost_force(study: Study, move: Manoeuvre) -> float:
    """Return about what friction and throttling cost per way [N].

    Throttling over a whole step between lines on either side: what chambers lose at half a step
    each while they move, and as much again for switching them. Errs high: simulated, the paper's
    machine loses 0.84 to 0.94 of it, those of studies/crane and studies/fast 0.7 to 0.8.
    """
    load = study.load
    throttling = (study.area_a + study.area_b) * pressure_step(study)
    speed = move.travel / move.duration
    return throttling + load.friction_coulomb + load.friction_viscous * speed


def oil_taken(study: Study) -> Iterator[Taken]:
    """Yield what each move takes, ideal converters assumed.

    Work over p_HP − p_LP, for α of a line's oil is the highest line's. The tank line's pressure
    carries (A_A − A_B) p_LP of the load; kinetic energy comes back and is left out.
    """
    loads = [one for force in study.verification.load_forces for one in study.loads_at(force)]
    span = _span(study)
    carried = (study.area_a - study.area_b) * study.supplies.low_pressure
    for number, move in enumerate(study.manoeuvre):
        way = move.reach[1] - move.reach[0]
        lifted = [0.0]
        if move.extends:
            lifted.append(max(loads) - carried)
        if move.retracts:
            lifted.append(carried - min(loads))
        lost, lift = lost_force(study, move), max(lifted) * way
        time = move.duration + move.rest
        yield Taken(number, (lost * way + lift) / span, (lost * move.travel + lift) / span / time)


def most_taken(study: Study) -> Taken:
    """Return the move whose way takes the most oil."""
    return max(oil_taken(study), key=lambda one: one.way)


def pressure_left(study: Study, volume: float) -> float:
    """Return the accumulator's pressure [Pa] after a volume [m³] is taken at p_on, unpumped.

    Down to its precharge, where it is empty. Errs low: with their pumps the paper's machine and
    those of studies/crane and studies/fast stay about 1 MPa above.
    """
    supplies = study.supplies
    exponent, precharge = supplies.accumulator_exponent, supplies.accumulator_precharge
    gas = (precharge / supplies.pump_on) ** (1 / exponent) + volume / supplies.accumulator_volume
    pressure: float = precharge * max(1 / gas, 1.0) ** exponent
    return pressure


def least_accumulator(study: Study, precharge: float) -> float:
    """Return the volume [m³] that keeps one way within ``SWING`` of p_on; infinite if none does.

    V₀ [(p_pre/p)^(1/n) − (p_pre/p_on)^(1/n)] = V, the oil of a polytropic gas between p and p_on,
    at a precharge [Pa].
    """
    on, exponent = study.supplies.pump_on, study.supplies.accumulator_exponent
    low = (1 - SWING) * on
    if precharge >= low:
        return math.inf
    room: float = (precharge / low) ** (1 / exponent) - (precharge / on) ** (1 / exponent)
    return most_taken(study).way / room


def least_pump(study: Study) -> float:
    """Return the flow [m³/s] that refills, within each move and its rest, what the move takes."""
    return max(one.flow for one in oil_taken(study))


def least_converter(study: Study) -> float:
    """Return the oil [m³] that each converter is to take from its centre to an end.

    One of them may make the pressure of the larger chamber all the way: its stroke, twice that,
    takes what the chamber sweeps, with ``CONVERTER_RESERVE``. A single one takes it from its
    centre, for no other brings it back.
    """
    swept = swept_volume(study)
    return swept * max(CONVERTER_RESERVE / 2, 1 / study.converters)


def swept_volume(study: Study) -> float:
    """Return what the larger chamber sweeps over all moves [m³]."""
    low, high = study.reach()
    return max(study.area_a, study.area_b) * (high - low)


def converter_weights(study: Study) -> Range:
    """Return least and largest W_conv [N s/m⁶] that fit the converters' travel.

    At its end a converter's oil, through one valve to each chamber that pushes, at half a step, is
    to cost no less than the force of half a step, where another line does as well; half-way, where
    it costs an eighth, no more than a whole step's.
    """
    step = pressure_step(study)
    valve = study.valves.flow_coefficient * max(map(max, study.edge_rule.sizes))
    valves = valve * sum(one.valves for one in study.side(Side.PUSHING))
    price = study.area_a * step / (valves * math.sqrt(step / 2))  # per m³ of travel³
    whole = price / study.supplies.converter_travel**3
    return whole / 2, 8 * whole


def longest_filters(study: Study) -> dict[str, float]:
    """Return the longest time constant [s] of each filter, by its key in ``[controller]``.

    The position's is the loop's own delay, T_S/2, valve and computation: beyond it the filter
    costs more gain than all else. A pressure's is T_S/2, to hear 86 % of a step by the next
    decision. The supplies' is a tenth of the shortest move, within which they sink.
    """
    found = {"pressure_filter": study.controller.sampling_period / 2}
    if study.estimator.kind == "filters":
        found["position_filter"] = study.summed_delay[1]
    found["supply_filter"] = min(move.duration for move in study.manoeuvre) / 10
    return found


def most_friction(study: Study) -> float:
    """Return the stiction [N] beyond which it is hardly that of seals, see ``FRICTION_SHARE``."""
    return FRICTION_SHARE * study.area_a * study.supplies.high_pressure


def _span(study: Study) -> float:
    return study.supplies.high_pressure - study.supplies.low_pressure
