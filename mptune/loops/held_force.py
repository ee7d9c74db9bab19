"""What a held force reference makes of the force between samples, and an adjugate of three."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, kernel

if TYPE_CHECKING:
    from mptune.params.packed import Plant


@kernel
def adjugate(m: FloatArray) -> FloatArray:
    """Return the adjugate of a matrix ``(3, 3)``."""
    found = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            found[j, i] = m[a, c] * m[b, d] - m[a, d] * m[b, c]
    return found


@kernel
def force_terms(
    terms: FloatArray, within: float, plant: Plant, factor_a: float, factor_b: float
) -> None:
    """Fill the coefficients of F(w, θ) times (1 − w)² (1 − E_A w)(1 − E_B w)."""
    terms[:] = 0.0
    for side in range(2):
        own, other = (factor_a, factor_b) if side == 0 else (factor_b, factor_a)
        share = plant.share_a if side == 0 else 1 - plant.share_a
        faded = own**within
        # y_θ (1 − E w) = (1 − E^θ) + (E^θ − E) w, then (1 − E_other w)(1 − 2 w + w²)
        now, then = share * (1 - faded), share * (faded - own)
        first, second, third = -other - 2, 1 + 2 * other, -other
        terms[0] += now
        terms[1] += then + now * first
        terms[2] += then * first + now * second
        terms[3] += then * second + now * third
        terms[4] += then * third
