"""What other commands left for the report: taken for the same model, and for no other."""

import io
import json
from xml.etree import ElementTree as ET

import h5py
import numpy as np
import pytest
import xarray as xr

from mptune.figures.style import new_figure, to_svg
from mptune.identify.excitation import Excitation
from mptune.identify.result import IdentifyResult, Panel
from mptune.identify.store import read_panels, write_identification
from mptune.job.leftovers import keep, leftovers
from mptune.report.blocks import plain
from mptune.report.content.identification import identification
from mptune.report.content.tradeoff import comparison, front
from mptune.report.content.weights import weights
from mptune.report.picture import safe_picture
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


DAMAGED = [
    ("comparison", "{"),
    ("comparison", "[]"),
    ("comparison", "[" * 100_000),
    ("comparison", '{"study_hash": "HASH", "rows": [1]}'),
    ("comparison", '{"study_hash": "HASH", "rows": [{"structure": "pi"}]}'),
    ("comparison", '{"study_hash": "HASH", "rows": {"a": 1}}'),
    ("comparison", '{"study_hash": "HASH"}'),
    ("front", '{"study_hash": "HASH", "rows": [{"figures": {}, "converged": true}]}'),
    ("front", '{"study_hash": "HASH", "rows": [{"figures": null, "converged": true}]}'),
    ("weights", '{"study_hash": "HASH", "rows": [{"name": 1}]}'),
    ("weights", '{"study_hash": "HASH", "rows": [{"name": "a", "valve_switches": "many"}]}'),
    ("weights", '{"study_hash": "HASH", "rows": [' + ",".join(['{"name": "a"}'] * 3000) + "]}"),
]


@pytest.mark.parametrize(("name", "text"), DAMAGED, ids=range(len(DAMAGED)))
def test_what_is_damaged_or_of_another_shape_is_left_out_and_the_report_says_so(
    folder, boom, name, text
):
    (folder / f"{name}.json").write_text(text.replace("HASH", boom.hash()))
    found = leftovers(folder, boom)
    assert {"comparison": found.compared, "front": found.front, "weights": found.weights}[
        name
    ] == ()
    assert [one.split()[0] for one in found.left_out] == [f"{name}.json"]
    results = Results(boom, None, None, boom.study.feedforward, leftovers=found)
    for make in (comparison, front, weights, identification):
        make(results)


def without_variable(content):
    with xr.open_dataset(io.BytesIO(content), engine="h5netcdf") as dataset:
        stream = io.BytesIO()
        dataset.load().drop_vars("quality").to_netcdf(stream, engine="h5netcdf")
    return stream.getvalue()


def huge(content):
    stream = io.BytesIO(content)
    with h5py.File(stream, "a") as file:
        file.create_dataset("huge", (1_000_000, 1_000_000), "f8", chunks=(1000, 1000))
    return stream.getvalue()


@pytest.mark.parametrize(
    "damage", [lambda c: c[: len(c) // 2], lambda _: b"no data", without_variable, huge]
)
def test_a_damaged_identification_is_left_out_and_the_report_says_so(folder, boom, damage):
    path = folder / "identification.nc"
    path.write_bytes(damage(path.read_bytes()))
    found = leftovers(folder, boom)
    assert found.panels == ()
    assert [one.split()[0] for one in found.left_out] == ["identification.nc"]


@pytest.mark.parametrize("name", ["identification.nc", "front.svg", "front.json"])
def test_what_is_larger_than_any_of_ours_is_left_out_unread(folder, boom, name):
    with (folder / name).open("r+b") as stream:
        stream.truncate(10**13)  # a hole: it takes no room, and all memory once it is read
    found = leftovers(folder, boom)
    assert [one.split()[0] for one in found.left_out] == [name]
    assert "MB" in found.left_out[0]


HOSTILE_PICTURES = [
    b"<svg><script>alert(1)</script></svg>",
    b'<svg onload="alert(1)"><g onclick="alert(1)"/></svg>',
    b'<svg xmlns:x="http://www.w3.org/1999/xlink"><image x:href="/etc/hostname"/></svg>',
    b'<svg><a href="javascript:alert(1)"><text>click</text></a></svg>',
    b"<svg><foreignObject><iframe src='https://example.org'/></foreignObject></svg>",
    b"<svg><style>body{display:none}@import url(https://example.org)</style></svg>",
    b'<svg><rect style="position:fixed;width:100vw;fill:red"/></svg>',
    b'<svg><rect fill="url(https://example.org/x)"/></svg>',
    b'<svg><use href="https://example.org/x#y"/><animate attributeName="href"/></svg>',
    b"<svg>" + b"<g>" * 5000 + b"</g>" * 5000 + b"</svg>",
]


@pytest.mark.parametrize("svg", HOSTILE_PICTURES, ids=range(len(HOSTILE_PICTURES)))
def test_a_picture_is_copied_without_what_is_not_drawn(folder, boom, svg):
    (folder / "front.svg").write_bytes(svg)
    found = leftovers(folder, boom).figures.get("front", b"").lower()
    for word in (
        b"script",
        b"onload",
        b"onclick",
        b"example.org",
        b"hostname",
        b"style>",
        b"fixed",
    ):
        assert word not in found
    assert b"iframe" not in found


@pytest.mark.parametrize(
    "svg",
    [
        b"",
        b"<svg",
        b"<html/>",
        b'<!DOCTYPE svg [<!ENTITY a "b">]><svg>&a;</svg>',
        b"\0" * 100,
        b'<svg width="0" height="0"/>',
    ],
)
def test_what_is_no_picture_is_left_out_and_the_report_says_so(folder, boom, svg):
    (folder / "front.svg").write_bytes(svg)
    found = leftovers(folder, boom)
    assert "front" not in found.figures
    assert [one.split()[0] for one in found.left_out] == ["front.svg"]


def test_a_figure_of_ours_loses_nothing_that_is_drawn():
    figure = new_figure(2)
    figure.subplots().bar([1, 2], [3, 4], hatch="//", label="a")
    before = ET.fromstring(to_svg(figure))  # noqa: S314 - our own
    after = ET.fromstring(safe_picture(to_svg(figure)))  # noqa: S314 - our own
    for name in ("path", "use", "g", "defs", "clipPath", "pattern", "rect"):
        tag = f"{{http://www.w3.org/2000/svg}}{name}"
        pairs = zip(before.iter(tag), after.iter(tag), strict=True)
        for one, other in pairs:
            assert set(one.attrib) == set(other.attrib)
            assert one.get("d") == other.get("d")
            assert one.get("style", "").count(":") == other.get("style", "").count(":")
