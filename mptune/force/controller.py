"""The force controller on its own, as an embedded target would step it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import MptuneError
from mptune.force.cost import line_pressures
from mptune.force.search_space import space_of
from mptune.force.select import decide
from mptune.force.stop import stopped
from mptune.params.pack import pack_force, pack_signals
from mptune.params.two_chambers import needs_two_chambers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import IntArray
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


class ForceController:
    """Chooses valve states, one call per T_S; Eq. 5 to Eq. 10.

    Parameters
    ----------
    study
        The study whose machine is controlled.

    Raises
    ------
    InputError
        If it has more than two chambers.
    """

    def __init__(self, study: ResolvedStudy) -> None:
        needs_two_chambers(study, "step-by-step controller", "simulate it with mptune.verify")
        self._space = space_of(study)
        self._converters = study.study.converters
        self._settings = pack_force(study)
        self._signals = pack_signals(study.study.controller)
        self._states = (0, 0)
        self._stopped = False

    @property
    def states(self) -> tuple[int, int]:
        """The present states of the A- and B-side, 0 for closed; 0 to 27 in the paper."""
        return self._states

    def step(
        self, force: float, measured: Measured, position_reference: float, velocity_reference: float
    ) -> IntArray:
        """Return the valve commands for the next sampling period, side A first.

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
            If any input is not finite; all valves are then to be shut, and the state is.
        """
        numbers = [force, position_reference, velocity_reference, measured.position]
        numbers += [measured.velocity, measured.pressure_a, measured.pressure_b]
        numbers += [measured.pressure_low, measured.pressure_high, *measured.converters]
        if not np.isfinite(numbers).all() or len(measured.converters) != self._converters:
            self._states = (0, 0)
            raise MptuneError("the force controller was given a value that is not finite")
        error = position_reference - measured.position
        self._stopped = bool(stopped(self._stopped, error, velocity_reference, self._signals))
        if self._stopped:
            self._states = (0, 0)
        else:
            self._states = decide(
                force,
                measured.pressure_a,
                measured.pressure_b,
                measured.position,
                measured.velocity,
                line_pressures(measured.pressure_low, measured.pressure_high, self._space),
                np.asarray(measured.converters, np.float64),
                *self._states,
                self._space,
                self._settings,
            )
        return np.concatenate([self._space.valves[state] for state in self._states])
