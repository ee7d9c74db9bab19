"""The force controller on its own: one call per sampling period."""

import numpy as np
import pytest
from deciding import chosen, states
from recording import Recorder, drive, first_case, rig_of

from mptune.errors import MptuneError
from mptune.force.controller import ForceController, Measured
from mptune.force.search_space import search_space
from mptune.force.select import decide
from mptune.params.pack import pack_force
from mptune.signals.differentiator import differentiated
from mptune.signals.states import FORCE, POSITION_HEARD, VELOCITY_HEARD


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


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"converters": []}, "0 converter positions; its machine has 2 and 4"),
        ({"converters": [0.0] * 5}, "5 converter positions"),
        ({"further_pressures": [5e6]}, "3 chamber pressures and 4 converter"),
    ],
)
def test_a_wrong_number_of_values_is_refused_with_all_valves_shut(boom, change, words):
    controller = ForceController(boom)
    controller.step(3e4, measured(), 0.16, 0.05)
    with pytest.raises(MptuneError, match=words):
        controller.step(3e4, measured(**change), 0.16, 0.05)
    assert controller.states == (0, 0)


class Beside(Recorder):
    """The simulator's own decisions, with a controller beside that sees what they rest on."""

    def __init__(self, rig):
        super().__init__(rig)
        self.controller, self.different, self.met = ForceController(rig.study), 0, set()

    def step(self, inputs):
        decides = len(self.inputs) % self.rig.signals.ticks == 0
        decided, memory = super().step(inputs), self.rig.memory
        if decides:
            heard = memory.outer[[POSITION_HEARD, VELOCITY_HEARD]]
            if self.rig.signals.estimator.mass == 0:
                tick = self.rig.signals.sample_time
                heard = memory.history[0], differentiated(memory.history, tick)
            count, seen = len(memory.converters), memory.filtered
            now = Measured(
                *heard, *seen[1:3], seen[4], seen[3], memory.converters, seen[5 + count :]
            )
            valves = self.controller.step(memory.outer[FORCE], now, *inputs[:2])
            self.different += self.controller.states != tuple(memory.choice)
            assert valves.size == self.rig.space.valves.shape[1] * len(memory.choice)
            self.met.add(self.controller.states)
        return decided


@pytest.mark.parametrize("name", ["four-chamber", "mixed", "boom-2dof"])
@pytest.mark.compiled
def test_it_decides_as_the_simulator_does_whatever_the_machine(load_shape, name):
    move = 'manoeuvre=[{distance="20 mm", duration="0.5 s", rest="0.2 s"}]'
    study = load_shape(name, move)
    rig = rig_of(study, first_case(study, 49000.0))
    beside = Beside(rig)
    drive(rig, beside)
    shut = (0,) * len(study.study.all_chambers)
    assert beside.different == 0
    assert len(beside.met) > 5
    assert shut in beside.met  # it stopped at the end


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
