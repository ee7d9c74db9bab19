"""PI controllers of largest k_i with M_S ≤ 1.4: optima known from the literature.

Åström, Panagopoulos, Hägglund (1998), "Design of PI controllers based on non-convex optimization".
"""

import time

import numpy as np
import pytest
from scipy.optimize import differential_evolution, minimize_scalar

from mptune.shape import structure
from mptune.shape.design import design
from mptune.shape.procedure import ShapeStatus

M_S = 1.4
KNOWN = {
    "1/(s+1)^3": (lambda s: 1 / (s + 1) ** 3, 0, 0.3253),
    "1/(s+1)^4": (lambda s: 1 / (s + 1) ** 4, 0, 0.1920),
    "e^-s/(s+1)": (lambda s: np.exp(-s) / (s + 1), 0, 0.3730),
    "e^-s/s": (lambda s: np.exp(-s) / s, 1, 0.0418),
}


def sensitivity_peak(plant, k_p, k_i):
    """M_S by a very fine grid and, about its peak, a scalar search: nothing of mptune."""

    def size(omega):
        s = 1j * omega
        return 1 / np.abs(1 + plant(s) * (k_p + k_i / s))

    omega = np.geomspace(1e-4, 1e3, 400_000)
    worst = int(np.argmax(size(omega)))
    near = (omega[max(worst - 1, 0)], omega[min(worst + 1, len(omega) - 1)])
    found = minimize_scalar(
        lambda w: -size(w), bounds=near, method="bounded", options={"xatol": 1e-10}
    )
    return max(float(size(omega[worst])), float(-found.fun))


@pytest.mark.parametrize("name", KNOWN)
def test_largest_integral_gain_is_the_known_one(name):
    plant, integrators, known = KNOWN[name]
    begun = time.perf_counter()
    found = design(
        plant, structure.pi(), maximise="k_i", sensitivity_peak=M_S, integrators=integrators
    )
    took = time.perf_counter() - begun
    peak = sensitivity_peak(plant, **found.gains)
    k_i = found.gains["k_i"]
    print(
        f"{name}: k_p {found.gains['k_p']:.4f}, k_i {k_i:.5f} (known {known}, "
        f"{100 * (k_i / known - 1):+.3f} %), M_S {peak:.6f}, {1e3 * took:.0f} ms"
    )
    assert found.shaped.status is ShapeStatus.OPTIMAL
    assert found.shaped.stable
    assert k_i == pytest.approx(known, rel=1e-3)
    assert peak == pytest.approx(M_S, abs=1e-4)
    assert peak <= M_S * (1 + 1e-6)


def test_global_search_finds_the_same_optimum():
    """A second route: differential evolution over both gains, with M_S on a dense grid."""
    plant, _, _ = KNOWN["1/(s+1)^3"]
    s = 1j * np.geomspace(1e-2, 20, 1500)
    response = plant(s)

    def cost(x):
        peak = np.abs(1 / (1 + response * (x[0] + x[1] / s))).max()
        return -x[1] if peak <= M_S else peak

    searched = differential_evolution(
        cost, [(0.1, 2), (0.05, 1)], rng=np.random.default_rng(0), tol=1e-8, popsize=20
    )
    found = design(plant, structure.pi(), maximise="k_i", sensitivity_peak=M_S)
    print(f"differential evolution k_i {-searched.fun:.5f}, convex {found.gains['k_i']:.5f}")
    assert found.gains["k_i"] == pytest.approx(-searched.fun, rel=1e-3)
