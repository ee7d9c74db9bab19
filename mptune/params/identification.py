"""The operating points at which the force loop is identified (§2.4, Eq. 13)."""

from __future__ import annotations

from mptune.params.section import Range, Section, quantity

_PRESSURES = tuple(round(1e6 + 0.55e6 * step, 1) for step in range(21))  # Eq. 13: 1, 1.55 … 12 MPa


class Identification(Section):
    """Excitation and operating points; Eq. 13's where nothing is given.

    Each valve delay is a run of its own over all other values. A delay of 0 is the paper's
    simulation: the controller sees the pressures as they are. With a delay it sees them through
    median and filter, as on the machine.
    """

    amplitude: float = quantity(
        "N", "F̂", "peak of the force reference", 10e3, at_least=1e-3, at_most=1e9
    )
    frequency: Range = quantity(
        "rad/s", "ω", "lowest and highest frequency", (1.0, 200.0), at_least=1e-3, at_most=1e5
    )
    frequencies: int = quantity("1", "n", "number of frequencies", 24, at_least=2, at_most=400)
    positions: tuple[float, ...] = quantity(
        "m", "x_0", "piston positions", (0.15, 0.25), at_least=0, at_most=50
    )
    velocities: tuple[float, ...] = quantity(
        "m/s", "ẋ_0", "piston velocities", (-0.1, 0.0, 0.1), at_least=-10, at_most=10
    )
    pressures: tuple[float, ...] = quantity(
        "Pa", "p_A,0", "A-side pressures at the start", _PRESSURES, at_least=0, at_most=1e9
    )
    oil_bulk_moduli: tuple[float, ...] = quantity(
        "Pa", "B_oil", "bulk moduli of the oil", (800e6, 1200e6), at_least=1e7, at_most=1e11
    )
    valve_delays: tuple[float, ...] = quantity(
        "s", "d_v", "valve delays", (0.0,), at_least=0, at_most=1
    )
