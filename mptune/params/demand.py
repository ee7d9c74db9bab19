"""What the moves and the load ask of valves and pressures: rough, and said so."""

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


def flow_demand(study: Study) -> Iterator[Doubt]:
    """Doubt moves that are too fast for the valves."""
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


def _supplied(study: Study) -> tuple[float, float]:
    """Return least and largest force [N] of a piston at rest between the supply pressures."""
    cylinder, controller, supplies = study.cylinder, study.controller, study.supplies
    low = max(supplies.low_pressure, controller.pressure_min)
    high = min(supplies.high_pressure, controller.pressure_max)
    least = cylinder.area_a * low - cylinder.area_b * high
    return least, cylinder.area_a * high - cylinder.area_b * low


def _fastest(study: Study, move: Manoeuvre) -> float:
    """Return the steady velocity [m/s] at which the valves take up what force there is to spare.

    From A_A p_A − A_B p_B = F with p_A = p_HP − (A_A v/K)² and p_B = p_LP + (A_B v/K)², or the
    other way round; K is that of all valves in parallel. Friction is left out: errs on the
    generous side.
    """
    least, largest = _supplied(study)
    cylinder = study.cylinder
    loads = [one for force in study.verification.load_forces for one in study.loads_at(force)]
    spare = []
    if move.extends:
        spare.append(largest - max(loads))
    if move.retracts:
        spare.append(min(loads) - least)
    sizes = study.edge_rule.sizes
    flow = min(sum(sizes[0]), sum(sizes[-1])) * study.valves.flow_coefficient
    cubes = cylinder.area_a**3 + cylinder.area_b**3
    return flow * math.sqrt(max(min(spare, default=math.inf), 0.0) / cubes)
