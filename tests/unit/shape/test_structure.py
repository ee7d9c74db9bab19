"""Controllers linear in their parameters."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.errors import InputError
from mptune.loops.position import position_controller
from mptune.shape import structure
from mptune.tune.position_limits import damping_limits, frequency_limits

OMEGA = np.geomspace(0.01, 1000, 50)
GAINS = st.tuples(
    st.floats(0.1, 100), st.floats(0, 500), st.floats(1, 200), st.floats(0, 2), st.floats(1e-3, 0.1)
)


@given(GAINS)
def test_position_structure_is_eq_22(gains):
    k_p, k_i, omega, xi, tau = gains
    x = structure.position_parameters(k_p, k_i, omega, xi)
    own = structure.position(tau).controller(x, OMEGA)
    s = 1j * OMEGA
    equation = np.array([position_controller(one, k_p, k_i, omega, xi, tau) for one in s])
    np.testing.assert_allclose(own, equation, rtol=1e-10)


@given(GAINS)
def test_gains_survive_the_way_to_parameters_and_back(gains):
    back = structure.position_gains(structure.position_parameters(*gains[:4]))
    assert back == pytest.approx(gains[:4], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("x", [[1, 1, 0, 1], [0, 1, 1, 1], [1, 1, -1, 1]])
def test_parameters_without_omega_are_refused(x):
    with pytest.raises(InputError, match="ω"):
        structure.position_gains(np.array(x, float))


def test_pid_is_the_filtered_sum():
    s = 1j * OMEGA
    found = structure.pid(0.1).controller(np.array([2.0, 3.0, 0.5]), OMEGA)
    np.testing.assert_allclose(found, (2 + 3 / s + 0.5 * s) / (0.1 * s + 1))


def test_a_basis_of_ones_own_and_its_names():
    own = structure.basis_of([lambda s: 1.0, lambda s: s / (s + 1)], ["a", "b"])
    found = own.controller(np.array([2.0, 3.0]), OMEGA)
    np.testing.assert_allclose(found, 2 + 3 * 1j * OMEGA / (1j * OMEGA + 1))
    assert own.index("b") == 1
    with pytest.raises(InputError, match="one of a, b"):
        own.index("c")


def kept(limits, x):
    """Return whether every requirement on the parameters alone is kept, by its own definition."""
    values = []
    for one in limits:
        if hasattr(one, "coefficients"):
            values.append(one.coefficients @ x <= one.largest)
        elif hasattr(one, "value"):
            values.append(one.value(x) <= 0)
        else:
            values.append(abs(one.left @ x) <= one.right @ x)
    return all(values)


@given(GAINS, st.floats(1, 200))
def test_limits_of_omega_and_xi_say_the_same_of_parameters_as_of_gains(gains, typical):
    _, _, omega, xi, _ = gains
    x = structure.position_parameters(*gains[:4])
    for value, low, high in ((omega, 20.0, 60.0), (xi, 0.4, 0.9)):
        if min(abs(value / low - 1), abs(value / high - 1)) < 1e-6:
            return  # on the edge rounding decides
    assert kept(frequency_limits(20, 60), x) == (20 <= omega <= 60)
    assert kept(damping_limits(0.4, 0.9, typical), x) == (0.4 <= xi <= 0.9)


@given(GAINS, GAINS)
def test_the_tangent_of_the_lower_limit_of_xi_is_on_the_safe_side(one, other):
    limit = damping_limits(0.4, 0.9, 30.0)[0]
    at = structure.position_parameters(*one[:4])
    x = structure.position_parameters(*other[:4])
    tangent = limit.value(at) + limit.gradient(at) @ (x - at)
    assert tangent >= limit.value(x) - 1e-9 * (1 + limit.size(x) + abs(tangent))


@pytest.mark.parametrize(
    "one", [structure.p(), structure.pi(), structure.pid(0.07), structure.position(0.03)]
)
def test_fraction_is_the_basis(one):
    """Numerators over one denominator against the functions themselves."""
    x = np.arange(1.0, 1.0 + len(one.names))
    numerator, denominator = one.fraction(x)
    s = 1j * OMEGA
    found = np.polyval(numerator, s) / np.polyval(denominator, s)
    np.testing.assert_allclose(found, one.controller(x, OMEGA), rtol=1e-12)


def test_a_basis_of_mere_functions_has_no_fraction():
    own = structure.basis_of([lambda s: np.exp(-s)], ["k"])
    with pytest.raises(InputError, match="not known as a fraction"):
        own.fraction(np.ones(1))
