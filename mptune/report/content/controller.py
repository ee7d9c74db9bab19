"""The controller as it is exported: continuous gains, discrete coefficients, filters."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.params.pack import pack_gains
from mptune.params.valve_states import valve_states
from mptune.report.blocks import (
    Chapter,
    Heading,
    Note,
    Prose,
    Row,
    Tabular,
    equations,
    left,
    right,
    symbol,
    wide,
)
from mptune.signals.tustin import discretise
from mptune.units import shown

if TYPE_CHECKING:
    from mptune.params.controller import Controller
    from mptune.params.study import Study
    from mptune.report.results import Results

_COEFFICIENTS = {
    "b0": ("b_0", "1/s", "direct share"),
    "b1": ("b_1", "1/s", "numerator"),
    "b2": ("b_2", "1/s", "numerator"),
    "a1": ("a_1", "1", "denominator"),
    "a2": ("a_2", "1", "denominator"),
    "integral": ("c", "1/s", "of the trapezoidal integrator"),
}


def controller(results: Results) -> Chapter:
    """Return the controller, continuous and as the target runs it."""
    settings = results.study.study.controller
    law = discretise(pack_gains(results.sweep.gains), settings.sampling_period)
    sets = results.sweep.gains, results.feedforward
    gains: list[Row] = [
        [symbol(mark), f"{getattr(found, key):.9g}", unit.replace("^2", "²"), meaning]
        for found in sets
        for key, unit, mark, meaning in found.quantities()
    ]
    discrete: list[Row] = [
        [symbol(mark), f"{getattr(law, key):.12g}", unit, meaning]
        for key, (mark, unit, meaning) in _COEFFICIENTS.items()
    ]
    columns = [*left("Symbol"), *right("Value"), *left("Unit"), wide("Meaning")]
    period = shown(settings.sampling_period, "s")
    return Chapter.of(
        "The controller",
        Prose("Velocity controller, position controller, and what reaches the force controller:"),
        equations("eq18 eq22", "fref"),
        _search_space(results.study.study),
        *Tabular("Continuous, SI", columns, gains).titled(),
        Heading(f"Discrete: Tustin's approximation at T_S = {period}"),
        equations("tustin"),
        Tabular("Discrete", columns, discrete),
        *_filters(results.sweep.study.study.filtering).titled(),
        Note(
            "Positions and pressures pass a median of three samples before their first-order "
            "filter; the velocity is Eq. 23 of the filtered position:"
        ),
        equations("eq23"),
        new_page=True,
    )


def _search_space(study: Study) -> Prose:
    states = len(valve_states(study.edge_rule))
    lines, valves = len(study.edge_rule.sizes), study.edge_rule.valves
    chambers = len(study.all_chambers)
    return Prose(
        f"The force controller chooses among {states} states of each of {chambers} chambers, made "
        f"by {valves} valves to {lines} lines: {states**chambers} combinations in each decision "
        "(Eq. 6)."
    )


def _filters(settings: Controller) -> Tabular:
    fast = settings.fast_sampling_period
    rows: list[Row] = [
        [name, shown(time, "s"), f"{math.exp(-fast / time):.9g}"]
        for name, time in (
            ("position", settings.position_filter),
            ("chamber pressures", settings.pressure_filter),
            ("supply pressures, converter pistons", settings.supply_filter),
        )
    ]
    columns = [wide("Signal"), *right("Time constant", "Pole")]
    return Tabular(f"Filters at {shown(fast, 's')}", columns, rows)
