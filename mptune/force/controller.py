"""The force controller on its own, as an embedded target would step it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import MptuneError
from mptune.force.chambers import decide_of_chambers
from mptune.force.cost import line_pressures
from mptune.force.search_space import space_of
from mptune.force.select import decide
from mptune.force.stop import stopped
from mptune.params.pack import pack_chambers, pack_force, pack_signals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import FloatArray, IntArray
    from mptune.params.study import ResolvedStudy


@dataclass(frozen=True)
class Measured:
    """What the sensors say, filtered, in SI."""

    position: float  # m
    velocity: float  # m/s
    pressure_a: float  # Pa
    pressure_b: float  # Pa
    pressure_low: float  # Pa, lowest supply
    pressure_high: float  # Pa, highest supply
    converters: Sequence[float]  # m, deviations from the centre, positive on filling
    further_pressures: Sequence[float] = ()  # Pa, chambers behind A and B, in the study's order

    @property
    def pressures(self) -> tuple[float, ...]:
        """Pressures of all chambers [Pa], A's first."""
        return self.pressure_a, self.pressure_b, *self.further_pressures


class ForceController:
    """Chooses valve states, one call per T_S; Eq. 5 to Eq. 10.

    Parameters
    ----------
    study
        The study whose machine is controlled, of two chambers or of four.
    """

    def __init__(self, study: ResolvedStudy) -> None:
        self._space = space_of(study)
        self._converters = study.study.converters
        self._settings = pack_force(study)
        self._more = pack_chambers(study)
        self._signals = pack_signals(study.study.controller)
        self._shut = (0,) * len(study.study.all_chambers)
        self._states: tuple[int, ...] = self._shut
        self._stopped = False

    @property
    def states(self) -> tuple[int, ...]:
        """The present states of all chambers, A's first, 0 for closed; 0 to 27 in the paper."""
        return self._states

    def step(
        self, force: float, measured: Measured, position_reference: float, velocity_reference: float
    ) -> IntArray:
        """Return the valve commands for the next sampling period, chamber by chamber, A first.

        Parameters
        ----------
        force
            F_ref [N].
        measured
            The measured state.
        position_reference, velocity_reference
            For the stop logic [m], [m/s].

        Raises
        ------
        MptuneError
            If any input is not finite, or if there are not as many pressures or converters as the
            machine has; all valves are then to be shut, and the state is.
        """
        try:
            self._check(measured, force, position_reference, velocity_reference)
        except MptuneError:
            self._states = self._shut
            raise
        error = position_reference - measured.position
        self._stopped = bool(stopped(self._stopped, error, velocity_reference, self._signals))
        self._states = self._shut if self._stopped else self._decided(force, measured)
        return np.concatenate([self._space.valves[state] for state in self._states])

    def _check(self, measured: Measured, *others: float) -> None:
        given = len(measured.pressures), len(measured.converters)
        wanted = len(self._shut), self._converters
        if given != wanted:
            raise MptuneError(
                f"the force controller was given {given[0]} chamber pressures and {given[1]} "
                f"converter positions; its machine has {wanted[0]} and {wanted[1]}"
            )
        numbers = [*others, measured.position, measured.velocity, *measured.pressures]
        numbers += [measured.pressure_low, measured.pressure_high, *measured.converters]
        if not np.isfinite(numbers).all():
            raise MptuneError("the force controller was given a value that is not finite")

    def _decided(self, force: float, measured: Measured) -> tuple[int, ...]:
        supplies = line_pressures(measured.pressure_low, measured.pressure_high, self._space)
        converters: FloatArray = np.asarray(measured.converters, np.float64)
        position, velocity = measured.position, measured.velocity
        if self._more is None:
            pressure_a, pressure_b = measured.pressure_a, measured.pressure_b
            present_a, present_b = self._states
            return decide(
                force, pressure_a, pressure_b, position, velocity, supplies, converters,
                present_a, present_b, self._space, self._settings,
            )  # fmt: skip
        choice = np.array(self._states, np.int64)
        decide_of_chambers(
            force, np.array(measured.pressures, np.float64), position, velocity, supplies,
            converters, choice, self._space, self._more,
        )  # fmt: skip
        return tuple(choice.tolist())
