"""The studies around a state estimator on the nonlinear machine, on seeds that no search has seen.

``MPTUNE_BENCH_SETS`` movement sets per run are counted (the first is not), ``MPTUNE_BENCH_SEEDS``
seeds taken: 20 and 3 are those of the trial that the limits come from, fewer take less time. All
masses and oils of the study, valve delays drawn anew at each switching. Run with ``make trials``.
"""

import os

import numpy as np
import pytest

from mptune.certify.result import Grounds
from mptune.params.load import load_study
from mptune.robust.sweep import sweep
from mptune.verify.verify import verify

pytestmark = [pytest.mark.bench, pytest.mark.trial]

SETS, SEEDS = (
    int(os.environ.get(f"MPTUNE_BENCH_{name}", default))
    for name, default in (("SETS", "20"), ("SEEDS", "3"))
)
PAPER_S = (
    'controller.error="absolute"', 'controller.loss="ends"', "controller.horizon=1",
    'controller.weight_switching="100 N"', 'controller.weight_loss="80 N/J"',
    'controller.weight_converter="2e11 N s/m^6"',
)  # fmt: skip
STUDIES = {  # study, overrides, largest mean index at any of the masses [ms]
    "estimator, the paper's decision": ("boom-estimator", PAPER_S, 3.2),
    "estimator": ("boom-estimator", (), 3.0),
    "robust": ("boom-estimator-robust", PAPER_S, 5.5),
    "robust, mass learnt": ("boom-estimator-robust", ("feedforward.adaptive_mass=true",), 4.0),
    "adaptive, the paper's decision": ("boom-adaptive", PAPER_S, 2.4),
    "adaptive": ("boom-adaptive", (), 2.3),
}
FIGURES = (
    ("energy_loss_j_per_mm", "loss J/mm", 1),
    ("force_error_integral_kn2s", "force error kN² s", 1),
    ("valve_switches", "switches", 0),
    ("final_error_mm", "final mm", 2),
    ("converter_peak_mm", "converter mm", 1),
)
ASKED = {  # of a study as it stands: largest means
    "boom-estimator": {
        "energy_loss_j_per_mm": 14.5, "force_error_integral_kn2s": 18.0, "valve_switches": 560.0,
        "final_error_mm": 0.45,
    },
}  # fmt: skip
LARGEST_SETS = 4.0  # ms, index of 95 % of sets
PROVED = ("gain_margin", "sampled_sensitivity_peak", "disk_margin", "peak_compliance")
PUBLISHED_COMPLIANCE = 3.171e-7  # m/N, §5.1's box
PUBLISHED_NOISE = 2044.5  # N


def loaded(root, name, *options):
    chosen = [f"verification.seeds={list(range(101, 101 + SEEDS))}", *options]
    path = root / "studies" / name / "study.toml"
    return load_study(path, [f"verification.repeats={SETS + 1}", *chosen])


@pytest.mark.parametrize("label", STUDIES)
def test_a_study_tracks_as_it_says(root, label):
    name, options, most = STUDIES[label]
    study = loaded(root, name, *options)
    result, broken = verify(study), []
    for mass in study.study.verification.masses:
        cases = [case for case in result.cases if case.mass_kg == mass]
        sets = [one.performance_index_ms for case in cases for one in case.sets]
        found = {key: float(np.mean([case.figure(key) for case in cases])) for key, *_ in FIGURES}
        text = ", ".join(f"{name} {found[key]:.{digits}f}" for key, name, digits in FIGURES)
        print(
            f"\n{label}, {mass / 1e3:g} t: index {np.mean(sets):.2f} ms (95 % "
            f"{np.quantile(sets, 0.95):.2f}, worst {max(sets):.2f}); {text}"
        )
        assert all(case.stable for case in cases)
        broken += [f"{mass} index {np.mean(sets):.2f} ms"] if np.mean(sets) > most else []
        slow = not options and np.quantile(sets, 0.95) > LARGEST_SETS
        broken += [f"{mass} sets of a large index"] if slow else []
        asked = {} if options else ASKED.get(name, {})
        broken += [f"{mass} {key}" for key, limit in asked.items() if found[key] > limit]
    assert not broken


@pytest.mark.parametrize("name", ["boom-estimator", "boom-estimator-robust"])
def test_the_margins_are_certified_as_it_runs(root, name):
    """Every margin asked for is proved over the box, if not always to the last percent."""
    swept = sweep(loaded(root, name))
    for check in swept.checks:
        print(f"\n{name}: {check.key} {check.limit}: {check.found:.5g}, {check.status}", end="")
    proofs = swept.certificates
    for figure in ("sensitivity_peak", "disk_margin", "peak_compliance"):
        one = proofs.of("force_reference", "sampled", figure)
        print(f"\n{name}: {figure} {one.attained:.5g}, guaranteed {one.bound:.5g}", end="")
    assert swept.satisfied
    proved = {one.key: one.grounds for one in swept.checks if one.key in PROVED}
    assert set(proved.values()) == {Grounds.CERTIFIED}
    compliance = proofs.of("force_reference", "sampled", "peak_compliance")
    assert compliance.bound <= PUBLISHED_COMPLIANCE
    assert swept.noise_force <= 0.5 * PUBLISHED_NOISE
