"""What was fitted to a frequency response: values, confidence, and how far both may be trusted."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.arrays import FloatArray

NAMES = ("tau_a", "tau_b", "delay")


class Certainty(StrEnum):
    """How far a response determines the parameters."""

    DETERMINED = "determined"
    ORDER_UNKNOWN = "order of τ_A and τ_B not determined"
    ILL_DETERMINED = "ill determined"
    NOT_CONVERGED = "not converged"


class Interval(NamedTuple):
    """A parameter's value and the ends of its 95 % confidence interval [s]."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, repr=False)
class Fit(Summarised):
    """G_F and dead time fitted to one response.

    Attributes
    ----------
    name
        The response's.
    tau_a, tau_b, delay
        Values and 95 % intervals [s]. The delay is all of the response's dead time.
    covariance
        ``(3, 3)`` of τ_A, τ_B and delay about the value [s²].
    points
        Points fitted.
    error
        Rms of |G_measured/G_fitted − 1|.
    weakest
        The combination of the three that is known least, in words, with its linear half width.
    certainty
        Whether the response determines them.
    either_order_determined
        Whether it would if it were known which lag is which side's, whichever that is.
    """

    name: str
    tau_a: Interval
    tau_b: Interval
    delay: Interval
    covariance: FloatArray
    points: int
    error: float
    weakest: str
    certainty: Certainty
    either_order_determined: bool = False

    @property
    def good(self) -> bool:
        """Whether the intervals say enough.

        Which lag is which side's may stay open, as no study needs it: the intervals then hold both
        orders, however far the lags are apart, and each order by itself must be as well determined
        as the only one must be elsewhere.
        """
        if self.certainty is Certainty.ORDER_UNKNOWN:
            return self.either_order_determined
        return self.certainty is Certainty.DETERMINED

    @property
    def headline(self) -> str:
        """The response, the three values and how far they are determined."""
        found = ", ".join(f"{name} {1e3 * getattr(self, name).value:.4g} ms" for name in NAMES)
        return f"Fit of {self.name}: {found}; {self.certainty}"

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        values: dict[str, Any] = {f"{name}_s": getattr(self, name)._asdict() for name in NAMES}
        said = {
            "name": self.name,
            **values,
            "points": self.points,
            "relative_error": self.error,
            "weakest": self.weakest,
            "certainty": self.certainty.value,
        }
        return strict(said)
