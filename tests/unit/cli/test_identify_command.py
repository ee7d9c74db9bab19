"""``mptune identify`` as users run it."""

import json

import pytest

from mptune.cli.main import status

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

BRIEF = (
    *("--set", 'identification.pressures=["4 MPa", "13 MPa"]'),
    *("--set", 'identification.oil_bulk_moduli=["1200 MPa"]'),
    *("--set", 'identification.frequency=["20 rad/s", "100 rad/s"]'),
    *("--set", "identification.frequencies=3"),
)


@pytest.fixture
def identify(study_file, tmp_path, capsys):
    def run(*arguments):
        code = status(["identify", str(study_file), "--out", str(tmp_path), "-q", *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def test_json_holds_panels_counts_and_agreement(identify):
    code, out, _ = identify("--json", *BRIEF)
    values = json.loads(out)
    assert code == 0
    assert out.count("\n") == 1
    assert values["satisfied"] is True
    assert values["excitation"] == "sine"
    assert len(values["panels"]) == 2
    for panel in values["panels"]:
        assert panel["points"] == 3
        assert panel["skipped_points"] == 3
        assert panel["fits"]["fitted"] == 9
        assert len(panel["frequency_rad_s"]) == len(panel["deviation_median_db"]) == 3
        assert panel["agreement"][0]["share_within"] == 1


def test_the_table_shows_limits_counts_and_files(identify, tmp_path):
    code, out, _ = identify(*BRIEF)
    assert code == 0
    for words in ("B_oil = 1200 MPa", "±0.5 dB, ±8°", "agrees", "3 skipped", "all valid"):
        assert words in out
    written = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {"identification.nc", "identification.svg"}


def test_each_delay_has_its_panels_and_its_figure(identify, tmp_path):
    code, out, _ = identify("--json", "--delay", "0 ms", "--delay", "8 ms", *BRIEF)
    assert code in {0, 1}
    delays = [panel["valve_delay_s"] for panel in json.loads(out)["panels"]]
    assert delays == [0, 0, 0.008, 0.008]
    written = {path.name for path in tmp_path.rglob("*.svg")}
    assert written == {"identification.svg", "identification-8ms.svg"}


def test_disagreement_ends_with_status_1(identify):
    """A loop that knows the oil exactly lags by T_S, not by the T_S/2 of theory."""
    arguments = [one.replace("1200 MPa", "1400 MPa").replace('"20', '"60') for one in BRIEF]
    arguments = [one.replace('"100 rad/s"', '"200 rad/s"') for one in arguments]
    code, out, _ = identify(*arguments)
    assert code == 1
    assert "DISAGREES" in out


@pytest.mark.parametrize("excitation", ["multisine", "chirp"])
def test_other_excitations(identify, excitation):
    code, out, _ = identify("--json", "--excitation", excitation, *BRIEF)
    assert code in {0, 1}
    assert json.loads(out)["excitation"] == excitation


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--excitation", "square"), "sine, multisine, chirp"),
        (("--delay", "8"), "has no unit"),
        (("--delay", "12 ms"), "sampling period"),
        (("--delay", "8 mm"), "wrong dimension"),
        (("--set", 'identification.positions=["2 m"]'), "beyond the stroke"),
    ],
)
def test_bad_input_ends_with_status_2_and_leaves_nothing(identify, tmp_path, arguments, words):
    code, out, err = identify(*arguments)
    assert code == 2
    assert words in err
    assert out == ""
    assert not list(tmp_path.iterdir())
