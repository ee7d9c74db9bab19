"""The plan of a campaign: which machine each run simulates, and what makes it this campaign."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.campaign.draw import Draw, box_of
from mptune.errors import Fault, InputError
from mptune.params.gains import version
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.campaign.draw import Box
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy

RUNS, POINTS = 1000, 3  # where the study says nothing
_MOST_RUNS = 10_000_000
_PARAMETERS, _NOISE = 0, 1  # each run's two streams of random numbers


@dataclass(frozen=True, repr=False)
class Plan(Summarised):
    """A campaign before it is run.

    Attributes
    ----------
    study, gains, feedforward
        The machine and its controller.
    box
        Ranges of the parameters.
    points
        ``(R, 16)`` the parameters of every run, in the order of ``Draw``.
    """

    study: ResolvedStudy
    gains: Gains
    feedforward: Feedforward
    box: Box
    points: FloatArray

    @property
    def headline(self) -> str:
        """Study, method and number of runs."""
        return (
            f"Campaign of {self.study.name}, {self.study.study.campaign.method}: {self.runs} runs"
        )

    @property
    def runs(self) -> int:
        """Number of runs, R."""
        return len(self.points)

    @property
    def chunks(self) -> tuple[range, ...]:
        """The runs of each chunk file."""
        size = self.study.study.campaign.chunk
        return tuple(range(k, min(k + size, self.runs)) for k in range(0, self.runs, size))

    def draw(self, index: int) -> Draw:
        """Return the parameters of one run."""
        return Draw(*map(float, self.points[index]))

    def values(self) -> dict[str, Any]:
        """Return all that decides a campaign's results, its version included."""
        study = self.study.study
        return {
            "model": self.study.model_values(),
            "campaign": study.campaign.model_dump(),
            "box": [self.box.low.tolist(), self.box.high.tolist()],
            "start": study.verification.start,
            "gains": self.gains.model_dump(),
            "feedforward": self.feedforward.model_dump(),
            "version": version(),
        }

    def identity(self) -> str:
        """Return the hash that ties chunk files to their campaign."""
        text = json.dumps(self.values(), sort_keys=True, ensure_ascii=True)
        return hashlib.sha256(text.encode()).hexdigest()


def plan_campaign(
    study: ResolvedStudy, gains: Gains | None = None, feedforward: Feedforward | None = None
) -> Plan:
    """Return a study's campaign with the given gains, or the study's own where None.

    Parameters
    ----------
    study
        The study, whose ``[campaign]`` says what varies and how often.
    gains, feedforward
        What controls the machine; the study's own where None.

    Raises
    ------
    InputError
        If a range cannot be simulated, or a grid has more points than can be run.
    """
    box = box_of(study)
    return Plan(
        study=study,
        gains=gains or study.study.gains,
        feedforward=feedforward or study.study.feedforward,
        box=box,
        points=box.low + (box.high - box.low) * _unit_points(study, box),
    )


def _unit_points(study: ResolvedStudy, box: Box) -> FloatArray:
    """Return the runs' places inside the box, ``(R, 16)``, 0 where a parameter is fixed."""
    asked, places = study.study.campaign, box.varying
    if asked.method == "grid":
        return _grid(study, box)
    unit = np.zeros((asked.runs or RUNS, len(box.low)))
    if asked.method == "sobol" and len(places):
        unit[:, places] = _sobol(len(places), len(unit), asked.seed)
    elif len(places):
        for index, row in enumerate(unit):
            row[places] = _stream(asked.seed, index, _PARAMETERS).random(len(places))
    return unit


def _sobol(dimensions: int, runs: int, seed: int) -> FloatArray:
    """Return scrambled Sobol' points; they are balanced best where ``runs`` is a power of 2."""
    from scipy.stats import qmc

    points = qmc.Sobol(dimensions, scramble=True, rng=seed).random_base2(math.ceil(math.log2(runs)))
    return np.asarray(points[:runs], np.float64)


def _grid(study: ResolvedStudy, box: Box) -> FloatArray:
    per_axis = study.study.campaign.points or POINTS
    if per_axis ** len(box.varying) > _MOST_RUNS:
        fault = Fault(
            "campaign.points",
            str(per_axis),
            f"makes a grid of {per_axis}^{len(box.varying)} runs",
            'take fewer points, fewer ranges, or method = "sobol"',
        )
        raise InputError(study.name, fault)
    axes = [
        np.linspace(0, 1, per_axis) if place in box.varying else np.zeros(1)
        for place in range(len(box.low))
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def noise_of(seed: int, index: int) -> np.random.Generator:
    """Return the source of sensor noise of one run: the same wherever and whenever it is run."""
    return _stream(seed, index, _NOISE)


def _stream(seed: int, *key: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
