"""One requirement's excess: the logarithm of found over allowed, and what a figure's is."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.robust.model import LinearModel
    from mptune.robust.place import PlantPoint
    from mptune.robust.running import RunningFigures

FARTHEST = -5.0  # below a limit: a margin without limit is no farther
_UNSTABLE = 7.0  # a peak's logarithm where there is no finite one
_STABLE_BY = 1e-3  # disk margin of a loop that a search calls stable

SAMPLED = (
    "sampled_sensitivity_peak", "gain_margin", "disk_margin", "phase_margin", "delay_margin",
    "peak_compliance",
)  # fmt: skip
POSITION, STABLE = "position_ratio", "unstable_plants"
NOISES = ("noise_gain", "noise_force")
PEAKS = ("sensitivity_peak", "complementary_peak")
STEPS = ("overshoot", "settling_time")
AS_IT_RUNS = (*SAMPLED, *STEPS)


class Excess(NamedTuple):
    """One requirement's worst over the plants asked: excess, plant of the family, frequency."""

    requirement: str
    excess: float  # logarithm of found over allowed
    plant: int
    frequency: float

    def at(self, model: LinearModel) -> PlantPoint | None:
        """Return the place; None for requirements that know no plant."""
        if self.plant < 0:
            return None
        as_it_runs = self.requirement in {*AS_IT_RUNS, STABLE}
        return model.point(self.plant, self.frequency, as_it_runs=as_it_runs)


def over_limit(name: str, limit: float, found: RunningFigures) -> tuple[FloatArray, FloatArray]:
    """Return by how much a figure of loops as they run is over its limit, and where.

    Margins pass through zero where a loop becomes unstable and so are compared as they are, which
    near the limit is their logarithm as well.
    """
    stable = found.stable > 0
    if name == STABLE:
        return _STABLE_BY - found.disk_margin, found.disk_frequency
    if name == "gain_margin":  # an unstable loop's is below 1: the factor that would mend it
        return np.log(limit / np.clip(found.gain_margin, 1e-3, 1e3)), found.gain_frequency
    if name in {"disk_margin", "phase_margin", "delay_margin"}:
        frequency = getattr(found, name.replace("margin", "frequency"))
        over = np.clip(1 - getattr(found, name) / limit, FARTHEST, _UNSTABLE)
        return over, frequency
    if name == "peak_compliance":
        over, at = np.log(found.peak_compliance / limit), found.compliance_frequency
    else:
        over, at = np.log(found.sensitivity_peak / limit), found.sensitivity_frequency
    return np.where(stable, over, _UNSTABLE), at
