"""Lines and edges of a study: what they make, and what is refused."""

import time

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.params.line_table import line_table
from mptune.params.lines import Edges, SupplyLine, nominal_pressures, supplies_of
from mptune.params.load import load_study
from mptune.params.packed import BASE, FROM_LOWEST, FROM_STEADY, MADE_BY, RESTS, SHARE
from mptune.params.valve_states import EdgeRule, StateKind, number_of_states, valve_states

TANK = '{kind = "tank", pressure = "1 MPa"}'
SEVEN = '{kind = "constant", pressure = "7 MPa"}'
TOP = '{kind = "constant", pressure = "14 MPa"}'
MEDIUM = '{kind = "accumulator", pressure = "7 MPa"}'
PUMP = '{kind = "pump", pressure = "9 MPa", margin = "2 MPa", standby = "2 MPa", lag = "60 ms"}'


def converter(low, high, share=0.5):
    return f'{{kind = "converter", between = [{low}, {high}], share = {share}}}'


def lines(*texts):
    return f"lines=[{', '.join(texts)}]"


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        ((TANK,), "single line"),
        ((TANK, TANK, TOP), "it alone, is a tank"),
        ((SEVEN, TOP), "it alone, is a tank"),
        ((TANK, TOP, SEVEN), "rising pressure"),
        ((TANK, PUMP, TOP), "only the last may be: it keeps its margin"),
        ((TANK, MEDIUM, TOP), "one volume of gas.*make it constant"),
        ((TANK, converter(1, 2), TOP), "a line below and one above"),
        ((TANK, converter(1, 4), converter(2, 4), TOP), "a converter"),
        ((TANK, SEVEN, converter(1, 2)), "last line"),
        ((TANK, converter(1, 3), PUMP), "below a pump"),
        ((TANK, converter("true", 3), TOP), "valid integer"),
        ((TANK, '{kind = "constant"}'), "no pressure"),
        ((TANK, '{kind = "constant", pressure = "7 MPa", share = 0.5}'), "a share"),
    ],
)
def test_lines_that_make_no_machine_are_refused(load_boom, texts, words):
    with pytest.raises(InputError, match=words):
        load_boom(lines(*texts), corners=True)


def test_the_paper_s_lines_written_out_are_its_short_form():
    """The same table, but that the accumulator's pressure counts from the tank line."""
    own = [SupplyLine(kind="tank", pressure="2 MPa")]
    own += [SupplyLine(kind="converter", between=(1, 6), share=k / 5) for k in range(1, 5)]
    own.append(SupplyLine(kind="accumulator", pressure="14 MPa"))
    np.testing.assert_allclose(line_table(own, 2e6), line_table((), 2e6), rtol=1e-15)
    assert nominal_pressures(own) == pytest.approx([2e6, 4.4e6, 6.8e6, 9.2e6, 11.6e6, 14e6])


def test_a_converter_takes_its_oil_from_the_lines_that_it_is_between():
    own = [SupplyLine(kind="tank", pressure="1 MPa")]
    own += [SupplyLine(kind="converter", between=(1, 3), share=0.25)]
    own += [SupplyLine(kind="constant", pressure="5 MPa")]
    own += [SupplyLine(kind="converter", between=(3, 5), share=0.4)]
    own += [SupplyLine(kind="constant", pressure="15 MPa")]
    table = line_table(own, 1e6)
    high = 15e6
    pressures = table[BASE] + table[SHARE] * (high - table[BASE])
    np.testing.assert_allclose(pressures, nominal_pressures(own), rtol=1e-15)
    assert table[MADE_BY].tolist() == [-1, 0, -1, 1, -1]
    assert table[RESTS].tolist() == [1, 0, 0, 0, 1]
    # What is drawn has the energy of where it comes from.
    energy = table[FROM_LOWEST] * 1e6 + table[FROM_STEADY] + table[SHARE] * high
    np.testing.assert_allclose(energy, pressures, rtol=1e-15)


def test_what_no_line_needs_is_not_asked_for(write_study):
    """Without accumulator and converters there is nothing left of [supplies]."""
    study = load_study(write_study({"supplies": None, "lines": f"[{TANK}, {TOP}]"}))
    assert (study.study.supplies.low_pressure, study.study.supplies.high_pressure) == (1e6, 14e6)
    assert study.study.converters == 0
    with pytest.raises(InputError, match="supplies"):
        load_study(write_study({"supplies": None}))
    with pytest.raises(InputError, match=r"supplies\.converter_area"):
        load_study(write_study({"supplies": None, "lines": f"[{TANK}, {converter(1, 3)}, {TOP}]"}))


def test_the_paper_s_supplies_are_as_they_are_written(boom):
    assert supplies_of((), boom.study.supplies) is boom.study.supplies


def test_too_many_combinations_are_refused_with_their_number(load_boom):
    edges = 'edges={sizes=[1, 2, 4, 8, 16], states=["subsets"]}'
    with pytest.raises(InputError, match=f"{(1 + 6 * 31) ** 2} combinations"):
        load_boom(edges, corners=True)
    load_boom(edges, "controller.max_combinations=40000", corners=True)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (f'edges={{sizes={[1] * 24}, states=["subsets"]}}', "over 10000 states"),
        (f"edges.sizes={[1] * 5000}", "30000 valves of a chamber"),
        ("controller.max_combinations=1000000000", "at most"),
    ],
)
def test_states_that_nobody_could_count_are_refused_at_once(load_boom, override, words):
    """Every choice among 24 valves of one line makes 17 million of them."""
    begun = time.process_time()
    with pytest.raises(InputError, match=words):
        load_boom(override, corners=True)
    assert time.process_time() - begun < 5


@pytest.mark.parametrize("most", [1, 27, 28, 100])
def test_states_are_counted_as_far_as_asked(boom, most):
    assert number_of_states(boom.study.edge_rule, most) == min(28, most + 1)


@pytest.mark.parametrize(
    ("valves", "kinds", "expected"),
    [
        (2, ("all", "single", "crossflow"), 28),
        (1, ("all", "single", "crossflow"), 12),
        (3, ("subsets",), 43),
        (2, ("subsets", "crossflow"), 34),
    ],
)
def test_states_of_six_lines(valves, kinds, expected):
    """Of a single valve all and single are the same, and one crossflow of a pair is left."""
    rule = EdgeRule(((1.0,) * valves,) * 6, tuple(StateKind(kind) for kind in kinds))
    assert len(valve_states(rule)) == expected


def test_edges_are_the_paper_s_where_nothing_is_said(boom):
    assert boom.study.edges == Edges()
    assert boom.study.edge_rule.valves == 12
    assert len(valve_states(boom.study.edge_rule)) ** 2 == 784
