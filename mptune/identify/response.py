"""A frequency response, wherever it comes from: a sine fit, a spectrum, or a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.interop import frequency_response
from mptune.summary import Summarised

if TYPE_CHECKING:
    import pandas as pd
    from control import FrequencyResponseData

    from mptune.arrays import BoolArray, ComplexArray, FloatArray


@dataclass(frozen=True, repr=False)
class FrequencyResponse(Summarised):
    """Force reference to force, point by point.

    Attributes
    ----------
    omega
        ``(F,)`` frequencies [rad/s], rising.
    response
        ``(F,)`` complex response; NaN where there is none.
    quality
        ``(F,)`` coherence γ² of a spectrum, or 1 − (residual/fitted rms)² of a sine fit: 1 is
        perfect, and the response's relative variance falls as it nears 1. NaN where not known.
    name
        Where it comes from, in words.
    """

    omega: FloatArray
    response: ComplexArray
    quality: FloatArray
    name: str

    @property
    def headline(self) -> str:
        """Where it comes from, and how many points it has."""
        return f"Frequency response of {self.name}: {int(self.valid.sum())} points"

    def to_pandas(self) -> pd.DataFrame:
        """Return magnitude, phase and quality over frequency [rad/s]."""
        import pandas as pd

        columns = {
            "magnitude_db": self.decibels,
            "phase_deg": self.degrees,
            "quality": self.quality,
        }
        return pd.DataFrame(columns, pd.Index(self.omega, name="frequency_rad_s"))

    def to_control(self) -> FrequencyResponseData:
        """Return the valid points as python-control's object.

        Raises
        ------
        InputError
            If python-control is not installed.
        """
        return frequency_response(self.response[self.valid], self.omega[self.valid], self.name)

    @property
    def valid(self) -> BoolArray:
        """``(F,)``: where there is a response."""
        return np.isfinite(self.response)

    @property
    def decibels(self) -> FloatArray:
        """``(F,)``: magnitude [dB]."""
        return np.asarray(20 * np.log10(np.abs(self.response)))

    @property
    def degrees(self) -> FloatArray:
        """``(F,)``: phase, unwrapped over the valid points [°]."""
        phase = np.full(len(self.omega), np.nan)
        phase[self.valid] = np.degrees(np.unwrap(np.angle(self.response[self.valid])))
        return phase
