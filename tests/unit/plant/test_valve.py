"""Valves: delay, ramp, order of commands, and who is at rest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from opened import opened

from mptune.force.search_space import search_space
from mptune.params.packed import OPEN_A, OPEN_B, SHARE
from mptune.plant.valve import PENDING, advance, command, open_valves, quiet, shut_valves

RAMP = 2e-3
# Instants fall between the steps of a millisecond as well as on them.
commands = st.lists(
    st.tuples(
        st.integers(0, 3), st.sampled_from([0.0, 1.0]), st.integers(0, 80), st.integers(0, 120)
    ),
    min_size=1,
    max_size=20,
)


def replay(orders, edges):
    """Give each order (valve, wanted, time, delay; in 0.1 ms) and step over the edges [s]."""
    valves, pending, now = shut_valves(), sorted(orders, key=lambda order: order[2]), 0.0
    for edge in edges:
        while pending and pending[0][2] * 1e-4 <= now + 1e-12:
            valve, wanted, time, delay = pending.pop(0)
            command(valves, valve, wanted, (time + delay) * 1e-4)
        advance(valves, now, edge - now, RAMP)
        now = edge
    return valves


@pytest.mark.parametrize("wanted", [1.0, 0.0])
def test_a_command_takes_hold_after_its_delay_and_ramps_linearly(wanted):
    valves = shut_valves()
    valves.opening[5] = valves.target[5] = valves.commanded[5] = 1 - wanted
    command(valves, 5, wanted, 4e-3)
    found = []
    for tick in range(80):
        found.append(valves.opening[5])
        advance(valves, tick * 1e-4, 1e-4, RAMP)
    share = np.clip((np.arange(80) * 1e-4 - 4e-3) / RAMP, 0, 1)
    np.testing.assert_allclose(found, share if wanted else 1 - share, atol=1e-9)
    assert valves.opening[:5].sum() + valves.opening[6:].sum() == 0


def test_a_command_due_between_steps_starts_at_its_own_instant():
    valves = shut_valves()
    command(valves, 0, 1.0, 0.37e-3)
    advance(valves, 0.0, 1e-3, RAMP)
    assert valves.opening[0] == pytest.approx(0.63e-3 / RAMP, rel=1e-12)


def test_pending_commands_take_hold_in_the_order_given():
    """Opened at 3 ms, shut at 6 ms: a pulse of 3 ms; a later command never overtakes."""
    valves = shut_valves()
    command(valves, 0, 1.0, 3e-3)
    command(valves, 0, 0.0, 6e-3)
    seen = []
    for tick in range(10):
        advance(valves, tick * 1e-3, 1e-3, RAMP)
        seen.append(valves.opening[0])
    np.testing.assert_allclose(seen, [0, 0, 0, 0.5, 1, 1, 0.5, 0, 0, 0], atol=1e-12)


def test_a_later_command_with_a_shorter_delay_waits_for_the_earlier_one_and_wins():
    valves = shut_valves()
    command(valves, 0, 1.0, 8e-3)
    command(valves, 0, 0.0, 2e-3)
    opening = []
    for tick in range(14):
        advance(valves, tick * 1e-3, 1e-3, RAMP)
        opening.append(valves.opening[0])
    assert opening == [0.0] * 14
    assert valves.target[0] == 0.0
    assert valves.counters[1] == 0


def test_a_command_during_the_ramp_turns_it_round():
    valves = shut_valves()
    command(valves, 0, 1.0, 0.0)
    advance(valves, 0.0, 1e-3, RAMP)
    command(valves, 0, 0.0, 1e-3)
    advance(valves, 1e-3, 0.5e-3, RAMP)
    assert valves.opening[0] == pytest.approx(0.25)


def test_only_changes_count_as_switches():
    valves = shut_valves()
    for wanted in (0.0, 1.0, 1.0, 0.0, 1.0):
        command(valves, 3, wanted, 0.0)
    command(valves, 4, 1.0, 0.0)
    assert valves.counters[0] == 4
    assert valves.counters[2:].tolist() == [0, 0, 0, 3, 1, *[0] * 19]


def test_two_valves_of_a_supply_add_up_on_their_own_side():
    valves = shut_valves()
    valves.opening[[4, 5, 6, 12 + 10]] = 1, 0.5, 0.25, 1
    space = search_space()
    table = opened(space.lines, 1.0, 1.0)  # all of another instant
    open_valves(valves, space.edge, space.lines, table)
    assert table[OPEN_A, :4].tolist() == [1.5, 0.25, 0, 0]
    assert table[OPEN_B, :4].tolist() == [0, 0, 1, 0]
    assert table[SHARE, :3].tolist() == [2 / 5, 3 / 5, 1]


def test_a_valve_ends_where_it_was_last_commanded_however_many_commands_are_pending():
    valves = shut_valves()
    for count in range(PENDING + 1):
        command(valves, 0, float(count % 2 == 0), 1e-3 * count)
    advance(valves, 0.0, 0.1, RAMP)
    assert valves.opening[0] == valves.commanded[0] == 1.0


@given(commands)
def test_one_step_or_many_lead_to_the_same_opening(orders):
    """All orders are given first, so that the steps alone differ."""
    first = [(valve, wanted, 0, delay) for valve, wanted, _, delay in orders[:PENDING]]
    once = replay(first, [0.011])
    often = replay(first, np.linspace(0, 0.011, 97)[1:])
    np.testing.assert_allclose(once.opening, often.opening, atol=1e-9)
    np.testing.assert_array_equal(once.target, often.target)
    assert once.counters[0] == often.counters[0]


@given(commands, st.integers(1, 30))
def test_quiet_tells_the_truth(orders, span):
    """Where it says that nothing will move, nothing does; where it does not, something happens."""
    orders = [(order[0] + 4 * place, *order[1:]) for place, order in enumerate(orders[:5])]
    for stop in range(5, 200, 13):
        valves = replay(orders, np.arange(1, stop) * 1e-4)
        now = (stop - 1) * 1e-4
        until = now + span * 1e-4
        said = quiet(valves, until)
        before = valves.opening.copy(), valves.due.copy()
        moved = advance(valves, now, until - now, RAMP)
        opened = not np.array_equal(valves.opening, before[0])
        assert moved or not opened
        if said:
            assert not moved
        else:
            assert moved or not np.array_equal(valves.due, before[1])


@given(commands)
def test_openings_stay_between_shut_and_open_and_settle_on_the_command(orders):
    valves = shut_valves()
    for place, (valve, wanted, time, delay) in enumerate(orders):
        command(valves, valve + 4 * (place % 5), wanted, (time + delay) * 1e-4)
    for tick in range(300):
        advance(valves, tick * 1e-4, 1e-4, RAMP)
        assert valves.opening.min() >= 0
        assert valves.opening.max() <= 1
    np.testing.assert_array_equal(valves.opening, valves.commanded)
    assert quiet(valves, 1.0)
