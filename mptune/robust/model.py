"""A study's linear model: its plants, its loops and what is asked of them, packed once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from mptune.interop import frequency_response
from mptune.loops.broken import FORCE, NAMES
from mptune.loops.family import FamilyLoops, nominal_plants, plants_of
from mptune.params.pack import pack_gains, pack_measured, pack_nominal, pack_path
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, NominalPlant, Plants
from mptune.robust.at_plant import loop_around_measured, loop_as_it_runs, named_response, no_loop
from mptune.robust.condition import Sides, nominal_loops, sides
from mptune.robust.curves import loop_curves
from mptune.robust.delays import at_same_share, corners_of, joined
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.measured import Members, members_of, whole_family
from mptune.robust.place import PlantPoint, plant_point
from mptune.summary import Summarised

if TYPE_CHECKING:
    from control import FrequencyResponseData

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.params.controller import Gains
    from mptune.params.requirements import RatioCurve, Requirements
    from mptune.params.study import ResolvedStudy

PATHS = ("none", "filters")
"""Paths of continuous loops; ``"estimator"`` stands in the filters' place, ``"sampled"`` runs."""


@dataclass(frozen=True, repr=False)
class LinearModel(Summarised):
    """The linear model of one study.

    Attributes
    ----------
    study
        The study.
    lumped
        The grid of its uncertainty set, ``(N,)`` each, the delay the lumped one of Eq. 14 to 21.
    explicit
        The same plants with the delays that they have where measurement path and sampling stand
        explicitly.
    members
        Measured responses that stand beside the box, or in its place within their band.
    path
        Measurement path that the study's inequalities include.
    filters
        Measurement path as it runs: the filters', or the state estimator's in their place.
    period
        T_S [s].
    """

    study: ResolvedStudy
    lumped: Plants
    explicit: Plants
    members: Members | None
    path: MeasurementPath
    filters: MeasurementPath
    period: float

    @classmethod
    def of(cls, study: ResolvedStudy) -> LinearModel:
        """Return the linear model of a study."""
        lumped = plants_of(study)
        return cls(
            study=study,
            lumped=lumped,
            explicit=plants_of(study, explicit=True),
            members=members_of(study, lumped),
            path=pack_path(study),
            filters=pack_measured(study),
            period=study.study.controller.sampling_period,
        )

    @property
    def headline(self) -> str:
        """Study, uncertainty set and size of the family."""
        chosen = self.study.uncertainty_name or "default"
        size = f"{self.whole_family.number} plants"
        return f"Linear model of {self.study.name}, uncertainty {chosen}: {size}"

    @property
    def plants(self) -> Plants:
        """``(N,)``: the box's plants as the study's inequalities take them."""
        return self.plants_along(self.path)

    @property
    def nominal(self) -> NominalPlant:
        """The nominal plant of Eq. 14, as the study's inequalities take it."""
        return self.nominal_along(self.path)

    def plants_along(self, path: MeasurementPath) -> Plants:
        """Return the box's plants with the delays that go with a measurement path."""
        return self.lumped if path == NO_PATH else self.explicit

    def nominal_along(self, path: MeasurementPath) -> NominalPlant:
        """Return the nominal plant with the delay that goes with a measurement path."""
        return pack_nominal(self.study, explicit=path != NO_PATH)

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
    def path_name(self) -> str:
        """``"none"`` or ``"filters"``: the path that the study's inequalities include."""
        return "none" if self.path == NO_PATH else "filters"

    @property
    def estimated(self) -> bool:
        """Whether a state estimator stands in the filters' place."""
        return self.filters.estimator_mass > 0

    @property
    def paths(self) -> tuple[str, str]:
        """The continuous loops' paths: ``"none"``, and what measures, as it runs."""
        return "none", "estimator" if self.estimated else "filters"

    @property
    def judged_path(self) -> str:
        """The path on which the continuous loops' requirements rest.

        It is that of the inequalities but with a state estimator, around which no velocity loop
        separates: then the loop at F_ref is asked, and Eq. 17 and Eq. 21 are information.
        """
        return "estimator" if self.estimated else self.path_name

    @property
    def runs(self) -> bool:
        """Whether every delay leaves room for the hold, so that there is a sampled loop."""
        return bool(self.explicit.delay.min() >= self.period / 2)

    @cached_property
    def whole_family(self) -> Plants:
        """The box's plants, and the measured members behind them."""
        return whole_family(self.plants, self.members)

    @property
    def member_names(self) -> tuple[str, ...]:
        """The measured response behind each member; empty where nothing was measured."""
        return self.members.names if self.members else ()

    def path_of(self, name: str) -> MeasurementPath:
        """Return one of the study's own ``paths``."""
        return dict(zip(self.paths, (NO_PATH, self.filters), strict=True))[name]

    def loops(
        self,
        gains: Gains | LoopGains,
        path: MeasurementPath | None = None,
        plants: Plants | None = None,
        which: int = FORCE,
    ) -> FamilyLoops:
        """Return the loops of the box's plants, or of those given, with the delays as they are.

        ``path`` is that of the study's inequalities where None.
        """
        packed = gains if isinstance(gains, LoopGains) else pack_gains(gains)
        along = self.path if path is None else path
        family = self.plants_along(along) if plants is None else plants
        return FamilyLoops(family, packed, along, which)

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
        nominal = self.nominal_along(self.path if path is None else path)
        return self.loops(gains, path, nominal_plants(nominal), which)

    def nominal_gains(self, omega: FloatArray, gains: Gains | LoopGains) -> ComplexArray:
        """Return the nominal loop gains at jω, ``(2, F)``: velocity loop, position loop."""
        loops = self.loops(gains)
        return np.asarray(nominal_loops(omega, self.nominal, loops.gains, loops.path))

    def sides(
        self, omega: FloatArray, gains: Gains | LoopGains, plants: Plants | None = None
    ) -> Sides:
        """Return both sides of Eq. 17 and Eq. 21, over the whole family where none are given."""
        return sides(omega, self.loops(gains, plants=plants), self.nominal, self.members)

    def point(self, index: int, frequency: float, *, as_it_runs: bool = False) -> PlantPoint:
        """Return a plant of the family, measured members after the box's plants, at ω [rad/s]."""
        family = whole_family(self.explicit, self.members) if as_it_runs else self.whole_family
        return plant_point(family, index, frequency, self.member_names)

    def plant(self, at: PlantPoint, *, as_it_runs: bool = False) -> Plants:
        """Return the plant at a place, as a family of one.

        With ``as_it_runs`` a plant of the study's inequalities gets the delay that it has where
        path and sampling are explicit.
        """
        delay = at.delay_s
        if as_it_runs and self.path == NO_PATH:
            delay = at_same_share(delay, self.lumped, self.explicit)
        fields = (at.mass_kg, delay, at.tau_a_s, at.tau_b_s, self.plants.share_a[0])
        return Plants(*(np.array([value]) for value in fields))

    def holds(self, at: PlantPoint, *, as_it_runs: bool) -> bool:
        """Return whether a plant is one of the grid's."""
        family = self.explicit if as_it_runs else self.plants
        one = self.plant(at)
        return bool(np.all([a == b[0] for a, b in zip(family, one, strict=True)], 0).any())

    def joined_by(self, at: PlantPoint, *, as_it_runs: bool) -> LinearModel:
        """Return the model with one more plant: found as it runs, or in the inequalities."""
        one = self.plant(at)
        if as_it_runs or self.path != NO_PATH:
            explicit, lumped = joined(self.explicit, self.lumped, one)
        else:
            lumped, explicit = joined(self.lumped, self.explicit, one)
        return replace(self, lumped=lumped, explicit=explicit)

    def to_control(
        self,
        gains: Gains | LoopGains | None = None,
        loop: str = "force",
        path: str | None = None,
        plant: PlantPoint | None = None,
        omega: FloatArray | None = None,
    ) -> FrequencyResponseData:
        """Return a loop gain as python-control's object, its dead time exact.

        python-control's transfer functions and state spaces have no dead time but through Padé's
        approximation. A frequency response holds the values themselves, and so e^{−sd} as it is.

        Parameters
        ----------
        gains
            The gains; the study's own where None.
        loop
            Where it is broken: ``"velocity"``, ``"position"`` or ``"force"`` (at F_ref).
        path
            Measurement path, one of the study's ``paths``, that of the study's inequalities where
            None, or ``"sampled"`` for the loop at F_ref as it runs, in sampled time.
        plant
            A plant of the family, a measured one included, with the delay that it has; the
            nominal one where None.
        omega
            ``(F,)`` frequencies [rad/s]; the first grid of a sweep, or those measured, where None.

        Raises
        ------
        InputError
            If there is no such loop or path, or python-control is not installed.
        """
        if loop not in NAMES:
            raise no_loop("loop", loop, f"choose {', '.join(NAMES)}")
        if path not in {None, *self.paths, "sampled"}:
            raise no_loop("path", path, f"choose {', '.join(self.paths)} or sampled")
        packed = self.loops(self.gains if gains is None else gains).gains
        grid = self._grid(packed, plant, omega)
        name = f"{loop} loop of {self.study.name}"
        if path == "sampled":
            grid = grid[grid <= np.pi / self.period] if omega is None else grid
            return frequency_response(
                self._as_it_runs_at(grid, packed, loop, plant), grid, name, self.period
            )
        along = self.path if path is None else self.path_of(path)
        which = NAMES.index(loop)
        if plant is not None and plant.response is not None:
            measured = named_response(self.members, plant.response)
            values = loop_around_measured(which, grid, measured, plant.mass_kg, packed, along)
        else:
            values = loop_curves(which, grid, self._one(packed, along, plant))[0]
        return frequency_response(values, grid, name)

    def _one(
        self, gains: LoopGains, path: MeasurementPath, plant: PlantPoint | None
    ) -> FamilyLoops:
        """Return the loop of one plant of the box, or of the nominal one, as a family of one."""
        return (
            self.nominal_loop(gains, path)
            if plant is None
            else self.loops(gains, path, self.plant(plant))
        )

    def _grid(
        self, gains: LoopGains, plant: PlantPoint | None, omega: FloatArray | None
    ) -> FloatArray:
        if omega is not None:
            return np.asarray(omega, np.float64)
        if plant is not None and plant.response is not None:
            return named_response(self.members, plant.response).omega
        return first_grid(*frequency_range(self.plants, self.nominal, gains))

    def _as_it_runs_at(
        self, omega: FloatArray, gains: LoopGains, loop: str, plant: PlantPoint | None
    ) -> ComplexArray:
        if loop != "force" or (plant is not None and plant.response is not None):
            remedy = 'ask loop="force" of a plant of the box, or another path'
            raise no_loop("path", "sampled", remedy)
        one = self._one(gains, self.filters, plant)
        if one.plants.delay[0] < self.period / 2:
            remedy = f"it needs a total delay of at least {self.period / 2:g} s"
            raise no_loop("path", "sampled", remedy)
        return loop_as_it_runs(omega, one, self.period)

    def corners(self) -> IntArray:
        """Return the plants with the least or largest mass, all lags smallest or all largest."""
        return corners_of(self.lumped, self.explicit)
