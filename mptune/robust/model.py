"""What is to be tuned: a study's family, loops, moves and requirements, packed once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.family import plants_of
from mptune.params.pack import (
    LoopGains,
    MeasurementPath,
    NominalPlant,
    Plants,
    pack_filters,
    pack_gains,
    pack_nominal,
    pack_path,
)
from mptune.robust.condition import Sides, sides
from mptune.robust.measured import Members, members_of, whole_family
from mptune.robust.place import PlantPoint, plant_point
from mptune.sim.moves import Moves, moves_of

if TYPE_CHECKING:
    from mptune.arrays import FloatArray, IntArray
    from mptune.params.requirements import Requirements
    from mptune.params.study import ResolvedStudy


@dataclass(frozen=True)
class Task:
    """One study's tuning task.

    Attributes
    ----------
    plants
        The family's box, ``(N,)`` each.
    members
        Measured responses that stand beside it, or in its place within their band.
    path
        Measurement path that the study's model includes.
    filters
        Measurement path as it runs, which the sampled loop always has.
    period
        T_S [s].
    """

    study: ResolvedStudy
    plants: Plants
    nominal: NominalPlant
    members: Members | None
    share_a: float
    path: MeasurementPath
    filters: MeasurementPath
    period: float

    @classmethod
    def of(cls, study: ResolvedStudy) -> Task:
        """Return the task of a study."""
        plants = plants_of(study)
        return cls(
            study=study,
            plants=plants,
            members=members_of(study, plants),
            nominal=pack_nominal(study),
            share_a=study.study.cylinder.share_a,
            path=pack_path(study),
            filters=pack_filters(study.study.controller),
            period=study.study.controller.sampling_period,
        )

    @property
    def requirements(self) -> Requirements:
        """What the study asks for."""
        return self.study.study.requirements

    @property
    def start(self) -> LoopGains:
        """The study's own gains."""
        return pack_gains(self.study.study.gains)

    @cached_property
    def moves(self) -> tuple[Moves, ...]:
        """The study's moves, each from rest.

        The loop is linear: moves that differ by their distance only have the same index.
        """
        alike = {
            move if move.kind == "file" else move.model_copy(update={"distance": 1.0})
            for move in self.study.study.manoeuvre
        }
        return tuple(moves_of([move]) for move in sorted(alike, key=repr))

    def picked(self, rows: IntArray) -> Plants:
        """Return some plants of the family."""
        return Plants(*(np.ascontiguousarray(column[rows]) for column in self.plants))

    def sides(self, omega: FloatArray, gains: LoopGains, plants: Plants | None = None) -> Sides:
        """Return both sides of Eq. 17 and Eq. 21, over the whole family where none are given."""
        family = self.plants if plants is None else plants
        return sides(omega, family, self.nominal, self.share_a, gains, self.path, self.members)

    def point(self, index: int, frequency: float) -> PlantPoint:
        """Return a plant of the family, measured members after the box's plants, at ω [rad/s]."""
        names = self.members.names if self.members else ()
        return plant_point(whole_family(self.plants, self.members), index, frequency, names)

    def corners(self) -> IntArray:
        """Return the plants with the least or largest mass, all lags smallest or all largest."""
        plants = self.plants
        lags = np.stack([plants.delay, plants.tau_a, plants.tau_b])
        small = np.all(lags == lags.min(axis=1, keepdims=True), axis=0)
        large = np.all(lags == lags.max(axis=1, keepdims=True), axis=0)
        light, heavy = plants.mass == plants.mass.min(), plants.mass == plants.mass.max()
        return np.flatnonzero((small | large) & (light | heavy))
