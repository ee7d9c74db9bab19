"""What a point of the search is worth: its objective, and the requirements as excesses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.tune.excess import Excess
from mptune.tune.objective import Judge, weights_of
from mptune.tune.polish import Values

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.arrays import FloatArray
    from mptune.robust.model import LinearModel
    from mptune.tune.excesses import Excesses
    from mptune.tune.objective import Figures
    from mptune.tune.space import Choice, Space

INDEX = "tracking_index"
_OF_PLANTS = ("tracking", "robustness")  # kinds whose largest value of several is the objective
_NO_INTEGRAL = 1e-6  # 1/s²: stands for a gain of 0, whose inverse is wanted
_ROUNDING = 1e-5  # of a logarithm, kept in hand


class Worth:
    """One search's objective and requirements, on the plants that bind.

    Parameters
    ----------
    model, judge
        The study's linear model and its figures of merit.
    before
        The figures that the objective is relative to.
    space
        What is free.
    required
        The requirements on loops.
    hand
        What is kept in hand of requirements, see ``Excesses``.
    """

    def __init__(
        self,
        model: LinearModel,
        judge: Judge,
        before: Figures,
        space: Space,
        required: Excesses,
        hand: Mapping[str, float] | None = None,
    ) -> None:
        self._judge, self._before, self._space, self._required = judge, before, space, required
        self._model = model
        self._weights = weights_of(model.study.study.objective)
        self._kept: dict[str, tuple[str, float]] = {}  # name: kind, and the most it may become
        limit = model.requirements.tracking_index
        if limit is not None:
            most = limit * float(np.exp(-_ROUNDING - (hand or {}).get(INDEX, 0.0)))
            self._kept[INDEX] = "tracking", most

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of objective that are improved or kept."""
        return tuple(dict.fromkeys((*self._weights, *(kind for kind, _ in self._kept.values()))))

    @property
    def heaviest(self) -> str:
        """The kind of objective that weighs most."""
        return max(self._weights, key=lambda kind: self._weights[kind])

    def turn_to(self, kind: str, choice: Choice, share: float) -> None:
        """Improve another kind; the last one may become worse by a share of a choice's value."""
        last = next(iter(self._weights))
        self._kept[f"objective {last}"] = last, self._value(choice, last) * (1 + share)
        self._weights = {kind: 1.0}

    def of(self, point: FloatArray) -> Values:
        """Return what a point is worth."""
        choice = self._space.choice(point)
        first = next((kind for kind in _OF_PLANTS if kind in self._weights), None)
        peaks = np.zeros(0)
        if first is not None:
            share = self._weights[first] / self._base(first)
            peaks = share * self._values(choice, first).ravel()
        smooth = sum(
            weight * self._value(choice, kind) / self._base(kind)
            for kind, weight in self._weights.items()
            if kind != first
        )
        return Values(peaks, float(smooth), self._excesses(choice))

    def of_requirements(self, point: FloatArray) -> Values:
        """Return the requirements of a point, the objective left out."""
        return Values(np.zeros(0), 0.0, self._excesses(self._space.choice(point)))

    def names(self) -> list[str]:
        """Return the name behind each excess."""
        names = [*self._required.names]
        for name, (kind, _) in self._kept.items():
            names += [name] * np.size(self._values(self._space.choice(self._space.low), kind))
        return names

    def bounded(self, worst: Mapping[str, float]) -> tuple[Excess, ...]:
        """Return the excess of the tracking index, from the worst values over the family."""
        if INDEX not in self._kept:
            return ()
        kind, most = self._kept[INDEX]
        return (Excess(INDEX, float(np.log(worst[kind] / most)), -1, np.nan),)

    def _excesses(self, choice: Choice) -> FloatArray:
        """Return the requirements' excesses, and those of earlier objectives."""
        kept = [
            np.log(self._values(choice, kind).ravel() / most) for kind, most in self._kept.values()
        ]
        by = choice.put_over(self._model).filters
        return np.concatenate([self._required.of(choice.gains, by), *kept])

    def _values(self, choice: Choice, kind: str) -> FloatArray:
        """Return what is to be small of one kind of objective."""
        if kind == "tracking":
            return self._judge.tracking_peaks(choice, running_away=True)
        if kind == "load-step":
            return self._judge.load_peaks(choice.gains)
        if kind == "robustness":  # positive, and smooth where α passes through 0
            return np.exp(-self._judge.disk_margins(choice))
        if kind == "disturbance":
            return np.array([1 / max(choice.gains.k_i_pos, _NO_INTEGRAL)])
        return np.array([1 / self._judge.bandwidth(choice.gains)])

    def _value(self, choice: Choice, kind: str) -> float:
        return float(self._values(choice, kind).max())

    def _base(self, kind: str) -> float:
        """Return the study's own gains' value of one kind of objective; 1 where they have none."""
        before = self._before
        value = {
            "tracking": before.tracking,
            "disturbance": 1 / (before.integral_gain or 1.0),
            "load-step": before.load_step,
            "bandwidth": 1 / before.bandwidth,
            "robustness": np.exp(-before.disk_margin),
        }[kind]
        return float(value) if np.isfinite(value) and value > 0 else 1.0
