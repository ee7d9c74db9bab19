"""Quantities as people write them, and the SI floats that everything inside uses.

MPa, ms and dm³ exist in study files and in print only. The registry is pint's; the number is
split off first and read as a plain decimal, so that nothing in a file is ever evaluated.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pint import UnitRegistry

_QUANTITY = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf|NaN|Infinity))"
    r"\s*(?P<unit>.*?)\s*"
)
# Unit names with at most one small power each: nothing that takes time to evaluate.
_UNIT = re.compile(
    r"(?:[A-Za-zµμ°%_]+(?:\s*(?:\^|\*\*)\s*-?\d(?:\.\d)?(?![\d.]))?|1(?=\s*/)|[()*/·\s])+"
)
_LONGEST_UNIT = 40
_MANY = 1e6  # units, beside which an offset does not cancel what tells them apart
_TON = re.compile(r"\btons?\b")
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PLAIN = str.maketrans("⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹", "-+0123456789")
_FLOW_COEFFICIENT = "m^3/(s Pa^0.5)"
_RAISED = re.compile(r"[⁻⁺]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
_TENS = re.compile(r"(?<=\d)\s*[·×]\s*10\^(?=[-+]?\d)")


class UnitError(ValueError):
    """A text that is no quantity of the wanted dimension; the message is a rule, then a remedy."""

    def __init__(self, rule: str, remedy: str) -> None:
        super().__init__(f"{rule}; {remedy}")
        self.rule = rule
        self.remedy = remedy


@cache
def registry() -> UnitRegistry[Any]:
    """Return the one unit registry."""
    import pint

    return pint.UnitRegistry(cache_folder=None)


def parse_quantity(text: str, unit: str) -> float:
    """Return a quantity such as ``"1400 MPa"`` in the SI unit ``unit``.

    Parameters
    ----------
    text
        A decimal number and a unit. A flow coefficient may be a rated flow as well, as data sheets
        state it: ``"10 l/min at 0.5 MPa"``.
    unit
        The SI unit wanted, e.g. ``"Pa"`` or ``"rad/s"``.

    Raises
    ------
    UnitError
        If the text is no quantity, has another dimension, or is not finite.
    """
    flow, at, drop = text.replace("@", " at ").partition(" at ")
    if at and unit == _FLOW_COEFFICIENT:
        return _rated_flow(flow, drop)
    match = _QUANTITY.fullmatch(_typed(text))
    if match is None:
        raise UnitError(
            "is not a number with a unit", f'write a number and a unit, like "1 {unit}"'
        )
    value = float(match["number"])
    written = re.sub(r"^/", "1/", match["unit"])  # a rate, as in "46.96/s"
    factor, offset = _conversion(written, unit)  # zero of a wrong unit is still wrong
    if math.isfinite(value) and value != 0:
        # Multiplied as decimals, so that "12.2 ms" is the float 0.0122 and not its neighbour.
        value = float(Decimal(match["number"]) * factor + offset)
    elif value == 0:
        value = float(offset)
    if not math.isfinite(value):
        raise UnitError("is not a finite number", f"give a finite value in {unit}")
    return value


def _rated_flow(flow: str, drop: str) -> float:
    """Return K_v = Q/√Δp of a rated flow and the pressure drop that it was measured at."""
    rated, pressure = parse_quantity(flow, "m^3/s"), parse_quantity(drop, "Pa")
    if pressure <= 0:
        raise UnitError("is rated at no pressure drop", 'write it like "10 l/min at 0.5 MPa"')
    return rated / math.sqrt(pressure)  # Eq. 2, above the transition pressure


def is_unit(text: str) -> bool:
    """Return whether a text is a unit of anything."""
    written = _typed(text)
    if len(written) > _LONGEST_UNIT or _UNIT.fullmatch(written) is None:
        return False
    try:
        registry().parse_units(written)
    except Exception:  # noqa: BLE001 - pint's parser raises whatever its tokenizer met
        return False
    return True


def _typed(text: str) -> str:
    """Return a text as it would be typed: what is printed with raised digits and true signs."""
    plain = text.replace("−", "-").replace("⋅", "·")
    plain = _RAISED.sub(lambda power: f"^{power[0].translate(_PLAIN)}", plain)
    return _TENS.sub("e", plain)


@cache
def _conversion(written: str, unit: str) -> tuple[Decimal, Decimal]:
    """Return the SI value of one ``written`` unit, to the 15 digits that pint keeps, and of none.

    The value of 0 is not 0 for temperatures alone. A difference of temperatures is written in
    delta_degC or delta_degF.
    """
    import pint

    if not written:
        raise UnitError("has no unit", f'write the unit behind the number, like "1 {unit}"')
    if len(written) > _LONGEST_UNIT or _UNIT.fullmatch(written) is None:
        raise UnitError(f"has an unreadable unit {written!r}", f"write a unit of {unit}")
    if _TON.search(written):
        rule = f"is in {written}, and a ton is 1000 kg here, 907 or 1016 kg elsewhere"
        raise UnitError(rule, "write t, or short_ton or long_ton")
    try:
        units = registry().parse_units(written)
        zero, one, many = (
            registry().Quantity(size, units).to(unit).magnitude for size in (0.0, 1.0, _MANY)
        )
    except pint.UndefinedUnitError as error:
        raise UnitError(f"has an unknown unit {written!r}", f"write a unit of {unit}") from error
    except pint.DimensionalityError as error:
        raise UnitError(
            f"has the wrong dimension ({written})", f"this value is measured in {unit}"
        ) from error
    except Exception as error:  # pint's parser raises whatever its tokenizer met
        raise UnitError(f"has an unreadable unit {written!r}", f"write a unit of {unit}") from error
    _refuse_cycles_for_radians(written, unit)
    if zero == 0:
        return Decimal(f"{one:.15g}"), Decimal(0)
    return Decimal(f"{(many - zero) / _MANY:.15g}"), Decimal(f"{zero:.15g}")


def _refuse_cycles_for_radians(written: str, unit: str) -> None:
    """Refuse Hz where rad/s is meant: the radian has no dimension, so pint would pass it as 1."""
    if unit == "rad/s" and not re.search(r"rad|deg|°|rpm|turn|rev|cycle", written):
        raise UnitError(
            f"is in {written}, which does not say whether radians or cycles are counted",
            'write it in rad/s (1 Hz is 6.2832 rad/s), like "42 rad/s"',
        )


DISPLAY = {
    "m": (1e3, "mm"),
    "m^2": (1e4, "cm²"),
    "m^3": (1e3, "dm³"),
    "Pa": (1e-6, "MPa"),
    "s": (1e3, "ms"),
    "N": (1e-3, "kN"),
    "m/s": (1e3, "mm/s"),
    "m^3/s": (6e4, "l/min"),
    "N s/m": (1e-3, "kN s/m"),
}
"""Factor and name of the units in print; what is not here is printed in SI."""


def number(value: float, digits: int = 4) -> str:
    """Return a number for print; a dash where there is none."""
    if math.isnan(value):
        return "—"
    if math.isinf(value):
        return "∞"
    if value == 0 or 1e-3 <= abs(value) < 1e6:
        whole = len(str(int(abs(value))))
        text = f"{value:.{max(digits, whole)}g}"
        if abs(float(text)) < 1e6:  # to which a little less may be rounded
            return text
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    mantissa = mantissa.rstrip("0").rstrip(".")
    return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPTS)}"


_DECIMAL = re.compile(r"(?<![\w.])[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?(?![\w.])")
_ALL_DIGITS = 17  # tell any two floats apart


def exact(value: float) -> str:
    """Return the shortest decimal that reads back as this value: a limit, as it was written."""
    return repr(value).removesuffix(".0")


def number_beside(value: float, limits: str, digits: int = 4) -> str:
    """Return a number for print, with as many digits as it needs to differ from its limits.

    Parameters
    ----------
    value
        The number.
    limits
        The limits as they are printed beside it, such as ``"≤ 0.48"`` or ``"2 … 5 1/s"``.
    digits
        Significant digits where they suffice.
    """
    others = [float(text) for text in _DECIMAL.findall(limits)]
    for more in range(digits, _ALL_DIGITS):
        text = number(value, more)
        if all(one == value or text != number(one, more) for one in others):
            return text
    return exact(value)


def shown(value: Any, unit: str, *, ranged: bool = False) -> str:
    """Return a quantity in SI in the unit that people read it in.

    A tuple is a list, or with ``ranged`` a smallest and a largest value; a text stays as it is.
    """
    if isinstance(value, str):
        return value
    factor, name = DISPLAY.get(unit, (1.0, "" if unit == "1" else unit))
    name = re.sub(r"\^(-?\d)(?![.\d])", lambda power: power[1].translate(_SUPERSCRIPTS), name)
    values = value if isinstance(value, tuple) else (value,)
    texts = [
        "–".join(number(factor * end) for end in one)
        if isinstance(one, tuple)
        else number(factor * one)
        for one in values
    ]
    text = ("–" if ranged else ", ").join(texts)
    return f"{text} {name}".rstrip()
