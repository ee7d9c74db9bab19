"""Guaranteed bounds over all frequencies against dense evaluation."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mptune.shape import certificate
from mptune.shape.certificate import supremum
from mptune.shape.deviation import Deviation
from mptune.shape.problem import Function
from mptune.shape.rational import RationalPlant
from mptune.shape.rational_loops import ClosedLoop, RationalLoops
from mptune.shape.taylor import Line
from mptune.shape.winding import axis_end, count_closed_poles

FLOOR = 1e-9


def dense(plants, extra=()):
    """Frequencies over all decades, and about every light root of the plants."""
    parts = [np.geomspace(1e-6, 1e6, 20_000), *extra]
    for plant in plants:
        for root in [*plant.poles, *plant.zeros]:
            if abs(root.imag) > 0:
                away = np.geomspace(1e-8, 0.9, 1000)
                parts += [abs(root.imag) * (1 - away), abs(root.imag) * (1 + away)]
    return np.unique(np.concatenate(parts))


def values(plant, controller, omega):
    """|S|, |T| and |CS| by their definitions."""
    s = 1j * omega
    c = np.polyval(controller[0], s) / np.polyval(controller[1], s)
    loop = plant(s) * c
    return {
        Function.SENSITIVITY: np.abs(1 / (1 + loop)),
        Function.COMPLEMENTARY: np.abs(loop / (1 + loop)),
        Function.CONTROL: np.abs(c / (1 + loop)),
    }


stable_real = st.floats(0.05, 20).map(lambda size: -size)
light = st.tuples(st.floats(1e-5, 0.5), st.floats(0.3, 20)).map(
    lambda mode: mode[1] * complex(-mode[0], np.sqrt(1 - mode[0] ** 2))
)
plants = st.builds(
    lambda zeros, poles, modes, integrators, gain, delay: RationalPlant(
        zeros,
        [*poles, *modes, *(mode.conjugate() for mode in modes), *[0.0] * integrators],
        gain,
        delay,
    ),
    st.lists(stable_real | st.floats(0.05, 20), max_size=1),
    st.lists(stable_real, min_size=2, max_size=3),
    st.lists(light, max_size=1),
    st.integers(0, 1),
    st.floats(0.01, 10),
    st.floats(0, 2),
)
gains = st.just(0.0) | st.floats(1e-6, 0.5)
controllers = st.tuples(gains, gains, gains).map(lambda x: ([x[2], x[0], x[1]], [0.02, 1.0, 0.0]))


@settings(max_examples=30, deadline=None)
@given(plant=plants, controller=controllers)
def test_nothing_exceeds_the_bound_of_a_random_loop(plant, controller):
    loops = RationalLoops([plant], *controller)
    assume(any(controller[0]))
    assume(count_closed_poles(loops).stable[0])
    for function in Function:
        bound = supremum(ClosedLoop(loops, function), axis_end(loops), FLOOR)
        sampled = values(plant, controller, dense([plant], [[max(bound.frequency, 1e-9)]]))
        assert bound.closed
        assert sampled[function].max() <= bound.bound
        assert bound.bound <= max(bound.attained * (1 + 2 * certificate.GAP), FLOOR)
        at = values(plant, controller, np.array([max(bound.frequency, 1e-30)]))
        assert at[function][0] == pytest.approx(bound.attained, rel=1e-6, abs=FLOOR)


@settings(max_examples=60)
@given(plant=plants, controller=controllers, reach=st.floats(1, 30))
def test_the_tail_holds_throughout_the_right_half_plane(plant, controller, reach):
    """Beyond the end of the axis, on half circles about the origin: L itself and all functions."""
    assume(any(controller[0]))
    loops = RationalLoops([plant], *controller)
    omega = axis_end(loops)
    assume(np.isfinite(omega[0]))
    tail = loops.tail(omega)
    half = np.linspace(-np.pi / 2, np.pi / 2, 401)
    s = reach * omega[0] * np.exp(1j * half)
    c = np.polyval(controller[0], s) / np.polyval(controller[1], s)
    loop = plant(s) * c
    assert np.abs(loop - tail.centre[0]).max() <= tail.radius[0]
    expected = {
        Function.SENSITIVITY: 1 / (1 + loop),
        Function.COMPLEMENTARY: loop / (1 + loop),
        Function.CONTROL: c / (1 + loop),
    }
    for function, found in expected.items():
        assert np.abs(found).max() <= ClosedLoop(loops, function).beyond(omega)[0] * (1 + 1e-12)


def test_the_tail_is_sharp_beside_a_growing_pole():
    """|L| of k/(s − p) is k/(ω − p) on the real axis: the bound, to rounding."""
    loops = RationalLoops([RationalPlant([], [3.0], 2.0)], [1.0], [1.0])
    assert loops.tail(np.array([8.0])).radius[0] == pytest.approx(2 / 5, rel=1e-9)


parts = st.builds(complex, st.floats(-2, 2), st.floats(-2, 2))


@given(upper=st.tuples(parts, parts), lower=st.tuples(parts, parts), gamma=st.floats(0.5, 2))
def test_parabolas_are_compared_at_their_top(upper, lower, gamma):
    """Lines without rest: proved exactly where no x in [−1, 1] breaks the inequality."""
    x = np.linspace(-1, 1, 2001)
    excess = np.abs(upper[0] + upper[1] * x) ** 2 - gamma**2 * np.abs(lower[0] + lower[1] * x) ** 2
    assume(abs(excess.max()) > 1e-4)
    lines = [
        Line(np.array([value]), np.array([move]), np.zeros(1)) for value, move in (upper, lower)
    ]
    assert certificate._below(gamma, *lines)[0] == (excess.max() < 0)


def test_the_worst_of_several_plants_is_named():
    plants = [RationalPlant([], [-1.0] * 3, gain, 0.2) for gain in (0.5, 2.0, 1.0)]
    loops = RationalLoops(plants, [1.0, 0.3], [1.0, 0.0])
    bound = supremum(ClosedLoop(loops, Function.SENSITIVITY), axis_end(loops), FLOOR)
    each = [
        values(one, ([1.0, 0.3], [1.0, 0.0]), dense([one]))[Function.SENSITIVITY].max()
        for one in plants
    ]
    assert bound.row == int(np.argmax(each)) == 1
    assert max(each) <= bound.bound
    assert max(each) == pytest.approx(bound.attained, rel=1e-6)


def test_deviation_is_eq_17():
    """max|P_n/P − 1|·|T| with integrators and a light mode that both plants share."""
    mode = complex(-0.01, 4.0)
    poles = [0.0, -2.0, mode, mode.conjugate()]
    nominal = RationalPlant([], poles, 20.0, 0.05)
    members = [RationalPlant([], poles, 24.0, 0.08), RationalPlant([-9.0], [*poles, -9.5], 18.0)]
    controller = [0.3, 0.05], [1.0, 0.0]
    loops = RationalLoops([nominal] * 2, *controller)
    assert count_closed_poles(loops).stable.all()
    bound = supremum(Deviation(nominal, members, *controller), axis_end(loops), FLOOR)
    away = np.geomspace(1e-9, 0.5, 2000)
    about = [bound.frequency * (1 - away), bound.frequency * (1 + away)]
    omega = dense([nominal], about)
    s = 1j * omega
    error = np.max([np.abs(one(s) / nominal(s) - 1) for one in members], axis=0)
    worst = (error * values(nominal, controller, omega)[Function.COMPLEMENTARY]).max()
    assert bound.closed
    assert worst <= bound.bound
    assert worst == pytest.approx(bound.attained, rel=1e-5)


def test_an_improper_controller_has_no_bound_of_control():
    """k_d s without a filter: |CS| of a plant that falls off grows without end."""
    loops = RationalLoops([RationalPlant([], [-1.0, -2.0], 1.0)], [1.0, 1.0], [1.0])
    assert count_closed_poles(loops).stable[0]
    found = supremum(ClosedLoop(loops, Function.CONTROL), axis_end(loops), FLOOR)
    assert found.bound == np.inf
    assert not found.closed


def test_what_ends_early_is_open_and_still_a_bound(monkeypatch):
    loops = RationalLoops([RationalPlant([], [-1.0] * 3, 1.0, 0.5)], [0.5, 0.2], [1.0, 0.0])
    whole = supremum(ClosedLoop(loops, Function.SENSITIVITY), axis_end(loops), FLOOR)
    monkeypatch.setattr(certificate, "_ROUNDS", 2)
    early = supremum(ClosedLoop(loops, Function.SENSITIVITY), axis_end(loops), FLOOR)
    assert not early.closed
    assert early.bound > whole.bound


def test_a_plant_that_does_not_deviate_is_below_the_floor():
    nominal = RationalPlant([], [-1.0, -2.0], 1.0, 0.5)
    controller = [0.3, 0.05], [1.0, 0.0]
    loops = RationalLoops([nominal], *controller)
    found = supremum(Deviation(nominal, [nominal], *controller), axis_end(loops), FLOOR)
    assert found.closed
    assert found.bound <= FLOOR
