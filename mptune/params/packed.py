"""The bare tuples that kernels take, all in SI: their layout is compiled in."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.summary import tuple_text

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, FloatArray, IntArray

SUBSTEPS = 5  # of the machine's integration in one T_S,fast

# Rows of a table of lines ``(LINE_ROWS, L)``, lowest pressure first. A line stands at
# base + share (p_high − base), where p_high is the pressure of the highest line.
BASE = 0  # Pa
RESTS = 1  # 1 where the base is the lowest line's pressure as measured, else 0
SHARE = 2  # -, α
FROM_LOWEST = 3  # -, how much of the oil that is drawn comes from the lowest line
FROM_STEADY = 4  # Pa, energy of the oil that comes from constant lines between, per m³ drawn
MADE_BY = 5  # number of the converter cylinder that makes the line; −1 for none
LINE_ROWS = 6
# Further rows of the table as a machine stands, ``(OPEN_ROWS, L)``: the lines that have an open
# valve side by side, with the open valves to each chamber [K_v]; 0 behind the last of them.
OPEN_A, OPEN_B = LINE_ROWS, LINE_ROWS + 1
OPEN_ROWS = LINE_ROWS + 2

# Rows of a table of chambers ``(CHAMBER_ROWS, C)``, in the order of the study.
AREA = 0  # m², positive where pressure pushes the piston out
DEAD = 1  # m³, V_0 + V_h
HOSE = 2  # m³, V_h
SIZE = 3  # -, of the chamber's valves, in those of the edges
INERTANCE = 4  # Pa s²/m³, of its hose as a line; 0 where it is part of the chamber
RESISTANCE = 5  # Pa s/m³
CHAMBER_ROWS = 6


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
    filter_time: float  # s, its time constant; of a state estimator 1/ω_o
    estimator_mass: float = 0.0  # kg, m̂ of a state estimator in the filter's and Eq. 23's place
    l_1: float = 0.0  # -, its correction of position
    l_2: float = 0.0  # 1/s, of velocity
    l_3: float = 0.0  # 1/s², of load force over m̂


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
    accumulator_volume: float  # 0 where the highest line has none: it is then constant
    accumulator_precharge: float
    accumulator_exponent: float
    pump_margin: float  # Pa, of a pump that follows the load
    pump_standby: float  # Pa, its least pressure; relief_pressure is its largest
    pump_lag: float  # s; 0 without such a pump
    converter_area: float
    converter_travel: float
    converter_friction: float
    line_inertance: float  # Pa s²/m³, of each hose as a line; 0 where it is part of its chamber
    line_inertance_b: float
    line_resistance: float  # Pa s/m³
    line_resistance_b: float
    converters: int  # K, converter cylinders


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
    error_width: float  # N, f_0 of Huber's count; 0 counts linearly
    path_loss: float  # 1 takes losses along Eq. 5's steps, 0 at both ends
    candidates: float  # combinations looked at two periods ahead; 0 looks one ahead
    weight_common_mode: float
    steady_state: float  # 1 judges by settled pressures, 0 by those after T_S
    weight_compression: float
    rest_velocity: float  # m/s, below which a closed chamber counts as settled
    weight_pressure: float  # N/Pa, of pressures beyond their limits; 0 for a fixed penalty


class MoreChambers(NamedTuple):
    """The chambers of a machine that has more than two."""

    table: FloatArray  # (CHAMBER_ROWS, C)
    # (C,) what the force controller knows of each: as of side A where it pushes, else of side B,
    # with the flow coefficient of its own valves.
    settings: tuple[ForceSettings, ...]


class StateEstimator(NamedTuple):
    """The state estimator as it runs at T_S,fast; a mass of 0 stands for the paper's filters."""

    mass: float  # kg, m̂
    l_1: float  # -
    l_2: float  # 1/s
    l_3: float  # 1/s²
    injected: float  # 1 where the reference is injected, else 0


class SensorErrors(NamedTuple):
    """What is untrue about the sensors beside their noise."""

    gain_a: float  # -, 1 where true
    gain_b: float
    offset_a: float  # Pa
    offset_b: float
    hysteresis: float  # m, of the position sensor
    quantum: float  # m, its resolution; 0 for none


NO_ESTIMATOR = StateEstimator(0.0, 0.0, 0.0, 0.0, 0.0)
TRUE_SENSORS = SensorErrors(1.0, 1.0, 0.0, 0.0, 0.0, 0.0)


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
    estimator: StateEstimator = NO_ESTIMATOR
    sensors: SensorErrors = TRUE_SENSORS


class FeedforwardTuple(NamedTuple):
    """Feed-forward beyond the velocity reference; poles at T_S,fast, 0 for none."""

    acceleration_mass: float  # kg
    reference_pole: float
    velocity_reference_pole: float
    preview: float = 0.0  # s
    jerk: float = 0.0  # 1 where the acceleration ahead comes from the jerk, else 0
    viscous_friction: float = 0.0  # N s/m
    coulomb_friction: float = 0.0  # N
    friction_velocity: float = 1.0  # m/s, above 0
    adaptive: float = 0.0  # 1 where the mass is learnt on line, else 0
    mass_least: float = 0.0  # kg, bounds of a mass that is learnt
    mass_largest: float = 0.0
    regressor_pole: float = 0.0  # at T_S,fast, of the lag between reference and force
    sample_time: float = 1.0  # s, T_S,fast


NO_FEEDFORWARD = FeedforwardTuple(0.0, 0.0, 0.0)
NO_PATH = MeasurementPath(0.0, 0.0, 0.0)
NO_TABLE = np.zeros((0, 3))
