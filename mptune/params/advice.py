"""Advice on what is too small or too slow for the moves: a doubt with the size that would do.

What ``mptune.params.sizing`` asks for is rounded up, or down, so that whoever follows the advice
hears it no more.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.params import sizing
from mptune.params.doubts import Doubt
from mptune.units import DISPLAY, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.study import Study

_DIGITS = 2  # of an advised size
_SAME = 1e-9  # relative: 4.3 ms as a sum is 4.3 ms as it is written
_DEAREST = 8  # pressure steps, of the largest W_conv
_LEAN = 0.8  # of the accumulator's least pressure: an advised precharge


def advice_on(study: Study) -> Iterator[Doubt]:
    """Yield what of a study its machine and its moves have outgrown."""
    if study.supplies.accumulator_volume > 0:
        yield from _accumulator(study)
        yield from _pump(study)
    if study.converters > 0:
        yield from _converters(study)
        yield from _converter_weight(study)
    yield from _filters(study)
    yield from _friction(study)


def advised(value: float, unit: str, *, up: bool) -> str:
    """Return a size in SI for print, on two digits and no smaller, or no larger, than it is."""
    factor = DISPLAY.get(unit, (1.0, unit))[0]
    digit = 10.0 ** (math.floor(math.log10(value * factor)) + 1 - _DIGITS)
    exact = value * factor / digit
    whole = math.ceil(exact * (1 - _SAME)) if up else math.floor(exact * (1 + _SAME))
    return shown(whole * digit / factor, unit)


def _exceeds(one: float, other: float) -> bool:
    return one > other * (1 + _SAME)


def _accumulator(study: Study) -> Iterator[Doubt]:
    supplies, most = study.supplies, sizing.most_taken(study)
    left = sizing.pressure_left(study, most.way)
    allowed = (1 - sizing.SWING) * supplies.pump_on
    empty = left <= supplies.accumulator_precharge
    if not (_exceeds(allowed, left) or empty):
        return
    precharge, keys, held = supplies.accumulator_precharge, ["supplies.accumulator_volume"], ""
    values = [shown(supplies.accumulator_volume, "m^3")]
    if not math.isfinite(sizing.least_accumulator(study, precharge)):
        keys.append("supplies.accumulator_precharge")
        values.append(shown(precharge, "Pa"))
        precharge = _LEAN * allowed
        held = f" with a precharge of {shown(precharge, 'Pa')}"
    volume = advised(sizing.least_accumulator(study, precharge), "m^3", up=True)
    falls = "runs empty at" if empty else "falls to"
    yield Doubt(
        (*keys, f"manoeuvre[{most.move + 1}]"),
        (*values, f"takes {shown(most.way, 'm^3')}"),
        f"it {falls} {shown(left, 'Pa')} within one way of that move while the pump is off",
        f"{volume}{held} would hold {shown(allowed, 'Pa')}, nine tenths of pump_on",
    )


def _pump(study: Study) -> Iterator[Doubt]:
    needed, pump = sizing.least_pump(study), study.supplies.pump_flow
    if _exceeds(needed, pump):
        yield Doubt(
            ("supplies.pump_flow", "manoeuvre"),
            (shown(pump, "m^3/s"), f"{len(study.manoeuvre)} moves"),
            f"a move and its rest take about {shown(needed, 'm^3/s')}",
            f"take a pump of {advised(needed, 'm^3/s', up=True)}, or rest longer after the moves",
        )


def _converters(study: Study) -> Iterator[Doubt]:
    supplies, needed = study.supplies, sizing.least_converter(study)
    if _exceeds(needed, supplies.converter_area * supplies.converter_travel):
        area = needed / supplies.converter_travel
        yield Doubt(
            ("supplies.converter_area", "supplies.converter_travel"),
            (shown(supplies.converter_area, "m^2"), shown(supplies.converter_travel, "m")),
            f"the moves sweep {shown(sizing.swept_volume(study), 'm^3')} of the larger chamber; "
            f"each converter is to take {shown(needed, 'm^3')} from its centre to an end",
            f"take {advised(area, 'm^2', up=True)} at that travel, or shorten the moves",
        )


def _converter_weight(study: Study) -> Iterator[Doubt]:
    weight, (least, most) = study.controller.weight_converter, sizing.converter_weights(study)
    small = _exceeds(least, weight)
    if not (small or _exceeds(weight, most)):
        return
    fault = "does not keep the converters from their ends" if small else "outweighs the force"
    better = advised(least, "N s/m^6", up=True) if small else advised(most, "N s/m^6", up=False)
    yield Doubt(
        ("controller.weight_converter", "supplies.converter_travel"),
        (shown(weight, "N s/m^6"), shown(study.supplies.converter_travel, "m")),
        f"it {fault}: with one valve open a converter at its end costs "
        f"{weight / most * _DEAREST:.2g} pressure steps on the piston",
        f"{better} makes them {0.5 if small else _DEAREST:g}; or let `mptune weights` find it",
    )


def _filters(study: Study) -> Iterator[Doubt]:
    reasons = {
        "position_filter": "lags more than half of T_S, valve and computation together",
        "pressure_filter": "has not heard a pressure by the next decision",
        "supply_filter": "lags behind supplies that sink within a move",
    }
    for name, longest in sizing.longest_filters(study).items():
        given = getattr(study.controller, name)
        if _exceeds(given, longest):
            yield Doubt(
                (f"controller.{name}", "controller.sampling_period"),
                (shown(given, "s"), shown(study.controller.sampling_period, "s")),
                f"it {reasons[name]}",
                f"{advised(longest, 's', up=False)} would do",
            )


def _friction(study: Study) -> Iterator[Doubt]:
    given, most = study.load.friction_static, sizing.most_friction(study)
    if _exceeds(given, most):
        usual = advised(most * sizing.USUAL_FRICTION / sizing.FRICTION_SHARE, "N", up=False)
        yield Doubt(
            ("load.friction_static", "cylinder.bore"),
            (shown(given, "N"), shown(study.cylinder.bore, "m")),
            f"it is {given / most * sizing.FRICTION_SHARE:.2g} of the piston's largest force, of "
            "which seals take 0.01 to 0.02",
            f"seals of that piston have about {usual}, and half of it as Coulomb friction",
        )
