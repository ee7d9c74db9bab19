"""The position after a step of the load force, against explicit steps and the frequency domain."""

import numpy as np
import pytest

from mptune.loops.family import FamilyLoops
from mptune.params.pack import pack_filters
from mptune.params.packed import NO_PATH, LoopGains, Plants
from mptune.sim.response import load_step, position_step

SHARE = 4 / 7
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
PLANT = (24500.0, 0.0125, 0.0122, 0.0089)
HEAVY = (49000.0, 0.0215, 0.0001, 0.0119)


def family(*plants, gains=GAINS, path=NO_PATH):
    rows = np.array([(*plant, SHARE) for plant in plants])
    return FamilyLoops(Plants(*rows.T.copy()), gains, path)


def stepped(plant, gains, path, end, step):
    """Return the same by small explicit steps with buffers, written for the test."""
    mass, delay, tau_a, tau_b = plant
    count, behind = round(end / step), round(delay / step)
    sample, pole = path.sample_time, path.filter_pole
    every = round(sample / step) if sample else 0
    given, x_past = np.zeros(count), np.zeros(count + 1)
    y, a, b, v, x = np.zeros(count + 1), 0.0, 0.0, 0.0, 0.0
    lag1 = lag2 = integral = 0.0
    corner = gains.tau * gains.omega
    for k in range(count):
        x_past[k] = x
        if every:
            before, raw = (y[k - every], x_past[k - every]) if k >= every else (0.0, 0.0)
            y[k] = pole * before + (1 - pole) * raw
            taps = [y[k - n * every] if k >= n * every else 0.0 for n in range(6)]
            velocity = np.dot([5, 3, 1, -1, -3, -5], taps) / (35 * sample)
        else:
            y[k], velocity = x, v
        error = -y[k]
        damped = 2 * gains.xi / corner
        shape = (error - 2 * lag1 + lag2) / corner**2 + damped * (lag1 - lag2) + lag2
        outer = gains.k_p_pos * shape + gains.k_i_pos * integral
        given[k] = gains.k_p_vel * (outer - velocity)
        fed = given[k - behind] if k >= behind else 0.0
        force = SHARE * a + (1 - SHARE) * b - 1.0
        lag1, lag2 = (
            lag1 + step * (error - lag1) / gains.tau,
            lag2 + step * (lag1 - lag2) / gains.tau,
        )
        integral += step * error
        a, b = a + step * (fed - a) / tau_a, b + step * (fed - b) / tau_b
        x, v = x + step * v, v + step * force / mass
    x_past[count] = x
    return x_past


@pytest.mark.parametrize("path", ["none", "filters"])
def test_small_explicit_steps_come_to_the_same(boom, path):
    """Two step sizes of first order, extrapolated to none."""
    way = NO_PATH if path == "none" else pack_filters(boom.study.controller)
    end, step = 0.4, 2.5e-5
    coarse, fine = (stepped(PLANT, GAINS, way, end, h) for h in (step, step / 2))
    expected = 2 * fine[::2] - coarse
    time = np.arange(len(coarse)) * step
    found = load_step(family(PLANT, path=way), time)[0]
    error = np.abs(found - expected).max() / np.abs(expected).max()
    print(f"path {path}: largest difference {error:.1e} of the peak")
    assert error < 2e-4


@pytest.mark.compiled  # long without it
def test_integral_action_brings_it_to_zero_and_its_absence_to_the_stiffness():
    time = np.linspace(0, 8, 801)
    whole = load_step(family(PLANT, HEAVY), time)
    peak = np.abs(whole).max(axis=1)
    print(f"peaks {peak} m/N, at the end {np.abs(whole[:, -1])}")
    assert np.all(np.abs(whole[:, -1]) < 1e-4 * peak)
    rigid = load_step(family(PLANT, HEAVY, gains=GAINS._replace(k_i_pos=0.0)), time)
    stiffness = GAINS.k_p_vel * GAINS.k_p_pos
    np.testing.assert_allclose(rigid[:, -1], -1 / stiffness, rtol=1e-6)


def test_a_positive_load_pushes_against_positive_motion_from_the_first_instant():
    time = np.linspace(0, PLANT[1], 30)
    found = load_step(family(PLANT), time)[0]
    np.testing.assert_allclose(found, -0.5 * time**2 / PLANT[0], rtol=1e-9, atol=1e-20)


def test_load_is_the_reference_step_through_the_inverse_of_the_controller():
    """x/r = C G/(1 + L) and x/F_load = −P/(1 + L) differ by the factor −P/(C G), in frequency."""
    gains = GAINS._replace(k_i_pos=0.0)
    time = np.linspace(0, 6, 24001)
    load = load_step(family(PLANT, gains=gains), time)[0]
    step = position_step(family(PLANT, gains=gains), time)[0]
    omega = 8.0
    kernel = np.exp(-1j * omega * time)
    # jω times the transform of a step's answer is the transfer function; tails are constant.
    transform = [
        1j * omega * np.trapezoid((one - one[-1]) * kernel, time) + one[-1] for one in (load, step)
    ]
    s = 1j * omega
    _, k_p, _, corner, xi, tau = gains
    shaped = k_p * (s**2 / corner**2 + 2 * xi * s / corner + 1) / (tau * s + 1) ** 2
    _, delay, tau_a, tau_b = PLANT
    lag = SHARE / (tau_a * s + 1) + (1 - SHARE) / (tau_b * s + 1)
    expected = -transform[1] / (gains.k_p_vel * shaped * lag * np.exp(-s * delay))
    assert transform[0] == pytest.approx(expected, rel=1e-4)


def test_the_load_step_does_not_care_for_the_plants_beside_it():
    time = np.linspace(0, 1, 50)
    both = load_step(family(PLANT, HEAVY), time)
    for row, plant in enumerate((PLANT, HEAVY)):
        alone = load_step(family(plant), time)
        np.testing.assert_array_equal(both[row], alone[0])
