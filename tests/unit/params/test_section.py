"""Sections: ranges, bounds, and plain SI numbers where a gains file is read."""

from __future__ import annotations

from typing import Literal, Optional

import pytest
from pydantic import Field, ValidationError

from mptune.params.section import Range, Section, quantity


class Part(Section):
    length: float = quantity("m", "L", "length", above=0, at_most=2)
    span: Range = quantity("s", "T", "span", ("1 s", "2 s"), at_least=0)


def test_a_bound_holds_in_si_whatever_the_unit_written():
    assert Part.model_validate({"length": "2000 mm"}).length == 2.0
    with pytest.raises(ValidationError, match="at most 2 m"):
        Part.model_validate({"length": "2001 mm"})


def test_a_bound_holds_for_both_ends_of_a_range():
    with pytest.raises(ValidationError, match="at least 0 s"):
        Part.model_validate({"length": "1 m", "span": ["-1 s", "2 s"]})


def test_plain_si_numbers_are_read_only_where_they_are_asked_for():
    assert Part.model_validate({"length": 1.5}, context={"si": True}).length == 1.5
    with pytest.raises(ValidationError, match="no unit"):
        Part.model_validate({"length": 1.5})


def test_bounds_hold_for_plain_si_numbers_too():
    with pytest.raises(ValidationError, match="at most 2 m"):
        Part.model_validate({"length": 2.5}, context={"si": True})


def test_quantities_come_with_unit_symbol_and_meaning():
    assert list(Part.quantities()) == [("length", "m", "L", "length"), ("span", "s", "T", "span")]


class Spans(Section):
    maybe: Range | None = quantity("s", "T", "a range or nothing", None)
    older: Optional[Range] = quantity("s", "T", "the same, in typing's words", None)  # noqa: UP045 - as it may be written
    word: Range | Literal["all"] = quantity("s", "T", "or a word", "all", words=("all",))
    several: tuple[Range, ...] = quantity("s", "T", "list of ranges", (("1 s", "2 s"),))
    printed: Literal["tuple[float, float]", "..."] = "..."
    named: dict[str, Range] = Field(default_factory=dict)


def test_a_range_is_asked_by_its_type_in_whatever_union_it_stands():
    ranges = {name for name in Spans.model_fields if Spans.is_range(name)}
    assert ranges == {"maybe", "older", "word"}


def test_a_list_of_ranges_is_no_range():
    assert Spans.model_validate({"several": [["1 s", "2 s"], ["3 s", "4 s"]]}).several[1] == (3, 4)
    with pytest.raises(ValidationError, match="a list is needed"):
        Spans.model_validate({"several": "1 s"})
