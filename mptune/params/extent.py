"""How much work a study asks for, told before any of it begins.

Each value may lie within its range and the study as a whole still ask for more than fits: a rest of
an hour at a tick of a microsecond, say. What would not fit is refused with its size, and with what
to change. The limits are those of one machine, and far above what machines of this kind need.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mptune.errors import Fault

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.study import ResolvedStudy
    from mptune.params.uncertainty import UncertaintySet

_MEMORY: Final = 1e9  # bytes, of one array or of those that are held together
_MOST_TICKS: Final = 2e9  # of all machines together: an hour or so
_MOST_STEPS: Final = 1e6  # of one response of the continuous loop
_MOST_PLANTS: Final = 200_000
_MOST_FITS: Final = 2_000_000  # of Fig. 3
_MOST_HELD: Final = 400  # sampling periods in a delay: the order of the sampled loop
_MOST_FAST: Final = 20_000  # fast ticks in a sampling period or a delay
_COLUMNS: Final = 24  # numbers that a simulated tick leaves behind, on both machines together
_LONGEST_STEP: Final = 5e-4  # s, of a response


def faults_of_extent(resolved: ResolvedStudy) -> Iterator[Fault]:
    """Yield a fault for each part of a study that asks for more than fits, or for nothing."""
    yield from _moves_and_ticks(resolved)
    yield from _delays(resolved)
    yield from _family(resolved.uncertainty)
    asked = resolved.study.identification
    operating = (asked.positions, asked.velocities, asked.pressures, asked.oil_bulk_moduli)
    fits = asked.frequencies * math.prod(len(one) for one in (*operating, asked.valve_delays))
    if fits > _MOST_FITS:
        rule = f"asks for {fits:.2g} fits, {_MOST_FITS:.0e} at most"
        yield Fault("identification", "", rule, "give fewer operating points or frequencies")


def _moves_and_ticks(resolved: ResolvedStudy) -> Iterator[Fault]:
    study = resolved.study
    tick, asked = study.controller.fast_sampling_period, study.verification
    longest, place = 0.0, ""
    for number, move in enumerate(study.manoeuvre, 1):
        if move.duration < tick:
            rule = f"is shorter than a tick of {tick:g} s: nothing would be simulated"
            key = f"manoeuvre[{number}].duration"
            yield Fault(key, f"{move.duration:g} s", rule, "give a longer move")
        if move.kind == "file" and move.stands:
            rule = "moves nowhere, from its first sample to its last"
            yield Fault(f"manoeuvre[{number}].file", "", rule, "record a move")
        for name in ("duration", "rest"):
            if getattr(move, name) > longest:
                longest, place = getattr(move, name), f"manoeuvre[{number}].{name}"
    ticks = sum(move.duration + move.rest for move in study.manoeuvre) / tick
    machines = len(asked.masses) * len(asked.valve_delays) * len(asked.oil_bulk_moduli)
    cases = machines * len(asked.load_forces) * len(asked.seeds)
    size = 8 * _COLUMNS * ticks * cases
    if size > _MEMORY:
        rule = f"makes {ticks:.2g} ticks of {tick:g} s, {size / 1e9:.3g} GB for {cases} machines"
        yield Fault(place, f"{longest:g} s", rule, "shorten it, or verify on fewer machines")
    elif ticks * cases * asked.repeats > _MOST_TICKS:
        rule = f"makes {ticks * cases * asked.repeats:.2g} ticks, {_MOST_TICKS:.0e} at most"
        yield Fault("verification.repeats", str(asked.repeats), rule, "repeat less often")
    beside = ticks * len(asked.masses) * study.systems.repeats
    if beside > _MOST_TICKS:
        rule = f"makes {beside:.2g} ticks for each system, {_MOST_TICKS:.0e} at most"
        yield Fault("systems.repeats", str(study.systems.repeats), rule, "repeat less often")


def _delays(resolved: ResolvedStudy) -> Iterator[Fault]:
    controller, box = resolved.study.controller, resolved.uncertainty
    delays = (*box.lumped_delay, *box.explicit_delay)
    least, largest = min(delays), max(delays)
    least = min(least, box.nominal_delay)
    largest = max(largest, box.nominal_delay)
    period, tick = controller.sampling_period, controller.fast_sampling_period
    longest = max(move.duration + move.rest for move in resolved.study.manoeuvre)
    steps = longest / min(least, _LONGEST_STEP, max(tick, 1e-6))
    if steps > _MOST_STEPS:
        rule = f"makes {steps:.2g} steps of a move of {longest:g} s, {_MOST_STEPS:.0e} at most"
        yield Fault("uncertainty.delay", f"{least:g} s", rule, "lengthen it, or shorten the moves")
    if largest / period > _MOST_HELD:
        rule = f"is {largest / period:.3g} sampling periods, {_MOST_HELD} at most"
        remedy = "shorten it, or lengthen controller.sampling_period"
        yield Fault("uncertainty.delay", f"{largest:g} s", rule, remedy)
    if max(period, largest) / tick > _MOST_FAST:
        rule = f"makes {max(period, largest) / tick:.2g} ticks in a sampling period or a delay"
        key = "controller.fast_sampling_period"
        yield Fault(key, f"{tick:g} s", rule, f"lengthen it: {_MOST_FAST} at most")


def _family(box: UncertaintySet) -> Iterator[Fault]:
    pairs = (box.mass, box.delay, box.tau_a, box.tau_b)
    varying = sum(isinstance(pair, str) or pair[0] < pair[1] for pair in pairs)
    plants = box.points**varying
    if plants > _MOST_PLANTS:
        rule = f"makes a family of {plants:.2g} plants, {_MOST_PLANTS:.0e} at most"
        yield Fault("uncertainty.points", str(box.points), rule, "give fewer points")
