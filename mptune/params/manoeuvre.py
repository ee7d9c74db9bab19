"""The moves on which gains are judged, and the machines that make them (§6, §7)."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse

FEWEST_SAMPLES = 4
"""Of a recorded reference."""


class Manoeuvre(Section):
    """One move of the position reference, then a rest."""

    kind: Literal["quintic", "trapezoid", "s-curve", "sine", "velocity", "file"] = Field(
        "quintic", description="shape of the reference"
    )
    distance: float = quantity(
        "m",
        "A",
        "signed length of the move; of a sine, from one end to the other",
        0.0,
        at_least=-50,
        at_most=50,
    )
    duration: float = quantity("s", "T", "time of the move", at_least=1e-9, at_most=1e4)
    rest: float = quantity("s", "T_rest", "rest after the move", at_least=0, at_most=1e4)
    ramp_share: float = quantity(
        "1", "r", "share of the time for each ramp of trapezoid and s-curve", 0.25, above=0,
        at_most=0.5,
    )  # fmt: skip
    cycles: int = quantity("1", "n", "cycles of a sine", 1, at_least=1, at_most=10000)
    samples: tuple[tuple[float, float], ...] = Field(
        (), description="time [s] and position [m], read from the file that `file` names"
    )
    speed: float = quantity(
        "m/s", "v", "commanded speed, as from a joystick", 0.0, at_least=-10, at_most=10
    )
    ramp: float = quantity(
        "s",
        "T_r",
        "time in which a commanded speed is reached, and left again",
        0.1,
        at_least=1e-9,
        at_most=1e4,
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

    @model_validator(mode="after")
    def _samples_are_a_move(self) -> Self:
        if not self.samples:
            return self
        if len(self.samples) < FEWEST_SAMPLES:
            refuse(f"has less than {FEWEST_SAMPLES} samples", "record more")
        times = [time for time, _ in self.samples]
        if any(after <= before for before, after in pairwise(times)):
            refuse("has samples whose times do not rise", "order them")
        if not math.isclose(self.duration, times[-1] - times[0], rel_tol=1e-9):
            refuse("has a duration that is not its samples'", "leave samples to `file`")
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
    def stands(self) -> bool:
        """Whether the move covers no distance, so that there is no index to judge it by."""
        return self.reach == (0.0, 0.0)

    @property
    def reach(self) -> tuple[float, float]:
        """Least and largest position on the way, from the begin [m]."""
        places = [0.0, self.distance, self.net_distance]
        if self.kind == "file":
            places = [position - self.samples[0][1] for _, position in self.samples]
        return min(places), max(places)

    @property
    def peak_velocity(self) -> float:
        """Largest speed of the reference [m/s]; of a file's, between its samples."""
        length, time = abs(self.distance), self.duration
        if self.kind == "quintic":
            return 1.875 * length / time
        if self.kind == "sine":
            return math.pi * self.cycles * length / time
        if self.kind == "file":
            return max(map(abs, self._speeds()))
        if self.kind == "velocity":
            return abs(self.speed)
        return length / (time * (1 - self.ramp_share))

    @property
    def peak_acceleration(self) -> float:
        """Largest acceleration of the reference [m/s²]; of a file's, between its samples."""
        time, speed = self.duration, self.peak_velocity
        if self.kind == "quintic":
            return 10 / math.sqrt(3) * abs(self.distance) / time**2
        if self.kind == "sine":
            return 2 * math.pi * self.cycles / time * speed
        if self.kind == "file":
            speeds, times = self._speeds(), [at for at, _ in self.samples]
            gaps = [(last - first) / 2 for first, last in zip(times, times[2:], strict=False)]
            changes = [abs(b - a) for a, b in pairwise(speeds)]
            return max((a / gap for a, gap in zip(changes, gaps, strict=True)), default=0.0)
        if self.kind == "velocity":
            return speed / self.ramp
        factor = 2 if self.kind == "s-curve" else 1
        return factor * speed / (self.ramp_share * time)

    @property
    def travel(self) -> float:
        """The way that the reference goes, there and back [m]."""
        if self.kind == "sine":
            return 2 * self.cycles * abs(self.distance)
        if self.kind == "file":
            places = [place for _, place in self.samples]
            return sum(abs(b - a) for a, b in pairwise(places))
        return abs(self.net_distance)

    @property
    def extends(self) -> bool:
        """Whether the piston is to move out somewhere."""
        if self.kind == "file":
            return max(self._speeds()) > 0
        return self.net_distance > 0 or (self.kind == "sine" and self.distance != 0)

    @property
    def retracts(self) -> bool:
        """Whether the piston is to move in somewhere."""
        if self.kind == "file":
            return min(self._speeds()) < 0
        return self.net_distance < 0 or (self.kind == "sine" and self.distance != 0)

    def _speeds(self) -> list[float]:
        return [(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(self.samples)]


class Verification(Section):
    """The machines on which the gains are proven; what is left out follows the study's ranges."""

    start: float = quantity("m", "x_0", "piston position at the start", at_least=0, at_most=50)
    masses: tuple[float, ...] = quantity(
        "kg", "m", "masses; the ends of uncertainty.mass", (), at_least=10, at_most=1e7
    )
    valve_delays: tuple[float | Range, ...] = quantity(
        "s", "d_v", "valve delays, valves.delay; a pair is drawn from at each switching", (),
        at_least=0, at_most=1,
    )  # fmt: skip
    oil_bulk_moduli: tuple[float, ...] = quantity(
        "Pa",
        "B_oil",
        "oil bulk moduli; the ends of oil.bulk_modulus",
        (),
        at_least=1e7,
        at_most=1e11,
    )
    load_forces: tuple[float, ...] = quantity(
        "N", "F_load", "load forces; load.force", (), at_least=-1e9, at_most=1e9
    )
    seeds: tuple[int, ...] = quantity(
        "1", "seed", "seeds of the random numbers", (1,), at_least=0, at_most=2**63 - 1
    )
    repeats: int = quantity("1", "n", "movement sets per case", 1, at_least=1, at_most=100_000)
    papers_frame: bool = Field(
        default=False,
        description="whether run tunes in the paper's own frame as well, for comparison; never "
        "around a state estimator, which that frame does not know",
    )
    duty: float = quantity(
        "1", "η", "share of the year in which the machine does these moves", 0.1,
        above=0, at_most=1,
    )  # fmt: skip

    @model_validator(mode="after")
    def _delay_pairs_are_ordered(self) -> Self:
        for pair in self.valve_delays:
            if isinstance(pair, tuple) and pair[0] > pair[1]:
                refuse("has a reversed range in valve_delays", "write the smaller value first")
        return self

    def filled(self, mass: Range, delay: Range, modulus: Range, force: float) -> Self:
        """Return the same with what was left out taken from a study's ranges, all in SI."""
        ranges = {
            "masses": tuple(dict.fromkeys(mass)),
            "valve_delays": (delay,),
            "oil_bulk_moduli": tuple(dict.fromkeys(modulus)),
            "load_forces": (force,),
        }
        left_out = {name: value for name, value in ranges.items() if not getattr(self, name)}
        return self.model_copy(update=left_out)

    def delay_ranges(self) -> tuple[Range, ...]:
        """Return every valve delay as a range [s]; a single delay is one without width."""
        return tuple(one if isinstance(one, tuple) else (one, one) for one in self.valve_delays)
