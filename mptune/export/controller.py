"""A controller ready to be written, and what every file says of it: its origin and its margins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.params.gains import version
from mptune.params.headline import Headline
from mptune.robust.place import finite
from mptune.units import number_beside

if TYPE_CHECKING:
    from mptune.export.constants import Numbers
    from mptune.export.margins import WrittenMargins
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.gains import GainsFile
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy

WARNING = (
    "WARNING: the margins of these gains are NOT satisfied. They were exported on insistence",
    "(--force). Do not run a machine with them before you know why.",
)
_TOLD = 20  # differences, of however many a gains file may name


@dataclass(frozen=True)
class TargetController:
    """A controller ready to be written in any format.

    Attributes
    ----------
    study
        The study that it belongs to.
    source
        The gains file that it was made from.
    gains, feedforward
        As written: rounded where asked for.
    numbers
        What runs on the target, rounded to its arithmetic.
    margins
        The requirements, checked for exactly these numbers.
    date
        When it was made, UTC.
    differs
        In what the study's model differs from the one that the gains were made for: the margins as
        written hold for the study's, the closed loop's verdict for the other.
    """

    study: ResolvedStudy
    source: GainsFile
    gains: Gains
    feedforward: Feedforward
    numbers: Numbers
    margins: WrittenMargins
    date: str
    differs: tuple[Difference, ...] = ()

    @property
    def trusted(self) -> bool:
        """Whether the margins are satisfied, by the gains file and as written."""
        return self.source.margins == "satisfied" and self.margins.satisfied

    @property
    def verdict(self) -> str:
        """The verdict on the margins of the numbers as written."""
        return "satisfied" if self.trusted else "violated"

    @property
    def word(self) -> Headline:
        """How the controller came out: as written, and as the gains file says."""
        stated = Headline.MET if self.source.margins == "satisfied" else Headline.NOT_MET
        return Headline.first(
            (Headline(self.source.verdict or stated), self.margins.judgement.word)
        )

    @property
    def reason(self) -> str:
        """What that rests on: the numbers as written, else what the gains file says."""
        written = self.margins.judgement
        said = self.source.reason or f"margins {self.source.margins} in the gains file"
        return written.because if written.word is self.word else said

    def provenance(self) -> dict[str, str]:
        """Return study, hash, version and dates."""
        return {
            "study": self.study.name,
            "study_hash": self.study.hash(),
            "uncertainty": self.study.uncertainty_name or "default",
            "version": version(),
            "date": self.date,
            "gains_date": self.source.date,
            "gains_hash": self.source.content_hash(),
            "precision": self.numbers.precision.value,
        }

    def verdicts(self) -> list[dict[str, Any]]:
        """Return every requirement with its limit and what was found."""
        return [
            {
                "requirement": check.label,
                "limit": check.limit,
                "found": finite(check.found),
                "status": check.status.value,
            }
            for check in self.margins.checks
        ]

    def heading(self, title: str) -> list[str]:
        """Return the lines that open every file, without comment marks."""
        lines = [title, ""]
        if not self.trusted:
            lines += [*WARNING, ""]
        lines += [f"{key}: {value}" for key, value in self.provenance().items()]
        lines += [
            "",
            f"verdict: {self.word} ({self.reason})",
            f"margins as written: {self.verdict}",
        ]
        for check in self.margins.checks:
            found = number_beside(check.found, check.limit, 6)
            lines.append(f"  {check.label}: {found} ({check.limit}), {check.status}")
        lines += [f"closed loop on the nonlinear machine: {self.source.closed_loop}"]
        if self.differs:
            lines += ["", "That is the gains file's word, which was made for another model:"]
            lines += [f"  {one.headline}" for one in self.differs[:_TOLD]]
            if len(self.differs) > _TOLD:
                lines.append(f"  and {len(self.differs) - _TOLD} keys more")
        lines += ["", "gains, SI:"]
        for section in (self.gains, self.feedforward):
            for key, unit, symbol, _ in section.quantities():
                value, name = getattr(section, key), unit if unit != "1" else "-"
                lines.append(f"  {key} = {value!r} {name} ({symbol})")
        return lines
