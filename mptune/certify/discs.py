"""Complex discs over a box of plants: a value at the centre, and how far from it the box may lead.

A value at the centre is off by rounding alone (``error``); whatever varies over the box is a disc
about its value at the centre (``spread``). 1/(1 + jx) moves by |x − x'|/(|1 + jx||1 + jx'|),
e^{−jx} by at most |x − x'| and by at most 2. Rounding is taken care of as in
``mptune.certify.balls``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from mptune.arrays import Complex, Real, kernel
from mptune.certify.balls import ROUND, Dual, modulus, widened


class Disc(NamedTuple):
    """A value at the centre, its rounding, and how far from it the box may lead."""

    value: complex
    error: float
    spread: float


@kernel
def product(a: Disc, b: Disc) -> Disc:
    """Return a·b."""
    size_a, size_b = modulus(a.value), modulus(b.value)
    rounding = ROUND * size_a * size_b
    return Disc(
        a.value * b.value,
        widened(size_a * b.error + size_b * a.error + a.error * b.error + rounding),
        widened(size_a * b.spread + size_b * a.spread + a.spread * b.spread + rounding),
    )


@kernel
def turning_disc(phase: float, reach: float) -> Disc:
    """Return e^{−jx} for x within ``reach`` of a phase that has seen two roundings."""
    error = widened(ROUND * (2 + 2 * abs(phase)))
    return Disc(complex(math.cos(phase), -math.sin(phase)), error, widened(min(2.0, reach) + error))


@kernel
def lag(omega: float, tau: float, half_omega: float, half_tau: float) -> Disc:
    """Return 1/(1 + jωτ)."""
    x = omega * tau
    reach = widened(abs(omega) * half_tau + tau * half_omega + half_omega * half_tau)
    square = 1 + x * x
    near = max(abs(x) - reach, 0.0)
    size = 1 / math.sqrt(square)
    error = widened(5 * ROUND * size)
    spread = widened(min(1.0, reach * size / math.sqrt(1 + near * near)) + error)
    return Disc(complex(1 / square, -x / square), error, spread)


@kernel
def total(a: Disc, b: Disc) -> Disc:
    """Return a + b."""
    value = a.value + b.value
    rounding = ROUND * modulus(value)
    return Disc(
        value, widened(a.error + b.error + rounding), widened(a.spread + b.spread + rounding)
    )


@kernel
def multiple(a: Disc, factor: float, half: float) -> Disc:
    """Return a real multiple, by a factor that may be ``half`` more or less over the box."""
    size = abs(factor)
    rounding = 2 * ROUND * size * modulus(a.value)
    spread = a.spread * size + half * (modulus(a.value) + a.spread)
    return Disc(a.value * factor, widened(a.error * size + rounding), widened(spread + rounding))


@kernel
def disc_of(a: Dual) -> Disc:
    """Return a function of ω, its derivative left out."""
    return Disc(a.value, a.error, a.spread)


@kernel
def slope_of(a: Dual) -> Disc:
    """Return a function's derivative by ω."""
    return Disc(a.slope, a.slope_spread, a.slope_spread)


@kernel
def lagging(a: Disc) -> Disc:
    """Return −ja."""
    return Disc(complex(a.value.imag, -a.value.real), a.error, a.spread)


@kernel
def twice_real(product: Disc, factor: float, half: float) -> tuple[float, float]:
    """Return twice the real part of a multiple, and how far from it the box may lead."""
    found = multiple(product, factor, half)
    return 2 * found.value.real, 2 * found.spread


@kernel
def along(a: Disc, unit: Complex) -> Real:
    """Return how large the part of a disc along a direction may be."""
    part = abs(a.value.real * unit.real - a.value.imag * unit.imag)
    return (part + a.spread + 4 * ROUND * modulus(a.value)) * (1 + 4 * ROUND)
