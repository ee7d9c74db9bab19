"""``mptune tune`` as users run it: structures, comparison, front, JSON, and bad words."""

import json

import pytest

from mptune.cli.main import status

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

CORNERS = ("--set", "uncertainty.points=2")
FIGURES = {"tracking_index_s", "k_i_pos", "load_step_m_per_n", "bandwidth_rad_s"}
FIGURES |= {"disk_margin", "peak_compliance_m_per_n"}
GAINS = {"k_p_vel", "k_p_pos", "k_i_pos", "omega", "xi", "tau"}


@pytest.fixture
def tune(study_file, tmp_path, capsys):
    """Run ``mptune tune`` on the boom study's corners; return status, stdout and stderr."""

    def run(*arguments):
        code = status(["tune", str(study_file), "--out", str(tmp_path), *CORNERS, *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def strict(text):
    def refuse(token):
        raise AssertionError(token)

    return json.loads(text, parse_constant=refuse)


def test_json_of_a_comparison_and_a_front_holds_the_agreed_keys(tune, tmp_path):
    code, out, err = tune("--json", "--compare", "--front", "2")
    values = strict(out)
    assert code == (0 if values["verdict"] == "met" else 1), err
    assert {
        "status", "structure", "gains", "feedforward", "estimator", "gains_before",
        "velocity_worst_ratio",
        "position_worst_ratio", "satisfied", "objective", "binding", "rounds", "blocking",
        "evaluations", "velocity_gain_limited_by", "compared", "front", "verdict",
        "verdict_reason", "witness", "warnings",
    } == set(values)  # fmt: skip
    assert set(values["gains"]) == GAINS
    assert set(values["objective"]["after"]) == FIGURES
    assert [row["structure"] for row in values["compared"]] == ["own", "p", "pi", "pid", "eq22"]
    for row in values["compared"]:
        assert set(row["gains"]) == GAINS
        assert set(row["figures"]) == FIGURES
        assert row["satisfied"]
    assert len(values["front"]) == 2
    assert values["front"][0]["figures"]["k_i_pos"] < values["front"][1]["figures"]["k_i_pos"]
    written = {path.name for path in (tmp_path / "boom").iterdir()}
    stored = {"gains.toml", "comparison.json", "front.json"}
    assert written == stored | {"controllers.svg", "front.svg"}


def test_tables_name_the_controllers_and_the_points(tune):
    code, out, _ = tune("--compare", "--front", "2")
    assert code == (0 if out.startswith("Verdict: met: ") else 1)
    assert out.startswith("Verdict: met")
    for words in (
        "PID with filter",
        "Eq. 22",
        "Tracking against disturbance",
        "The gains lie at:",
        "ms",
    ):
        assert words in out
    assert "nan" not in out
    assert "inf" not in out


@pytest.mark.parametrize("structure", ["p", "pid"])
def test_a_structure_is_tuned_and_named(tune, structure):
    code, out, _ = tune("--json", "--structure", structure)
    values = strict(out)
    assert code == (0 if values["verdict"] == "met" else 1)
    assert values["structure"] == structure
    assert values["satisfied"]


def test_an_unknown_structure_is_bad_input_and_leaves_nothing(tune, tmp_path):
    code, out, err = tune("--structure", "h-infinity")
    assert (code, out) == (2, "")
    assert "p, pi, pid, eq22" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("count", ["-1", "51", "two"])
def test_a_count_of_points_that_cannot_be_is_bad_input(tune, count):
    assert tune("--front", count)[0] == 2


BLOCKED = {
    "velocity": ("requirements.velocity_ratio=0.45", "velocity_ratio"),
    "position": ("requirements.position_ratio=0.1", "position_ratio"),
}


@pytest.mark.parametrize("case", BLOCKED)
def test_what_cannot_be_met_ends_with_status_1_and_says_what_blocks(tune, case):
    override, name = BLOCKED[case]
    code, out, _ = tune("--json", "--set", override)
    values = strict(out)
    assert code == 1
    assert values["status"] == "infeasible"
    assert not values["satisfied"]
    assert values["blocking"]["requirement"] == name
    assert values["blocking"]["at"]["mass_kg"] == 49000
    assert values["blocking"]["remedy"]


def test_comparison_and_front_of_what_cannot_be_met_say_so_too(tune):
    arguments = ("--compare", "--front", "2", "--set", "requirements.velocity_ratio=0.45")
    code, out, err = tune(*arguments)
    assert code == 1, err
    assert out.count("infeasible") >= 4
    code, out, _ = tune("--json", *arguments)
    assert code == 1
    assert strict(out)["front"] == []


def test_a_start_beyond_numbers_is_null_in_json(tune):
    code, out, _ = tune("--json", "--set", "gains.k_p_pos=1e5 1/s")
    assert code == (0 if json.loads(out)["verdict"] == "met" else 1)
    assert strict(out)["objective"]["before"]["tracking_index_s"] is None
