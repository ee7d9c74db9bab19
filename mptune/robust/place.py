"""A plant of the family at a frequency: the place that a figure names as responsible."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.params.packed import Plants


def finite(value: float) -> float | None:
    """Return the value, or None where it is NaN or infinite, which JSON cannot say."""
    return value if np.isfinite(value) else None


@dataclass(frozen=True)
class PlantPoint(Summarised):
    """A plant of the family at a frequency.

    A measured member has the name of its ``response``, and neither delay nor lags of its own: NaN.
    """

    mass_kg: float
    delay_s: float
    tau_a_s: float
    tau_b_s: float
    frequency_rad_s: float
    response: str | None = None

    @property
    def headline(self) -> str:
        """The plant and the frequency in one line."""
        text = f"{self.mass_kg / 1e3:.4g} t, " + (
            f"measured {self.response}"
            if self.response
            else f"d {1e3 * self.delay_s:.4g} ms, "
            f"τ {1e3 * self.tau_a_s:.3g}/{1e3 * self.tau_b_s:.3g} ms"
        )
        if np.isnan(self.frequency_rad_s):
            return text
        return f"{text}, ω {self.frequency_rad_s:.3g} rad/s"

    def values(self) -> dict[str, float | str | None]:
        """Return the fields by name, as JSON has them; ``response`` of measured members only."""
        values: dict[str, float | str | None] = {
            field.name: finite(getattr(self, field.name))
            for field in fields(self)
            if field.name != "response"
        }
        return values if self.response is None else {**values, "response": self.response}


def plant_point(
    plants: Plants, index: int, frequency: float, responses: tuple[str, ...] = ()
) -> PlantPoint:
    """Return one plant of a family at a frequency [rad/s].

    The last of the ``plants`` are measured members, whose ``responses`` are named.
    """
    mass, delay, tau_a, tau_b, _ = (float(column[index]) for column in plants)
    member = int(index) - (plants.number - len(responses))
    name = responses[member] if member >= 0 else None
    return PlantPoint(mass, delay, tau_a, tau_b, float(frequency), name)
