"""Complex balls with a derivative: what a function of frequency does over a whole interval.

A ``Dual`` encloses an analytic function f of ω over |ω − c| ≤ r by three discs ::

    f(c)          within  error         of  value     (rounding alone)
    f(ω)          within  spread        of  value     for every ω of the interval
    df/dω (ω)     within  slope_spread  of  slope     for every ω of the interval

Every operation is an inclusion in floating point: beside the radii that follow from its operands
it adds ``ROUND`` times the size of its result. One rounding is at most 1.1e-16 of a result, a
complex product at most 2.5e-16, and the functions of the C library (sin, cos, sqrt) are taken to be
right within 4 units in the last place, 8.9e-16 at worst; ``ROUND`` = 1e-15 is above each of these,
and constants that carry a rounding of their own are given it twice. ``widened`` covers the
rounding of the radii. None of this may be compiled with fast-math.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from mptune.arrays import Complex, kernel

ROUND = 1e-15  # of the size of a result: what one operation in floating point may be off by


class Dual(NamedTuple):
    """A complex function of ω over an interval: see the module."""

    value: complex
    error: float
    spread: float
    slope: complex
    slope_spread: float


_UNDERFLOW = 1e-300


@kernel
def modulus(z: Complex) -> float:
    """Return |z| without the care for overflow that makes the library's slow."""
    return math.sqrt(z.real * z.real + z.imag * z.imag)


@kernel
def widened(radius: float) -> float:
    """Return a radius enlarged by what a dozen roundings on the way to it may have taken off.

    What an underflow takes off, some 1e-323 a time, is far below the least that is added.
    """
    return radius * (1 + 2 * ROUND) + _UNDERFLOW


@kernel
def constant(number: float) -> Dual:
    """Return a real constant, exact."""
    return Dual(complex(number, 0.0), 0.0, 0.0, complex(0.0, 0.0), 0.0)


@kernel
def plus(a: Dual, b: Dual) -> Dual:
    """Return a + b."""
    value, slope = a.value + b.value, a.slope + b.slope
    rounding = ROUND * modulus(value)
    return Dual(
        value,
        widened(a.error + b.error + rounding),
        widened(a.spread + b.spread + rounding),
        slope,
        widened(a.slope_spread + b.slope_spread + ROUND * modulus(slope)),
    )


@kernel
def scaled(a: Dual, factor: float) -> Dual:
    """Return a real multiple, whose factor may be off by one rounding itself."""
    size = abs(factor)
    rounding = 2 * ROUND * size
    return Dual(
        a.value * factor,
        widened(a.error * size + rounding * modulus(a.value)),
        widened(a.spread * size + rounding * modulus(a.value)),
        a.slope * factor,
        widened(a.slope_spread * size + rounding * modulus(a.slope)),
    )


@kernel
def times(a: Dual, b: Dual) -> Dual:
    """Return a·b."""
    size_a, size_b = modulus(a.value), modulus(b.value)
    slope_a, slope_b = modulus(a.slope), modulus(b.slope)
    rounding = ROUND * size_a * size_b
    slope_spread = (slope_a * b.spread + size_b * a.slope_spread + a.slope_spread * b.spread) + (
        slope_b * a.spread + size_a * b.slope_spread + b.slope_spread * a.spread
    )
    return Dual(
        a.value * b.value,
        widened(size_a * b.error + size_b * a.error + a.error * b.error + rounding),
        widened(size_a * b.spread + size_b * a.spread + a.spread * b.spread + rounding),
        a.slope * b.value + a.value * b.slope,
        widened(slope_spread + 2 * ROUND * (slope_a * size_b + size_a * slope_b)),
    )


@kernel
def conjugate(a: Dual) -> Dual:
    """Return the conjugate; its derivative by the real ω is the conjugate's."""
    return Dual(
        complex(a.value.real, -a.value.imag),
        a.error,
        a.spread,
        complex(a.slope.real, -a.slope.imag),
        a.slope_spread,
    )


@kernel
def squared_modulus(a: Dual) -> Dual:
    """Return |a|²."""
    size, slope = modulus(a.value), modulus(a.slope)
    rounding = 3 * ROUND * size * size
    slope_spread = slope * a.spread + size * a.slope_spread + a.spread * a.slope_spread
    return Dual(
        complex(a.value.real * a.value.real + a.value.imag * a.value.imag, 0.0),
        widened((2 * size + a.error) * a.error + rounding),
        widened((2 * size + a.spread) * a.spread + rounding),
        complex(2 * (a.value.real * a.slope.real + a.value.imag * a.slope.imag), 0.0),
        widened(2 * (slope_spread + 2 * ROUND * size * slope)),
    )


@kernel
def inverse(a: Dual, least: float) -> Dual:
    """Return 1/a, where |a| ≥ ``least`` > 0 is known to hold throughout the interval."""
    square = a.value.real * a.value.real + a.value.imag * a.value.imag
    value = complex(a.value.real / square, -a.value.imag / square)
    size = modulus(value)
    infimum = max(least, modulus(a.value) * (1 - 2 * ROUND) - a.spread)
    reach = widened(size * (a.spread / infimum) + 3 * ROUND * size)
    one = Dual(
        value,
        widened(size * a.error / max(least, modulus(a.value) - a.error) + 3 * ROUND * size),
        reach,
        complex(0.0, 0.0),
        0.0,
    )
    factor = times(one, one)
    slope = -a.slope * factor.value
    slope_spread = (
        modulus(a.slope) * factor.spread
        + modulus(factor.value) * a.slope_spread
        + a.slope_spread * factor.spread
        + 2 * ROUND * modulus(slope)
    )
    return Dual(value, one.error, reach, slope, widened(slope_spread))


@kernel
def turning(omega: float, half: float, time: float) -> Dual:
    """Return e^{−jωt} for ω within ``half`` of ``omega``."""
    phase = omega * time
    value = complex(math.cos(phase), -math.sin(phase))
    error = widened(ROUND * (2 + 2 * abs(phase)))
    spread = widened(min(2.0, abs(time) * half) + error)
    slope = complex(value.imag * time, -value.real * time)
    slope_spread = widened(abs(time) * spread + 2 * ROUND * abs(time))
    return Dual(value, error, spread, slope, slope_spread)


@kernel
def sinc(omega: float, half: float, time: float) -> Dual:
    """Return sin(ωt)/(ωt), t > 0, from |sinc| ≤ 1, |sinc'| ≤ 1/2 and |sinc''| ≤ 1/3."""
    x = omega * time
    square = x * x
    if square < 0.0625:  # the next term of either series is below 5e-16
        value = 1 - square / 6 * (
            1 - square / 20 * (1 - square / 42 * (1 - square / 72 * (1 - square / 110)))
        )
        slope = 1 - square / 10 * (1 - square / 28 * (1 - square / 54 * (1 - square / 88)))
        slope *= -x / 3
    else:
        value = math.sin(x) / x
        slope = (math.cos(x) - value) / x
    error = widened(ROUND * (4 + abs(x)))
    reach = time * half * (1 + 2 * ROUND)
    spread = widened(min((abs(slope) + 12 * ROUND + reach / 3) * reach, 2.0) + error)
    slope_spread = widened(time * (min(reach / 3, 1.0) + ROUND * (12 + abs(x))))
    return Dual(complex(value, 0.0), error, spread, complex(slope * time, 0.0), slope_spread)


@kernel
def polynomial(
    omega: float, half: float, c0: float, c1: float, c2: float, c3: float, c4: float, c5: float
) -> Dual:
    """Return Σ c_i (jω)^i, whose coefficients are not negative, ω − half may be.

    The k-th derivative over the interval is at most that of Σ c_i x^i at x = |ω| + half.
    """
    top = abs(omega) + half
    size = abs(omega)
    square = omega * omega
    value = complex(c0 - square * (c2 - square * c4), omega * (c1 - square * (c3 - square * c5)))
    slope = complex(-omega * (2 * c2 - 4 * c4 * square), c1 - square * (3 * c3 - 5 * c5 * square))
    terms = c0 + size * (c1 + size * (c2 + size * (c3 + size * (c4 + size * c5))))
    slopes = c1 + size * (2 * c2 + size * (3 * c3 + size * (4 * c4 + size * 5 * c5)))
    bends = 2 * c2 + top * (6 * c3 + top * (12 * c4 + top * 20 * c5))
    error = widened(3 * ROUND * terms)
    slope_spread = widened(bends * half + 3 * ROUND * slopes)
    spread = widened((modulus(slope) + slope_spread) * half + error)
    return Dual(value, error, spread, slope, slope_spread)
