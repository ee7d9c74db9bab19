"""The paper's own frame for a study: the continuous loop, the two inequalities, and no more.

Tuned so, gains look better on paper than they are on the machine: the loop as it runs has filters
and sampling, and hears noise. They stand beside a study's own tuning for comparison, never as its
result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.params.requirements import Objective, Requirements

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy

_CORNERS = 2  # points per range


def has_papers_frame(study: ResolvedStudy) -> bool:
    """Return whether a study is to be tuned in that frame too; it knows no state estimator."""
    return study.study.verification.papers_frame and study.study.estimator.kind == "filters"


def in_papers_frame(study: ResolvedStudy) -> ResolvedStudy:
    """Return a study that asks what the paper asks.

    Its ratios of Eq. 17 and Eq. 21 and its bounds stay; every other requirement goes. Tracking is
    judged on the continuous loop with velocity feed-forward alone, without a measurement path, and
    on the corners of the box, where the paper's sets have their slowest machines; the ratios are
    certified over all of it.
    """
    own = study.study
    asked = own.requirements
    kept = {"velocity_ratio", "position_ratio", "bounds"}
    paper = {
        "requirements": Requirements().model_copy(
            update={name: getattr(asked, name) for name in kept}
        ),
        "objective": Objective(kind="tracking"),
        "model": own.model.model_copy(update={"measurement_path": "none"}),
    }
    box = study.uncertainty
    corners = box.model_copy(update={"points": min(box.points, _CORNERS)})
    return study.model_copy(update={"study": own.model_copy(update=paper), "uncertainty": corners})
