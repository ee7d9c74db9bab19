"""The compiled controller does what mptune's own does, and shuts all valves on bad input."""

import ctypes
import math

import numpy as np
import pytest
import recording as rec
import target
from hypothesis import given, settings
from hypothesis import strategies as st
from recording import first_case, record_case
from target import EXACT, REPLAY, STRICT, Controller, any_compiler, compile_c, replay

from mptune.export.formats import Precision
from mptune.verify.verify import run_case

pytestmark = pytest.mark.compiled  # they simulate at length

MOVES = (
    'manoeuvre=[{distance="35 mm", duration="0.6 s", rest="0.3 s"},'
    ' {distance="-35 mm", duration="0.5 s", rest="0.2 s"}]'
)
HUBER, PATH, TWO = 'controller.error="huber"', 'controller.loss="path"', "controller.horizon=2"
STEADY = (
    'controller.force_model="steady-state"',
    'controller.weight_switching="400 N"',
    'controller.weight_loss="200 N/J"',
    'controller.weight_compression="60 N/J"',
)
DECISIONS = {
    "huber": (HUBER,),
    "path": (PATH, 'controller.converter_flow="mean"'),
    "two periods": (TWO, "controller.candidates=9"),
    "common mode": ('controller.weight_common_mode="300 N/MPa"',),
    "all": (HUBER, PATH, TWO, 'controller.weight_common_mode="300 N/MPa"',
            'controller.delay_prediction="6.5 ms"'),
    "steady state": STEADY,
    "steady state, two periods": (*STEADY, TWO, HUBER),
}  # fmt: skip
POINTER, STATE, INPUT, NUMERIC = 1, 2, 4, 8
NUMBERS_IN_STATE = 71


@pytest.fixture(scope="module")
def controller(sources, tmp_path_factory):
    place = tmp_path_factory.mktemp("library") / "controller.so"
    flags = (*EXACT, "-shared", "-fPIC")
    return Controller(compile_c(any_compiler(), sources, place, *flags))


def same_decisions(found, recording):
    assert (found[:, target.FAULT] == 0).all()
    assert (found[:, target.FORCE] == recording.decisions[:, rec.FORCE]).all()
    assert (found[:, target.STOPPED] == recording.decisions[:, rec.STOPPED]).all()
    states = recording.decisions[:, [rec.STATE_A, rec.STATE_B]]
    assert (found[:, [target.STATE_A, target.STATE_B]] == states).all()


def replayed(study, folder, *flags, like=None):
    """Replay a simulated case through a study's controller in C; both decide the same."""
    target.write_sources(study, folder / "c", like=like)
    recording = record_case(study, first_case(study, 49000.0))
    program = compile_c(
        any_compiler(), folder / "c", folder / "replay", *flags, *EXACT, extra=[REPLAY]
    )
    found, _ = replay(program, recording, folder)
    same_decisions(found, recording)
    return found, recording


def test_the_recording_is_the_simulator_itself(study, recording):
    case = first_case(study, 24500.0)._replace(seed=study.study.verification.seeds[0])
    once = study.study.model_copy(
        update={"verification": study.study.verification.model_copy(update={"repeats": 1})}
    )
    verified = run_case(
        study.model_copy(update={"study": once}), case, study.study.gains, study.study.feedforward
    )
    assert (verified.traces == recording.trace).all()


def test_every_valve_command_is_mptune_s_own_to_the_last_bit(sources, recording, tmp_path):
    program = compile_c(any_compiler(), sources, tmp_path / "replay", *EXACT, extra=[REPLAY])
    found, _ = replay(program, recording, tmp_path)
    same_decisions(found, recording)
    moving = recording.decisions[:, rec.STATE_A]
    assert len(np.unique(moving)) > 10  # the run is no rest
    every = recording.inputs.shape[0] // 20
    assert found[:, target.DECIDED].sum() == every
    held = np.diff(found[:, target.VALVES], axis=0).any(axis=1)
    assert not held[found[1:, target.DECIDED] == 0].any()


@pytest.mark.parametrize("which", ["full_study", "proportional_study"])
def test_what_the_paper_leaves_off_is_the_same_too(request, prepared, which, tmp_path):
    """Feed-forward, lagged references, delay prediction and the mean flow; no integral."""
    study = request.getfixturevalue(which)
    replayed(study, tmp_path, like=prepared)


def test_estimator_and_feed_forward_are_the_same_too(estimated_study, prepared, tmp_path):
    replayed(estimated_study, tmp_path, like=prepared)


@pytest.mark.parametrize(
    "name", ["three-pressure", "digital-valve", "mixed", "four-chamber", "four-converters"]
)
def test_machines_of_other_sizes_are_the_same_to_the_last_bit(load_shape, name, tmp_path):
    study = load_shape(name, MOVES)
    found, recording = replayed(study, tmp_path, *STRICT)
    states = recording.decisions[:, rec.STATE_A : rec.STATE_A + len(study.study.all_chambers)]
    further = states.shape[1] - 2
    assert (found[:, found.shape[1] - further :] == states[:, 2:]).all()
    assert len(np.unique(states, axis=0)) > 5


@pytest.mark.parametrize("decision", [(), ('controller.force_model="dynamic"', HUBER, PATH)])
def test_four_chambers_two_periods_ahead_are_the_same_to_the_last_bit(
    load_shape, decision, tmp_path
):
    plain = ('controller.weight_compression="0 N/J"',) if decision else ()
    study = load_shape("four-chamber", MOVES, TWO, *decision, *plain)
    found, recording = replayed(study, tmp_path, *STRICT)
    states = recording.decisions[:, rec.STATE_A : rec.STATE_A + 4]
    assert (found[:, found.shape[1] - 2 :] == states[:, 2:]).all()
    assert len(np.unique(states, axis=0)) > 5


@pytest.mark.parametrize("name", DECISIONS)
def test_every_option_of_the_decision_is_the_same_to_the_last_bit(
    load_boom, prepared, name, tmp_path
):
    study = load_boom(MOVES, *DECISIONS[name], corners=True)
    _, recording = replayed(study, tmp_path, like=prepared)
    assert len(np.unique(recording.decisions[:, rec.STATE_A])) > 5


@pytest.mark.parametrize("name", ["all", "steady state, two periods"])
def test_sanitizers_find_nothing_in_any_option(load_boom, prepared, name, tmp_path):
    study = load_boom(MOVES, *DECISIONS[name], corners=True)
    target.write_sources(study, tmp_path / "c", like=prepared)
    recording = record_case(study, first_case(study, 24500.0))
    recording = recording._replace(inputs=recording.inputs[:1000])
    compiler, flags = target.sanitizing()
    program = compile_c(compiler, tmp_path / "c", tmp_path / "replay", *flags, extra=[REPLAY])
    spoilt, _ = replay(program, spoilt_inputs(recording, 1000), tmp_path)
    assert (spoilt[:, target.FAULT] != 0).any()
    assert np.isfinite(spoilt).all()


def test_single_precision_differs_only_where_two_choices_cost_the_same(study, recording, tmp_path):
    """Costs of both precisions differ by F_ref's difference and the rounding of four forces."""
    target.write_sources(study, tmp_path / "c", Precision.FLOAT)
    program = compile_c(any_compiler(), tmp_path / "c", tmp_path / "replay", *EXACT, extra=[REPLAY])
    found, _ = replay(program, recording, tmp_path)
    assert (found[:, target.FAULT] == 0).all()
    error = np.abs(found[:, target.FORCE] - recording.decisions[:, rec.FORCE])
    states = found[:, [target.STATE_A, target.STATE_B]]
    other = (states != recording.decisions[:, [rec.STATE_A, rec.STATE_B]]).any(axis=1)
    assert 0 < other.sum() < 0.05 * len(other)
    first = np.argmax(other)  # from then on the valves that are open differ as well
    more, _ = rec.extra_cost(study, recording.decisions[first], *states[first])
    assert 0 <= more <= 2 * error[first] + target.SINGLE_FORCE


def test_single_precision_moves_the_force_by_what_its_positions_resolve(study, recording, tmp_path):
    """Two roundings in each step of the filter, which keeps them for 1/(1 − pole) steps; Eq. 23."""
    target.write_sources(study, tmp_path / "c", Precision.FLOAT)
    program = compile_c(any_compiler(), tmp_path / "c", tmp_path / "replay", *EXACT, extra=[REPLAY])
    found, _ = replay(program, recording, tmp_path)
    error = np.abs(found[:, target.FORCE] - recording.decisions[:, rec.FORCE])
    resolved = float(np.spacing(np.float32(recording.inputs[:, 3].max())))
    position = resolved / (1 - math.exp(-0.5 / 12))
    velocity = 18 / (35 * 0.5e-3) * position
    assert 0 < error.max() < study.study.gains.k_p_vel * velocity


def spoilt_inputs(recording, count, seed=4):
    """Return recorded inputs with values from everywhere thrown in."""
    random = np.random.default_rng(seed)
    inputs = recording.inputs[:count].copy()
    bad = [np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 0.0, -0.0, 1e12, -1.0]
    rows = random.integers(0, count, count // 4)
    inputs[rows, random.integers(0, 12, len(rows))] = random.choice(bad, len(rows))
    return recording._replace(inputs=inputs)


def test_sanitizers_find_nothing(sources, recording, tmp_path):
    compiler, flags = target.sanitizing()
    program = compile_c(compiler, sources, tmp_path / "replay", *flags, extra=[REPLAY])
    found, _ = replay(program, recording, tmp_path)
    same_decisions(found, recording)
    spoilt, _ = replay(program, spoilt_inputs(recording, 2000), tmp_path)
    faulty = spoilt[:, target.FAULT] != 0
    assert faulty.any()
    assert not spoilt[faulty][:, target.VALVES].any()
    assert np.isfinite(spoilt).all()


def bounds_of(study):
    """Return the accepted range of each input, stated here again."""
    stroke, supplies = study.study.cylinder.stroke, study.study.supplies
    place = (-0.1 * stroke, 1.1 * stroke)
    pressure = (-0.1 * supplies.relief_pressure, 3 * supplies.relief_pressure)
    converter = 1.1 * supplies.converter_travel
    fast = stroke / study.study.controller.sampling_period
    sharp = fast / study.study.controller.sampling_period
    ranges = [place, (-fast, fast), (-sharp, sharp), place, *[pressure] * 4]
    return np.array(ranges + [(-converter, converter)] * 4)


values = st.one_of(
    st.floats(width=64),
    st.sampled_from([math.nan, math.inf, -math.inf, 0.0, -0.0, 0.15, 2e6, 1.4e7, -1.7e6, 4.9e7]),
)


@settings(max_examples=150)
@given(
    rows=st.lists(st.tuples(st.integers(0, 11), values, st.booleans()), min_size=1, max_size=60),
    load=values,
)
def test_whatever_comes_in_valves_are_shut_or_sound(controller, study, recording, rows, load):
    bounds = bounds_of(study)
    start = recording.first
    fault = controller.init(start, load)
    least, largest = -57805.3, 78539.8  # N, within the pressure limits
    if not (math.isfinite(load) and least - 1 <= load <= largest + 1):
        assert fault == INPUT
    ready, held = fault == 0, False
    for number, (column, value, spoil) in enumerate(rows):
        row = recording.inputs[200 + number].copy()
        if spoil:
            row[column] = value
        good = bool(((row >= bounds[:, 0]) & (row <= bounds[:, 1])).all())
        fault = controller.step(row)
        outputs = controller.outputs
        assert fault == outputs.fault == (0 if ready and good else (INPUT if ready else STATE))
        held = (held or fault != 0) and not (fault == 0 and outputs.decided)
        if fault or held:
            assert controller.shut()
        assert set(outputs.valve) <= {0, 1}
        assert max(outputs.state_a, outputs.state_b) < 28
        assert math.isfinite(outputs.force_reference)


@pytest.mark.parametrize("column", range(12))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e9, -1e9])
def test_each_bad_input_shuts_all_valves_at_once_and_spoils_no_filter(
    controller, recording, column, value
):
    assert controller.init(recording.first, recording.load) == 0
    steps = np.flatnonzero(recording.decisions[:, rec.STATE_A])[0] + 1
    for row in recording.inputs[:steps]:
        assert controller.step(row) == 0
    assert not controller.shut()
    before = list(controller.state[:NUMBERS_IN_STATE])
    row = recording.inputs[steps].copy()
    row[column] = value
    assert controller.step(row) == INPUT
    assert controller.shut()
    assert list(controller.state[:NUMBERS_IN_STATE]) == before
    opened = False
    for row in recording.inputs[steps + 1 : steps + 200]:
        assert controller.step(row) == 0
        opened = opened or not controller.shut()
    assert opened  # it goes on by itself


def test_a_controller_that_was_not_set_up_does_nothing(controller, recording):
    for content in (0.0, math.nan, -1.0):
        controller.state[:] = [content] * len(controller.state)
        assert controller.step(recording.inputs[0]) == STATE
        assert controller.shut()
        assert controller.outputs.force_reference == 0


@pytest.mark.parametrize("column", [0, 3, 5, 11])
def test_a_bad_first_sample_leaves_it_not_set_up(controller, recording, column):
    first = recording.first.copy()
    first[column] = math.nan
    assert controller.init(first, recording.load) == INPUT
    assert controller.step(recording.inputs[0]) == STATE
    assert controller.shut()


def test_a_state_full_of_no_numbers_is_a_fault_until_it_is_set_up_again(controller, recording):
    assert controller.init(recording.first, recording.load) == 0
    controller.state[:NUMBERS_IN_STATE] = [math.nan] * NUMBERS_IN_STATE
    assert controller.step(recording.inputs[0]) == NUMERIC
    assert controller.shut()
    assert controller.outputs.force_reference == 0
    assert controller.step(recording.inputs[0]) == STATE
    assert controller.init(recording.first, recording.load) == 0
    assert controller.step(recording.inputs[0]) == 0


def test_null_pointers_are_a_fault(controller, recording):
    library, null = controller.library, ctypes.c_void_p()
    inputs, state = target.Inputs.of(recording.first), ctypes.byref(controller.state)
    outputs = ctypes.byref(controller.outputs)
    assert library.mptune_init(null, ctypes.byref(inputs), ctypes.c_double(0)) == POINTER
    assert library.mptune_init(state, null, ctypes.c_double(0)) == POINTER
    assert library.mptune_step(null, ctypes.byref(inputs), outputs) == POINTER
    assert library.mptune_step(state, null, outputs) == POINTER
    assert library.mptune_step(state, ctypes.byref(inputs), null) == POINTER
