"""The second study: feed-forward tuned too, and what the nonlinear machine makes of it."""

import pytest

from mptune.job.tune import tune_study
from mptune.params.gains import read_gains
from mptune.params.load import load_study
from mptune.verify.verify import verify

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

COARSE = ("uncertainty.points=2",)
BRIEF = (
    "verification.repeats=3",
    "verification.seeds=[1]",
    'verification.oil_bulk_moduli=["1200 MPa"]',
)


@pytest.fixture(scope="module")
def study(root):
    return load_study(root / "studies" / "boom-2dof" / "study.toml", [*COARSE, *BRIEF])


@pytest.fixture(scope="module")
def tuning(study, tmp_path_factory):
    return tune_study(study, tmp_path_factory.mktemp("two-dof"))


def test_the_published_gains_break_the_studys_gain_margin(study):
    from mptune.robust.sweep import sweep

    broken = [check.key for check in sweep(study).checks if check.status.value != "satisfied"]
    assert broken == ["gain_margin"]


def test_tuned_gains_and_feedforward_keep_margin_and_noise(tuning):
    tuned = tuning.tuned
    ahead = tuned.feedforward
    print(
        f"index on the sampled loop {1e3 * tuned.figures_before.tracking:.2f} -> "
        f"{1e3 * tuned.figures.tracking:.2f} ms, {ahead}, binding {', '.join(tuned.binding)}"
    )
    assert tuned.sweep.satisfied
    assert tuned.status.value == "optimal"
    checks = {check.key: check.found for check in tuned.sweep.checks}
    assert checks["gain_margin"] >= 1.25
    assert checks["noise_gain"] <= 34.1e6
    assert 24500 < ahead.acceleration_mass < 49000
    assert 0.005 < ahead.reference_lag < 0.03
    assert tuned.figures.tracking < 0.25 * tuned.figures_before.tracking


def test_the_gains_file_carries_the_feedforward(tuning):
    file = read_gains(tuning.files[0])
    assert file.margins == "satisfied"
    for key, value in tuning.tuned.feedforward.model_dump().items():
        assert getattr(file.feedforward, key) == pytest.approx(value, rel=1e-12)
    assert file.gains.k_p_pos == pytest.approx(tuning.tuned.gains.k_p_pos, rel=1e-12)


def test_the_nonlinear_machine_tracks_within_6_ms(study, tuning):
    result = verify(study, tuning.tuned.gains, tuning.tuned.feedforward)
    assert result.satisfied
    for case in result.worst_per_mass():
        index = case.mean("performance_index_ms")
        loss = case.mean("energy_loss_j_per_mm")
        print(f"{case.mass_kg:.0f} kg: mean index {index:.2f} ms, loss {loss:.1f} J/mm")
        assert index <= 6
