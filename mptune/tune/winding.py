"""Encirclements of sampled loops: what a frequency response alone can say about stability."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.stability import PoleCount

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray

_LARGE = 4.0  # |L| at the first frequency of a loop with poles at the origin
_TAIL = 0.5  # |L| at the last frequency
_STRAIGHT = np.pi / 4  # largest deviation from the asymptote's angle at the first frequency


def count_sampled(loop: ComplexArray, integrators: int, unstable_poles: int = 0) -> PoleCount:
    """Count the closed-loop poles in the right half plane of sampled loops.

    Between two samples the loop is taken to keep within the circle whose diameter joins them,
    which no samples can prove. The count is refused (undecided) where such a step is longer than
    its distance from the critical point, where |L| is not below 1/2 at the last frequency, and
    where the first frequency does not show the c/s^k of the open-loop poles at the origin.

    Parameters
    ----------
    loop
        ``(N, F)`` loop gains at rising frequencies.
    integrators
        Number k of open-loop poles at the origin.
    unstable_poles
        Number of open-loop poles in the right half plane.
    """
    gain = np.atleast_2d(loop)
    distance = 1 + gain
    step = np.abs(np.diff(gain, axis=1))
    near = np.minimum(np.abs(distance[:, 1:]), np.abs(distance[:, :-1]))
    # A loop far out moves far in a step; then its angle as seen from −1 must change little.
    change = np.angle(distance[:, 1:] / distance[:, :-1])
    decided = np.all((step <= near) | (np.abs(change) < np.pi / 6), axis=1)
    decided &= np.abs(gain[:, -1]) < _TAIL
    first = gain[:, 0]
    if integrators:
        # The angle of L j^k is that of c: 0 or π.
        deviation = np.angle((first * 1j**integrators) ** 2) / 2
        decided &= (np.abs(first) > _LARGE) & (np.abs(deviation) < _STRAIGHT)
        start = -integrators * np.pi / 2 + deviation + np.angle(1 + 1 / first)
    else:
        start = np.angle(distance[:, 0] * np.where(distance[:, 0].real < 0, -1, 1))
        decided &= np.abs(start) < _STRAIGHT
    angle = start + change.sum(axis=1) - np.angle(distance[:, -1])
    poles = unstable_poles - angle / np.pi
    whole = np.rint(poles)
    decided &= (np.abs(poles - whole) < 0.25) & (whole >= 0)
    return PoleCount(whole.astype(np.int64), decided)
