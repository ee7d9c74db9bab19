"""``mptune weights`` as users run it."""

import json
import tomllib

import pytest

from mptune.cli.main import status

SHORT = (
    *("--set", 'manoeuvre=[{distance="5 mm", duration="0.3 s", rest="0.1 s"}]'),
    *("--set", "verification.repeats=1"),
    *("--sets", "1", "--workers", "1"),
)


@pytest.fixture
def cli(study_file, tmp_path, capsys):
    def run(*arguments):
        code = status(["weights", str(study_file), "--out", str(tmp_path), *arguments])
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.mark.compiled
def test_a_search_leaves_weights_figure_and_database_and_goes_on(cli, tmp_path, study_file):
    code, out, err = cli(*SHORT, "--trials", "4", "--json")
    values = json.loads(out)
    assert code == (0 if values["satisfied"] else 1), err
    assert out.count("\n") == 1
    assert values["trials"] == 4
    folder = tmp_path / "boom"
    left = {"weights.db", "weights.json", "weights.toml", "weights.svg"}
    assert {path.name for path in folder.iterdir()} == left
    text = (folder / "weights.toml").read_text(encoding="utf-8")
    section = tomllib.loads(text)["controller"]
    recommended = values["recommended"]["weights"]
    assert section["weight_loss"] == f"{recommended['weight_loss_n_per_j']:.6g} N/J"
    from mptune.params.load import load_study

    overrides = [f'controller.{key}="{value}"' for key, value in section.items()]
    assert load_study(study_file, overrides).study.controller.weight_loss == pytest.approx(
        recommended["weight_loss_n_per_j"], rel=1e-5
    )
    code, out, _ = cli(*SHORT, "--trials", "6")
    assert "Pareto front of 6 trials" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--sampler", "dice"), "--sampler"),
        (("--also", "mass"), "--also"),
        (("--storage", "nothing://x"), "--storage"),
        (("--trials", "0"), "--trials"),
    ],
)
def test_bad_input_ends_with_2(cli, arguments, message):
    code, _, err = cli(*SHORT, *arguments)
    assert code == 2
    assert message in err
