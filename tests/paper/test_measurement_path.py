"""What Eq. 17 and Eq. 21 do not see: the sensitivity peaks with the measurement path included."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import Plants
from mptune.robust.margins import family_margins
from mptune.robust.model import PATHS, LinearModel

GRID = np.geomspace(0.1, 1000, 200)
PLANTS = Plants(
    mass=np.array([24500.0, 24500.0, 49000.0, 24500.0]),
    delay=np.array([0.010, 0.014, 0.014, 0.0215]),
    tau_a=np.array([0.0001, 0.0122, 0.0122, 0.0122]),
    tau_b=np.array([0.0001, 0.0119, 0.0119, 0.0119]),
    share_a=np.full(4, 4 / 7),
)
NAMES = ("24.5 t, 10 ms, no lag", "24.5 t, 14 ms", "49 t, 14 ms", "24.5 t, 21.5 ms")
VELOCITY_PEAKS = {"none": (1.29, 1.82, 1.34, 2.43), "filters": (1.67, 2.78, 1.58, 4.35)}
FORCE_PEAKS = {"none": (1.52, 2.47, 1.76, 4.81), "filters": (2.10, 8.70, 2.91, None)}


@pytest.fixture(scope="module")
def loops(boom):
    """The loops of the four plants with the published gains, by measurement path."""
    model = LinearModel.of(boom)
    return {path: model.loops(model.gains, model.path_of(path), PLANTS) for path in PATHS}


@pytest.fixture(scope="module")
def margins(loops):
    return {path: family_margins(GRID, one) for path, one in loops.items()}


@pytest.mark.parametrize("path", ["none", "filters"])
@pytest.mark.parametrize("plant", range(4))
def test_the_sensitivity_peak_of_the_velocity_loop(margins, path, plant):
    found = margins[path].sensitivity_peak[VELOCITY, plant]
    print(f"M_S, velocity loop, {NAMES[plant]}, path {path}: {found:.3f}")
    assert found == pytest.approx(VELOCITY_PEAKS[path][plant], abs=0.006)


@pytest.mark.parametrize(
    ("path", "plant"), [(path, plant) for path in FORCE_PEAKS for plant in range(4)][:-1]
)
def test_the_sensitivity_peak_at_the_force_reference(margins, path, plant):
    found = margins[path].sensitivity_peak[FORCE, plant]
    print(f"M_S at F_ref, {NAMES[plant]}, path {path}: {found:.3f}")
    assert found == pytest.approx(FORCE_PEAKS[path][plant], abs=0.006)


@pytest.mark.parametrize(("path", "margin"), [("none", "2.1"), ("filters", "1.2")])
def test_the_gain_margin_of_section_5_1_s_worst_plant(margins, path, margin):
    found = margins[path].gain_margin[FORCE, 1]
    print(f"gain margin at F_ref, {NAMES[1]}, path {path}: {found:.3f}")
    assert f"{found:.2g}" == margin


def stable(loops, which):
    count = count_unstable_poles(loops.broken_at(which))
    assert count.decided.all()
    return count.stable.tolist()


def test_the_worst_plant_of_fig_5_is_unstable_with_the_path(loops):
    assert stable(loops["none"], FORCE) == [True, True, True, True]
    assert stable(loops["filters"], FORCE) == [True, True, True, False]


def test_the_velocity_loops_alone_stay_stable_with_the_path(loops):
    assert stable(loops["filters"], VELOCITY) == [True, True, True, True]


@pytest.mark.compiled  # interpreted, it would take minutes
def test_the_sweep_tells_of_the_unstable_plants_that_eq_17_and_21_pass(fig_5_twice):
    assert fig_5_twice.velocity.satisfied
    assert fig_5_twice.position.satisfied
    assert fig_5_twice.family("none").unstable_count == 0
    with_path = fig_5_twice.family("filters")
    unstable = with_path.first_unstable()
    print(f"with the path {with_path.unstable_count} plants of {len(with_path.stable)} unstable")
    assert with_path.unstable_count > 0
    assert (unstable.mass_kg, unstable.delay_s, unstable.tau_a_s) == (24500, 0.0215, 0.0122)
    worst, at = with_path.worst("sensitivity_peak", FORCE)
    assert np.isnan(worst)
    assert at is None


@pytest.mark.compiled  # interpreted, it would take minutes
def test_the_sweep_over_section_5_1_keeps_a_gain_margin_of_1_2_with_the_path(section_5_1):
    worst, at = section_5_1.family("filters").worst("gain_margin", FORCE)
    assert f"{worst:.2g}" == "1.2"
    assert (at.mass_kg, at.delay_s) == (24500, 0.014)
