"""Records from CSV, MAT and MDF files: the same record from each, each fault one by one."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from mptune.errors import InputError
from mptune.identify.spectrum import welch_response
from mptune.identify.timeseries import Asked, read_record

COUNT, STEP = 400, 0.5e-3
TIME = 0.25 + STEP * np.arange(COUNT)
REFERENCE = 10e3 * np.sin(40 * TIME)
FORCE = 9e3 * np.sin(40 * TIME - 0.3)
KILO = Asked("F_ref [kN]", "F [kN]", "t [ms]")


def write_csv(path, header="t [ms],F_ref [kN],F [N],x [mm]", **columns):
    values = {"time": 1e3 * TIME, "reference": 1e-3 * REFERENCE, "force": FORCE, "x": 0 * TIME}
    rows = np.stack([columns.get(key, value) for key, value in values.items()], axis=1)
    lines = [header, *(",".join(map(repr, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def write_mat(path):
    log = {"F_ref": 1e-3 * REFERENCE, "F": 1e-3 * FORCE, "t": 1e3 * TIME}
    savemat(path, {"log": log, "note": "rig", **log})
    return path


def write_mat_73(path):
    """A file of version 7.3: HDF5 behind a block of 512 bytes, row vectors as columns."""
    with h5py.File(path, "w", userblock_size=512) as file:
        log = file.create_group("log")
        for place in (file, log):
            place["F_ref"] = 1e-3 * REFERENCE[:, None]
            place["F"] = 1e-3 * FORCE[None, :]
            place["t"] = 1e3 * TIME[:, None]
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(512))
    return path


def write_mdf(path, force_time=TIME, unit="kN"):
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version="4.10") as file:
        for name, values, time, one in (
            ("F_ref", 1e-3 * REFERENCE, TIME, "kN"),
            ("F", 1e-3 * FORCE, force_time, unit),
        ):
            file.append([asammdf.Signal(values, time, unit=one, name=name)])
        file.save(path, overwrite=True)
    return path


def same(record):
    np.testing.assert_allclose(record.reference, REFERENCE, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(record.force, FORCE, rtol=1e-12, atol=1e-9)
    assert record.sample_time == pytest.approx(STEP, rel=1e-9)
    assert record.name == "rig"


def test_a_csv_file_gives_the_record(tmp_path):
    path = write_csv(tmp_path / "rig.csv")
    same(read_record(path, Asked("F_ref", "F")))
    same(read_record(path, Asked("F_ref", "F", sample_time="0.5 ms")))
    same(read_record(path, Asked("F_ref [kN]", "F", "t")))


@pytest.mark.parametrize("writer", [write_mat, write_mat_73])
def test_a_mat_file_gives_the_record(tmp_path, writer):
    path = writer(tmp_path / "rig.mat")
    same(read_record(path, KILO))
    same(read_record(path, Asked("log.F_ref [kN]", "log.F [kN]", "log.t [ms]")))
    same(read_record(path, Asked("F_ref [kN]", "F [kN]", sample_time="500 us")))


def test_an_mdf_file_gives_the_record(tmp_path):
    same(read_record(write_mdf(tmp_path / "rig.mf4"), Asked("F_ref", "F")))


def refused(path, asked, *parts):
    with pytest.raises(InputError) as caught:
        read_record(path, asked)
    text = str(caught.value)
    assert str(path) in text
    for part in parts:
        assert part in text


PLAIN = Asked("F_ref", "F")


@pytest.mark.parametrize("name", ["rig.csv", "rig.mat", "rig.mf4"])
def test_a_file_that_is_not_there_a_folder_and_an_empty_file(tmp_path, name):
    path = tmp_path / name
    refused(path, PLAIN, "does not exist")
    path.write_bytes(b"")
    refused(path, PLAIN, "is empty")
    path.unlink()
    path.mkdir()
    refused(path, PLAIN, "is a folder")


def test_an_unknown_kind_of_file(tmp_path):
    path = tmp_path / "rig.xlsx"
    path.write_bytes(b"x")
    refused(path, PLAIN, ".xlsx", ".mat")


@pytest.mark.parametrize("writer", [write_mat, write_mat_73, write_mdf])
@pytest.mark.parametrize("share", [0.2, 0.6])
def test_a_binary_file_that_was_cut_off(tmp_path, writer, share):
    path = writer(tmp_path / ("rig.mf4" if writer is write_mdf else "rig.mat"))
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    refused(path, KILO, "copy it again")


def test_a_csv_file_that_was_cut_off(tmp_path):
    path = write_csv(tmp_path / "rig.csv")
    path.write_text(path.read_text(encoding="utf-8")[:-12], encoding="utf-8")
    refused(path, PLAIN, f"line {COUNT + 1}", "cut off")


@pytest.mark.parametrize(
    ("writer", "name"), [(write_csv, "rig.csv"), (write_mat, "rig.mat"), (write_mdf, "rig.mf4")]
)
def test_a_missing_channel_names_those_there_are(tmp_path, writer, name):
    path = writer(tmp_path / name)
    refused(path, Asked("F_reference", "F [kN]", "t [ms]"), "`F_reference`", "F_ref")


def test_units_that_are_missing_wrong_or_in_contradiction(tmp_path):
    path = write_csv(tmp_path / "rig.csv")
    refused(path, Asked("F_ref", "x"), "wrong dimension (mm)")
    refused(path, Asked("F_ref [N]", "F"), "is in kN by the file")
    refused(path, Asked("F_ref", "F", sample_time="0.5 mm"), "wrong dimension")
    refused(path, Asked("F_ref", "F", sample_time="0.5"), "no unit")
    refused(write_mat(tmp_path / "rig.mat"), Asked("F_ref", "F [kN]", "t [ms]"), "F_ref [N]")
    refused(tmp_path / "rig.mat", Asked("F_ref [kN]", "F [kN]", "t"), "t [s]")
    refused(tmp_path / "rig.mat", Asked("F_ref [kN]", "F [kN]"), "no unit")
    refused(write_mdf(tmp_path / "rig.mf4", unit="MPa"), PLAIN, "wrong dimension (MPa)")


def test_no_time_at_all(tmp_path):
    path = write_csv(tmp_path / "rig.csv", "n [1],F_ref [kN],F [N],x [mm]")
    refused(path, PLAIN, "time between samples")


def test_unequal_sampling(tmp_path):
    gap = np.where(np.arange(COUNT) >= 57, TIME + 2 * STEP, TIME)
    refused(write_csv(tmp_path / "rig.csv", time=1e3 * gap), PLAIN, "evenly", "sample 58")
    back = TIME.copy()
    back[10] = back[8]
    refused(write_csv(tmp_path / "rig.csv", time=1e3 * back), PLAIN, "evenly")
    refused(write_csv(tmp_path / "rig.csv", time=0 * TIME), PLAIN, "evenly")
    rounded = np.round(1e3 * TIME, 2)  # a recorder's rounding is no gap
    assert read_record(write_csv(tmp_path / "rig.csv", time=rounded), PLAIN)


def test_channels_of_different_rasters(tmp_path):
    path = write_mdf(tmp_path / "rig.mf4", force_time=TIME + 0.1 * STEP)
    refused(path, PLAIN, "instants")
    savemat(tmp_path / "rig.mat", {"a": REFERENCE, "b": FORCE[:-1]})
    refused(tmp_path / "rig.mat", Asked("a [N]", "b [N]", sample_time="1 ms"), "399 samples")


def test_a_given_time_between_samples_must_agree_with_the_recorded_one(tmp_path):
    path = write_csv(tmp_path / "rig.csv")
    for text in ("0.25 ms", "1 ms", "0.51 ms"):
        parts = f"`sample time` = {text} contradicts", "steps by 0.5 ms"
        refused(path, Asked("F_ref", "F", sample_time=text), *parts)
        refused(path, Asked("F_ref", "F", "t [ms]", text), *parts)
    assert read_record(path, Asked("F_ref", "F", sample_time="0.502 ms")).sample_time == 0.502e-3
    refused(path, Asked("F_ref", "F", sample_time="0 ms"), "is not above 0")
    mdf = write_mdf(tmp_path / "rig.mf4")
    refused(mdf, Asked("F_ref", "F", sample_time="0.25 ms"), "contradicts", "steps by 0.5 ms")
    same(read_record(mdf, Asked("F_ref", "F", sample_time="0.5 ms")))
    shifted = write_mdf(tmp_path / "rig.mf4", force_time=TIME + 0.1 * STEP)
    refused(shifted, Asked("F_ref", "F", sample_time="0.5 ms"), "instants")


def test_a_given_time_between_samples_glues_no_gap(tmp_path):
    gap = np.where(np.arange(COUNT) >= 57, TIME + 25e-3, TIME)
    asked = Asked("F_ref", "F", sample_time="0.5 ms")
    refused(write_csv(tmp_path / "rig.csv", time=1e3 * gap), asked, "evenly: 0.5 ms", "sample 58")
    savemat(tmp_path / "rig.mat", {"F_ref": REFERENCE, "F": FORCE, "t": gap})
    asked = Asked("F_ref [N]", "F [N]", sample_time="0.5 ms")
    refused(tmp_path / "rig.mat", asked, "evenly: 0.0005 (of no unit)", "sample 58")


@pytest.mark.parametrize(
    ("step", "fits"),
    [
        (0.5e-3, "s"),
        (0.5, "ms"),
        (500.0, "µs"),
        (5e5, "ns"),
        (1.0, "samples"),
        (0.7, ""),
        (2.0, ""),
        (0.05, ""),
    ],
)
def test_a_time_without_unit_is_compared_in_each_that_it_may_have(tmp_path, step, fits):
    path = tmp_path / "rig.mat"
    savemat(path, {"F_ref": REFERENCE, "F": FORCE, "t": step * np.arange(COUNT)})
    asked = Asked("F_ref [N]", "F [N]", sample_time="0.5 ms")
    if fits:
        same(read_record(path, asked))
    else:
        refused(path, asked, "= 0.5 ms contradicts", f"steps by {step:g} (of no unit)")


def test_what_is_no_time_of_the_record_does_not_stand_in_its_way(tmp_path):
    asked = Asked("F_ref", "F", sample_time="0.5 ms")
    same(read_record(write_csv(tmp_path / "rig.csv", "T [degC],F_ref [kN],F [N],x [mm]"), asked))
    columns = {"F_ref": REFERENCE, "F": FORCE, "t": 2 * TIME[:-7]}
    savemat(tmp_path / "rig.mat", columns)
    asked = Asked("F_ref [N]", "F [N]", sample_time="0.5 ms")
    same(read_record(tmp_path / "rig.mat", asked))
    refused(tmp_path / "rig.mat", asked._replace(time="t [s]"), "has 393 samples")


def test_elements_of_arrays_are_channels_and_round_brackets_hold_units_too(tmp_path):
    path = write_csv(tmp_path / "rig.csv", "Time (ms),u[1],u[2] (N),Force (filtered)")
    same(read_record(path, Asked("u[1] [kN]", "u[2]")))
    same(read_record(path, Asked("u[1] (kN)", "u[2] [N]", "Time")))
    refused(path, Asked("u[1]", "u[2]"), "`u[1]` has no unit", '"u[1] [N]"')
    refused(path, Asked("u", "u[2]"), "it has: Time, u[1], u[2], Force (filtered)")


def write_mdf_twice(path, groups):
    """A file with F_ref once, and a channel F of each group's values."""
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version="4.10") as file:
        for signals in groups:
            made = [asammdf.Signal(v, TIME, unit="N", name=name) for name, v in signals]
            file.append(made)
        file.save(path, overwrite=True)
    return path


def test_a_channel_that_stands_in_two_groups_is_named_with_its_group(tmp_path):
    groups = [("F_ref", REFERENCE)], [("F", 2 * FORCE)], [("F", FORCE), ("x", FORCE)]
    path = write_mdf_twice(tmp_path / "rig.mf4", groups)
    refused(path, PLAIN, "`F` stands in more than one group", "name one: F@1, F@2")
    same(read_record(path, Asked("F_ref", "F@2")))
    same(read_record(path, Asked("F_ref", "F@2 [N]")))
    assert read_record(path, Asked("F_ref", "F@1")).force == pytest.approx(2 * FORCE)
    refused(path, Asked("F_ref", "F@3"), "`F@3` is no channel of it")


def test_a_channel_that_stands_twice_in_one_group_is_named_with_its_place(tmp_path):
    groups = [[("F_ref", REFERENCE), ("F", 2 * FORCE), ("F", FORCE)]]
    path = write_mdf_twice(tmp_path / "rig.mf4", groups)
    refused(path, PLAIN, "name one: F@0.2, F@0.3")
    same(read_record(path, Asked("F_ref", "F@0.3")))


def test_nan_in_time(tmp_path):
    time = np.where(np.arange(COUNT) == 30, np.nan, 1e3 * TIME)
    refused(write_csv(tmp_path / "rig.csv", time=time), PLAIN, "sample 31")


def test_nan_a_constant_input_and_a_short_record_stop_before_the_spectrum(tmp_path):
    holed = np.where(np.arange(COUNT) == 5, np.nan, FORCE)
    for columns, message in (
        ({"force": holed}, "first at sample 6"),
        ({"reference": np.full(COUNT, 7.0)}, "constant"),
    ):
        record = read_record(write_csv(tmp_path / "rig.csv", **columns), PLAIN)
        with pytest.raises(InputError, match=message):
            welch_response(record.reference, record.force, record.sample_time, record.name)
    path = write_csv(tmp_path / "rig.csv")
    lines = path.read_text(encoding="utf-8").splitlines()[:40]
    path.write_text("\n".join(lines), encoding="utf-8")
    record = read_record(path, PLAIN)
    with pytest.raises(InputError, match="too short"):
        welch_response(record.reference, record.force, record.sample_time, record.name)


def test_without_the_extra_an_mdf_file_says_what_to_install(tmp_path, monkeypatch):
    path = write_mdf(tmp_path / "rig.mf4")
    monkeypatch.setitem(__import__("sys").modules, "asammdf", None)
    refused(path, PLAIN, "mptune[data]")


def test_a_formula_in_an_mdf_file_is_not_evaluated(tmp_path):
    asammdf = pytest.importorskip("asammdf")
    with asammdf.MDF(version="4.10") as file:
        signal = asammdf.Signal(FORCE, TIME, unit="N", name="F", conversion={"formula": "X1*2"})
        file.append([signal, asammdf.Signal(REFERENCE, TIME, unit="N", name="F_ref")])
        file.save(tmp_path / "rig.mf4")
    refused(tmp_path / "rig.mf4", PLAIN, "formula")
