"""Plants with light modes: what a grid steps over, a certificate sees.

The plant 9/((s + 1)(s² + 6ζs + 9)) with PI at M_S 1.4. References: M_S on grids that are dense
about the mode, and roots of the closed loop's polynomial, neither through mptune's certificate; the
optima by differential evolution over both gains (``test_differential_evolution_agrees``).
"""

import control
import numpy as np
import pytest
from scipy.optimize import differential_evolution

from mptune.certify.result import Grounds
from mptune.shape import structure
from mptune.shape.design import design
from mptune.shape.procedure import ShapeStatus
from mptune.shape.rational import RationalPlant

OPTIMA = {1 / 30: 0.27187, 0.01: 0.087560, 0.001: 0.0089917, 1e-4: 0.00090154}  # k_p ≥ 0
FREE = {1 / 30: 0.42766, 0.01: 0.30965, 0.001: 0.24776, 1e-4: 0.24083}  # k_p of either sign


def denominator(damping):
    return np.polymul([1, 1], [1, 6 * damping, 9])


def plant(damping):
    pole = 3 * (-damping + 1j * np.sqrt(1 - damping**2))
    return RationalPlant([], [-1, pole, pole.conjugate()], 9.0)


def dense(damping):
    """Frequencies about the mode at distances from far below its half width to its frequency."""
    away = np.geomspace(1e-3 * damping, 0.5, 40_000)
    return np.sort(
        np.concatenate([3 * (1 - away), 3 * (1 + away), np.geomspace(1e-5, 1e3, 40_000)])
    )


def sensitivity_peak(damping, k_p, k_i, omega):
    s = 1j * omega
    open_loop = np.polyval(denominator(damping), s) * s
    return np.abs(open_loop / (open_loop + 9 * (k_p * s + k_i))).max()


def closed_loop(damping, k_p, k_i):
    return np.roots(np.polyadd(np.polymul(denominator(damping), [1, 0]), 9 * np.array([k_p, k_i])))


@pytest.mark.parametrize("low", [0.0, -5.0])
@pytest.mark.parametrize("damping", OPTIMA)
def test_m_s_is_certified_and_the_optimum_found(damping, low):
    found = design(
        plant(damping), structure.pi(), maximise="k_i", sensitivity_peak=1.4, low={"k_p": low}
    )
    (verdict,) = found.verdicts
    peak = sensitivity_peak(damping, **found.gains, omega=dense(damping))
    poles = closed_loop(damping, **found.gains)
    print(damping, found.gains, f"M_S {peak:.7f}, certified {verdict.bound:.7f}", poles.real.max())
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert found.stability is verdict.grounds is Grounds.CERTIFIED
    assert np.all(poles.real < 0)
    assert peak <= verdict.bound <= 1.4
    assert peak == pytest.approx(verdict.attained, rel=1e-6)
    assert found.gains["k_i"] == pytest.approx((FREE if low else OPTIMA)[damping], rel=1e-4)
    assert low <= found.gains["k_p"]


def test_integral_dominated_optimum():
    """9/((s + 1)(s² + 0.2s + 9)): with k_p ≥ 0 the proportional part only feeds the mode."""
    s = control.tf("s")
    transfer = 9 / ((s + 1) * (s**2 + 0.2 * s + 9))
    for form in (transfer, control.ss(transfer), lambda s: 9 / ((s + 1) * (s**2 + 0.2 * s + 9))):
        found = design(form, structure.pi(), maximise="k_i", sensitivity_peak=1.4)
        assert found.shaped.status is ShapeStatus.OPTIMAL
        assert found.gains["k_p"] == pytest.approx(0, abs=1e-4)
        assert found.gains["k_i"] == pytest.approx(0.2719, abs=1e-4)


def test_differential_evolution_agrees():
    """A second route to an optimum, over both gains, with stability by roots."""
    damping = 1 / 30
    omega = np.concatenate([np.geomspace(1e-2, 30, 500), np.linspace(2.5, 3.5, 500)])

    def cost(x):
        growth = closed_loop(damping, *x).real.max()
        if growth >= 0:
            return 10 + growth
        peak = sensitivity_peak(damping, *x, omega=omega)
        return -x[1] if peak <= 1.4 else peak

    searched = differential_evolution(
        cost, [(0, 1), (0, 1)], rng=np.random.default_rng(0), tol=1e-8, maxiter=60
    )
    print(searched.x)
    assert -searched.fun == pytest.approx(OPTIMA[damping], rel=1e-3)
    assert searched.x[0] == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("damping", [0.01, 0.001, 1e-4, 1e-6])
def test_an_unstable_loop_is_never_called_stable(damping):
    """Started from gains that only the light mode makes unstable, between a grid's points."""
    start = {"k_p": 0.3, "k_i": 0.1}
    assert closed_loop(damping, **start).real.max() > 0
    found = design(
        plant(damping), structure.pi(), maximise="k_i", sensitivity_peak=1.4, start=start
    )
    assert np.all(closed_loop(damping, **found.gains).real < 0)
    assert found.shaped.start_replaced


def test_undamped_mode_is_damped_by_the_loop():
    """Poles on the axis itself: counted all the same, and S is 0 there."""
    found = design(
        RationalPlant([], [-1, 3j, -3j], 9.0),
        structure.pi(),
        maximise="k_i",
        sensitivity_peak=1.4,
        low={"k_p": -5.0},
    )
    poles = closed_loop(0.0, **found.gains)
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert np.all(poles.real < -1e-3)
    assert sensitivity_peak(0.0, **found.gains, omega=dense(1e-4)) <= found.verdicts[0].bound <= 1.4


def test_a_basis_of_ones_own_sees_the_mode_but_proves_nothing():
    functions = [np.ones_like, lambda s: 1 / s]
    own = structure.basis_of(functions, ["k_p", "k_i"], [False, True])
    found = design(plant(1e-4), own, maximise="k_i", sensitivity_peak=1.4)
    (verdict,) = found.verdicts
    assert found.stability is verdict.grounds is Grounds.GRID
    assert np.isnan(verdict.bound)
    assert np.all(closed_loop(1e-4, **found.gains).real < 0)
    assert sensitivity_peak(1e-4, **found.gains, omega=dense(1e-4)) <= 1.4 * (1 + 1e-3)
