"""The gains that written numbers stand for: rounded, discretised, in single precision.

What runs on the target are the coefficients of Tustin's approximation, not the gains. They are
turned back into gains here, so that margins can be computed for exactly what was written.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from pydantic import ValidationError

from mptune.params.controller import Gains
from mptune.params.pack import pack_gains
from mptune.params.section import Section
from mptune.signals.tustin import DiscreteController, discretise

if TYPE_CHECKING:
    from mptune.arrays import ComplexArray
    from mptune.export.constants import Numbers
    from mptune.params.study import ResolvedStudy

_LOWEST = (
    1e-2  # rad/s, from where coefficients and gains are compared, up to half the sampling rate
)
_FREQUENCIES = 400


@dataclass(frozen=True)
class Written:
    """What the written numbers amount to.

    Attributes
    ----------
    gains
        The gains whose discretisation they are.
    position_filter
        The time constant of the written position filter [s].
    deviation
        Largest relative deviation of the written position controller from that of the gains, over
        frequency: single precision splits the double pole of Eq. 22, which no gains can say.
    """

    gains: Gains
    position_filter: float
    deviation: float

    def study(self, study: ResolvedStudy) -> ResolvedStudy:
        """Return the study with the position filter as written."""
        estimator = study.study.estimator.model_copy(
            update={"position_filter": self.position_filter}
        )
        return study.model_copy(
            update={"study": study.study.model_copy(update={"estimator": estimator})}
        )


_Part = TypeVar("_Part", bound=Section)


def rounded_section(section: _Part, digits: int | None) -> _Part:
    """Return gains or feed-forward, each number to so many significant digits; None leaves them."""
    if digits is None:
        return section
    values = section.model_dump()
    for key, *_ in section.quantities():
        values[key] = float(f"{values[key]:.{digits - 1}e}")
    return type(section).model_validate(values, context={"si": True})


def written_gains(numbers: Numbers, intended: Gains) -> Written:
    """Return the gains that the numbers stand for, by Tustin's approximation read backwards.

    Parameters
    ----------
    numbers
        As they are written.
    intended
        Gains that they were made from: they stand in where the numbers say nothing, as they do of
        ω and ξ where K_P,pos is zero.
    """
    period = numbers.value("sampling_period")
    keys = ("b0", "b1", "b2", "a1", "a2", "integral_rate")
    law = DiscreteController(*(numbers.value(key) for key in keys))
    c = 2 / period
    half = law.a1 / 2
    lag = (1 - half) / (1 + half)
    total, alternating = law.b0 + law.b1 + law.b2, law.b0 - law.b1 + law.b2
    values = intended.model_dump() | {
        "k_p_vel": numbers.value("k_p_vel"),
        "k_p_pos": total / (1 + law.a1 + law.a2),
        "k_i_pos": 2 * law.integral / period,
        "tau": lag / c,
    }
    if total > 0 and alternating > 0:
        ratio = math.sqrt(alternating / total)
        values |= {"omega": c / ratio, "xi": (law.b0 - law.b2) / (total * ratio)}
    try:
        gains = Gains.model_validate(values, context={"si": True})
    except ValidationError:
        gains = intended  # the deviation says how far that is off
    return Written(gains, _filter_time(numbers), _deviation(law, gains, period))


def _filter_time(numbers: Numbers) -> float:
    return -numbers.value("sample_time") / math.log(numbers.value("position_pole"))


def _deviation(law: DiscreteController, gains: Gains, period: float) -> float:
    omega = np.geomspace(_LOWEST, math.pi / period, _FREQUENCIES, endpoint=False)
    z = np.exp(1j * omega * period)
    meant = _response(DiscreteController(*discretise(pack_gains(gains), period)), z)
    if not meant.any():
        return 0.0  # no position controller at all
    return float(np.abs(_response(law, z) / meant - 1).max())


def _response(law: DiscreteController, z: ComplexArray) -> ComplexArray:
    """Return Eq. 22 as discretised, at z."""
    section = (law.b0 * z**2 + law.b1 * z + law.b2) / (z**2 + law.a1 * z + law.a2)
    return np.asarray(section + law.integral * (z + 1) / (z - 1))
