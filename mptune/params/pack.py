"""From study objects to the bare tuples that kernels take: the only bridge between them."""

from __future__ import annotations

import math
from itertools import zip_longest
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import frozen
from mptune.params.chambers import NUMBERS, Side, common_size, volumes_of
from mptune.params.estimator import place_estimator
from mptune.params.line_table import line_table
from mptune.params.packed import (
    AREA,
    CHAMBER_ROWS,
    DEAD,
    HOSE,
    INERTANCE,
    NO_ESTIMATOR,
    NO_PATH,
    RESISTANCE,
    SIZE,
    TRUE_SENSORS,
    FeedforwardTuple,
    ForceSettings,
    LoopGains,
    Machine,
    MeasurementPath,
    MoreChambers,
    NominalPlant,
    SensorErrors,
    SignalSettings,
    StateEstimator,
)

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Controller, Feedforward, Gains
    from mptune.params.machine import SensorTruth
    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy

_REFERENCE_AHEAD = 3e-3  # s, by which the reference's motion is ahead of the machine's force


def pack_gains(gains: Gains) -> LoopGains:
    """Return the gains as a kernel tuple."""
    return LoopGains(gains.k_p_vel, gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi, gains.tau)


def pack_filters(controller: Controller) -> MeasurementPath:
    """Return the controller's measurement path as a kernel tuple."""
    sample_time = controller.fast_sampling_period
    pole = math.exp(-sample_time / controller.position_filter)
    return MeasurementPath(sample_time, pole, controller.position_filter)


def pack_estimator(study: ResolvedStudy) -> StateEstimator:
    """Return the state estimator as a kernel tuple; ``NO_ESTIMATOR`` where filters are used.

    Its mass is the least of the family where the study gives none: with more of it the loop at
    F_ref loses its gain margin.
    """
    asked = study.study.estimator
    if asked.kind == "filters":
        return NO_ESTIMATOR
    gains = place_estimator(asked.bandwidth, study.study.controller.fast_sampling_period)
    mass = study.uncertainty.mass[0] if asked.mass is None else asked.mass
    return StateEstimator(
        mass, gains.position, gains.velocity, gains.load, float(asked.reference_injection)
    )


def pack_measured(study: ResolvedStudy) -> MeasurementPath:
    """Return the measurement path as it runs: the filters', or the state estimator's."""
    path, by = pack_filters(study.study.filtering), pack_estimator(study)
    if by.mass == 0:
        return path
    time = 1 / study.study.estimator.bandwidth
    return MeasurementPath(path.sample_time, 0.0, time, by.mass, by.l_1, by.l_2, by.l_3)


def force_noise(study: ResolvedStudy) -> float:
    """Return the rms of the noise that all pressure sensors make of the force [N]."""
    areas = (one.area for one in study.study.all_chambers)
    return study.study.controller.pressure_noise * math.hypot(*areas)


def pack_sensors(sensors: SensorTruth) -> SensorErrors:
    """Return what is untrue about the sensors as a kernel tuple."""
    return SensorErrors(
        1 + sensors.pressure_gain_error_a,
        1 + sensors.pressure_gain_error_b,
        sensors.pressure_offset_a,
        sensors.pressure_offset_b,
        sensors.position_hysteresis,
        sensors.position_resolution,
    )


def pack_feedforward(
    feedforward: Feedforward, sample_time: float, masses: Range = (0.0, math.inf)
) -> FeedforwardTuple:
    """Return the feed-forward as a kernel tuple, its lags discretised at ``sample_time`` [s].

    ``masses`` [kg] are the family's, within which a mass that is learnt on line stays.
    """

    def pole(lag: float) -> float:
        return math.exp(-sample_time / lag) if lag > 0 else 0.0

    return FeedforwardTuple(
        feedforward.acceleration_mass,
        pole(feedforward.reference_lag),
        pole(feedforward.velocity_reference_lag),
        feedforward.preview,
        float(feedforward.jerk),
        feedforward.viscous_friction,
        feedforward.coulomb_friction,
        feedforward.friction_velocity,
        float(feedforward.adaptive_mass),
        masses[0] if feedforward.adaptive_mass else 0.0,
        masses[1] if feedforward.adaptive_mass else 0.0,
        pole(_REFERENCE_AHEAD) if feedforward.adaptive_mass else 0.0,
        sample_time,
    )


def pack_path(study: ResolvedStudy) -> MeasurementPath:
    """Return the measurement path that the study's linear model includes."""
    if study.study.model.measurement_path == "none":
        return NO_PATH
    return pack_filters(study.study.filtering)


def pack_nominal(study: ResolvedStudy, *, explicit: bool = False) -> NominalPlant:
    """Return the nominal plant as a kernel tuple, its delay lumped or beside an explicit path."""
    box = study.uncertainty
    delay = box.nominal_delay_as_it_runs if explicit else box.nominal_delay
    return NominalPlant(box.nominal_mass, delay)


def pack_machine(
    study: ResolvedStudy, mass: float, oil_bulk_modulus: float, load: float
) -> Machine:
    """Return one machine as a kernel tuple.

    What stands in it of A and B is the sum over all chambers of a side; those of a machine that has
    more than one on a side are ``pack_chambers``.
    """
    hose, valves = study.study.hose, study.study.valves
    pushing, pulling = (volumes_of(study.study.side(side), hose) for side in Side)
    supplies, outer = study.study.supplies, study.study.load
    return Machine(
        area_a=pushing.area,
        area_b=pulling.area,
        stroke=study.study.cylinder.stroke,
        dead_a=pushing.dead,
        dead_b=pulling.dead,
        hose_a=pushing.hose,
        hose_b=pulling.hose,
        oil=oil_bulk_modulus,
        hose=hose.bulk_modulus,
        flow_coefficient=valves.flow_coefficient * common_size(study.study.all_chambers),
        transition_pressure=valves.transition_pressure,
        mass=mass,
        load=load,
        load_stiffness=outer.stiffness,
        start=study.study.verification.start,
        friction_coulomb=outer.friction_coulomb,
        friction_static=outer.friction_static,
        friction_viscous=outer.friction_viscous,
        friction_velocity=outer.friction_velocity,
        low_pressure=supplies.low_pressure,
        pump_on=supplies.pump_on,
        pump_off=supplies.pump_off,
        pump_flow=supplies.pump_flow,
        relief_pressure=supplies.relief_pressure,
        accumulator_volume=supplies.accumulator_volume,
        accumulator_precharge=supplies.accumulator_precharge,
        accumulator_exponent=supplies.accumulator_exponent,
        **_following_pump(study),
        converter_area=supplies.converter_area,
        converter_travel=supplies.converter_travel,
        converter_friction=supplies.converter_friction,
        line_inertance=hose.inertance(pushing.length),
        line_inertance_b=hose.inertance(pulling.length),
        line_resistance=hose.resistance(pushing.length),
        line_resistance_b=hose.resistance(pulling.length),
        converters=study.study.converters,
    )


def pack_chambers(study: ResolvedStudy) -> MoreChambers | None:
    """Return the chambers of a machine that has more than two; None of one that has two.

    Kernels compile in whether there are any, so that those of two chambers know nothing of them.
    """
    chambers, hose = study.study.all_chambers, study.study.hose
    if len(chambers) == NUMBERS[0]:
        return None
    table, settings, known = np.zeros((CHAMBER_ROWS, len(chambers))), [], pack_force(study)
    for place, one in enumerate(chambers):
        own = volumes_of((one,), hose)
        pushes = one.side is Side.PUSHING
        table[AREA, place] = own.area if pushes else -own.area
        table[DEAD, place], table[HOSE, place] = own.dead, own.hose
        table[SIZE, place] = one.valves
        table[INERTANCE, place] = hose.inertance(one.hose_length)
        table[RESISTANCE, place] = hose.resistance(one.hose_length)
        settings.append(
            known._replace(
                area_a=own.area if pushes else 0.0,
                area_b=0.0 if pushes else own.area,
                dead_a=own.dead,
                dead_b=own.dead,
                hose_a=own.hose,
                hose_b=own.hose,
                flow_coefficient=known.flow_coefficient * one.valves,
            )
        )
    return MoreChambers(frozen(table), tuple(settings))


def _following_pump(study: ResolvedStudy) -> dict[str, float]:
    """Return margin, standby pressure and lag of a pump that follows the load; 0 for none."""
    last = study.study.lines[-1] if study.study.lines else None
    values = (last.margin, last.standby, last.lag) if last else ()
    names = ("pump_margin", "pump_standby", "pump_lag")
    return {name: value or 0.0 for name, value in zip_longest(names, values)}


def pack_lines(study: ResolvedStudy) -> FloatArray:
    """Return the table of lines ``(LINE_ROWS, L)``, see ``mptune.params.packed``.

    It is kept apart from ``Machine``, as is the boom's table below.
    """
    return line_table(study.study.lines, study.study.supplies.low_pressure)


def pack_table(study: ResolvedStudy) -> FloatArray:
    """Return the boom's table ``(K, 3)``: position [m], load force [N], factor of the inertia.

    It is kept apart from ``Machine``: kernels are twice as fast with tuples of plain numbers.
    """
    return np.array(study.study.load.table, np.float64).reshape(-1, 3)


def pack_force(study: ResolvedStudy) -> ForceSettings:
    """Return the force controller's settings as a kernel tuple."""
    machine = pack_machine(study, 1.0, study.study.oil.bulk_modulus_estimate, 0.0)
    controller = study.study.controller
    return ForceSettings(
        area_a=machine.area_a,
        area_b=machine.area_b,
        stroke=machine.stroke,
        dead_a=machine.dead_a,
        dead_b=machine.dead_b,
        hose_a=machine.hose_a,
        hose_b=machine.hose_b,
        oil=machine.oil,
        hose=machine.hose,
        flow_coefficient=machine.flow_coefficient,
        transition_pressure=machine.transition_pressure,
        sampling_period=controller.sampling_period,
        pressure_min=controller.pressure_min,
        pressure_max=controller.pressure_max,
        weight_switching=controller.weight_switching,
        weight_loss=controller.weight_loss,
        weight_converter=controller.weight_converter,
        predicted_share={"predicted": 1.0, "present": 0.0, "mean": 0.5}[controller.converter_flow],
        delay_prediction=controller.delay_prediction,
        error_width=controller.error_width if controller.error == "huber" else 0.0,
        path_loss=float(controller.loss == "path"),
        candidates=float(controller.candidates if controller.horizon == 2 else 0),
        weight_common_mode=controller.weight_common_mode,
        steady_state=float(controller.force_model == "steady-state"),
        weight_compression=controller.weight_compression,
        rest_velocity=controller.velocity_tolerance,
        weight_pressure=controller.weight_pressure,
    )


def pack_signals(
    controller: Controller,
    estimator: StateEstimator = NO_ESTIMATOR,
    sensors: SensorErrors = TRUE_SENSORS,
) -> SignalSettings:
    """Return filters or state estimator, tolerances, noise and sensors as a kernel tuple."""
    sample_time = controller.fast_sampling_period

    def pole(time_constant: float) -> float:
        return math.exp(-sample_time / time_constant)

    return SignalSettings(
        sample_time=sample_time,
        ticks=controller.ticks,
        position_pole=pole(controller.position_filter),
        pressure_pole=pole(controller.pressure_filter),
        supply_pole=pole(controller.supply_filter),
        backlash=controller.converter_backlash,
        dead_zone=controller.dead_zone,
        velocity_tolerance=controller.velocity_tolerance,
        stop_tolerance=controller.position_tolerance_stop,
        start_tolerance=controller.position_tolerance_start,
        position_noise=controller.position_noise,
        pressure_noise=controller.pressure_noise,
        converter_noise=controller.converter_noise,
        estimator=estimator,
        sensors=sensors,
    )
