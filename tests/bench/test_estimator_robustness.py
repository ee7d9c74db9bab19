"""A state estimator with feed-forward on machines that it was not tuned for: printed and judged.

Gains are those of ``studies/boom-estimator`` where the study stands, else an independent trial's,
on the same machine, with the paper's decision. Seeds are none that a search has seen. What counts
is the mean over oils and sets at each mass, as in the trial's table; the worst is printed too.
"""

import time
from pathlib import Path

import numpy as np
import pytest

from mptune.params.load import load_study
from mptune.verify.verify import verify

pytestmark = [pytest.mark.bench, pytest.mark.trial]

STUDY = Path("studies/boom-estimator/study.toml")
TRIAL = (
    "estimator.kind='state'", "estimator.bandwidth='45.8 rad/s'", "estimator.mass='24.32 t'",
    "estimator.reference_injection=true", "controller.delay_prediction='6.25 ms'",
    "feedforward.acceleration_mass='38.3 t'", "feedforward.preview='26.9 ms'",
    "feedforward.viscous_friction='3000 N s/m'", "feedforward.coulomb_friction='600 N'",
    "gains.k_p_vel='1251960 N s/m'", "gains.k_p_pos='12.83 1/s'", "gains.k_i_pos='13.52 1/s^2'",
    "gains.omega='114.2 rad/s'", "gains.xi=0.384", "gains.tau='8.92 ms'",
)  # fmt: skip
OILS = "verification.oil_bulk_moduli=['800 MPa', '1200 MPa', '1400 MPa']"
MASSES = "verification.masses=['24.5 t', '36 t', '49 t']"
LARGEST_INDEX, LARGEST_FORCE_ERROR = 5.0, 35.0  # ms, kN² s
SLOWER = 1.15  # than with the published gains, at most


def study_of(*changes, estimated=True, seeds=(31,), repeats=6):
    few = (f"verification.seeds={list(seeds)}", f"verification.repeats={repeats}", OILS, MASSES)
    if estimated and STUDY.exists():
        return load_study(STUDY, [*few, *changes])
    own = TRIAL if estimated else ()
    return load_study("studies/boom/study.toml", [*few, *own, *changes], "section-5-1")


def friction(factor):
    load = study_of().study.load
    units = {"coulomb": "N", "static": "N", "viscous": "N s/m"}
    return tuple(
        f"load.friction_{kind}='{factor * getattr(load, f'friction_{kind}'):g} {unit}'"
        for kind, unit in units.items()
    )


def noise(kind, factor, unit):
    return (f"controller.{kind}='{factor * getattr(study_of().study.controller, kind)} {unit}'",)


def gain(factor):
    return (f"gains.k_p_vel='{factor * study_of().study.gains.k_p_vel} N s/m'",)


OTHERS = {
    "as it is": lambda: (),
    "friction × 0.5": lambda: friction(0.5),
    "friction × 2": lambda: friction(2.0),
    "hoses as lines": lambda: ("hose.dynamics=true",),
    "position noise × 2": lambda: noise("position_noise", 2, "m"),
    "pressure noise × 3": lambda: noise("pressure_noise", 3, "Pa"),
    "no load": lambda: ("verification.load_forces=['0 N']",),
    "both gains + 2 %": lambda: untrue("gain_error", 0.02, 0.02),
    "both gains − 2 %": lambda: untrue("gain_error", -0.02, -0.02),
    "gains + 2 %, − 2 %": lambda: untrue("gain_error", 0.02, -0.02),
    "gains − 2 %, + 2 %": lambda: untrue("gain_error", -0.02, 0.02),
    "offsets + 0.1 MPa, − 0.1 MPa": lambda: untrue("offset", 1e5, -1e5),
    "offsets − 0.1 MPa, + 0.1 MPa": lambda: untrue("offset", -1e5, 1e5),
    "valves of 5 ms": lambda: ("verification.valve_delays=['5 ms']",),
    "valves of 8 ms": lambda: ("verification.valve_delays=['8 ms']",),
    "loop gain × 1.25": lambda: gain(1.25),
}


def untrue(what, side_a, side_b):
    unit = " Pa" if what == "offset" else ""
    return tuple(
        f"sensors.pressure_{what}_{side}=" + (f"'{value}{unit}'" if unit else f"{value}")
        for side, value in (("a", side_a), ("b", side_b))
    )


def by_mass(result, key):
    """Return a figure's mean over the cases of each mass."""
    found = [
        np.mean([case.mean(key) for case in result.cases if case.mass_kg == mass])
        for mass in (24.5e3, 36e3, 49e3)
    ]
    return np.round(found, 2)


@pytest.mark.parametrize("name", OTHERS)
def test_it_holds_on_another_machine(name):
    result = verify(study_of(*OTHERS[name]()))
    index, force, loss = (
        by_mass(result, key)
        for key in ("performance_index_ms", "force_error_integral_kn2s", "energy_loss_j_per_mm")
    )
    largest = max(case.span("performance_index_ms")[1] for case in result.cases)
    noisiest = max(case.mean("force_error_integral_kn2s") for case in result.cases)
    print(
        f"{name}: at 24.5, 36, 49 t index {index} ms (worst set {largest:.2f}), "
        f"force error {force} kN² s (worst case {noisiest:.1f}), loss {loss} J/mm"
    )
    assert result.satisfied, [case.status for case in result.cases]
    assert index.max() <= LARGEST_INDEX
    assert force.max() <= LARGEST_FORCE_ERROR


def lightest_sets(weight):
    """Return the figures of every set of the least mass, ``(sets,)`` each, under a weight."""
    common = f"controller.weight_common_mode='{weight} N/MPa'"
    mass = "verification.masses=['24.5 t']"
    result = verify(study_of(mass, common, seeds=(31, 32, 33), repeats=20))
    assert result.satisfied
    sets = [one for case in result.cases for one in case.sets]
    index, force, far, low = (
        np.array([getattr(one, key) for one in sets])
        for key in ("performance_index_ms", "force_error_integral_kn2s", "converter_peak_mm",
                    "pressure_min_mpa")
    )  # fmt: skip
    named = (("index [ms]", index), ("force error [kN² s]", force), ("converter [mm]", far))
    for name, values in named:
        shares = ", ".join(f"{value:.2f}" for value in np.quantile(values, (0.5, 0.95, 0.99, 1)))
        print(f"common mode {weight} N/MPa: {name}, median, 95, 99, 100 % of {len(sets)}: {shares}")
    together = np.corrcoef(force, far)[0, 1]
    lowest = low[np.argsort(index)[-3:]]
    print(
        f"force error goes with the converters' excursion: {together:.2f}; least pressure of the "
        f"three sets of largest index: {lowest.round(2)} MPa, median {np.median(low):.2f} MPa"
    )
    return index, force, together


def test_sets_far_from_the_rest_are_those_whose_converters_stand_far_out():
    """The least mass, set by set. Eq. 7's converter term rises with the cube of the excursion.

    At 45 mm and 50 mm/s it is W_conv A v x³ ≈ 2e11 · 2.5e-4 · 9e-5 N ≈ 4.5 kN: as much as the force
    error that it competes with. Where the pistons have wandered so far, the force is left for
    them. Neither half nor twice the weight helps: the one lets them wander further, the other
    bids more. A common-mode weight ends it, at a higher loss: sets of large force error and large
    index have a chamber below p_min.
    """
    index, force, together = lightest_sets(0)
    calm_index, calm_force, calm = lightest_sets(300)
    assert together > 0.5 > abs(calm)
    assert calm_force.max() < 0.9 * force.max()
    assert np.quantile(calm_index, 0.95) < np.quantile(index, 0.95)


def test_the_closed_loop_is_hardly_slower_than_with_the_filters():
    plain, full = study_of(estimated=False), study_of()
    spans = {}
    for _ in range(3):
        for name, study in (("published", plain), ("estimator", full)):
            begin = time.perf_counter()
            verify(study)
            spent = time.perf_counter() - begin
            spans[name] = min(spent, spans.get(name, spent))
    ratio = spans["estimator"] / spans["published"]
    print(
        f"published {spans['published']:.2f} s, estimator {spans['estimator']:.2f} s: {ratio:.3f}"
    )
    assert ratio <= SLOWER
