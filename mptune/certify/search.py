"""Branch and bound: a proof over a list of boxes, in one compiled search.

A box is proved when F < 0 all over it, by the discs alone or by the centred form
F(c) + Σ sup|∂F/∂x_i|·r_i; or, where only that is asked, because the denominator keeps clear of
zero. Where the enclosure of a partial derivative has one sign, the largest F lies on one face, and
the box collapses to it; else the side with the largest sup|∂F/∂x_i|·r_i is bisected. The list is
worked off depth first. A centre where F > 0 for certain lies above the bound and ends the search;
so does a box too small to be split: there F = 0 as far as can be told. What is proved for a lower
bound holds for a higher one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, kernel
from mptune.certify.balls import ROUND
from mptune.certify.clearance import clearance
from mptune.certify.climb import figure_at
from mptune.certify.enclosure import (
    GAIN,
    OMEGA,
    RATIO,
    SIDES,
    TAU_A,
    TAU_B,
    Enclosed,
    PlantDiscs,
    enclose,
    force_over,
    plant_over,
)
from mptune.certify.figures import coefficients
from mptune.certify.form import COMPLIANCE
from mptune.certify.rows import DELTA_N, row_length, stored
from mptune.certify.softness import enclose_softness, softness

if TYPE_CHECKING:
    from mptune.certify.form import Form

PROVED, ABOVE, OPEN, STUCK = 0, 1, 2, 3
_SMALLEST = 1e-13  # half a side over its place, below which it is not split any more
_TINY = 1e-25  # and in itself, in SI
_CARE = 1 + 1e-14
_FOLDED_CARE = 1 + 1e-9
_NOTHING_PROVED = 1e30  # of L, left out
_FAR = 1e-6  # weight of n over that of d, below which only zeros of d are asked for


class Found(NamedTuple):
    """How a search ended: its status, the boxes it took, and how many are left on the list."""

    status: int
    boxes: int
    left: int


class Rest(NamedTuple):
    """What a truncated loop leaves out of L, where that depends on the box: see ``folded``."""

    fixed: float
    near: float
    near_rate: float  # s
    rate: float  # s; 0 where nothing depends on the box
    offset: float  # c, of ``mptune.certify.sampled``
    sought: float  # the bound that is to be proved; 0 where only zeros of d are asked for
    time: float  # m_N/K_P,vel of a compliance [s]; 0 of other figures


NO_REST = Rest(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def search(
    form: Form,
    shifts: FloatArray,
    curve: FloatArray,
    num: float,
    den: float,
    lows: FloatArray,
    highs: FloatArray,
    count: int,
    budget: int,
    point: FloatArray,
    rest: Rest = NO_REST,
) -> Found:
    """Prove that the figure is below a bound in every box of a list.

    Parameters
    ----------
    form, shifts, curve
        The figure, as ``coefficients`` takes it.
    num, den
        Asked is num·|n|² < den·|d|²: 1 and γ² for a bound γ of the figure. Where num ≤ den/10⁶ the
        question is whether the denominator comes near zero, and n_1 = 0 is taken for granted.
    lows, highs
        ``(S, SIDES)``: the list of boxes, its first ``count`` rows in use, the others are room.
        Worked off from its end: what is left of it is not proved.
    count
        Boxes on the list.
    budget
        Boxes to try at most.
    point
        ``(SIDES,)``, filled: where the figure is ABOVE, or where the search ended.
    """
    terms = len(shifts)
    stiffened = form.figure == COMPLIANCE and form.path.estimator_mass > 0
    # A box at place p uses the coefficients in a slot ≤ p, so that the last one may fill its own.
    slots = np.empty(len(lows), np.int64)
    for i in range(count):
        slots[i] = -1
    rows = np.empty((len(lows), row_length(terms, form.path.estimator_mass)))
    softnesses = np.empty((len(lows) if stiffened else 1, row_length(terms, 0.0)))
    half, slopes, spreads = np.empty(SIDES), np.empty(SIDES), np.empty(SIDES)
    centre = point
    boxes = 0
    while count > 0:
        last = count - 1
        low, high = lows[last], highs[last]
        _measure(low, high, centre, half)
        if boxes >= budget or count == len(lows):
            return Found(OPEN, boxes, count)
        boxes += 1
        if slots[last] < 0:
            slots[last] = last
            coefficients(form, shifts, curve, centre[OMEGA], half[OMEGA], rows[last])
            if stiffened:
                softness(form, shifts, centre[OMEGA], half[OMEGA], softnesses[last])
        row = rows[slots[last]]
        own = softnesses[slots[last] if stiffened else 0]
        f, clear = _look(
            form, shifts, row, own, num, den, low, high, centre, half, slopes, spreads, rest
        )
        if clear or _highest(f, slopes, spreads, half) < 0:
            slots[last] = -1
            count -= 1
            continue
        if f.value > f.error and (rest.rate == 0 or _above(form, curve, num, den, centre)):
            return Found(ABOVE, boxes, count)
        if _collapse(low, high, slopes, spreads, rest):
            slots[last] = -1
            continue
        side = _widest(centre, half, slopes, spreads)
        if side < 0:
            return Found(STUCK, boxes, count)
        _split(lows, highs, count, side, centre[side])
        slots[last] = -1 if side == OMEGA else slots[last]
        slots[count] = slots[last]
        count += 1
    return Found(PROVED, boxes, 0)


@kernel
def _look(
    form: Form,
    shifts: FloatArray,
    row: FloatArray,
    own: FloatArray,
    num: float,
    den: float,
    low: FloatArray,
    high: FloatArray,
    centre: FloatArray,
    half: FloatArray,
    slopes: FloatArray,
    spreads: FloatArray,
    rest: Rest,
) -> tuple[Enclosed, bool]:
    """Enclose F over a box, and say whether the denominator alone settles it."""
    terms, power = len(shifts), 2 if form.figure == COMPLIANCE else 0
    plant = plant_over(row, shifts, form.share_a, centre, half)
    if power > 0 and form.path.estimator_mass > 0:
        force = force_over(own, shifts, form.share_a, centre, half)
        left = _left_over(rest, form.share_a, low, high)
        return enclose_softness(
            plant, force, row, own, terms, left, math.sqrt(den), centre, half, slopes, spreads
        ), False  # fmt: skip
    top, bottom = num, den
    if rest.rate > 0:
        top, bottom = _weights(rest, form.share_a, low, high)
    f = enclose(plant, row, terms, top, bottom, centre, half, slopes, spreads, power)
    weight = (centre[RATIO] + half[RATIO]) ** power
    return f, _clear(plant, row, terms, weight * top, bottom, centre, half)


@kernel
def _weights(rest: Rest, share_a: float, low: FloatArray, high: FloatArray) -> tuple[float, float]:
    """Return the weights of n and d with what the loop leaves out over a box counted in.

    With δ left out, X = x S + y T is below γ if |X_t| + δ(|y| + γ)|S_t| ≤ γ for the truncated loop,
    and |S_t| ≤ |y| + |X_t| in all three mixtures.
    """
    left = _left_over(rest, share_a, low, high)
    if left >= _NOTHING_PROVED:
        return 1.0, 0.0
    if rest.sought == 0:
        return left * left * _CARE, 1.0
    reach = _FOLDED_CARE * left * (rest.offset + rest.sought)
    sought = (rest.sought - reach * rest.offset) / (1 + reach)
    return 1.0, sought * sought if sought > 0 else 0.0


@kernel
def _left_over(rest: Rest, share_a: float, low: FloatArray, high: FloatArray) -> float:
    """Return what is left out of L over a box at most."""
    if rest.rate == 0:
        return 0.0
    shortest = min(low[TAU_A], low[TAU_B])
    if shortest <= 0:
        return _NOTHING_PROVED
    fall = _FOLDED_CARE * (share_a / low[TAU_A] + (1 - share_a) / low[TAU_B])
    left: float = rest.fixed + min(rest.near, fall * rest.near_rate) + fall * rest.rate
    return left * math.exp(high[GAIN])


@kernel
def _above(form: Form, curve: FloatArray, num: float, den: float, centre: FloatArray) -> bool:
    """Return whether the loop itself is above the bound at a box's centre, not cut off."""
    return num == 1.0 and figure_at(form, curve, centre) ** 2 > den


@kernel
def _measure(low: FloatArray, high: FloatArray, centre: FloatArray, half: FloatArray) -> None:
    """Fill centre and half widths, which reach at least to both ends."""
    for i in range(SIDES):
        centre[i] = 0.5 * (low[i] + high[i])
        half[i] = max(high[i] - centre[i], centre[i] - low[i]) * (1 + ROUND)


@kernel
def _split(lows: FloatArray, highs: FloatArray, count: int, side: int, middle: float) -> None:
    """Bisect the last box of the list: its upper part is added as a further one."""
    last = count - 1
    for i in range(SIDES):
        lows[count, i], highs[count, i] = lows[last, i], highs[last, i]
    highs[last, side] = lows[count, side] = middle


@kernel
def _clear(
    plant: PlantDiscs,
    row: FloatArray,
    terms: int,
    num: float,
    den: float,
    centre: FloatArray,
    half: FloatArray,
) -> bool:
    """Return whether the denominator stays clear of zero, if that is what is asked."""
    if num > _FAR * den and half[GAIN] == 0:
        return False
    least = clearance(plant, row, terms, centre, half)
    top = stored(row, terms + DELTA_N)  # |n|², n_1 = 0
    return bool(least > 0 and den * least * least > num * (top.value.real + top.spread) * _CARE)


@kernel
def _highest(f: Enclosed, slopes: FloatArray, spreads: FloatArray, half: FloatArray) -> float:
    """Return what F is at most over a box: by the discs, or by the centred form."""
    centred = f.value + f.error
    size = abs(f.value)
    for i in range(SIDES):
        reach = (abs(slopes[i]) + spreads[i]) * half[i]
        centred += reach
        size += reach
    return min(centred + 4 * ROUND * size, f.value + f.spread * (1 + 2 * ROUND))


@kernel
def _collapse(
    low: FloatArray, high: FloatArray, slopes: FloatArray, spreads: FloatArray, rest: Rest
) -> bool:
    """Reduce a box to the faces that hold its largest F; return whether any was found.

    A face on which less is asked than of the box, as less is left out there, proves nothing of it.
    """
    found = False
    for i in range(SIDES):
        if low[i] < high[i] and abs(slopes[i]) > spreads[i] and not _eased(i, slopes[i], rest):
            found = True
            if slopes[i] > 0:
                low[i] = high[i]
            else:
                high[i] = low[i]
    return found


@kernel
def _eased(side: int, slope: float, rest: Rest) -> bool:
    """Return whether less is asked on the face to which a slope points."""
    if rest.rate == 0:
        return False
    if side in (TAU_A, TAU_B) or (side == RATIO and rest.time > 0):
        return slope > 0
    if side == GAIN:
        return slope < 0
    return side == OMEGA and rest.time > 0 and slope < 0


@kernel
def _widest(centre: FloatArray, half: FloatArray, slopes: FloatArray, spreads: FloatArray) -> int:
    """Return the side over which F may move most, −1 where all are too short to be split."""
    side, most = -1, 0.0
    for i in range(SIDES):
        if i == GAIN and side >= 0:
            continue  # what it does is known for its whole length
        reach = (abs(slopes[i]) + spreads[i]) * half[i]
        if reach > most and half[i] > _SMALLEST * abs(centre[i]) + _TINY:
            side, most = i, reach
    return side
