"""The moves on which gains are judged, and the machines that make them (§6, §7)."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse


class Manoeuvre(Section):
    """One move of the position reference, then a rest."""

    kind: Literal["quintic"] = Field("quintic", description="shape of the reference")
    distance: float = quantity("m", "A", "signed length of the move")
    duration: float = quantity("s", "T", "time of the move", above=0)
    rest: float = quantity("s", "T_rest", "rest after the move", at_least=0)


class Verification(Section):
    """The machines on which the gains are proven."""

    start: float = quantity("m", "x_0", "piston position at the start", at_least=0)
    masses: tuple[float, ...] = quantity("kg", "m", "masses", above=0)
    valve_delays: tuple[float | Range, ...] = quantity(
        "s", "d_v", "valve delays; a pair is drawn from at each switching", at_least=0
    )
    oil_bulk_moduli: tuple[float, ...] = quantity("Pa", "B_oil", "oil bulk moduli", above=0)
    load_forces: tuple[float, ...] = quantity("N", "F_load", "load forces")
    seeds: tuple[int, ...] = quantity("1", "seed", "seeds of the random numbers", (1,))
    repeats: int = quantity("1", "n", "movement sets per case", 1, at_least=1)

    @model_validator(mode="after")
    def _delay_pairs_are_ordered(self) -> Self:
        for pair in self.valve_delays:
            if isinstance(pair, tuple) and pair[0] > pair[1]:
                refuse("has a reversed range in valve_delays", "write the smaller value first")
        return self

    def delay_ranges(self) -> tuple[Range, ...]:
        """Return every valve delay as a range [s]; a single delay is one without width."""
        return tuple(one if isinstance(one, tuple) else (one, one) for one in self.valve_delays)
