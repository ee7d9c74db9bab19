"""Every number that the controller on the target runs with, in SI, by name.

One list serves all formats: tables, C, function mock-up units and Structured Text.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.errors import Fault, InputError
from mptune.export.formats import Precision
from mptune.force.cost import force_limits
from mptune.params.chambers import Side, common_size, volumes_of
from mptune.params.pack import (
    pack_estimator,
    pack_feedforward,
    pack_force,
    pack_gains,
    pack_signals,
)
from mptune.signals.tustin import discretise

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy

_MEANINGS = {
    "k_p_vel": ("N s/m", "velocity gain, Eq. 18"),
    "b0": ("1/s", "Eq. 22 by Tustin, second-order section, on the error now"),
    "b1": ("1/s", "on the error one T_S ago"),
    "b2": ("1/s", "on the error two T_S ago"),
    "a1": ("1", "on its output one T_S ago"),
    "a2": ("1", "on its output two T_S ago"),
    "integral_rate": ("1/s", "Eq. 22 by Tustin, integral: K_I,pos T_S/2"),
    "dead_zone": ("m", "error below which the integral stands still"),
    "force_least": ("N", "limit of F_ref: A_A p_min - A_B p_max"),
    "force_largest": ("N", "limit of F_ref: A_A p_max - A_B p_min"),
    "acceleration_mass": ("kg", "mass of the acceleration feed-forward"),
    "reference_pole": ("1", "pole of the lag of x_ref at T_S,fast; 0 for none"),
    "velocity_reference_pole": ("1", "pole of the lag of v_ref at T_S,fast; 0 for none"),
    "preview": ("s", "how far ahead acceleration_reference is of the other references"),
    "jerk": ("1", "1 where it is a_ref + preview j_ref of now instead: the future is unknown"),
    "viscous_friction": ("N s/m", "viscous friction fed forward"),
    "coulomb_friction": ("N", "Coulomb friction fed forward"),
    "friction_velocity": ("m/s", "velocity reference about which Coulomb friction turns over"),
    "adaptive": ("1", "1 where the mass is learnt on line"),
    "mass_least": ("kg", "bound of a mass that is learnt"),
    "mass_largest": ("kg", "bound of a mass that is learnt"),
    "regressor_pole": ("1", "pole of the lag between reference and force, of the regression"),
    "estimator_mass": ("kg", "mass of the state estimator; 0 for filters and Eq. 23"),
    "l_1": ("1", "its correction of the position"),
    "l_2": ("1/s", "of the velocity"),
    "l_3": ("1/s^2", "of the load force over its mass"),
    "injected": ("1", "1 where the reference is injected into it"),
    "sample_time": ("s", "T_S,fast"),
    "position_pole": ("1", "pole of the position filter at T_S,fast"),
    "pressure_pole": ("1", "pole of the chamber pressure filters"),
    "supply_pole": ("1", "pole of the supply pressure and converter filters"),
    "backlash": ("m", "width of the converters' backlash"),
    "velocity_tolerance": ("m/s", "stop logic: v_ref below it counts as rest"),
    "stop_tolerance": ("m", "stop logic: error to stop, Eq. 9"),
    "start_tolerance": ("m", "stop logic: error to start again, Eq. 10"),
    "area_a": ("m^2", "A_A"),
    "area_b": ("m^2", "A_B"),
    "stroke": ("m", "x_max"),
    "dead_a": ("m^3", "V_0,A + V_h,A"),
    "dead_b": ("m^3", "V_0,B + V_h,B"),
    "hose_a": ("m^3", "V_h,A"),
    "hose_b": ("m^3", "V_h,B"),
    "oil": ("Pa", "estimated bulk modulus of the oil"),
    "hose": ("Pa", "bulk modulus of the hose"),
    "flow_coefficient": ("m^3/(s Pa^0.5)", "K_v of one valve"),
    "transition_pressure": ("Pa", "pressure difference below which the orifice is smoothed"),
    "sampling_period": ("s", "T_S"),
    "pressure_min": ("Pa", "p_min"),
    "pressure_max": ("Pa", "p_max"),
    "weight_switching": ("N", "W_sw"),
    "weight_loss": ("N/J", "W_loss"),
    "weight_converter": ("N s/m^6", "W_conv"),
    "predicted_share": ("1", "of Q_conv in Eq. 7: 1 predicted, 0 present, 0.5 mean"),
    "delay_prediction": ("s", "valve delay predicted through; 0 for none"),
    "error_width": ("N", "force error from which Huber's count is linear; 0 counts linearly"),
    "path_loss": ("1", "1 takes losses along Eq. 5's steps, 0 at both ends, Eq. 8"),
    "candidates": ("1", "combinations looked at two periods ahead; 0 looks one ahead"),
    "weight_common_mode": ("N/Pa", "W_cm"),
    "steady_state": ("1", "1 judges by settled pressures, 0 by those after T_S"),
    "weight_compression": ("N/J", "W_comp"),
    "weight_pressure": ("N/Pa", "of a pressure beyond its limits; 0 for the fixed penalty"),
    "rest_velocity": ("m/s", "velocity below which a closed chamber counts as settled"),
    "position_least": ("m", "accepted position and reference"),
    "position_largest": ("m", "accepted position and reference"),
    "pressure_least": ("Pa", "accepted pressure"),
    "pressure_largest": ("Pa", "accepted pressure"),
    "converter_largest": ("m", "accepted converter position, either way"),
    "velocity_reference_largest": ("m/s", "accepted v_ref, either way"),
    "acceleration_reference_largest": ("m/s^2", "accepted a_ref, either way"),
}


_OF_CHAMBERS = {
    "area": ("m^2", "A_i"),
    "dead": ("m^3", "V_0,i + V_h,i"),
    "hose": ("m^3", "V_h,i"),
    "flow_coefficient": ("m^3/(s Pa^0.5)", "K_v of one valve"),
    "pulls": ("1", "1 where its pressure pulls the piston in"),
}


class Number(NamedTuple):
    """One number of the controller."""

    key: str
    value: float
    unit: str
    meaning: str


@dataclass(frozen=True)
class Numbers:
    """The controller's numbers.

    Attributes
    ----------
    sections
        The numbers in SI, by section.
    ticks
        Fast sampling periods in one sampling period.
    precision
        The arithmetic that they are rounded to.
    chambers
        The numbers of each chamber.
    """

    sections: dict[str, tuple[Number, ...]]
    ticks: int
    precision: Precision
    chambers: tuple[tuple[Number, ...], ...] = ()

    def all(self) -> tuple[Number, ...]:
        """Return the numbers of every section."""
        return tuple(number for section in self.sections.values() for number in section)

    def value(self, key: str) -> float:
        """Return one number's value."""
        return next(number.value for number in self.all() if number.key == key)


def controller_numbers(
    study: ResolvedStudy, gains: Gains, feedforward: Feedforward, precision: Precision
) -> Numbers:
    """Return the numbers that the controller runs with, rounded to its arithmetic.

    Raises
    ------
    InputError
        If a number does not fit into single precision.
    """
    controller = study.study.controller
    signals, force = pack_signals(study.study.filtering), pack_force(study)
    law = discretise(pack_gains(gains), controller.sampling_period)._asdict()
    law["integral_rate"] = law.pop("integral")
    masses = study.uncertainty.mass
    ahead = pack_feedforward(feedforward, signals.sample_time, masses)._asdict()
    ahead.pop("sample_time")
    estimator = pack_estimator(study)._asdict()
    least, largest = force_limits(force)
    stop = ("velocity_tolerance", "stop_tolerance", "start_tolerance")
    filters = ("sample_time", "position_pole", "pressure_pole", "supply_pole", "backlash")
    sections: dict[str, dict[str, float]] = {
        "outer_loops": {
            "k_p_vel": gains.k_p_vel,
            **law,
            "dead_zone": signals.dead_zone,
            "force_least": least,
            "force_largest": largest,
        },
        "feedforward_lags": ahead,
        "state_estimator": {"estimator_mass": estimator.pop("mass"), **estimator},
        "filters": {key: getattr(signals, key) for key in filters},
        "stop_logic": {key: getattr(signals, key) for key in stop},
        "force_controller": force._asdict(),
        "accepted_inputs": _accepted(study),
    }
    rounded = {
        name: tuple(
            Number(key, _rounded(key, float(value), precision), *_MEANINGS[key])
            for key, value in values.items()
        )
        for name, values in sections.items()
    }
    return Numbers(rounded, signals.ticks, precision, tuple(_chambers(study, precision)))


def _chambers(study: ResolvedStudy, precision: Precision) -> Iterator[tuple[Number, ...]]:
    """Yield the numbers of each chamber."""
    chambers, hose = study.study.all_chambers, study.study.hose
    coefficient = pack_force(study).flow_coefficient / common_size(chambers)
    for one in chambers:
        volumes = volumes_of((one,), hose)
        values = {
            "area": volumes.area,
            "dead": volumes.dead,
            "hose": volumes.hose,
            "flow_coefficient": coefficient * one.valves,
            "pulls": float(one.side is Side.PULLING),
        }
        yield tuple(
            Number(key, _rounded(key, value, precision), *_OF_CHAMBERS[key])
            for key, value in values.items()
        )


def _accepted(study: ResolvedStudy) -> dict[str, float]:
    """Return the limits beyond which an input is taken for a broken sensor or caller."""
    stroke, supplies = study.study.cylinder.stroke, study.study.supplies
    period = study.study.controller.sampling_period
    travel = supplies.converter_travel if study.study.converters else 0.0
    return {
        "position_least": -0.1 * stroke,
        "position_largest": 1.1 * stroke,
        "pressure_least": -0.1 * supplies.relief_pressure,
        "pressure_largest": 3 * supplies.relief_pressure,
        "converter_largest": 1.1 * travel,
        "velocity_reference_largest": stroke / period,
        "acceleration_reference_largest": stroke / period**2,
    }


def _rounded(key: str, value: float, precision: Precision) -> float:
    if precision is Precision.DOUBLE:
        return value
    with np.errstate(over="ignore", under="ignore"):
        single = float(np.float32(value))
    if not np.isfinite(single) or (value != 0 and abs(single) < np.finfo(np.float32).tiny):
        fault = Fault(
            key, f"{value:g}", "does not fit into single precision", "use --precision double"
        )
        raise InputError("--precision", fault)
    return single
