"""Structured Text: right in grammar, the numbers of the tables, and the loops of the simulator."""

import re
import tomllib

import numpy as np
import pytest
import recording as rec
from lark import UnexpectedInput
from recording import first_case, record_case
from structured_text_language import PARSER, Program
from target import renumbered

from mptune.export.structured_text import _milliseconds, structured_text
from mptune.export.table import as_toml
from mptune.sim.closed_loop import FED_MASS

TICKS = 700  # 0.35 s: a mass that is learnt has then moved


@pytest.fixture(scope="module")
def text(controller):
    return structured_text(controller)


def test_the_text_follows_the_grammar(text, single):
    for one in (text, structured_text(single)):
        tree = PARSER.parse(one)
        names = [block.children[0].value for block in tree.find_data("block")]
        assert names[-1] == "MPT_OuterLoops"
        assert len(names) == 9
        assert len(list(tree.find_data("program"))) == 1


def test_a_block_that_uses_a_constant_says_so_and_no_other_does(text):
    for unit in re.findall(
        r"^(?:FUNCTION_BLOCK|PROGRAM) .*?^END_\w+$", text, re.MULTILINE | re.DOTALL
    ):
        bare = re.sub(r"\(\*.*?\*\)", "", unit, flags=re.DOTALL)
        *_, body = bare.split("END_VAR\n")
        external = re.search(r"VAR_EXTERNAL CONSTANT\n(.*?)END_VAR", bare, re.DOTALL)
        declared = re.findall(r"MPT_\w+", external[1]) if external else []
        assert sorted(declared) == sorted(set(re.findall(r"MPT_[A-Z0-9_]+\b", body)))


def test_a_constant_that_is_not_declared_is_out_of_reach(text):
    without = re.sub(r"VAR_EXTERNAL CONSTANT\n    MPT_SAMPLE_TIME : LREAL;\nEND_VAR\n", "", text)
    assert without != text
    block = Program(without).instance("MPT_Differentiator")
    with pytest.raises(KeyError, match="MPT_SAMPLE_TIME"):
        block(Reset=True, Position=0.1)


def test_the_program_runs_in_a_task_of_the_fast_period(text, single, study):
    signals = study.study.controller
    assert Program(text).interval == "T#0.5ms"
    assert signals.fast_sampling_period == 0.5e-3
    for one in (text, single):
        program = Program(one if isinstance(one, str) else structured_text(one))
        ticks = signals.sampling_period / signals.fast_sampling_period
        assert program.constants["MPT_TICKS"] == round(ticks)


@pytest.mark.parametrize(
    ("seconds", "wanted"),
    [
        (0.5e-3, "0.5"),
        (1e-3, "1"),
        (0.01, "10"),
        (0.1, "100"),
        (1e-7, "0.0001"),
        (1 / 3e3, "0.333333"),
    ],
)
def test_a_time_has_no_exponent(seconds, wanted):
    assert _milliseconds(seconds) == wanted


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("END_IF;", ""),
        ("END_FUNCTION_BLOCK", ""),
        (" := ", " = "),
        ("1.0 - Pole", "1. - Pole"),
        ("ELSE", "ELSE IF"),
        ("CONFIGURATION", "CONFIG"),
        ("T#0.5ms", "0.5ms"),
        ("END_RESOURCE", ""),
    ],
)
def test_the_grammar_refuses_what_is_wrong(text, old, new):
    assert old in text
    with pytest.raises(UnexpectedInput):
        PARSER.parse(text.replace(old, new, 1))


@pytest.mark.parametrize("which", ["controller", "single"])
def test_constants_are_those_of_the_table(request, which):
    controller = request.getfixturevalue(which)
    table = tomllib.loads(as_toml(controller))
    constants = Program(structured_text(controller)).constants
    assert len(constants) > 15
    numbers = {
        f"MPT_{key.upper()}": value
        for name in ("outer_loops", "feedforward_lags", "state_estimator", "filters")
        for key, value in table[name].items()
    }
    numbers |= {f"MPT_AREA_{side.upper()}": table["force_controller"][f"area_{side}"]
                for side in "ab"}  # fmt: skip
    assert constants.pop("MPT_TICKS") == controller.numbers.ticks
    for name, value in constants.items():
        rounded = float(np.float32(value)) if which == "single" else value
        assert rounded == numbers.pop(name)
    assert numbers == {}


def test_single_precision_declares_no_double(single):
    text = structured_text(single)
    assert "LREAL" not in text
    assert re.search(r"\bREAL\b", text)


def inputs_of(row):
    """Return the program's inputs of a recorded row: pressures are used by an estimator only."""
    x_ref, v_ref, a_ref, position, pressure_a, pressure_b = row[:6]
    return {
        "Sample": position,
        "PressureA": pressure_a,
        "PressureB": pressure_b,
        "PositionReference": x_ref,
        "VelocityReference": v_ref,
    }, {"AccelerationReference": a_ref}


@pytest.mark.compiled
@pytest.mark.parametrize("which", ["study", "full_study", "proportional_study"])
def test_the_blocks_give_the_simulator_s_force_reference(request, controller, which):
    same_force_references(request.getfixturevalue(which), controller)


@pytest.mark.compiled
def test_estimator_and_feed_forward_are_in_the_blocks_too(estimated_study, controller):
    same_force_references(estimated_study, controller)


def same_force_references(study, controller):
    """Bit for bit in double precision, called one by one and as a program."""
    program = Program(structured_text(renumbered(controller, study)))
    recording = record_case(study, first_case(study, 24500.0))
    measurement, loops = program.instance("MPT_Measurement"), program.instance("MPT_OuterLoops")
    whole = program.instance("MPT_Program")
    measured, ahead = inputs_of(recording.first.tolist())
    measurement(Reset=True, Load=recording.load, **measured)
    whole(Reset=True, Load=recording.load, **measured, **ahead)
    rows = recording.inputs[:TICKS].tolist()
    first = True
    for tick, (row, decision) in enumerate(zip(rows, recording.decisions, strict=False)):
        measured, ahead = inputs_of(row)
        measurement(Reset=False, **measured)
        if study.study.estimator.kind == "filters":
            assert measurement.Position == decision[rec.HISTORY][0]
        assert measurement.Mass == recording.trace[tick, FED_MASS]
        if tick % 20 == 0:
            loops(
                Reset=first,
                Load=recording.load,
                LaggedPosition=measurement.LaggedPosition,
                LaggedVelocity=measurement.LaggedVelocity,
                Mass=measurement.Mass,
                Position=measurement.Position,
                Velocity=measurement.Velocity,
                **ahead,
            )
            first = False
        whole(Reset=False, Load=recording.load, **measured, **ahead)
        assert whole.ForceReference == loops.ForceReference
        assert loops.ForceReference == decision[rec.FORCE]
    moved = recording.trace[:TICKS, FED_MASS]
    assert (moved.min() < moved.max()) == study.study.feedforward.adaptive_mass


def test_every_file_says_where_it_comes_from(text, study):
    assert f"study_hash: {study.hash()}" in text
    assert "margins as written: satisfied" in text


def test_forced_text_says_so_loudly(forced):
    assert "NOT satisfied" in structured_text(forced).split("*)")[0]
