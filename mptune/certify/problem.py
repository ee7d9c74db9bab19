"""What is to be certified: a box of plants about a nominal one, and the loop around them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.loops.family import ranges_of
from mptune.params.pack import pack_gains, pack_measured, pack_nominal
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, NominalPlant, Plants

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Gains
    from mptune.params.study import ResolvedStudy

Interval = tuple[float, float]
LEAST_MASS = 1e-3  # of the nominal mass: a growing box stops there
PATHS = ("none", "filters", "sampled")  # one more, "estimator", stands in the filters' place


class Point(NamedTuple):
    """A plant of the box at a frequency: where a figure is attained, or a loop is unstable."""

    mass: float  # kg
    delay: float  # s
    tau_a: float  # s
    tau_b: float  # s
    omega: float  # rad/s; NaN where the plant alone is meant, inf in the limit


@dataclass(frozen=True)
class PlantBox:
    """A continuous box of plants of Eq. 15, and the nominal plant of Eq. 14.

    Attributes
    ----------
    nominal
        The nominal plant, inside the box or outside.
    mass, delay, tau_a, tau_b
        Least and largest value [kg], [s]; both may be the same.
    """

    nominal: NominalPlant
    mass: Interval
    delay: Interval
    tau_a: Interval
    tau_b: Interval

    def __post_init__(self) -> None:
        """Refuse what is no box of plants.

        Raises
        ------
        ValueError
            If an interval is empty, not finite, or reaches below zero, or a mass is not positive.
        """
        for name in ("mass", "delay", "tau_a", "tau_b"):
            low, high = getattr(self, name)
            if not (math.isfinite(high) and 0 <= low <= high):
                raise ValueError(f"{name} = [{low}, {high}] is no interval of values from 0 on")
        if not (self.mass[0] > 0 and self.nominal.mass > 0 and self.nominal.delay >= 0):
            raise ValueError("a box needs positive masses and a nominal delay of at least 0")

    def corners(self, share_a: float) -> Plants:
        """Return the box's corners, ``(N,)`` each; fewer than 16 where sides have no width."""
        sides = (self.mass, self.delay, self.tau_a, self.tau_b)
        return plants_of(list(product(*(sorted(set(side)) for side in sides))), share_a)

    def grown(self, factor: float, least_delay: float = 0.0) -> PlantBox:
        """Return the box grown about the nominal plant: x_N + factor·(x − x_N), with τ_N = 0.

        Masses stay above ``LEAST_MASS`` times the nominal one, delays at or above ``least_delay``
        [s], time constants at or above 0.
        """
        mass, delay = self.nominal.mass, self.nominal.delay
        grown = replace(
            self,
            mass=_about(mass, self.mass, factor, LEAST_MASS * mass),
            delay=_about(delay, self.delay, factor, least_delay),
            tau_a=_about(0.0, self.tau_a, factor, 0.0),
            tau_b=_about(0.0, self.tau_b, factor, 0.0),
        )
        return self if factor == 1 and least_delay <= self.delay[0] else grown

    def joined(self, other: PlantBox) -> PlantBox:
        """Return the least box that holds both."""
        return replace(
            self,
            mass=_hull(self.mass, other.mass),
            delay=_hull(self.delay, other.delay),
            tau_a=_hull(self.tau_a, other.tau_a),
            tau_b=_hull(self.tau_b, other.tau_b),
        )


def _about(centre: float, interval: Interval, factor: float, floor: float) -> Interval:
    low, high = (max(centre + factor * (end - centre), floor) for end in interval)
    return low, high


def _hull(a: Interval, b: Interval) -> Interval:
    return min(a[0], b[0]), max(a[1], b[1])


def plants_of(rows: object, share_a: float) -> Plants:
    """Return plants given as rows of mass, delay, τ_A and τ_B."""
    table = np.array(rows, np.float64).reshape(-1, 4)
    columns = [np.ascontiguousarray(column) for column in table.T]
    return Plants(*(*columns, np.full(len(table), share_a)))


@dataclass(frozen=True)
class BoxedLoop:
    """A box of plants and the loop around them.

    Attributes
    ----------
    box
        The plants.
    gains
        The gains of Eq. 18 and Eq. 22.
    filters
        Median, position filter and Eq. 23, as the paths ``"filters"`` and ``"sampled"`` have them,
        or a state estimator in their place, as ``"estimator"`` and ``"sampled"`` have it.
    share_a
        A_A/(A_A + A_B).
    period
        T_S [s], a whole number of the filters' sample times.
    explicit
        The plants that the paths ``"filters"`` and ``"sampled"`` are judged with, where their
        delays are others; None where it is the box.
    """

    box: PlantBox
    gains: LoopGains
    filters: MeasurementPath
    share_a: float
    period: float
    explicit: PlantBox | None = None

    @classmethod
    def of(cls, study: ResolvedStudy, gains: Gains | None = None) -> BoxedLoop:
        """Return the study's problem, with other gains where they are given."""
        controller = study.study.controller
        box, explicit = (
            PlantBox(pack_nominal(study, explicit=own), *ranges_of(study, explicit=own))
            for own in (False, True)
        )
        return cls(
            box,
            pack_gains(gains or study.study.gains),
            pack_measured(study),
            study.study.share_a,
            controller.sampling_period,
            None if explicit == box else explicit,
        )

    def along(self, path: str) -> BoxedLoop:
        """Return the loop whose box is that of a measurement path."""
        if path == "none" or self.explicit is None:
            return self
        return replace(self, box=self.explicit, explicit=None)

    def path(self, name: str) -> MeasurementPath:
        """Return the measurement path of that name."""
        return NO_PATH if name == "none" else self.filters

    @property
    def measured(self) -> str:
        """``"filters"`` or ``"estimator"``: what measures."""
        return "estimator" if self.filters.estimator_mass > 0 else "filters"

    @property
    def holds_sampled(self) -> bool:
        """Whether half a sampling period, the hold's, fits into every delay."""
        box = self.along("sampled").box
        return box.delay[0] >= self.period / 2 and self.filters.sample_time > 0


def edges_of(
    problem: BoxedLoop, omega: Interval, phase: float = 0.0, gain: float = 1.0
) -> FloatArray:
    """Return a box of coordinates as kernels take it, ``(2, 7)``: ω, m_N/m, d, τ_A, τ_B, φ, γ.

    m_N/m is rounded outwards. The phase may be as much to either side, the gain from 1 to its own.
    """
    box = problem.box
    mass = box.nominal.mass
    ratios = (mass / box.mass[1] * (1 - 1e-15), mass / box.mass[0] * (1 + 1e-15))
    louder = (0.0, math.log(gain) * (1 + 1e-15))
    sides = (omega, ratios, box.delay, box.tau_a, box.tau_b, (-phase, phase), louder)
    return np.ascontiguousarray(np.array(sides, np.float64).T)
