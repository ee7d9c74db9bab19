"""From written coefficients back to gains."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from target import gains_of

from mptune.export.as_written import rounded_section, written_gains
from mptune.export.constants import Number, Numbers, controller_numbers
from mptune.export.formats import Precision
from mptune.params.controller import Gains

gains_in_reach = st.builds(
    Gains.model_construct,
    k_p_vel=st.floats(1e5, 1e6),
    k_p_pos=st.floats(1.0, 40.0),
    k_i_pos=st.just(0.0) | st.floats(1e-3, 200.0),
    omega=st.floats(10.0, 200.0),
    xi=st.floats(0.1, 1.5),
    tau=st.floats(1e-3, 30e-3),
)


def written(study, gains, precision):
    feedforward = study.study.feedforward
    return written_gains(controller_numbers(study, gains, feedforward, precision), gains)


@given(gains=gains_in_reach)
def test_coefficients_give_their_gains_back(study, gains):
    back = written(study, gains, Precision.DOUBLE)
    for key, value in gains.model_dump().items():
        assert getattr(back.gains, key) == pytest.approx(value, rel=1e-10, abs=1e-12)
    assert back.deviation < 1e-11
    assert back.position_filter == pytest.approx(12e-3, rel=1e-12)


@given(gains=gains_in_reach)
def test_single_precision_moves_the_gains_by_what_its_coefficients_lose(study, gains):
    back = written(study, gains, Precision.FLOAT)
    assert back.gains.k_p_vel == float(np.float32(gains.k_p_vel))
    assert back.gains.k_i_pos == pytest.approx(gains.k_i_pos, rel=2e-7)
    assert back.deviation < 1e-5  # the split of the double pole
    assert back.position_filter == pytest.approx(12e-3, rel=2e-6)
    assert back.position_filter != pytest.approx(12e-3, rel=1e-9)


def test_a_coefficient_that_no_gains_have_shows_as_deviation(study):
    file = gains_of(study)
    numbers = controller_numbers(study, file.gains, file.feedforward, Precision.DOUBLE)

    def spoilt(one):
        return one._replace(value=one.value + 0.05) if one.key == "a2" else one

    sections = {name: tuple(map(spoilt, part)) for name, part in numbers.sections.items()}
    back = written_gains(Numbers(sections, numbers.ticks, numbers.precision), file.gains)
    assert back.deviation > 1e-2
    assert isinstance(numbers.all()[0], Number)


def test_a_position_controller_that_is_off_keeps_its_shape(study):
    gains = study.study.gains.model_copy(update={"k_p_pos": 0.0, "k_i_pos": 0.0})
    back = written(study, gains, Precision.DOUBLE)
    assert (back.gains.k_p_pos, back.gains.k_i_pos) == (0.0, 0.0)
    assert (back.gains.omega, back.gains.xi) == (gains.omega, gains.xi)
    assert back.deviation == 0.0


@pytest.mark.parametrize(("digits", "tau"), [(None, 0.0052463), (17, 0.0052463), (2, 0.0052)])
def test_gains_are_rounded_to_significant_digits(study, digits, tau):
    gains = study.study.gains.model_copy(update={"tau": 0.0052463, "k_p_vel": 709249.0})
    rounded = rounded_section(gains, digits)
    assert rounded.tau == tau
    assert rounded.k_p_vel == (709249.0 if digits != 2 else 710000.0)
    assert math.isfinite(rounded.xi)
