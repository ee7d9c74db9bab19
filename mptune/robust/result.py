"""What a sweep found: frozen, with a status and the plant and frequency responsible."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mptune.certify.result import Grounds
from mptune.errors import Fault, InputError
from mptune.interop import Drawn, Labelled
from mptune.loops.family import derived_time_constants
from mptune.robust.certificates import Certificates, bound_json
from mptune.robust.place import PlantPoint, finite
from mptune.summary import Summarised
from mptune.units import number_beside

if TYPE_CHECKING:
    from collections.abc import Mapping

    from control import FrequencyResponseData

    from mptune.arrays import FloatArray, IntArray
    from mptune.certify.result import Bound
    from mptune.params.controller import Gains
    from mptune.params.packed import Plants
    from mptune.params.study import ResolvedStudy
    from mptune.robust.family import Family
    from mptune.robust.measured import Members
    from mptune.robust.model import LinearModel


class Status(StrEnum):
    """How a condition or a requirement came out."""

    SATISFIED = "satisfied"
    VIOLATED = "violated"
    UNSTABLE = "unstable"  # a premise of the theorem fails: a nominal loop is not stable
    UNDECIDED = "undecided"  # a loop passes through the critical point as far as can be told
    NOT_CONVERGED = "not converged"  # the worst ratio still moved when refinement ended
    NOT_EVALUATED = "not evaluated"  # the study leaves no loop on which it could be checked


@dataclass(frozen=True, repr=False)
class Condition(Summarised):
    """Eq. 17 or Eq. 21 over the family.

    Attributes
    ----------
    name
        ``"velocity"`` (Eq. 17) or ``"position"`` (Eq. 21).
    left, right
        ``(F,)`` envelope of |Δ| over the family, and |(1 + L_N)/L_N|.
    plant
        ``(F,)`` the plant behind each value of the envelope, measured members after the box's.
    plant_ratio
        ``(N,)`` each plant's largest left/right ratio, in the same order.
    allowed
        ``(F,)`` largest ratio that the study allows.
    worst_ratio, at
        Largest ratio over plants and frequencies, and where: that of the certificate, polished,
        where there is one, else the grid's, which can only miss higher values.
    worst_use, worst_use_at
        Largest quotient of ratio and allowed ratio, and where.
    certified
        Attained and guaranteed worst ratio over the box; None where measured responses stand in
        its place.
    grounds
        What the status rests on.
    binding
        Whether the verdict rests on it; False with a state estimator, for which it is information.
    low_frequency_limit
        The worst ratio is the limit of vanishing frequency, |m_min/m − 1|, which no gain changes.
    nominal_stable, poles_equal
        The theorem's premises: the nominal closed loop is stable; nominal and true open loops have
        the same number of unstable poles.
    """

    name: str
    left: FloatArray
    right: FloatArray
    plant: IntArray
    plant_ratio: FloatArray
    allowed: FloatArray
    worst_ratio: float
    at: PlantPoint
    worst_use: float
    worst_use_at: PlantPoint
    low_frequency_limit: bool
    nominal_stable: bool
    poles_equal: bool
    status: Status
    certified: Bound | None = None
    grounds: Grounds = Grounds.GRID
    binding: bool = True

    @property
    def headline(self) -> str:
        """Worst ratio, where it is, and the status."""
        return (
            f"{self.name}: worst ratio {self.worst_ratio:.4g} at {self.at.headline}: "
            f"{self.status}, {self.grounds}"
        )

    @property
    def ratio(self) -> FloatArray:
        """``(F,)``: left over right."""
        return np.asarray(self.left / self.right)

    @property
    def margin(self) -> float:
        """Factor by which the family's error may grow before the condition fails."""
        return 1 / self.worst_ratio if self.worst_ratio > 0 else np.inf

    @property
    def satisfied(self) -> bool:
        """Whether the requirement and the theorem's premises hold."""
        return self.status is Status.SATISFIED

    def json(self) -> dict[str, Any]:
        """Return the verdict in SI, units in the keys."""
        return {
            "worst_ratio": finite(self.worst_ratio),
            "margin": finite(self.margin),
            "satisfied": self.satisfied,
            "status": self.status.value,
            "nominal_stable": self.nominal_stable,
            "poles_equal": self.poles_equal,
            "low_frequency_limit": self.low_frequency_limit,
            "at": self.at.values(),
            "certified": bound_json(self.certified) if self.certified else None,
            "grounds": self.grounds.value,
            "binding": self.binding,
        }


@dataclass(frozen=True)
class Check(Summarised):
    """One requirement of the study.

    Attributes
    ----------
    key
        What programs know it by: the requirement's key in the study, ``"unstable_plants"`` for the
        stability of the true family, which is always asked for.
    label
        What people read.
    limit
        The limit for print.
    found, at
        What was found, and where; None where no plant is responsible.
    grounds
        What the status rests on; None where no family is asked.
    """

    key: str
    label: str
    limit: str
    found: float
    status: Status
    at: PlantPoint | None
    grounds: Grounds | None = None

    @property
    def headline(self) -> str:
        """Limit, what was found, and the status."""
        return f"{self.label} {self.limit}: {self.found_text}, {self.status}"

    @property
    def found_text(self) -> str:
        """What was found, with as many digits as it needs to differ from the limit."""
        return number_beside(self.found, self.limit)

    def json(self) -> dict[str, Any]:
        """Return the requirement in SI; its label as ``name``."""
        return {
            "name": self.label,
            "limit": self.limit,
            "found": finite(self.found),
            "status": self.status.value,
            "at": self.at.values() if self.at else None,
            "grounds": self.grounds.value if self.grounds else None,
        }


@dataclass(frozen=True, repr=False)
class SweepResult(Summarised, Drawn, Labelled):
    """Both conditions and the true family's margins for one set of gains.

    ``plants`` are those of the box; measured ``members`` stand beside or instead of them.
    """

    drawings: ClassVar[Mapping[str, str]] = {
        "panels": "mptune.figures.panels:four_panels",
        "bode": "mptune.figures.bode:bode_plots",
        "nyquist": "mptune.figures.nyquist:nyquist_plots",
        "sensitivity": "mptune.figures.sensitivity:sensitivity_functions",
        "load": "mptune.figures.sensitivity:load_response",
        "certificates": "mptune.figures.certificates:certified_worst_cases",
    }
    dataset: ClassVar[str] = "mptune.robust.store:to_dataset"

    model: LinearModel
    gains: Gains
    omega: FloatArray
    velocity: Condition
    position: Condition
    families: tuple[Family, ...]  # without and with the measurement path
    sampled: Family | None  # as it runs; None where some delay leaves no room for the hold
    noise_gain: float  # N/m, rms of F_ref per rms of position noise
    checks: tuple[Check, ...]
    certificates: Certificates | None = None
    noise_force: float = float("nan")  # N, rms of F_ref that all sensors' noise makes

    @property
    def study(self) -> ResolvedStudy:
        """The study that was swept."""
        return self.model.study

    @property
    def plants(self) -> Plants:
        """``(N,)`` the box's plants."""
        return self.model.plants

    @property
    def members(self) -> Members | None:
        """Measured members of the family, if any."""
        return self.model.members

    @property
    def conditions(self) -> tuple[Condition, Condition]:
        """Eq. 17 and Eq. 21."""
        return self.velocity, self.position

    @property
    def satisfied(self) -> bool:
        """Whether every requirement that the study writes is met: half of a verdict."""
        return all(check.status is Status.SATISFIED for check in self.checks)

    @property
    def headline(self) -> str:
        """Study, uncertainty set, and whether every requirement is met."""
        chosen = self.study.uncertainty_name or "default"
        verdict = "every requirement met" if self.satisfied else "not every requirement met"
        return f"Sweep of {self.study.name}, uncertainty {chosen}: {verdict}"

    def family(self, path: str) -> Family:
        """Return the true family with one measurement path.

        Parameters
        ----------
        path
            ``"none"``, ``"filters"`` or ``"estimator"``, or ``"sampled"`` for the loop as it runs.

        Raises
        ------
        InputError
            If there is no such family, as where some delay leaves no room for the hold.
        """
        found = {family.path: family for family in (*self.families, self.sampled) if family}
        if path in found:
            return found[path]
        rule, remedy = "is no measurement path", f"one of {', '.join(found)}"
        if path == "sampled":
            least, half = self.model.explicit.delay.min(), self.model.period / 2
            rule = (
                f"has no hold to run with: the least total delay, {least:g} s, is below {half:g} s"
            )
            remedy = (
                "raise uncertainty.delay_as_it_runs, which holds half a sampling period, or ask "
                f"{remedy}"
            )
        raise InputError(f"sweep of {self.study.name}", Fault("path", repr(path), rule, remedy))

    def to_control(
        self,
        loop: str = "force",
        path: str | None = None,
        plant: PlantPoint | None = None,
        omega: FloatArray | None = None,
    ) -> FrequencyResponseData:
        """Return a loop gain under the swept gains as python-control's object.

        Parameters
        ----------
        loop, path, plant, omega
            As of ``LinearModel.to_control``: ``plant=result.position.at`` is Eq. 21's worst.

        Raises
        ------
        InputError
            As ``LinearModel.to_control``.
        """
        return self.model.to_control(self.gains, loop, path, plant, omega)

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys."""
        values: dict[str, Any] = {}
        for condition in self.conditions:
            values[condition.name] = condition.json()
        values["true_family"] = {family.path: family.json() for family in self.families}
        if self.sampled is not None:
            values["true_family"]["sampled"] = self.sampled.json()
        values |= self.certificates.json() if self.certificates else {"bounds": []}
        values["noise_gain_n_per_m"] = finite(self.noise_gain)
        values["noise_force_n"] = finite(self.noise_force)
        values["requirements"] = [check.json() for check in self.checks]
        values["satisfied"] = self.satisfied
        tau_a, tau_b = derived_time_constants(self.study)  # Eq. 4 and 12, beside the set's own
        values["derived_time_constants"] = {"tau_a_s": list(tau_a), "tau_b_s": list(tau_b)}
        return values
