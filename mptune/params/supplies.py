"""What makes the pressures of the lines: pump, accumulator and converter cylinders (Fig. 1)."""

from __future__ import annotations

import math
from typing import Self

from pydantic import model_validator

from mptune.params.section import Section, quantity, refuse


class Supplies(Section):
    """What makes the pressures: the paper's six, from one accumulator by four converter cylinders.

    Beside ``[[lines]]`` only what these need is asked for; what is not given is NaN.
    """

    low_pressure: float = quantity(
        "Pa", "p_LP", "pressure of the tank-side line", math.nan, at_least=0, at_most=1e9
    )
    high_pressure: float = quantity(
        "Pa", "p_HP", "nominal highest pressure", math.nan, at_least=1e3, at_most=1e9
    )
    pump_on: float = quantity(
        "Pa", "p_on", "pressure at which the pump starts", math.nan, at_least=1e3, at_most=1e9
    )
    pump_off: float = quantity(
        "Pa", "p_off", "pressure at which the pump stops", math.nan, at_least=1e3, at_most=1e9
    )
    pump_flow: float = quantity(
        "m^3/s", "Q_pump", "flow of the pump", math.nan, at_least=1e-9, at_most=10
    )
    relief_pressure: float = quantity(
        "Pa", "p_rel", "opening pressure of the relief", math.nan, at_least=1e3, at_most=1e9
    )
    accumulator_volume: float = quantity(
        "m^3", "V_acc", "accumulator volume", math.nan, at_least=1e-6, at_most=1e3
    )
    accumulator_precharge: float = quantity(
        "Pa", "p_pre", "gas precharge", math.nan, at_least=1e3, at_most=1e9
    )
    accumulator_exponent: float = quantity(
        "1", "n", "polytropic exponent of the gas", math.nan, at_least=1, at_most=3
    )
    converter_area: float = quantity(
        "m^2", "A_conv", "converter piston area", math.nan, at_least=1e-6, at_most=10
    )
    converter_travel: float = quantity(
        "m",
        "x_conv",
        "converter piston travel from the centre to an end",
        math.nan,
        at_least=1e-4,
        at_most=10,
    )
    converter_friction: float = quantity(
        "Pa", "p_conv", "converter friction", math.nan, at_least=0, at_most=1e8
    )

    @model_validator(mode="after")
    def _pressures_are_ordered(self) -> Self:
        if self.low_pressure >= self.high_pressure:
            refuse("has a low_pressure not below its high_pressure", "check both pressures")
        if self.pump_on >= self.pump_off:
            refuse("has a pump_on pressure not below pump_off", "check both pressures")
        if self.accumulator_precharge >= self.pump_on:
            refuse("has an accumulator_precharge not below pump_on", "the gas would stay expanded")
        if self.pump_off > self.relief_pressure:
            refuse("has a relief_pressure below pump_off", "raise the relief_pressure")
        return self
