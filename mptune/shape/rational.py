"""Plants that know their poles, their zeros and their dead time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mptune.arrays import ComplexArray, FloatArray

_PAIRED = 1e-9  # of their size, that a root and its conjugate may miss each other by
_AT_ORIGIN = 1e-9  # of the largest pole: closer to 0, state-space poles are tried as integrators
_AGREE = 1e-6  # of an object's own response, that its poles and zeros must reproduce
_FAR = 1e7  # of the largest pole: further out, zeros are tried as rounding at infinity
_LIGHT = 0.5  # damping ratio below which a root is a mode that a grid may step over
_UNDAMPED = 1e-9  # least damping ratio that points are set for
_PER_DECADE = 6


@dataclass(frozen=True, eq=False)
class RationalPlant:
    """P(s) = gain · Π(s − zero)/Π(s − pole) · e^{−s·delay}, the dead time exact.

    Attributes
    ----------
    zeros, poles
        Roots of numerator and denominator [rad/s]; complex ones with their conjugates. Those of
        light modes are taken exactly as they are given.
    gain
        The factor in front of the products, not the gain at ω = 0.
    delay
        Dead time [s], not negative.

    Raises
    ------
    InputError
        Where a root has no conjugate, a value is not finite, or there are more zeros than poles.
    """

    zeros: Sequence[complex] | ComplexArray
    poles: Sequence[complex] | ComplexArray
    gain: float
    delay: float = 0.0

    def __post_init__(self) -> None:
        """Keep roots as arrays, conjugates exact, and refuse what is no plant."""
        if not np.isfinite(self.gain):
            _refuse("gain", f"{self.gain}", "is not finite", "give the factor of the products")
        if not (np.isfinite(self.delay) and self.delay >= 0):
            _refuse("delay", f"{self.delay}", "is no dead time", "give a time in s, 0 or more")
        for name in ("zeros", "poles"):
            object.__setattr__(self, name, frozen(_with_conjugates(getattr(self, name), name)))
        if len(self.zeros) > len(self.poles):
            rule = f"are more ({len(self.zeros)}) than the poles ({len(self.poles)})"
            _refuse("zeros", "", rule, "give a proper plant")

    @classmethod
    def of(cls, plant: Any, delay: float = 0.0) -> RationalPlant:
        """Return the plant of an object that knows its poles and zeros, with a dead time.

        Parameters
        ----------
        plant
            A continuous-time TransferFunction or StateSpace of python-control with one input and
            one output, or a ``RationalPlant``, whose own dead time is added to.
        delay
            Dead time [s], which python-control's objects cannot hold.

        Raises
        ------
        InputError
            Where the object does not know its poles and zeros, or they do not reproduce its
            response, as happens with many equal poles or badly scaled states.
        """
        if isinstance(plant, RationalPlant):
            return replace(plant, delay=plant.delay + delay)
        found = rational_form(plant)
        if found is None:
            rule = "has no poles and zeros that reproduce its frequency response to 1e-6"
            _refuse("plant", "", rule, "give RationalPlant(zeros, poles, gain, delay)")
        return replace(found, delay=delay)

    def __call__(self, s: Any) -> ComplexArray:
        """Return P(s) for complex s of any shape [rad/s], factor by factor."""
        points = np.asarray(s, np.complex128)
        found = self.gain * np.exp(-points * self.delay)
        with np.errstate(divide="ignore", invalid="ignore"):  # infinite at a pole
            for n, pole in enumerate(self.poles):
                upper = points - self.zeros[n] if n < len(self.zeros) else 1.0
                found = found * (upper / (points - pole))
        return np.asarray(found, np.complex128)

    @property
    def integrators(self) -> int:
        """Number of poles at the origin."""
        return int(np.sum(np.asarray(self.poles) == 0))

    @property
    def unstable_poles(self) -> int:
        """Number of poles in the open right half plane."""
        return int(np.sum(np.real(self.poles) > 0))

    @property
    def landmarks(self) -> FloatArray:
        """Frequencies that a grid must hold to see this plant, rising [rad/s]."""
        return landmarks([*self.poles, *self.zeros])


def landmarks(roots: Iterable[complex]) -> FloatArray:
    """Return frequencies at and about each root, at ω_n(1 ± kζ) for light modes, rising [rad/s].

    The distances kζω_n from a light mode rise by sixths of a decade, from a tenth of its half width
    to a third of its frequency: there a loop that shifts the mode is seen where it shifts it to.
    """
    found = [np.zeros(0)]
    for root in roots:
        size, centre = abs(root), abs(root.imag)
        damping = abs(root.real) / size if size > 0 else 1.0
        if size == 0 or root.imag < 0:
            continue
        if damping >= _LIGHT:
            found.append(np.array([size]))
            continue
        nearest, furthest = np.log10(0.1 * max(damping, _UNDAMPED)), np.log10(1 / 3)
        count = int(np.ceil(_PER_DECADE * (furthest - nearest))) + 1
        away = np.logspace(nearest, furthest, count)
        found += [centre * (1 - away), centre * (1 + away)]
        if damping >= _UNDAMPED:  # else the response may be infinite there
            found.append(np.array([centre]))
    return np.unique(np.concatenate(found))


def rational_form(plant: Any) -> RationalPlant | None:
    """Return an object's poles and zeros as a plant, None where it has none or they mislead.

    Poles that an eigenvalue solver leaves near the origin are tried there too, and zeros that it
    leaves far away are tried without: whichever reproduces the object's own response counts.
    """
    if isinstance(plant, RationalPlant):
        return plant
    if not (callable(getattr(plant, "poles", None)) and callable(getattr(plant, "zeros", None))):
        return None
    poles, zeros = np.asarray(plant.poles()), np.asarray(plant.zeros())
    largest = max(float(np.abs(poles).max(initial=0.0)), 1e-300)
    settled = np.where(np.abs(poles) <= _AT_ORIGIN * largest, 0.0, poles)
    near = zeros[np.abs(zeros) <= _FAR * largest]
    for some_poles in (poles, settled):
        for some_zeros in (zeros, near):
            found = _fitted(plant, some_zeros, some_poles)
            if found is not None:
                return found
    return None


def _fitted(plant: Any, zeros: ComplexArray, poles: ComplexArray) -> RationalPlant | None:
    """Return the plant with these roots if it reproduces the object's response."""
    roots = np.concatenate([poles, zeros])
    if len(zeros) > len(poles) or not np.all(np.isfinite(roots)):
        return None
    size = 2 * float(np.abs(roots).max(initial=0.0)) or 1.0
    unit = RationalPlant(zeros, poles, 1.0)
    gain = (np.asarray(plant(complex(size))).reshape(-1) / unit(complex(size))).real
    found = replace(unit, gain=float(gain[0]))
    sizes = np.abs(roots[roots != 0]) if np.any(roots != 0) else np.ones(1)
    omega = np.unique(np.concatenate([0.1 * sizes, sizes, 10 * sizes, landmarks(roots)]))
    with np.errstate(divide="ignore", invalid="ignore"):
        own, ours = np.asarray(plant(1j * omega)).reshape(-1), found(1j * omega)
        finite = np.isfinite(own) & np.isfinite(ours)
    return found if np.all(np.abs(own - ours)[finite] <= _AGREE * np.abs(own)[finite]) else None


def _with_conjugates(roots: Any, name: str) -> ComplexArray:
    """Return the roots with the conjugate of every complex one beside it, exactly."""
    given = np.atleast_1d(np.asarray(roots, np.complex128))
    if given.ndim != 1 or not np.all(np.isfinite(given)):
        _refuse(name, "", "are not a list of finite numbers", "give roots in rad/s")
    upper, lower = given[given.imag > 0], given[given.imag < 0].conj()
    upper, lower = np.sort_complex(upper), np.sort_complex(lower)
    if len(upper) != len(lower) or np.any(np.abs(upper - lower) > _PAIRED * np.abs(upper)):
        _refuse(name, "", "hold a complex root without its conjugate", "give both of each pair")
    return np.concatenate([given[given.imag == 0], np.ravel(np.stack([upper, upper.conj()], 1))])


def _refuse(key: str, value: str, rule: str, remedy: str) -> NoReturn:
    raise InputError("plant", Fault(key, value, rule, remedy))
