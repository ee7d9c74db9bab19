"""Gains of another frame on a study's machines: a comparison beside its own before and after."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from mptune.strict import strict
from mptune.summary import Summarised
from mptune.verify.before_after import Mark, changes, in_a_sentence, named

if TYPE_CHECKING:
    from mptune.params.controller import Gains
    from mptune.verify.before_after import Change
    from mptune.verify.result import VerifyResult

_FRAME = (
    "For comparison, tuned in the paper's own frame alone (continuous loop, two ratios, bounds)"
)


@dataclass(frozen=True, repr=False)
class PapersFrame(Summarised):
    """What tuning in the paper's own frame alone comes to, on paper and on the machine.

    Attributes
    ----------
    gains
        What it finds.
    index_before, index
        The linear tracking index there of the study's own gains and of these [s].
    verified
        The study's machines under these gains, with the seeds of its own verification.
    changes
        What is better and what worse on them than under the study's own gains, on the same sets.
    """

    gains: Gains
    index_before: float
    index: float
    verified: VerifyResult
    changes: tuple[Change, ...]

    @property
    def brief(self) -> str:
        """The same in few words: a figure that is worse at one mass is."""
        worst = {one.key: one.mark for one in self.changes if one.mark is Mark.WORSE}
        worse = ", ".join(named(key) for key in worst) or "nothing"
        before, after = (1e3 * index for index in (self.index_before, self.index))
        return (
            "For comparison, the paper's own frame alone: linear tracking index "
            f"{before:.2f} → {after:.2f} ms on paper, worse on the machine in {worse}."
        )

    @property
    def headline(self) -> str:
        """Index on paper, and what the machine says."""
        on_machine = in_a_sentence(self.changes, "those gains")
        before, after = (1e3 * index for index in (self.index_before, self.index))
        return (
            f"{_FRAME}: linear tracking index {before:.2f} → {after:.2f} ms on paper. {on_machine}"
        )

    def json(self) -> dict[str, Any]:
        """Return gains, index on paper, and the machine's changes."""
        return strict(
            {
                "gains": self.gains.model_dump(),
                "tracking_index_before_s": self.index_before,
                "tracking_index_s": self.index,
                "cases": self.verified.json()["cases"],
                "changes": [one.json() for one in self.changes],
                "summary": self.headline,
            }
        )


def beside(
    before: VerifyResult, gains: Gains, index: tuple[float, float], verified: VerifyResult
) -> PapersFrame:
    """Return gains beside a study's own, judged on the movement sets that both have run.

    Parameters
    ----------
    before
        The machines under the study's own gains.
    gains
        The others.
    index
        The linear tracking index before and after, in the frame of the others [s].
    verified
        The same machines with the same seeds under the others, for as many sets or fewer.
    """
    sets = min(len(case.sets) for case in verified.cases)
    first = replace(
        before, cases=tuple(replace(case, sets=case.sets[:sets]) for case in before.cases)
    )
    return PapersFrame(gains, *index, verified, changes(first, verified))
