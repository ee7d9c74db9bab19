"""What each lever of the decision does on the published gains, on seeds of its own.

``MPTUNE_BENCH_SETS`` movement sets per run are counted (the first is not), ``MPTUNE_BENCH_SEEDS``
seeds and ``MPTUNE_BENCH_OILS`` oils taken: 20, 3 and 3 are those of the trial that the ranges come
from, fewer take less time. Run with ``make trials``.
"""

import os

import numpy as np
import pytest

from mptune.campaign.workers import workers
from mptune.params.load import load_study
from mptune.verify.verify import Case, run_case
from mptune.weigh.weigh import search_weights

pytestmark = [pytest.mark.bench, pytest.mark.trial]

SETS, SEEDS, OILS, TRIALS = (
    int(os.environ.get(f"MPTUNE_BENCH_{name}", default))
    for name, default in (("SETS", "4"), ("SEEDS", "3"), ("OILS", "1"), ("TRIALS", "60"))
)
MODULI = (1.2e9, 0.8e9, 1.4e9)  # Pa
MASSES = (24500.0, 49000.0)
FIGURES = (
    ("performance_index_ms", "index ms", 1),
    ("energy_loss_j_per_mm", "loss J/mm", 1),
    ("force_error_integral_kn2s", "force error kN² s", 1),
    ("valve_switches", "switches", 0),
    ("busiest_valve_per_s", "busiest 1/s", 2),
    ("final_error_mm", "final mm", 2),
    ("pressure_min_mpa", "p min MPa", 2),
)

HUBER, PATH, TWO = 'controller.error="huber"', 'controller.loss="path"', "controller.horizon=2"
DELAY = 'controller.delay_prediction="6.25 ms"'
LEVERS = {
    "published": (),
    "Huber": (HUBER,),
    "loss along the path": (PATH,),
    "two periods": (TWO,),
    "Huber, path": (HUBER, PATH),
    "Huber, path, two periods": (HUBER, PATH, TWO),
    "delay predicted": (DELAY,),
    "… and Huber": (HUBER, DELAY),
    "… and Huber, path, two periods": (HUBER, PATH, TWO, DELAY),
    "common mode 300 N/MPa": ('controller.weight_common_mode="300 N/MPa"',),
}
STEADY = 'controller.force_model="steady-state"'
COMPRESSION = (  # the weights of a trial, calibrated
    STEADY,
    'controller.weight_switching="400 N"',
    'controller.weight_loss="200 N/J"',
    'controller.weight_compression="60 N/J"',
)
REF_16 = 15.9  # J/mm, §7.3
SLOW = ('controller.sampling_period="20 ms"',)


def figures_of(study, mass, delay=(5e-3, 8e-3), oils=MODULI[:OILS]):
    """Means (or worst) over seeds and oils of one machine, as each figure counts."""
    runs = [
        run_case(
            study, Case(mass, delay, oil, 9700.0, 101 + seed), study.study.gains,
            study.study.feedforward,
        )
        for seed in range(SEEDS)
        for oil in oils
    ]  # fmt: skip
    found = {key: float(np.mean([run.figure(key) for run in runs])) for key, *_ in FIGURES}
    found["stable"] = all(run.stable for run in runs)
    return found


def measured(study_file, name, *options, **changes):
    """Measure one lever on both masses, and print a line for each."""
    study = load_study(study_file, [f"verification.repeats={SETS + 1}", *options])
    found = {}
    for mass in MASSES:
        found[mass] = figures_of(study, mass, **changes)
        text = ", ".join(f"{label} {found[mass][key]:.{n}f}" for key, label, n in FIGURES)
        print(f"{name:32} {mass / 1e3:g} t: {text}{'' if found[mass]['stable'] else ' UNSTABLE'}")
    return found


def mean(found, key):
    return float(np.mean([found[mass][key] for mass in MASSES]))


def test_each_lever_alone_on_the_published_gains(study_file):
    """The loss falls and the index stays, whatever the outer loops are."""
    print()
    found = {name: measured(study_file, name, *options) for name, options in LEVERS.items()}
    loss = {name: mean(one, "energy_loss_j_per_mm") for name, one in found.items()}
    index = {name: mean(one, "performance_index_ms") for name, one in found.items()}
    switches = {name: mean(one, "valve_switches") for name, one in found.items()}
    for name, one in found.items():
        assert all(one[mass]["stable"] for mass in MASSES), name
        assert abs(index[name] - index["published"]) < 1.0, name
    assert 18 < loss["published"] < 20
    assert loss["Huber"] < loss["published"] - 1.2
    assert loss["Huber, path"] < loss["Huber"]
    assert loss["… and Huber, path, two periods"] < loss["published"] - 3
    assert switches["Huber"] < 0.85 * switches["published"]
    common, own = (
        mean(found[name], "pressure_min_mpa") for name in ("common mode 300 N/MPa", "published")
    )
    assert common > own  # cavitation


def test_the_steady_state_decision_has_ref_16_s_figures_at_weights_that_weigh_finds(
    study_file, tmp_path
):
    """From Table 2's weights, which do not carry over, on seeds that the search has not seen.

    Of the front, the weights with the least force error at about ref. 16's loss are taken: they are
    calibrated, having been chosen by the figure that they are held against.
    """
    print()
    measured(study_file, "steady state, Table 2's weights", STEADY)
    measured(study_file, "steady state, the trial's weights", *COMPRESSION)
    with workers(1) as team:
        result = search_weights(
            load_study(study_file, [STEADY]), team, f"sqlite:///{tmp_path / 'w.db'}", TRIALS
        )
    print(result.headline)
    front = [result.trials[place] for place in result.front]
    like = [one for one in front if one.mean("energy_loss_j_per_mm") <= REF_16 + 0.5]
    weights = min(like, key=lambda one: one.mean("force_error_integral_kn2s")).weights
    options = [
        f'controller.weight_switching="{weights.weight_switching} N"',
        f'controller.weight_loss="{weights.weight_loss} N/J"',
        f'controller.weight_converter="{weights.weight_converter} N s/m^6"',
        f'controller.weight_compression="{weights.weight_compression} N/J"',
    ]
    found = measured(study_file, f"steady state, {TRIALS} trials", STEADY, *options)[49000.0]
    print("; ".join(options))
    assert found["stable"]
    assert 15 <= found["energy_loss_j_per_mm"] <= 18
    assert 33 <= found["force_error_integral_kn2s"] <= 45


def test_slow_valves_suit_the_steady_state_decision(study_file):
    """Valves of 15 to 19 ms at a T_S of 20 ms, over all three oils."""
    print()
    slow = {"delay": (15e-3, 19e-3), "oils": MODULI}
    dynamic = measured(study_file, "dynamic, slow valves", *SLOW, **slow)[49000.0]
    steady = measured(study_file, "steady state, slow valves", *SLOW, *COMPRESSION, **slow)[49000.0]
    assert steady["force_error_integral_kn2s"] <= 75
    assert dynamic["force_error_integral_kn2s"] > 140
