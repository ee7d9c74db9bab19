"""§7's figures of merit: what each is called, in which unit, and how sets and runs compare in it.

One table for results, campaigns, weights, terminal, report and figures.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from mptune.units import number

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mptune.arrays import Real


class Over(StrEnum):
    """What counts of several movement sets."""

    MEAN = "mean"
    LARGEST = "largest"
    LEAST = "least"


class Better(StrEnum):
    """Which of two values is the better one."""

    LOWER = "lower"
    HIGHER = "higher"


@dataclass(frozen=True)
class Merit:
    """One figure of merit.

    Attributes
    ----------
    key
        Its name with its unit: a field of ``SetFigures`` and a key in JSON and data sets.
    name
        Its name without: the key of its limit in ``[campaign.limits]``, where it has one.
    label, short
        Its name in print, and in a narrow column.
    unit, factor
        §7's unit, and what one of it is in SI.
    over, better
        What counts of several sets, and whether less is better than more.
    digits
        Significant digits in print.
    """

    key: str
    name: str
    label: str
    short: str
    unit: str
    factor: float
    over: Over
    better: Better = Better.LOWER
    digits: int = 3

    @property
    def printed_unit(self) -> str:
        """The unit in print; a dash where there is none."""
        return "–" if self.unit == "1" else self.unit.replace("^2", "²")

    @property
    def axis(self) -> str:
        """Label and unit, for an axis."""
        return f"{self.label} [{self.printed_unit}]"

    def heading(self, between: str = " ") -> str:
        """Return the short name and the unit, if any, for a column."""
        return self.short if self.unit == "1" else f"{self.short}{between}[{self.printed_unit}]"

    def title(self, between: str = " ") -> str:
        """Return the heading with a capital letter."""
        heading = self.heading(between)
        return heading[0].upper() + heading[1:]

    def text(self, value: float) -> str:
        """Return a value for print, without its unit."""
        return number(value, self.digits)

    def of_sets(self, values: Iterable[float]) -> float:
        """Return what counts of several sets; NaN where there are none."""
        found = list(values)
        if not found:
            return float("nan")
        if self.over is Over.MEAN:
            return float(np.mean(found))
        return float(max(found) if self.over is Over.LARGEST else min(found))

    def badness(self, value: Real) -> Real:
        """Return a number that is the larger, the worse the value is; of arrays, each."""
        return -value if self.better is Better.HIGHER else value


_MEAN, _LARGEST = Over.MEAN, Over.LARGEST
_N2S = 1e6  # N² s in kN² s

MERITS = (
    Merit("performance_index_ms", "performance_index", "Performance index", "index",
          "ms", 1e-3, _MEAN),
    Merit("energy_loss_j_per_mm", "energy_loss", "Energy loss", "loss", "J/mm", 1e3, _MEAN),
    Merit("pump_loss_j_per_mm", "pump_loss", "Energy loss by pump power", "pump loss",
          "J/mm", 1e3, _MEAN),
    Merit("force_error_integral_kn2s", "force_error_integral", "Force error ∫ΔF²", "∫ΔF²",
          "kN^2 s", _N2S, _MEAN),
    Merit("final_error_mm", "final_error", "Final error", "final", "mm", 1e-3, _LARGEST, digits=2),
    Merit("peak_velocity_mm_s", "peak_velocity", "Peak velocity", "velocity",
          "mm/s", 1e-3, _LARGEST),
    Merit("valve_switches", "valve_switches", "Valve switches per set", "switches",
          "1", 1.0, _MEAN, digits=4),
    Merit("converter_peak_mm", "converter_peak", "Converter peak", "converter",
          "mm", 1e-3, _LARGEST),
    Merit("pressure_min_mpa", "pressure_min", "Least pressure", "p min", "MPa", 1e6,
          Over.LEAST, Better.HIGHER),
    Merit("pressure_max_mpa", "pressure_max", "Largest pressure", "p max", "MPa", 1e6, _LARGEST),
    Merit("energy_residual", "energy_residual", "Energy residual", "residual",
          "1", 1.0, _LARGEST),
    Merit("busiest_valve_per_s", "busiest_valve", "Switches of the busiest valve", "busiest valve",
          "1/s", 1.0, _MEAN),
    Merit("velocity_error_mm_s", "velocity_error", "Velocity error, rms", "velocity error",
          "mm/s", 1e-3, _MEAN),
    Merit("velocity_lag_ms", "velocity_lag", "Velocity lag", "lag", "ms", 1e-3, _MEAN),
    Merit("stop_overshoot_mm", "stop_overshoot", "Overshoot at the stop", "overshoot",
          "mm", 1e-3, _LARGEST),
)  # fmt: skip
_BY_KEY = {merit.key: merit for merit in MERITS}


def merit(key: str) -> Merit:
    """Return the figure of merit of a key.

    Raises
    ------
    KeyError
        If no figure has it.
    """
    return _BY_KEY[key]


# What a commanded speed is judged by.
OF_SPEEDS = tuple(
    merit(key) for key in ("velocity_error_mm_s", "velocity_lag_ms", "stop_overshoot_mm")
)

# What a table of runs shows, in its order.
TABULATED = tuple(
    merit(key)
    for key in (
        "performance_index_ms",
        "energy_loss_j_per_mm",
        "force_error_integral_kn2s",
        "final_error_mm",
        "converter_peak_mm",
        "valve_switches",
    )
)
OF_CONVERTERS = merit("converter_peak_mm")
