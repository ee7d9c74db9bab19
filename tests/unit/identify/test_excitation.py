"""Force references: their peak, their frequencies and how even they are."""

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.identify.excitation import Excitation, excitation_named, runs_of


@pytest.fixture(scope="module")
def runs(boom):
    def make(excitation):
        return runs_of(boom.study.identification, boom.study.controller, excitation)

    return make


@pytest.mark.parametrize("excitation", list(Excitation))
def test_the_peak_is_the_amplitude(runs, excitation):
    for run in runs(excitation):
        assert np.abs(run.reference).max() == pytest.approx(10e3, rel=2e-3)


@pytest.mark.parametrize("excitation", list(Excitation))
def test_records_are_whole_sampling_periods_after_a_start_up(runs, excitation):
    for run in runs(excitation):
        assert run.start_up >= 1000  # 0.5 s
        assert run.start_up % 20 == 0
        assert len(run.reference) > run.start_up


def test_sines_cover_the_frequencies_in_a_logarithmic_grid(runs):
    found = []
    for run in runs(Excitation.SINE):
        u = run.reference[run.start_up :]
        omega, response, quality = run.analyse(u, np.stack([u, 0.5 * u]))
        np.testing.assert_allclose(response[:, 0], [1, 0.5], rtol=1e-6)
        assert quality.min() > 0.999
        found.append(omega[0])
    np.testing.assert_allclose(found, np.geomspace(1, 200, 24), rtol=2.5e-3)


def test_a_multisine_is_periodic_even_and_of_low_crest(runs):
    (run,) = runs(Excitation.MULTISINE)
    period = run.start_up
    u = run.reference
    assert len(u) == 5 * period
    np.testing.assert_allclose(u[period:], u[:-period], atol=1e-6)
    crest = np.abs(u).max() / np.sqrt(np.mean(u**2))
    print(f"crest factor {crest:.2f}")
    assert crest < 2.5
    omega, response, _ = run.analyse(u[period:], u[None, period:])
    np.testing.assert_allclose(response, 1, rtol=1e-9)
    line = np.abs(np.fft.rfft(u[:period]))
    strong = line[np.rint(omega * period * 0.5e-3 / (2 * np.pi)).astype(int)]
    np.testing.assert_allclose(strong, strong.mean(), rtol=1e-6)
    assert np.sort(line)[-len(omega) - 1] < 1e-6 * strong.mean()


def test_a_chirp_covers_the_band_without_a_gap(runs):
    (run,) = runs(Excitation.CHIRP)
    u = run.reference[run.start_up :]
    late = np.roll(u, 20)  # 10 ms
    omega, response, quality = run.analyse(u, late[None])
    assert omega[0] < 2
    assert omega[-1] > 199
    middle = (omega > 5) & (omega < 190)
    np.testing.assert_allclose(np.abs(response[0, middle]), 1, atol=0.05)
    np.testing.assert_allclose(
        np.angle(response[0, middle] * np.exp(1j * omega[middle] * 0.01)), 0, atol=0.05
    )
    assert quality[0, middle].min() > 0.95


def test_an_unknown_shape_is_refused_with_the_known_ones():
    with pytest.raises(InputError, match="sine, multisine, chirp"):
        excitation_named("square")
