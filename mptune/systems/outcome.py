"""What a run of a system came to: §7's figures of its sets, and whether it did what it should."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.sim.judge import LIMIT_CYCLE_SWINGS, SATURATED
from mptune.sim.merit import merit

if TYPE_CHECKING:
    from mptune.sim.judge import SetFigures
    from mptune.sim.record import RunRecord

INDEX, LOSS, FORCE_ERROR = (
    "performance_index_ms",
    "energy_loss_j_per_mm",
    "force_error_integral_kn2s",
)


@dataclass(frozen=True)
class Outcome:
    """A run of a system.

    Attributes
    ----------
    sets
        The figures of every movement set that counts.
    record
        The neutral record of the last set.
    broken
        The first limit that was broken; empty where none was.
    """

    sets: tuple[SetFigures, ...]
    record: RunRecord
    broken: str = ""

    @property
    def stable(self) -> bool:
        """Whether it stayed finite, free of limit cycles and off its limits, and arrived."""
        return bool(
            not self.broken
            and self.sets
            and all(np.isfinite(one.performance_index_ms) for one in self.sets)
            and all(one.oscillation < LIMIT_CYCLE_SWINGS for one in self.sets)
            and all(one.saturated_s < SATURATED for one in self.sets)
        )

    @property
    def worth(self) -> float:
        """Mean performance index [ms]; infinite where the run is not stable."""
        return self.mean(INDEX) if self.stable else np.inf

    def mean(self, key: str) -> float:
        """Return the mean of a figure over the sets."""
        return float(np.mean([getattr(one, key) for one in self.sets]))

    def figure(self, key: str) -> float:
        """Return what counts of a figure over the sets, as ``mptune.sim.merit`` says."""
        return merit(key).of_sets(getattr(one, key) for one in self.sets)

    def spread(self, key: str) -> float:
        """Return how far a figure's sets lie apart."""
        values = [getattr(one, key) for one in self.sets]
        return float(max(values) - min(values))

    @property
    def reference_index_ms(self) -> float:
        """Mean index over the reference's peak velocity [ms].

        §7.2's index divides by the velocity reached, which overshoot flatters.
        """
        peak = 1e3 * float(np.abs(self.record.velocity_reference).max())
        values = [one.performance_index_ms * one.peak_velocity_mm_s / peak for one in self.sets]
        return float(np.mean(values))

    @property
    def returned_j_per_mm(self) -> float:
        """Energy that flows back to the low-pressure side, net, in the last set [J/mm].

        It counts as lost (§7.1); a recovery could at best take it off the loss.
        """
        return (0.0 - self.record.energies.returned) / (1e3 * self.record.travel)
