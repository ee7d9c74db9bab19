"""Plants as users hold them: arrays, functions of s, or objects of python-control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from mptune.errors import Fault, InputError
from mptune.shape.rational import RationalPlant, rational_form

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.shape.problem import Between

_POINTS = 400
_WIDE = (1e-7, 1e7, 6000)  # rad/s, where a plant's own range is looked for
_FIRST_LAG, _LAST_LAG = 0.01, 2 * np.pi  # rad, of the phase beyond its low-frequency value
_FALLEN = 1e-4  # of the gain where the lag is half a radian
_AT_ORIGIN = 1e-9  # |s| of a pole that counts as an integrator, relative to the largest


@dataclass(frozen=True)
class Response:
    """One plant.

    Attributes
    ----------
    at
        P(jω) ``(F,)`` for ω ``(F,)`` [rad/s]; a sampled plant knows its own frequencies only.
    omega
        Those frequencies; None where any will do.
    integrators, unstable_poles
        Poles at the origin and in the right half plane, where the plant's object knows them.
    rational
        Its poles, zeros and dead time, where the plant's object knows them.
    """

    at: Callable[[FloatArray], ComplexArray]
    omega: FloatArray | None
    integrators: int | None
    unstable_poles: int | None
    rational: RationalPlant | None = None

    @property
    def landmarks(self) -> FloatArray:
        """Frequencies that a grid must hold to see the plant's poles and zeros [rad/s]."""
        return np.zeros(0) if self.rational is None else self.rational.landmarks


def response_of(plant: Any, omega: FloatArray | None, name: str) -> Response:
    """Return a plant's response.

    Parameters
    ----------
    plant
        An array ``(F,)`` of values at ``omega``; a frequency response object with ``omega`` and
        values when called (python-control's FRD); or anything that is P(s) when called with
        complex s: a function, a ``RationalPlant``, a transfer function, a state space.
    omega
        ``(F,)`` frequencies of an array [rad/s].
    name
        What to call the plant in errors.
    """
    _refuse_sampled_time(plant, name)
    if callable(plant) and getattr(plant, "omega", None) is None:
        _refuse_several_channels(plant, name)
        known = rational_form(plant)
        if known is not None:
            counts = known.integrators, known.unstable_poles
            return Response(_along_axis(known), None, *counts, known)
        return Response(_along_axis(plant), None, *_poles(plant))
    if callable(plant):
        grid = np.asarray(plant.omega, np.float64)
        values = np.asarray(plant(1j * grid), np.complex128).reshape(-1)
    else:
        if omega is None:
            _refuse(name, "is an array without frequencies", "give omega in rad/s")
        grid, values = np.asarray(omega, np.float64), np.asarray(plant, np.complex128)
    if grid.shape != values.shape or grid.ndim != 1 or len(grid) < 2:
        rule = f"has {values.shape} values at {grid.shape} frequencies"
        _refuse(name, rule, "give one value per frequency, and at least two")
    if np.any(np.diff(grid) <= 0) or grid[0] <= 0:
        _refuse(name, "has frequencies that do not rise from above 0", "sort them, in rad/s")
    if not np.all(np.isfinite(values)):
        _refuse(name, "has values that are not finite", "leave those frequencies out")
    return Response(lambda _omega: values, grid, None, None)


def _along_axis(plant: Callable[[ComplexArray], Any]) -> Callable[[FloatArray], ComplexArray]:
    def at(omega: FloatArray) -> ComplexArray:
        found = np.asarray(plant(np.asarray(1j * omega, np.complex128)), np.complex128)
        return np.broadcast_to(found.reshape(-1), omega.shape)

    return at


def _refuse(name: str, rule: str, remedy: str) -> NoReturn:
    raise InputError("design", Fault(name, "", rule, remedy))


def _refuse_sampled_time(plant: Any, name: str) -> None:
    step = getattr(plant, "dt", None)
    if step is not None and step != 0:
        rule = f"is in sampled time (dt = {step})"
        _refuse(name, rule, "give its frequency response as an array, with omega")


def _refuse_several_channels(plant: Any, name: str) -> None:
    channels = getattr(plant, "ninputs", 1), getattr(plant, "noutputs", 1)
    if channels != (1, 1):
        rule = f"has {channels[0]} inputs and {channels[1]} outputs"
        _refuse(name, rule, "give one of its channels")


def _poles(plant: Any) -> tuple[int | None, int | None]:
    """Return integrators and unstable poles where the object knows its poles."""
    if not callable(getattr(plant, "poles", None)):
        return None, None
    poles = np.asarray(plant.poles())
    size = max(float(np.abs(poles).max(initial=0.0)), 1.0)
    origin = np.abs(poles) <= _AT_ORIGIN * size
    return int(origin.sum()), int(((poles.real > 0) & ~origin).sum())


def own_range(plant: Response, name: str) -> FloatArray:
    """Return a grid from where a plant's phase begins to move to where little of it is left.

    The last frequency has 2π of lag more than the first, or a gain 1e-4 times that at half a
    radian of lag.
    """
    wide = np.union1d(np.geomspace(*_WIDE), plant.landmarks)
    values = plant.at(wide)
    turned = np.abs(np.unwrap(np.angle(values)) - np.angle(values[0]))
    moved = np.flatnonzero(turned > _FIRST_LAG)
    bent = np.flatnonzero(turned > 0.5)
    if not len(bent):
        _refuse(name, "has no frequency of its own: its phase stays the same", "give omega")
    small = np.abs(values) < _FALLEN * np.abs(values[bent[0]])
    ends = np.flatnonzero(((turned > _LAST_LAG) | small) & (wide > 10 * wide[bent[0]]))
    last = ends[0] if len(ends) else len(wide) - 1
    return np.geomspace(wide[moved[0]] / 10, wide[last], _POINTS)


def between(plants: Sequence[Response]) -> Between | None:
    """Return the plants' values at any frequency, None where some are sampled."""
    if any(plant.omega is not None for plant in plants):
        return None

    def values(omega: FloatArray, rows: IntArray) -> tuple[ComplexArray, ComplexArray]:
        found = np.stack([plants[row].at(omega) for row in rows])
        return found, np.zeros_like(found)

    return values
