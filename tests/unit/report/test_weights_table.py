"""The table of weights has what the machine has, and what was searched."""

import pytest

from mptune.report.content.weights import trials

WEIGHTS = {
    "weight_switching_n": 800.0,
    "weight_loss_n_per_j": 80.0,
    "weight_converter_n_s_per_m6": 2e11,
    "sampling_period_s": 0.01,
    "candidates": 6,
    "weight_compression_n_per_j": 30.0,
}


def row(peak, **changes):
    return {
        "name": "one",
        "weights": WEIGHTS | changes,
        "valve_switches": 300.0,
        "converter_peak_mm": peak,
    }


def headings(*rows):
    return [column.text.replace("\n", " ") for column in trials("title", rows).columns]


@pytest.mark.parametrize("peak", [0.0, 40.0])
def test_converters_have_columns_where_there_are_any(peak):
    found = headings(row(peak))
    assert any("W_conv" in one for one in found) == (peak > 0)
    assert any("Converter" in one for one in found) == (peak > 0)
    assert all(any(name in one for one in found) for name in ("W_sw", "W_loss", "T_S"))


def test_further_terms_have_columns_where_they_differ():
    spread = {"name": "spread", "valve_switches": 3.0}
    assert "W_comp [N/J]" not in headings(row(0.0), row(0.0), spread)
    found = headings(row(0.0), row(0.0, weight_compression_n_per_j=60.0), spread)
    assert "W_comp [N/J]" in found
    assert not any(one.startswith(("f_0", "n ", "W_cm")) for one in found)


def test_every_row_has_as_many_cells_as_there_are_columns():
    table = trials("title", [row(0.0), row(0.0, candidates=9), {"name": "spread"}])
    assert {len(one) for one in table.rows} == {len(table.columns)}
