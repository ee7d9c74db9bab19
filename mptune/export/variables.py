"""The variables of a function mock-up unit, in the order of their value references."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from mptune.force.search_space import space_of
from mptune.params.chambers import LETTERS, NUMBERS

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy

Kind = Literal["real", "integer", "boolean"]
Causality = Literal["input", "parameter", "output"]

UNITS = {  # exponents of the SI base units
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "N": {"kg": 1, "m": 1, "s": -2},
}


class Variable(NamedTuple):
    """One variable; only inputs and parameters have a start."""

    name: str
    kind: Kind
    causality: Causality
    unit: str
    start: float | None
    description: str


def variables(study: ResolvedStudy) -> tuple[Variable, ...]:
    """Return inputs (the members of ``mptune_inputs``, in order), a parameter, and outputs."""
    supplies, middle = study.study.supplies, study.study.cylinder.stroke / 2
    low, high = supplies.low_pressure, supplies.high_pressure
    last = len(space_of(study).first) - 1
    further = LETTERS[NUMBERS[0] : len(study.study.all_chambers)].lower()
    inputs: tuple[tuple[str, str, float, str], ...] = (
        ("position_reference", "m", middle, "x_ref"),
        ("velocity_reference", "m/s", 0.0, "v_ref"),
        ("acceleration_reference", "m/s2", 0.0, "a_ref"),
        ("position", "m", middle, "sampled position, unfiltered"),
        ("pressure_a", "Pa", (low + high) / 2, "sampled pressure of the A-side chamber"),
        ("pressure_b", "Pa", (low + high) / 2, "sampled pressure of the B-side chamber"),
        ("pressure_high", "Pa", high, "sampled pressure of the highest supply"),
        ("pressure_low", "Pa", low, "sampled pressure of the lowest supply"),
        *(
            (f"converter[{i}]", "m", 0.0, "sampled converter position, positive on filling")
            for i in range(1, study.study.converters + 1)
        ),
        *(
            (
                f"pressure_{one}",
                "Pa",
                (low + high) / 2,
                f"sampled pressure of chamber {one.upper()}",
            )
            for one in further
        ),
    )
    outputs: tuple[tuple[str, Kind, str], ...] = (
        ("state_a", "integer", f"valve state of side A, 0 to {last}"),
        ("state_b", "integer", f"valve state of side B, 0 to {last}"),
        *(
            (f"state_{one}", "integer", f"valve state of chamber {one.upper()}, 0 to {last}")
            for one in further
        ),
        ("fault", "integer", "sum of the faults of mptune_controller.h; 0 for none"),
        ("stopped", "boolean", "the stop logic holds all valves shut"),
        ("decided", "boolean", "the loops ran in this step"),
        *(
            (f"valve_{side}[{supply},{number}]", "boolean", "open; supplies from the lowest up")
            for side in ("a", "b", *further)
            for supply, parallel in enumerate(study.study.edge_rule.sizes, 1)
            for number in range(1, len(parallel) + 1)
        ),
    )
    load = "load at the start as far as it is known: the integrator carries it"
    return (
        *(Variable(name, "real", "input", unit, at, text) for name, unit, at, text in inputs),
        Variable("load_force", "real", "parameter", "N", 0.0, load),
        Variable("force_reference", "real", "output", "N", None, "F_ref, limited"),
        *(Variable(name, kind, "output", "", None, text) for name, kind, text in outputs),
    )
