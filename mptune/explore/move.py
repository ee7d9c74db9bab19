"""One move on the nonlinear machine: the first of the study's, with one seed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.sim.closed_loop import chamber_columns
from mptune.verify.result import CaseStatus
from mptune.verify.verify import Case, rig_of, run_rig

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.study import ResolvedStudy
    from mptune.sim.record import RunRecord
    from mptune.verify.result import CaseResult

_SEED = 1
_STRIDE = 5  # samples from one that is drawn to the next


@dataclass(frozen=True)
class SimulatedMove:
    """One move of one machine under one set of gains, as it is drawn.

    Attributes
    ----------
    case
        The machine, its status and figures of merit.
    time
        ``(T,)`` [s].
    error
        ``(T,)`` position error [m].
    force, force_reference
        ``(T,)`` [N].
    states
        ``(T,)`` numbers of the valve states of each chamber.
    """

    case: CaseResult
    time: FloatArray
    error: FloatArray
    force: FloatArray
    force_reference: FloatArray
    states: tuple[FloatArray, ...]

    @property
    def record(self) -> RunRecord:
        """The record of the move."""
        return self.case.record

    @property
    def words(self) -> str:
        """Peak error, final error, loss and switches in one line."""
        if self.case.status is CaseStatus.NOT_FINITE:
            return "the simulation left all bounds"
        record = self.record
        peak, last = (1e3 * float(one) for one in (np.abs(self.error).max(), self.error[-1]))
        loss = record.energies.loss / (1e3 * record.travel)
        return (
            f"peak error {peak:.2f} mm, at the end {last + 0.0:.2f} mm, loss {loss:.1f} J/mm, "
            f"{record.switches} switches, {self.case.status}"
        )


def machine_for(study: ResolvedStudy, mass: float) -> Case:
    """Return the machine that is moved: of a mass [kg], in the middle of what else may vary."""
    moduli = study.study.oil.bulk_modulus
    return Case(
        mass, study.study.valves.delay, 0.5 * (moduli[0] + moduli[1]), study.study.load.force, _SEED
    )


def simulated_move(study: ResolvedStudy, mass: float) -> SimulatedMove:
    """Return the study's first move, its rest included, on a machine of one mass [kg].

    The same seed draws noise and valve delays for every set of gains, yet the loop is chaotic: what
    differs by less than moves scatter says nothing.
    """
    first = study.study.model_copy(update={"manoeuvre": study.study.manoeuvre[:1]})
    one = study.model_copy(update={"study": first})
    case = machine_for(study, mass)
    rig = rig_of(one, case, first.gains, first.feedforward)
    found = run_rig(one, case, rig, np.random.default_rng(_SEED), 1)
    record, traces = found.record, found.traces
    columns = chamber_columns(found.converters, len(first.all_chambers))
    return SimulatedMove(
        case=found,
        time=record.time[::_STRIDE],
        error=record.error[::_STRIDE],
        force=record.force[::_STRIDE],
        force_reference=record.force_reference[::_STRIDE],
        states=tuple(traces[::_STRIDE, column] for column in columns.states),
    )
