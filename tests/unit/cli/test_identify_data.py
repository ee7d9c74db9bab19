"""``mptune identify --data`` as users run it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mptune.cli.main import status
from mptune.identify.fit import model


@pytest.fixture
def response(tmp_path, boom):
    omega = np.geomspace(2, 300, 60)
    value = model(omega, np.array([6e-3, 11e-3, 12e-3]), boom.study.share_a)
    rng = np.random.default_rng(1)
    value *= 1 + 0.001 * (rng.standard_normal(60) + 1j * rng.standard_normal(60))
    table = np.stack([omega, 20 * np.log10(abs(value)), np.degrees(np.angle(value))], axis=1)
    lines = ["omega [rad/s],magnitude [dB],phase [deg]"]
    lines += [",".join(map(repr, row)) for row in table.tolist()]
    path = tmp_path / "rig.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.fixture
def cli(study_file, tmp_path, capsys):
    def run(*arguments):
        code = status(["identify", str(study_file), "--out", str(tmp_path / "out"), *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def test_json_holds_fits_and_ranges_in_si(cli, response):
    code, out, _ = cli("--json", "--data", str(response))
    values = json.loads(out)
    assert code == 0
    (fitted,) = values["fits"]
    assert fitted["tau_a_s"]["value"] == pytest.approx(6e-3, rel=0.05)
    assert fitted["delay_s"]["low"] < 12e-3 < fitted["delay_s"]["high"]
    low, high = values["uncertainty"]["tau_b_s"]
    assert low < 11e-3 < high


def test_people_get_a_table_and_the_section(cli, response, tmp_path):
    code, out, _ = cli("-q", "--data", str(response))
    assert code == 0
    assert "[uncertainty]" in out
    assert 'tau_a = ["' in out
    assert (tmp_path / "out" / "boom" / "measured" / "uncertainty.toml").is_file()


def test_an_undetermined_fit_leaves_with_1(cli, response):
    code, out, _ = cli("-q", "--data", str(response), "--band", "2 rad/s", "20 rad/s")
    assert code == 1
    assert "determined" in out


def test_a_good_fit_leaves_with_0_though_the_order_of_the_lags_is_open(cli, response):
    code, out, _ = cli("-q", "--data", str(response), "--band", "2 rad/s", "100 rad/s")
    assert code == 0
    assert "order of" in out
    assert "not how far the machine varies" in " ".join(out.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--input", "F_ref"), "--data"),
        (("--period", "5 s"), "--data"),
        (("--data", "RIG", "--input", "F_ref"), "belong together"),
        (("--data", "RIG", "--period", "5 s"), "name the channels"),
        (("--data", "RIG", "--input", "F_ref", "--output", "F"), "`F_ref`"),
        (("--data", "RIG", "--band", "2 Hz", "20 Hz"), "radians or cycles"),
        (("--data", "RIG", "--band", "0 rad/s", "20 rad/s"), "not above 0"),
        (("--data", "gone.csv"), "does not exist"),
    ],
)
def test_bad_options_leave_with_2(cli, response, arguments, message):
    code, out, err = cli(*(str(response) if one == "RIG" else one for one in arguments))
    assert code == 2
    assert message in err
    assert out == ""
