"""Bytes spoilt at random: studies, gains, CSV and MAT files (``make fuzz``, MINUTES chosen).

Whatever becomes of a file, it is read, or refused as the user's in few words: no other error, no
warning of ours.
"""

from __future__ import annotations

import os
import time
import warnings
from collections import Counter

import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from scipy.io import savemat

from mptune.errors import InputError
from mptune.identify.responses import read_response
from mptune.identify.timeseries import Asked, read_record
from mptune.params.gains import read_gains
from mptune.params.load import load_study

MINUTES = float(os.environ.get("MINUTES", "2"))
LONGEST = 4096  # bytes of a message
PIECES = [
    b"\x00", b"\xff", b"\r", b'"', b"'''", b"[", b"]]", b"{", b"=", b".", b",", b";", b"\t", b"-",
    b"nan", b"inf", b"1e400", b"9" * 30, b"\xef\xbb\xbf", b"\\u0000", b" degC", b" ton", b"[1]",
    b"2020-01-01", b"true", b"\n\n", b"#", b"(", b"\xc2\xb7", b"\xe2\x88\x92", b'"' * 3,
]  # fmt: skip
EDITS = st.lists(
    st.tuples(
        st.floats(0, 1, exclude_max=True),
        st.integers(0, 30),
        st.one_of(st.sampled_from(PIECES), st.binary(max_size=6)),
    ),
    min_size=1,
    max_size=4,
)


def spoil(whole, edits):
    """Return bytes with some of them replaced: (place, how many, by what)."""
    for place, length, piece in edits:
        at = int(place * len(whole))
        whole = whole[:at] + piece + whole[at + length :]
    return whole


@pytest.fixture(scope="module")
def samples(study_file, tmp_path_factory):
    """Whole files, and what reads each of them."""
    folder = tmp_path_factory.mktemp("whole")
    time_ms = 0.5 * np.arange(20)
    savemat(folder / "a.mat", {"t": time_ms, "F_ref": np.sin(time_ms), "F": np.cos(time_ms)})
    rows = "".join(f"{t!r},{np.sin(t)!r},{np.cos(t)!r}\n" for t in time_ms.tolist())
    response = "".join(f"{n},{1 / n!r},{-0.1 * n!r}\n" for n in range(1, 9))
    channels = Asked("F_ref [kN]", "F [kN]", "t [ms]")
    gains = (
        'format = 1\nstudy = "boom"\nstudy_hash = "0"\nversion = "0.1.0"\nwritten = "now"\n'
        'margins = "satisfied"\nclosed_loop = "not run"\ncontent_hash = "0"\n\n'
        "[gains]\nk_p_vel = 7e5\nk_p_pos = 13.0\nk_i_pos = 22.0\nomega = 50.0\nxi = 0.7\n"
        "tau = 0.002\n\n[feedforward]\nacceleration_mass = 0.0\n\n[figures]\na = 1.0\n"
    )
    return {
        "study.toml": (study_file.read_bytes(), load_study),
        "gains.toml": (gains.encode(), read_gains),
        "record.csv": (
            ("t [ms],F_ref [kN],F [kN]\n" + rows).encode(),
            lambda path: read_record(path, channels),
        ),
        "response.csv": (("frequency [rad/s],real,imag\n" + response).encode(), read_response),
        "record.mat": (
            (folder / "a.mat").read_bytes(),
            lambda path: read_record(path, channels),
        ),
    }


def outcome(read, path):
    with warnings.catch_warnings():
        warnings.filterwarnings("error", category=RuntimeWarning, module="mptune")
        try:
            read(path)
        except InputError as error:
            size = len(str(error).encode())
            return "refused" if size <= LONGEST else f"refused in {size} bytes"
    return "read"


def spoilt_files(samples, folder, examples, number, tried):
    """Try so many spoilt files."""

    @seed(number)
    @settings(
        max_examples=examples,
        derandomize=False,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(st.sampled_from(sorted(samples)), EDITS)
    def one(name, edits):
        whole, read = samples[name]
        path = folder / name
        path.write_bytes(spoil(whole, edits))
        tried[name, outcome(read, path)] += 1

    one()


def show(tried):
    for name in sorted({name for name, _ in tried}):
        print(f"{name:16} read {tried[name, 'read']:6} refused {tried[name, 'refused']:6}")


def test_some_spoilt_files_are_read_or_refused(samples, tmp_path):
    tried = Counter()
    spoilt_files(samples, tmp_path, 150, 1, tried)
    show(tried)
    assert {how for _, how in tried} == {"read", "refused"}


def test_a_type_beyond_the_reader_s_table_is_refused_before_it_kills_the_process(samples, tmp_path):
    whole, read = samples["record.mat"]
    path, places = tmp_path / "record.mat", 0
    for place in range(128, len(whole), 4):
        for kind in (b"\x13\0\0\0", b"\xff\xff\0\0", b"\0\0\0\xff", b"\x63\0\4\0"):
            path.write_bytes(whole[:place] + kind + whole[place + 4 :])
            places += outcome(read, path) == "refused"
    assert places > 50


@pytest.mark.fuzz
def test_spoilt_files_for_some_minutes(samples, tmp_path):
    end, number, tried = time.monotonic() + 60 * MINUTES, 2, Counter()
    while time.monotonic() < end:
        spoilt_files(samples, tmp_path, 300, number, tried)
        number += 1
    show(tried)
    assert {how for _, how in tried} == {"read", "refused"}
