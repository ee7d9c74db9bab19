"""One draw of a campaign: the machine, noise and moves that its parameters make."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.campaign.scaled_moves import scaled
from mptune.campaign.temperature import temperature_factors
from mptune.errors import Fault, InputError
from mptune.params.campaign import Campaign
from mptune.params.machine import SensorTruth
from mptune.params.pack import pack_sensors
from mptune.params.packed import RESISTANCE
from mptune.sim.moves import moves_of
from mptune.verify.verify import Case, check_delay, check_repeats, delays_of, rig_of

if TYPE_CHECKING:
    from mptune.arrays import FloatArray, IntArray
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy
    from mptune.verify.verify import Rig


_LINES = 0.5  # of ``lines``: from there on hoses are lines


class Draw(NamedTuple):
    """The parameters of one run in SI; meanings stand in ``mptune.params.campaign``."""

    mass: float
    valve_delay: float  # at the reference temperature, as the next
    oil_bulk_modulus: float
    load_force: float
    friction: float
    temperature: float
    noise: float
    lines: float
    pressure_gain_error_a: float
    pressure_gain_error_b: float
    pressure_offset_a: float
    pressure_offset_b: float
    position_hysteresis: float
    position_resolution: float
    distance: float
    duration: float


PARAMETER_UNITS = {
    name: unit for name, unit, *_ in Campaign.quantities() if name in Draw._fields
}  # in the order of ``Draw``


class Box(NamedTuple):
    """Least and largest value of every parameter, ``(16,)`` each, in the order of ``Draw``."""

    low: FloatArray
    high: FloatArray

    @property
    def varying(self) -> IntArray:
        """Places of the parameters that are not fixed."""
        return np.flatnonzero(self.high > self.low)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters that are not fixed."""
        return tuple(Draw._fields[place] for place in self.varying)


def box_of(study: ResolvedStudy) -> Box:
    """Return the box of a study's campaign; the study's own ranges where it gives none.

    Raises
    ------
    InputError
        If the slowest valve is too slow, or the longest move leaves the stroke.
    """
    asked, loads = study.study.campaign, study.study.verification.load_forces
    own = {key: getattr(study.study.sensors, key) for key, *_ in SensorTruth.quantities()}
    own["lines"] = float(study.study.hose.dynamics)
    ranges = {key: getattr(asked, key) or (value, value) for key, value in own.items()}
    ranges |= {
        "mass": asked.mass or study.uncertainty.mass,
        "valve_delay": asked.valve_delay or study.study.valves.delay,
        "oil_bulk_modulus": asked.oil_bulk_modulus or study.study.oil.bulk_modulus,
        "load_force": asked.load_force or (min(loads), max(loads)),
    }
    low, high = np.array(
        [ranges.get(name) or getattr(asked, name) for name in Draw._fields], np.float64
    ).T
    coldest = temperature_factors(asked.temperature[0])
    check_delay(study, "campaign.valve_delay", float(high[1]) * coldest.valve_delay)
    check_repeats(study, "campaign.sets", asked.sets)
    _check_stroke(study, asked.distance[1])
    return Box(low, high)


def _check_stroke(study: ResolvedStudy, longest: float) -> None:
    position, stroke = study.study.verification.start, study.study.cylinder.stroke
    for move in study.study.manoeuvre:
        for place in move.reach:
            if not 0 <= position + longest * place <= stroke:
                fault = Fault(
                    "campaign.distance",
                    f"{longest:g}",
                    f"takes a manoeuvre to {position + longest * place:g} m, outside the stroke",
                    "take a smaller factor or change verification.start",
                )
                raise InputError(study.name, fault)
        position += longest * move.net_distance


def rig_of_draw(
    study: ResolvedStudy, draw: Draw, gains: Gains, feedforward: Feedforward, seed: int
) -> tuple[Case, Rig]:
    """Return the machine that a draw makes, and what runs on it."""
    warm = temperature_factors(draw.temperature)
    delay = draw.valve_delay * warm.valve_delay
    case = Case(
        mass=draw.mass,
        valve_delay=(delay, delay),
        oil_bulk_modulus=draw.oil_bulk_modulus * warm.bulk_modulus,
        load_force=draw.load_force,
        seed=seed,
    )
    rig = rig_of(_with_hoses(study, draw), case, gains, feedforward)
    machine, signals = rig.machine, rig.signals
    machine = machine._replace(
        friction_coulomb=machine.friction_coulomb * draw.friction,
        friction_static=machine.friction_static * draw.friction,
        friction_viscous=machine.friction_viscous * draw.friction * warm.viscosity,
        line_resistance=machine.line_resistance * warm.viscosity,
        line_resistance_b=machine.line_resistance_b * warm.viscosity,
    )
    signals = signals._replace(
        position_noise=signals.position_noise * draw.noise,
        pressure_noise=signals.pressure_noise * draw.noise,
        converter_noise=signals.converter_noise * draw.noise,
        sensors=pack_sensors(_sensors(draw)),
    )
    more = rig.more
    if more is not None:
        table = more.table.copy()
        table[RESISTANCE] *= warm.viscosity
        more = more._replace(table=frozen(table))
    delays = delays_of(study, case.valve_delay)
    rig = rig._replace(machine=machine, signals=signals, delays=delays, more=more)
    if (draw.distance, draw.duration) != (1.0, 1.0):
        moves = [scaled(move, draw.distance, draw.duration) for move in study.study.manoeuvre]
        rig = rig._replace(moves=moves_of(moves))
    return case, rig


def _sensors(draw: Draw) -> SensorTruth:
    values = draw._asdict()
    return SensorTruth.model_construct(**{key: values[key] for key, *_ in SensorTruth.quantities()})


def _with_hoses(study: ResolvedStudy, draw: Draw) -> ResolvedStudy:
    """Return the study with its hoses as lines, or as a part of their chambers."""
    machine, lines = study.study, draw.lines >= _LINES
    if machine.hose.dynamics == lines:
        return study
    hose = machine.hose.model_copy(update={"dynamics": lines})
    return study.model_copy(update={"study": machine.model_copy(update={"hose": hose})})
