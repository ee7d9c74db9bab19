"""The sweep of both inequalities against the same sweep written with python-control objects.

Both are run side by side on 7⁴ plants and 400 frequencies; run with ``make bench``.
"""

import ctypes
import subprocess
import time
from pathlib import Path

import control
import numpy as np
import pytest
import target

from mptune.robust import condition
from mptune.robust.model import LinearModel

pytestmark = pytest.mark.bench


def control_sides(omega, plants, nominal, gains):
    """Return the largest left/right ratios of both conditions, with python-control objects."""
    s = control.tf("s")
    g_v = gains.k_p_vel
    g_p = gains.k_p_pos * (s**2 / gains.omega**2 + 2 * gains.xi * s / gains.omega + 1)
    g_p = g_p / (gains.tau * s + 1) ** 2 + gains.k_i_pos / s
    jw = 1j * omega
    controller = g_p(jw)
    g_n = (1 / (nominal.mass * s))(jw) * np.exp(-jw * nominal.delay)
    n_pos = g_n * g_v / (jw * (1 + g_n * g_v))
    right = [np.abs((1 + g_n * g_v) / (g_n * g_v))]
    right.append(np.abs((1 + n_pos * controller) / (n_pos * controller)))
    worst = np.zeros(2)
    for mass, delay, tau_a, tau_b, share_a in zip(*plants, strict=True):
        lead = tau_b * share_a + tau_a * (1 - share_a)
        plant = (lead * s + 1) / ((tau_a * s + 1) * (tau_b * s + 1) * mass * s)
        g_t = plant(jw) * np.exp(-jw * delay)
        t_pos = g_t * g_v / (jw * (1 + g_t * g_v))
        for loop, error in enumerate(((g_t - g_n) / g_n, (t_pos - n_pos) / n_pos)):
            worst[loop] = max(worst[loop], (np.abs(error) / right[loop]).max())
    return worst


@pytest.mark.guard
def test_sweep_is_at_least_400_times_faster_than_control_objects(boom, ratio):
    model, omega = LinearModel.of(boom), np.geomspace(0.1, 1000, 400)

    def fast():
        return model.sides(omega, model.gains)

    fast()  # compile, or load from the cache
    times = []
    for _ in range(7):
        start = time.perf_counter()
        found = fast()
        times.append(time.perf_counter() - start)
    start = time.perf_counter()
    slow = control_sides(omega, model.plants, model.nominal, model.gains)
    slow_time = time.perf_counter() - start
    fast_time = float(np.median(times))
    print(
        f"\n{model.plants.number} plants x {len(omega)} frequencies: "
        f"python-control {slow_time:.2f} s, mptune {1e3 * fast_time:.1f} ms, "
        f"{slow_time / fast_time:.0f} times faster"
    )
    np.testing.assert_allclose(found.ratio.max(axis=1), slow, rtol=1e-9)
    ratio(
        "sweep of both inequalities: python-control over mptune", slow_time / fast_time, least=400
    )


@pytest.mark.guard
def test_sweep_is_at_most_twice_as_slow_as_a_c_loop(boom, tmp_path, ratio):
    """The same factors in C, compiled with -O3 -march=native."""
    compiler = target.gcc()
    if compiler is None:
        pytest.skip("no gcc here")
    library = tmp_path / "family_errors.so"
    flags = ["-O3", "-march=native", "-shared", "-fPIC", "-o", str(library)]
    source = Path(__file__).parent / "family_errors.c"
    subprocess.run([*compiler, *flags, str(source), "-lm"], check=True)
    model, omega = LinearModel.of(boom), np.geomspace(0.1, 1000, 400)
    loops = model.nominal_gains(omega, model.gains)
    weight = np.ascontiguousarray(np.abs(loops) / np.abs(1 + loops))
    factors = condition._factors(model.plants, model.nominal)
    delays, lags, plants = len(factors.delay), factors.lags.shape[1], len(factors.mass_ratio)
    left, ratio = np.zeros((2, len(omega))), np.zeros((2, plants))
    rows = [np.zeros(delays, complex), np.zeros(lags, complex)]
    loop = np.ascontiguousarray(loops[0])

    def pointer(array):
        return array.ctypes.data_as(ctypes.c_void_p)

    run = ctypes.CDLL(str(library)).family_errors
    arguments = (
        len(omega), pointer(omega), delays, pointer(factors.delay), lags,
        *(pointer(np.ascontiguousarray(one)) for one in factors.lags), plants,
        pointer(factors.mass_ratio), pointer(factors.which_delay), pointer(factors.which_lags),
        ctypes.c_double(model.nominal.delay), pointer(loop), pointer(weight),
        *map(pointer, rows), pointer(left), pointer(ratio),
    )  # fmt: skip
    times = {"mptune": [], "C": []}
    for _ in range(9):
        for name, work in (
            (
                "mptune",
                lambda: condition._family_errors(omega, factors, model.nominal.delay, loop, weight),
            ),
            ("C", lambda: run(*arguments)),
        ):
            start = time.perf_counter()
            found = work()
            times[name].append(time.perf_counter() - start)
            if name == "mptune":
                expected = found
    np.testing.assert_allclose(left, expected[0], rtol=1e-12)
    np.testing.assert_allclose(ratio, expected[2], rtol=1e-12)
    ours, theirs = (float(np.median(times[name][1:])) for name in ("mptune", "C"))
    print(f"\nmptune {1e3 * ours:.1f} ms, C {1e3 * theirs:.1f} ms: {ours / theirs:.2f} times")
    ratio("sweep of Eq. 17: mptune over a loop in C", ours / theirs, most=2)
