"""Controllers that are linear in their parameters, C(s) = Σ_k x_k φ_k(s)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault, InputError
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mptune.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, repr=False)
class Structure(Summarised):
    """A basis of K functions, and what is known of their parameters. The letter K counts them.

    Attributes
    ----------
    names
        Names of the parameters x.
    basis
        Returns φ(s) ``(K, F)`` for complex frequencies s ``(F,)`` [rad/s].
    integral
        Whether each function has a pole at the origin, ``(K,)``.
    low, high
        Bounds of the parameters, ``(K,)``.
    numerators, denominator
        The functions as fractions over one denominator, falling powers of s; empty where they are
        not known as such.
    """

    names: tuple[str, ...]
    basis: Callable[[ComplexArray], ComplexArray]
    integral: tuple[bool, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    numerators: tuple[tuple[float, ...], ...] = ()
    denominator: tuple[float, ...] = ()

    @property
    def headline(self) -> str:
        """The names of the parameters."""
        return f"Structure of {', '.join(self.names)}"

    def fraction(self, parameters: FloatArray) -> tuple[list[float], list[float]]:
        """Return numerator and denominator of C(s), falling powers of s.

        Parameters
        ----------
        parameters
            ``(K,)`` the parameters x.

        Raises
        ------
        InputError
            Where the functions are not known as fractions.
        """
        if not self.denominator:
            fault = Fault("", "", "is not known as a fraction", "take its frequency response")
            raise InputError("controller", fault)
        numerator = np.zeros(1)
        for share, one in zip(parameters, self.numerators, strict=True):
            numerator = np.polyadd(numerator, share * np.array(one))
        return numerator.tolist(), list(self.denominator)

    def response(self, omega: FloatArray) -> ComplexArray:
        """Return φ(jω), ``(K, F)``."""
        return self.basis(np.asarray(1j * omega, np.complex128))

    def controller(self, parameters: FloatArray, omega: FloatArray) -> ComplexArray:
        """Return C(jω), ``(F,)``."""
        return np.asarray(parameters @ self.response(omega), np.complex128)

    def index(self, name: str) -> int:
        """Return the place of a parameter."""
        if name not in self.names:
            fault = Fault(name, "", "is no parameter", f"one of {', '.join(self.names)}")
            raise InputError("controller", fault)
        return self.names.index(name)


def basis_of(
    functions: Sequence[Callable[[ComplexArray], ComplexArray]],
    names: Sequence[str],
    integral: Sequence[bool] | None = None,
    low: Sequence[float] | None = None,
    high: Sequence[float] | None = None,
) -> Structure:
    """Return a structure of the user's own functions of s.

    Parameters
    ----------
    functions
        φ_k, each taking s ``(F,)`` and returning ``(F,)`` or a number.
    names
        The parameters' names.
    integral
        Whether each function has a pole at the origin; none where None.
    low, high
        Bounds; 0 and infinity where None.
    """
    count = len(functions)

    def basis(s: ComplexArray) -> ComplexArray:
        return np.stack([np.broadcast_to(function(s), s.shape) for function in functions])

    return Structure(
        tuple(names),
        basis,
        tuple(integral) if integral else (False,) * count,
        tuple(low) if low else (0.0,) * count,
        tuple(high) if high else (np.inf,) * count,
    )


def _one(s: ComplexArray) -> ComplexArray:
    return np.ones_like(s)


def _integral(s: ComplexArray) -> ComplexArray:
    return 1 / s


def p() -> Structure:
    """Return C = k_p."""
    return replace(basis_of([_one], ["k_p"]), numerators=((1.0,),), denominator=(1.0,))


def pi() -> Structure:
    """Return C = k_p + k_i/s."""
    found = basis_of([_one, _integral], ["k_p", "k_i"], [False, True])
    return replace(found, numerators=((1.0, 0.0), (1.0,)), denominator=(1.0, 0.0))


def pid(filter_time: float) -> Structure:
    """Return C = (k_p + k_i/s + k_d s)/(filter_time s + 1).

    Parameters
    ----------
    filter_time
        The filter's time constant [s].
    """

    def filtered(power: int) -> Callable[[ComplexArray], ComplexArray]:
        return lambda s: np.asarray(s**power / (filter_time * s + 1))

    functions = [filtered(0), filtered(-1), filtered(1)]
    found = basis_of(functions, ["k_p", "k_i", "k_d"], [False, True, False])
    numerators = ((1.0, 0.0), (1.0,), (1.0, 0.0, 0.0))
    return replace(found, numerators=numerators, denominator=(filter_time, 1.0, 0.0))


def position(tau: float) -> Structure:
    """Return Eq. 22 at a fixed τ [s].

    C = (x_0 + x_1 s + x_2 s²)/(τs + 1)² + x_3/s with x = (K_P, 2ξK_P/ω, K_P/ω², K_I).

    Parameters
    ----------
    tau
        τ [s].
    """

    def shaped(power: int) -> Callable[[ComplexArray], ComplexArray]:
        return lambda s: np.asarray(s**power / (tau * s + 1) ** 2)  # Eq. 22, first term

    functions = [shaped(0), shaped(1), shaped(2), _integral]
    names = ["k_p", "two_xi_k_p_over_omega", "k_p_over_omega_squared", "k_i"]
    found = basis_of(functions, names, [False, False, False, True])
    lags = (tau**2, 2 * tau, 1.0)
    numerators = ((1.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), lags)
    return replace(found, numerators=numerators, denominator=(*lags, 0.0))


def position_parameters(k_p: float, k_i: float, omega: float, xi: float) -> FloatArray:
    """Return x of ``position`` from Eq. 22's gains, ``(4,)``."""
    return np.array([k_p, 2 * xi * k_p / omega, k_p / omega**2, k_i])


def position_gains(x: FloatArray) -> tuple[float, float, float, float]:
    """Return Eq. 22's K_P [1/s], K_I [1/s²], ω [rad/s] and ξ from x of ``position``.

    Raises
    ------
    InputError
        Where x_0 or x_2 is not above 0: no ω and ξ belong to such a controller.
    """
    if x[0] <= 0 or x[2] <= 0:
        rule = "has no ω in Eq. 22"
        remedy = "keep K_P and K_P/ω² above 0 by bounds of the parameters"
        raise InputError(
            "position controller", Fault("x", f"({x[0]:g}, …, {x[2]:g}, …)", rule, remedy)
        )
    omega = float(np.sqrt(x[0] / x[2]))
    return float(x[0]), float(x[3]), omega, float(x[1]) * omega / (2 * float(x[0]))
