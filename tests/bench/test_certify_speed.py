"""Certificates of the paper's study: boxes and time; and at length, that nothing exceeds them.

Run with ``make bench``, at length with ``make trials``.
"""

import math
import time

import numpy as np
import pytest
from certified import (
    FIGURES,
    compare_with_intervals,
    largest_value,
    limits,
    random_points,
    random_problem,
    reference,
)
from scipy.optimize import minimize

from mptune.certify.bounds import bound
from mptune.certify.climb import explore, figure_at
from mptune.certify.enclosure import OMEGA, SIDES
from mptune.certify.form import curve_of, form_of
from mptune.certify.margins import MARGINS, margin
from mptune.certify.problem import PATHS, BoxedLoop, edges_of
from mptune.certify.radius import RADII, radius
from mptune.certify.stability import box_stability, corner_verdict

pytestmark = pytest.mark.bench

SETS = ("", "section-5-1")


@pytest.fixture(scope="module", params=SETS, ids=["fig_5", "section_5_1"])
def problem(request, load_boom):
    return BoxedLoop.of(load_boom(uncertainty=request.param))


def timed(work):
    """Return what is worked out and the least of three times, nothing remembered between them."""
    work()  # compile, or load from the cache
    times = []
    for _ in range(3):
        corner_verdict.cache_clear()
        start = time.perf_counter()
        found = work()
        times.append(time.perf_counter() - start)
    return found, min(times)


def test_every_certificate_of_a_sweep(problem):
    total = 0.0
    print()
    for path in PATHS:
        found, spent = timed(lambda path=path: box_stability(problem, path))
        total += spent
        print(f"stability {path:8} {found.status:10} {found.boxes:7} boxes {1e3 * spent:7.1f} ms")
    for name in FIGURES:
        found, spent = timed(lambda name=name: bound(problem, *name))
        total += spent
        label = " ".join(name)
        print(
            f"{label:44} {found.attained:9.5f} {found.bound:9.5f} {found.boxes:7} boxes "
            f"{1e3 * spent:7.1f} ms"
        )
        assert found.closed
        assert spent <= (1.0 if name[1] == "sampled" else 0.6)
    print(f"all that a sweep certifies: {total:.2f} s")
    assert total <= 4
    for until in (one for one in RADII if one != "estimator"):  # the boom has none
        found, spent = timed(lambda until=until: radius(problem, until))
        total += spent
        label = f"{found.lower:.4f} to {found.upper:.4f}"
        print(f"radius {until:12} {label:20} {found.boxes:7} boxes {1e3 * spent:7.1f} ms")
        assert found.closed
    print(f"with the radii: {total:.2f} s")
    assert total <= 6
    for path in PATHS:
        for name in MARGINS:
            found, spent = timed(lambda path=path, name=name: margin(problem, path, name))
            label = f"{found.lower:.5g} to {found.upper:.5g}"
            print(f"{path:8} {name:13} {label:22} {found.boxes:7} boxes {1e3 * spent:7.1f} ms")
            assert found.closed


@pytest.mark.trial
@pytest.mark.parametrize("name", FIGURES, ids="-".join)
def test_a_million_plants_and_two_hundred_ascents(problem, name):
    found = bound(problem, *name)
    attained, proved = limits(found)
    if not math.isfinite(proved):
        pytest.skip("a witness stands for the whole box")
    form, curve = form_of(problem, *name), curve_of(1.0)
    rng = np.random.default_rng(1)
    plants = random_points(rng, problem, name[1], 1000)
    omega = random_points(rng, problem, name[1], 1000)[:, OMEGA]
    edges = edges_of(problem, (0.0, float(omega.max())))
    best = explore(form, curve, edges, omega, plants.copy(), 1, 0.0, np.empty(SIDES))
    assert best <= proved
    top = best
    width = np.where(edges[1] > edges[0], edges[1] - edges[0], 1.0)
    for plant in plants[:200]:
        found = minimize(
            lambda x: -figure_at(form, curve, edges[0] + np.clip(x, 0, 1) * width),
            (plant - edges[0]) / width,
            method="L-BFGS-B",
            bounds=[(0.0, 1.0 if high > low else 0.0) for low, high in edges.T],
        )
        top = max(top, -float(found.fun))
    print(f"\n{best:.6f} by chance, {top:.6f} by ascents, {attained:.6f} attained, {proved:.6f}")
    assert top <= proved
    assert top <= attained * (1 + 1e-4)


@pytest.mark.trial
def test_a_thousand_random_families():
    rng = np.random.default_rng(2)
    opened = total = 0
    start = time.perf_counter()
    for _ in range(1000):
        problem = random_problem(rng)
        for name in FIGURES:
            found = bound(problem, *name)
            attained, proved = limits(found)
            total += 1
            opened += not found.closed
            assert attained <= proved
            if math.isfinite(proved):
                points = random_points(rng, problem, name[1], 30)
                highest = largest_value(form_of(problem, *name), curve_of(1.0), points)
                assert highest <= proved * (1 + 1e-12)
    spent = time.perf_counter() - start
    print(f"\n{total} certificates, {opened} of them open, {spent:.0f} s")
    assert opened <= 0.005 * total


@pytest.mark.trial
def test_ten_thousand_boxes_against_interval_arithmetic():
    rng, program = np.random.default_rng(3), reference()
    for k in range(10_000):
        compare_with_intervals(rng, random_problem(rng), FIGURES[k % len(FIGURES)], program)
