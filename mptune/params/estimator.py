"""What tells the outer loops position and velocity: the paper's filters, or a state estimator."""

from __future__ import annotations

import cmath
import math
from typing import Literal, NamedTuple

from pydantic import Field

from mptune.params.section import Section, quantity


class EstimatorGains(NamedTuple):
    """Corrections by the error of the predicted position, once per T_S,fast."""

    position: float  # -, l_1
    velocity: float  # 1/s, l_2
    load: float  # 1/s², l_3, times m̂: of the load force


class Estimator(Section):
    """The estimator of position, velocity and load force; the paper's filters by default."""

    kind: Literal["filters", "state"] = Field(
        "filters", description="median, position filter and Eq. 23, or a state estimator"
    )
    bandwidth: float = quantity(
        "rad/s", "ω_o", "bandwidth of the state estimator", 40.0, at_least=1, at_most=1e5
    )
    mass: float | None = quantity(
        "kg", "m̂", "mass that the state estimator believes in; the least of the family", None,
        at_least=10, at_most=1e7,
    )  # fmt: skip
    position_filter: float | None = quantity(
        "s", "τ_x", "time constant of the position filter, in the place of the controller's", None,
        at_least=1e-6, at_most=10,
    )  # fmt: skip
    reference_injection: bool = Field(
        default=False,
        description="tell the estimator what its mass and the feed-forward's disagree on",
    )

    def unused(self, key: str) -> bool:
        """Return whether a quantity belongs to the other kind, or is left to the controller."""
        if key == "position_filter":
            return self.kind == "state" or self.position_filter is None
        return self.kind == "filters"


def place_estimator(bandwidth: float, sample_time: float) -> EstimatorGains:
    """Return the gains that put the error's poles on a Butterworth circle.

    The error's dynamics are (I − LC)A with A = [[1, T, −T²/2], [0, 1, −T], [0, 0, 1]] and
    C = [1, 0, 0]; their poles become e^{ω_o T p} with p = −1 and −1/2 ± j√3/2. Comparing the
    coefficients of Π(1 − z_i w) gives the three gains in turn.

    Parameters
    ----------
    bandwidth
        ω_o [rad/s].
    sample_time
        T = T_S,fast [s].
    """
    angle = bandwidth * sample_time
    one = math.exp(-angle)  # the real pole
    pair = cmath.exp(angle * cmath.exp(2j * math.pi / 3))
    twice, square = 2 * pair.real, abs(pair) ** 2
    first, second = -(one + twice), one * twice + square
    position = -math.expm1(-2 * angle)  # 1 − Πz_i, no digits lost
    load = (first + second + position) / sample_time**2
    velocity = (first + 3 - position) / sample_time - load * sample_time / 2
    return EstimatorGains(position, velocity, load)
