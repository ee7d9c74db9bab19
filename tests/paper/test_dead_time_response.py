"""Step responses with exact dead time: a case solved by hand, and a second route."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mptune.loops.family import FamilyLoops
from mptune.params.pack import pack_gains
from mptune.params.packed import NO_PATH, Plants
from mptune.params.paper import PUBLISHED_GAINS
from mptune.sim.response import position_step, velocity_step

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

SHARE_A = 4 / 7
GAINS = pack_gains(PUBLISHED_GAINS)


def one_plant(mass, delay, tau_a, tau_b):
    return Plants(*(np.array([value]) for value in (mass, delay, tau_a, tau_b, SHARE_A)))


def loops(plants, **changes):
    return FamilyLoops(plants, GAINS._replace(**changes), NO_PATH)


def test_integrator_with_dead_time_follows_the_method_of_steps():
    gain, time = 2.0, np.linspace(0, 3, 3001)
    found = velocity_step(loops(one_plant(1.0, 1.0, 0.0, 0.0), k_p_vel=gain), time)[0]
    by_hand = np.select(
        [time <= 1, time <= 2], [0 * time, gain * (time - 1)], gain * (time - 1)
    ) - np.where(time > 2, gain**2 * (time - 2) ** 2 / 2, 0)
    error = np.abs(found - by_hand).max()
    print(f"largest error of y(t) = K(t-1) - K²(t-2)²/2: {error:.1e}")
    assert error < 1e-6


def command(state, gains, position):
    """Return F_ref from velocity, position and the controller's states, written for the test."""
    _, _, v, x, lag1, lag2, integral = state
    if not position:
        return gains.k_p_vel * (1 - v)
    corner = gains.tau * gains.omega
    error = 1 - x
    shape = (error - 2 * lag1 + lag2) / corner**2 + 2 * gains.xi / corner * (lag1 - lag2) + lag2
    return gains.k_p_vel * (gains.k_p_pos * shape + gains.k_i_pos * integral - v)


def method_of_steps(plant, gains, end, *, position):
    """Return the solution as a function of time, interval of one dead time by interval."""
    mass, delay, tau_a, tau_b = plant
    pieces = []
    state = np.zeros(7)
    for k in range(int(np.ceil(end / delay))):

        def slope(time, state, k=k):
            side_a, side_b, v, x, lag1, lag2, _ = state
            force = command(pieces[k - 1](time - delay), gains, position) if k else 0.0
            error = (1.0 if position else 0.0) - x
            return [
                (force - side_a) / tau_a,
                (force - side_b) / tau_b,
                (SHARE_A * side_a + (1 - SHARE_A) * side_b) / mass,
                v,
                (error - lag1) / gains.tau,
                (lag1 - lag2) / gains.tau,
                error,
            ]

        span = (k * delay, (k + 1) * delay)
        solved = solve_ivp(slope, span, state, "Radau", rtol=1e-9, atol=1e-12, dense_output=True)
        pieces.append(solved.sol)
        state = solved.y[:, -1]
    return lambda time: pieces[min(int(time / delay), len(pieces) - 1)](time)


@pytest.mark.parametrize(
    "plant", [(24500.0, 0.0215, 0.0122, 0.0119), (49000.0, 0.011, 0.0001, 0.006)]
)
@pytest.mark.parametrize("position", [False, True])
def test_family_response_agrees_with_an_ode_solver_on_the_method_of_steps(plant, position):
    time = np.linspace(0, 0.5, 51)
    solution = method_of_steps(plant, GAINS, time[-1], position=position)
    expected = np.array([solution(instant)[3 if position else 2] for instant in time])
    plants = one_plant(*plant)
    if position:
        found = position_step(loops(plants), time)[0]
    else:
        found = velocity_step(loops(plants), time)[0]
    error = np.abs(found - expected).max()
    print(f"{plant}, {'position' if position else 'velocity'}: {error:.1e}")
    assert error < 2e-5


def test_unstable_loop_grows():
    unstable = loops(one_plant(24500.0, 0.011, 0.0, 0.0), k_p_vel=3.6e6)  # above m π/(2 d)
    time = np.linspace(0, 3, 301)
    found = velocity_step(unstable, time)
    late, early = np.abs(found[0, time > 2]).max(), np.abs(found[0, time < 1]).max()
    assert late > 2 * early
