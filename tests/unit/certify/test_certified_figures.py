"""Coefficients of figures as functions of ω, each against mpmath over its whole interval."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp
from test_balls import assert_encloses
from test_enclosure import GAINS

from mptune.certify import aliases, figures
from mptune.certify.form import form_of
from mptune.certify.shares import share_of

CURVE = np.array([[10.0, 0.7], [50.0, 0.4], [50.001, 0.41], [200.0, 0.9]])
WITHIN = st.floats(0.0, 1.0)


@given(st.integers(0, 4), WITHIN, WITHIN)
def test_what_is_allowed(segment, place, width):
    ends = [0.0, *CURVE[:, 0], 400.0]
    low, high = ends[segment], ends[segment + 1]
    half = 0.499 * width * (high - low)
    omega = low + half + place * (high - low - 2 * half)

    def exact(at):
        if segment in {0, 4}:
            return mp.mpf(CURVE[0 if segment == 0 else -1, 1])
        (w0, a0), (w1, a1) = ((mp.mpf(x), mp.mpf(y)) for x, y in CURVE[segment - 1 : segment + 1])
        return a0 + (a1 - a0) * mp.log(at / w0) / mp.log(w1 / w0)

    if 0 < segment < 4 and not low * 1.000001 < omega - half <= omega + half < high * 0.999999:
        return  # differences of mpmath's would reach over the corner
    assert_encloses(figures._allowed(CURVE, omega, half), exact, omega, half)


@given(st.floats(0.0, 314.0), st.floats(0.0, 150.0), st.sampled_from([1, -1, 2, -5, 30]))
def test_the_share_of_a_shifted_frequency(omega, half, shift):
    shift *= 2 * np.pi / 0.01
    found = share_of(omega, half, shift)
    exact_shift = 2 * mp.pi * round(shift * 0.01 / (2 * np.pi)) / mp.mpf("0.01")
    assert_encloses(found, lambda at: at / (at + exact_shift), omega, half)


@pytest.fixture(scope="module")
def forms(varied):
    return {
        (kind, path): form_of(varied(gains=gains), "force_reference", path, "sensitivity_peak")
        for kind, gains in GAINS.items()
        for path in ("filters", "sampled")
    }


def controller(form, s):
    """Return Eq. 22, from its terms."""
    gains = form.gains
    corner, tau = mp.mpf(gains.omega), mp.mpf(gains.tau)
    shape = s * s / corner**2 + 2 * mp.mpf(gains.xi) * s / corner + 1
    return gains.k_p_pos * shape / (tau * s + 1) ** 2 + gains.k_i_pos / s


@pytest.mark.parametrize("kind", GAINS)
@given(omega=st.floats(0.5, 300.0), share=WITHIN)
def test_eq_23_and_eq_22(forms, kind, omega, share):
    form = forms[kind, "filters"]
    half = 0.4 * share * omega
    time = mp.mpf(form.path.sample_time)

    def exact_23(at):
        z = mp.expj(-at * time)
        return (5 + 3 * z + z**2 - z**3 - 3 * z**4 - 5 * z**5) / (35 * time) / (1j * at)

    assert_encloses(aliases.differentiator(form, omega, half), exact_23, omega, half)
    first, law = figures.shape_of(form, omega, half)
    order = 2 if form.gains.k_i_pos else 1 if form.gains.k_p_pos else 0

    def exact_first(at):
        lag = (1 + 1j * at * mp.mpf(form.gains.tau)) ** 2
        return (1j * at) ** order * lag if order else mp.mpf(1)

    def exact_law(at):  # Q over what both share: G_P times s^(k − 1) R
        if not order:
            return mp.mpf(0)
        return controller(form, 1j * at) * exact_first(at) / (1j * at)

    assert_encloses(first, exact_first, omega, half)
    assert_encloses(law, exact_law, omega, half)


@pytest.mark.parametrize("kind", GAINS)
@given(omega=st.floats(0.5, 300.0), share=WITHIN)
def test_eq_22_under_tustin(forms, kind, omega, share):
    form = forms[kind, "sampled"]
    half = 0.4 * share * min(omega, 314.0 - omega)
    first, law = aliases.sampled_law(form, omega, half)
    order = 2 if form.gains.k_i_pos else 1 if form.gains.k_p_pos else 0
    period, tau = mp.mpf(form.period), mp.mpf(form.gains.tau)

    def warped(at):
        w = mp.expj(-at * period)
        return 2 / period * (1 - w) / (1 + w)

    def exact_first(at):
        if not order:
            return mp.mpf(1)
        w = mp.expj(-at * period)
        lags = ((1 + tau * warped(at)) * (1 + w)) ** 2
        return 1j * at * lags * ((1 - w) / period if order == 2 else 1)

    def exact_law(at):
        if not order:
            return mp.mpf(0)
        return controller(form, warped(at)) * exact_first(at) / (1j * at)

    assert_encloses(first, exact_first, omega, half)
    assert_encloses(law, exact_law, omega, half)
