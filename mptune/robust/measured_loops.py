"""Stability and margins of the loops around measured force responses.

The turns of 1 + L about the origin are counted along the measured band, finely interpolated. What
the band leaves out is closed so:

* **Below.** The loop has to be above 2 at the band's start, and its integrators are known to make
  it larger still. The force response is continued with magnitude and delay of its first point, and
  may be off by half anywhere.
* **Above.** The loop has to be below 1/2 at the band's end, and is taken to stay there: nobody
  measured it.

Where this is not so, where interpolation could be off by as much as the distance to the critical
point, or where the phase turns by more than 90° between points and the loop is not certainly below
1, the count is undecided and counts as not stable. Margins are those within the band.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import ComplexArray, FloatArray, frozen, kernel
from mptune.loops.broken import loop_around
from mptune.loops.family import FamilyLoops, nominal_plants
from mptune.loops.stability import PoleCount, poles_of_turns
from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant
from mptune.robust.margins import Margins, measured_margins

if TYPE_CHECKING:
    from mptune.robust.measured import ForceResponse, Members

_FINE = 32  # steps between two measured points
_BELOW = 600  # points of the continuation
_OFF_BELOW = 0.5  # relative error of the continuation
_ARC: ComplexArray = np.exp(1j * np.linspace(0, np.pi / 2, 33))


@kernel
def _loops(
    which: int,
    s: ComplexArray,
    force: ComplexArray,
    mass: float,
    gains: LoopGains,
    path: MeasurementPath,
) -> ComplexArray:
    values = np.empty(len(s), np.complex128)
    for k in range(len(s)):
        values[k] = loop_around(which, s[k], force[k] / (mass * s[k]), mass, gains, path)
    return values


def fine_grid(response: ForceResponse) -> FloatArray:
    """Return the measured frequencies with steps between them, ``((K − 1)·_FINE + 1,)``."""
    place = np.arange((len(response.omega) - 1) * _FINE + 1) / _FINE
    fine = np.exp(np.interp(place, np.arange(len(response.omega)), np.log(response.omega)))
    fine[0], fine[-1] = response.omega[0], response.omega[-1]
    return fine


def count_members(
    which: int, members: Members, gains: LoopGains, path: MeasurementPath
) -> PoleCount:
    """Count each member's closed-loop poles in the right half plane.

    Parameters
    ----------
    which
        ``VELOCITY`` or ``FORCE``.
    members, gains, path
        The measured members, the gains and the measurement path.
    """
    counts = [
        _count(which, response, mass, gains, path)
        for response in members.responses
        for mass in members.masses
    ]
    unstable, decided = zip(*counts, strict=True)
    return PoleCount(frozen(np.array(unstable, np.int64)), frozen(np.array(decided)))


def _count(
    which: int, response: ForceResponse, mass: float, gains: LoopGains, path: MeasurementPath
) -> tuple[int, bool]:
    start = _start(which, response, mass, gains, path)
    if start is None:
        return 0, False
    first = response.omega[0]
    below = np.concatenate([start * _ARC, 1j * np.geomspace(start, first, _BELOW)[1:-1]])
    fine = fine_grid(response)
    s = np.concatenate([below, 1j * fine])
    force = np.concatenate([_continued(response, below), response.at(fine)])
    loop = _loops(which, s, force, mass, gains, path)
    doubt, of_magnitude = np.full((2, len(s)), _OFF_BELOW)
    doubt[len(below) :] = _along(response.doubt)
    of_magnitude[len(below) :] = _along(response.magnitude_doubt)
    size, distance = np.abs(loop), np.abs(1 + loop)
    turned = np.angle((1 + loop[1:]) / (1 + loop[:-1]))
    decided = (
        np.all((doubt * size < distance) | ((1 + of_magnitude) * size < 1))
        and np.all(np.abs(turned) < np.pi / 2)
        and abs(loop[len(below)]) > 2
        and abs(loop[-1]) < 0.5
    )
    count = poles_of_turns(turned.sum(keepdims=True), 1 + loop[-1:], np.array([decided]))
    return max(int(count.unstable[0]), 0), bool(count.decided[0])


def _along(doubt: FloatArray) -> FloatArray:
    """Return a figure of each measured step at every point of the fine grid."""
    return np.append(np.repeat(doubt, _FINE), doubt[-1])


def _continued(response: ForceResponse, s: ComplexArray) -> ComplexArray:
    """Return the force response below the band: magnitude and delay of its first point."""
    first = response.at(response.omega[:1])[0]
    return np.asarray(np.abs(first) * np.exp(np.angle(first) * s / response.omega[0]))


def _start(
    which: int, response: ForceResponse, mass: float, gains: LoopGains, path: MeasurementPath
) -> float | None:
    """Return a radius on whose half circle the loop is its leading term c/s^k, or None."""
    at_once = nominal_plants(NominalPlant(mass, 0.0))
    known = FamilyLoops(at_once, gains, path, which)
    leading = known.leading[0] * abs(response.response[0])
    radius = 0.5 * float(response.omega[0])
    for _ in range(200):
        s: ComplexArray = radius * _ARC
        loop = _loops(which, s, _continued(response, s), mass, gains, path)
        near = np.abs(loop * s**known.integrators / leading - 1) <= 0.5
        if near.all() and np.abs(loop).min() >= 4:
            return radius
        radius *= 0.5
    return None


def member_margins(members: Members, gains: LoopGains, path: MeasurementPath) -> Margins:
    """Return the margins of every member within its band, three loops by M members each."""
    rows = []
    for response in members.responses:
        omega = fine_grid(response)
        force = response.at(omega)
        rows += [measured_margins(omega, force, mass, gains, path) for mass in members.masses]
    return Margins(*np.moveaxis(np.stack(rows, axis=1), 2, 0))
