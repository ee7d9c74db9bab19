"""The study's manoeuvres as one reference."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.signals import trajectory
from mptune.sim.record import CommandedSpeed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import FloatArray
    from mptune.params.manoeuvre import Manoeuvre


class Moves(NamedTuple):
    """A sequence of moves and rests, from position 0."""

    pieces: FloatArray  # (P, 7) see ``mptune.signals.trajectory``
    ends: FloatArray  # (M,) s, when each rest ends
    travel: float  # m, the way of all moves added up
    commands: tuple[CommandedSpeed, ...] = ()  # those moves that are a speed over time

    @property
    def duration(self) -> float:
        """Time of all moves and rests [s]."""
        return float(self.ends[-1])

    @property
    def reach(self) -> float:
        """Largest distance from the start [m]."""
        return float(np.abs(self.sampled(2000)).max())

    def sampled(self, count: int) -> FloatArray:
        """Return ``count`` + 1 positions, evenly spaced in time."""
        times = np.linspace(0, self.duration, count + 1)
        return np.array([trajectory.reference(time, self.pieces)[0] for time in times])


def moves_of(manoeuvres: Sequence[Manoeuvre]) -> Moves:
    """Return manoeuvres one after another."""
    tables, ends, begin, position, travel = [], [], 0.0, 0.0, 0.0
    commands = []
    for move in manoeuvres:
        table = _pieces(move)
        last = trajectory.reference(move.duration, table)[0]
        rest = np.array([[move.duration, last, 0, 0, 0, 0, 0]])
        table = np.concatenate([table, rest])
        travel += _travel(table, move.duration)
        table[:, 0] += begin
        table[:, 1] += position
        tables.append(table)
        position += last
        stop, end = begin + move.duration, begin + move.duration + move.rest
        if move.kind == "velocity":
            commands.append(CommandedSpeed(begin, stop, end, move.speed))
        begin = end
        ends.append(end)
    return Moves(np.concatenate(tables), np.array(ends), travel, tuple(commands))


def _pieces(move: Manoeuvre) -> FloatArray:
    if move.kind == "quintic":
        return trajectory.quintic(move.distance, move.duration)
    if move.kind == "trapezoid":
        return trajectory.trapezoid(move.distance, move.duration, move.ramp_share)
    if move.kind == "s-curve":
        return trajectory.s_curve(move.distance, move.duration, move.ramp_share)
    if move.kind == "sine":
        return trajectory.sine(move.distance, move.duration, move.cycles)
    if move.kind == "velocity":
        return trajectory.trapezoid(move.net_distance, move.duration, move.ramp / move.duration)
    return _spline(move.samples)


def _spline(samples: tuple[tuple[float, float], ...]) -> FloatArray:
    """Return the spline through recorded positions that begins and ends at rest."""
    from scipy.interpolate import CubicSpline

    time, position = np.array(samples).T
    spline = CubicSpline(time - time[0], position - position[0], bc_type="clamped")
    cubic = spline.c[::-1].T  # (P, 4), constant term first
    return np.column_stack([spline.x[:-1], cubic, np.zeros((len(cubic), 2))])


def _travel(table: FloatArray, duration: float) -> float:
    times = np.linspace(0, duration, 1001)
    path = np.array([trajectory.reference(time, table)[0] for time in times])
    return float(np.abs(np.diff(path)).sum())


def distinct_moves(manoeuvres: Sequence[Manoeuvre]) -> tuple[Moves, ...]:
    """Return each different move from rest, for a linear loop.

    There, moves that differ by their distance only have the same index.
    """
    alike = {
        move if move.kind in {"file", "velocity"} else move.model_copy(update={"distance": 1.0})
        for move in manoeuvres
    }
    return tuple(moves_of([move]) for move in sorted(alike, key=repr))
