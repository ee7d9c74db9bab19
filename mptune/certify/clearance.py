"""How far 1 + L, or any figure's denominator, keeps from zero over a box, at every gain at once.

The centred form of F knows that |d|² is small near a zero, not on which side of it: here the
denominator itself is followed along the direction in which it stands.
"""

from __future__ import annotations

import math

from mptune.arrays import Complex, FloatArray, Real, kernel
from mptune.certify.balls import ROUND, Dual, modulus, widened
from mptune.certify.discs import (
    Disc,
    along,
    disc_of,
    lagging,
    multiple,
    product,
    slope_of,
    total,
    turning_disc,
)
from mptune.certify.enclosure import DELAY, GAIN, OMEGA, PHASE, RATIO, TAU_A, TAU_B, PlantDiscs
from mptune.certify.rows import D_0, D_1, stored


@kernel
def clearance(
    plant: PlantDiscs, row: FloatArray, terms: int, centre: FloatArray, half: FloatArray
) -> Real:
    """Return what the denominator's modulus is at least over a box, or a number below zero.

    With θ the argument of d at the centre, |d| ≥ Re(e^{−jθ}d), whose mean value form knows how
    the denominator moves relative to where it stands: nothing but that part can bring it to zero.
    An extra gain g moves d along a line, d_0 + g d_1 Y: at the centre the nearest point of its
    piece gives θ, and as Re(e^{−jθ}d) is linear in g, the least of it lies at either end.
    """
    omega, delay = centre[OMEGA], centre[DELAY]
    first, second = stored(row, terms + D_0), stored(row, terms + D_1)
    reach = abs(omega) * half[DELAY] + (delay + half[DELAY]) * half[OMEGA] + half[PHASE]
    turn = turning_disc(omega * delay + centre[PHASE], widened(reach))
    weight = product(disc_of(second), turn)  # d_1 e^{−j(ωd + φ)}
    own = slope_of(first)
    lowest = math.exp(centre[GAIN] - half[GAIN]) * (1 - 4 * ROUND)
    highest = math.exp(centre[GAIN] + half[GAIN]) * (1 + 4 * ROUND)
    if centre[GAIN] == 0 and half[GAIN] == 0:
        lowest = highest = 1.0
    moved = weight.value * plant.whole.value
    nearest = highest
    square = moved.real * moved.real + moved.imag * moved.imag
    if square > 0:
        nearest = -(moved.real * first.value.real + moved.imag * first.value.imag) / square
        nearest = min(max(nearest, lowest), highest)
    towards = first.value + nearest * moved
    size = modulus(towards)
    if size == 0:
        return -1.0
    unit = complex(towards.real / size, -towards.imag / size)
    slope = product(slope_of(second), turn)
    least = _least_along(unit, lowest, first, own, weight, slope, plant, centre, half)
    if highest > lowest:
        least = min(
            least, _least_along(unit, highest, first, own, weight, slope, plant, centre, half)
        )
    return least


@kernel
def _least_along(
    unit: Complex,
    gain: float,
    first: Dual,
    own: Disc,
    weight: Disc,
    slope: Disc,
    plant: PlantDiscs,
    centre: FloatArray,
    half: FloatArray,
) -> Real:
    """Return what d_0 + g d_1 Y is at least along a direction, by its mean value form.

    ``own``, ``weight`` and ``slope`` are ∂d_0/∂ω, d_1 e^{−j(ωd + φ)} and the same of ∂d_1/∂ω.
    """
    whole = plant.whole
    turned = product(weight, whole)
    ahead = lagging(turned)
    far = first.value + gain * turned.value
    least = far.real * unit.real - far.imag * unit.imag
    least -= first.error + gain * turned.error
    least -= 8 * ROUND * (modulus(first.value) + gain * modulus(turned.value))
    by_omega = total(product(weight, plant.by_omega), product(slope, whole))
    by_omega = total(by_omega, multiple(ahead, centre[DELAY], half[DELAY]))
    by_omega = total(own, multiple(by_omega, gain, 0.0))
    by_delay = total(product(weight, plant.by_delay), multiple(ahead, centre[OMEGA], half[OMEGA]))
    least -= along(by_omega, unit) * half[OMEGA]
    moves = along(product(weight, plant.by_ratio), unit) * half[RATIO]
    moves += along(by_delay, unit) * half[DELAY]
    moves += along(product(weight, plant.by_tau_a), unit) * half[TAU_A]
    moves += along(product(weight, plant.by_tau_b), unit) * half[TAU_B]
    moves += along(ahead, unit) * half[PHASE]
    least -= gain * moves * (1 + 4 * ROUND)
    return least - 8 * ROUND * modulus(far)
