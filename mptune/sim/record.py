"""A neutral record of one movement set: what moved the load, and at what cost, whatever it was.

§7's figures of merit are judged from it, so that a cylinder with on/off valves, a servo valve or a
pump are judged alike. Chamber pressures may be left out; what only one kind of machine has it
judges itself, and hands over as figures of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.arrays import BoolArray, FloatArray


@dataclass(frozen=True)
class Energies:
    """Where the energy of a movement set came from and where it went [J].

    Attributes
    ----------
    pumped
        By the pump, or by whatever else feeds the supply; it varies with the pump's phase.
    drawn
        From the supply at its high pressure.
    returned
        From the low-pressure side; negative where more flows back. What flows back is lost (§7.1).
    delivered
        To the load, at the piston.
    spent
        Everything else that was drawn, by cause; what is stored in the oil at the end as well.
    """

    pumped: float
    drawn: float
    returned: float
    delivered: float
    spent: Mapping[str, float]

    @property
    def loss(self) -> float:
        """What was drawn and not delivered [J]; free of the pump's phase."""
        return self.drawn - self.delivered

    @property
    def pump_loss(self) -> float:
        """What was pumped and not delivered [J], as §7.1 has it."""
        return self.pumped - self.delivered

    @property
    def residual(self) -> float:
        """What the energies fail to close by, over the energy put in [-]."""
        given = self.drawn + self.returned
        used = self.delivered
        for energy in self.spent.values():
            used += energy
        return abs(given - used) / max(abs(given), 1.0)


class BrokenLimit(NamedTuple):
    """A limit of the machine that was met, and when."""

    name: str
    at: float  # s, since the run began


class CommandedSpeed(NamedTuple):
    """A manoeuvre of kind ``velocity`` in a movement set, times since the set began [s]."""

    begin: float
    stop: float  # when the reference stands again
    end: float  # of the rest
    speed: float  # m/s, signed


@dataclass(frozen=True, repr=False)
class RunRecord(Summarised):
    """One movement set of one load.

    Attributes
    ----------
    sample_time
        Time between samples [s].
    position_reference, velocity_reference, position, velocity
        ``(T,)`` [m], [m/s]; position and velocity are the true ones.
    force_reference, force
        ``(T,)`` [N].
    active
        ``(T,)`` whether the force was being controlled.
    ends
        ``(M,)`` when each rest ends, since the set began [s].
    travel
        The way of all moves added up [m].
    energies
        The energies of the set.
    switches
        How often a valve was switched in the set.
    force_limits
        Least and largest force reference [N].
    broken
        Limits that were broken, in the order of time.
    pressures
        ``(T, P)`` of the chambers [Pa]; None where there are none.
    own_figures
        Figures that only this kind of machine has, by their key in ``mptune.sim.merit``.
    busiest
        How often the valve that switches most was switched in the set; None where it was not
        counted.
    commands
        The moves that are a commanded speed over time.
    """

    sample_time: float
    position_reference: FloatArray
    velocity_reference: FloatArray
    position: FloatArray
    velocity: FloatArray
    force_reference: FloatArray
    force: FloatArray
    active: BoolArray
    ends: FloatArray
    travel: float
    energies: Energies
    switches: int = 0
    force_limits: tuple[float, float] = (-np.inf, np.inf)
    broken: tuple[BrokenLimit, ...] = ()
    pressures: FloatArray | None = None
    own_figures: Mapping[str, float] = field(default_factory=dict)
    busiest: int | None = None
    commands: tuple[CommandedSpeed, ...] = ()

    def __post_init__(self) -> None:
        """Look at every array through a view that nobody can write to."""
        for one in fields(self):
            value = getattr(self, one.name)
            if isinstance(value, np.ndarray):
                object.__setattr__(self, one.name, frozen(value.view()))

    @property
    def headline(self) -> str:
        """How long the set lasts, and what it cost."""
        energies = self.energies
        return (
            f"Record of {self.sample_time * len(self.position):g} s, {1e3 * self.travel:g} mm of "
            f"travel: {energies.loss:.4g} J lost, {self.switches} switches"
        )

    @property
    def time(self) -> FloatArray:
        """``(T,)`` since the set began [s]."""
        return np.asarray(self.sample_time * np.arange(len(self.position)))

    @property
    def error(self) -> FloatArray:
        """``(T,)`` position error [m]."""
        return np.asarray(self.position_reference - self.position)

    @property
    def force_error(self) -> FloatArray:
        """``(T,)`` force error while the force is controlled, else 0 [N]."""
        return np.asarray((self.force_reference - self.force) * self.active)
