"""One grid of plants with two delays each: lumped, and beside an explicit path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mptune.arrays import IntArray
    from mptune.params.packed import Plants


def at_same_share(delay: float, source: Plants, other: Plants) -> float:
    """Return the delay [s] at the share of another grid's range that this one has of its own."""
    low, high = float(source.delay.min()), float(source.delay.max())
    first, last = float(other.delay.min()), float(other.delay.max())
    share = (delay - low) / (high - low) if high > low else 0.0
    return first if share == 0 else last if share == 1 else first + share * (last - first)


def joined(source: Plants, other: Plants, one: Plants) -> tuple[Plants, Plants]:
    """Return both grids with one more plant, given as the first grid has it."""
    twin = one._replace(delay=np.array([at_same_share(float(one.delay[0]), source, other)]))
    return source.followed_by(one), other.followed_by(twin)


def corners_of(lumped: Plants, explicit: Plants) -> IntArray:
    """Return the plants with the least or largest mass, all lags smallest or all largest."""
    lags = np.stack([lumped.delay, explicit.delay, lumped.tau_a, lumped.tau_b])
    small = np.all(lags == lags.min(axis=1, keepdims=True), axis=0)
    large = np.all(lags == lags.max(axis=1, keepdims=True), axis=0)
    light, heavy = lumped.mass == lumped.mass.min(), lumped.mass == lumped.mass.max()
    return np.flatnonzero((small | large) & (light | heavy))
