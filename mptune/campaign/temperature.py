"""What the oil's temperature moves: viscosity, and with it friction; bulk modulus; valve delay.

Three assumed laws about T_0 = 40 °C, at which every value of the study holds:

- viscosity, and with it viscous friction and the hoses' resistance: Reynolds' law,
  exp(−0.035 (T − T_0)), a mineral oil of ISO VG 46 between 20 and 80 °C;
- bulk modulus: exp(−0.005 (T − T_0)), about half a per cent less per kelvin;
- valve delay: the viscosity's factor to the power 0.1, as the spool has oil to shear. At 20 °C
  that is 7 % more; the coil, which is slower when hot, is left out.

Without a data sheet they say how such effects go together, not how large they are for one oil.
"""

from __future__ import annotations

import math
from typing import NamedTuple

REFERENCE = 313.15  # K, T_0
_VISCOSITY = 0.035  # 1/K
_BULK_MODULUS = 0.005  # 1/K
_DELAY_POWER = 0.1


class TemperatureFactors(NamedTuple):
    """What values at T_0 are multiplied by."""

    viscosity: float
    bulk_modulus: float
    valve_delay: float


def temperature_factors(temperature: float) -> TemperatureFactors:
    """Return the factors at a temperature [K]; exactly 1 at T_0."""
    above = temperature - REFERENCE
    viscosity = math.exp(-_VISCOSITY * above)
    return TemperatureFactors(viscosity, math.exp(-_BULK_MODULUS * above), viscosity**_DELAY_POWER)
