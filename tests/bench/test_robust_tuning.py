"""How robust the boom's loop can be made as it runs, and what that costs; ``make trials``.

§5.1's box, filters as they are, both ratios allowed up to 1, at the published gains' peak
compliance and noise gain. The machine is the nonlinear one, with oil of 1200 MPa.
"""

from __future__ import annotations

import time

import numpy as np
import pytest

from mptune.loops.broken import FORCE
from mptune.params.load import load_study
from mptune.tune.tuner import tune
from mptune.verify.verify import verify

pytestmark = [pytest.mark.bench, pytest.mark.trial]

MACHINE = (
    'verification.oil_bulk_moduli=["1200 MPa"]',
    "verification.repeats=10",
)
ROBUST = (
    "uncertainty.sets.section-5-1.points=3",
    "requirements.velocity_ratio=1.0",
    "requirements.position_ratio=1.0",
    'requirements.peak_compliance="0.317 um/N"',
    'requirements.noise_gain="34.1 MN/m"',
    'objective={kind="robustness", tracking_loop="sampled"}',
    *MACHINE,
)
AHEAD = 'objective.free=["acceleration_mass", "reference_lag"]'
FIGURES = {
    "performance_index_ms": "index [ms]",
    "energy_loss_j_per_mm": "loss [J/mm]",
    "force_error_integral_kn2s": "dF² [kN² s]",
    "final_error_mm": "final [mm]",
    "valve_switches": "switches",
}


def on_the_machine(study, gains, feedforward):
    """Return each mass's figures, ``{mass: {figure: (mean, least, largest)}}``, printed."""
    cases = verify(study, gains, feedforward=feedforward).cases
    assert all(case.stable for case in cases)
    found = {}
    for mass in sorted({case.mass_kg for case in cases}):
        some = [case for case in cases if case.mass_kg == mass]
        found[mass] = {
            key: (
                np.mean([case.figure(key) for case in some]),
                min(case.span(key)[0] for case in some),
                max(case.span(key)[1] for case in some),
            )
            for key in FIGURES
        }
        texts = (
            f"{FIGURES[key]} {one[0]:.2f} ({one[1]:.2f} to {one[2]:.2f})"
            for key, one in found[mass].items()
        )
        print(f"  {mass / 1e3:g} t: " + ", ".join(texts))
    return found


def shown(study, label):
    """Return a tuning, its certified disk margin printed beside what it costs."""
    start = time.perf_counter()
    found = tune(study)
    took = time.perf_counter() - start
    margin = found.sweep.certificates.of("force_reference", "sampled", "disk_margin")
    factor = found.sweep.sampled.worst("gain_margin", FORCE)[0]
    print(
        f"\n{label}: {found.status}, disk margin {margin.attained:.4f}, proved {margin.bound:.4f}, "
        f"gain margin {factor:.3f}, compliance {1e6 * found.figures.peak_compliance:.3f} mm/kN, "
        f"noise gain {found.sweep.noise_gain / 1e6:.2f} MN/m, "
        f"Eq. 21 {found.sweep.position.worst_ratio:.3f}, "
        f"linear index {1e3 * found.figures.tracking:.2f} ms; {took:.1f} s\n  {found.gains}, "
        f"{found.feedforward}; at {', '.join(found.binding)}"
    )
    assert found.sweep.satisfied
    return found, margin.bound


def test_robustness_of_the_loop_as_it_runs(study_file):
    study = load_study(study_file, ROBUST, "section-5-1")
    tune(study)  # kernels loaded
    print("published:")
    on_the_machine(study, study.study.gains, study.study.feedforward)
    cases = {
        "both ratios up to 1": (),
        "Eq. 21 up to 0.48": ("requirements.position_ratio=0.48",),
        "with feed-forward, index up to 10 ms": (AHEAD, 'requirements.tracking_index="10 ms"'),
        "with feed-forward, index up to 6 ms": (AHEAD, 'requirements.tracking_index="6 ms"'),
    }
    for label, more in cases.items():
        study = load_study(study_file, (*ROBUST, *more), "section-5-1")
        found, proved = shown(study, label)
        assert proved >= 0.5
        on_the_machine(study, found.gains, found.feedforward)


def test_the_papers_study_tuned_as_it_runs_is_better_on_the_machine(study_file):
    asked = (
        "uncertainty.points=3",
        'objective.tracking_loop="sampled"',
        'requirements.noise_gain="34.1 MN/m"',
        *MACHINE,
    )
    study = load_study(study_file, asked)
    found, _ = shown(study, "tracking as it runs")
    print(f"  linear index of the published gains {1e3 * found.figures_before.tracking:.2f} ms")
    tuned = on_the_machine(study, found.gains, found.feedforward)
    published = on_the_machine(study, study.study.gains, study.study.feedforward)
    for mass, figures in tuned.items():
        index = "performance_index_ms"
        assert figures[index][0] < published[mass][index][0]
        for key in set(FIGURES) - {index}:  # no worse than the spread
            assert figures[key][0] < published[mass][key][2]
