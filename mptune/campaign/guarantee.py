"""What independent runs say about the probability to fail: Clopper and Pearson's bound.

It holds for the distribution that the runs were drawn from, and for independent draws only: neither
Sobol' points nor a grid allow it.
"""

from __future__ import annotations

from typing import NamedTuple

from mptune.errors import Fault, InputError

_LEAST = 1e-12  # probability that runs are counted for
_FAILURES = (0, 1, 2, 5, 10)  # for which needed runs are listed


class Guarantee(NamedTuple):
    """With a confidence of 1 − ``doubt`` the failure probability is below the one given."""

    runs: int
    failures: int
    failure_probability: float  # ε
    doubt: float  # δ


def guarantee(runs: int, failures: int, doubt: float) -> Guarantee:
    """Return Clopper and Pearson's one-sided upper bound of the failure probability.

    The bound is exact, not asymptotic: whatever the true probability, it is undercut with a
    probability of at most ``doubt``.
    """
    from scipy.stats import beta

    bound = 1.0 if failures >= runs else float(beta.isf(doubt, failures + 1, runs - failures))
    return Guarantee(runs, failures, bound, doubt)


def runs_needed(failure_probability: float, doubt: float, failures: int = 0) -> int:
    """Return the fewest runs that guarantee a failure probability when ``failures`` of them fail.

    Without failures that is the least N with (1 − ε)^N ≤ δ.
    """
    short, enough = failures, failures + 1
    while guarantee(enough, failures, doubt).failure_probability > failure_probability:
        short, enough = enough, 2 * enough
    while enough - short > 1:
        middle = (short + enough) // 2
        if guarantee(middle, failures, doubt).failure_probability > failure_probability:
            short = middle
        else:
            enough = middle
    return enough


def runs_table(failure_probability: float, doubt: float) -> dict[int, int]:
    """Return how many runs are needed when none, or a few, of them fail.

    Raises
    ------
    InputError
        If either number is no probability between 1e-12 and 1.
    """
    numbers = {"EPSILON": failure_probability, "DELTA": doubt}
    faults = [
        Fault(
            name,
            f"{value:g}",
            f"is not between {_LEAST:g} and 1",
            "give probabilities, like 0.01 1e-6; less takes more runs than anybody makes",
        )
        for name, value in numbers.items()
        if not _LEAST <= value < 1
    ]
    if faults:
        raise InputError("--runs-for", *faults)
    return {failures: runs_needed(failure_probability, doubt, failures) for failures in _FAILURES}
