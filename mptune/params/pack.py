"""From study objects to the bare tuples that kernels take: the only bridge between them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mptune.params.packed import (
    NO_PATH,
    FeedforwardTuple,
    ForceSettings,
    LoopGains,
    Machine,
    MeasurementPath,
    NominalPlant,
    SignalSettings,
)

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Controller, Feedforward, Gains
    from mptune.params.study import ResolvedStudy


def pack_gains(gains: Gains) -> LoopGains:
    """Return the gains as a kernel tuple."""
    return LoopGains(gains.k_p_vel, gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi, gains.tau)


def pack_filters(controller: Controller) -> MeasurementPath:
    """Return the controller's measurement path as a kernel tuple."""
    sample_time = controller.fast_sampling_period
    pole = math.exp(-sample_time / controller.position_filter)
    return MeasurementPath(sample_time, pole, controller.position_filter)


def pack_feedforward(feedforward: Feedforward, sample_time: float) -> FeedforwardTuple:
    """Return the feed-forward as a kernel tuple, its lags discretised at ``sample_time`` [s]."""

    def pole(lag: float) -> float:
        return math.exp(-sample_time / lag) if lag > 0 else 0.0

    return FeedforwardTuple(
        feedforward.acceleration_mass,
        pole(feedforward.reference_lag),
        pole(feedforward.velocity_reference_lag),
    )


def pack_path(study: ResolvedStudy) -> MeasurementPath:
    """Return the measurement path that the study's linear model includes."""
    if study.study.model.measurement_path == "none":
        return NO_PATH
    return pack_filters(study.study.controller)


def pack_nominal(study: ResolvedStudy, *, explicit: bool = False) -> NominalPlant:
    """Return the nominal plant as a kernel tuple, its delay lumped or beside an explicit path."""
    box = study.uncertainty
    delay = box.nominal_delay_as_it_runs if explicit else box.nominal_delay
    return NominalPlant(box.nominal_mass, delay)


def pack_machine(
    study: ResolvedStudy, mass: float, oil_bulk_modulus: float, load: float
) -> Machine:
    """Return one machine as a kernel tuple."""
    cylinder, hose, valves = study.study.cylinder, study.study.hose, study.study.valves
    supplies, outer = study.study.supplies, study.study.load
    section = math.pi / 4 * hose.diameter**2
    inertance = hose.oil_density / section if hose.dynamics else 0.0
    resistance = 8 * math.pi * hose.oil_viscosity / section**2  # laminar
    return Machine(
        area_a=cylinder.area_a,
        area_b=cylinder.area_b,
        stroke=cylinder.stroke,
        dead_a=cylinder.dead_volume_a + hose.volume_a,
        dead_b=cylinder.dead_volume_b + hose.volume_b,
        hose_a=hose.volume_a,
        hose_b=hose.volume_b,
        oil=oil_bulk_modulus,
        hose=hose.bulk_modulus,
        flow_coefficient=valves.flow_coefficient,
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
        converter_area=supplies.converter_area,
        converter_travel=supplies.converter_travel,
        converter_friction=supplies.converter_friction,
        line_inertance=inertance * hose.length_a,
        line_inertance_b=inertance * hose.length_b,
        line_resistance=resistance * hose.length_a,
        line_resistance_b=resistance * hose.length_b,
    )


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
    )


def pack_signals(controller: Controller) -> SignalSettings:
    """Return filters, tolerances and noise as a kernel tuple."""
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
    )
