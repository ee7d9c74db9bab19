"""What of a design is proved over all frequencies, and what a grid alone says.

Plants that know their poles, zeros and dead time, under a controller that is known as a fraction,
are certified: closed-loop poles are counted with certainty and every peak is bounded. What is a
mere function or array is judged on the grid, which can only miss and is therefore optimistic.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.result import Grounds
from mptune.errors import Fault, InputError
from mptune.shape.certificate import supremum
from mptune.shape.deviation import Deviation
from mptune.shape.problem import Loops
from mptune.shape.rational_loops import ClosedLoop, RationalLoops
from mptune.shape.responses import between
from mptune.shape.turns import SampledStability
from mptune.shape.winding import axis_end, count_closed_poles

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from mptune.arrays import FloatArray
    from mptune.shape.problem import Peak
    from mptune.shape.procedure import Use
    from mptune.shape.rational import RationalPlant
    from mptune.shape.rational_loops import Quotients
    from mptune.shape.responses import Response
    from mptune.shape.structure import Structure

NOMINAL, FAMILY, RATIO = "nominal", "family", "ratio"  # names of loops, and of a requirement
_BATCH = 256  # plants counted at once: the first that is not stable settles it
_FLOOR = 1e-6  # of what is allowed: bounds below are not asked for
KEPT = 1e-6  # of a bound, that a figure may be above it


@dataclass(frozen=True)
class PeakVerdict:
    """What one requirement over frequency comes to.

    Attributes
    ----------
    requirement
        Its name.
    attained
        The largest value found.
    bound
        What no value exceeds, at any frequency and of any plant; NaN where only a grid was looked
        at, infinite where none could be proved.
    allowed
        The largest allowed value; where that is a curve, 1, and the others are quotients of it.
    frequency
        Where the value is attained [rad/s].
    plant
        Of which plant of the loops.
    grounds
        What the verdict rests on; open where the proof was not finished within its budget.
    """

    requirement: str
    attained: float
    bound: float
    allowed: float
    frequency: float
    plant: int
    grounds: Grounds

    @property
    def kept(self) -> bool:
        """Whether the requirement is proved; on a grid only, whether it holds there."""
        most = self.attained if self.grounds is Grounds.GRID else self.bound
        return most <= self.allowed * (1 + KEPT)


class Proofs:
    """Stability and verdicts of one structure with nominal plant and family.

    Parameters
    ----------
    structure
        The controller.
    plants
        The plants of each set of loops.
    grid
        ``(F,)`` frequencies [rad/s] for plants that are not certified.
    integrators, unstable_poles
        Open-loop poles of plants that do not know their own, at the origin and in the right half
        plane; what is given for all plants where not None.

    Attributes
    ----------
    certified
        The sets of loops all of whose plants are certified.
    """

    def __init__(
        self,
        structure: Structure,
        plants: Mapping[str, Sequence[Response]],
        grid: FloatArray,
        integrators: int | None,
        unstable_poles: int | None,
    ) -> None:
        self._structure = structure
        given = integrators, unstable_poles
        usual = _counts(plants[NOMINAL][0], given, (0, 0))
        self._rational: dict[str, list[RationalPlant]] = {}
        sampled: dict[tuple[int, int], list[Response]] = {}
        for name, members in plants.items():
            self._rational[name] = []
            for one in members:
                if one.rational is not None and structure.denominator:
                    _refuse_contradiction(one, given, usual)
                    self._rational[name].append(one.rational)
                else:
                    sampled.setdefault(_counts(one, given, usual), []).append(one)
        self.certified = {
            name for name, members in plants.items() if len(members) == len(self._rational[name])
        }
        self._sampled = [
            SampledStability(structure, {"sampled": loops_of(grid, members)}, *both)
            for both, members in sampled.items()
        ]

    @property
    def stability(self) -> Grounds:
        """What the verdict on stability rests on."""
        return Grounds.GRID if self._sampled else Grounds.CERTIFIED

    @property
    def reasons(self) -> tuple[Fault, ...]:
        """Why counts on the grid were refused so far."""
        return tuple(reason for one in self._sampled for reason in one.reasons)

    def stable(self, x: FloatArray) -> bool:
        """Return whether parameters stabilise every loop, as certainly as the plants allow."""
        if not all(one(x) for one in self._sampled):
            return False
        plants = [one for members in self._rational.values() for one in members]
        batches = [plants[first : first + _BATCH] for first in range(0, len(plants), _BATCH)]
        return all(
            bool(
                count_closed_poles(RationalLoops(batch, *self._structure.fraction(x))).stable.all()
            )
            for batch in batches
        )

    def verdicts(
        self, x: FloatArray, peaks: Sequence[Peak], uses: Sequence[Use], ratio: float | None
    ) -> tuple[PeakVerdict, ...]:
        """Return a verdict on every peak at parameters that stabilise every loop.

        Parameters
        ----------
        x
            The parameters, ``(K,)``.
        peaks
            The requirements.
        uses
            What the grid says of them.
        ratio
            The largest left/right ratio of the peak of that name, None where there is none.
        """
        found = {use.requirement: use for use in uses}
        return tuple(self._verdict(x, peak, found[peak.name], ratio) for peak in peaks)

    def _verdict(self, x: FloatArray, peak: Peak, use: Use, ratio: float | None) -> PeakVerdict:
        allowed = 1.0 if callable(peak.largest) else float(peak.largest)
        if ratio is not None and peak.name == RATIO:
            allowed, quotients = ratio, self._deviation(x)
        else:
            quotients = self._closed_loop(x, peak)
        if quotients is None:
            attained = use.quotient * allowed
            place = use.frequency, use.plant
            return PeakVerdict(peak.name, attained, np.nan, allowed, *place, Grounds.GRID)
        loops, functions = quotients
        bound = supremum(functions, axis_end(loops), floor=_FLOOR * allowed)
        place = bound.frequency, bound.row
        both = bound.attained, bound.bound
        grounds = Grounds.CERTIFIED if bound.closed else Grounds.OPEN
        return PeakVerdict(peak.name, *both, allowed, *place, grounds)

    def _deviation(self, x: FloatArray) -> tuple[RationalLoops, Quotients] | None:
        """Return the family's condition with its loops, None where it is not certified."""
        if self.certified != {NOMINAL, FAMILY}:
            return None
        fraction = self._structure.fraction(x)
        nominal, members = self._rational[NOMINAL][0], self._rational[FAMILY]
        loops = RationalLoops([nominal] * len(members), *fraction)
        return loops, Deviation(nominal, members, *fraction)

    def _closed_loop(self, x: FloatArray, peak: Peak) -> tuple[RationalLoops, Quotients] | None:
        """Return the functions of a peak with their loops, None where they are not certified."""
        if callable(peak.largest) or peak.loops not in self.certified:
            return None
        loops = RationalLoops(self._rational[peak.loops], *self._structure.fraction(x))
        return loops, ClosedLoop(loops, peak.function)


def loops_of(grid: FloatArray, plants: Sequence[Response]) -> Loops:
    """Return the loops of some plants on a grid."""
    values = np.stack([one.at(grid) for one in plants])
    if not np.all(np.isfinite(values)):
        at = grid[~np.isfinite(values).all(axis=0)][0]
        rule = "has a frequency at which a plant is not finite"
        raise InputError("design", Fault("omega", f"{at:g}", rule, "leave it out"))
    return Loops.of(grid, values, between(list(plants)))


def _counts(
    plant: Response, given: tuple[int | None, int | None], usual: tuple[int, int]
) -> tuple[int, int]:
    """Return integrators and unstable poles: as given, else the plant's own, else the usual."""
    own = plant.integrators, plant.unstable_poles
    found = [
        next(one for one in choice if one is not None)
        for choice in zip(given, own, usual, strict=True)
    ]
    return found[0], found[1]


def _refuse_contradiction(
    plant: Response, given: tuple[int | None, int | None], usual: tuple[int, int]
) -> None:
    """Refuse a count that a plant's own poles contradict."""
    own = _counts(plant, (None, None), usual)
    for name, one, other in zip(("integrators", "unstable_poles"), given, own, strict=True):
        if one is not None and one != other:
            rule = f"contradicts a plant that has {other} by its own poles"
            raise InputError("design", Fault(name, f"{one}", rule, "leave it out"))
