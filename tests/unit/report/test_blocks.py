"""The parts of a report: what is taken for a symbol, and what stays as it stands."""

import json

import pytest

from mptune.report.blocks import (
    Break,
    Chapter,
    Heading,
    Note,
    Prose,
    Tabular,
    Words,
    left,
    plain,
    right,
    symbol,
    verdict,
    wide,
)


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("at F_ref, sampled", [("at F", False), ("ref", True), (", sampled", False)]),
        ("K_P,vel times", [("K", False), ("P,vel", True), (" times", False)]),
        ("τ_A and τ_B.", [("τ", False), ("A", True), (" and τ", False), ("B", True), (".", False)]),
        ("K_I,pos, then", [("K", False), ("I,pos", True), (", then", False)]),
        ("position_ratio", [("position_ratio", False)]),
        ("a plain text", [("a plain text", False)]),
        ("", []),
    ],
)
def test_symbols_of_the_report_s_own_words_get_a_subscript(text, pairs):
    assert [(run["text"], run["sub"]) for run in Words(text).runs] == pairs


def test_runs_lose_no_letter():
    text = "K_P,vel of F_ref, and x_2"
    assert "".join(run["text"] for run in Words(text).runs) == text.replace("_", "")


def made(part):
    """Return a part as the templates get it."""
    return json.loads(json.dumps(part, default=plain))


def test_cells_carry_their_look_and_columns_their_side():
    table = made(Tabular("Title", right("of F_ref"), [["plain"], [symbol("x_1")]]))
    assert table["kind"] == "tabular"
    assert table["rows"] == [["plain"], [{"text": "x_1", "look": "symbol", "kind": "cell"}]]
    assert table["columns"][0]["align"] == "right"
    assert table["columns"][0]["runs"] == Words("of F_ref").runs
    assert table["keep"]


def test_a_chapter_keeps_its_blocks_in_order():
    one = made(Chapter.of("Title of F_ref", Prose("a"), Break(), Note("b"), new_page=True))
    assert [block["kind"] for block in one["blocks"]] == ["prose", "break", "note"]
    assert one["text"] == "Title of F_ref"
    assert [run["sub"] for run in one["runs"]] == [False, True]
    assert one["new_page"]


def test_a_table_without_rows_has_no_heading_and_nothing_after_it():
    empty, full = Tabular("Title", right("a"), []), Tabular("Title", right("a"), [["1"]])
    assert empty.titled(Note("said of it")) == []
    assert full.titled(Note("said of it")) == [Heading("Title"), full, Note("said of it")]


def test_parts_of_different_kinds_differ():
    assert Prose("a") == Prose("a")
    assert Prose("a") != Note("a")


def test_a_brief_table_leaves_out_its_columns_of_detail_only():
    columns = [*right("a"), *right("b", detail=True), wide("c"), wide("d", detail=True)]
    brief = Tabular("Title", columns, [["1", "2", "3", "4"]]).brief()
    assert [column.text for column in brief.columns] == ["a", "c"]
    assert brief.rows == [["1", "3"]]
    assert brief.title == "Title"


def test_columns_in_which_no_row_says_anything_are_left_out_and_the_first_never_is():
    columns = [*left("Name"), *right("Value"), *left("Note")]
    table = Tabular("t", columns, [["—", "1", "—"], ["", "—", verdict("", good=True)]])
    assert [column.text for column in table.filled().columns] == ["Name", "Value"]
    assert table.filled().rows == [["—", "1"], ["", "—"]]
    empty = Tabular("t", columns, [])
    assert empty.filled() is empty
