"""From study objects to the bare tuples that kernels take: the only bridge between them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.controller import Controller, Gains
    from mptune.params.study import ResolvedStudy


class Plants(NamedTuple):
    """A family of plants: Eq. 15's parameters, each ``(N,)``, in SI."""

    mass: FloatArray  # kg, m
    delay: FloatArray  # s, T_S/2 + d
    tau_a: FloatArray  # s, τ_A
    tau_b: FloatArray  # s, τ_B


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


NO_PATH = MeasurementPath(0.0, 0.0, 0.0)


def pack_gains(gains: Gains) -> LoopGains:
    """Return the gains as a kernel tuple."""
    return LoopGains(gains.k_p_vel, gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi, gains.tau)


def pack_filters(controller: Controller) -> MeasurementPath:
    """Return the controller's measurement path as a kernel tuple."""
    sample_time = controller.fast_sampling_period
    pole = math.exp(-sample_time / controller.position_filter)
    return MeasurementPath(sample_time, pole, controller.position_filter)


def pack_path(study: ResolvedStudy) -> MeasurementPath:
    """Return the measurement path that the study's linear model includes."""
    if study.study.model.measurement_path == "none":
        return NO_PATH
    return pack_filters(study.study.controller)


def pack_nominal(study: ResolvedStudy) -> NominalPlant:
    """Return the nominal plant as a kernel tuple."""
    return NominalPlant(study.uncertainty.nominal_mass, study.uncertainty.nominal_delay)
