"""Requirements on the parameters alone that are not linear: cones, and concave functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import ComplexArray, FloatArray


@dataclass(frozen=True)
class Cone:
    """The requirement |left·x| ≤ right·x."""

    name: str
    left: ComplexArray  # (K,)
    right: FloatArray  # (K,)


@dataclass(frozen=True)
class Concave:
    """The requirement value(x) ≤ 0 of a concave function, replaced by its tangent, which is safe.

    Attributes
    ----------
    name
        The requirement's name in results.
    value
        The function of x.
    gradient
        Its gradient, ``(K,)``.
    size
        ``(x)``: what a value of it is to be compared with.
    """

    name: str
    value: Callable[[FloatArray], float]
    gradient: Callable[[FloatArray], FloatArray]
    size: Callable[[FloatArray], float]
