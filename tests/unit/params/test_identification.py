"""The optional section on identification: units, bounds and errors."""

import pytest

from mptune.errors import InputError


def test_values_are_read_with_their_units(load_boom):
    asked = load_boom(
        'identification.frequency=["2 rad/s", "100 rad/s"]',
        'identification.pressures=["30 bar"]',
        'identification.valve_delays=["0 ms", "5 ms"]',
    ).study.identification
    assert asked.frequency == (2, 100)
    assert asked.pressures == (pytest.approx(3e6),)
    assert asked.valve_delays == (0, pytest.approx(5e-3))


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("identification.amplitude=0 kN", "at least 0.001 N"),
        ("identification.amplitude=5 kPa", "wrong dimension"),
        ('identification.frequency=["9 rad/s", "2 rad/s"]', "reversed"),
        ('identification.frequency=["0 rad/s", "2 rad/s"]', "at least 0.001 rad/s"),
        ('identification.frequency=["1 Hz", "2 Hz"]', "radians or cycles"),
        ("identification.frequencies=1", "at least 2"),
        ("identification.positions=[]", "empty list"),
        ('identification.pressures="3 MPa"', "single value"),
        ('identification.valve_delays=["-1 ms"]', "at least 0"),
        ("identification.velocity=1", "did you mean `velocities`"),
    ],
)
def test_bad_values_are_refused_one_by_one(load_boom, override, words):
    with pytest.raises(InputError, match=words):
        load_boom(override)
