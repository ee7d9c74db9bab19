"""The chambers among the parameters."""

from mptune.report.content.parameters import _chambers


def test_each_chamber_has_a_row_with_its_size_and_units(load_shape):
    table = _chambers(load_shape("four-chamber"))
    assert [row[0] for row in table.rows] == list("ABCD")
    assert [row[1] for row in table.rows] == ["pushing", "pulling"] * 2
    assert [row[2].split()[0] for row in table.rows] == ["32", "16", "8", "4"]
    assert table.legend.startswith("published")
