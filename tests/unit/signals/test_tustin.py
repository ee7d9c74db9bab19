"""The discrete controller against scipy's bilinear transform of Eq. 22."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import cont2discrete, dlsim, dlti

from mptune.params.packed import LoopGains
from mptune.signals.tustin import discrete_response, discretise

gains = st.builds(
    LoopGains,
    k_p_vel=st.just(7e5),
    k_p_pos=st.floats(0.5, 50),
    k_i_pos=st.floats(0, 100),
    omega=st.floats(5, 200),
    xi=st.floats(0.05, 2),
    tau=st.floats(0.002, 0.05),
)


def run(law, errors):
    """Run the difference equations that the docstring states."""
    lag1 = lag2 = integral = last = 0.0
    outputs = []
    for error in errors:
        shaped = law.b0 * error + lag1
        lag1 = law.b1 * error - law.a1 * shaped + lag2
        lag2 = law.b2 * error - law.a2 * shaped
        integral += law.integral * (error + last)
        last = error
        outputs.append(shaped + integral)
    return np.array(outputs)


@given(gains=gains, seed=st.integers(0, 2**32 - 1))
def test_difference_equations_equal_scipys_bilinear_transform(gains, seed):
    period = 0.01
    shape = gains.k_p_pos * np.array([1 / gains.omega**2, 2 * gains.xi / gains.omega, 1.0])
    lags = np.array([gains.tau**2, 2 * gains.tau, 1.0])
    numerator = np.polyadd(np.polymul(shape, [1, 0]), gains.k_i_pos * lags)
    denominator = np.polymul(lags, [1, 0])
    system = cont2discrete((numerator, denominator), period, method="bilinear")
    errors = np.random.default_rng(seed).normal(size=60)
    _, expected = dlsim(dlti(np.squeeze(system[0]), system[1], dt=period), errors)
    found = run(discretise(gains, period), errors)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found, expected[:, 0], atol=1e-8 * scale)


@given(gains=gains, bent=st.floats(0.1, 3.0))
def test_its_response_is_that_of_eq_22_at_the_frequency_that_tustin_bends_it_to(gains, bent):
    """Tustin puts s = (2/T_S)(1 − w)/(1 + w) wherever Eq. 22 has s; all of it, up to Nyquist."""
    period = 0.01
    w = np.exp(-1j * bent)
    s = 2 / period * (1 - w) / (1 + w)
    shape = (s / gains.omega) ** 2 + 2 * gains.xi * s / gains.omega + 1
    expected = gains.k_p_pos * shape / (gains.tau * s + 1) ** 2 + gains.k_i_pos / s  # Eq. 22
    found = discrete_response(discretise(gains, period), w)
    np.testing.assert_allclose(found, expected, rtol=1e-9)
