"""The chain on the command line: a table for people, a list in JSON, a figure of the job."""

import json

import pytest

from mptune.cli.main import status

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

MODELS = ["Eq. 17 and 21", "true family", "with measurement path", "sampled"]
SWEEP = ("--uncertainty", "section-5-1", "--set", "uncertainty.sets.section-5-1.points=2")


@pytest.fixture
def sweep(study_file, tmp_path, capsys):
    def run(*arguments):
        code = status(["sweep", str(study_file), "--out", str(tmp_path), "-q", *SWEEP, *arguments])
        return code, capsys.readouterr().out

    return run


def test_sweep_prints_every_model_with_its_factor(sweep):
    code, out = sweep()
    assert code == 0
    table = out[out.index("How far the gain at F_ref may rise") :]
    rows = [line for line in table.splitlines() if line.strip().startswith(tuple(MODELS))]
    assert [next(name for name in MODELS if name in row) for row in rows] == MODELS
    assert "1.232" in table
    assert "24.5 t, d 14 ms" in table


def test_json_of_a_sweep_holds_the_chain(sweep):
    code, out = sweep("--json")
    links = json.loads(out)["chain"]
    assert code == 0
    assert [link["model"] for link in links] == MODELS
    assert links[-1]["gain_factor"] == pytest.approx(1.240, abs=0.001)
    assert links[-1]["at"]["mass_kg"] == 24500


def test_what_cannot_be_told_is_null_in_json_and_words_in_print(sweep):
    mass = ("--set", 'uncertainty.sets.section-5-1.mass=["11 t", "250 t"]')
    _, out = sweep("--json", *mass)
    assert json.loads(out)["chain"][-1]["gain_factor"] is None
    assert "cannot be told" in sweep(*mass)[1]
