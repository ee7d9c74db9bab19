"""The coefficients of the loop at F_ref around a state estimator: continuous, and as it runs.

With κ = m_N/m̂ and ``mptune.signals.estimator``'s ŝ, w, λ_i and Δ, u = ŝ/s and P = s m_N/K_P,vel,
the loop gain times s²R P, over what ``mptune.certify.figures`` divides s²R and Q by, is ::

    G_F e^{−sd} (f + μ x)/Δ
    f = κ w s [ s²R ŝ (ŝ + λ_1 w − T λ_2/2) + s Q (1 − l_1) ŝ (1 + w)/2 ]
    x = w [ s²R u (λ_2 ŝ + λ_3 w) + Q (λ_1 ŝ² + λ_2 w ŝ + λ_3 w (1 + w)/2) ]

The mass stands with x alone: one product more than other loops have, and still no division by what
varies over the box. As it runs, each alias ω_k has such a pair, held and folded: with the share
ω/ω_k, jω in the place of the first s of f, and Q for what Tustin makes of it (``aliases``), f takes
one power of the share, x two and its Q one more. There 1/Δ is an enclosure, with |Δ| at least the
product of the poles' distances from the circle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from mptune.arrays import FloatArray, kernel
from mptune.certify.balls import (
    Dual,
    constant,
    inverse,
    plus,
    polynomial,
    scaled,
    sinc,
    times,
    turning,
)
from mptune.certify.rows import FIXED, store
from mptune.certify.shares import share_of

if TYPE_CHECKING:
    from mptune.certify.form import Form
    from mptune.params.packed import MeasurementPath

_CARE = 0.9  # the poles are where they were placed but for rounding


class Responses(NamedTuple):
    """The estimator's responses times Δ, the median left out: see ``mptune.signals.estimator``."""

    late: Dual  # w
    over_s: Dual  # u = ŝ/s
    speed_of_force: Dual  # m̂ v̂/F Δ
    place_of_force: Dual  # m̂ x̂/F Δ
    speed_of_place: Dual  # v̂/x Δ/ŝ
    place_of_place: Dual  # x̂/x Δ
    below: Dual  # Δ
    ahead: Dual  # m̂ v̂/F Δ/ŝ


@kernel
def responses(path: MeasurementPath, omega: float, half: float, folded: int) -> Responses:
    """Return the responses about a frequency; ``folded`` above 0 where it is an alias [rad/s]."""
    time = path.sample_time
    first, second, third = path.l_1 / time, path.l_2 / time, path.l_3 / time
    late = turning(omega, half, time)
    over = times(turning(omega, half, 0.5 * time), sinc(omega, half, 0.5 * time))
    slope = scaled(plus(constant(1.0), scaled(late, -1.0)), 1 / time)
    if folded == 0:  # no digits lost at low frequency
        slope = times(polynomial(omega, half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0), over)
    mean = scaled(plus(constant(1.0), late), 0.5)
    square = times(slope, slope)
    loads = times(late, mean)
    of_place = plus(scaled(times(late, slope), second), scaled(loads, third))
    ahead = plus(slope, plus(scaled(late, first), constant(-0.5 * time * second)))
    below = plus(times(square, plus(slope, scaled(late, first))), of_place)
    return Responses(
        late,
        over,
        times(slope, ahead),
        scaled(times(slope, mean), 1 - path.l_1),
        plus(scaled(slope, second), scaled(late, third)),
        plus(scaled(square, first), of_place),
        below,
        ahead,
    )


@kernel
def floor_of(path: MeasurementPath) -> float:
    """Return what |Δ| is at least on the imaginary axis [1/s³]."""
    angle = path.sample_time / path.filter_time
    far = -math.expm1(-angle) / path.sample_time
    near = -math.expm1(-0.5 * angle) / path.sample_time
    return _CARE * far * near * near


@kernel
def continuous_pair(
    form: Form, terms: int, first: Dual, law: Dual, omega: float, half: float, row: FloatArray
) -> Dual:
    """Store x and f, the second behind the ``terms`` and what is fixed; return Δ."""
    known = responses(form.path, omega, half, 0)
    rate = polynomial(omega, half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)  # s
    of_place = plus(
        times(first, times(known.over_s, known.speed_of_place)), times(law, known.place_of_place)
    )
    of_force = plus(
        times(first, known.speed_of_force), times(times(rate, law), known.place_of_force)
    )
    kappa = form.nominal.mass / form.path.estimator_mass
    store(row, terms - 1, times(known.late, of_place))
    store(row, terms + FIXED, scaled(times(known.late, times(rate, of_force)), kappa))
    return known.below


@kernel
def sampled_pairs(
    form: Form, shifts: FloatArray, first: Dual, law: Dual, omega: float, half: float,
    row: FloatArray,
) -> None:  # fmt: skip
    """Store x/Δ and f/Δ of every shifted value, those of f behind what is fixed."""
    hold = sinc(omega, half, form.period / 2)
    rate = polynomial(omega, half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)  # jω
    kappa = form.nominal.mass / form.path.estimator_mass
    floor, terms = floor_of(form.path), len(shifts)
    for k in range(terms):
        known = responses(form.path, omega + shifts[k], half, k)
        share = share_of(omega, half, shifts[k])
        alias = round(shifts[k] * form.period / (2 * math.pi))
        held = scaled(hold, -1.0 if alias % 2 != 0 else 1.0)
        heard = times(times(held, share), times(known.late, inverse(known.below, floor)))
        of_place = plus(
            times(first, times(known.over_s, known.speed_of_place)),
            times(times(share, law), known.place_of_place),
        )
        of_force = plus(
            times(first, known.speed_of_force), times(times(rate, law), known.place_of_force)
        )
        store(row, k, times(times(heard, share), of_place))
        store(row, terms + FIXED + k, scaled(times(heard, times(rate, of_force)), kappa))
