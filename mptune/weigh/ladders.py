"""What §5.4's order tries of each weight: the paper's machine's, and another's at its own scale."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.weigh.scales import times_the_papers

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy

LADDERS = {  # of the paper's machine, in the order of §5.4
    "weight_converter": tuple(2e9 * 10**k for k in (0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5)),  # N s/m⁶
    "weight_loss": tuple(10.0 * 2**k for k in range(7)),  # N/J
    "weight_switching": tuple(12.5 * 2**k for k in range(7)),  # N
}


def ladder(study: ResolvedStudy, weight: str) -> tuple[float, ...]:
    """Return what is tried of a weight on a study's machine, from the least up.

    Parameters
    ----------
    study
        The study.
    weight
        Its key in ``[controller]``.
    """
    times = times_the_papers(study, weight)
    return tuple(times * rung for rung in LADDERS[weight])
