"""The one place that decides how gains came out: requirements first, then every model that was run.

The paper's inequalities leave the measurement path out, so that gains which meet every written
requirement may still be unstable as they run. The headline says so.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.certify.result import Stability
from mptune.params.headline import Headline
from mptune.robust.chain import GAIN_RESERVE, chain, factor_text
from mptune.robust.result import Status
from mptune.robust.tables import place_text
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mptune.robust.chain import Link
    from mptune.robust.place import PlantPoint
    from mptune.robust.result import Check, SweepResult

_OPEN = {Status.UNDECIDED, Status.NOT_CONVERGED, Status.NOT_EVALUATED}


@dataclass(frozen=True)
class Judgement(Summarised):
    """How gains came out, and why.

    Attributes
    ----------
    word
        The verdict.
    reason
        What it rests on: the requirement or the model that decides, and its figure.
    witness
        The plant that decides; None where none is responsible, or it is a machine, which the reason
        then names.
    """

    word: Headline
    reason: str
    witness: PlantPoint | None = None

    @property
    def met(self) -> bool:
        """Whether the verdict is *met*."""
        return self.word is Headline.MET

    @property
    def line(self) -> str:
        """The verdict with its reason and witness, the first line wherever gains are judged."""
        return f"{self.word}: {self.because}"

    @property
    def because(self) -> str:
        """Reason and witness."""
        return self.reason + (f", at {place_text(self.witness)}" if self.witness else "")

    @property
    def headline(self) -> str:
        """The verdict with its reason."""
        return self.line

    def json(self) -> dict[str, Any]:
        """Return word, reason and witness, as JSON has them beside what was found."""
        return {
            "verdict": self.word.value,
            "verdict_reason": self.reason,
            "witness": self.witness.values() if self.witness else None,
        }


def judge(checks: Iterable[Check], links: Sequence[Link]) -> Judgement:
    """Return how gains came out.

    Parameters
    ----------
    checks
        The requirements that the study writes, the stability of its family among them.
    links
        Every model that was run, with its stability and its gain factor; of a certified factor the
        safe side counts. Those of another reading, which stand beside, do not.
    """
    checks = tuple(checks)
    links = [link for link in links if not link.beside]
    found = (
        _undecided(checks, links) or _violated(checks) or _unstable(links) or _short_of_gain(links)
    )
    return found or _met(links)


def judge_sweep(swept: SweepResult, others: Sequence[Link] = ()) -> Judgement:
    """Return how a sweep's gains came out on every linear model, and on what else was run.

    Parameters
    ----------
    swept
        The sweep of the gains.
    others
        Further models, as the nonlinear machine.
    """
    return judge(swept.checks, (*chain(swept), *others))


def _undecided(checks: Sequence[Check], links: Sequence[Link]) -> Judgement | None:
    for check in checks:
        if check.status in _OPEN:
            return Judgement(Headline.UNDECIDED, check.headline, check.at)
    for link in links:
        if link.stability is Stability.UNDECIDED:
            reason = f"{link.name}: whether it is stable cannot be told"
            return Judgement(Headline.UNDECIDED, reason, link.witness)
    return None


def _violated(checks: Sequence[Check]) -> Judgement | None:
    broken = [check for check in checks if check.status is not Status.SATISFIED]
    if not broken:
        return None
    more = f" (and {len(broken) - 1} more)" if len(broken) > 1 else ""
    return Judgement(Headline.NOT_MET, broken[0].headline + more, broken[0].at)


def _unstable(links: Sequence[Link]) -> Judgement | None:
    for link in links:
        if link.stability is Stability.UNSTABLE:
            reason = f"{link.name}: {link.note or 'not stable as it is'}"
            return Judgement(Headline.ON_PAPER, reason, link.witness or link.at)
    return None


def _short_of_gain(links: Sequence[Link]) -> Judgement | None:
    """Return the verdict on the model with the least gain factor, if that is no reserve."""
    short = [link for link in links if not link.safe >= GAIN_RESERVE]  # NaN is none
    if not short:
        return None
    worst = min(short, key=lambda link: link.safe if link.safe == link.safe else 0.0)
    factor = factor_text(worst.safe)
    reason = f"{worst.name}: gain factor {factor}, below {GAIN_RESERVE:g}"
    return Judgement(Headline.ON_PAPER, reason, worst.at)


def _met(links: Sequence[Link]) -> Judgement:
    reason = "every requirement"
    if links:
        least = min(links, key=lambda link: link.safe)
        reason += f"; the gain at F_ref may rise by {factor_text(least.safe)} ({least.name})"
    return Judgement(Headline.MET, reason)
