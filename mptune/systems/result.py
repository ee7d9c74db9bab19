"""What the comparison of the systems found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from mptune.interop import Drawn
from mptune.sim.merit import MERITS
from mptune.strict import strict
from mptune.summary import Summarised
from mptune.systems.outcome import INDEX, LOSS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.params.study import ResolvedStudy
    from mptune.systems.outcome import Outcome


@dataclass(frozen=True, repr=False)
class SystemRun(Summarised):
    """One system under one controller with one mass.

    Attributes
    ----------
    key, title, boundary
        Of the system, see ``Contender``.
    controller, gains
        Whose gains, and the gains in words.
    best
        Whether the common rule chose them.
    """

    key: str
    title: str
    boundary: str
    controller: str
    gains: str
    best: bool
    mass_kg: float
    outcome: Outcome

    @property
    def headline(self) -> str:
        """System, controller, mass and the two figures that are compared."""
        found = self.outcome
        return (
            f"{self.title}, {self.controller} gains, {self.mass_kg / 1e3:g} t: index "
            f"{found.mean(INDEX):.4g} ms, loss {found.mean(LOSS):.4g} J/mm"
        )

    def json(self) -> dict[str, Any]:
        """Return the run; figures keep §7's units."""
        found = self.outcome
        return strict(
            {
                "kind": "run",
                "system": self.key,
                "title": self.title,
                "boundary": self.boundary,
                "controller": self.controller,
                "gains": self.gains,
                "best": self.best,
                "mass_kg": self.mass_kg,
                "stable": found.stable,
                "broken": found.broken or None,
                **{one.key: found.figure(one.key) for one in MERITS},
                "reference_index_ms": found.reference_index_ms,
                "returned_j_per_mm": found.returned_j_per_mm,
                "spreads": {key: found.spread(key) for key in (INDEX, LOSS)},
            }
        )


@dataclass(frozen=True, repr=False)
class CalibratedValue(Summarised):
    """A calibrated value of a system, and what loss and index make of changing it.

    Attributes
    ----------
    key, value, unit, source
        In the study, in SI.
    change
        The share by which it was lowered and raised.
    index_ms, loss_j_per_mm
        Lowered, as it is, and raised; NaN where the run was not stable.
    """

    key: str
    value: float
    unit: str
    source: str
    change: float
    index_ms: tuple[float, float, float]
    loss_j_per_mm: tuple[float, float, float]

    @property
    def headline(self) -> str:
        """The value and both figures about it."""
        loss, index = (
            " → ".join(f"{one:.4g}" for one in three)
            for three in (self.loss_j_per_mm, self.index_ms)
        )
        return f"{self.key} ± {100 * self.change:g} %: loss {loss} J/mm, index {index} ms"

    def json(self) -> dict[str, Any]:
        """Return the value in SI; figures keep §7's units."""
        return strict(
            {
                "kind": "calibrated",
                "key": self.key,
                "value": self.value,
                "unit": self.unit,
                "source": self.source,
                "change": self.change,
                "performance_index_ms": self.index_ms,
                "energy_loss_j_per_mm": self.loss_j_per_mm,
            }
        )


@dataclass(frozen=True, repr=False)
class SystemsResult(Summarised, Drawn):
    """All systems, each with its literature's controller and the best one, on every mass."""

    drawings: ClassVar[Mapping[str, str]] = {"systems": "mptune.figures.systems:loss_over_index"}

    study: ResolvedStudy
    runs: tuple[SystemRun, ...]
    calibrated: tuple[CalibratedValue, ...]

    @property
    def headline(self) -> str:
        """How many systems, and how many of their runs are stable."""
        systems = len({run.key for run in self.runs})
        stable = sum(run.outcome.stable for run in self.runs)
        return f"{systems} systems on {self.study.name}: {stable} of {len(self.runs)} runs stable"

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        return (self.rows(),)

    @property
    def satisfied(self) -> bool:
        """Whether every run is stable."""
        return all(run.outcome.stable for run in self.runs)

    def rows(self) -> list[dict[str, Any]]:
        """Return every run and every calibrated value, as JSON has them."""
        return [*(run.json() for run in self.runs), *(one.json() for one in self.calibrated)]

    def json(self) -> dict[str, Any]:
        """Return everything."""
        return {
            "satisfied": self.satisfied,
            "runs": [run.json() for run in self.runs],
            "calibrated": [one.json() for one in self.calibrated],
        }
