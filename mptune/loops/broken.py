"""The loop gains of one plant, at the places where an engineer breaks the loop.

::

    x_ref ──►(+)──► G_P ──►(+)──► K_P,vel ──► F_ref ──► G_F e^{−sd} ──► 1/(ms) ──► 1/s ──┬──► x
              ▲ −           ▲ −                                                          │
              │             └───────── Eq. 23 ◄──┬── filter ◄── median ◄─────────────────┤
              └──────────────────────────────────┘                                       │

``VELOCITY``
    the velocity loop alone, position loop open
``POSITION``
    broken at the position error, velocity loop closed
``FORCE``
    both loops closed, broken at F_ref: 1 + L_F = (1 + L_v)(1 + L_p)
``SAMPLED``
    the same as it runs, sampled: see ``mptune.loops.sampled``

Without a measurement path the position and the velocity are taken as they are. A state estimator
hears the force as well, so that no velocity loop separates: ``VELOCITY`` is then the loop at F_ref
with the position controller off, ``POSITION`` the loop broken behind that controller.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import Complex, kernel
from mptune.loops.estimated import estimated_loop
from mptune.loops.position import closed_velocity, position_controller
from mptune.loops.velocity import true_velocity, velocity_controller
from mptune.signals.conditioning import filter_response, median_response
from mptune.signals.differentiator import differentiator_over_s

if TYPE_CHECKING:
    from mptune.params.packed import LoopGains, MeasurementPath, Plant

VELOCITY, POSITION, FORCE, SAMPLED = 0, 1, 2, 3
NAMES = ("velocity", "position", "force")


@kernel
def position_path(s: Complex, path: MeasurementPath) -> Complex:
    """Return the response from position to filtered position; 1 without a path."""
    if path.sample_time == 0:
        return 1 + 0 * s
    median = median_response(s, path.sample_time)
    return median * filter_response(s, path.sample_time, path.filter_pole)


@kernel
def velocity_path(s: Complex, path: MeasurementPath) -> Complex:
    """Return the response from velocity to measured velocity; 1 without a path."""
    return _differentiated(position_path(s, path), s, path)


@kernel
def _differentiated(position: Complex, s: Complex, path: MeasurementPath) -> Complex:
    """Return ``velocity_path`` of a ``position_path``."""
    if path.sample_time == 0:
        return position
    return position * differentiator_over_s(s, path.sample_time)


@kernel
def feedbacks(s: Complex, gains: LoopGains, path: MeasurementPath) -> tuple[Complex, Complex]:
    """Return what every plant of a family shares: K_P,vel times its path, and G_P times its own."""
    heard = position_path(s, path)
    controller = position_controller(
        s, gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi, gains.tau
    )
    inner = velocity_controller(gains.k_p_vel) * _differentiated(heard, s, path)
    return inner, controller * heard


@kernel
def closed_around(
    which: int, s: Complex, velocity: Complex, inner: Complex, outer: Complex, k_p_vel: float
) -> Complex:
    """Return the loop gain of a plant ``velocity`` with its ``feedbacks``, broken at ``which``."""
    if which == VELOCITY:
        return velocity * inner
    if which == POSITION:
        return closed_velocity(s, velocity, velocity * inner, k_p_vel) * outer
    return velocity * (inner + k_p_vel * outer / s)


@kernel
def velocity_loop(s: Complex, velocity: Complex, k_p_vel: float, path: MeasurementPath) -> Complex:
    """Return L_v, the loop gain of the velocity loop around the plant ``velocity``."""
    return velocity * velocity_controller(k_p_vel) * velocity_path(s, path)


@kernel
def position_loop(
    s: Complex, velocity: Complex, gains: LoopGains, path: MeasurementPath
) -> Complex:
    """Return L_p, the loop gain broken at the position error."""
    inner, outer = feedbacks(s, gains, path)
    return closed_around(POSITION, s, velocity, inner, outer, gains.k_p_vel)


@kernel
def loop_around(
    which: int,
    s: Complex,
    velocity: Complex,
    mass: float,
    gains: LoopGains,
    path: MeasurementPath,
) -> Complex:
    """Return the loop gain around one velocity plant, broken at ``which``.

    The mass [kg], which ``velocity`` holds already, is asked for where a state estimator hears the
    force.
    """
    if path.estimator_mass > 0:
        whole = estimated_loop(s, velocity, mass, gains, path, 1.0)
        if which == FORCE:
            return whole
        inner = estimated_loop(s, velocity, mass, gains, path, 0.0)
        return inner if which == VELOCITY else (whole - inner) / (1 + inner)
    if which == VELOCITY:
        return velocity_loop(s, velocity, gains.k_p_vel, path)
    inner, outer = feedbacks(s, gains, path)
    return closed_around(which, s, velocity, inner, outer, gains.k_p_vel)


@kernel
def loop_gain(
    which: int, s: Complex, plant: Plant, gains: LoopGains, path: MeasurementPath
) -> Complex:
    """Return the loop gain of one plant, broken at ``which``."""
    return loop_around(which, s, true_velocity(s, plant), plant.mass, gains, path)
