"""The machine: cylinder, oil, hoses, valves and load (Table 1, Fig. 4)."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse

FEWEST_ROWS = 2
"""Of a boom's table."""


class Cylinder(Section):
    """The main cylinder. Side A is the piston side, side B the rod side.

    Beside ``[[chambers]]`` its stroke alone counts; what is not given is NaN.
    """

    bore: float = quantity("m", "D", "bore diameter", math.nan, at_least=5e-3, at_most=5)
    rod: float = quantity("m", "D_r", "rod diameter", math.nan, at_least=0, at_most=5)
    stroke: float = quantity("m", "x_max", "stroke", at_least=0.01, at_most=50)
    dead_volume_a: float = quantity(
        "m^3", "V_0,A", "dead volume, A-side", math.nan, at_least=0, at_most=10
    )
    dead_volume_b: float = quantity(
        "m^3", "V_0,B", "dead volume, B-side", math.nan, at_least=0, at_most=10
    )

    @model_validator(mode="after")
    def _rod_fits(self) -> Self:
        if self.rod >= self.bore:
            refuse(
                f"has a rod ({self.rod:g} m) that is not thinner than its bore ({self.bore:g} m)",
                "check both diameters",
            )
        return self

    @property
    def area_a(self) -> float:
        """Piston area of the A-side, A_A [m²]."""
        return math.pi / 4 * self.bore**2

    @property
    def area_b(self) -> float:
        """Piston area of the B-side, A_B [m²]."""
        return math.pi / 4 * (self.bore**2 - self.rod**2)


class Oil(Section):
    """The oil's bulk modulus, as it may be and as the controller believes it."""

    bulk_modulus: Range = quantity(
        "Pa", "B_oil", "bulk modulus of the oil", at_least=1e7, at_most=1e11
    )
    bulk_modulus_estimate: float = quantity(
        "Pa", "B̂_oil", "estimate of B_oil", at_least=1e7, at_most=1e11
    )

    @model_validator(mode="after")
    def _estimate_is_above(self) -> Self:
        largest = self.bulk_modulus[1]
        if self.bulk_modulus_estimate < largest:
            refuse(
                f"has a bulk_modulus_estimate of {self.bulk_modulus_estimate / 1e6:g} MPa, below "
                f"the largest oil bulk modulus, {largest / 1e6:g} MPa; Eq. 12 needs B ≤ B̂",
                "raise the estimate",
            )
        return self


class Hose(Section):
    """The hoses between the valves and the chambers."""

    diameter: float = quantity("m", "D_h", "inner diameter", at_least=1e-3, at_most=1)
    length_a: float = quantity("m", "L_h,A", "length, A-side", math.nan, at_least=0, at_most=1e3)
    length_b: float = quantity("m", "L_h,B", "length, B-side", math.nan, at_least=0, at_most=1e3)
    bulk_modulus: float = quantity(
        "Pa", "B_h", "bulk modulus of the hose", at_least=1e6, at_most=1e14
    )
    dynamics: bool = Field(
        default=False,
        description="simulate the hoses as lines with inertia, the valves at their far end",
    )
    oil_density: float = quantity(
        "kg/m^3", "ρ", "density of the oil", 870.0, at_least=100, at_most=5e3
    )
    oil_viscosity: float = quantity("Pa s", "μ", "dynamic viscosity", 0.04, at_least=0, at_most=100)

    def volume(self, length: float) -> float:
        """Return the volume V_h [m³] of a hose of some length [m]."""
        return self._section * length

    def inertance(self, length: float) -> float:
        """Return ρ L/A of a hose as a line [Pa s²/m³]; 0 where it is a part of its chamber."""
        return self.oil_density / self._section * length if self.dynamics else 0.0

    def resistance(self, length: float) -> float:
        """Return the laminar resistance 8 π μ L/A² of a hose as a line [Pa s/m³]."""
        return 8 * math.pi * self.oil_viscosity / self._section**2 * length

    @property
    def _section(self) -> float:
        return math.pi / 4 * self.diameter**2


class Valves(Section):
    """The on/off valves, all alike."""

    flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)", "K_v", "flow coefficient of one valve", at_least=1e-12, at_most=1e-2
    )
    delay: Range = quantity("s", "d_v", "valve delay, opening ramp included", at_least=0, at_most=1)
    ramp: float = quantity(
        "s", "r_v", "opening ramp, part of the valve delay", at_least=1e-5, at_most=1
    )
    computation_delay: Range = quantity("s", "d_c", "computational delay", at_least=0, at_most=1)
    transition_pressure: float = quantity(
        "Pa",
        "p_tr",
        "pressure difference below which the orifice is smoothed",
        at_least=1,
        at_most=1e8,
    )

    @model_validator(mode="after")
    def _ramp_is_part_of_the_delay(self) -> Self:
        if self.ramp > self.delay[0]:
            refuse("has a ramp longer than its smallest delay, of which it is a part", "shorten it")
        return self


class SensorTruth(Section):
    """What is untrue about the sensors beside their noise; true by default."""

    pressure_gain_error_a: float = quantity(
        "1",
        "ε_A",
        "relative gain error of the pressure sensor of side A",
        0.0,
        at_least=-0.9,
        at_most=9,
    )
    pressure_gain_error_b: float = quantity(
        "1",
        "ε_B",
        "relative gain error of the pressure sensor of side B",
        0.0,
        at_least=-0.9,
        at_most=9,
    )
    pressure_offset_a: float = quantity(
        "Pa", "o_A", "offset of side A's pressure sensor", 0.0, at_least=-1e8, at_most=1e8
    )
    pressure_offset_b: float = quantity(
        "Pa", "o_B", "offset of side B's pressure sensor", 0.0, at_least=-1e8, at_most=1e8
    )
    position_hysteresis: float = quantity(
        "m",
        "h_x",
        "hysteresis of the position sensor, as a backlash's width",
        0.0,
        at_least=0,
        at_most=1,
    )
    position_resolution: float = quantity(
        "m", "q_x", "resolution of the position sensor; 0 for none", 0.0, at_least=0, at_most=1
    )


class Load(Section):
    """What the piston pushes against, apart from the inertia (which is in ``[uncertainty]``)."""

    force: float = quantity("N", "F_load", "constant load force", at_least=-1e9, at_most=1e9)
    stiffness: float = quantity(
        "N/m", "k_load", "rise of the load force with position", 0.0, at_least=-1e10, at_most=1e10
    )
    table: tuple[tuple[float, float, float], ...] = Field(
        (), description="position [m], added load force [N], factor of the inertia [–]"
    )
    friction_coulomb: float = quantity("N", "F_C", "Coulomb friction", at_least=0, at_most=1e9)
    friction_static: float = quantity("N", "F_S", "stiction", at_least=0, at_most=1e9)
    friction_viscous: float = quantity("N s/m", "b", "viscous friction", at_least=0, at_most=1e10)
    friction_velocity: float = quantity(
        "m/s", "v_S", "Stribeck velocity", at_least=1e-6, at_most=10
    )

    @model_validator(mode="after")
    def _table_is_a_table(self) -> Self:
        if not self.table:
            return self
        if len(self.table) < FEWEST_ROWS:
            refuse(f"has a table of less than {FEWEST_ROWS} rows", "write the ends of the stroke")
        if any(after[0] <= before[0] for before, after in pairwise(self.table)):
            refuse("has a table whose positions do not rise", "order its rows")
        if any(row[2] <= 0 for row in self.table):
            refuse("has a table with an inertia that is not positive", "give factors above 0")
        return self
