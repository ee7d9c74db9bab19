"""What other commands left for the report: taken for the same model, and for no other."""

import json

import numpy as np
import pytest

from mptune.identify.excitation import Excitation
from mptune.identify.result import IdentifyResult, Panel
from mptune.identify.store import read_panels, write_identification
from mptune.job.leftovers import keep, leftovers
from mptune.report.blocks import plain
from mptune.report.content.identification import identification
from mptune.report.content.tradeoff import comparison, front
from mptune.report.content.weights import weights
from mptune.report.results import Leftovers, Results

FIGURES = {
    "tracking_index_s": 0.0123,
    "k_i_pos": 22.0,
    "load_step_m_per_n": 1e-7,
    "bandwidth_rad_s": 20.0,
}
ROW = {
    "structure": "pi",
    "status": "optimal",
    "satisfied": True,
    "velocity_worst_ratio": 0.6,
    "position_worst_ratio": 0.4,
    "figures": FIGURES,
}


WEIGHTS = {
    "name": "recommended",
    "reason": "it loses less",
    "weights": {
        "weight_switching_n": 390.0,
        "weight_loss_n_per_j": 113.0,
        "weight_converter_n_s_per_m6": 3e11,
    },
    "energy_loss_j_per_mm": 17.7,
    "performance_index_ms": 19.3,
    "force_error_integral_kn2s": 43.6,
    "valve_switches": 543.0,
    "converter_peak_mm": 52.8,
}


def panel(delay):
    omega = np.array([1.0, 10.0, 100.0])
    theory = 1 / (1 + 0.01j * omega)
    return Panel(
        position_m=0.15,
        oil_bulk_modulus_pa=8e8,
        valve_delay_s=delay,
        tau_a_s=0.01,
        tau_b_s=0.011,
        omega=omega,
        velocity=np.array([0.0, 0.1]),
        pressure_a=np.array([5e6, 6e6]),
        skipped=1,
        response=np.stack([theory * 1.01, theory * 0.99]),
        quality=np.ones((2, 3)),
        status=np.zeros((2, 3), np.int64),
        theory=theory,
    )


@pytest.fixture
def folder(tmp_path, boom):
    keep(tmp_path, "comparison", boom, [ROW])
    keep(tmp_path, "front", boom, [{"figures": FIGURES, "converged": True}])
    keep(tmp_path, "weights", boom, [WEIGHTS])
    result = IdentifyResult(boom, Excitation.SINE, (panel(0.0), panel(0.005)))
    write_identification(tmp_path / "identification.nc", result)
    for name in ("controllers", "front", "weights", "identification", "identification-5ms", "else"):
        (tmp_path / f"{name}.svg").write_bytes(b"<svg/>")
    return tmp_path


def test_what_belongs_to_the_model_is_taken_with_its_figures(folder, boom):
    found = leftovers(folder, boom)
    assert [row["structure"] for row in found.compared] == ["pi"]
    assert len(found.front) == 1
    assert [one.valve_delay_s for one in found.panels] == [0.0, 0.005]
    names = {"controllers", "front", "weights", "identification", "identification-5ms"}
    assert set(found.figures) == names


def test_panels_come_back_as_they_were(folder, boom):
    found = read_panels(folder / "identification.nc", boom.hash())
    for one, before in zip(found, (panel(0.0), panel(0.005)), strict=True):
        for name in Panel.__dataclass_fields__:
            assert np.array_equal(getattr(one, name), getattr(before, name)), name
        assert one.json() == before.json()


def test_another_model_s_results_are_left_out(folder, load_boom):
    found = leftovers(folder, load_boom('load.force="5 kN"'))
    assert found == Leftovers((), (), (), (), {})


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"rows": [1]}'])
def test_what_cannot_be_read_is_left_out(folder, boom, text):
    (folder / "comparison.json").write_text(text)
    (folder / "identification.nc").write_text(text)
    found = leftovers(folder, boom)
    assert found.compared == ()
    assert found.panels == ()
    assert len(found.front) == 1


def test_sections_appear_only_with_their_results(folder, boom):
    empty = Results(boom, None, None, boom.study.feedforward)
    sections = (comparison, "PI"), (front, "12.30"), (weights, "543"), (identification, "agrees")
    for make, words in sections:
        assert make(empty) is None
        found = Results(boom, None, None, boom.study.feedforward, leftovers=leftovers(folder, boom))
        assert words in json.dumps(make(found), default=plain, ensure_ascii=False)
