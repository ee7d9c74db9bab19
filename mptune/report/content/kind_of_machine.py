"""What a report says of a machine that hangs on what it is made of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.params.valve_states import StateKind, states_by_kind

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy

_PAPERS = (StateKind.ALL, StateKind.SINGLE, StateKind.CROSSFLOW)
_KINDS = {
    StateKind.ALL: "all valves of a line",
    StateKind.SINGLE: "one valve of a line",
    StateKind.SUBSETS: "some valves of a line",
    StateKind.CROSSFLOW: "crossflow",
}


def valve_state_words(study: ResolvedStudy) -> str:
    """Return what the dotted lines in a plot of valve states part; nothing where there are none."""
    rule = study.study.edge_rule
    if rule.states == _PAPERS and {len(parallel) for parallel in rule.sizes} == {2}:
        return (
            " In the valve states, crossflow is above the upper dotted line, one valve between the "
            "lines, both valves below."
        )
    made = states_by_kind(rule)[1:]
    kinds = [_KINDS[kind] for kind, states in zip(rule.states, made, strict=True) if states]
    if len(kinds) == 1:
        return ""
    return f" In the valve states dotted lines part, from below, {_listed(kinds)}."


def supply_words(study: ResolvedStudy) -> str:
    """Return what makes the pressures of a machine's lines."""
    supplies, parts = study.study.supplies, ["lines of constant pressure"]
    if supplies.accumulator_volume > 0:
        parts = ["accumulator", "pump"]
    elif study.study.lines and study.study.lines[-1].margin is not None:
        parts = ["a pump that follows the load"]
    if study.study.converters:
        parts.append("converter cylinders")
    return _listed(parts)


def loss_words(study: ResolvedStudy) -> str:
    """Return from where to where a machine's energy loss is counted."""
    if study.study.supplies.accumulator_volume > 0:
        return "accumulator power less piston power"
    return "power of all lines above the lowest less piston power"


def loss_source(study: ResolvedStudy) -> str:
    """Return by what a machine's energy loss is calibrated."""
    if study.study.converters:
        return "the loss through the reading of Q_conv"
    return "the loss through what the study's sources call so"


def largest_words(study: ResolvedStudy) -> str:
    """Return which figures of a case are the largest of its movement sets."""
    if study.study.converters:
        return "final error and converter position are the largest"
    return "the final error is the largest"


def _listed(words: list[str]) -> str:
    """Return words in a row, the last after an "and"."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
