"""The compliance around a state estimator, which hears the force and so stiffens on its own.

A load shifts the position by (1 + L_F) S/(mω²), L_F being the part of the loop gain that the
estimator hears of the force, which knows nothing of the load. With ``mptune.certify.estimated``'s
f, E = Σ f G_F e^{−jω_k d} as enclosed there, and d = d_0 + Ŷ e^{−jωd}, the figure
|S||1 + L_F|μ/|P|² is |n|/|d| with ::

    n = μ (d_0 + E e^{−jωd})/P² = μ (n_0 + Σ (f/P²) G_F e^{−jω_k d})

n_0 = d_0/P² and f/P², which is analytic at ω = 0, are kept in a row of their own, and n encloses as
any figure does. Where δ is left out of L, and so at most of L_F too, the figure is below γ if
|n'| + δ(|w d_0| + γ|d_0|) ≤ γ|d'| for the truncated loop, w = μ/|P|²; by
(a + b)² ≤ (1 + ε)a² + (1 + 1/ε)b² that follows from ::

    (1 + ε)|n'|² + 2(1 + 1/ε)δ²(μ²|n_0|² + γ²|d_0|²) ≤ γ²|d'|²
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.arrays import FloatArray, kernel
from mptune.certify.aliases import sampled_law
from mptune.certify.balls import (
    ROUND,
    Dual,
    conjugate,
    constant,
    inverse,
    plus,
    polynomial,
    scaled,
    sinc,
    squared_modulus,
    times,
    widened,
)
from mptune.certify.enclosure import RATIO, SIDES, Enclosed, PlantDiscs, enclose
from mptune.certify.estimated import Responses, floor_of, responses
from mptune.certify.figures import shape_of, softened
from mptune.certify.rows import (
    ALPHA_D,
    ALPHA_N,
    BETA_D,
    BETA_N,
    D_0,
    D_1,
    DELTA_D,
    DELTA_N,
    store,
)
from mptune.certify.shares import over_alias
from mptune.loops.broken import SAMPLED

if TYPE_CHECKING:
    from mptune.certify.form import Form

_EPSILON, _PER_LEFT = 2e-3, 3.0  # the least ε, by whose half a bound is too high, and ε over δ


@kernel
def softness(form: Form, shifts: FloatArray, omega: float, half: float, row: FloatArray) -> None:
    """Fill a row with the coefficients of n/μ about a frequency; see ``rows``."""
    terms = len(shifts)
    rate = form.gains.k_p_vel / form.nominal.mass
    kappa = rate * rate * form.nominal.mass / form.path.estimator_mass
    soft = softened(form, omega, half)
    if form.loop == SAMPLED:
        first, law = sampled_law(form, omega, half)
        hold = sinc(omega, half, form.period / 2)
        floor = floor_of(form.path)
        for k in range(terms):
            known = responses(form.path, omega + shifts[k], half, k)
            alias = round(shifts[k] * form.period / (2 * math.pi))
            held = scaled(hold, -1.0 if alias % 2 != 0 else 1.0)
            heard = times(held, times(known.late, inverse(known.below, floor)))
            store(row, k, scaled(times(heard, _pushed(first, law, known, omega, half, shifts[k])),
                                 kappa))  # fmt: skip
    else:
        first, law = shape_of(form, omega, half)
        known = responses(form.path, omega, half, 0)
        soft = times(soft, known.below)
        pushed = times(known.late, _pushed(first, law, known, omega, half, 0.0))
        store(row, terms - 1, scaled(pushed, kappa))
    nothing = constant(0.0)
    store(row, terms + ALPHA_N, constant(1.0))
    store(row, terms + BETA_N, conjugate(soft))
    store(row, terms + DELTA_N, squared_modulus(soft))
    store(row, terms + DELTA_D, scaled(squared_modulus(soft), -1.0))
    for place in (ALPHA_D, BETA_D, D_0, D_1):
        store(row, terms + place, nothing)


@kernel
def _pushed(
    first: Dual, law: Dual, known: Responses, omega: float, half: float, shift: float
) -> Dual:
    """Return what of f/s² differs from alias to alias, hold and delays left out."""
    if shift == 0:
        ahead = times(known.over_s, known.ahead)
        return plus(times(first, ahead), times(law, known.place_of_force))
    rate = polynomial(omega, half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)  # jω
    heard = plus(times(first, known.speed_of_force), times(times(rate, law), known.place_of_force))
    return times(over_alias(omega, half, shift), heard)


@kernel
def enclose_softness(
    plant: PlantDiscs,
    force: PlantDiscs,
    row: FloatArray,
    own: FloatArray,
    terms: int,
    left: float,
    sought: float,
    centre: FloatArray,
    half: FloatArray,
    slopes: FloatArray,
    spreads: FloatArray,
) -> Enclosed:
    """Enclose what is to be negative over a box, and its gradient.

    Parameters
    ----------
    plant, force
        Ŷ and the sum Σ (f/P²) G_F e^{−jω_k d} over the box.
    row, own, terms
        The loop's coefficients and those of ``softness``, and the number of shifts.
    left
        δ.
    sought
        γ.
    centre, half, slopes, spreads
        As of ``enclose``.
    """
    epsilon = max(_EPSILON, _PER_LEFT * left)
    weight = 2 * (1 + 1 / epsilon) * left * left * (1 + 8 * ROUND)
    top = enclose(force, own, terms, 1 + epsilon if left > 0 else 1.0, weight,
                  centre, half, slopes, spreads, 0)  # fmt: skip
    by, moved = slopes.copy(), spreads.copy()
    found = enclose(
        plant, row, terms, weight * sought * sought, sought * sought,
        centre, half, slopes, spreads, 0,
    )  # fmt: skip
    ratio, reach = centre[RATIO], half[RATIO]
    square, swing = ratio * ratio, (2 * ratio + reach) * reach
    for i in range(SIDES):
        size = abs(by[i]) + moved[i]
        slopes[i] += square * by[i]
        rounding = 8 * ROUND * (square * size + abs(slopes[i]))
        spreads[i] = widened(spreads[i] + square * moved[i] + swing * size + rounding)
    size = abs(top.value) + top.spread + top.error
    slopes[RATIO] += 2 * ratio * top.value
    further = 2 * ratio * (top.spread + top.error) + 2 * reach * size + 8 * ROUND * ratio * size
    spreads[RATIO] = widened(spreads[RATIO] + further)
    rounding = 8 * ROUND * (square * size + abs(found.value))
    return Enclosed(
        found.value + square * top.value,
        widened(found.error + square * top.error + rounding),
        widened(found.spread + square * top.spread + swing * size + rounding),
    )
