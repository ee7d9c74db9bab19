"""The loop around a state estimator, and the bounds that make its encirclement count certain.

With ``mptune.signals.estimator``'s responses the loop gain at F_ref is ::

    L = K_P,vel G_F e^{−sd} [ v̂/F + G_P x̂/F + (v̂/x + G_P x̂/x)/(m s²) ]

The mass stands in one term only, which is why an estimator that believes in the least mass keeps
the gain at high frequency whatever the mass is. The estimator runs at T_S,fast and repeats itself
with that rate, as a continuous loop does not: the loop is taken up to half that rate. What lies
above is folded back by sampling; ``mptune.loops.sampled`` counts it, and here it is left out.

Bounds: |ŝ| = (2/T) sin(ωT/2) rises up to half the rate, and every pole z_i of the error has
|1 − z_i w| ≥ |ŝ|T − |1 − z_i|, so that beyond |1 − z_i| every response is below a falling one.
"""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import Complex, kernel
from mptune.loops.position import position_controller
from mptune.signals.estimator import heard

if TYPE_CHECKING:
    from mptune.params.packed import LoopGains, MeasurementPath

LEVEL = 0.5  # of |L|, beyond the tail
_BISECTIONS = 60
_ROUNDED = 1 + 1e-9  # more than all roundings of these formulas


@kernel
def estimated_loop(
    s: Complex,
    velocity: Complex,
    mass: float,
    gains: LoopGains,
    path: MeasurementPath,
    share: float,
) -> Complex:
    """Return the loop gain at F_ref around a state estimator.

    Parameters
    ----------
    s
        Complex frequency [rad/s].
    velocity
        G_vel(s) of Eq. 15, force reference to velocity.
    mass
        m [kg].
    gains, path
        The gains, and the estimator.
    share
        How much of the position controller is switched on: 1, or 0 for the velocity gain alone.
    """
    known = heard(s, path)
    controller = share * position_controller(
        s, gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi, gains.tau
    )
    of_force = known.speed_of_force + controller * known.place_of_force
    of_place = known.speed_of_place + controller * known.place_of_place
    return gains.k_p_vel * velocity * (of_force * mass * s + of_place / s)


@kernel
def estimated_terms(
    omega: float, mass: float, gains: LoopGains, path: MeasurementPath, share: float
) -> float:
    """Return the sum of the moduli of the loop's terms over |G_F|, at ω up to half the fast rate.

    Terms are products of powers of s, ŝ and w, of 1/Δ and of the lags of Eq. 22; (1 + w)/2 is two.
    """
    time = path.sample_time
    size = 2 / time * math.sin(0.5 * omega * time)  # |ŝ|
    late = np.exp(-1j * omega * time)
    slope = (1 - late) / time
    first, second, third = path.l_1 / time, path.l_2 / time, path.l_3 / time
    below = slope**3 + first * late * slope * slope + second * late * slope
    below += third * late * (1 + late) / 2
    ratio = omega / gains.omega
    shape = (ratio * ratio + 2 * gains.xi * ratio + 1) / (1 + (gains.tau * omega) ** 2)
    controller = share * (gains.k_p_pos * shape + gains.k_i_pos / omega)
    found: float = gains.k_p_vel * _moduli(size, controller, omega, mass, path) / abs(below)
    return found


@kernel
def _moduli(
    size: float, controller: float, omega: float, mass: float, path: MeasurementPath
) -> float:
    """Return the terms' moduli times |Δ|, over K_P,vel, from |ŝ| and a bound of |G_P|."""
    time = path.sample_time
    first, second, third = path.l_1 / time, path.l_2 / time, path.l_3 / time
    of_force = size * (size + first + time * second / 2) + controller * size
    of_place = size * (second * size + third)
    of_place += controller * (first * size * size + second * size + third)
    return of_force / path.estimator_mass + of_place / (mass * omega * omega)


def slowest_error(path: MeasurementPath) -> tuple[float, float]:
    """Return max |1 − z_i|/T over the error's poles [1/s], and Σ T|z_i|/(1 − |z_i|) [s].

    The second bounds |d ln Δ/dω|.
    """
    time = path.sample_time
    angle = time / path.filter_time  # ω_o T
    poles = [math.exp(-angle), cmath.exp(angle * cmath.exp(2j * math.pi / 3))]
    far = max(abs(1 - pole) for pole in poles) / time
    shares = [abs(pole) / (1 - abs(pole)) for pole in poles]
    return _ROUNDED * far, _ROUNDED * time * (shares[0] + 2 * shares[1])


def falling_bound(omega: float, mass: float, gains: LoopGains, path: MeasurementPath) -> float:
    """Return what |L| is at most from ω [rad/s] up to half the fast rate; infinite if unknown."""
    time = path.sample_time
    size = 2 / time * math.sin(min(0.5 * omega * time, 0.5 * math.pi))
    distance = size - slowest_error(path)[0]
    if distance <= 0:
        return math.inf
    corner = gains.omega * gains.tau
    shape = 1 / corner**2 + gains.xi / corner + 1  # bounds |G_P|/K_P,pos without its I-term
    controller = gains.k_p_pos * shape + gains.k_i_pos / omega
    found = gains.k_p_vel * _moduli(size, controller, omega, mass, path) / distance**3
    return _ROUNDED * float(found)


def half_rate(path: MeasurementPath) -> float:
    """Return half the fast rate [rad/s]: up to there the loop is taken."""
    return math.pi / path.sample_time


def tail_of(mass: float, gains: LoopGains, path: MeasurementPath, level: float = LEVEL) -> float:
    """Return a frequency beyond which |L| is at most ``level``; infinite where there is none.

    Parameters
    ----------
    mass
        The least mass asked about [kg]: more of it makes less of the loop.
    gains, path
        The gains, and the estimator.
    level
        The level.
    """
    low, high = 1e-3, half_rate(path)
    if falling_bound(high, mass, gains, path) > level:
        return math.inf
    for _ in range(_BISECTIONS):
        middle = math.sqrt(low * high)
        if falling_bound(middle, mass, gains, path) <= level:
            high = middle
        else:
            low = middle
    return high
