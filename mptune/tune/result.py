"""What the tuner found: frozen, with a status and what stands in the way where anything does."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar

from mptune.interop import Drawn
from mptune.robust.place import finite
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.estimator import Estimator
    from mptune.robust.place import PlantPoint
    from mptune.robust.result import SweepResult
    from mptune.tune.objective import Figures
    from mptune.tune.velocity import VelocityGain


class TuneStatus(StrEnum):
    """How the tuning came out."""

    OPTIMAL = "optimal"  # every requirement met, first-order stationary: a local optimum
    NOT_CONVERGED = "feasible, not converged"  # met, and the search was still moving
    INFEASIBLE = "infeasible"  # some requirement cannot be met; ``blocking`` says which


@dataclass(frozen=True)
class Concession:
    """How far one requirement would have to give, if all the others stay.

    ``factor`` multiplies the allowed value (divides it, for a margin); NaN where the others alone
    could not be met either.
    """

    requirement: str
    factor: float


@dataclass(frozen=True)
class Blocking:
    """The requirement that stands in the way, and how far it would have to give."""

    requirement: str
    least_found: float
    at: PlantPoint | None
    remedy: str
    reliefs: tuple[Concession, ...] = ()

    def json(self) -> dict[str, Any]:
        """Return the block, as JSON has it."""
        return {
            "requirement": self.requirement,
            "least_found": finite(self.least_found),
            "at": self.at.values() if self.at else None,
            "remedy": self.remedy,
            "reliefs": {one.requirement: finite(one.factor) for one in self.reliefs},
        }


@dataclass(frozen=True)
class Round:
    """One round of tuning on the plants that bind and asking the whole family.

    Attributes
    ----------
    best
        The objective on the plants tuned on, relative to the study's own gains.
    worst
        The largest quotient of found and allowed over the whole family.
    plants
        Number of plants tuned on.
    """

    best: float
    worst: float
    plants: int


@dataclass(frozen=True, repr=False)
class TuneResult(Summarised, Drawn):
    """Tuned gains, with the sweep that judges them over the whole family.

    Attributes
    ----------
    structure
        Structure of the position controller, one of ``mptune.tune.space.STRUCTURES``.
    gains, feedforward, estimator, before, estimator_before
        The tuned gains, feed-forward and estimator, and the study's own gains and estimator.
    figures, figures_before
        Their figures of merit.
    velocity
        What limits the velocity gain.
    sweep
        The verdict over the whole family.
    binding
        The requirements and bounds that the gains lie at.
    rounds
        How the set of binding plants grew.
    evaluations
        Candidates that the search looked at.
    """

    drawings: ClassVar[Mapping[str, str]] = {"panels": "mptune.figures.panels:four_panels"}

    status: TuneStatus
    structure: str
    gains: Gains
    feedforward: Feedforward
    estimator: Estimator
    before: Gains
    estimator_before: Estimator
    figures: Figures
    figures_before: Figures
    velocity: VelocityGain
    sweep: SweepResult
    blocking: Blocking | None
    binding: tuple[str, ...]
    rounds: tuple[Round, ...]
    evaluations: int

    @property
    def headline(self) -> str:
        """The status, and the tracking index before and after."""
        before, after = self.figures_before.tracking, self.figures.tracking
        index = f"tracking index {1e3 * before:.4g} ms before, {1e3 * after:.4g} ms tuned"
        return f"Tuning of {self.sweep.study.name} ({self.structure}): {self.status}, {index}"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return (self.sweep,)

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys; gains keep the study's keys."""
        values = {
            "status": self.status.value,
            "structure": self.structure,
            "gains": self.gains.model_dump(),
            "feedforward": self.feedforward.model_dump(),
            "estimator": self.estimator.model_dump(),
            "gains_before": self.before.model_dump(),
            "velocity_worst_ratio": self.sweep.velocity.worst_ratio,
            "position_worst_ratio": self.sweep.position.worst_ratio,
            "satisfied": self.sweep.satisfied,
            "objective": {
                "before": self.figures_before.json(),
                "after": self.figures.json(),
            },
            "velocity_gain_limited_by": self.velocity.limited_by,
            "binding": list(self.binding),
            "rounds": [
                {"best": one.best, "worst": one.worst, "plants": one.plants} for one in self.rounds
            ],
            "blocking": self.blocking.json() if self.blocking else None,
            "evaluations": self.evaluations,
        }
        return strict(values)
