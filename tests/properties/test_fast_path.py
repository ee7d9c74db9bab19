"""The compiled equations against python-control, which knows nothing of mptune.

Rational parts are ``control`` transfer functions evaluated at s = jω; dead times are multiplied on
as e^{−jωd}. Both routes are right to a few units in the last place of each *term*, but Eq. 16, 20
and 22 subtract terms that may nearly cancel, and Eq. 19 divides by 1 + L, which may nearly vanish.
A difference of two routes is therefore held against what the terms add up to in modulus, times
(1 + |L|)/|1 + L| for every return difference divided by: that is the size to which rounding is
amplified in any order of evaluation. Against the result itself no fixed tolerance could hold.
"""

from __future__ import annotations

import control
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mptune.loops.broken import FORCE, POSITION, VELOCITY, loop_gain
from mptune.loops.family import FamilyLoops
from mptune.loops.force_dynamics import force_dynamics
from mptune.loops.position import position_controller, position_error
from mptune.loops.velocity import nominal_velocity, true_velocity, velocity_error
from mptune.params.packed import NO_PATH, LoopGains, MeasurementPath, NominalPlant, Plant, Plants
from mptune.robust.condition import sides

TOLERANCE = 1e-9
SAMPLE = 0.0005
FILTERS = MeasurementPath(SAMPLE, float(np.exp(-SAMPLE / 0.012)), 0.012)

frequencies = st.floats(0.1, 3000.0)
masses = st.floats(1e3, 1e5)
delays = st.floats(0.0, 0.05)
lags = st.just(0.0) | st.floats(1e-6, 0.05)
shares = st.floats(0.5, 0.95)
plants = st.builds(Plant, masses, delays, lags, lags, shares)
nominals = st.builds(NominalPlant, masses, delays)
gains = st.builds(
    LoopGains,
    st.floats(1e4, 3e6),
    st.floats(0.1, 50.0),
    st.just(0.0) | st.floats(0.01, 300.0),
    st.floats(5.0, 300.0),
    st.just(0.0) | st.floats(1e-3, 3.0),
    st.floats(0.001, 0.1),
)


def close(found, expected, scale):
    return abs(found - expected) <= TOLERANCE * scale


def amplification(loop):
    return (1 + abs(loop)) / abs(1 + loop)


def reference_force(omega, tau_a, tau_b, share_a):
    lead = share_a * tau_b + (1 - share_a) * tau_a
    return control.tf([lead, 1], np.polymul([tau_a, 1], [tau_b, 1]))(1j * omega)


def reference_velocity(omega, mass, delay, tau_a=0.0, tau_b=0.0, share_a=0.5):
    integrator = control.tf([1], [mass, 0])(1j * omega)
    return reference_force(omega, tau_a, tau_b, share_a) * integrator * np.exp(-1j * omega * delay)


def reference_terms(omega, gain):
    """Return the two terms of Eq. 22."""
    numerator = [1 / gain.omega**2, 2 * gain.xi / gain.omega, 1]
    lag = np.polymul([gain.tau, 1], [gain.tau, 1])
    shape = gain.k_p_pos * control.tf(numerator, lag)
    return shape(1j * omega), gain.k_i_pos * control.tf([1], [1, 0])(1j * omega)


def size_of_terms(omega, gain):
    """Return the moduli of Eq. 22's terms, the numerator's three included, added up."""
    ratio = omega / gain.omega
    numerator = ratio**2 + 2 * gain.xi * ratio + 1
    return gain.k_p_pos * numerator / (1 + (gain.tau * omega) ** 2) + gain.k_i_pos / omega


def reference_path(omega):
    """Return the responses from position to filtered position and to velocity, by z."""
    z = np.exp(1j * omega * SAMPLE)
    pole = FILTERS.filter_pole
    median = control.tf([1], [1, 0], SAMPLE)(z)
    lag = control.tf([1 - pole, 0], [1, -pole], SAMPLE)(z)
    taps = control.tf([5, 3, 1, -1, -3, -5], [35 * SAMPLE, 0, 0, 0, 0, 0], SAMPLE)(z)
    return median * lag, median * lag * taps


@given(frequencies, lags, lags, shares)
def test_force_dynamics(omega, tau_a, tau_b, share_a):
    expected = reference_force(omega, tau_a, tau_b, share_a)
    assert close(force_dynamics(1j * omega, tau_a, tau_b, share_a), expected, abs(expected))


@given(frequencies, plants)
def test_true_velocity(omega, plant):
    expected = reference_velocity(omega, *plant)
    assert close(true_velocity(1j * omega, plant), expected, abs(expected))


@given(frequencies, plants, nominals)
def test_velocity_error_is_the_quotient_of_eq_16(omega, plant, nominal):
    true, believed = reference_velocity(omega, *plant), reference_velocity(omega, *nominal)
    found = velocity_error(1j * omega, plant, nominal)
    assert close(found, (true - believed) / believed, 1 + abs(true / believed))


@given(frequencies, plants, nominals, st.floats(1e4, 3e6))
def test_position_error_is_the_quotient_of_eq_20(omega, plant, nominal, gain):
    s = 1j * omega
    true_loop = reference_velocity(omega, *plant) * gain
    nominal_loop = reference_velocity(omega, *nominal) * gain
    true, believed = (loop / (s * (1 + loop)) for loop in (true_loop, nominal_loop))  # Eq. 19
    error = velocity_error(s, plant, nominal)
    found = position_error(error, nominal_velocity(s, nominal) * gain)
    scale = (1 + abs(true / believed)) * amplification(true_loop) * amplification(nominal_loop)
    assert close(found, (true - believed) / believed, scale)


@given(frequencies, gains)
def test_position_controller(omega, gain):
    terms = reference_terms(omega, gain)
    found = position_controller(1j * omega, *gain[1:])
    assert close(found, sum(terms), size_of_terms(omega, gain))


@given(frequencies, plants, gains, st.sampled_from([NO_PATH, FILTERS]))
def test_loop_gains_at_all_three_places(omega, plant, gain, path):
    s = 1j * omega
    to_position, to_velocity = (1, s) if path is NO_PATH else reference_path(omega)
    velocity = reference_velocity(omega, *plant) * gain.k_p_vel
    inner = velocity * to_velocity / s
    terms, sizes = reference_terms(omega, gain), size_of_terms(omega, gain)
    position = velocity / (s * (1 + inner)) * to_position
    outer = velocity * to_position / s

    def found(which):
        return loop_gain(which, s, plant, gain, path)

    assert close(found(VELOCITY), inner, abs(inner))
    assert close(
        found(POSITION), position * sum(terms), abs(position) * sizes * amplification(inner)
    )
    assert close(found(FORCE), inner + outer * sum(terms), abs(inner) + abs(outer) * sizes)


@given(frequencies, st.lists(plants, min_size=1, max_size=6), nominals, gains)
def test_both_sides_of_eq_17_and_eq_21(omega, family, nominal, gain):
    s = 1j * omega
    true = np.array([reference_velocity(omega, *plant) for plant in family]) * gain.k_p_vel
    believed = reference_velocity(omega, *nominal) * gain.k_p_vel
    closed = true / (s * (1 + true)), believed / (s * (1 + believed))
    terms = reference_terms(omega, gain)
    assume(sum(terms) != 0)  # at ω, undamped and without K_I, Eq. 22 is zero
    loop = closed[1] * sum(terms)
    loops = FamilyLoops(Plants(*np.array(family).T.copy()), gain, NO_PATH)
    found = sides(np.array([omega]), loops, nominal)

    quotients = np.abs(true / believed), np.abs(closed[0] / closed[1])
    scale = (1 + quotients[0]).max()
    assert close(found.left[0, 0], np.abs((true - believed) / believed).max(), scale)
    scale = (1 + quotients[1].max()) * amplification(true).max() * amplification(believed)
    assert close(found.left[1, 0], np.abs((closed[0] - closed[1]) / closed[1]).max(), scale)
    assert close(found.right[0, 0], abs((1 + believed) / believed), 1 + 1 / abs(believed))
    cancelled = size_of_terms(omega, gain) / abs(sum(terms))
    scale = (1 + 1 / abs(loop)) * amplification(believed) * cancelled
    assert close(found.right[1, 0], abs((1 + loop) / loop), scale)


@pytest.mark.compiled
def test_compiled_kernels_are_the_interpreted_ones():
    random = np.random.default_rng(3)
    gain = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
    for _ in range(50):
        s = complex(random.uniform(-5, 5), random.uniform(0.1, 1000))
        plant = Plant(*random.uniform((2e4, 0, 0, 0, 0.5), (5e4, 0.02, 0.012, 0.012, 0.9)))
        for which in (VELOCITY, POSITION, FORCE):
            for path in (NO_PATH, FILTERS):
                compiled = loop_gain(which, s, plant, gain, path)
                assert compiled == pytest.approx(
                    loop_gain.py_func(which, s, plant, gain, path), rel=1e-13
                )
