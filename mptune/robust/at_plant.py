"""The loop gain of one plant over frequency: Eq. 15's, the same as it runs, or a measured one's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault, InputError
from mptune.loops.broken import loop_around
from mptune.loops.sampled import coefficient_count, sampled_loop, sampled_plant
from mptune.loops.velocity import plant_at

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray, FloatArray
    from mptune.loops.family import FamilyLoops
    from mptune.params.packed import LoopGains, MeasurementPath
    from mptune.robust.measured import ForceResponse, Members


def loop_as_it_runs(omega: FloatArray, loops: FamilyLoops, period: float) -> ComplexArray:
    """Return the loop gain at F_ref of a family of one, sampled at ``period`` [s], ``(F,)``."""
    plant = plant_at(loops.plants, 0)
    size = coefficient_count(plant.delay, loops.path, period)
    sampled = sampled_plant(plant, loops.path, period, size)
    return np.asarray(sampled_loop(1j * omega, sampled, loops.gains, period))


def loop_around_measured(
    which: int,
    omega: FloatArray,
    response: ForceResponse,
    mass: float,
    gains: LoopGains,
    path: MeasurementPath,
) -> ComplexArray:
    """Return the loop gain around a measured force response and a mass [kg], ``(F,)``.

    ``which`` is ``VELOCITY``, ``POSITION`` or ``FORCE``; NaN outside the measured band.
    """
    s = np.asarray(1j * omega, np.complex128)
    return np.asarray(loop_around(which, s, response.at(omega) / (mass * s), mass, gains, path))


def named_response(members: Members | None, name: str) -> ForceResponse:
    """Return a measured response by its name.

    Raises
    ------
    InputError
        If none has it.
    """
    responses = members.responses if members else ()
    for one in responses:
        if one.name == name:
            return one
    known = ", ".join(one.name for one in responses) or "none was measured"
    raise no_loop("plant", name, known)


def no_loop(key: str, value: str | None, remedy: str) -> InputError:
    """Return the refusal of a loop that the model does not have."""
    return InputError("to_control", Fault(key, repr(value), "names no loop of the model", remedy))
