"""The boom's position loop: K_I,pos within Eq. 21 at the published velocity gain and τ."""

import time

import numpy as np
import pytest

from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import LoopGains
from mptune.robust.grid import frequency_range
from mptune.robust.model import LinearModel
from mptune.robust.sweep import sweep
from mptune.shape.problem import (
    Function,
    Loops,
    Maximise,
    Norm,
    Peak,
    Problem,
    WeightedSensitivity,
)
from mptune.shape.procedure import ShapeStatus
from mptune.shape.shaping import shape_loop
from mptune.shape.structure import position, position_gains, position_parameters
from mptune.tune.position_limits import damping_limits, frequency_limits

pytestmark = pytest.mark.compiled  # the envelope over the family would take minutes

LIMIT = 0.476
INTEGRAL = Maximise(np.array([0.0, 0.0, 0.0, 1.0]))
POINTS = 250


class Boom:
    """Eq. 21 of the boom study as a loop-shaping problem."""

    def __init__(self, study):
        self.study, self.model = study, LinearModel.of(study)
        self.plants, self.gains = self.model.plants, self.model.gains
        span = frequency_range(self.plants, self.model.nominal, self.gains)
        self.omega = np.geomspace(*span, POINTS)
        # With ω = ξ = τ = 1 and no I-term Eq. 22 is 1: what is left is the plant.
        self.one = self.gains._replace(k_p_pos=1.0, k_i_pos=0.0, omega=1.0, xi=1.0, tau=1.0)
        self.left = self.envelope(self.omega)
        gains = self.gains
        self.start = position_parameters(gains.k_p_pos, gains.k_i_pos, gains.omega, gains.xi)

    def envelope(self, omega):
        return self.model.sides(omega, self.gains).left[1]

    def allowed(self, omega):
        same = len(omega) == len(self.omega)
        return LIMIT / (self.left if same else self.envelope(omega))

    def plant(self, omega, rows):
        found = np.tile(self.model.nominal_gains(omega, self.one)[1], (len(rows), 1))
        return found, np.zeros_like(found)

    def force_loops(self, omega, rows):
        """Return the true loops broken at F_ref: slope and fixed part in the controller."""
        columns = (column[rows][:, None] for column in self.plants)
        mass, delay, tau_a, tau_b, share_a = columns
        s = 1j * omega
        lead = tau_b * share_a + tau_a * (1 - share_a)
        force = (lead * s + 1) / ((tau_a * s + 1) * (tau_b * s + 1))
        velocity = force * np.exp(-s * delay) / (mass * s) * self.gains.k_p_vel
        return velocity / s, velocity

    def gains_at(self, x, tau):
        k_p, k_i, omega, xi = position_gains(x)
        return LoopGains(self.gains.k_p_vel, k_p, k_i, omega, xi, tau)

    def problem(self, *requirements, tau=6e-3, objective=INTEGRAL, **others):
        def stable(x):
            loops = self.model.nominal_loop(self.gains_at(x, tau))
            return bool(x[0] > 0 < x[2]) and bool(count_unstable_poles(loops).stable.all())

        nominal = Loops(self.omega, *self.plant(self.omega, [0]), self.plant)
        ratio = Peak("position_ratio", Function.COMPLEMENTARY, self.allowed, "nominal")
        return Problem(
            position(tau), {"nominal": nominal, **others}, objective, (ratio, *requirements), stable
        )

    def noise(self, bound):
        """K_P,vel (G_P + s) behind a 12 ms lag, white noise up to 1 kHz."""
        omega = np.linspace(1, 2 * np.pi * 1000, 400)
        lag = self.gains.k_p_vel / (1 + 12e-3j * omega)
        weight = np.full(len(omega), 1 / len(omega))
        return Norm("noise_gain", omega, 1j * omega * lag, lag, weight, bound)


@pytest.fixture(scope="module")
def loop(load_boom):
    return Boom(load_boom())


def shaped(loop, problem):
    begun = time.perf_counter()
    found = shape_loop(problem, loop.start)
    return found, time.perf_counter() - begun


def test_integral_gain_is_three_times_the_published_one(loop):
    shape_loop(loop.problem(), loop.start)  # builds the program
    found, took = shaped(loop, loop.problem())
    gains = loop.gains_at(found.parameters, 6e-3)
    checked = sweep(
        loop.study,
        loop.study.study.gains.model_copy(
            update={name: getattr(gains, name) for name in ("k_p_pos", "k_i_pos", "omega", "xi")}
        ),
    )
    print(
        f"K_I,pos {gains.k_i_pos:.2f} 1/s² (published 22), K_P,pos {gains.k_p_pos:.2f} 1/s, "
        f"ω {gains.omega:.1f} rad/s, ξ {gains.xi:.3f}; Eq. 21 by the sweep "
        f"{checked.position.worst_ratio:.6f} (allowed {LIMIT}); {len(found.iterates)} iterates, "
        f"{1e3 * took:.0f} ms"
    )
    assert found.status is ShapeStatus.OPTIMAL
    assert found.stable
    assert gains.k_i_pos == pytest.approx(70, rel=0.01)
    assert checked.position.worst_ratio == pytest.approx(LIMIT, rel=1e-4)


def test_published_noise_gain_costs_little_and_less_noise_costs_more(loop):
    problem = loop.problem(tau=6e-3)
    matrix = loop.noise(1.0).matrix(problem.structure)
    published = float(np.linalg.norm(matrix @ np.append(loop.start, 1.0)))
    values = []
    for share in (np.inf, 1.0, 0.995, 0.99):
        extra = () if np.isinf(share) else (loop.noise(share * published),)
        found, took = shaped(loop, loop.problem(*extra))
        noise = float(np.linalg.norm(matrix @ np.append(found.parameters, 1.0))) / published
        print(
            f"noise ≤ {share} of published: K_I,pos {found.objective:.2f}, noise {noise:.4f}, "
            f"{1e3 * took:.0f} ms"
        )
        assert found.status is ShapeStatus.OPTIMAL
        assert noise <= share * (1 + 1e-6)
        values.append(found.objective)
    assert np.all(np.diff(values) < 0)


def test_m_s_at_f_ref_over_the_true_family(loop):
    values = []
    rows = np.arange(len(loop.plants.mass))
    family = Loops(loop.omega, *loop.force_loops(loop.omega, rows), loop.force_loops)
    for limit in (4.0, 2.5):
        peak = Peak("sensitivity_peak", Function.SENSITIVITY, limit, "force")
        problem = loop.problem(peak, force=family)
        found, took = shaped(loop, problem)
        plant, fixed = loop.force_loops(loop.omega, rows)
        controller = problem.structure.controller(found.parameters, loop.omega)
        worst = np.abs(1 / (1 + fixed + plant * controller)).max()
        print(
            f"M_S ≤ {limit} at F_ref on {len(rows)} plants: K_I,pos {found.objective:.2f}, "
            f"grid M_S {worst:.4f}, rounds {found.rounds}, {1e3 * took:.0f} ms"
        )
        assert found.status is ShapeStatus.OPTIMAL
        assert worst <= limit * (1 + 1e-6)
        values.append(found.objective)
    assert values[1] < values[0] < 70


def test_weighted_sensitivity_beats_the_published_gains(loop):
    objective = WeightedSensitivity(lambda omega: 10 / omega, "nominal")
    found, took = shaped(loop, loop.problem(objective=objective))
    plant = loop.plant(loop.omega, [0])[0][0]
    published = loop.problem().structure.controller(loop.start, loop.omega)
    before = (10 / loop.omega / np.abs(1 + plant * published)).max()
    print(f"max 10/ω |S|: {before:.3f} -> {found.objective:.3f}, {1e3 * took:.0f} ms")
    assert found.status is ShapeStatus.OPTIMAL
    assert found.objective < before


def test_one_tau_after_another_with_margins_on_a_handful_of_plants(loop):
    """The time of one τ: Eq. 21, and M_S and M_T at F_ref on the corners of the family."""
    columns = np.array(loop.plants)
    extreme = (columns == columns.min(axis=1, keepdims=True)) | (
        columns == columns.max(axis=1, keepdims=True)
    )
    rows = np.flatnonzero(extreme.all(axis=0))
    every = np.arange(len(loop.plants.mass))
    family = Loops(loop.omega, *loop.force_loops(loop.omega, every), loop.force_loops)
    corners = family.picked(rows)
    peaks = (
        Peak("sensitivity_peak", Function.SENSITIVITY, 3.0, "force"),
        Peak("complementary_peak", Function.COMPLEMENTARY, 3.0, "force"),
    )
    times, values = [], []
    for tau in (5e-3, 6e-3, 8e-3, 10e-3, 14e-3, 20e-3):
        found, took = shaped(loop, loop.problem(*peaks, tau=tau, force=corners))
        assert found.status is ShapeStatus.OPTIMAL
        times.append(took)
        values.append(found.objective)
    print(
        f"{len(rows)} plants, {POINTS} frequencies: {1e3 * np.median(times):.0f} ms per τ "
        f"(median of {len(times)}, slowest {1e3 * max(times):.0f}); K_I,pos {np.round(values, 1)}"
    )


@pytest.mark.parametrize(
    ("limits", "kept"),
    [
        (frequency_limits(40, 60), lambda gains: 40 * (1 - 1e-5) <= gains.omega <= 60),
        (frequency_limits(20, 30), lambda gains: 20 <= gains.omega <= 30 * (1 + 1e-5)),
        (damping_limits(0.75, 1, 40), lambda gains: 0.75 * (1 - 1e-5) <= gains.xi <= 1),
        (damping_limits(0.2, 0.5, 40), lambda gains: 0.2 <= gains.xi <= 0.5 * (1 + 1e-5)),
    ],
    ids=["omega above", "omega below", "xi above", "xi below"],
)
def test_limits_of_omega_and_xi_bind(loop, limits, kept):
    found, took = shaped(loop, loop.problem(*limits))
    gains = loop.gains_at(found.parameters, 6e-3)
    print(f"K_I,pos {gains.k_i_pos:.2f}, ω {gains.omega:.2f}, ξ {gains.xi:.3f}, {took:.3f} s")
    assert found.status is ShapeStatus.OPTIMAL
    assert kept(gains)
    assert 50 < gains.k_i_pos < 69.9
