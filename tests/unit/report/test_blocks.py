"""The parts of a report: what is taken for a symbol, and what stays as it stands."""

import pytest

from mptune.report.blocks import Cell, right, runs, section, table


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
    assert [(run["text"], run["sub"]) for run in runs(text)] == pairs


def test_runs_lose_no_letter():
    text = "K_P,vel of F_ref, and x_2"
    assert "".join(run["text"] for run in runs(text)) == text.replace("_", "")


def test_cells_carry_their_look_and_columns_their_side():
    made = table(right("a"), [["plain"], [Cell("x_1", "symbol")]], keep=True)
    assert [row[0]["look"] for row in made["rows"]] == ["", "symbol"]
    assert made["columns"][0]["align"] == "right"
    assert made["keep"]


def test_a_section_keeps_its_blocks_in_order():
    made = section("Title of F_ref", {"kind": "a"}, {"kind": "b"}, new_page=True)
    assert [block["kind"] for block in made["blocks"]] == ["a", "b"]
    assert made["title"] == "Title of F_ref"
    assert made["new_page"]
