"""Four chambers where a run begins, and where their signals and columns stand."""

import numpy as np
import pytest

from mptune.params.pack import pack_chambers, pack_gains, pack_machine
from mptune.plant import machine as plant
from mptune.plant.chambers import chambers_force, place_of
from mptune.sim.closed_loop import CHAMBER_A, CHAMBER_B, STATE_A, STATE_B, chamber_columns
from mptune.sim.memory import chamber_of_signal
from mptune.verify.at_rest import new_memory

pytestmark = pytest.mark.compiled


def test_all_chambers_carry_the_load_and_every_filter_stands_at_them(load_shape):
    study = load_shape("four-chamber")
    machine, more = pack_machine(study, 30e3, 1.2e9, 9700.0), pack_chambers(study)
    memory = new_memory(study, machine, pack_gains(study.study.gains), 0.15)
    assert chambers_force(memory.state, machine, more.table) == pytest.approx(9700)
    assert len(memory.choice) == 4
    assert len(memory.valves.opening) == 4 * study.study.edge_rule.valves
    told = {
        chamber_of_signal(i, 0): value
        for i, value in enumerate(memory.filtered)
        if chamber_of_signal(i, 0) >= 0
    }
    assert told == {i: memory.state[place_of(i, machine)] for i in range(4)}
    assert told[0] == told[2]
    assert told[1] == told[3]


@pytest.mark.parametrize("converters", [0, 4])
def test_signals_and_columns_of_two_chambers_are_the_usual_ones(boom, converters):
    signals = [chamber_of_signal(i, converters) for i in range(5 + converters)]
    assert signals == [-1, 0, 1, -1, -1, *[-1] * converters]
    columns = chamber_columns(converters, 2)
    assert columns.pressures == [CHAMBER_A, CHAMBER_B]
    assert columns.states == [STATE_A, STATE_B]
    machine = pack_machine(boom, 30e3, 1.2e9, 0.0)
    assert [place_of(i, machine) for i in range(2)] == [plant.PRESSURE_A, plant.PRESSURE_B]


def test_columns_of_four_chambers_share_none():
    columns = chamber_columns(0, 4)
    own = [*columns.pressures, *columns.states]
    assert len(set(own)) == 8
    assert max(own) == columns.width - 1
    assert np.all(np.diff(columns.pressures) > 0)
