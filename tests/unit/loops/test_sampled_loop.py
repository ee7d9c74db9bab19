"""The sampled loop against a simulation of its own, built from matrix exponentials and scipy.

The simulation steps through the fast ticks: plant under a held force that arrives late, median as
one sample, filter, Eq. 23, and Eq. 22 as scipy's bilinear transform makes it. Nothing in it comes
from mptune but the numbers.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.signal import cont2discrete, tf2ss

from mptune.loops.broken import FORCE, loop_gain
from mptune.loops.family import FamilyLoops
from mptune.loops.sampled import (
    coefficient_count,
    multipliers,
    sampled_loop,
    sampled_plant,
    stable_as_sampled,
)
from mptune.params.packed import FeedforwardTuple, LoopGains, MeasurementPath, Plant, Plants
from mptune.signals.trajectory import quintic
from mptune.sim.sampled import run_linear

PERIOD, FAST, SHARE_A = 0.01, 0.0005, 4 / 7
PATH = MeasurementPath(FAST, float(np.exp(-FAST / 0.012)), 0.012)
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)

PLANTS = {  # mass [kg], valve and computation [s], τ_A [s], τ_B [s]
    "Sec. 5.1's worst": (24500.0, 0.009, 0.0122, 0.0119),
    "heavy": (49000.0, 0.0071, 0.003, 0.0101),
    "no lag of side A": (24500.0, 0.0043, 0.0, 0.008),
    "no lags, no delay": (24500.0, 0.0, 0.0, 0.0),
    "arrives on a tick": (24500.0, 0.0065, 0.01, 0.004),
    "arrives at the next decision": (24500.0, 0.01, 0.01, 0.004),
    "more than one period late": (24500.0, 0.0165, 0.0122, 0.0119),
    "more than two periods late": (49000.0, 0.02317, 0.005, 0.0),
}


class Simulation:
    """The open loop over one sampling period: s' = F s + G u, measured force y = C s."""

    def __init__(self, plant, gains=GAINS, path=PATH, period=PERIOD):
        self.mass, self.delay, *self.lags = plant
        self.path, self.period = path, period
        self.ticks = round(period / path.sample_time)
        self.whole = int(np.floor(self.delay / period + 1e-9))  # periods until a force arrives
        self.arrives = max(self.delay - self.whole * period, 0.0)
        lag = [gains.tau, 1.0]
        shape = [gains.k_p_pos / gains.omega**2, 2 * gains.xi * gains.k_p_pos / gains.omega]
        numerator = np.polyadd([*shape, gains.k_p_pos, 0], gains.k_i_pos * np.polymul(lag, lag))
        law = tf2ss(numerator, [*np.polymul(lag, lag), 0.0])  # Eq. 22
        self.law = cont2discrete(law, period, "bilinear")[:4]
        self.k_p_vel = gains.k_p_vel
        # forces that are on their way, newest first | plant | last position | filtered | controller
        self.size = (self.whole + 1) + 4 + 1 + 6 + 3
        self.exponentials = {}
        units = np.eye(self.size + 1)  # each column a state and a force
        columns = self._step(units[:-1], units[-1])
        self.f, self.g = columns[:, :-1], columns[:, -1]
        self.c = self._measured(np.eye(self.size))

    def _parts(self, states):
        return np.split(states, np.cumsum([self.whole + 1, 4, 1, 6]))

    def _measured(self, states):
        """Return K_P,vel (velocity + G_P position), as the controller reads both."""
        *_, filtered, law = self._parts(states)
        velocity = np.dot([5, 3, 1, -1, -3, -5], filtered) / (35 * self.path.sample_time)  # Eq. 23
        _, _, c, d = self.law
        return self.k_p_vel * (velocity + (c @ law)[0] + d[0, 0] * filtered[0])

    def _step(self, states, force):
        """Return the states, one per column, one period later; ``force`` is decided now."""
        ahead, plant, last, filtered, law = (part.copy() for part in self._parts(states))
        a, b, *_ = self.law
        law = a @ law + b * filtered[0]
        ahead = np.vstack([force, ahead])
        before, after = ahead[-1], ahead[-2]
        fast, pole = self.path.sample_time, self.path.filter_pole
        last[0] = plant[3]
        for tick in range(self.ticks):
            low, high = tick * fast, (tick + 1) * fast
            border = min(max(self.arrives, low), high)
            plant = self._advance(plant, before, border - low)
            plant = self._advance(plant, after, high - border)
            filtered = np.vstack([pole * filtered[0] + (1 - pole) * last[0], filtered[:-1]])
            last[0] = plant[3]
        return np.vstack([ahead[:-1], plant, last, filtered, law])

    def _advance(self, plant, force, time):
        """Advance side A, side B, velocity and position under a held force."""
        shares = (SHARE_A, 1 - SHARE_A)
        key = round(time, 12)
        if key not in self.exponentials:
            rates = np.zeros((5, 5))
            for side, (share, lag) in enumerate(zip(shares, self.lags, strict=True)):
                if lag > 0:
                    rates[side, side], rates[side, 4] = -1 / lag, 1 / lag
                    rates[2, side] = share / self.mass
                else:
                    rates[2, 4] += share / self.mass
            rates[3, 2] = 1.0
            self.exponentials[key] = expm(rates * time)
            self.exponentials[key][:2][np.array(self.lags) == 0] = 0.0  # no state of that side
        return (self.exponentials[key] @ np.vstack([plant, force]))[:4]

    @property
    def monodromy(self):
        """The closed loop's map over one period: u = −y."""
        return self.f - np.outer(self.g, self.c)

    def response(self, omega, settle=300, fitted=900):
        """Return y over u, from a run with u = exp(jωkT), drift of the integrators fitted."""
        turn = np.exp(1j * omega * self.period)
        state, measured = np.zeros(self.size, complex), []
        for k in range(settle + fitted):
            measured.append(self.c @ state)
            state = self.f @ state + self.g * turn**k
        k = np.arange(settle, settle + fitted)
        drift = (k - k.mean()) / fitted
        basis = np.stack([turn**k, *(drift**power for power in range(3))], axis=1)
        values = np.array(measured[settle:])
        found, *_ = np.linalg.lstsq(basis, values, rcond=None)
        assert np.abs(basis @ found - values).max() < 1e-6 * np.abs(values).max()
        return found[0]


def with_hold(plant, period=PERIOD):
    """Return the plant with its total delay: what is given holds valve and computation alone."""
    mass, delay, tau_a, tau_b = plant
    return Plant(mass, delay + period / 2, tau_a, tau_b, SHARE_A)


def as_sampled(plant, path=PATH, period=PERIOD):
    true = with_hold(plant, period)
    return sampled_plant(true, path, period, coefficient_count(true.delay, path, period))


def family(*plants, gains=GAINS, path=PATH, period=PERIOD):
    """Return the loops around some plants."""
    columns = np.array([with_hold(plant, period) for plant in plants]).T.copy()
    return FamilyLoops(Plants(*columns), gains, path)


@pytest.mark.parametrize("name", PLANTS)
def test_the_response_is_that_of_a_simulation_in_time(name):
    simulation, plant = Simulation(PLANTS[name]), as_sampled(PLANTS[name])
    decibel, degrees = [], []
    for omega in np.geomspace(1, 300, 12):
        ratio = sampled_loop(1j * omega, plant, GAINS, PERIOD) / simulation.response(omega)
        decibel.append(abs(20 * np.log10(abs(ratio))))
        degrees.append(abs(np.degrees(np.angle(ratio))))
    print(f"{name}: {max(decibel):.1e} dB, {max(degrees):.1e}° over 1..300 rad/s")
    assert max(decibel) < 0.1
    assert max(degrees) < 1.0
    assert max(decibel) < 1e-4  # nothing is approximated
    assert max(degrees) < 1e-3


def worst_mismatch(plant, gains=GAINS, path=PATH, period=PERIOD, outside=0):
    """Return the largest relative difference of both characteristic polynomials off the roots.

    ``outside`` integrators are in the simulation but not in the loop.
    """
    simulation = Simulation(plant, gains, path, period)
    found = multipliers(family(plant, gains=gains, path=path, period=period), period)[0]
    points = np.concatenate([radius * np.exp(1j * np.linspace(0.1, 6, 7)) for radius in (0.9, 1.3)])
    worst = 0.0
    for z in points:
        expected = np.linalg.det(z * np.eye(simulation.size) - simulation.monodromy)
        expected /= (z - 1) ** outside * z ** (simulation.size - outside - len(found))
        worst = max(worst, abs(np.prod(z - found) / expected - 1))
    return worst


@pytest.mark.parametrize("name", PLANTS)
def test_multipliers_are_the_eigenvalues_of_a_simulated_period(name):
    expected = np.linalg.eigvals(Simulation(PLANTS[name]).monodromy)
    found = multipliers(family(PLANTS[name]), PERIOD)[0]
    slow = expected[np.abs(expected) > 0.5]
    distance = np.abs(slow[:, None] - found).min(axis=1).max()
    mismatch = worst_mismatch(PLANTS[name])
    print(f"{name}: largest distance {distance:.1e}, polynomials differ by {mismatch:.1e}")
    assert distance < 1e-6
    assert mismatch < 1e-7
    assert np.sum(np.abs(found) > 0.5) == len(slow)


GAINS_AT_RANDOM = st.builds(
    LoopGains,
    st.floats(5e4, 2e6),
    st.floats(0.5, 40.0),
    st.floats(0.1, 100.0),
    st.floats(10.0, 120.0),
    st.floats(0.0, 1.5),
    st.floats(0.002, 0.03),
)
PLANTS_AT_RANDOM = st.tuples(
    st.floats(5e3, 1e5),
    st.sampled_from([0.0, 0.0005, 0.01, 0.02]) | st.floats(0.0, 0.03),
    st.just(0.0) | st.floats(1e-4, 0.02),
    st.just(0.0) | st.floats(1e-4, 0.02),
)


@given(plant=PLANTS_AT_RANDOM, gains=GAINS_AT_RANDOM, ticks=st.sampled_from([1, 2, 7, 20]))
def test_any_plant_has_the_multipliers_of_its_simulation(plant, gains, ticks):
    fast = PERIOD / ticks
    path = MeasurementPath(fast, float(np.exp(-fast / 0.012)), 0.012)
    assert worst_mismatch(plant, gains, path) < 1e-6


@pytest.mark.parametrize(("k_p_pos", "outside"), [(13.0, 1), (0.0, 2)])
def test_integrators_outside_the_loop_do_not_make_it_unstable(k_p_pos, outside):
    gains = GAINS._replace(k_p_pos=k_p_pos, k_i_pos=0.0)
    plant = PLANTS["Sec. 5.1's worst"]
    assert worst_mismatch(plant, gains, outside=outside) < 1e-6
    for factor, expected in ((1.0, True), (3.0, False)):
        loops = family(plant, gains=gains).scaled(factor)
        stable, sure = stable_as_sampled(loops, PERIOD)
        assert stable[0] == expected
        assert sure[0]


def test_each_plant_of_a_family_is_judged_as_if_alone():
    plants = list(PLANTS.values())
    together = multipliers(family(*plants), PERIOD)
    for row, plant in zip(together, plants, strict=True):
        alone = multipliers(family(plant), PERIOD)[0]
        assert np.abs(row).max() == pytest.approx(np.abs(alone).max(), rel=1e-9)


def limit(grows):
    """Return the factor on the gain at which a loop begins to grow, to 1e-4."""
    low, high = 0.2, 6.0
    while high / low > 1 + 1e-4:
        middle = (low * high) ** 0.5
        low, high = (low, middle) if grows(middle) else (middle, high)
    return low


@pytest.mark.compiled
@pytest.mark.parametrize("name", PLANTS)
def test_the_stability_limit_is_where_the_simulated_movement_begins_to_grow(name):
    plant, ticks = PLANTS[name], 60_000
    rest = [1.25, 0.07, 0.0, 0.0, 0.0, 0.0, 0.0]
    move, plain = np.vstack([quintic(0.07, 1.25), rest]), FeedforwardTuple(0, 0, 0)

    def swings(factor):
        gains = GAINS._replace(k_p_vel=factor * GAINS.k_p_vel)
        one = with_hold(plant)
        reference, position, *_ = run_linear(one, gains, PATH, PERIOD, move, plain, ticks)
        error = np.abs(reference - position)
        early, late = error[20_000:25_000].max(), error[55_000:].max()
        return not np.isfinite(late) or late > max(early, 1e-9)

    def unstable(factor):
        return not stable_as_sampled(family(plant).scaled(factor), PERIOD)[0][0]

    in_time, by_multipliers = limit(swings), limit(unstable)
    print(f"{name}: {in_time:.4f} in time, {by_multipliers:.4f} by multipliers")
    assert by_multipliers == pytest.approx(in_time, rel=0.005)


@pytest.mark.parametrize("name", ["Sec. 5.1's worst", "no lag of side A"])
def test_sampled_ever_faster_it_tends_to_the_continuous_loop(name):
    omega = np.geomspace(1, 30, 12)
    errors = []
    for period in (0.01, 0.005, 0.0025, 0.00125):
        fast = period / 5
        path = MeasurementPath(fast, float(np.exp(-fast / 0.012)), 0.012)
        sampled, true = as_sampled(PLANTS[name], path, period), with_hold(PLANTS[name], period)
        ratios = [
            sampled_loop(1j * w, sampled, GAINS, period)
            / loop_gain(FORCE, 1j * w, true, GAINS, path)
            for w in omega
        ]
        errors.append(np.abs(np.array(ratios) - 1).max())
    print(f"{name}:", ", ".join(f"{error:.1e}" for error in errors))
    assert errors[-1] < 1e-4
    quotients = np.array(errors[:-1]) / errors[1:]
    assert np.all(quotients > 3.8)  # of second order in the sampling period
