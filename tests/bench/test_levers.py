"""The levers one on top of the other, on the nonlinear machine and in the linear loop: printed.

Published gains on the base study over section 5.1's box, as an independent trial put them together.
"""

import time

import numpy as np
import pytest

from mptune.params.load import load_study
from mptune.robust.families import true_family
from mptune.robust.grid import first_grid, frequency_range
from mptune.robust.model import LinearModel
from mptune.verify.verify import verify

pytestmark = [pytest.mark.bench, pytest.mark.trial]

DELAY = ("controller.delay_prediction='6.25 ms'",)
ESTIMATOR = ("estimator.kind='state'", "estimator.bandwidth='40 rad/s'")
AHEAD = (
    "feedforward.acceleration_mass='37 t'",
    "feedforward.preview='11 ms'",
    "estimator.reference_injection=true",
)
STEPS = {
    "published": (),
    "delay predicted": DELAY,
    "state estimator": DELAY + ESTIMATOR,
    "acceleration ahead": DELAY + ESTIMATOR + AHEAD,
}
INDEX = {  # ms at 24.5 and 49 t, of the trial
    "published": (15.2, 22.9),
    "delay predicted": (15.3, 23.1),
    "state estimator": (8.4, 16.5),
    "acceleration ahead": (4.7, 6.1),
}
FORCE = 2  # row of the loop at F_ref


def study_of(changes):
    few = ("verification.seeds=[11, 12, 13]", "verification.repeats=6")
    return load_study("studies/boom/study.toml", [*few, *changes], "section-5-1")


@pytest.mark.parametrize("name", STEPS)
def test_a_lever_does_what_the_trial_saw(name):
    study = study_of(STEPS[name])
    result = verify(study)
    model = LinearModel.of(study)
    omega = first_grid(*frequency_range(model.plants, model.nominal, model.gains))
    margins = true_family(model, model.gains, model.paths[1], omega).margins
    for mass, expected in zip((24_500.0, 49_000.0), INDEX[name], strict=True):
        cases = [case for case in result.cases if case.mass_kg == mass]
        index, loss, force, switches = (
            float(np.mean([case.mean(key) for case in cases]))
            for key in ("performance_index_ms", "energy_loss_j_per_mm",
                        "force_error_integral_kn2s", "valve_switches")
        )  # fmt: skip
        print(
            f"{name}, {mass / 1e3:g} t: index {index:.2f} ms, loss {loss:.1f} J/mm, force error "
            f"{force:.1f} kN² s, {switches:.0f} switches; at F_ref: gain margin "
            f"{margins.gain_margin[FORCE].min():.2f}, M_S "
            f"{margins.sensitivity_peak[FORCE].max():.2f}"
        )
        assert index == pytest.approx(expected, rel=0.1)


def test_the_closed_loop_is_hardly_slower_with_all_of_it():
    plain, full = (study_of(STEPS[name]) for name in ("delay predicted", "acceleration ahead"))
    spans = {}
    for _ in range(3):
        for name, study in (("published", plain), ("estimator", full)):
            begin = time.perf_counter()
            verify(study)
            spent = time.perf_counter() - begin
            spans[name] = min(spent, spans.get(name, spent))
    ratio = spans["estimator"] / spans["published"]
    print(f"published {spans['published']:.2f} s, with all of it {spans['estimator']:.2f} s")
    print(f"ratio {ratio:.3f}")
    assert ratio <= 1.15
