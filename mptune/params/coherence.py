"""A study checked as a whole: values that are right one by one, and do not fit one another.

Refused is only what cannot be simulated. All else that hardly can be meant is a ``Doubt``, which
the loaded study carries; a study may differ on purpose, as Fig. 5's delays do from §5.1's sum.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.errors import Fault
from mptune.params.advice import advice_on
from mptune.params.chambers import LETTERS, NUMBERS
from mptune.params.demand import flow_demand, force_demand, slowest_valves
from mptune.params.doubts import Doubt
from mptune.params.packed import SUBSTEPS
from mptune.params.valve_states import number_of_states
from mptune.units import shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy, Study

_SAME = 1e-9  # relative: nearer values are the same
_MOST_VALVES = 1000  # of a side
_MOST_COUNTED = 10_000  # states of a side, after which they are many
_FEWER = "take fewer valves"
# Runge-Kutta's method then damps an undamped swing by 2 % at each step; below 2.2 it excites it, as
# do the longer steps of calm ticks, until the pressure that they move ends them.
_STEPS_OF_A_SWING = 5
_DELAYS = ("delay", "delay_as_it_runs")


def refusals_of(study: Study, written: frozenset[str]) -> list[Fault]:
    """Return what of a study cannot be simulated, each fault with both keys and numbers.

    Parameters
    ----------
    study
        The study, its ``[verification]`` filled up.
    written
        The keys of ``[verification]`` that a file or the command line has written; the others
        stand for those that they are taken from.
    """
    return [
        *_slow_valves(study, written),
        *_heavy_loads(study, written),
        *_combinations(study),
        *_short_hoses(study),
    ]


def doubts_of(resolved: ResolvedStudy) -> tuple[Doubt, ...]:
    """Return what of a study may be meant otherwise, see ``Doubt``."""
    study = resolved.study
    return (
        *_delays(resolved),
        *_inertia(resolved),
        *_tried_elsewhere(resolved),
        *slowest_valves(study),
        *force_demand(study),
        *flow_demand(study),
        *advice_on(study),
    )


def _slow_valves(study: Study, written: frozenset[str]) -> Iterator[Fault]:
    if study.controller.force_model == "steady-state":
        return  # it looks at no instant within T_S, and may wait for slow valves
    period = study.controller.sampling_period
    for number, (_, longest) in enumerate(study.verification.delay_ranges()):
        if longest < period:
            continue
        own = "valve_delays" in written
        key = f"verification.valve_delays[{number + 1}]" if own else "valves.delay"
        yield Fault(
            key,
            shown(longest, "s"),
            f"is not below controller.sampling_period = {shown(period, 's')}, which Table 2 asks "
            "to be longer than the valve delay",
            "lengthen the sampling period or take faster valves",
        )


def _heavy_loads(study: Study, written: frozenset[str]) -> Iterator[Fault]:
    """Refuse loads beyond the force reference's limits: nothing could hold the piston."""
    controller = study.controller
    low, high = controller.pressure_min, controller.pressure_max
    least = study.area_a * low - study.area_b * high
    largest = study.area_a * high - study.area_b * low
    for number, force in enumerate(study.verification.load_forces):
        worst = max(study.loads_at(force), key=lambda load: max(load - largest, least - load))
        if least <= worst <= largest:
            continue
        own = "load_forces" in written
        yield Fault(
            f"verification.load_forces[{number + 1}]" if own else "load.force",
            shown(force, "N"),
            f"makes a load of {shown(worst, 'N')}, beyond the {shown(least, 'N')} to "
            f"{shown(largest, 'N')} that controller.pressure_min = {shown(low, 'Pa')} and "
            f"controller.pressure_max = {shown(high, 'Pa')} give",
            "take a larger piston, higher pressures or less load",
        )


def _combinations(study: Study) -> Iterator[Fault]:
    """Refuse more combinations of all chambers' states than a decision is to look at."""
    rule, most = study.edge_rule, study.controller.max_combinations
    chambers = len(study.all_chambers)
    if rule.valves > _MOST_VALVES:
        yield Fault(
            "edges", f"{rule.valves} valves of a chamber", f"are more than {_MOST_VALVES}", _FEWER
        )
        return
    states = number_of_states(rule, _MOST_COUNTED)  # every choice among n valves makes 2ⁿ
    of_each = f"states of each of {chambers} chambers and"
    if states > _MOST_COUNTED:
        made = f"make over {_MOST_COUNTED} {of_each} {_MOST_COUNTED**chambers} combinations"
    else:
        made = f"make {states} {of_each} {states**chambers} combinations"
    if states**chambers > most:
        yield Fault(
            "edges",
            f"{rule.valves} valves of a chamber",
            f"{made}, more than controller.max_combinations = {most}",
            f"{_FEWER} or kinds of states, or raise it",
        )


def _short_hoses(study: Study) -> Iterator[Fault]:
    """Refuse hoses as lines whose oil swings faster than the simulator's steps can follow.

    The swing of its volume at the valves' end against its oil takes 2π l √(ρ/B), at the stiffest
    oil. One of four chambers may have no hose.
    """
    drawn = study.campaign.lines is not None and study.campaign.lines[1] > 0
    if not (study.hose.dynamics or drawn):
        return
    asked = "campaign.lines" if drawn else "hose.dynamics"
    hose, chambers = study.hose, study.all_chambers
    moduli = (*study.verification.oil_bulk_moduli, *study.oil.bulk_modulus,
              *(study.campaign.oil_bulk_modulus or ()))  # fmt: skip
    stiff = 1 / (1 / max(moduli) + 1 / hose.bulk_modulus)  # Eq. 4 of a volume that is all hose
    step = study.controller.fast_sampling_period / SUBSTEPS
    least = _STEPS_OF_A_SWING * step / (2 * math.pi) * math.sqrt(stiff / hose.oil_density)
    for number, one in enumerate(chambers):
        length = one.hose_length
        if length >= least or (length == 0 and len(chambers) > NUMBERS[0]):
            continue
        key = f"chambers[{number + 1}].hose_length"
        yield Fault(
            key if study.chambers else f"hose.length_{LETTERS[number].lower()}",
            shown(length, "m"),
            f"is too short for a line of {asked}: below {shown(least, 'm')} its oil swings within "
            f"{_STEPS_OF_A_SWING} steps of the simulation",
            "leave that out, and hoses are a part of their chambers",
        )


def _delays(resolved: ResolvedStudy) -> Iterator[Doubt]:
    study, box = resolved.study, resolved.uncertainty
    given = [box.lumped_delay, box.explicit_delay]
    if given[0] == given[1]:
        del given[1]
    parts = {
        "controller.sampling_period": shown(study.controller.sampling_period, "s"),
        "valves.delay": shown(study.valves.delay, "s", ranged=True),
        "valves.computation_delay": shown(study.valves.computation_delay, "s", ranged=True),
    }
    for name, pair in zip(_DELAYS, given, strict=False):
        if _same(pair, study.summed_delay):
            continue
        yield Doubt(
            (resolved.key_of(name), *parts),
            (shown(pair, "s", ranged=True), *parts.values()),
            "the sum of T_S/2, valve and computation is "
            f"{shown(study.summed_delay, 's', ranged=True)}",
            f'write {name} = "derived", or leave it where more is counted in it',
        )


def _inertia(resolved: ResolvedStudy) -> Iterator[Doubt]:
    """Hold the machine's inertia, the table's factor included, against the family's."""
    factors = resolved.study.inertia_factors()
    masses, box = resolved.study.verification.masses, resolved.uncertainty.mass
    machine = (min(masses) * min(factors), max(masses) * max(factors))
    if not resolved.study.load.table or _inside(machine, box):
        return
    yield Doubt(
        ("load.table", resolved.key_of("mass")),
        (f"inertia × {min(factors):.3g}–{max(factors):.3g}", shown(box, "kg", ranged=True)),
        f"the machine has {shown(machine, 'kg', ranged=True)} where its moves take it, of which "
        "the family of plants holds a part only",
        "widen the range of mass, or let the table's factors be about 1",
    )


def _tried_elsewhere(resolved: ResolvedStudy) -> Iterator[Doubt]:
    """Hold the machines of ``[verification]`` against the ranges that the gains are made for."""
    study, asked = resolved.study, resolved.study.verification
    delays = asked.delay_ranges()
    tried: tuple[tuple[str, Range, str, Range, str], ...] = (
        ("masses", _ends(asked.masses), resolved.key_of("mass"), resolved.uncertainty.mass, "kg"),
        (
            "valve_delays",
            (min(low for low, _ in delays), max(high for _, high in delays)),
            "valves.delay",
            study.valves.delay,
            "s",
        ),
        ("oil_bulk_moduli", _ends(asked.oil_bulk_moduli), "oil.bulk_modulus",
         study.oil.bulk_modulus, "Pa"),
        ("load_forces", _ends(asked.load_forces), "load.force",
         (study.load.force, study.load.force), "N"),
    )  # fmt: skip
    for name, found, key, wanted, unit in tried:
        if name == "load_forces" and found[0] <= wanted[0] <= found[1]:
            continue
        if _same(found, wanted):
            continue
        texts = [
            shown(pair[0], unit) if pair[0] == pair[1] else shown(pair, unit, ranged=True)
            for pair in (found, wanted)
        ]
        yield Doubt(
            (f"verification.{name}", key),
            (texts[0], texts[1]),
            "the gains are tried on other machines than they are made for",
            f"leave verification.{name} out, and it follows {key}",
        )


def _ends(values: tuple[float, ...]) -> Range:
    return min(values), max(values)


def _same(one: Range, other: Range) -> bool:
    return all(abs(a - b) <= _SAME * max(abs(a), abs(b)) for a, b in zip(one, other, strict=True))


def _inside(one: Range, other: Range) -> bool:
    return one[0] >= other[0] * (1 - _SAME) and one[1] <= other[1] * (1 + _SAME)
