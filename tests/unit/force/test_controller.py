"""The force controller on its own: one call per sampling period."""

import numpy as np
import pytest
from deciding import chosen, states

from mptune.errors import MptuneError
from mptune.force.controller import ForceController, Measured
from mptune.force.search_space import search_space
from mptune.force.select import decide
from mptune.params.pack import pack_force


def measured(**changes):
    values = {
        "position": 0.15,
        "velocity": 0.05,
        "pressure_a": 7e6,
        "pressure_b": 5e6,
        "pressure_low": 2e6,
        "pressure_high": 14e6,
        "converters": [0.0, 0.01, -0.01, 0.0],
    }
    return Measured(**(values | changes))


def test_it_steps_alone_and_remembers_its_states(boom):
    controller = ForceController(boom)
    for force in (5e3, 3e4, -2e4):
        valves = controller.step(force, measured(), 0.16, 0.05)
        assert valves.shape == (24,)
        assert set(np.unique(valves)) <= {0, 1}
        assert valves[:12].sum() <= 3
        assert valves[12:].sum() <= 3
    assert controller.states != (0, 0)


def test_more_force_is_answered_with_more_pressure_difference(boom):
    """The mean supply that each side is joined to rises on A and falls on B."""
    supplies = np.repeat(np.linspace(2e6, 14e6, 6), 2)
    means = []
    for force in (-15e3, 55e3):
        controller = ForceController(boom)
        for _ in range(3):
            valves = controller.step(force, measured(velocity=0.0), 0.16, 0.05)
        means.append([supplies @ side / max(side.sum(), 1) for side in np.split(valves, 2)])
    print(means)
    assert means[1][0] > means[0][0]
    assert means[1][1] < means[0][1]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    "place", ["force", "position", "velocity", "pressure_a", "pressure_high", "converters"]
)
def test_a_value_that_is_not_finite_is_refused_with_all_valves_shut(boom, place, bad):
    controller = ForceController(boom)
    controller.step(3e4, measured(), 0.16, 0.05)
    assert controller.states != (0, 0)
    change = {} if place == "force" else {place: [0, bad, 0, 0] if place == "converters" else bad}
    with pytest.raises(MptuneError, match="not finite"):
        controller.step(bad if place == "force" else 3e4, measured(**change), 0.16, 0.05)
    assert controller.states == (0, 0)
    assert controller.step(3e4, measured(), 0.16, 0.05).sum() > 0


@pytest.mark.parametrize("count", [0, 3, 5])
def test_a_wrong_number_of_converters_is_refused(boom, count):
    with pytest.raises(MptuneError):
        ForceController(boom).step(3e4, measured(converters=[0.0] * count), 0.16, 0.05)


def test_it_stops_by_eq_9_and_starts_by_eq_10(boom):
    controller = ForceController(boom)
    shut = []
    for error, velocity in [(1e-3, 0), (4e-4, 0), (6e-4, 0), (8e-4, 0), (6e-4, 0), (0, 1e-3)]:
        valves = controller.step(3e4, measured(velocity=0.0), 0.15 + error, velocity)
        shut.append(bool(valves.sum() == 0))
    assert shut == [False, True, True, False, False, False]


@pytest.mark.compiled
def test_two_controllers_do_not_share_their_memory(boom):
    one, other = ForceController(boom), ForceController(boom)
    one.step(3e4, measured(), 0.16, 0.05)
    assert other.states == (0, 0)


@pytest.mark.parametrize(
    "options",
    [
        ('controller.error="huber"', 'controller.loss="path"', "controller.horizon=2"),
        ('controller.force_model="steady-state"', 'controller.weight_compression="60 N/J"'),
    ],
)
def test_it_decides_with_every_option_as_the_kernel_does(load_boom, options):
    study = load_boom(*options)
    controller, settings, space = ForceController(study), pack_force(study), search_space()
    for case in states(40 if hasattr(decide, "py_func") else 3, 18):
        supplies = case["supplies"]
        now = Measured(
            case["x"], case["v"], *case["p"], supplies[0], supplies[5], case["converters"]
        )
        expected = chosen(case | {"present": controller.states}, space, settings)
        controller.step(case["wanted"], now, case["x"] + 0.01, 0.05)
        assert controller.states == expected
