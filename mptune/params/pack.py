"""From study objects to the bare tuples that kernels take: the only bridge between them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.summary import tuple_text

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, FloatArray, IntArray
    from mptune.params.controller import Controller, Feedforward, Gains
    from mptune.params.study import ResolvedStudy


class Plant(NamedTuple):
    """One plant of Eq. 15, in SI."""

    mass: float  # kg, m
    delay: float  # s, T_S/2 + d
    tau_a: float  # s, τ_A
    tau_b: float  # s, τ_B
    share_a: float  # -, A_A/(A_A + A_B)


class Plants(NamedTuple):
    """A family of plants: the fields of ``Plant``, each ``(N,)``."""

    mass: FloatArray
    delay: FloatArray
    tau_a: FloatArray
    tau_b: FloatArray
    share_a: FloatArray

    @property
    def number(self) -> int:
        """N, the number of plants."""
        return len(self.mass)

    def picked(self, rows: IntArray | BoolArray) -> Plants:
        """Return some of the plants: rows by their numbers, or by a mask."""
        return Plants(*(np.ascontiguousarray(column[rows]) for column in self))

    def followed_by(self, others: Plants) -> Plants:
        """Return these plants and others behind them."""
        return Plants(*(np.concatenate(pair) for pair in zip(self, others, strict=True)))

    def __repr__(self) -> str:
        """Return shape and range of each field."""
        return tuple_text(self)


class NominalPlant(NamedTuple):
    """The nominal plant of Eq. 14."""

    mass: float  # kg, m_min
    delay: float  # s, T_S/2 + d_min


class LoopGains(NamedTuple):
    """The gains of Eq. 18 and Eq. 22."""

    k_p_vel: float  # N s/m
    k_p_pos: float  # 1/s
    k_i_pos: float  # 1/s²
    omega: float  # rad/s
    xi: float  # -
    tau: float  # s


class MeasurementPath(NamedTuple):
    """Median, position filter and Eq. 23; a sample time of 0 stands for no path at all."""

    sample_time: float  # s, T_S,fast
    filter_pole: float  # -, pole of the discrete first-order filter
    filter_time: float  # s, its time constant


class Machine(NamedTuple):
    """One machine of Eq. 1 to Eq. 4, all in SI."""

    area_a: float
    area_b: float
    stroke: float
    dead_a: float  # V_0,A + V_h,A
    dead_b: float
    hose_a: float  # V_h,A
    hose_b: float
    oil: float  # B_oil
    hose: float  # B_h
    flow_coefficient: float
    transition_pressure: float
    mass: float
    load: float  # F_load at the start position
    load_stiffness: float
    start: float
    friction_coulomb: float
    friction_static: float
    friction_viscous: float
    friction_velocity: float
    low_pressure: float
    pump_on: float
    pump_off: float
    pump_flow: float
    relief_pressure: float
    accumulator_volume: float
    accumulator_precharge: float
    accumulator_exponent: float
    converter_area: float
    converter_travel: float
    converter_friction: float
    line_inertance: float  # Pa s²/m³, of each hose as a line; 0 where it is part of its chamber
    line_inertance_b: float
    line_resistance: float  # Pa s/m³
    line_resistance_b: float


class ForceSettings(NamedTuple):
    """What the force controller knows and wants, §2.2 and §2.3."""

    area_a: float
    area_b: float
    stroke: float
    dead_a: float
    dead_b: float
    hose_a: float
    hose_b: float
    oil: float  # B̂_oil
    hose: float
    flow_coefficient: float
    transition_pressure: float
    sampling_period: float
    pressure_min: float
    pressure_max: float
    weight_switching: float
    weight_loss: float
    weight_converter: float
    predicted_share: float  # of Eq. 7's Q_conv: 1 predicted, 0 present, 1/2 mean
    delay_prediction: float


class SignalSettings(NamedTuple):
    """Filters, tolerances and noise, §5.2 and Table 2."""

    sample_time: float
    ticks: int  # fast samples in one sampling period
    position_pole: float
    pressure_pole: float
    supply_pole: float
    backlash: float
    dead_zone: float
    velocity_tolerance: float
    stop_tolerance: float  # x_tol1
    start_tolerance: float  # x_tol2
    position_noise: float
    pressure_noise: float
    converter_noise: float


class FeedforwardTuple(NamedTuple):
    """Feed-forward beyond the velocity reference; poles at T_S,fast, 0 for none."""

    acceleration_mass: float  # kg
    reference_pole: float
    velocity_reference_pole: float


NO_PATH = MeasurementPath(0.0, 0.0, 0.0)
NO_TABLE = np.zeros((0, 3))


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


def pack_nominal(study: ResolvedStudy) -> NominalPlant:
    """Return the nominal plant as a kernel tuple."""
    return NominalPlant(study.uncertainty.nominal_mass, study.uncertainty.nominal_delay)


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
