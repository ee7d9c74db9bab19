"""Quantities as people write them."""

from __future__ import annotations

import contextlib
import subprocess
import sys

import pytest

from mptune.units import UnitError, parse_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1400 MPa", "Pa", 1.4e9),
        ("0.4 dm^3", "m^3", 0.4e-3),
        ("0.4 dm**3", "m^3", 0.4e-3),
        ("12.2 ms", "s", 0.0122),
        ("700 kN s/m", "N s/m", 700e3),
        ("700 kN*s/m", "N s/m", 700e3),
        ("12 l/min", "m^3/s", 0.0002),
        ("2.357e-7 m^3/(s Pa^0.5)", "m^3/(s Pa^0.5)", 2.357e-7),
        ("2e11 N s/m^6", "N s/m^6", 2e11),
        ("13 1/s", "1/s", 13.0),
        ("46.96/s", "1/s", 46.96),
        ("22 /s²", "1/s^2", 22.0),
        ("10 l/min at 0.5 MPa", "m^3/(s Pa^0.5)", 1e-2 / 60 / 0.5e6**0.5),
        ("40 l/min @ 5 bar", "m^3/(s Pa^0.5)", 4e-2 / 60 / 0.5e6**0.5),
        ("24.5t", "kg", 24500.0),
        ("  5   mm ", "m", 0.005),
        ("-35 mm", "m", -0.035),
        (".5 kN", "N", 500.0),
        ("60 rpm", "rad/s", 6.283185307179586),
        ("180 deg/s", "rad/s", 3.141592653589793),
        ("10 µm", "m", 1e-5),  # micro sign
        ("10 μm", "m", 1e-5),  # Greek mu
        ("0.4 dm³", "m^3", 0.4e-3),
        ("31.2 cm²", "m^2", 31.2e-4),
        ("13 s⁻¹", "1/s", 13.0),
        ("22 1/s²", "1/s^2", 22.0),
        ("14 N/mm²", "Pa", 14e6),
        ("700 kN⋅s/m", "N s/m", 700e3),
        ("700 kN·s/m", "N s/m", 700e3),
        ("−35 mm", "m", -0.035),
        ("2.357·10⁻⁷ m³/(s Pa^0.5)", "m^3/(s Pa^0.5)", 2.357e-7),
        ("360 °/s", "rad/s", 6.283185307179586),
        ("20 degC", "K", 293.15),
        ("20 °C", "K", 293.15),
        ("0 degC", "K", 273.15),
        ("20 delta_degC", "K", 20.0),
        ("20 K", "K", 20.0),
        ("24.5 tonne", "kg", 24500.0),
        ("1 short_ton", "kg", 907.18474),
    ],
)
def test_a_quantity_becomes_its_si_value(text, unit, value):
    assert parse_quantity(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12.2 ms", "s", 0.0122),
        ("11.9 ms", "s", 0.0119),
        ("31.2 cm^2", "m^2", 0.00312),
        ("0.4 dm^3", "m^3", 0.0004),
        ("0.4 l", "m^3", 0.0004),
        ("400 cm^3", "m^3", 0.0004),
    ],
)
def test_a_scaled_decimal_is_the_nearest_float_and_not_its_neighbour(text, unit, value):
    assert parse_quantity(text, unit) == value


@pytest.mark.parametrize(
    ("text", "unit", "rule"),
    [
        ("1400", "Pa", "no unit"),
        ("MPa", "Pa", "not a number"),
        ("", "Pa", "not a number"),
        ("1400 mm", "Pa", "wrong dimension"),
        ("1400 MegaFoo", "Pa", "unknown unit"),
        ("1,400 MPa", "Pa", "unreadable unit"),
        ("1_400 MPa", "Pa", "unit"),
        ("5-8 ms", "s", "unit"),
        ("5 8 ms", "s", "unit"),
        ("nan Pa", "Pa", "finite"),
        ("inf Pa", "Pa", "finite"),
        ("-inf Pa", "Pa", "finite"),
        ("1e999 Pa", "Pa", "finite"),
        ("1 m/0", "m", "unreadable unit"),
        ("5 mm at 3 Pa", "m", "unreadable unit"),
        ("1 //s", "1/s", "unreadable unit"),
        ("1 m; import os", "m", "unreadable unit"),
        ("1 __import__('os')", "m", "unreadable unit"),
        ("1 " + "m*" * 5000 + "m", "m", "unreadable unit"),
    ],
)
def test_what_is_no_quantity_is_refused_with_the_rule(text, unit, rule):
    with pytest.raises(UnitError) as caught:
        parse_quantity(text, unit)
    assert rule in caught.value.rule
    assert unit in caught.value.remedy


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("10 l/min at 0 MPa", "is rated at no pressure drop"),
        ("10 l/min at -5 bar", "is rated at no pressure drop"),
        ("10 mm at 5 bar", "wrong dimension"),
        ("10 l/min at 5 s", "wrong dimension"),
        ("10 l/min at", "wrong dimension"),
        ("10 l/min at 5 bar at 3 bar", "unreadable unit"),
    ],
)
def test_a_rated_flow_that_is_none_is_refused(text, rule):
    with pytest.raises(UnitError, match=rule):
        parse_quantity(text, "m^3/(s Pa^0.5)")


def test_degrees_fahrenheit_have_their_offset_too():
    assert parse_quantity("-40 degF", "K") == pytest.approx(233.15, rel=1e-13)
    assert parse_quantity("9 delta_degF", "K") == pytest.approx(5, rel=1e-13)


@pytest.mark.parametrize("text", ["24.5 ton", "2 tons", "1 kN/ton"])
def test_a_ton_that_may_be_short_or_long_is_refused(text):
    with pytest.raises(UnitError, match="907 or 1016 kg elsewhere; write t, or short_ton"):
        parse_quantity(text, "kg")


@pytest.mark.parametrize("text", ["42 Hz", "42 1/s", "42 kHz", "42 s^-1"])
def test_a_frequency_that_may_count_cycles_is_refused_where_radians_are_meant(text):
    with pytest.raises(UnitError, match=r"radians or cycles.*rad/s"):
        parse_quantity(text, "rad/s")


@pytest.mark.parametrize(
    "text", ["1e308 MPa", "1e-99999999999999999999 Pa", "0e99999999999999999999 Pa"]
)
def test_a_number_at_the_end_of_its_range_gives_a_finite_value_or_a_refusal(text):
    with contextlib.suppress(UnitError):
        assert parse_quantity(text, "Pa") == 0.0


TOWERS = [
    "m**9**9**9",
    "m^9^9^9",
    "m ** 9 ** 9 ** 9",
    "m^-9^9^9",
    "m^999999999",
    "m^(9)^(9)^(9)",
    "m^(9^(9^9))",
    "m*(9^(9^9))",
    "m**(9)**(9)**(9)**9",
]


def test_towers_of_powers_are_refused_at_once_and_never_evaluated():
    program = (
        "import sys; from mptune.units import UnitError, parse_quantity\n"
        "for unit in sys.argv[1:]:\n"
        "    try: parse_quantity(f'1 {unit}', 'm')\n"
        "    except UnitError: print(unit, flush=True)"
    )
    # In a process of its own: an evaluated tower holds the interpreter for hours.
    with subprocess.Popen(
        [sys.executable, "-c", program, *TOWERS], stdout=subprocess.PIPE, text=True
    ) as process:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=10)
        process.kill()
        refused = process.stdout.read().splitlines()
    assert refused == TOWERS
