"""The piston and what it pushes against: friction, load force and inertia (Eq. 1)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import FloatArray, inlined_kernel, lending_kernel

if TYPE_CHECKING:
    from mptune.params.packed import Machine

_CREEP = 1e-4  # m/s: below it dry friction is proportional to velocity


@inlined_kernel
def friction(velocity: float, machine: Machine) -> float:
    """Return F_μ [N]: Coulomb friction, Stribeck's rise towards stiction, and viscous friction."""
    speed = abs(velocity) / machine.friction_velocity
    dry = machine.friction_coulomb
    if speed < 6:  # beyond, the exponential is below 1e-15
        dry += (machine.friction_static - dry) * math.exp(-speed * speed)
    sign = (
        math.tanh(velocity / _CREEP)
        if abs(velocity) < 20 * _CREEP
        else math.copysign(1.0, velocity)
    )
    return dry * sign + machine.friction_viscous * velocity


class Burden(NamedTuple):
    """Load force and effective inertia about a piston position, linear in position."""

    position: float  # m
    force: float  # N, F_load there
    stiffness: float  # N/m
    mass: float  # kg, m there
    mass_slope: float  # kg/m


@lending_kernel
def burden_at(position: float, machine: Machine, table: FloatArray) -> Burden:
    """Return load and inertia about a position.

    The load is constant, rises with position, and follows the boom's ``table`` ``(K, 3)``, of which
    the slopes of the present interval are taken: a piston that leaves it does so by less than its
    way in one fast tick before the next is looked up.
    """
    force = machine.load + machine.load_stiffness * (position - machine.start)
    if len(table) == 0:
        return Burden(position, force, machine.load_stiffness, machine.mass, 0.0)
    added, rise = _from_table(position, table, 1)
    factor, slope = _from_table(position, table, 2)
    mass = machine.mass
    return Burden(
        position, force + added, machine.load_stiffness + rise, mass * factor, mass * slope
    )


@lending_kernel
def _from_table(position: float, table: FloatArray, column: int) -> tuple[float, float]:
    """Return value and slope of a column by linear interpolation, held beyond the ends."""
    last = len(table) - 1
    if position <= table[0, 0]:
        return table[0, column], 0.0
    if position >= table[last, 0]:
        return table[last, column], 0.0
    row = np.searchsorted(table[:, 0], position)
    width = table[row, 0] - table[row - 1, 0]
    slope = (table[row, column] - table[row - 1, column]) / width
    return table[row - 1, column] + slope * (position - table[row - 1, 0]), slope
