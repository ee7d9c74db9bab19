"""What a system's controller measures: position and pressures, as §5.2 conditions them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.signals.conditioning import median_of_three
from mptune.signals.differentiator import remember

if TYPE_CHECKING:
    from mptune.params.packed import SignalSettings


class Sensed(NamedTuple):
    """Position first, then every pressure."""

    raw: FloatArray  # (2, 1 + P) the last two samples of each
    filtered: FloatArray  # (1 + P,)
    history: FloatArray  # (6,) filtered positions, newest first, for Eq. 23


def settled_sensors(position: float, pressures: FloatArray) -> Sensed:
    """Return sensors that have seen a position [m] and pressures [Pa] for long."""
    values = np.concatenate([[position], pressures])
    return Sensed(np.stack([values, values]), values.copy(), np.full(6, position))


@kernel
def sense(
    sensors: Sensed,
    state: FloatArray,
    first: int,
    signals: SignalSettings,
    random: np.random.Generator,
) -> None:
    """Sample every sensor once: noise, median of three, first-order filter.

    Parameters
    ----------
    sensors
        Carried on in place.
    state
        Position first; ``first`` is the place of its first pressure.
    signals
        Filters and noise.
    random
        Source of the noise.
    """
    raw, filtered = sensors.raw, sensors.filtered
    for i in range(len(filtered)):
        value, noise, pole = state[0], signals.position_noise, signals.position_pole
        if i > 0:
            value = state[first + i - 1]
            noise, pole = signals.pressure_noise, signals.pressure_pole
        sample = value + noise * random.standard_normal()
        middle = median_of_three(sample, raw[0, i], raw[1, i])
        raw[1, i] = raw[0, i]
        raw[0, i] = sample
        filtered[i] = pole * filtered[i] + (1 - pole) * middle
    remember(sensors.history, filtered[0])
