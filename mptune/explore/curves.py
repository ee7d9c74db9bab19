"""The loops of the plants that are looked at, in frequency and in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.explore.setting import LOOPS
from mptune.figures.panels import step_horizon
from mptune.figures.style import drawable
from mptune.loops.family import FamilyLoops
from mptune.params.packed import NO_PATH
from mptune.robust.curves import loop_curves
from mptune.sim.response import farthest, load_step, position_step, velocity_step

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray
    from mptune.explore.looking import Looked
    from mptune.params.packed import LoopGains

_POINTS = 400
_LOWEST, _HIGHEST = 0.3, 1000.0  # rad/s
_INSTANTS = 161
_LOAD_FADES = 8.0  # over the slowest rate of the position loop


@dataclass(frozen=True)
class LoopView:
    """Loop gains of the plants that are looked at.

    Attributes
    ----------
    omega
        ``(F,)`` frequencies [rad/s].
    gain
        ``(P, F)`` loop gains.
    """

    omega: FloatArray
    gain: ComplexArray

    @property
    def decibel(self) -> FloatArray:
        """``(P, F)``: magnitude [dB]."""
        return np.asarray(20 * np.log10(np.maximum(np.abs(self.gain), 1e-12)))

    @property
    def degrees(self) -> FloatArray:
        """``(P, F)``: phase [°], unwrapped along frequency, starting within (−360°, 0]."""
        phase = np.unwrap(np.angle(self.gain), axis=-1)
        phase = phase - 2 * np.pi * np.ceil(phase[:, :1] / (2 * np.pi))
        return np.asarray(np.degrees(phase))

    @property
    def sensitivity(self) -> FloatArray:
        """``(P, F)``: |S| = |1/(1 + L)|."""
        return np.asarray(1 / np.abs(1 + self.gain))

    @property
    def complementary(self) -> FloatArray:
        """``(P, F)``: |T| = |L/(1 + L)|."""
        return np.asarray(np.abs(self.gain / (1 + self.gain)))


def loop_view(gains: LoopGains, looked: Looked, loop: str) -> LoopView:
    """Return the loop gains of the plants that are looked at, broken at one of ``LOOPS``."""
    omega = np.geomspace(_LOWEST, _HIGHEST, _POINTS)
    loops = FamilyLoops(looked.plants, gains, looked.path)
    return LoopView(omega, loop_curves(LOOPS.index(loop), omega, loops))


class TimeResponse(NamedTuple):
    """A response in time of the plants that are looked at."""

    time: FloatArray  # (T,) s
    value: FloatArray  # (P, T)


@dataclass(frozen=True)
class StepView:
    """Steps of velocity and position over their references, and of the load [m/N].

    Attributes
    ----------
    along
        Whether the measurement path is in them. A state estimator has no continuous loop in time:
        beside one the steps are those without path.
    """

    velocity: TimeResponse
    position: TimeResponse
    load: TimeResponse
    along: bool


def step_view(gains: LoopGains, looked: Looked) -> StepView:
    """Return the steps of the plants that are looked at."""
    path = NO_PATH if looked.path.estimator_mass > 0 else looked.path
    loops = FamilyLoops(looked.plants, gains, path)
    fast, slow = step_horizon(gains, looked.plants)
    rates = gains.k_p_pos, gains.k_i_pos**0.5, gains.k_p_vel / float(looked.plants.mass[0]) / 100
    ends = fast, slow, _LOAD_FADES / max(rates)
    times = [np.linspace(0, min(end, farthest(loops)), _INSTANTS) for end in ends]
    steps = (velocity_step, position_step, load_step)
    found = [
        TimeResponse(time, drawable(step(loops, time)))
        for step, time in zip(steps, times, strict=True)
    ]
    velocity, position, load = found
    return StepView(velocity, position, load, along=path != NO_PATH)
