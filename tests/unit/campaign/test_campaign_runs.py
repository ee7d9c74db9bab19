"""Campaigns on the real simulator: the same results however they are run, failures kept."""

import numpy as np
import pytest
import xarray as xr

from mptune.campaign.adversary import find_worst
from mptune.campaign.campaign import run_campaign
from mptune.campaign.plan import plan_campaign
from mptune.campaign.simulate import FIGURES, Controlled, figures_of, simulate, simulate_rows
from mptune.campaign.workers import Workers, workers
from mptune.claim import claimed
from mptune.errors import InputError, MptuneError

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

WIDE = ("runs=30", "chunk=10", "friction=[0.5, 2]", "noise=[0.5, 2]")


def stored(folder):
    return xr.load_dataset(folder / "campaign.nc", engine="h5netcdf")


def test_two_workers_and_other_chunks_of_work_give_the_same_bits(plan, run, tmp_path):
    one = plan(*WIDE)
    alone = run(one, tmp_path / "alone")
    with workers(2) as team:
        (tmp_path / "two").mkdir()
        shared = run_campaign(one, tmp_path / "two", team)
    assert np.array_equal(alone.figures, shared.figures, equal_nan=True)
    assert stored(tmp_path / "alone").identical(stored(tmp_path / "two"))
    assert not (tmp_path / "two" / "campaign").exists()


@pytest.mark.parametrize("number", [0, 13, 29])
def test_a_run_is_replayed_exactly(plan, run, number):
    one = plan(*WIDE)
    shared = Controlled(one.study, one.gains, one.feedforward)
    again = figures_of(simulate(shared, one.draw(number), number))
    assert np.array_equal(run(one).figures[number], again, equal_nan=True)


def test_four_chambers_are_drawn_with_their_hoses_as_lines_and_without(load_shape, run):
    short = 'manoeuvre=[{distance="5 mm", duration="0.3 s", rest="0.1 s"}]'
    study = load_shape("four-converters", short, "campaign.lines=[0, 1]", "campaign.runs=6")
    one = plan_campaign(study)
    lined = [one.draw(number).lines >= 0.5 for number in range(6)]
    assert 0 < sum(lined) < 6
    result = run(one)
    assert np.isfinite(result.column("performance_index_ms")).all()
    assert result.column("energy_residual").max() < 5e-3


def test_the_file_says_what_was_run(plan, run, tmp_path):
    one = plan(*WIDE)
    run(one)
    data = stored(tmp_path)
    assert data.attrs["campaign_identity"] == one.identity()
    assert data["mass"].attrs["units"] == "kg"
    assert np.array_equal(data["friction"], one.points[:, 4])


def test_unstable_machines_are_recorded_with_their_reason(load_boom, plan, run):
    from mptune.campaign.plan import plan_campaign

    wild = load_boom(
        'manoeuvre=[{distance="70 mm", duration="1.25 s", rest="0.5 s"}]',
        "gains.k_p_vel=2e6 N s/m",
        "campaign.runs=3",
    )
    result = run(plan_campaign(wild))
    assert result.failures == 3
    assert set(result.reasons()) <= {"limit cycle", "saturated", "limit broken"}
    assert all(result.reason)
    assert np.isfinite(result.column("performance_index_ms")).all()


def test_what_cannot_be_simulated_is_an_error_in_its_row(plan, monkeypatch):
    one = plan(*WIDE)
    shared = Controlled(one.study, one.gains, one.feedforward)
    monkeypatch.setattr("mptune.campaign.simulate.simulate", lambda *_: 1 / 0)
    rows = simulate_rows(shared, [(3, one.draw(3))], version())
    assert rows.status == ["error"]
    assert "ZeroDivisionError" in rows.reason[0]
    assert np.isnan(rows.figures).all()


def version():
    from mptune.params.gains import version as number

    return number()


def test_a_worker_of_another_version_refuses(plan):
    one = plan(*WIDE)
    shared = Controlled(one.study, one.gains, one.feedforward)
    with pytest.raises(MptuneError, match=r"0\.0\.0 is needed"):
        simulate_rows(shared, [(0, one.draw(0))], "0.0.0")


def test_a_run_above_a_limit_has_failed(plan, run):
    result = run(plan("runs=4", "limits.performance_index=1 ms"))
    assert result.reasons() == {"performance_index above its limit": 4}
    assert (result.status == "stable").all()


class StopError(Exception):
    """The kill of these tests, where a real one is not needed."""


def interrupted(run, one, after, **options):
    def progress(_stage, share):
        if share * one.runs >= after:
            raise StopError

    with pytest.raises(StopError):
        run(one, progress=progress, **options)


def test_finished_chunks_ask_for_resume_and_are_not_run_again(plan, run, tmp_path):
    one = plan(*WIDE)
    undisturbed = run(one, tmp_path / "undisturbed").figures
    interrupted(run, one, 25)
    assert len(list((tmp_path / "campaign").glob("chunk-*.nc"))) == 2
    with pytest.raises(InputError, match="--resume"):
        run(one)
    seen = []
    result = run(one, resume=True, progress=lambda _, share: seen.append(share))
    assert round(seen[0] * one.runs) == 20
    assert np.array_equal(result.figures, undisturbed, equal_nan=True)


def test_chunks_of_another_campaign_are_refused(plan, run):
    interrupted(run, plan(*WIDE), 25)
    with pytest.raises(InputError, match=r"another campaign.*: seed 1 there, 2 here"):
        run(plan(*WIDE, "seed=2"), resume=True)
    with pytest.raises(InputError, match=r"noise .* there, .* here"):
        run(plan(*WIDE, "noise=[0.5, 3]"), resume=True)


@pytest.mark.parametrize("resume", [False, True])
def test_a_campaign_of_another_seed_is_kept_and_one_of_the_same_seed_replaced(
    plan, run, tmp_path, resume
):
    run(plan("runs=4"))
    kept = stored(tmp_path)
    with pytest.raises(InputError, match="holds a campaign of seed 1, and this one has seed 2"):
        run(plan("runs=4", "seed=2"), resume=resume)
    assert stored(tmp_path).identical(kept)
    run(plan("runs=5"), resume=resume)
    assert stored(tmp_path).sizes["run"] == 5


def test_one_folder_takes_one_campaign_at_a_time(plan, run, tmp_path):
    with claimed(tmp_path, "campaign", "a campaign of 9 runs, seed 7"):
        with pytest.raises(InputError, match="written to by a campaign of 9 runs, seed 7"):
            run(plan("runs=4"))
        run(plan("runs=4"), tmp_path / "other")
    assert list(tmp_path.iterdir()) == [tmp_path / "other"]
    assert not list((tmp_path / "other").glob(".*"))


def test_a_damaged_chunk_is_named(plan, run, tmp_path):
    one = plan(*WIDE)
    interrupted(run, one, 25)
    chunk = tmp_path / "campaign" / "chunk-000001.nc"
    chunk.write_bytes(chunk.read_bytes()[:1000])
    with pytest.raises(InputError, match=r"chunk-000001\.nc.*--resume"):
        run(one, resume=True)


def test_resuming_a_finished_campaign_runs_nothing(plan, run, monkeypatch):
    one = plan(*WIDE)
    first = run(one)
    monkeypatch.setattr("mptune.campaign.campaign._run_missing", None)
    assert np.array_equal(run(one, resume=True).figures, first.figures, equal_nan=True)


def test_a_scheduler_that_does_not_answer_is_named(monkeypatch):
    monkeypatch.setattr("mptune.campaign.workers._CONNECT", 0.5)
    with pytest.raises(InputError, match="does not answer"), workers(scheduler="tcp://127.0.0.1:9"):
        pass


def test_the_search_finds_a_machine_worse_than_any_drawn(plan, run):
    one = plan("runs=60", "duration=[0.8, 1.2]")
    team = Workers(1, {"backend": "sequential"})
    worst = find_worst(one, "peak_velocity_mm_s", team, evaluations=100)
    assert worst.draw.duration == pytest.approx(0.8, abs=0.02)  # the fastest move
    assert worst.value >= run(one).column("peak_velocity_mm_s").max() - 0.5
    shared = Controlled(one.study, one.gains, one.feedforward)
    again = figures_of(simulate(shared, worst.draw, 0))
    assert again[FIGURES.index("peak_velocity_mm_s")] == worst.value


def test_the_search_needs_a_known_figure_and_something_to_vary(plan):
    with pytest.raises(InputError, match="is no figure"):
        find_worst(plan(), "beauty", Workers(1, {}))
    fixed = ('mass=["1 t", "1 t"]', 'valve_delay=["5 ms", "5 ms"]',
             'oil_bulk_modulus=["1 GPa", "1 GPa"]')  # fmt: skip
    with pytest.raises(InputError, match="no parameter that varies"):
        find_worst(plan(*fixed), "final_error_mm", Workers(1, {}))
