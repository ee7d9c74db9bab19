"""The convex core of a study: starts for the polish, and a proof of where none can be found.

At a fixed τ and K_P,vel the position controller of Eq. 22 is linear in its parameters. Eq. 21, M_S,
M_T and the noise gain are then convex once their right-hand sides are linearised at the last
iterate; so is the sampled loop's M_S, since Tustin's approximation is Eq. 22 at the frequency
(2/T_S) tan(ωT_S/2). What is not convex, tracking in time and the gain margin, is left to the
polish: tracking is stood in for by the largest |S| weighted by the reference's spectrum.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import kernel
from mptune.loops.broken import position_path, velocity_path
from mptune.loops.family import nominal_plants
from mptune.loops.sampled import coefficient_count, measured_parts, sampled_plant
from mptune.loops.stability import count_unstable_poles
from mptune.loops.velocity import plant_at, true_velocity
from mptune.params.packed import LoopGains
from mptune.robust.condition import nominal_loops
from mptune.robust.grid import frequency_range
from mptune.robust.sweep import CONVERGED
from mptune.robust.verdict import allowed_ratio
from mptune.shape.problem import (
    Function,
    Linear,
    Loops,
    Maximise,
    Norm,
    Peak,
    Problem,
    WeightedSensitivity,
)
from mptune.shape.shaping import Shaped, shape_loop
from mptune.shape.structure import Structure, position, position_gains, position_parameters
from mptune.signals.conditioning import filter_response
from mptune.signals.differentiator import differentiator_over_s
from mptune.sim.moves import distinct_moves
from mptune.tune.position_limits import damping_limits, frequency_limits

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.params.packed import MeasurementPath, Plants
    from mptune.robust.model import LinearModel
    from mptune.shape.problem import Between, Requirement

_POINTS = 250
_NOISE_POINTS = 400
_LOWEST_NOISE = 10.0  # rad/s: below it noise is the reference's matter, not the noise gain's
_BELOW_NYQUIST = 0.98  # of half the sampling rate: Tustin's frequency goes to infinity there
_MOVE_SAMPLES = 400
NOMINAL, TRUE, SAMPLED = "nominal", "true", "sampled"


@dataclass(frozen=True)
class Core:
    """The convex core at one velocity gain.

    Attributes
    ----------
    model
        The study's linear model.
    gains
        The velocity gain, and gains to start from.
    rows
        The plants of the family that M_S, M_T and the sampled loop are asked of.
    limits
        Bounds of single gains by name, in SI.
    """

    model: LinearModel
    gains: LoopGains
    rows: IntArray
    limits: dict[str, tuple[float, float]]

    def shaped(self, tau: float, kind: str) -> tuple[Shaped, LoopGains]:
        """Return the outcome at one τ [s] for one kind of objective, and its gains."""
        problem = self.problem(tau, kind)
        gains = self.gains
        start = position_parameters(gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi)
        found = shape_loop(problem, start)
        return found, self._gains_at(tau, found.parameters)

    def problem(self, tau: float, kind: str) -> Problem:
        """Return the loop-shaping problem at one τ [s]."""
        structure = position(tau)
        model = self.model
        low, high = frequency_range(model.plants, model.nominal, self.gains)
        omega = np.geomspace(low, high, _POINTS)
        loops = {
            NOMINAL: _loops(omega, partial(_nominal, model, self.gains), 1),
            TRUE: _loops(omega, partial(_true, model, self.gains, self.rows), len(self.rows)),
        }
        if model.requirements.sampled_sensitivity_peak is not None:
            bent = np.geomspace(low, _bent(_BELOW_NYQUIST * np.pi / model.period, model), _POINTS)
            sampled = partial(_sampled, model, self.gains, self.rows)
            loops[SAMPLED] = _loops(bent, sampled, len(self.rows))
        bounds = self._bounds(structure)
        return Problem(
            structure=structure,
            loops=loops,
            objective=self._objective(structure, kind),
            requirements=(*self._requirements(omega), *bounds),
            stable=partial(self._stable, tau),
        )

    def _requirements(self, omega: FloatArray) -> list[Peak | Norm]:
        asked, model = self.model.requirements, self.model
        left = self.model.sides(omega, self.gains).left[1]

        def largest(at: FloatArray) -> FloatArray:
            error = np.exp(np.interp(np.log(at), np.log(omega), np.log(left)))
            allowed = allowed_ratio(asked.position_ratio, at) * (1 - 5 * CONVERGED)
            return np.asarray(allowed / error)

        found: list[Peak | Norm] = [
            Peak("position_ratio", Function.COMPLEMENTARY, largest, NOMINAL)
        ]
        for name, function, limit, loops in (
            ("sensitivity_peak", Function.SENSITIVITY, asked.sensitivity_peak, TRUE),
            ("complementary_peak", Function.COMPLEMENTARY, asked.complementary_peak, TRUE),
            (
                "sampled_sensitivity_peak",
                Function.SENSITIVITY,
                asked.sampled_sensitivity_peak,
                SAMPLED,
            ),
        ):
            if limit is not None:
                found.append(Peak(name, function, limit, loops))
        if asked.noise_gain is not None:
            found.append(_noise(model, self.gains.k_p_vel, asked.noise_gain))
        return found

    def _bounds(self, structure: Structure) -> list[Requirement]:
        found: list[Requirement] = []
        for name, place in (("k_p_pos", 0), ("k_i_pos", 3)):
            low, high = self.limits[name]
            unit = np.eye(len(structure.names))[place]
            found += [Linear(f"{name} ≤", unit, high), Linear(f"{name} ≥", -unit, -low)]
        found += frequency_limits(*self.limits["omega"])
        found += damping_limits(*self.limits["xi"], self.gains.omega)
        return found

    def _objective(self, structure: Structure, kind: str) -> Maximise | WeightedSensitivity:
        if kind == "tracking":
            return WeightedSensitivity(partial(_spectrum, self.model), TRUE)
        place = 0 if kind == "bandwidth" else 3
        return Maximise(np.eye(len(structure.names))[place])

    def _gains_at(self, tau: float, x: FloatArray) -> LoopGains:
        if x[0] <= 0 or x[2] <= 0:
            return self.gains._replace(tau=tau)
        k_p, k_i, omega, xi = position_gains(x)
        return LoopGains(self.gains.k_p_vel, k_p, k_i, omega, xi, tau)

    def _stable(self, tau: float, x: FloatArray) -> bool:
        if x[0] <= 0 or x[2] <= 0:
            return False
        model, gains = self.model, self._gains_at(tau, x)
        for plants in (nominal_plants(model.nominal), model.plants.picked(self.rows)):
            loops = model.loops(gains, plants=plants)
            if not count_unstable_poles(loops).stable.all():
                return False
        return True


def _loops(omega: FloatArray, between: Between, count: int) -> Loops:
    plant, fixed = between(omega, np.arange(count))
    return Loops(omega, plant, fixed, between)


def _nominal(
    model: LinearModel, gains: LoopGains, omega: FloatArray, rows: IntArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the nominal position loop over G_P, and its part without G_P: none."""
    # With ω = ξ = τ = 1 and no I-term Eq. 22 is 1: what is left is the plant.
    one = gains._replace(k_p_pos=1.0, k_i_pos=0.0, omega=1.0, xi=1.0, tau=1.0)
    plant = np.tile(nominal_loops(omega, model.nominal, one, model.path)[1], (len(rows), 1))
    return plant, np.zeros_like(plant)


def _true(
    model: LinearModel, gains: LoopGains, every: IntArray, omega: FloatArray, rows: IntArray
) -> tuple[ComplexArray, ComplexArray]:
    plants = model.plants.picked(every[rows])
    parts = _force_parts(omega, plants, gains.k_p_vel, model.path)
    return parts[0], parts[1]


@kernel
def _force_parts(
    omega: FloatArray, plants: Plants, k_p_vel: float, path: MeasurementPath
) -> ComplexArray:
    """Return the loops broken at F_ref: over G_P, and the part without it, ``(2, N, F)``."""
    parts = np.empty((2, len(plants.mass), len(omega)), np.complex128)
    for f in range(len(omega)):
        s = 1j * omega[f]
        position, velocity = position_path(s, path) / s, velocity_path(s, path)
        for n in range(len(plants.mass)):
            plant = k_p_vel * true_velocity(s, plant_at(plants, n))
            parts[0, n, f], parts[1, n, f] = plant * position, plant * velocity
    return parts


def _sampled(
    model: LinearModel, gains: LoopGains, every: IntArray, omega: FloatArray, rows: IntArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the sampled loops over G_P at Tustin's frequencies, and their parts without it."""
    plants, where = model.explicit.picked(every[rows]), (model.filters, model.period)
    parts = _sampled_parts(omega, plants, gains.k_p_vel, *where)
    return parts[0], parts[1]


@kernel
def _sampled_parts(
    omega: FloatArray, plants: Plants, k_p_vel: float, path: MeasurementPath, period: float
) -> ComplexArray:
    parts = np.empty((2, len(plants.mass), len(omega)), np.complex128)
    hold = period / 2
    count = coefficient_count(plants.delay.max(), path, period)
    for n in range(len(plants.mass)):
        plant = sampled_plant(plant_at(plants, n), path, period, count)
        for f in range(len(omega)):
            true = np.arctan(omega[f] * hold) / hold  # where Tustin puts this frequency
            position, velocity = measured_parts(1j * true, plant, period)
            parts[0, n, f], parts[1, n, f] = k_p_vel * position, k_p_vel * velocity
    return parts


def _bent(omega: float, model: LinearModel) -> float:
    """Return the frequency of Eq. 22 that Tustin's approximation puts at ω [rad/s]."""
    return float(2 / model.period * np.tan(omega * model.period / 2))


def _spectrum(model: LinearModel, omega: FloatArray) -> FloatArray:
    """Return the size of the references' spectrum, largest over the moves and above each ω."""
    sizes = []
    for move in distinct_moves(model.study.study.manoeuvre):
        time = np.linspace(0, move.duration, _MOVE_SAMPLES + 1)
        steps = np.diff(move.sampled(_MOVE_SAMPLES))
        waves = np.exp(-1j * omega[:, None] * 0.5 * (time[1:] + time[:-1]))
        sizes.append(np.abs(waves @ steps) / omega)
    largest = np.max(sizes, axis=0)
    order = np.argsort(omega)[::-1]
    largest[order] = np.maximum.accumulate(largest[order])  # its zeros are no places to rest in
    return np.asarray(largest / largest.max())


def _noise(model: LinearModel, k_p_vel: float, limit: float) -> Norm:
    """Return the noise gain's bound, see ``mptune.loops.noise``; here with the integral term."""
    path = model.filters
    half_rate = np.pi / path.sample_time
    omega = np.geomspace(_LOWEST_NOISE, half_rate, _NOISE_POINTS)
    s = 1j * omega
    through = k_p_vel * filter_response(s, path.sample_time, path.filter_pole)
    velocity = s * differentiator_over_s(s, path.sample_time)
    weight = np.gradient(omega) / half_rate
    return Norm("noise_gain", omega, velocity * through, through, weight, limit)
