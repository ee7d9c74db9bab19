"""The worst machine inside the box, searched for instead of waited for.

Differential evolution from the box's corners and Sobol' points. Every candidate meets the same
sensor noise, so that machines are compared and not luck; the one found then meets other noise, as
a search keeps what happened to be bad. It may miss the worst machine, which is optimistic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.campaign.draw import Draw
from mptune.campaign.result import draw_json
from mptune.campaign.simulate import FIGURES, Controlled, RunRows, simulate_rows
from mptune.errors import Fault, InputError
from mptune.params.gains import version
from mptune.progress import silent
from mptune.sim.merit import merit

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.campaign.plan import Plan
    from mptune.campaign.workers import Workers
    from mptune.progress import Progress

SEARCH_NOISE = 0  # number of the run whose noise all candidates meet
_OTHER_NOISE = range(1, 9)
_PER_PARAMETER = 8  # candidates of a generation
_BLOCK = 4  # candidates per task
_NO_FIGURE = 1e9  # score of a machine whose simulation left the numbers: worse than any figure


@dataclass(frozen=True)
class WorstMachine:
    """What the search found.

    Attributes
    ----------
    figure, value
        What was searched for, and its worst value found, in §7's unit.
    draw
        The machine.
    status, reason
        How its closed loop behaved, and why it failed; empty where it did not.
    other_noise
        The figure of the same machine under other sensor noise.
    evaluations
        How many machines were simulated.
    """

    figure: str
    value: float
    draw: Draw
    status: str
    reason: str
    other_noise: FloatArray
    evaluations: int

    def json(self) -> dict[str, Any]:
        """Return the machine in SI and its figure."""
        return {
            "satisfied": not self.reason,
            "figure": self.figure,
            "worst": self.value,
            "worst_at": draw_json(self.draw),
            "status": self.status,
            "reason": self.reason,
            "other_noise": self.other_noise.tolist(),
            "evaluations": self.evaluations,
        }


def find_worst(
    plan: Plan,
    figure: str,
    team: Workers,
    evaluations: int = 400,
    progress: Progress = silent,
) -> WorstMachine:
    """Search the campaign's box for the machine with the worst figure.

    Raises
    ------
    InputError
        If the figure is unknown, or no parameter varies.
    """
    from scipy.optimize import differential_evolution

    _check(plan, figure)
    places = plan.box.varying
    size = _PER_PARAMETER * len(places)
    generations = max(math.ceil(evaluations / size) - 1, 1)
    total = (generations + 1) * size
    done = 0

    def scores(candidates: FloatArray) -> FloatArray:
        nonlocal done
        draws = [_inside(plan, candidate) for candidate in candidates.T]
        values = -_badness(figure, _run(plan, draws, [SEARCH_NOISE] * len(draws), team))
        done += len(draws)
        progress("search for the worst", done / total)
        return values

    found = differential_evolution(
        scores,
        [(0.0, 1.0)] * len(places),
        init=_first(len(places), size, plan.study.study.campaign.seed),
        maxiter=generations,
        vectorized=True,
        updating="deferred",
        polish=False,
        tol=0.0,
        rng=plan.study.study.campaign.seed,
    )
    draw = _inside(plan, found.x)
    numbers = [SEARCH_NOISE, *_OTHER_NOISE]
    rows = _run(plan, [draw] * len(numbers), numbers, team)
    values = rows.figures[:, FIGURES.index(figure)]
    return WorstMachine(
        figure, float(values[0]), draw, rows.status[0], rows.reason[0], values[1:], done
    )


def _check(plan: Plan, figure: str) -> None:
    if figure not in FIGURES:
        fault = Fault("", figure, "is no figure", f"choose one of {', '.join(FIGURES)}")
        raise InputError("--worst", fault)
    if not len(plan.box.varying):
        fault = Fault("campaign", "", "has no parameter that varies", "give at least one a range")
        raise InputError(plan.study.name, fault)


def _first(dimensions: int, size: int, seed: int) -> FloatArray:
    """Return the first generation, ``(size, dimensions)``: corners where they fit, then Sobol'."""
    from scipy.stats import qmc

    points = qmc.Sobol(dimensions, rng=seed).random_base2(math.ceil(math.log2(size)))[:size]
    if 2 ** (dimensions + 1) <= size:
        points[: 2**dimensions] = list(product((0.0, 1.0), repeat=dimensions))
    return np.asarray(points, np.float64)


def _inside(plan: Plan, unit: FloatArray) -> Draw:
    values, box = plan.box.low.copy(), plan.box
    values[box.varying] += unit * (box.high - box.low)[box.varying]
    return Draw(*map(float, values))


def _run(plan: Plan, draws: list[Draw], numbers: list[int], team: Workers) -> RunRows:
    """Run each draw under the noise of the run of that number."""
    shared = Controlled(plan.study, plan.gains, plan.feedforward)
    jobs = list(zip(numbers, draws, strict=True))
    tasks = ((shared, jobs[k : k + _BLOCK], version()) for k in range(0, len(jobs), _BLOCK))
    rows = list(team.results(simulate_rows, tasks))
    return RunRows(
        [number for one in rows for number in one.number],
        np.concatenate([one.figures for one in rows]),
        [status for one in rows for status in one.status],
        [reason for one in rows for reason in one.reason],
    )


def _badness(figure: str, rows: RunRows) -> FloatArray:
    values = rows.figures[:, FIGURES.index(figure)]
    badness = merit(figure).badness(values)
    return np.where(np.isfinite(badness), badness, _NO_FIGURE)
