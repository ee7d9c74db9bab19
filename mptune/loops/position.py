"""The position loop: closed velocity loop, its error, and the five-parameter controller (§3.3)."""

from __future__ import annotations

from mptune.arrays import Complex, kernel


@kernel
def closed_velocity(
    s: Complex, velocity: Complex, velocity_loop: Complex, k_p_vel: float
) -> Complex:
    """Return G_pos(s), velocity reference to position, with the velocity loop closed.

    Parameters
    ----------
    s
        Complex frequency [rad/s].
    velocity
        G_vel(s) of Eq. 14 or Eq. 15.
    velocity_loop
        The loop gain, G_vel(s) G_V(s) times the measurement path where there is one.
    k_p_vel
        K_P,vel [N s/m].
    """
    return velocity * k_p_vel / (s * (1 + velocity_loop))  # Eq. 19


@kernel
def position_error(velocity_error: Complex, nominal_velocity_loop: Complex) -> Complex:
    """Return Δ_pos(s) = (G_T,pos − G_N,pos)/G_N,pos.

    With G_T,vel = (1 + Δ_vel) G_N,vel the quotient of Eq. 20 is Δ_vel over the return difference of
    the true velocity loop. A measurement path common to both multiplies the loop gain only.
    """
    return velocity_error / (1 + (1 + velocity_error) * nominal_velocity_loop)  # Eq. 20


@kernel
def position_controller(
    s: Complex, k_p_pos: float, k_i_pos: float, omega: float, xi: float, tau: float
) -> Complex:
    """Return G_P(s), position error to velocity reference [1/s]."""
    shape = (s * s / omega**2 + 2 * xi * s / omega + 1) / (tau * s + 1) ** 2
    return k_p_pos * shape + k_i_pos / s  # Eq. 22
