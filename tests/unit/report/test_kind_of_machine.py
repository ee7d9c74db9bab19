"""What a report says of a machine is true of that machine."""

import pytest

from mptune.report.content import kind_of_machine as words
from mptune.report.content.parameters import _lines, _sections


def test_of_the_paper_s_machine_it_is_as_the_paper_has_it(boom):
    assert "both valves below" in words.valve_state_words(boom)
    assert words.supply_words(boom) == "accumulator, pump and converter cylinders"
    assert words.loss_words(boom).startswith("accumulator power")
    assert "converter position" in words.largest_words(boom)


@pytest.mark.parametrize(
    ("name", "states", "supplies"),
    [
        ("four-chamber", "", "lines of constant pressure"),
        (
            "four-converters",
            "all valves of a line and crossflow",
            "accumulator, pump and converter",
        ),
        ("following", "all valves of a line, one valve of a line and crossflow", "a pump that"),
        ("mixed", "some valves of a line and crossflow", "accumulator, pump and converter"),
    ],
)
def test_kinds_of_states_and_supplies_are_the_machine_s_own(load_shape, name, states, supplies):
    study = load_shape(name)
    found = words.valve_state_words(study)
    assert states in found
    assert bool(found) == bool(states)
    assert words.supply_words(study).startswith(supplies)
    assert ("Q_conv" in words.loss_source(study)) == (study.study.converters > 0)


def test_lines_are_listed_and_supplies_say_nothing_in_their_place(load_shape):
    study = load_shape("four-chamber")
    assert [row[1:3] for row in _lines(study).rows] == [["tank", "1 MPa"], ["constant", "12 MPa"]]
    assert _lines(study).legend.startswith("published: two lines")
    titles = [block.text for block in _sections(study) if hasattr(block, "text")]
    assert "lines" in titles
    assert "supplies" not in titles
    made = _lines(load_shape("four-converters")).rows[1]
    assert made == ["2", "converter", "4.9 MPa", "1 and 4", "0.3", "1"]
