"""Data files that would run, read elsewhere or never end: refused, or read as far as asked."""

from __future__ import annotations

import time
import tracemalloc
import zlib

import asammdf
import h5py
import numpy as np
import pytest
from asammdf.blocks import v2_v3_blocks, v4_blocks
from asammdf.blocks.conversion_utils import from_dict

from mptune import hdf5
from mptune.errors import InputError
from mptune.identify import mat_files
from mptune.identify.channels import read_channels
from mptune.identify.timeseries import Asked, read_record

COUNT = 400
TIME = 1e-3 * np.arange(COUNT)
WAVE = np.sin(40 * TIME)
PLAIN = Asked("F_ref [kN]", "F [kN]", "t [s]")


def refused(path, *words, asked=PLAIN):
    with pytest.raises(InputError) as caught:
        read_record(path, asked)
    for word in words:
        assert word in str(caught.value)


def mdf_with(path, version, conversion=None, on="F", time_conversion=None):
    """Write a file whose channel, or time, has a conversion in the file's own words."""
    with asammdf.MDF(version=version) as file:
        for name in ("F_ref", "F"):
            file.append([asammdf.Signal(WAVE, TIME, unit="kN", name=name)])
        for group, name in enumerate(("F_ref", "F")):
            if name == on and conversion:
                file.groups[group].channels[1].conversion = conversion
            if name == on and time_conversion:
                file.groups[group].channels[0].conversion = time_conversion
        return file.save(path, overwrite=True)


def formula_3(text):
    return v2_v3_blocks.ChannelConversion(conversion_type=10, formula=text)


def formula_4(text):
    return from_dict({"formula": text})


FORMULAS = ("X1 * 2", "__import__('os').system('touch injected')", "X1.__class__")


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize(("version", "formula"), [("3.30", formula_3), ("4.10", formula_4)])
def test_no_formula_of_any_version_is_evaluated(tmp_path, monkeypatch, version, formula, text):
    monkeypatch.chdir(tmp_path)
    for module in (v2_v3_blocks, v4_blocks):
        monkeypatch.setattr(module, "evaluate", lambda *_: pytest.fail("a formula was evaluated"))
        monkeypatch.setattr(module, "lambdify", lambda *_: pytest.fail("a formula was compiled"))
    name = "rig.mdf" if version < "4" else "rig.mf4"
    asked = Asked("F_ref", "F")
    refused(mdf_with(tmp_path / name, version, formula(text)), "formula", "`F`", asked=asked)
    path = mdf_with(tmp_path / f"t-{name}", version, time_conversion=formula(text))
    refused(path, "formula", asked=asked)
    assert not (tmp_path / "injected").exists()


@pytest.mark.parametrize("version", ["2.14", "3.30", "4.10", "4.20"])
def test_numbers_of_every_version_are_read(tmp_path, version):
    path = mdf_with(tmp_path / "rig.mdf", version)
    record = read_record(path, Asked("F_ref", "F"))
    np.testing.assert_allclose(record.force, 1e3 * WAVE)
    linear = from_dict({"a": 2.0, "b": 1.0})
    if version >= "4":
        doubled = read_record(mdf_with(path, version, linear), Asked("F_ref", "F"))
        np.testing.assert_allclose(doubled.force, 1e3 * (2 * WAVE + 1))


def mat_73(path, change=lambda file: None):
    with h5py.File(path, "w") as file:
        for name, values in (("F_ref", WAVE), ("F", WAVE), ("t", TIME)):
            file[name] = values[:, None]
        change(file)
    return path


def links_in_circles(file):
    deep = file.create_group("log")
    for n in range(5):
        file[f"root{n}"] = file["/"]
        deep[f"root{n}"] = file["/"]
        deep[f"self{n}"] = deep


def dangling(file):
    file["gone"] = h5py.SoftLink("/nowhere")
    file["circle"] = h5py.SoftLink("/circle")


def huge_and_unasked(file):
    file.create_dataset("huge", (400_000_000,), "f8", chunks=(1_000_000,), compression="gzip")


@pytest.mark.parametrize("change", [links_in_circles, dangling, huge_and_unasked])
def test_of_mat_73_only_what_is_asked_is_read_at_once(tmp_path, change):
    path = mat_73(tmp_path / "rig.mat", change)
    begun = time.monotonic()
    tracemalloc.start()
    record = read_record(path, PLAIN)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    np.testing.assert_allclose(record.force, 1e3 * WAVE)
    assert time.monotonic() - begun < 10
    assert peak < 50e6


def test_a_channel_beyond_any_record_is_refused_with_its_size(tmp_path):
    path = mat_73(tmp_path / "rig.mat", huge_and_unasked)
    refused(path, "3.2 GB", asked=Asked("huge [kN]", "F [kN]", "t [s]"))


def test_many_objects_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(hdf5, "_MOST_OBJECTS", 100)

    def many(file):
        group = file.create_group("many")
        for n in range(101):
            group.create_group(str(n))

    refused(mat_73(tmp_path / "rig.mat", many), "objects")


def external_storage(file):
    del file["F"]
    file.create_dataset("F", (COUNT,), "u1", external=[("/etc/passwd", 0, COUNT)])


def external_link(file):
    del file["F"]
    file["F"] = h5py.ExternalLink("/etc/other.h5", "/F")


def virtual(file):
    del file["F"]
    layout = h5py.VirtualLayout((COUNT,), "f8")
    layout[:] = h5py.VirtualSource("/etc/other.h5", "F", (COUNT,))
    file.create_virtual_dataset("F", layout)


def external_below(file):
    file.create_group("a/b").create_dataset("c", (9,), "u1", external=[("/etc/passwd", 0, 9)])


@pytest.mark.parametrize("change", [external_storage, external_link, virtual, external_below])
def test_nothing_outside_a_file_is_read(tmp_path, change):
    refused(mat_73(tmp_path / "rig.mat", change), "another file")


def test_a_packed_variable_that_unpacks_beyond_memory_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(mat_files, "_LARGEST", 10_000_000)
    packing = zlib.compressobj(9)
    piece = bytes(1 << 20)
    packed = b"".join(packing.compress(piece) for _ in range(10)) + packing.flush()
    tag = (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little")
    path = tmp_path / "rig.mat"
    header = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    path.write_bytes(header + tag + packed)
    assert path.stat().st_size < 2e4
    refused(path, "unpacks to more than 0.01 GB")


def test_names_alone_are_read_before_a_channel_is_asked_for(tmp_path):
    channels = read_channels(mat_73(tmp_path / "rig.mat", huge_and_unasked))
    assert channels.names == ("F", "F_ref", "huge", "t")
