"""Structured Text: right in grammar, the numbers of the tables, and the loops of the simulator."""

import re
import tomllib

import numpy as np
import pytest
import recording as rec
from lark import UnexpectedInput
from recording import first_case, record_case
from structured_text_language import PARSER, Program
from target import gains_of

from mptune.export.formats import Precision
from mptune.export.structured_text import structured_text
from mptune.export.table import as_toml
from mptune.job.export import prepare


@pytest.fixture(scope="module")
def text(controller):
    return structured_text(controller)


def test_the_text_follows_the_grammar(text, single):
    for one in (text, structured_text(single)):
        tree = PARSER.parse(one)
        names = [block.children[0].value for block in tree.find_data("block")]
        assert names[-1] == "MPT_OuterLoops"
        assert len(names) == 6


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("END_IF;", ""),
        ("END_FUNCTION_BLOCK", ""),
        (" := ", " = "),
        ("1.0 - Pole", "1. - Pole"),
        ("ELSE", "ELSE IF"),
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
    for name, value in constants.items():
        rounded = float(np.float32(value)) if which == "single" else value
        assert rounded == numbers.pop(name)
    assert numbers == {}


def test_single_precision_declares_no_double(single):
    text = structured_text(single)
    assert "LREAL" not in text
    assert re.search(r"\bREAL\b", text)


@pytest.mark.compiled
@pytest.mark.parametrize("which", ["study", "full_study"])
def test_the_blocks_give_the_simulator_s_force_reference(request, which):
    """Bit for bit but for two sums that the blocks take in another order."""
    study = request.getfixturevalue(which)
    controller = prepare(study, gains_of(study), Precision.DOUBLE)
    program = Program(structured_text(controller))
    recording = record_case(study, first_case(study, 24500.0))
    measurement, loops = program.instance("MPT_Measurement"), program.instance("MPT_OuterLoops")
    x_ref, v_ref, _, position, *_ = recording.first.tolist()
    measurement(Reset=True, Sample=position, PositionReference=x_ref, VelocityReference=v_ref)
    rows = zip(recording.inputs[:2000].tolist(), recording.decisions.tolist(), strict=False)
    first = True
    for tick, (row, decision) in enumerate(rows):
        measurement(Reset=False, Sample=row[3], PositionReference=row[0], VelocityReference=row[1])
        assert measurement.Position == decision[rec.HISTORY][0]
        if tick % 20 == 0:
            loops(
                Reset=first,
                Load=recording.load,
                LaggedPosition=measurement.LaggedPosition,
                LaggedVelocity=measurement.LaggedVelocity,
                AccelerationReference=row[2],
                Position=measurement.Position,
                Velocity=measurement.Velocity,
            )
            first = False
        assert loops.ForceReference == pytest.approx(decision[rec.FORCE], rel=1e-9, abs=1e-6)


def test_every_file_says_where_it_comes_from(text, study):
    assert f"study_hash: {study.hash()}" in text
    assert "margins as written: satisfied" in text


def test_forced_text_says_so_loudly(forced):
    assert "NOT satisfied" in structured_text(forced).split("*)")[0]
