"""Array types, the letters of their shapes, and the decorators of compiled kernels.

Shapes are written with these letters everywhere:

``N``
    plants of a family
``F``
    frequencies
``T``
    instants of time

Kernels are compiled by numba without fast-math; ``mptune.kernel_cache`` says where they are kept.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

from mptune.kernel_cache import kept_for

if TYPE_CHECKING:
    from collections.abc import Callable

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

# Equations are written once, for a number inside a kernel and for arrays of any shape alike.
Complex = Any
Real = Any

_Function = TypeVar("_Function", bound="Callable[..., Any]")


def _compiled(
    function: _Function,
    *,
    parallel: bool = False,
    inlined: bool = False,
    counted: bool = True,
) -> _Function:
    njit: Any = numba.njit
    with kept_for(function) as cached:
        decorate = njit(
            cache=cached,
            nogil=True,
            error_model="numpy",
            parallel=parallel,
            forceinline=inlined,
            _nrt=counted,  # numba has no public name for it; what makes an array does not compile
        )
        return cast("_Function", decorate(function))


def kernel(function: _Function) -> _Function:
    """Compile a function of plain numbers, tuples and arrays."""
    return _compiled(function)


def inlined_kernel(function: _Function) -> _Function:
    """Compile a lending kernel into each of its callers: a call would slow an inner loop down.

    The compiler's back end does it: numba's own inlining takes several times as long to compile and
    makes nothing faster.
    """
    return _compiled(function, inlined=True, counted=False)


def lending_kernel(function: _Function) -> _Function:
    """Compile a function that makes no array and keeps none: references to arrays are not counted.

    A count is an atomic instruction for every array of every tuple handed on, which in the
    simulator's innermost loops takes longer than the arithmetic. The caller holds all that is lent.
    """
    return _compiled(function, counted=False)


def parallel_kernel(function: _Function) -> _Function:
    """Compile a function whose ``numba.prange`` loops run on all cores."""
    return _compiled(function, parallel=True)


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array, marked read-only, for use inside frozen results."""
    array.setflags(write=False)
    return array
