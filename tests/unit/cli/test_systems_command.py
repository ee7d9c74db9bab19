"""``mptune systems`` as users run it, and what it leaves for the report."""

import json

import pytest

from mptune.cli.main import status
from mptune.job.gains import gains_file
from mptune.job.leftovers import leftovers
from mptune.params.gains import write_gains
from mptune.params.load import load_study
from mptune.report.blocks import Figure, Tabular
from mptune.report.content.systems import systems
from mptune.report.results import Results
from mptune.robust.sweep import sweep

SHORT = (
    (
        'manoeuvre=[{distance="10 mm", duration="0.4 s", rest="0.2 s"}, '
        '{distance="-10 mm", duration="0.4 s", rest="0.2 s"}]'
    ),
    "verification.repeats=2",
    "systems.repeats=2",
    "systems.beside=[]",
    'verification.masses=["49 t"]',
    "systems.gain_margin=1",
)


@pytest.fixture
def corners(study_file):
    return load_study(study_file, [*SHORT, "uncertainty.points=2"])


@pytest.fixture
def swept(corners):
    return sweep(corners)


@pytest.fixture
def gains(swept, tmp_path):
    """A file of the study's own gains, judged on the corners of the box alone."""
    path = tmp_path / "gains.toml"
    write_gains(path, gains_file(swept, swept.study.study.feedforward, (), None))
    return path


@pytest.mark.compiled
def test_the_comparison_is_printed_and_left_for_the_report(
    study_file, corners, swept, gains, tmp_path, capsys
):
    options = [part for value in SHORT for part in ("--set", value)]
    study = load_study(study_file, SHORT)
    options += ["--gains", str(gains)]  # made on a grid of its corners alone
    code = status(["systems", str(study_file), "--out", str(tmp_path), "--json", *options])
    captured = capsys.readouterr()
    values = json.loads(captured.out)
    assert code == (0 if values["satisfied"] else 1), captured.err
    found = {run["system"] for run in values["runs"]}
    assert [one["key"] for one in values["differs"]] == ["uncertainty.points"]
    machines = {"this_machine", "pid_loop", "cascade_loop", "steady_state"}
    assert found >= {"load_sensing", "digital_valves", "four_chamber", *machines}
    assert all(run["energy_residual"] < 5e-3 for run in values["runs"])
    assert {path.name for path in (tmp_path / "boom").iterdir()} == {"systems.json", "systems.svg"}

    left = leftovers(tmp_path / "boom", study)
    assert len(left.systems) == len(values["runs"]) + len(values["calibrated"])
    assert left.figures is not None
    assert "systems" in left.figures
    chapter = systems(Results(study, swept, swept, study.study.feedforward, leftovers=left))
    assert chapter is not None
    tables = [block for block in chapter.blocks if isinstance(block, Tabular)]
    assert [table.title for table in tables[:3]] == [
        "Systems under the same load and moves",
        "Controllers, and the boundary of the loss",
        "Calibrated values",
    ]
    assert {table.title for table in tables[3:]} >= {"systems.load_sensing", "systems.pid_loop"}
    assert any(isinstance(block, Figure) for block in chapter.blocks)
    assert leftovers(tmp_path / "boom", corners).systems == ()  # another grid, another model


def test_there_is_no_chapter_without_a_comparison(boom):
    results = Results(boom, None, None, boom.study.feedforward)
    assert systems(results) is None


def test_an_interrupted_comparison_has_status_130_and_leaves_nothing(
    study_file, gains, tmp_path, monkeypatch, capsys
):
    from mptune.job import systems as job

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(job, "contest", interrupted)
    options = [part for value in SHORT for part in ("--set", value)]
    line = ["systems", str(study_file), "--gains", str(gains), "--out", str(tmp_path / "out")]
    assert status([*line, *options]) == 130
    captured = capsys.readouterr()
    assert "interrupted" in captured.err
    assert not captured.out
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]
