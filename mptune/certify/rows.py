"""What is kept of a figure over one interval of ω: a row of duals.

First the coefficients of Y's terms, one where nothing is sampled, then those of α, δ and β of
numerator and denominator, and d_0 and d_1. Around a state estimator there follow the coefficients
of those terms that know nothing of the mass, as many as there are with it.
"""

from __future__ import annotations

from mptune.arrays import FloatArray, kernel
from mptune.certify.balls import Dual

PER_DUAL = 7  # numbers of a row per dual
ALPHA_N, ALPHA_D, DELTA_N, DELTA_D, BETA_N, BETA_D, D_0, D_1 = 0, 1, 2, 3, 4, 5, 6, 7
FIXED = 8  # duals behind the terms


@kernel
def row_length(terms: int, estimated: float) -> int:
    """Return the numbers of a row with so many terms, ``estimated`` above 0 with an estimator."""
    return PER_DUAL * (FIXED + (2 * terms if estimated > 0 else terms))


@kernel
def holds_force(row: FloatArray, terms: int) -> bool:
    """Return whether a row has terms that know nothing of the mass."""
    return len(row) > PER_DUAL * (FIXED + terms)


@kernel
def store(row: FloatArray, place: int, dual: Dual) -> None:
    """Write one dual of a row."""
    at = PER_DUAL * place
    row[at], row[at + 1], row[at + 2] = dual.value.real, dual.value.imag, dual.error
    row[at + 3], row[at + 4], row[at + 5] = dual.spread, dual.slope.real, dual.slope.imag
    row[at + 6] = dual.slope_spread


@kernel
def stored(row: FloatArray, place: int) -> Dual:
    """Return one dual of a row."""
    at = PER_DUAL * place
    return Dual(
        complex(row[at], row[at + 1]),
        row[at + 2],
        row[at + 3],
        complex(row[at + 4], row[at + 5]),
        row[at + 6],
    )
