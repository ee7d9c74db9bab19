"""What the simulated identification found: Fig. 3's panels, each beside Eq. 11 with its delay."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from mptune.identify.response import FrequencyResponse
from mptune.interop import Drawn, Labelled
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.identify.excitation import Excitation
    from mptune.params.study import ResolvedStudy


class FitStatus(IntEnum):
    """What became of one operating point at one frequency."""

    FITTED = 0
    POOR = 1  # what the fit leaves over has more power than the fit
    OUT_OF_RANGE = 2  # pressures outside p_min … p_max for more than a tenth of the time
    NOT_FINITE = 3


class Band(NamedTuple):
    """How well simulation and theory are to agree over a range of frequencies."""

    low: float  # rad/s, left out
    high: float  # rad/s, included
    decibels: float
    degrees: float


BANDS = (Band(0.0, 40.0, 0.5, 8.0), Band(40.0, 200.0, 2.0, 15.0))
_EDGE = 1.005  # frequencies are moved to whole periods, by less than this: edges are meant so
_MOST = 0.9  # of the fitted points lie within both limits where theory agrees


@dataclass(frozen=True)
class Agreement:
    """One panel's agreement with theory over one band.

    Attributes
    ----------
    band
        The band and its limits.
    median_decibels, median_degrees
        The largest deviation over frequency of the median over the operating points.
    largest_decibels, largest_degrees
        The largest deviation of any point.
    within
        Share of the points, over all frequencies of the band, within both limits.
    """

    band: Band
    median_decibels: float
    median_degrees: float
    largest_decibels: float
    largest_degrees: float
    within: float

    @property
    def satisfied(self) -> bool:
        """Whether most points are within the limits."""
        return self.within >= _MOST


@dataclass(frozen=True, repr=False)
class Panel(Summarised, Drawn):
    """One panel of Fig. 3: all operating points at one position, bulk modulus and valve delay.

    Attributes
    ----------
    position_m, oil_bulk_modulus_pa, valve_delay_s
        What the panel's points have in common.
    tau_a_s, tau_b_s
        Eq. 12's time constants.
    omega
        ``(F,)`` frequencies [rad/s].
    velocity, pressure_a
        ``(N,)`` the operating points [m/s], [Pa].
    skipped
        Points left out because p_B,0 is above p_max.
    response
        ``(N, F)`` force over force reference; NaN where the status is not ``FITTED``.
    quality
        ``(N, F)`` see ``FrequencyResponse``.
    status
        ``(N, F)`` a ``FitStatus`` each.
    theory
        ``(F,)`` G_F e^{−s(T_S/2 + d)}.
    """

    drawings: ClassVar[Mapping[str, str]] = {"bode": "mptune.figures.identification:bode_panels"}

    position_m: float
    oil_bulk_modulus_pa: float
    valve_delay_s: float
    tau_a_s: float
    tau_b_s: float
    omega: FloatArray
    velocity: FloatArray
    pressure_a: FloatArray
    skipped: int
    response: ComplexArray
    quality: FloatArray
    status: IntArray
    theory: ComplexArray

    @property
    def headline(self) -> str:
        """The panel, and whether it agrees with theory."""
        verdict = "agrees" if self.satisfied else "does not agree"
        return f"{self.name}: {verdict} with Eq. 11, {self.failed} of {self.status.size} not valid"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return ((self,),)

    @property
    def name(self) -> str:
        """The panel in words, as Fig. 3 has it."""
        text = f"x = {self.position_m:g} m, B_oil = {self.oil_bulk_modulus_pa / 1e6:g} MPa"
        return text + (f", d = {1e3 * self.valve_delay_s:g} ms" if self.valve_delay_s else "")

    @property
    def decibels(self) -> FloatArray:
        """``(N, F)``: magnitude over theory's [dB]."""
        return np.asarray(20 * np.log10(np.abs(self.response / self.theory)))

    @property
    def degrees(self) -> FloatArray:
        """``(N, F)``: phase less theory's [°]."""
        return np.asarray(np.degrees(np.angle(self.response / self.theory)))

    def count(self, status: FitStatus) -> int:
        """Return the number of fits with a status."""
        return int((self.status == status).sum())

    @property
    def failed(self) -> int:
        """Number of fits that are not valid."""
        return self.status.size - self.count(FitStatus.FITTED)

    def point(self, index: int) -> FrequencyResponse:
        """Return one operating point's response."""
        name = f"{self.name}, v = {self.velocity[index]:g} m/s, "
        name += f"p_A = {self.pressure_a[index] / 1e6:g} MPa"
        return FrequencyResponse(self.omega, self.response[index], self.quality[index], name)

    def agreement(self, band: Band) -> Agreement | None:
        """Return the agreement over a band; None where it holds no fitted point."""
        inside = (self.omega > _EDGE * band.low) & (self.omega <= _EDGE * band.high)
        decibels, degrees = self.decibels[:, inside], self.degrees[:, inside]
        fitted = np.isfinite(decibels)
        if not fitted.any():
            return None
        good = (np.abs(decibels) <= band.decibels) & (np.abs(degrees) <= band.degrees)
        return Agreement(
            band=band,
            median_decibels=largest(over_points(decibels, 50)),
            median_degrees=largest(over_points(degrees, 50)),
            largest_decibels=largest(decibels),
            largest_degrees=largest(degrees),
            within=float(good.sum() / fitted.sum()),
        )

    @property
    def satisfied(self) -> bool:
        """Whether most points of every band that the panel reaches agree with theory."""
        found = [self.agreement(band) for band in BANDS]
        return any(found) and all(one.satisfied for one in found if one is not None)

    def json(self) -> dict[str, Any]:
        """Return the panel in SI, deviations in dB and degrees."""
        values: dict[str, Any] = {
            "position_m": self.position_m,
            "oil_bulk_modulus_pa": self.oil_bulk_modulus_pa,
            "valve_delay_s": self.valve_delay_s,
            "tau_a_s": self.tau_a_s,
            "tau_b_s": self.tau_b_s,
            "points": len(self.velocity),
            "skipped_points": self.skipped,
            "fits": {status.name.lower(): self.count(status) for status in FitStatus},
            "satisfied": self.satisfied,
            "agreement": [_agreement_json(self.agreement(band)) for band in BANDS],
            "frequency_rad_s": self.omega.tolist(),
        }
        for name, deviation in (("db", self.decibels), ("deg", self.degrees)):
            for key, share in (("least", 0), ("median", 50), ("largest", 100)):
                values[f"deviation_{key}_{name}"] = over_points(deviation, share).tolist()
        return strict(values)


def _agreement_json(agreement: Agreement | None) -> dict[str, Any] | None:
    if agreement is None:
        return None
    return {
        "above_rad_s": agreement.band.low,
        "up_to_rad_s": agreement.band.high,
        "limit_db": agreement.band.decibels,
        "limit_deg": agreement.band.degrees,
        "largest_median_db": agreement.median_decibels,
        "largest_median_deg": agreement.median_degrees,
        "largest_db": agreement.largest_decibels,
        "largest_deg": agreement.largest_degrees,
        "share_within": agreement.within,
        "satisfied": agreement.satisfied,
    }


def over_points(values: FloatArray, share: float) -> FloatArray:
    """Return a percentile over the operating points, ``(F,)``; NaN where none is fitted."""
    found = np.full(values.shape[1], np.nan)
    some = np.isfinite(values).any(axis=0)
    found[some] = np.nanpercentile(values[:, some], share, axis=0)
    return found


def largest(values: FloatArray) -> float:
    """Return the value that is farthest from zero, with its sign."""
    fitted = values[np.isfinite(values)]
    return float(fitted[np.argmax(np.abs(fitted))])


@dataclass(frozen=True, repr=False)
class IdentifyResult(Summarised, Drawn, Labelled):
    """All panels of one identification."""

    drawings: ClassVar[Mapping[str, str]] = {"bode": "mptune.figures.identification:bode_panels"}
    dataset: ClassVar[str] = "mptune.identify.store:to_dataset"

    study: ResolvedStudy
    excitation: Excitation
    panels: tuple[Panel, ...]

    @property
    def headline(self) -> str:
        """Study, excitation and verdict."""
        verdict = "agrees" if self.satisfied else "does not agree"
        return f"Identification of {self.study.name}, {self.excitation}: {verdict} with Eq. 11"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return (self.panels,)

    def to_pandas(self) -> pd.DataFrame:
        """Return one row per panel, operating point and frequency, columns as ``to_xarray``."""
        frame: pd.DataFrame = self.to_xarray().to_dataframe()
        return frame

    @property
    def satisfied(self) -> bool:
        """Whether every panel agrees with theory."""
        return all(panel.satisfied for panel in self.panels)

    def json(self) -> dict[str, Any]:
        """Return all panels in SI."""
        return {
            "satisfied": self.satisfied,
            "excitation": self.excitation.value,
            "panels": [panel.json() for panel in self.panels],
        }
