"""The moves on which gains are judged, and the machines that make them (§6, §7)."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse


class Manoeuvre(Section):
    """One move of the position reference, then a rest."""

    kind: Literal["quintic", "trapezoid", "s-curve", "sine", "velocity", "file"] = Field(
        "quintic", description="shape of the reference"
    )
    distance: float = quantity(
        "m", "A", "signed length of the move; of a sine, from one end to the other", 0.0
    )
    duration: float = quantity("s", "T", "time of the move", above=0)
    rest: float = quantity("s", "T_rest", "rest after the move", at_least=0)
    ramp_share: float = quantity(
        "1", "r", "share of the time for each ramp of trapezoid and s-curve", 0.25, above=0,
        at_most=0.5,
    )  # fmt: skip
    cycles: int = quantity("1", "n", "cycles of a sine", 1, at_least=1)
    samples: tuple[tuple[float, float], ...] = Field(
        (), description="time [s] and position [m], read from the file that `file` names"
    )
    speed: float = quantity("m/s", "v", "commanded speed, as from a joystick", 0.0)
    ramp: float = quantity(
        "s", "T_r", "time in which a commanded speed is reached, and left again", 0.1, above=0
    )

    @model_validator(mode="after")
    def _has_what_its_kind_needs(self) -> Self:
        if (self.kind == "file") != bool(self.samples):
            refuse(
                'has either no file with kind = "file" or a file with another kind',
                'write kind = "file" and file = "name.csv"',
            )
        if (self.kind == "velocity") != (self.speed != 0):
            refuse(
                'has either no speed with kind = "velocity" or a speed with another kind',
                'write kind = "velocity" and speed = "50 mm/s"',
            )
        if self.kind == "velocity" and (self.distance != 0 or 2 * self.ramp > self.duration):
            refuse(
                "has a commanded speed with a distance, or with ramps longer than its duration",
                "leave the distance out, and let twice the ramp fit into the duration",
            )
        return self

    @property
    def net_distance(self) -> float:
        """How far from its begin the move ends [m]."""
        if self.kind == "file":
            return self.samples[-1][1] - self.samples[0][1]
        if self.kind == "velocity":
            return self.speed * (self.duration - self.ramp)
        return 0.0 if self.kind == "sine" else self.distance

    @property
    def reach(self) -> tuple[float, float]:
        """Least and largest position on the way, from the begin [m]."""
        places = [0.0, self.distance, self.net_distance]
        if self.kind == "file":
            places = [position - self.samples[0][1] for _, position in self.samples]
        return min(places), max(places)


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
