"""How the decision's weights move the figures of ``studies/boom-estimator``, all of them at once.

A single set scatters by as much as a weight moves it. So points all over a box of weights are run,
each with a seed of its own, and each figure's quadratic surface is fitted to them: every run then
tells of every weight. The study's own weights were chosen on such surfaces and proved on other
seeds (``test_estimator_studies.py``). ``MPTUNE_BENCH_POINTS`` points are
run, ``MPTUNE_BENCH_SETS`` sets of each run counted, the first is not. Run with ``make bench``.
"""

import os

import numpy as np
import pytest
from scipy.stats import qmc

from mptune.params.load import load_study
from mptune.verify.verify import cases_of, run_case

pytestmark = pytest.mark.bench

POINTS, SETS = (
    int(os.environ.get(f"MPTUNE_BENCH_{name}", default))
    for name, default in (("POINTS", "48"), ("SETS", "6"))
)
FIRST_SEED = 201
BOX = {  # key of [controller], unit, least, largest, whether on a logarithm
    "error_width": ("N", 1500.0, 4000.0, True),
    "weight_switching": ("N", 70.0, 150.0, True),
    "weight_loss": ("N/J", 55.0, 120.0, True),
    "weight_converter": ("N s/m^6", 1e11, 4e11, True),
    "weight_common_mode": ("N/MPa", 0.0, 150.0, False),
    "delay_prediction": ("ms", 5.5, 7.5, False),
}
FIGURES = (
    "performance_index_ms", "energy_loss_j_per_mm", "force_error_integral_kn2s", "valve_switches",
    "final_error_mm",
)  # fmt: skip


def weights_at(share):
    """Return the weights at a place of the unit box, by name."""
    found = {}
    for (name, (_, low, high, logarithm)), one in zip(BOX.items(), share, strict=True):
        found[name] = low * (high / low) ** one if logarithm else low + one * (high - low)
    return found


def share_of(weights):
    """Return the place in the unit box of weights by name."""
    return np.array(
        [
            np.log(weights[name] / low) / np.log(high / low)
            if logarithm
            else (weights[name] - low) / (high - low)
            for name, (_, low, high, logarithm) in BOX.items()
        ]
    )


def run_at(root, share, seed):
    """Return the figures' means over oils and sets, ``(masses, figures)``."""
    chosen = [f'controller.{k}="{v} {BOX[k][0]}"' for k, v in weights_at(share).items()]
    run = [f"verification.repeats={SETS + 1}", f"verification.seeds=[{seed}]"]
    study = load_study(root / "studies/boom-estimator/study.toml", [*chosen, *run])
    own, rows = study.study, {}
    for case in cases_of(study):
        found = run_case(study, case, own.gains, own.feedforward)
        assert found.stable
        rows.setdefault(case.mass, []).append([found.mean(key) for key in FIGURES])
    return np.array([np.mean(rows[mass], axis=0) for mass in own.verification.masses])


def terms(shares):
    """Return the surface's terms ``(P, 1 + 2K)``: constant, linear, squares about the middle."""
    x = np.asarray(shares) - 0.5
    return np.column_stack([np.ones(len(x)), x, x**2 - 1 / 12])


def fitted(shares, values):
    """Return the coefficients ``(terms, …)`` and the scatter about the surface."""
    table = terms(shares)
    found, *_ = np.linalg.lstsq(table, values.reshape(len(values), -1), rcond=None)
    rest = values.reshape(len(values), -1) - table @ found
    scatter = np.sqrt((rest**2).sum(axis=0) / max(len(values) - table.shape[1], 1))
    return found.reshape(-1, *values.shape[1:]), scatter.reshape(values.shape[1:])


def test_what_each_weight_moves(root):
    shares = qmc.Sobol(len(BOX), rng=np.random.default_rng(7)).random_base2(6)[:POINTS]
    values = np.array([run_at(root, one, FIRST_SEED + n) for n, one in enumerate(shares)])
    found, scatter = fitted(shares, values)
    for k, figure in enumerate(FIGURES):
        print(f"\n{figure}: middle {found[0, :, k].round(2)}, scatter {scatter[:, k].round(2)}")
        for name, rise in zip(BOX, found[1:], strict=False):
            print(f"  {name}, over its range: {rise[:, k].round(2)}", end="")
    own = load_study(root / "studies/boom-estimator/study.toml").study.controller
    at = {name: getattr(own, name) for name in BOX}
    at["delay_prediction"] *= 1e3
    at["weight_common_mode"] *= 1e6
    here = np.tensordot(terms([share_of(at)])[0], found, axes=1)
    print(f"\nthe study's own, by mass: {here.round(2).tolist()}")
    loss, switches = FIGURES.index("energy_loss_j_per_mm"), FIGURES.index("valve_switches")
    rise = dict(zip(BOX, found[1:].mean(axis=1), strict=False))
    assert rise["weight_loss"][loss] < 0
    assert rise["weight_switching"][switches] < 0
    assert rise["error_width"][switches] < 0
