"""The piston and what it pushes against: friction and end stops (Eq. 1's F_μ)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.arrays import kernel

if TYPE_CHECKING:
    from mptune.params.pack import Machine

_CREEP = 1e-4  # m/s: below it dry friction is proportional to velocity


@kernel
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
