"""The study's requirements as numbers that must not exceed 0, on the plants that bind.

Each is the logarithm of found over allowed. Eq. 21 needs no plants but its envelope max|Δ_pos|(ω),
which a handful of plants make; M_S, M_T and the sampled loop need the plants that are worst in
them. Both sets grow: a search asks the few, and ``grow`` asks the whole family afterwards.
Measured members are always asked, of Eq. 21, M_S and M_T.

Eq. 17 is not among them: every velocity gain up to the largest, known in closed form, meets it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.loops.broken import FORCE
from mptune.loops.noise import noise_gain
from mptune.loops.sampled import stable_as_sampled
from mptune.robust.grid import frequency_range
from mptune.robust.margins import family_margins, sampled_margins
from mptune.robust.measured_loops import member_margins
from mptune.robust.sweep import CONVERGED
from mptune.robust.verdict import allowed_ratio

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.arrays import FloatArray, IntArray
    from mptune.params.packed import LoopGains
    from mptune.robust.model import LinearModel
    from mptune.robust.place import PlantPoint

WINDOWS = 40  # of frequency, each judged by its largest ratio
POINTS = 25 * WINDOWS  # frequencies of the envelope
_MARGIN_POINTS = 150  # peaks are refined between them
_IN_HAND = 5 * CONVERGED  # of a ratio, for what the grid does not see
_GROWN = 1e-6  # of a quotient's logarithm: a plant that is worse by less is not added
_ROUNDING = 1e-5  # kept in hand of every other limit
_FARTHEST = -5.0  # below a limit: a margin without limit is no farther
_UNSTABLE = 7.0  # a peak's logarithm where there is no finite one

POSITION, NOISE = "position_ratio", "noise_gain"
PEAKS = ("sensitivity_peak", "complementary_peak")
SAMPLED = ("sampled_sensitivity_peak", "gain_margin")


def _with(omega: FloatArray, added: FloatArray) -> FloatArray:
    """Return the frequencies with each added one in the place of its nearest neighbour."""
    inside = added[(added > omega[0]) & (added < omega[-1])]
    place = np.searchsorted(0.5 * (omega[1:] + omega[:-1]), inside)
    moved = omega.copy()
    moved[place] = inside
    return moved


class Excess(NamedTuple):
    """One requirement's worst over the plants asked: excess, plant of the family, frequency."""

    requirement: str
    excess: float  # logarithm of found over allowed
    plant: int
    frequency: float

    def at(self, model: LinearModel) -> PlantPoint | None:
        """Return the place; None for requirements that know no plant."""
        if self.plant < 0:
            return None
        as_it_runs = self.requirement in SAMPLED
        return model.point(self.plant, self.frequency, as_it_runs=as_it_runs)


class Excesses:
    """The requirements of one study.

    Parameters
    ----------
    model
        The study's linear model.
    start
        Gains from which frequencies and first plants are chosen.
    hand
        By requirement, the logarithm that is kept in hand of its limit: what a certificate found
        between the frequencies asked.
    """

    def __init__(
        self, model: LinearModel, start: LoopGains, hand: Mapping[str, float] | None = None
    ) -> None:
        self._model, self._hand = model, dict(hand or {})
        low, high = frequency_range(model.plants, model.nominal, start)
        self._omega = np.geomspace(low, high, POINTS)
        if model.members is not None:
            self._omega = _with(self._omega, model.members.omega)
        self._coarse = np.geomspace(low, high, _MARGIN_POINTS)
        limit = model.requirements.position_ratio
        in_hand = np.log1p(-_IN_HAND) - self._hand.get(POSITION, 0.0)
        self._allowed = np.log(allowed_ratio(limit, self._omega)) + in_hand
        self._envelope = self._behind(start)
        corners = model.corners()
        members = model.members
        self._true = corners[:0] if members is not None and members.instead else corners
        self._sampled = corners
        self._peaks = tuple(name for name in PEAKS if getattr(model.requirements, name) is not None)
        # Where no hold fits into the delay there is no sampled loop to ask: the verdict says so.
        self._of_sampled = tuple(
            name for name in SAMPLED if model.runs and getattr(model.requirements, name) is not None
        )

    @property
    def plants(self) -> int:
        """Number of plants that are asked."""
        asked = [self._envelope]
        asked += [self._true] if self._peaks else []
        asked += [self._sampled] if self._of_sampled else []
        return len(np.unique(np.concatenate(asked)))

    @property
    def names(self) -> tuple[str, ...]:
        """The requirement behind each of the excesses."""
        found = [POSITION] * WINDOWS
        measured = len(self._model.members) if self._model.members is not None else 0
        found += [name for name in self._peaks for _ in range(len(self._true) + measured)]
        found += [name for name in self._of_sampled for _ in self._sampled]
        if self._model.requirements.noise_gain is not None:
            found.append(NOISE)
        return tuple(found)

    def of(self, gains: LoopGains) -> FloatArray:
        """Return the excesses on the plants that bind, in the order of ``names``."""
        ratio = self._ratio_excess(gains, self._envelope)[0]
        parts = [ratio.reshape(WINDOWS, -1).max(axis=1)]
        parts += [values for _, values, _ in self._peak_excesses(gains, self._true)]
        parts += [values for _, values, _ in self._sampled_excesses(gains, self._sampled)]
        noise = self._noise_excess(gains)
        return np.asarray(np.maximum(np.concatenate([*parts, noise]), _FARTHEST))

    def worst(self, gains: LoopGains) -> tuple[Excess, ...]:
        """Return each requirement's worst over the whole family."""
        every = np.arange(len(self._model.plants.mass))
        ratio, plant = self._ratio_excess(gains, every)
        top = int(np.argmax(ratio))
        found = [Excess(POSITION, float(ratio[top]), int(plant[top]), float(self._omega[top]))]
        members = self._model.members
        true = every[:0] if members is not None and members.instead else every
        kinds = (*self._peak_excesses(gains, true), *self._sampled_excesses(gains, every))
        for name, values, frequency in kinds:
            top = int(np.argmax(values))
            before = len(every) - len(true) if name in PEAKS else 0  # plants that are not asked
            found.append(Excess(name, float(values[top]), before + top, float(frequency[top])))
        found += [Excess(NOISE, float(value), -1, np.nan) for value in self._noise_excess(gains)]
        return tuple(found)

    def grow(self, gains: LoopGains) -> tuple[tuple[Excess, ...], bool]:
        """Ask the whole family; add the plants that are worse than those known.

        Returns
        -------
        tuple
            Each requirement's worst over the whole family, and whether a plant was added.
        """
        known = dict.fromkeys(self.names, -np.inf)
        for name, value in zip(self.names, self.of(gains), strict=True):
            known[name] = max(known[name], value)
        found, added = self.worst(gains), False
        for one in found:
            if one.plant < 0 or one.excess <= max(known[one.requirement], 0.0) + _GROWN:
                continue
            added = True
            if one.requirement == POSITION:
                self._envelope = np.union1d(self._envelope, self._behind(gains))
            elif one.requirement in PEAKS:
                self._true = np.union1d(self._true, [one.plant])
            else:
                self._sampled = np.union1d(self._sampled, [one.plant])
        return found, added

    def _ratio_excess(self, gains: LoopGains, rows: IntArray) -> tuple[FloatArray, IntArray]:
        found = self._model.sides(self._omega, gains, self._model.plants.picked(rows))
        count = len(self._model.plants.mass)
        of_box = rows[np.minimum(found.plant[1], len(rows) - 1)]
        members = count + found.plant[1] - len(rows)  # measured ones come after the box's
        plant = np.where(found.plant[1] < len(rows), of_box, members)
        return np.log(found.ratio[1]) - self._allowed, plant

    def _behind(self, gains: LoopGains) -> IntArray:
        """Return the plants of the box behind the envelopes."""
        plant = np.unique(self._model.sides(self._omega, gains).plant)
        return plant[plant < len(self._model.plants.mass)]

    def _peak_excesses(
        self, gains: LoopGains, rows: IntArray
    ) -> list[tuple[str, FloatArray, FloatArray]]:
        if not self._peaks:
            return []
        model, parts = self._model, []
        if len(rows):
            loops = model.loops(gains, plants=model.plants.picked(rows))
            parts.append(family_margins(self._coarse, loops))
        if model.members is not None:
            parts.append(member_margins(model.members, gains, model.path))
        found = []
        for name in self._peaks:
            limit, at = getattr(model.requirements, name), name.replace("peak", "frequency")
            peak = np.concatenate([getattr(part, name)[FORCE] for part in parts])
            frequency = np.concatenate([getattr(part, at)[FORCE] for part in parts])
            found.append((name, np.log(peak / limit) + self._rounding(name), frequency))
        return found

    def _sampled_excesses(
        self, gains: LoopGains, rows: IntArray
    ) -> list[tuple[str, FloatArray, FloatArray]]:
        if not self._of_sampled:
            return []
        model = self._model
        loops = model.as_it_runs(gains, model.explicit.picked(rows))
        stable = stable_as_sampled(loops, model.period)[0]
        margins = sampled_margins(self._coarse, loops, model.period)
        found = []
        if "sampled_sensitivity_peak" in self._of_sampled:
            limit = model.requirements.sampled_sensitivity_peak
            peak = np.log(margins.sensitivity_peak[FORCE] / limit)
            peak += self._rounding("sampled_sensitivity_peak")
            peak = np.where(stable, peak, _UNSTABLE)
            found.append(("sampled_sensitivity_peak", peak, margins.sensitivity_frequency[FORCE]))
        if "gain_margin" in self._of_sampled:
            limit = model.requirements.gain_margin
            # An unstable loop's margin is below 1: the factor that would make it stable.
            factor = np.where(stable, margins.gain_margin[FORCE], margins.gain_reduction[FORCE])
            at = np.where(stable, margins.gain_frequency[FORCE], margins.reduction_frequency[FORCE])
            over = np.log(limit / np.clip(factor, 1e-3, 1e3)) + self._rounding("gain_margin")
            found.append(("gain_margin", over, at))
        return found

    def _rounding(self, name: str) -> float:
        return _ROUNDING + self._hand.get(name, 0.0)

    def _noise_excess(self, gains: LoopGains) -> FloatArray:
        limit = self._model.requirements.noise_gain
        if limit is None:
            return np.zeros(0)
        return np.log([noise_gain(gains, self._model.filters) / limit]) + _ROUNDING
