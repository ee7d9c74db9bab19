"""The coefficients of the loop as it runs: its law, and one per shifted value of the plant.

The formulas stand in ``mptune.certify.sampled``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from mptune.certify.rows import store
from mptune.certify.shares import share_of

if TYPE_CHECKING:
    from mptune.certify.form import Form


@kernel
def differentiator(form: Form, omega: float, half: float) -> Dual:
    """Return Eq. 23 over s."""
    time = form.path.sample_time
    pairs = plus(
        plus(
            scaled(sinc(omega, half, 2.5 * time), 25.0), scaled(sinc(omega, half, 1.5 * time), 9.0)
        ),
        sinc(omega, half, 0.5 * time),
    )
    return times(turning(omega, half, 2.5 * time), scaled(pairs, 1 / 35))  # Eq. 23


@kernel
def sampled_law(form: Form, omega: float, half: float) -> tuple[Dual, Dual]:
    """Return what s²R and Q become under Tustin: see ``mptune.certify.sampled``."""
    if form.gains.k_i_pos == 0 and form.gains.k_p_pos == 0:
        return constant(1.0), constant(0.0)
    turn = turning(omega, half, form.period)
    both = plus(constant(1.0), turn)  # 1 + w
    change = scaled(plus(constant(1.0), scaled(turn, -1.0)), 1 / form.period)  # (1 − w)/T_S
    lag = plus(scaled(change, 2 * form.gains.tau), both)
    lags = times(lag, lag)
    rate = scaled(change, 2 / form.gains.omega)
    shape = plus(times(rate, plus(rate, scaled(both, 2 * form.gains.xi))), times(both, both))
    law = scaled(shape, form.gains.k_p_pos)
    first = times(polynomial(omega, half, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0), lags)
    if form.gains.k_i_pos == 0:
        return first, law
    summed = scaled(times(both, lags), form.gains.k_i_pos / 2)
    return times(first, change), plus(times(law, change), summed)


@kernel
def sampled_terms(
    form: Form,
    shifts: FloatArray,
    first: Dual,
    law: Dual,
    omega: float,
    half: float,
    row: FloatArray,
) -> None:
    """Store the coefficient of every shifted value: see ``mptune.certify.sampled``."""
    hold = sinc(omega, half, form.period / 2)
    floor = 1 - form.path.filter_pole
    for k in range(len(shifts)):
        at = omega + shifts[k]
        tick = turning(at, half, form.path.sample_time)
        denominator = plus(constant(1.0), scaled(tick, -form.path.filter_pole))
        place = scaled(times(tick, inverse(denominator, floor)), 1 - form.path.filter_pole)
        share = share_of(omega, half, shifts[k])
        heard = plus(times(first, differentiator(form, at, half)), times(share, law))
        if k > 0:
            place = times(place, times(share, share))
        sign = -1.0 if ((k + 1) // 2) % 2 == 1 else 1.0  # shifts stand in order 0, 1, −1, 2, −2, …
        store(row, k, times(scaled(hold, sign), times(place, heard)))
