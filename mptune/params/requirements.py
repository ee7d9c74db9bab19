"""What the tuned loops must keep, and what they are tuned for."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, Literal, Self

from pydantic import Field, field_validator, model_validator

from mptune.params.section import Range, Section, quantity, refuse
from mptune.units import UnitError, parse_quantity

RatioCurve = tuple[tuple[float, float], ...]
"""Pairs of frequency [rad/s] and largest allowed ratio, frequencies rising."""


class GainBounds(Section):
    """Smallest and largest value of single gains; a missing one is free within the default."""

    k_p_vel: Range | None = quantity(
        "N s/m", "K_P,vel", "bounds of K_P,vel", None, at_least=1, at_most=1e12
    )
    k_p_pos: Range | None = quantity(
        "1/s", "K_P,pos", "bounds of K_P,pos", None, at_least=0, at_most=1e5
    )
    k_i_pos: Range | None = quantity(
        "1/s^2", "K_I,pos", "bounds of K_I,pos", None, at_least=0, at_most=1e9
    )
    omega: Range | None = quantity("rad/s", "ω", "bounds of ω", None, at_least=0.01, at_most=1e6)
    xi: Range | None = quantity("1", "ξ", "bounds of ξ", None, at_least=0, at_most=1e3)
    tau: Range | None = quantity("s", "τ", "bounds of τ", None, at_least=1e-5, at_most=1)

    @field_validator("k_p_pos")
    @classmethod
    def _some_position_gain(cls, value: Range | None) -> Range | None:
        if value is not None and value[1] == 0:
            refuse("leaves no position controller", "let the upper bound be above 0 1/s")
        return value


class Requirements(Section):
    """The largest allowed left/right ratios of Eq. 17 and 21, and bounds on other figures.

    Those of the simulated machine are judged after it ran; no search of gains asks them.
    """

    velocity_ratio: float | RatioCurve = Field(1.0, description="largest ratio of Eq. 17")
    position_ratio: float | RatioCurve = Field(1.0, description="largest ratio of Eq. 21")
    sensitivity_peak: float | None = quantity("1", "M_S", "largest sensitivity peak", None, above=1)
    complementary_peak: float | None = quantity(
        "1", "M_T", "largest complementary sensitivity peak", None, at_least=1
    )
    gain_margin: float | None = quantity(
        "1", "g_m", "smallest gain margin at F_ref, sampled loop", None, above=1
    )
    sampled_sensitivity_peak: float | None = quantity(
        "1", "M_S", "largest sensitivity peak at F_ref, sampled loop", None, above=1
    )
    disk_margin: float | None = quantity(
        "1", "α", "smallest disk margin at F_ref, sampled loop", None, above=0, at_most=2
    )
    phase_margin: float | None = quantity(
        "rad", "φ_m", "smallest phase margin at F_ref, sampled loop", None, above=0, at_most=math.pi
    )
    delay_margin: float | None = quantity(
        "s", "d_m", "smallest delay margin at F_ref, sampled loop", None, above=0
    )
    peak_compliance: float | None = quantity(
        "m/N", "c", "largest |S|/(mω²) of the sampled loop: position over load force", None, above=0
    )
    overshoot: float | None = quantity(
        "1", "o", "largest overshoot of the sampled loop's position step", None, at_least=0
    )
    settling_time: float | None = quantity(
        "s", "t_s", "longest time of that step until it stays within 2 %", None, above=0
    )
    tracking_index: float | None = quantity(
        "s", "i_t", "largest tracking index on the objective's tracking loop", None, above=0
    )
    noise_gain: float | None = quantity(
        "N/m", "N", "largest noise gain from position to F_ref", None, above=0
    )
    noise_force: float | None = quantity(
        "N", "N_F", "largest rms of F_ref that all sensors' noise makes", None, above=0
    )
    performance_index: float | None = quantity(
        "s", "i", "largest performance index, simulated machine", None, above=0
    )
    final_error: float | None = quantity(
        "m", "e", "largest final position error, simulated machine", None, above=0
    )
    force_error: float | None = quantity(
        "N^2 s", "f", "largest force-error integral of a set, simulated machine", None, above=0
    )
    bounds: GainBounds = GainBounds()

    @field_validator("velocity_ratio", "position_ratio", mode="before")
    @classmethod
    def _ratio(cls, value: Any) -> Any:
        if isinstance(value, list):
            return _curve(value)
        if isinstance(value, bool) or not isinstance(value, int | float):
            refuse("is no ratio", 'give a number, or pairs like [["10 rad/s", 0.7], …]')
        return _checked_ratio(value)


def _curve(pairs: list[Any]) -> RatioCurve:
    if not pairs:
        refuse("is an empty curve", 'give pairs like [["10 rad/s", 0.7], ["100 rad/s", 0.4]]')
    curve = []
    for pair in pairs:
        if not isinstance(pair, list | tuple) or len(pair) != 2 or not isinstance(pair[0], str):
            refuse("is no list of pairs", 'give pairs like [["10 rad/s", 0.7], ["100 rad/s", 0.4]]')
        try:
            frequency = parse_quantity(pair[0], "rad/s")
        except UnitError as error:
            refuse(error.rule, error.remedy)
        if frequency <= 0:
            refuse("has a frequency that is not positive", "give frequencies above 0 rad/s")
        curve.append((frequency, _checked_ratio(pair[1])))
    frequencies = [frequency for frequency, _ in curve]
    if any(a >= b for a, b in pairwise(frequencies)):
        refuse("has frequencies that do not rise", "order the pairs by rising frequency")
    return tuple(curve)


def _checked_ratio(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= 1:
        refuse("is not above 0 and at most 1", "the theorem needs a left/right ratio below 1")
    return float(value)


Kind = Literal["tracking", "disturbance", "load-step", "bandwidth", "robustness"]
Turned = Literal[
    "acceleration_mass", "preview", "reference_lag", "velocity_reference_lag",
    "estimator_bandwidth", "estimator_mass", "position_filter",
]  # fmt: skip
"""What the tuner may turn beside the gains.

Friction is not among it: the linear loop has none, and could not tell what to feed forward. Nor are
the filters of pressures: they serve the decision alone, which the linear loop does not hold.
"""


class Objective(Section):
    """What the tuner improves, on which loop, and with which freedom."""

    kind: Kind | None = Field(None, description="the objective")
    tracking_loop: Literal["continuous", "sampled"] = Field(
        "continuous", description="loop on which tracking is judged: the paper's, or as it runs"
    )
    tracking_plants: Literal["family", "verification"] = Field(
        "family",
        description="machines on which tracking is judged: the family's, or those of "
        "[verification], whose oils give τ_A and τ_B; the latter on the sampled loop",
    )
    free: tuple[Turned, ...] = Field((), description="what the tuner may turn beside the gains")
    free_feedforward: tuple[Turned, ...] = Field((), description="an older name of free")
    then: tuple[Kind, ...] = Field(
        (), description="objectives improved after the first, without giving it up"
    )
    keep: float = quantity(
        "1", "κ", "share of an objective that later ones may cost", 0.01, at_least=0, at_most=1
    )
    tracking: float | None = quantity("1", "w_t", "weight of tracking", None, at_least=0)
    disturbance: float | None = quantity("1", "w_d", "weight of disturbance", None, at_least=0)
    load_step: float | None = quantity("1", "w_l", "weight of the load step", None, at_least=0)
    bandwidth: float | None = quantity("1", "w_b", "weight of bandwidth", None, at_least=0)
    robustness: float | None = quantity("1", "w_r", "weight of the disk margin", None, at_least=0)

    @property
    def turned(self) -> tuple[Turned, ...]:
        """What the tuner may turn beside the gains, under either name."""
        return tuple(dict.fromkeys((*self.free, *self.free_feedforward)))

    @property
    def runs(self) -> bool:
        """Whether any of it is judged on the loop as it runs."""
        return self.robust or self.tracking_loop == "sampled"

    @property
    def robust(self) -> bool:
        """Whether the disk margin is part of it."""
        return self.kind == "robustness" or "robustness" in self.then or bool(self.robustness)

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        weights = (self.tracking, self.disturbance, self.load_step, self.bandwidth, self.robustness)
        weighted = any(weight is not None for weight in weights)
        if weighted == (self.kind is not None):
            refuse("needs either a kind or weights", 'write kind = "tracking", or weights')
        if weighted and not any(weights):
            refuse("has no weight above zero", "give at least one positive weight")
        if self.turned and self.tracking_loop != "sampled":
            refuse(
                "frees feed-forward that only the sampled loop, with its filters, can judge",
                'write tracking_loop = "sampled"',
            )
        if self.tracking_plants == "verification" and self.tracking_loop != "sampled":
            refuse(
                "judges tracking on the machines of [verification], which run sampled",
                'write tracking_loop = "sampled", or tracking_plants = "family"',
            )
        if self.then and self.kind is None:
            refuse("has both weights and an order", "write kind and then, or weights")
        return self
