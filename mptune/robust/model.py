"""A study's linear model: its plants, its loops and what is asked of them, packed once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE
from mptune.loops.family import FamilyLoops, nominal_plants, plants_of
from mptune.params.pack import (
    NO_PATH,
    LoopGains,
    MeasurementPath,
    NominalPlant,
    Plants,
    pack_filters,
    pack_gains,
    pack_nominal,
    pack_path,
)
from mptune.robust.condition import Sides, nominal_loops, sides
from mptune.robust.measured import Members, members_of, whole_family
from mptune.robust.place import PlantPoint, plant_point

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.params.controller import Gains
    from mptune.params.requirements import RatioCurve, Requirements
    from mptune.params.study import ResolvedStudy

PATHS = ("none", "filters")
"""Measurement paths of the continuous loops; the third, ``"sampled"``, is the loop as it runs."""


@dataclass(frozen=True)
class LinearModel:
    """The linear model of one study.

    Attributes
    ----------
    study
        The study.
    plants
        The grid of its uncertainty set, ``(N,)`` each.
    nominal
        The nominal plant of Eq. 14.
    members
        Measured responses that stand beside the box, or in its place within their band.
    path
        Measurement path that the study's inequalities include.
    filters
        Measurement path as it runs.
    period
        T_S [s].
    """

    study: ResolvedStudy
    plants: Plants
    nominal: NominalPlant
    members: Members | None
    path: MeasurementPath
    filters: MeasurementPath
    period: float

    @classmethod
    def of(cls, study: ResolvedStudy) -> LinearModel:
        """Return the linear model of a study."""
        plants = plants_of(study)
        return cls(
            study=study,
            plants=plants,
            nominal=pack_nominal(study),
            members=members_of(study, plants),
            path=pack_path(study),
            filters=pack_filters(study.study.controller),
            period=study.study.controller.sampling_period,
        )

    @property
    def requirements(self) -> Requirements:
        """What the study asks for."""
        return self.study.study.requirements

    @property
    def limits(self) -> tuple[float | RatioCurve, float | RatioCurve]:
        """The largest allowed ratios of Eq. 17 and Eq. 21."""
        return self.requirements.velocity_ratio, self.requirements.position_ratio

    @property
    def gains(self) -> LoopGains:
        """The study's own gains."""
        return pack_gains(self.study.study.gains)

    @property
    def runs(self) -> bool:
        """Whether every delay leaves room for the hold, so that there is a sampled loop."""
        return bool(self.plants.delay.min() >= self.period / 2)

    @cached_property
    def whole_family(self) -> Plants:
        """The box's plants, and the measured members behind them."""
        return whole_family(self.plants, self.members)

    @property
    def member_names(self) -> tuple[str, ...]:
        """The measured response behind each member; empty where nothing was measured."""
        return self.members.names if self.members else ()

    def path_of(self, name: str) -> MeasurementPath:
        """Return the measurement path ``"none"`` or ``"filters"``."""
        return {"none": NO_PATH, "filters": self.filters}[name]

    def loops(
        self,
        gains: Gains | LoopGains,
        path: MeasurementPath | None = None,
        plants: Plants | None = None,
        which: int = FORCE,
    ) -> FamilyLoops:
        """Return the loops of the box's plants, or of those given.

        ``path`` is that of the study's inequalities where None.
        """
        packed = gains if isinstance(gains, LoopGains) else pack_gains(gains)
        family = self.plants if plants is None else plants
        return FamilyLoops(family, packed, self.path if path is None else path, which)

    def as_it_runs(self, gains: Gains | LoopGains, plants: Plants | None = None) -> FamilyLoops:
        """Return the loops with the measurement path as it runs."""
        return self.loops(gains, self.filters, plants)

    def nominal_loop(
        self,
        gains: Gains | LoopGains,
        path: MeasurementPath | None = None,
        which: int = FORCE,
    ) -> FamilyLoops:
        """Return the loop of the nominal plant, as a family of one."""
        return self.loops(gains, path, nominal_plants(self.nominal), which)

    def nominal_gains(self, omega: FloatArray, gains: Gains | LoopGains) -> ComplexArray:
        """Return the nominal loop gains at jω, ``(2, F)``: velocity loop, position loop."""
        loops = self.loops(gains)
        return np.asarray(nominal_loops(omega, self.nominal, loops.gains, loops.path))

    def sides(
        self, omega: FloatArray, gains: Gains | LoopGains, plants: Plants | None = None
    ) -> Sides:
        """Return both sides of Eq. 17 and Eq. 21, over the whole family where none are given."""
        return sides(omega, self.loops(gains, plants=plants), self.nominal, self.members)

    def point(self, index: int, frequency: float) -> PlantPoint:
        """Return a plant of the family, measured members after the box's plants, at ω [rad/s]."""
        return plant_point(self.whole_family, index, frequency, self.member_names)

    def plant(self, at: PlantPoint) -> Plants:
        """Return the plant at a place, as a family of one."""
        fields = (at.mass_kg, at.delay_s, at.tau_a_s, at.tau_b_s, self.plants.share_a[0])
        return Plants(*(np.array([value]) for value in fields))

    def corners(self) -> IntArray:
        """Return the plants with the least or largest mass, all lags smallest or all largest."""
        plants = self.plants
        lags = np.stack([plants.delay, plants.tau_a, plants.tau_b])
        small = np.all(lags == lags.min(axis=1, keepdims=True), axis=0)
        large = np.all(lags == lags.max(axis=1, keepdims=True), axis=0)
        light, heavy = plants.mass == plants.mass.min(), plants.mass == plants.mass.max()
        return np.flatnonzero((small | large) & (light | heavy))
