"""The common rule: which controller is a system's best, whatever the system.

The index measures the controller more than the actuator, so that every system is shown under its
literature's controller and under the best one by one rule: of those that stay stable on every mass
with their loop's gain as it is and times ``systems.gain_margin``, the one with the least worst
index. Few sets are run, and stability is judged by them: more could only find fault, so that the
rule errs on the side of too high a gain, for all systems alike.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from mptune.systems.bench import LoadCase
    from mptune.systems.contender import Contender, Tuned

_SETS = 2  # per run; the first is not judged


def judged(tuned: Tuned, cases: Iterable[LoadCase], margin: float) -> float:
    """Return the worst index over cases [ms]; infinite where some case is not stable.

    Parameters
    ----------
    tuned
        A system under one controller.
    cases
        One per mass.
    margin
        Factor on the loop's gain at which it must be stable as well.
    """
    worst = 0.0
    for case in cases:
        few = case._replace(repeats=_SETS)
        if not tuned.run(few, margin).stable:
            return np.inf
        worst = max(worst, tuned.run(few, 1.0).worth)
    return worst


def candidates(contender: Contender) -> tuple[Tuned, ...]:
    """Return every controller that the rule may choose."""
    return (contender.literature, *contender.others)


def best_of(contender: Contender, worsts: Sequence[float]) -> Tuned | None:
    """Return the controller of least worst index, the first of equals; None where none stands.

    ``worsts`` are those of ``candidates``, in their order.
    """
    least = int(np.argmin(worsts))
    return candidates(contender)[least] if np.isfinite(worsts[least]) else None
