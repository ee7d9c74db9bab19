"""The base of every section of a study: fields with unit, symbol and meaning, checked on reading.

A dimensional value is a string with its unit in the study file and an SI float in the object. A
``Range`` is an ordered pair. Every refusal names the value, the rule and the remedy.
"""

from __future__ import annotations

import math
from types import UnionType
from typing import TYPE_CHECKING, Any, NoReturn, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, field_validator
from pydantic_core import PydanticCustomError

from mptune.units import UnitError, parse_quantity

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pydantic import ValidationInfo
    from pydantic.fields import FieldInfo

Range = tuple[float, float]
"""Smallest and largest value, both included."""

_REQUIRED: Any = ...


def quantity(
    unit: str,
    symbol: str,
    meaning: str,
    default: Any = _REQUIRED,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    words: tuple[str, ...] = (),
) -> Any:
    """Declare a field: SI unit ("1" for a plain number), symbol, meaning and allowed values.

    The bounds hold for each value of a pair or list, in SI. ``words`` are allowed in the place of
    a quantity.
    """
    extra: dict[str, Any] = {
        "unit": unit,
        "symbol": symbol,
        "above": above,
        "at_least": at_least,
        "at_most": at_most,
        "words": words,
    }
    return Field(default, description=meaning, json_schema_extra=extra)


class Section(BaseModel):
    """A frozen part of a study; unknown keys are errors.

    With the validation context ``{"si": True}`` dimensional values are plain SI numbers, as in
    gains files.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _to_si(cls, value: Any, info: ValidationInfo) -> Any:
        field = cls.model_fields[info.field_name or ""]
        extra = field.json_schema_extra
        if not isinstance(extra, dict) or "unit" not in extra or value is None:
            return value
        if info.context and info.context.get("si"):
            extra = {**extra, "si": True}
        if _is_range(field):
            return _checked_range(_convert(value, extra))
        if _is_list(field):
            _check_list(value)
        elif isinstance(value, list):
            refuse("is a list where one number is needed", "give one value")
        return _convert(value, extra)

    @classmethod
    def is_range(cls, name: str) -> bool:
        """Return whether a field is a smallest and a largest value."""
        return _is_range(cls.model_fields[name])

    @classmethod
    def bounds_of(cls, name: str) -> Range:
        """Return the least and the largest value that a quantity may have, in SI."""
        extra: Any = cls.model_fields[name].json_schema_extra
        least = extra["at_least"] if extra["at_least"] is not None else extra["above"]
        low, high = -math.inf if least is None else least, extra["at_most"]
        return low, math.inf if high is None else high

    @classmethod
    def quantities(cls) -> Iterator[tuple[str, str, str, str]]:
        """Yield name, unit, symbol and meaning of each declared quantity."""
        for name, field in cls.model_fields.items():
            extra = field.json_schema_extra
            if isinstance(extra, dict) and "unit" in extra:
                yield name, str(extra["unit"]), str(extra["symbol"]), field.description or ""


def refuse(rule: str, remedy: str) -> NoReturn:
    """Refuse the value under validation with a rule and a remedy."""
    message = f"{rule}; {remedy}"
    raise PydanticCustomError(
        "refused", "{message}", {"message": message, "rule": rule, "remedy": remedy}
    )


def _is_range(field: FieldInfo) -> bool:
    return Range in _kinds(field)


def _is_list(field: FieldInfo) -> bool:
    return any(get_origin(kind) is tuple and Ellipsis in get_args(kind) for kind in _kinds(field))


def _kinds(field: FieldInfo) -> tuple[Any, ...]:
    """Return the types that a field allows: the members of a union, or its only one."""
    kind = field.annotation
    return get_args(kind) if get_origin(kind) in {Union, UnionType} else (kind,)


def _convert(value: Any, extra: dict[str, Any]) -> Any:
    if isinstance(value, list | tuple):
        return [_convert(item, extra) for item in value]
    unit = str(extra["unit"])
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        refuse("is no number with a unit", f'give a number and a unit, like "1 {unit}"')
    if isinstance(value, float) and not math.isfinite(value):
        refuse("is not a finite number", "give a finite value")
    if unit == "1" or extra.get("si"):
        if isinstance(value, str):
            refuse("is a text where a plain number is needed", "write the number without quotes")
        number = value
    elif isinstance(value, str):
        if value in extra["words"]:
            return value
        try:
            number = parse_quantity(value, unit)
        except UnitError as error:
            refuse(error.rule, error.remedy)
    else:
        refuse("has no unit", f'write it as a string with its unit, like "{value} {unit}"')
    _check_bounds(number, extra, "" if unit == "1" else f" {unit}")
    return number


def _check_bounds(number: float, extra: dict[str, Any], unit: str) -> None:
    above, at_least, at_most = extra["above"], extra["at_least"], extra["at_most"]
    if above is not None and not number > above:
        refuse(f"must be greater than {above:g}{unit}", "give a larger value")
    if at_least is not None and number < at_least:
        refuse(f"must be at least {at_least:g}{unit}", "give a larger value")
    if at_most is not None and number > at_most:
        refuse(f"must be at most {at_most:g}{unit}", "give a smaller value")


def _check_list(value: Any) -> None:
    if not isinstance(value, list | tuple):
        refuse("is a single value where a list is needed", 'give a list, like ["VALUE"]')
    if not value:
        refuse("is an empty list", "give at least one value")


def _checked_range(value: Any) -> Any:
    if isinstance(value, str):
        return value
    if not isinstance(value, list):
        refuse("is a single value where a range is needed", 'give a pair, like ["LOW", "HIGH"]')
    if not value:
        refuse("is an empty range", 'give a pair, like ["LOW", "HIGH"]')
    if len(value) != 2:
        refuse(f"has {len(value)} values", "a range is a pair: smallest and largest value")
    low, high = value
    if isinstance(low, int | float) and isinstance(high, int | float) and low > high:
        refuse("is a reversed range", "write the smaller value first")
    return value
