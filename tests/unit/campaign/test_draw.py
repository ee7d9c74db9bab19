"""What a draw makes of a study's machine."""

import numpy as np
import pytest

from mptune.campaign.draw import PARAMETER_UNITS, Draw, box_of, rig_of_draw
from mptune.campaign.temperature import REFERENCE, temperature_factors
from mptune.errors import InputError
from mptune.params.packed import INERTANCE, RESISTANCE
from mptune.verify.verify import Case, rig_of

TRUE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # of the sensors
NEUTRAL = Draw(24500.0, 6e-3, 1.2e9, 9700.0, 1.0, REFERENCE, 1.0, 0.0, *TRUE, 1.0, 1.0)


def rig(study, **changes):
    own = study.study
    return rig_of_draw(study, NEUTRAL._replace(**changes), own.gains, own.feedforward, 1)


def test_a_neutral_draw_is_the_machine_that_verification_builds(boom):
    case = Case(24500.0, (6e-3, 6e-3), 1.2e9, 9700.0, 1)
    own = boom.study
    drawn, made = rig(boom)
    assert drawn == case
    wanted = rig_of(boom, case, own.gains, own.feedforward)
    assert made.more is wanted.more is None  # the boom has two chambers
    for a, b in zip(made[:-1], wanted[:-1], strict=True):
        assert all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


def test_every_parameter_has_a_unit_in_the_order_of_the_draw():
    assert tuple(PARAMETER_UNITS) == Draw._fields


@pytest.mark.parametrize(
    ("changes", "field", "factor"),
    [
        ({"friction": 2.0}, "friction_coulomb", 2.0),
        ({"friction": 2.0}, "friction_static", 2.0),
        ({"friction": 0.5}, "friction_viscous", 0.5),
        ({"temperature": 293.15}, "friction_viscous", np.exp(0.7)),
        ({"temperature": 293.15}, "friction_coulomb", 1.0),
        ({"temperature": 293.15}, "oil", np.exp(0.1)),
        ({"mass": 49000.0}, "mass", 2.0),
    ],
)
def test_a_parameter_moves_what_it_should(boom, changes, field, factor):
    before, after = rig(boom)[1].machine, rig(boom, **changes)[1].machine
    assert getattr(after, field) == pytest.approx(factor * getattr(before, field))


def test_hoses_become_lines_from_one_half_on(boom, load_boom):
    for lines, inert in ((0.0, False), (0.49, False), (0.5, True), (1.0, True)):
        assert (rig(boom, lines=lines)[1].machine.line_inertance > 0) == inert
    lined = load_boom("hose.dynamics=true")
    assert rig(lined, lines=1.0)[1].machine == rig(boom, lines=1.0)[1].machine
    assert rig(lined, lines=0.0)[1].machine == rig(boom)[1].machine


def test_hoses_of_four_chambers_become_lines_that_warm_with_their_oil(load_shape):
    """By the same factor as those of two; a chamber without a hose has no line."""
    study = load_shape("four-converters")
    assert rig(study, lines=0.0)[1].more.table[INERTANCE].tolist() == [0, 0, 0, 0]
    cool, warm = (rig(study, lines=1.0, temperature=t)[1] for t in (293.15, 313.15))
    assert np.flatnonzero(warm.more.table[INERTANCE]).tolist() == [1]
    factor = cool.machine.line_resistance_b / warm.machine.line_resistance_b
    assert factor > 1.5
    assert cool.more.table[RESISTANCE] == pytest.approx(factor * warm.more.table[RESISTANCE])


def test_sensors_are_as_untrue_as_they_were_drawn(boom):
    drawn = {
        "pressure_gain_error_a": 0.02,
        "pressure_gain_error_b": -0.01,
        "pressure_offset_a": 1e5,
        "pressure_offset_b": -2e5,
        "position_hysteresis": 3e-5,
        "position_resolution": 1e-5,
    }
    found = rig(boom, **drawn)[1].signals.sensors
    assert found == (1.02, 0.99, 1e5, -2e5, 3e-5, 1e-5)


def test_a_study_s_own_sensors_and_hoses_are_drawn_where_no_range_is_given(load_boom):
    own = load_boom("sensors.pressure_offset_b=50 kPa", "hose.dynamics=true")
    low, high = (Draw(*ends) for ends in box_of(own))
    assert (low.pressure_offset_b, low.lines) == (high.pressure_offset_b, high.lines) == (5e4, 1.0)
    box = box_of(load_boom("campaign.pressure_gain_error_a=[-0.02, 0.02]", "campaign.lines=[0, 1]"))
    assert box.names[-2:] == ("lines", "pressure_gain_error_a")


def test_noise_scales_every_sensor_and_nothing_else(boom):
    before, after = rig(boom)[1].signals, rig(boom, noise=3.0)[1].signals
    for name, value in before._asdict().items():
        if isinstance(value, tuple):  # the estimator, and what is untrue about the sensors
            assert getattr(after, name) == value
            continue
        factor = 3.0 if name.endswith("_noise") else 1.0
        assert getattr(after, name) == pytest.approx(factor * value), name


def test_cold_oil_is_thicker_stiffer_and_slows_the_valves():
    cold, warm = temperature_factors(273.15), temperature_factors(353.15)
    assert all(c > 1 > w for c, w in zip(cold, warm, strict=True))
    assert temperature_factors(REFERENCE) == (1.0, 1.0, 1.0)


def test_moves_scale_in_length_and_time_and_keep_their_rests(boom):
    before, after = rig(boom)[1].moves, rig(boom, distance=0.5, duration=2.0)[1].moves
    assert after.travel == pytest.approx(0.5 * before.travel, rel=1e-3)
    assert after.duration == pytest.approx(2 * 4 * 1.25 + 4 * 1.0)
    assert after.reach == pytest.approx(0.5 * before.reach, rel=1e-6)


def test_ranges_are_the_studys_own_where_none_are_given(boom, load_boom):
    box = box_of(boom)
    assert box.names == ("mass", "valve_delay", "oil_bulk_modulus")
    assert (box.low[0], box.high[0]) == (24500, 49000)
    other = box_of(load_boom('campaign.mass=["1 t", "2 t"]', 'campaign.load_force=["0 N", "1 kN"]'))
    assert (other.low[0], other.high[0]) == (1000, 2000)
    assert other.names[-1] == "load_force"
    assert other.low[3] == 0


@pytest.mark.parametrize(
    ("overrides", "key"),
    [
        (['campaign.valve_delay=["5 ms", "10 ms"]'], "campaign.valve_delay"),
        (  # 9 ms at 40 °C are more than 10 ms at 0 °C
            ['campaign.valve_delay=["5 ms", "9 ms"]', 'campaign.temperature=["273 K", "313 K"]'],
            "campaign.valve_delay",
        ),
        (["campaign.distance=[1, 3]"], "campaign.distance"),
    ],
)
def test_what_cannot_be_simulated_is_refused_by_name(load_boom, overrides, key):
    with pytest.raises(InputError, match=key):
        box_of(load_boom(*overrides))


def test_sets_are_not_repeated_where_they_do_not_end_where_they_began(load_boom):
    one_way = 'manoeuvre=[{distance="10 mm", duration="1 s", rest="1 s"}]'
    with pytest.raises(InputError, match=r"campaign\.sets"):
        box_of(load_boom(one_way, "verification.repeats=1", "campaign.sets=2"))
