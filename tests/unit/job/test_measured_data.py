"""Measured data, from a record to a study's uncertainty section."""

from __future__ import annotations

import numpy as np
import pytest
import tomlkit

from mptune.errors import InputError
from mptune.identify.fit import model
from mptune.identify.fitted import Certainty
from mptune.identify.timeseries import Asked
from mptune.job.measured import Reading, identify_data
from mptune.params.load import load_study

KNOWN = np.array([6e-3, 11e-3, 12e-3])
STEP, PERIOD, PERIODS = 1e-3, 5.0, 8
ASKED = Asked("F_ref", "F")


def force_after(reference, share_a, known=KNOWN):
    """The force over a periodic reference in steady state."""
    omega = 2 * np.pi * np.fft.rfftfreq(len(reference), STEP)
    return np.fft.irfft(np.fft.rfft(reference) * model(omega, known, share_a), len(reference))


def write_record(path, reference, force):
    time = 1e3 * STEP * np.arange(len(force))
    rows = np.stack([time, 1e-3 * reference, 1e-3 * force], axis=1).tolist()
    lines = ["t [ms],F_ref [kN],F [kN]", *(",".join(map(repr, row)) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def rig(tmp_path, boom):
    """A record of a multisine up to 60 Hz at 20 dB, its first period a transient."""
    rng = np.random.default_rng(3)
    samples = round(PERIOD / STEP)
    lines = np.unique(np.round(np.geomspace(2, 300, 50))).astype(int)
    spectrum = np.zeros(samples // 2 + 1, complex)
    spectrum[lines] = 1e5 * np.exp(2j * np.pi * rng.random(len(lines)))
    reference = np.fft.irfft(spectrum)
    force = np.tile(force_after(reference, boom.study.share_a), PERIODS + 1)
    force += 0.1 * np.std(force) * rng.standard_normal(len(force))
    force[:samples] += 5e3 * np.exp(-np.arange(samples) * STEP)
    force = np.append(force, np.zeros(700))  # an unfinished period is left out
    reference = np.resize(np.tile(reference, PERIODS + 1), len(force))
    return write_record(tmp_path / "rig.csv", reference, force), lines


def test_a_multisine_record_ends_in_a_section_that_a_study_takes(boom, rig, tmp_path, write_study):
    path, lines = rig
    result, files = identify_data(boom, Reading((path,), ASKED, period=PERIOD), tmp_path / "out")
    (found,) = result.fits
    for one, true in zip((found.tau_a, found.tau_b, found.delay), KNOWN, strict=True):
        assert one.value == pytest.approx(true, rel=0.05)
        assert one.low <= true <= one.high
    assert found.points == len(lines)
    assert result.satisfied
    assert [file.name for file in files] == ["rig.csv", "uncertainty.toml", "fit.svg"]
    assert all(file.stat().st_size > 100 for file in files)
    target = write_study({})
    document = tomlkit.parse(target.read_text(encoding="utf-8"))
    text = files[1].read_text(encoding="utf-8").replace("# measured = [", "measured = [")
    document["uncertainty"] = tomlkit.parse(text)["uncertainty"]
    target.write_text(tomlkit.dumps(document), encoding="utf-8")
    (tmp_path / "rig.csv").write_bytes(files[0].read_bytes())
    study = load_study(target)
    assert study.uncertainty.tau_a == pytest.approx(result.ranges["tau_a"], rel=1e-3)
    assert len(study.uncertainty.measured[0].rows) == len(lines)


def test_a_response_file_is_fitted_as_it_is(boom, rig, tmp_path):
    path, _ = rig
    first, files = identify_data(boom, Reading((path,), ASKED, period=PERIOD), tmp_path / "out")
    again, _ = identify_data(boom, Reading((files[0],)), tmp_path / "again")
    assert again.fits[0].tau_a == first.fits[0].tau_a
    assert again.json() == first.json()


def test_a_reference_behind_the_hold_lacks_half_a_period(boom, rig, tmp_path):
    path, _ = rig
    plain, _ = identify_data(boom, Reading((path,), ASKED, period=PERIOD), tmp_path / "a")
    held, files = identify_data(
        boom, Reading((path,), ASKED, period=PERIOD, held=True), tmp_path / "b"
    )
    added = np.array(held.ranges["delay"]) - np.array(plain.ranges["delay"])
    np.testing.assert_allclose(added, 5e-3, rtol=1e-9)  # T_S/2
    assert held.ranges["tau_a"] == plain.ranges["tau_a"]
    assert "measured = [" not in files[1].read_text(encoding="utf-8")


def test_welch_needs_no_period_and_agrees(boom, tmp_path):
    rng = np.random.default_rng(5)
    reference = 5e3 * rng.standard_normal(60_000)
    force = force_after(reference, boom.study.share_a)
    force += 0.1 * np.std(force) * rng.standard_normal(len(force))
    path = write_record(tmp_path / "noise.csv", reference, force)
    reading = Reading((path,), ASKED, segment=5.0, band=(2.0, 300.0))
    result, _ = identify_data(boom, reading, tmp_path / "out")
    found = result.fits[0]
    for one, true in zip((found.tau_a, found.tau_b, found.delay), KNOWN, strict=True):
        assert one.value == pytest.approx(true, rel=0.05)


def test_several_files_span_one_range_and_reach_beyond_it(boom, tmp_path):
    omega = np.geomspace(2, 300, 40)
    files = []
    for name, tau_a in (("cold", 4e-3), ("warm", 9e-3)):
        value = model(omega, np.array([tau_a, 11e-3, 12e-3]), boom.study.share_a)
        lines = ["frequency [rad/s],re,im"]
        table = np.stack([omega, value.real, value.imag], axis=1).tolist()
        lines += [",".join(map(repr, row)) for row in table]
        files.append(tmp_path / f"{name}.csv")
        files[-1].write_text("\n".join(lines), encoding="utf-8")
    result, _ = identify_data(boom, Reading(tuple(files)), tmp_path / "out")
    assert result.ranges["tau_a"] == pytest.approx((0.0, 14e-3), rel=1e-4)  # 5 ms beyond each end
    with pytest.raises(InputError, match="two files of one name"):
        identify_data(boom, Reading((files[0], files[0])), tmp_path / "out")


def test_an_uncertain_fit_does_not_count_as_met(boom, rig, tmp_path):
    path, _ = rig
    reading = Reading((path,), ASKED, period=PERIOD, band=(2.0, 30.0))
    result, _ = identify_data(boom, reading, tmp_path / "out")
    assert result.fits[0].certainty is not Certainty.DETERMINED
    assert not result.satisfied


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"period": 0.0123456}, "exact period"),
        ({"period": 40.0}, "record longer"),
        ({"period": PERIOD, "skip": 100.0}, "leaves nothing"),
        ({"segment": 60.0}, "segment"),
    ],
)
def test_impossible_settings_are_refused(boom, rig, tmp_path, settings, message):
    with pytest.raises(InputError, match=message):
        identify_data(boom, Reading((rig[0],), ASKED, **settings), tmp_path / "out")
