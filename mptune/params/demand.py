"""What the moves and the load ask of valves, pressures, pump and converters: rough, and said so."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.params.doubts import Doubt
from mptune.units import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.manoeuvre import Manoeuvre
    from mptune.params.study import Study


def slowest_valves(study: Study) -> Iterator[Doubt]:
    """Doubt valves that, somewhere in their range, are as slow as the sampling period."""
    period, delay = study.controller.sampling_period, study.valves.delay
    if delay[1] >= period and study.controller.force_model == "dynamic":
        yield Doubt(
            ("valves.delay", "controller.sampling_period"),
            (shown(delay, "s", ranged=True), shown(period, "s")),
            "Table 2 asks for a sampling period longer than the valve delay",
            "lengthen the sampling period or take faster valves",
        )


def force_demand(study: Study) -> Iterator[Doubt]:
    """Doubt moves whose load, acceleration and friction ask more than the supplies give.

    At rest, without throttling: errs on the generous side.
    """
    least, largest = _supplied(study)
    load, masses = study.load, study.verification.masses
    loads = [one for force in study.verification.load_forces for one in study.loads_at(force)]
    peak = max(move.peak_acceleration for move in study.manoeuvre)
    speed = max(move.peak_velocity for move in study.manoeuvre)
    inertia = max(masses) * max(study.inertia_factors()) * peak
    moving = inertia + load.friction_coulomb + load.friction_viscous * speed
    low, high = min(loads) - moving, max(loads) + moving
    if low < least or high > largest:
        yield Doubt(
            ("load.force", "supplies.high_pressure"),
            (shown(load.force, "N"), shown(study.supplies.high_pressure, "Pa")),
            f"load, acceleration and friction ask for {shown((low, high), 'N', ranged=True)}, the "
            f"supplies give {shown((least, largest), 'N', ranged=True)}",
            "slow the moves down, or take a larger piston or higher pressures",
        )


def supply_demand(study: Study) -> Iterator[Doubt]:
    """Doubt moves that are too fast for the valves, or too much for pump or converters."""
    for number, move in enumerate(study.manoeuvre):
        fastest = _fastest(study, move)
        if move.peak_velocity > fastest:
            yield Doubt(
                (f"manoeuvre[{number + 1}]", "valves.flow_coefficient"),
                (
                    f"up to {shown(move.peak_velocity, 'm/s')}",
                    f"{study.valves.flow_coefficient:g} m³/(s Pa^0.5)",
                ),
                "all valves of one line and the supply pressures let the piston move at "
                f"{shown(fastest, 'm/s')} at most",
                "slow the move down or take larger valves",
            )
            break
    needed, pump = _mean_flow(study), study.supplies.pump_flow
    if needed > pump:
        yield Doubt(
            ("manoeuvre", "supplies.pump_flow"),
            (f"{len(study.manoeuvre)} moves", shown(pump, "m^3/s")),
            f"friction and throttling over half a pressure step take about "
            f"{shown(needed, 'm^3/s')} on average",
            "rest longer between the moves or take a larger pump",
        )
    yield from _converters(study)


def _supplied(study: Study) -> tuple[float, float]:
    """Return least and largest force [N] of a piston at rest between the supply pressures."""
    controller, supplies = study.controller, study.supplies
    low = max(supplies.low_pressure, controller.pressure_min)
    high = min(supplies.high_pressure, controller.pressure_max)
    least = study.area_a * low - study.area_b * high
    return least, study.area_a * high - study.area_b * low


def _fastest(study: Study, move: Manoeuvre) -> float:
    """Return the steady velocity [m/s] at which the valves take up what force there is to spare.

    From A_A p_A − A_B p_B = F with p_A = p_HP − (A_A v/K)² and p_B = p_LP + (A_B v/K)², or the
    other way round, and so for each of more chambers; K is that of all its valves in parallel.
    Friction is left out: errs on the generous side.
    """
    least, largest = _supplied(study)
    loads = [one for force in study.verification.load_forces for one in study.loads_at(force)]
    spare = []
    if move.extends:
        spare.append(largest - max(loads))
    if move.retracts:
        spare.append(min(loads) - least)
    sizes = study.edge_rule.sizes
    flow = min(sum(sizes[0]), sum(sizes[-1])) * study.valves.flow_coefficient
    cubes = sum(one.area**3 / one.valves**2 for one in study.all_chambers)
    return flow * math.sqrt(max(min(spare, default=math.inf), 0.0) / cubes)


def _mean_flow(study: Study) -> float:
    """Return about what the pump must give on average [m³/s], ideal converters assumed.

    Friction, and throttling over half a step between supply pressures on either side, per way;
    leakage, switching and compression are left out, so that a pump may still be too small.
    """
    supplies, load = study.supplies, study.load
    span = supplies.high_pressure - supplies.low_pressure
    time = sum(move.duration + move.rest for move in study.manoeuvre)
    speed = sum(move.travel for move in study.manoeuvre) / time
    throttling = (study.area_a + study.area_b) * span / (len(study.edge_rule.sizes) - 1) / 2
    return speed * (load.friction_coulomb + load.friction_viscous * speed + throttling) / span


def _converters(study: Study) -> Iterator[Doubt]:
    """Doubt moves that fill all converters, even if they share the oil evenly."""
    if study.converters == 0:
        return
    low, high = study.reach()
    swept = study.area_a * (high - low)
    supplies = study.supplies
    room = study.converters * supplies.converter_area * supplies.converter_travel
    if swept > room:
        yield Doubt(
            ("manoeuvre", "supplies.converter_travel"),
            (shown(high - low, "m"), shown(supplies.converter_travel, "m")),
            f"the A-side sweeps {shown(swept, 'm^3')}, {study.converters} converters take "
            f"{shown(room, 'm^3')} from their centres to their ends",
            "shorten the moves, or take larger converters or a longer travel",
        )
