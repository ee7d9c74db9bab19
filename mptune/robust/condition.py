"""Eq. 17 and Eq. 21: one robust-stability condition, two loops.

Left side: the largest multiplicative error over the family. Right side: |(1 + L_N)/L_N| of the
nominal loop. Their ratio is at most 1 where the condition holds; its inverse is the margin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import ComplexArray, FloatArray, IntArray, kernel
from mptune.loops.broken import position_loop, velocity_loop
from mptune.loops.force_dynamics import force_dynamics
from mptune.loops.position import position_error
from mptune.loops.velocity import error_of_factors, nominal_velocity
from mptune.summary import tuple_text

if TYPE_CHECKING:
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant, Plants
    from mptune.robust.measured import Members


class Sides(NamedTuple):
    """Both sides of Eq. 17 (row 0) and Eq. 21 (row 1) over a family.

    The N plants are those of the box, followed by the measured members where there are any.
    """

    left: FloatArray  # (2, F) envelope max |Δ| over the plants
    plant: IntArray  # (2, F) the plant behind each value of the envelope
    right: FloatArray  # (2, F) |(1 + L_N)/L_N|
    plant_ratio: FloatArray  # (2, N) largest left/right ratio of each plant
    plant_frequency: IntArray  # (2, N) the frequency behind it

    @property
    def ratio(self) -> FloatArray:
        """``(2, F)``: left over right."""
        return np.asarray(self.left / self.right)

    def __repr__(self) -> str:
        """Return shape and range of each field."""
        return tuple_text(self)


@kernel
def nominal_loops(
    omega: FloatArray, nominal: NominalPlant, gains: LoopGains, path: MeasurementPath
) -> ComplexArray:
    """Return the nominal loop gains at jω, ``(2, F)``: velocity loop, position loop."""
    loops = np.empty((2, len(omega)), np.complex128)
    for f in range(len(omega)):
        s = 1j * omega[f]
        velocity = nominal_velocity(s, nominal)
        loops[0, f] = velocity_loop(s, velocity, gains.k_p_vel, path)
        loops[1, f] = position_loop(s, velocity, gains, path)
    return loops


def sides(
    omega: FloatArray, loops: FamilyLoops, nominal: NominalPlant, members: Members | None = None
) -> Sides:
    """Return both sides of Eq. 17 and Eq. 21 at the frequencies ``omega``, ``(F,)`` [rad/s].

    Measured ``members`` raise the left side within their bands; where they stand instead of the
    box's plants those are left out.
    """
    gain = nominal_loops(omega, nominal, loops.gains, loops.path)
    with np.errstate(divide="ignore"):  # a loop without gain has an infinite right-hand side
        right = np.abs(1 + gain) / np.abs(gain)  # Eq. 17 and Eq. 21
    factors = _factors(loops.plants, nominal)
    if members is None:
        left, plant, ratio, frequency = _family_errors(
            omega, factors, nominal.delay, gain[0], 1 / right
        )
        return Sides(np.sqrt(left), plant, right, np.sqrt(ratio), frequency)
    asked = np.flatnonzero(~members.replaces(omega))
    weight = np.ascontiguousarray(1 / right[:, asked])
    found = _family_errors(omega[asked], factors, nominal.delay, gain[0, asked], weight)
    return _with_members(found, asked, members.errors(omega, nominal, gain[0]), right)


def _with_members(
    found: tuple[FloatArray, IntArray, FloatArray, IntArray],
    asked: IntArray,
    errors: FloatArray,
    right: FloatArray,
) -> Sides:
    """Return the sides of a family with measured members.

    ``found`` is what the kernel found at the frequencies ``asked``; ``errors`` ``(2, M, F)`` are
    the members'.
    """
    count = found[2].shape[1]
    left, plant = errors.max(axis=1), count + errors.argmax(axis=1)
    of_box = np.zeros_like(left)
    of_box[:, asked] = np.sqrt(found[0])
    behind = np.zeros_like(plant)
    behind[:, asked] = found[1]
    ratios = errors / right[:, None, :]
    at = asked[found[3]] if len(asked) else found[3]
    return Sides(
        left=np.maximum(left, of_box),
        plant=np.where(left > of_box, plant, behind),
        right=right,
        plant_ratio=np.concatenate([np.sqrt(found[2]), ratios.max(axis=2)], axis=1),
        plant_frequency=np.concatenate([at, ratios.argmax(axis=2)], axis=1),
    )


class _Factors(NamedTuple):
    """A family as the few different values that its plants are made of."""

    delay: FloatArray  # (D,) s, different delays
    lags: FloatArray  # (3, P) different τ_A [s], τ_B [s] and A_A/(A_A + A_B)
    mass_ratio: FloatArray  # (N,) m_min/m
    which_delay: IntArray  # (N,)
    which_lags: IntArray  # (N,)


def _factors(plants: Plants, nominal: NominalPlant) -> _Factors:
    """Return the family's different delays and lags, so that each is evaluated once."""
    delay, which_delay = np.unique(plants.delay, return_inverse=True)
    lags = np.stack([plants.tau_a, plants.tau_b, plants.share_a])
    lags, which_lags = np.unique(lags, axis=1, return_inverse=True)
    mass_ratio = nominal.mass / plants.mass
    return _Factors(delay, np.ascontiguousarray(lags), mass_ratio, which_delay, which_lags.ravel())


@kernel
def _family_errors(
    omega: FloatArray,
    factors: _Factors,
    nominal_delay: float,
    nominal_velocity_loop: ComplexArray,
    weight: FloatArray,
) -> tuple[FloatArray, IntArray, FloatArray, IntArray]:
    """Return the squared envelopes of |Δ_vel| and |Δ_pos| and each plant's worst ratio, squared.

    One thread: the loop is so short that sharing it out costs more than it saves.

    Parameters
    ----------
    omega
        ``(F,)`` frequencies [rad/s].
    factors, nominal_delay
        The family, and the nominal delay [s].
    nominal_velocity_loop
        ``(F,)`` loop gain of the nominal velocity loop.
    weight
        ``(2, F)`` inverse of the right-hand sides.

    Returns
    -------
    tuple
        Envelopes ``(2, F)``, plants behind them ``(2, F)``; worst ratios ``(2, N)`` and the
        frequencies behind them ``(2, N)``.
    """
    points, count = len(omega), len(factors.mass_ratio)
    left = np.zeros((2, points))
    plant = np.zeros((2, points), np.int64)
    ratio = np.zeros((2, count))
    frequency = np.zeros((2, count), np.int64)
    lag = np.empty(len(factors.delay), np.complex128)
    force = np.empty(factors.lags.shape[1], np.complex128)
    for f in range(points):
        s = 1j * omega[f]
        for i in range(len(lag)):
            lag[i] = np.exp(-s * (factors.delay[i] - nominal_delay))
        for i in range(len(force)):
            lags = factors.lags
            force[i] = force_dynamics(s, lags[0, i], lags[1, i], lags[2, i])
        for n in range(count):
            fast, late = force[factors.which_lags[n]], lag[factors.which_delay[n]]
            velocity = error_of_factors(fast, late, factors.mass_ratio[n])
            position = position_error(velocity, nominal_velocity_loop[f])
            for loop in range(2):
                error = velocity if loop == 0 else position
                size = error.real**2 + error.imag**2
                if size > left[loop, f]:
                    left[loop, f] = size
                    plant[loop, f] = n
                size *= weight[loop, f] ** 2
                if size > ratio[loop, n]:
                    ratio[loop, n] = size
                    frequency[loop, n] = f
    return left, plant, ratio, frequency
