"""What the sensors of the closed loop tell at each tick, and what is filtered out of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, lending_kernel
from mptune.params.packed import AREA
from mptune.plant.chambers import place_of
from mptune.plant.machine import CONVERTER, OIL, PRESSURE_A, PRESSURE_B, X
from mptune.plant.supplies import accumulator_pressure
from mptune.signals.adaptive_mass import fed_mass, learn_mass
from mptune.signals.conditioning import backlash, median_of_three
from mptune.signals.differentiator import remember
from mptune.signals.estimator import estimate
from mptune.signals.states import LAST_VELOCITY_REFERENCE
from mptune.sim.memory import SENSED, SIGNALS, Memory, chamber_of_signal

if TYPE_CHECKING:
    from mptune.params.packed import (
        FeedforwardTuple,
        ForceSettings,
        Machine,
        MoreChambers,
        SensorErrors,
        SignalSettings,
    )
    from mptune.signals.outer_loop import OuterLaw


@lending_kernel
def _sensed_position(memory: Memory, signals: SignalSettings) -> float:
    """Return where the position sensor's hysteresis stands [m]."""
    hysteresis = signals.sensors.hysteresis
    place: float = memory.state[X]
    if hysteresis > 0:
        place = backlash(memory.outer[SENSED], place, hysteresis)
        memory.outer[SENSED] = place
    return place


@lending_kernel
def _sensed_pressure(
    pressure: float, chamber: int, sensors: SensorErrors, more: MoreChambers
) -> float:
    """Return what the sensor of a chamber tells [Pa]: all of one side are untrue alike."""
    if more.table[AREA, chamber] > 0:
        return sensors.gain_a * pressure + sensors.offset_a
    return sensors.gain_b * pressure + sensors.offset_b


@lending_kernel
def measure(  # noqa: C901, PLR0912 - one signal after another, in one loop for speed
    memory: Memory,
    machine: Machine,
    signals: SignalSettings,
    settings: ForceSettings,
    law: OuterLaw,
    v_ref: float,
    random: np.random.Generator,
    more: MoreChambers | None = None,
) -> None:
    """Sample every sensor, take the median of three, filter; then backlash and history."""
    state, sensors = memory.state, signals.sensors
    place, force = 0.0, 0.0  # of the medians
    for i in range(len(memory.filtered)):
        if i == 0:
            value, noise = _sensed_position(memory, signals), signals.position_noise
            pole = signals.position_pole
        elif i == 1:
            value = sensors.gain_a * state[PRESSURE_A] + sensors.offset_a
            noise, pole = signals.pressure_noise, signals.pressure_pole
        elif i == 2:
            value = sensors.gain_b * state[PRESSURE_B] + sensors.offset_b
            noise, pole = signals.pressure_noise, signals.pressure_pole
        elif i == 3:
            value = accumulator_pressure(state[OIL], machine)
            noise, pole = signals.pressure_noise, signals.supply_pole
        elif i == 4:
            value, noise = machine.low_pressure, signals.pressure_noise
            pole = signals.supply_pole
        else:
            value, noise = state[CONVERTER + i - SIGNALS], signals.converter_noise
            pole = signals.supply_pole
        if more is not None:
            chamber = chamber_of_signal(i, len(memory.converters))
            if chamber >= 0:
                value = _sensed_pressure(state[place_of(chamber, machine)], chamber, sensors, more)
                noise, pole = signals.pressure_noise, signals.pressure_pole
        sample = value + noise * random.standard_normal()
        if i == 0 and sensors.quantum > 0:
            sample = sensors.quantum * np.rint(sample / sensors.quantum)
        middle = median_of_three(sample, memory.raw[0, i], memory.raw[1, i])
        memory.raw[1, i] = memory.raw[0, i]
        memory.raw[0, i] = sample
        memory.filtered[i] = pole * memory.filtered[i] + (1 - pole) * middle
        if i == 0:
            place = middle
        elif more is not None:
            chamber = chamber_of_signal(i, len(memory.converters))
            if chamber >= 0:
                force += more.table[AREA, chamber] * middle
        elif i == 1:
            force = settings.area_a * middle
        elif i == 2:
            force -= settings.area_b * middle
    for i in range(len(memory.converters)):
        memory.converters[i] = backlash(
            memory.converters[i], memory.filtered[SIGNALS + i], signals.backlash
        )
    remember(memory.history, memory.filtered[0])
    know_load(memory.outer, law.ahead, signals, place, force, v_ref)


@lending_kernel
def know_load(
    outer: FloatArray,
    ahead: FeedforwardTuple,
    signals: SignalSettings,
    position: float,
    force: float,
    v_ref: float,
) -> None:
    """Carry on what hears the force: the state estimator, and the mass that is learnt."""
    by = signals.estimator
    if by.mass > 0:
        estimate(outer, by, signals.sample_time, position, force, v_ref, fed_mass(outer, ahead))
    if ahead.adaptive > 0:
        learn_mass(outer, ahead, force, v_ref)
    outer[LAST_VELOCITY_REFERENCE] = v_ref
