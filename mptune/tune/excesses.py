"""The study's requirements as numbers that must not exceed 0, on the plants that bind.

Each is the logarithm of found over allowed. Eq. 21 needs no plants but its envelope max|Δ_pos|(ω),
which a handful of plants make; M_S, M_T and the loop as it runs need the plants that are worst
in them. Both sets grow: a search asks the few, and ``grow`` asks the whole family afterwards.
Measured members are always asked, of Eq. 21, M_S and M_T.

Eq. 17 is not among them: every velocity gain up to the largest, known in closed form, meets it.
Around a state estimator neither is Eq. 21, and what is asked of loops is asked of that at F_ref.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.broken import FORCE
from mptune.loops.noise import noise_force, noise_gain
from mptune.params.pack import force_noise
from mptune.robust.grid import frequency_range
from mptune.robust.margins import family_margins
from mptune.robust.measured_loops import member_margins
from mptune.robust.running import family_figures, running_figures
from mptune.robust.sweep import CONVERGED
from mptune.robust.verdict import allowed_ratio
from mptune.sim.running import step_figures
from mptune.tune.asked import AskedPlants
from mptune.tune.excess import (
    FARTHEST,
    NOISES,
    PEAKS,
    POSITION,
    SAMPLED,
    STABLE,
    STEPS,
    Excess,
    over_limit,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.arrays import FloatArray, IntArray
    from mptune.params.packed import LoopGains, MeasurementPath
    from mptune.robust.model import LinearModel

WINDOWS = 40  # of frequency, each judged by its largest ratio
POINTS = 25 * WINDOWS  # frequencies of the envelope
_MARGIN_POINTS = 150  # peaks are refined between them
_IN_HAND = 5 * CONVERGED  # of a ratio, for what the grid does not see
_GROWN = 1e-6  # of a quotient's logarithm: a plant that is worse by less is not added
_ROUNDING = 1e-5  # kept in hand of every other limit
_FOLDED = 1.05e-2  # and as it runs around an estimator, whose certificates close to 1 %
_LOWEST = 0.1  # of the envelope's lowest frequency: there loops as they run are first asked
_LEAST_OVERSHOOT = 1e-3  # taken for none


def _with(omega: FloatArray, added: FloatArray) -> FloatArray:
    """Return the frequencies with each added one in the place of its nearest neighbour."""
    inside = added[(added > omega[0]) & (added < omega[-1])]
    place = np.searchsorted(0.5 * (omega[1:] + omega[:-1]), inside)
    moved = omega.copy()
    moved[place] = inside
    return moved


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
        self._coarse, self._low = np.geomspace(low, high, _MARGIN_POINTS), _LOWEST * low
        limit = model.requirements.position_ratio
        in_hand = np.log1p(-_IN_HAND) - self._hand.get(POSITION, 0.0)
        self._allowed = np.log(allowed_ratio(limit, self._omega)) + in_hand
        self._envelope = self._behind(start)
        corners = model.corners()
        members = model.members
        self._true = corners[:0] if members is not None and members.instead else corners
        self._peaks = tuple(name for name in PEAKS if getattr(model.requirements, name) is not None)
        # Where no hold fits into the delay there is no sampled loop to ask: the verdict says so.
        self._of_sampled, self._of_steps = (
            tuple(name for name in names if model.runs and self._limit(name) is not None)
            for names in (SAMPLED, STEPS)
        )
        if model.runs and (self._of_sampled or model.study.study.objective.runs):
            self._of_sampled = (STABLE, *self._of_sampled)
        self._ask_sampled(corners)

    @property
    def plants(self) -> int:
        """Number of plants that are asked."""
        asked = [self._envelope]
        asked += [self._true] if self._peaks else []
        asked += [self._sampled] if self._of_sampled or self._of_steps else []
        return len(np.unique(np.concatenate(asked)))

    @property
    def names(self) -> tuple[str, ...]:
        """The requirement behind each of the excesses."""
        found = [] if self._model.estimated else [POSITION] * WINDOWS
        measured = len(self._model.members) if self._model.members is not None else 0
        found += [name for name in self._peaks for _ in range(len(self._true) + measured)]
        found += [name for name in (*self._of_sampled, *self._of_steps) for _ in self._sampled]
        found += [name for name in NOISES if self._limit(name) is not None]
        return tuple(found)

    def of(self, gains: LoopGains, filters: MeasurementPath | None = None) -> FloatArray:
        """Return the excesses on the plants that bind, in the order of ``names``.

        Parameters
        ----------
        gains
            The gains.
        filters
            What measures, as it runs; the study's own where None.
        """
        by, parts = filters or self._model.filters, []
        if not self._model.estimated:
            ratio = self._ratio_excess(gains, self._envelope)[0]
            parts.append(ratio.reshape(WINDOWS, -1).max(axis=1))
        parts += [values for _, values, _ in self._peak_excesses(gains, by, self._true)]
        parts += [values for _, values, _ in self._sampled_excesses(gains, by)]
        parts += [np.array([value]) for _, value in self._noise_excesses(gains, by)]
        return np.asarray(np.maximum(np.concatenate([np.zeros(0), *parts]), FARTHEST))

    def worst(self, gains: LoopGains, filters: MeasurementPath | None = None) -> tuple[Excess, ...]:
        """Return each requirement's worst over the whole family."""
        by, found = filters or self._model.filters, []
        every = np.arange(len(self._model.plants.mass))
        if not self._model.estimated:
            ratio, plant = self._ratio_excess(gains, every)
            top = int(np.argmax(ratio))
            found.append(
                Excess(POSITION, float(ratio[top]), int(plant[top]), float(self._omega[top]))
            )
        members = self._model.members
        true = every[:0] if members is not None and members.instead else every
        kinds = (*self._peak_excesses(gains, by, true), *self._sampled_excesses(gains, by, every))
        for name, values, frequency in kinds:
            top = int(np.argmax(values))
            before = len(every) - len(true) if name in PEAKS else 0  # plants that are not asked
            found.append(Excess(name, float(values[top]), before + top, float(frequency[top])))
        found += [Excess(name, x, -1, np.nan) for name, x in self._noise_excesses(gains, by)]
        return tuple(found)

    def grow(
        self, gains: LoopGains, filters: MeasurementPath | None = None
    ) -> tuple[tuple[Excess, ...], bool]:
        """Ask the whole family; add the plants that are worse than those known.

        Returns
        -------
        tuple
            Each requirement's worst over the whole family, and whether a plant was added.
        """
        known = dict.fromkeys(self.names, -np.inf)
        for name, value in zip(self.names, self.of(gains, filters), strict=True):
            known[name] = max(known[name], value)
        found, added = self.worst(gains, filters), False
        for one in found:
            if one.plant < 0 or one.excess <= max(known[one.requirement], 0.0) + _GROWN:
                continue
            added = True
            if one.requirement == POSITION:
                self._envelope = np.union1d(self._envelope, self._behind(gains))
            elif one.requirement in PEAKS:
                self._true = np.union1d(self._true, [one.plant])
            else:
                self._ask_sampled(np.union1d(self._sampled, [one.plant]))
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
        self, gains: LoopGains, by: MeasurementPath, rows: IntArray
    ) -> list[tuple[str, FloatArray, FloatArray]]:
        if not self._peaks:
            return []
        model, parts = self._model, []
        path = by if model.estimated else model.path
        if len(rows):
            loops = model.loops(gains, path, model.plants_along(path).picked(rows))
            parts.append(family_margins(self._coarse, loops))
        if model.members is not None:
            parts.append(member_margins(model.members, gains, path))
        found = []
        for name in self._peaks:
            limit, at = getattr(model.requirements, name), name.replace("peak", "frequency")
            peak = np.concatenate([getattr(part, name)[FORCE] for part in parts])
            frequency = np.concatenate([getattr(part, at)[FORCE] for part in parts])
            found.append((name, np.log(peak / limit) + self._rounding(name), frequency))
        return found

    def _limit(self, name: str) -> float | None:
        limit: float | None = getattr(self._model.requirements, name)
        return limit

    def _ask_sampled(self, rows: IntArray) -> None:
        """Ask these plants of the loop as it runs."""
        self._sampled = rows
        self._running = AskedPlants(self._model, rows, self._low)

    def _sampled_excesses(
        self, gains: LoopGains, by: MeasurementPath, rows: IntArray | None = None
    ) -> list[tuple[str, FloatArray, FloatArray]]:
        """Return the excesses of plants as they run: of those asked, or of other rows."""
        model, found = self._model, []
        if not (self._of_sampled or self._of_steps):
            return []
        plants = model.explicit.picked(self._sampled if rows is None else rows)
        loops = model.loops(gains, by, plants)
        if self._of_sampled and rows is None:
            figures = running_figures(self._running.by(by), gains)
        elif self._of_sampled:
            figures = family_figures(loops, model.period, self._low)
        for name in self._of_sampled:
            excess, frequency = over_limit(name, self._limit_of(name), figures)
            found.append((name, excess, frequency))
        if self._of_steps:
            asked = self._limit("settling_time")
            steps = step_figures(loops, model.period, asked or 0.0)
            nowhere = np.full(loops.plants.number, np.nan)
            for name in self._of_steps:
                over = steps.late_deviation
                if name == "overshoot":
                    limit = max(self._limit(name) or 0.0, _LEAST_OVERSHOOT)
                    over = np.maximum(steps.overshoot, _LEAST_OVERSHOOT / 2) / limit
                over = np.log(np.clip(np.nan_to_num(over, nan=np.inf), 1e-12, 1e3))
                found.append((name, over + self._rounding(name), nowhere))
        return found

    def _limit_of(self, name: str) -> float:
        """Return a limit of the loop as it runs, with what is kept in hand of it."""
        limit = 1.0 if name == STABLE else (self._limit(name) or 1.0)
        hand = self._rounding(name)
        return limit * float(np.exp(hand if name.endswith("margin") else -hand))

    def _rounding(self, name: str) -> float:
        certified = self._model.estimated and name in SAMPLED
        return (_FOLDED if certified else _ROUNDING) + self._hand.get(name, 0.0)

    def _noise_excesses(self, gains: LoopGains, by: MeasurementPath) -> list[tuple[str, float]]:
        model, found = self._model, []
        for name in NOISES:
            limit = self._limit(name)
            if limit is not None:
                of_place = model.study.study.controller.position_noise
                noise = (
                    noise_gain(gains, by)
                    if name == "noise_gain"
                    else noise_force(gains, by, of_place, force_noise(model.study))
                )
                found.append((name, float(np.log(noise / limit)) + _ROUNDING))
        return found
