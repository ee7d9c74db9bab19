"""What the tuner may choose: the controller's parameters, feed-forward, the state estimator.

Each structure of the position controller is a part of Eq. 22's parameter space, so that one loop,
one set of requirements and one search serve them all:

==========  ====================================================================================
``p``       K_P: ω = 1/τ and ξ = 1 make the shape of Eq. 22 equal to 1
``pi``      the same with K_I
``pid``     K_P + K_I/s + K_D s/(τs + 1): (K_P + x_1 s + x_2 s²)/(τs + 1)² with
            x_1 = 2τK_P + K_D and x_2 = τ²K_P + τK_D
``eq22``    all five
==========  ====================================================================================
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.params.controller import Feedforward, Gains
from mptune.params.estimator import Estimator
from mptune.params.pack import pack_measured, pack_path
from mptune.tune.beside import BESIDE, Beside

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.params.packed import LoopGains
    from mptune.params.section import Range, Section
    from mptune.robust.model import LinearModel

STRUCTURES = ("p", "pi", "pid", "eq22")
_OF_STRUCTURE = {
    "p": ("k_p_pos",),
    "pi": ("k_p_pos", "k_i_pos"),
    "pid": ("k_p_pos", "k_i_pos", "k_d_pos", "tau"),
    "eq22": ("k_p_pos", "k_i_pos", "omega", "xi", "tau"),
}
_LEAST_SHARE = 0.1  # of the largest velocity gain
OTHERS = (
    "sensitivity_peak", "complementary_peak", "sampled_sensitivity_peak", "gain_margin",
    "disk_margin", "phase_margin", "delay_margin", "peak_compliance", "overshoot",
    "settling_time", "tracking_index", "noise_gain", "noise_force",
)  # fmt: skip
"""Requirements on linear figures beside those of Eq. 17 and Eq. 21."""


class Choice(NamedTuple):
    """One candidate: gains, feed-forward beyond the velocity reference, and the estimator."""

    gains: LoopGains
    feedforward: Feedforward
    estimator: Estimator

    @classmethod
    def of(cls, model: LinearModel) -> Choice:
        """Return what the study itself says, spelt out what the estimator leaves to others."""
        own, known = model.study.study, model.filters.estimator_mass
        spelt: dict[str, float] = {"mass": known} if known else {}
        if "position_filter" in own.objective.turned:
            spelt["position_filter"] = own.filtering.position_filter
        return cls(model.gains, own.feedforward, own.estimator.model_copy(update=spelt))

    def put_over(self, model: LinearModel) -> LinearModel:
        """Return a model around this candidate's estimator, gains and feed-forward left alone."""
        inner = model.study.study
        if self.estimator == inner.estimator:
            return model
        inner = inner.model_copy(update={"estimator": self.estimator})
        study = model.study.model_copy(update={"study": inner})
        return replace(model, study=study, path=pack_path(study), filters=pack_measured(study))


@dataclass(frozen=True)
class Space:
    """The free parameters, their bounds, and the scales on which they are searched.

    Attributes
    ----------
    structure
        One of ``STRUCTURES``.
    names
        The free parameters.
    low, high
        Their bounds on the search's scales, ``(K,)``: logarithms, or multiples of a unit.
    fixed
        What the other parameters are.
    """

    structure: str
    names: tuple[str, ...]
    low: FloatArray
    high: FloatArray
    fixed: Choice

    @property
    def crowded(self) -> bool:
        """Whether so much is free, the velocity gain too, that local optima abound."""
        return "k_p_vel" in self.names

    def choice(self, point: FloatArray) -> Choice:
        """Return the candidate at a point ``(K,)`` of the search's scales."""
        inside = np.clip(point, self.low, self.high)
        at = dict(zip(self.names, inside.tolist(), strict=True))
        choice = self.fixed
        for name, variable in BESIDE.items():
            if name in at:
                part = getattr(choice, variable.part)
                moved = part.model_copy(update={variable.name: at.pop(name) * variable.unit})
                choice = choice._replace(**{variable.part: moved})
        gains = self._gains({name: float(np.exp(value)) for name, value in at.items()})
        return choice._replace(gains=gains)

    def point(self, choice: Choice) -> FloatArray:
        """Return a candidate's point, moved inside the bounds."""
        values = choice.gains._asdict()
        if self.structure == "pid":
            values["k_d_pos"] = _derivative_gain(choice.gains)
        point = [
            _beside(choice, BESIDE[name]) / BESIDE[name].unit
            if name in BESIDE
            else np.log(max(values[name], 1e-300))
            for name in self.names
        ]
        return np.asarray(np.clip(point, self.low, self.high), np.float64)

    def limits(self) -> dict[str, Range]:
        """Return the bounds of each of Eq. 22's gains in SI, fixed ones included."""
        found = {name: (value, value) for name, value in self.fixed.gains._asdict().items()}
        for name, low, high in zip(self.names, self.low, self.high, strict=True):
            if name in found:
                found[name] = float(np.exp(low)), float(np.exp(high))
        return found

    def _gains(self, values: dict[str, float]) -> LoopGains:
        derivative = values.pop("k_d_pos", 0.0)
        gains = self.fixed.gains._replace(**values)
        if self.structure in {"p", "pi"}:
            gains = gains._replace(omega=1 / gains.tau, xi=1.0)
        if self.structure == "p":
            gains = gains._replace(k_i_pos=0.0)
        if self.structure == "pid":
            first = 2 * gains.tau * gains.k_p_pos + derivative
            second = gains.tau**2 * gains.k_p_pos + gains.tau * derivative
            omega = float(np.sqrt(gains.k_p_pos / second))
            gains = gains._replace(omega=omega, xi=first * omega / (2 * gains.k_p_pos))
        return gains


def _beside(choice: Choice, variable: Beside) -> float:
    value: float = getattr(getattr(choice, variable.part), variable.name)
    return value


def _derivative_gain(gains: LoopGains) -> float:
    """Return the K_D that is nearest to Eq. 22's gains, from the coefficient of s."""
    first = 2 * gains.xi * gains.k_p_pos / gains.omega
    derivative = first - 2 * gains.tau * gains.k_p_pos
    return derivative if derivative > 0 else 1e-3 * first


def space_of(
    model: LinearModel,
    largest_velocity_gain: float,
    structure: str = "eq22",
    extra: dict[str, Range] | None = None,
) -> Space:
    """Return the space of one structure in the study's bounds, else in wide ones.

    The velocity gain is free below ``largest_velocity_gain`` [N s/m] where requirements beyond
    Eq. 17 may ask for less. Feed-forward is free where the study's objective names it. ``extra``
    bounds replace the study's.
    """
    bounds = {**_default_bounds(model, largest_velocity_gain), **_stated(model), **(extra or {})}
    names = [*_OF_STRUCTURE[structure]]
    if _velocity_gain_is_free(model):
        low = bounds["k_p_vel"][0]
        bounds["k_p_vel"] = (min(low, largest_velocity_gain), largest_velocity_gain)
        names.append("k_p_vel")
    names += model.study.study.objective.turned
    start = model.gains._replace(k_p_vel=largest_velocity_gain)
    values = {name: _middle(bounds[name]) for name in names if bounds[name][0] == bounds[name][1]}
    fixed = start._replace(
        **{name: value for name, value in values.items() if name in start._fields}
    )
    if structure in {"p", "pi"}:
        fixed = fixed._replace(tau=bounds["tau"][0])
    names = [name for name in names if name not in values]
    scaled = np.array([_scaled(name, bounds[name]) for name in names]).reshape(len(names), 2)
    choice = Choice.of(model)._replace(gains=fixed)
    return Space(structure, tuple(names), scaled[:, 0], scaled[:, 1], choice)


def _scaled(name: str, pair: Range) -> Range:
    if name in BESIDE:
        return pair[0] / BESIDE[name].unit, pair[1] / BESIDE[name].unit
    return float(np.log(pair[0])), float(np.log(pair[1]))


def _middle(pair: Range) -> float:
    return 0.5 * (pair[0] + pair[1])


def _velocity_gain_is_free(model: LinearModel) -> bool:
    """Return whether less than the largest velocity gain may do better.

    On the loop as it runs it may: there its own limit is another than Eq. 17's. Around a state
    estimator Eq. 17 sets none.
    """
    asked = model.requirements
    others = any(getattr(asked, name) is not None for name in OTHERS)
    return others or model.estimated or model.study.study.objective.runs


def _default_bounds(model: LinearModel, k_p_vel: float) -> dict[str, Range]:
    """Return a wide box about the velocity crossover.

    τ is at least half a sampling period, below which Tustin's approximation rings.
    """
    crossover = k_p_vel / model.nominal.mass
    half_period = model.period / 2
    wide = {
        "k_p_vel": (_LEAST_SHARE * k_p_vel, k_p_vel),
        "k_p_pos": (0.02 * crossover, 2 * crossover),
        "k_i_pos": (1e-4 * crossover**2, crossover**2),
        "k_d_pos": (1e-4, 2.0),
        "omega": (0.2 * crossover, 20 * crossover),
        "xi": (0.05, 3.0),
        "tau": (half_period, max(10 * half_period, 2 / crossover)),
        **{name: one.bounds(model) for name, one in BESIDE.items()},
    }
    return {name: _declared(name, pair) for name, pair in wide.items()}


_SECTIONS: dict[str, type[Section]] = {
    "gains": Gains,
    "feedforward": Feedforward,
    "estimator": Estimator,
}


def _declared(name: str, pair: Range) -> Range:
    """Return the part of a range within what the parameter's declaration allows."""
    field = BESIDE[name].name if name in BESIDE else name
    section = _SECTIONS[BESIDE[name].part if name in BESIDE else "gains"]
    if field not in section.model_fields:
        return pair
    least, largest = section.bounds_of(field)
    return min(max(pair[0], least), largest), min(max(pair[1], least), largest)


def _stated(model: LinearModel) -> dict[str, Range]:
    """Return the study's bounds; logarithmic scales start just above 0."""
    stated = model.requirements.bounds
    found = {}
    for name in type(stated).model_fields:
        pair = getattr(stated, name)
        if pair is not None:
            found[name] = (max(pair[0], 1e-6 * pair[1]), pair[1])
    return found
