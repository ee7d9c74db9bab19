"""Random certified problems, and what an independent interval program says of them."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path

import numpy as np

from mptune.certify.climb import figure_at
from mptune.certify.enclosure import OMEGA, SIDES, enclose, plant_over
from mptune.certify.figures import coefficients
from mptune.certify.form import COMPLIANCE, curve_of, form_of, scale_of
from mptune.certify.problem import PATHS, BoxedLoop, PlantBox, edges_of
from mptune.certify.proof import Proof
from mptune.certify.rows import FIXED, PER_DUAL
from mptune.certify.sampled import shifts_up_to
from mptune.certify.search import PROVED
from mptune.loops.broken import SAMPLED
from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant

PEAKS = ("sensitivity_peak", "complementary_peak", "disk_margin")
FIGURES = [
    ("velocity", "none", "equation_17"),
    ("velocity", "filters", "equation_17"),
    ("position", "none", "equation_21"),
    ("position", "filters", "equation_21"),
    *((loop, path, peak) for path in PATHS for loop in ("velocity", "position", "force_reference")
      for peak in PEAKS if path != "sampled" or loop == "force_reference"),
    *(("force_reference", path, "peak_compliance") for path in PATHS),
]  # fmt: skip


def reference():
    """Return the independent interval program as a module."""
    path = Path(__file__).parent / "reference" / "interval_arithmetic.py"
    spec = importlib.util.spec_from_file_location("interval_arithmetic", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def random_problem(rng):
    """Return a family with gains that suit it more or less, special cases among them."""

    def pair(low, high):
        ends = np.sort(rng.uniform(low, high, 2))
        return (float(ends[0]), float(ends[1 if rng.random() < 0.8 else 0]))

    mass, delay = pair(1e3, 5e4), pair(0.005, 0.03)
    tau_a, tau_b = (pair(0.0, 0.015) if rng.random() < 0.8 else (0.0, 0.0) for _ in range(2))
    nominal = NominalPlant(
        mass[0] * rng.choice([1.0, rng.uniform(0.5, 3)]),
        delay[0] * rng.choice([1.0, rng.uniform(0.5, 2)]),
    )
    speed = rng.uniform(0.02, 1.2) / (delay[1] + 0.01)  # K_P,vel/m
    k_p = speed * rng.choice([0.0, rng.uniform(0.02, 1.0)], p=[0.1, 0.9])
    k_i = rng.choice([0.0, k_p * speed * rng.uniform(0.01, 0.5) + 0.1], p=[0.2, 0.8])
    gains = LoopGains(
        k_p_vel=float(speed * mass[0]),
        k_p_pos=float(k_p),
        k_i_pos=float(k_i),
        omega=float(rng.uniform(0.3, 4) * speed),
        xi=float(rng.choice([1e-4, rng.uniform(0.05, 1.5)], p=[0.15, 0.85])),
        tau=float(rng.uniform(0.001, 0.03)),
    )
    fast, lag = 0.0005, rng.choice([0.003, 0.012])
    filters = MeasurementPath(fast, math.exp(-fast / lag), float(lag))
    return BoxedLoop(
        PlantBox(nominal, mass, delay, tau_a, tau_b), gains, filters, rng.uniform(0.4, 0.8), 0.01
    )


def random_points(rng, problem, path, count):
    """Return plants and frequencies, ``(count, SIDES)``, many of them on the box's faces."""
    end = math.pi / problem.period
    if path != "sampled":
        end = 3 * math.pi / max(problem.box.delay[1], 0.005)
    edges = edges_of(problem, (0.0, end))
    points = edges[0] + (edges[1] - edges[0]) * rng.uniform(-0.5, 1.5, (count, SIDES)).clip(0, 1)
    points[:, OMEGA] = end * 10 ** rng.uniform(-3, 0, count)
    return points


def largest_value(form, curve, points):
    """Return the largest value of a figure at some points."""
    return max(figure_at(form, curve, point) for point in points)


def limits(found, form):
    """Return a bound's two values as the search has them: a disk margin's inverted, no unit."""
    if found.figure == "disk_margin":
        return tuple(1 / value if value else math.inf for value in (found.attained, found.bound))
    return found.attained / scale_of(form), found.bound / scale_of(form)


def compare_with_intervals(rng, problem, name, program, terms=2):
    """Hold the discs and a proof over one random box against the interval program.

    No member may leave the discs, in 80-bit arithmetic with outward rounding; a bound that the
    interval program guarantees must be proved, and one that a member exceeds must not.
    """
    form, curve = form_of(problem, *name), curve_of(1.0)
    edges = edges_of(problem, (1.0, 300.0))
    width = (edges[1] - edges[0]) * 10 ** rng.uniform(-6, -1, SIDES)
    low = edges[0] + (edges[1] - edges[0] - width) * rng.uniform(0, 1, SIDES)
    box = np.stack([low, low + width])
    centre, half = 0.5 * (box[0] + box[1]), 0.5 * width
    none = np.zeros(SIDES)
    over_box = discs_of(form, curve, centre, half * (1 + 1e-15), terms)
    at_centre = discs_of(form, curve, centre, none, terms)
    assert at_centre[1] - at_centre[0] <= 1e-9 * at_centre[1] + 1e-9
    largest = 0.0
    members = [centre, *(box[0] + width * rng.uniform(0, 1, (2, SIDES)))]
    for discs, member in zip((at_centre, over_box, over_box), members, strict=True):
        value = exactly(program, form, name, member, none, terms)
        assert discs[0] <= value[1]
        assert value[0] <= discs[1]
        largest = max(largest, value[0])
    whole = exactly(program, form, name, centre, half, terms)
    assert over_box[0] <= whole[1]
    assert whole[0] <= over_box[1]
    if form.loop == SAMPLED:
        return  # its proofs count what the interval program leaves out
    if math.isfinite(whole[1]):
        assert Proof(form, curve, box).run(whole[1] * (1 + 1e-9) + 1e-9, 100_000) == PROVED
    assert Proof(form, curve, box).run(largest * (1 - 1e-9), 100_000) != PROVED


def discs_of(form, curve, centre, half, terms):
    """Return the least and the largest value of a figure that the discs allow over a box."""
    shifts = shifts_up_to(terms if form.loop == SAMPLED else 0, form.period)
    row = np.empty(PER_DUAL * (FIXED + len(shifts)))
    coefficients(form, shifts, curve, centre[OMEGA], half[OMEGA], row)
    plant = plant_over(row, shifts, form.share_a, centre, half)
    scratch, power = np.empty((2, SIDES)), 2 if form.figure == COMPLIANCE else 0
    top, bottom = (
        enclose(plant, row, len(shifts), *weights, centre, half, *scratch, power)
        for weights in ((1.0, 0.0), (0.0, 1.0))
    )
    least, most = -bottom.value - bottom.spread, -bottom.value + bottom.spread
    low = math.sqrt(max(top.value - top.spread, 0.0) / most)
    return low, math.sqrt((top.value + top.spread) / least) if least > 0 else math.inf


def exactly(program, form, name, centre, half, terms):
    """Return the same from the interval program, as a pair of numbers rounded outwards."""
    gains, loop = form.gains, {}
    loop["k_p_vel"], loop["k_p_pos"], loop["k_i_pos"] = gains.k_p_vel, gains.k_p_pos, gains.k_i_pos
    loop["corner"], loop["xi"], loop["tau"] = gains.omega, gains.xi, gains.tau
    loop["share_a"] = form.share_a
    loop["nominal_mass"], loop["nominal_delay"] = form.nominal
    if form.path.sample_time > 0:
        loop["sample"], loop["pole"] = form.path.sample_time, form.path.filter_pole
    loop["period"] = form.period
    low, high = centre - half, centre + half
    box = {
        key: (low[i], high[i])
        for i, key in ((0, "omega"), (2, "delay"), (3, "tau_a"), (4, "tau_b"))
    }
    box["mass_ratio"] = (low[1], high[1])
    low, high = program.figure(box, loop, name, terms)
    return low / scale_of(form) * (1 - 4e-16), high / scale_of(form) * (1 + 4e-16)
