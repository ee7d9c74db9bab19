"""One set of weights tried on the simulator: the figures that §5.4 weighs against each other."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.campaign.simulate import FIGURES, figures_of
from mptune.summary import Summarised
from mptune.verify.result import CaseStatus
from mptune.verify.verify import Case, run_case

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.arrays import FloatArray
    from mptune.campaign.workers import Workers
    from mptune.params.study import ResolvedStudy

OBJECTIVES = (
    "energy_loss_j_per_mm",
    "performance_index_ms",
    "force_error_integral_kn2s",
    "valve_switches",
)
LIMITS = ("stability", "converter travel", "largest pressure", "least pressure")
_CONVERTER_SHARE = 0.9  # of a converter piston's travel: other noise draws it out a little further
_LOST = 1e6  # stands for a figure that a simulation could not give


class Weights(NamedTuple):
    """What is searched, in SI; the names are keys of ``[controller]``."""

    weight_switching: float
    weight_loss: float
    weight_converter: float
    sampling_period: float
    position_tolerance_stop: float
    position_tolerance_start: float
    error_width: float = 2000.0
    candidates: int = 6
    weight_common_mode: float = 0.0
    weight_compression: float = 0.0


def own_weights(study: ResolvedStudy) -> Weights:
    """Return what the study says itself."""
    return Weights(*(getattr(study.study.controller, name) for name in Weights._fields))


def with_weights(study: ResolvedStudy, weights: Weights) -> ResolvedStudy:
    """Return the study with other weights."""
    controller = study.study.controller.model_copy(update=weights._asdict())
    return study.model_copy(
        update={"study": study.study.model_copy(update={"controller": controller})}
    )


@dataclass(frozen=True, repr=False)
class Trial(Summarised):
    """The figures of one set of weights.

    Attributes
    ----------
    weights
        What was tried.
    seeds
        Seed of each run, ``(C,)``.
    figures
        ``(C, 12)`` of each run, in the order of ``mptune.campaign.simulate.FIGURES``.
    unstable
        How many runs did not stay stable, a converter piston at its end included.
    """

    weights: Weights
    seeds: tuple[int, ...]
    figures: FloatArray
    unstable: int

    @property
    def headline(self) -> str:
        """The three weights, and how many runs were not stable."""
        weights = self.weights
        found = f"W_sw {weights.weight_switching:.3g}, W_loss {weights.weight_loss:.3g}"
        found += f", W_conv {weights.weight_converter:.3g}"
        return f"Trial of {found}: {self.unstable} of {len(self.seeds)} runs not stable"

    def column(self, figure: str) -> FloatArray:
        """Return one figure of every run, ``(C,)``."""
        values = self.figures[:, FIGURES.index(figure)]
        return np.where(np.isfinite(values), values, _LOST)

    def mean(self, figure: str) -> float:
        """Return one figure's mean over masses and seeds."""
        return float(self.column(figure).mean())

    def spread(self, figure: str) -> float:
        """Return the standard deviation between seeds of a figure's mean over the masses."""
        values, seeds = self.column(figure), np.array(self.seeds)
        return float(np.std([values[seeds == seed].mean() for seed in set(self.seeds)], ddof=1))

    @property
    def objectives(self) -> tuple[float, ...]:
        """What is to be small, in the order of ``OBJECTIVES``."""
        return tuple(self.mean(figure) for figure in OBJECTIVES)

    @property
    def converter_peak(self) -> float:
        """Largest way of a converter piston from its centre [m]; 0 without converters."""
        peaks = np.nan_to_num(self.figures[:, FIGURES.index("converter_peak_mm")])
        lost = ~np.isfinite(self.figures).any(axis=1)
        return 1e-3 * float(np.where(lost, _LOST, peaks).max())


class Bench:
    """Tries weights on the same machines with the same random numbers.

    Parameters
    ----------
    study
        The study; its least and its largest mass are run, at its first valve delay and load and at
        the middle of its oil bulk moduli.
    team
        Who runs it.
    seeds
        Common random numbers: every trial meets the same noise and valve delays.
    sets
        Movement sets per run; of several, the first is left out.
    """

    def __init__(
        self, study: ResolvedStudy, team: Workers, seeds: Sequence[int] = (1, 2), sets: int = 3
    ) -> None:
        asked = study.study.verification
        masses = sorted({min(asked.masses), max(asked.masses)})
        oils = sorted(asked.oil_bulk_moduli)
        fixed = asked.delay_ranges()[0], oils[len(oils) // 2], asked.load_forces[0]
        self.study = study
        self.seeds = tuple(seeds)
        self.sets = sets
        self._team = team
        self._cases = tuple(Case(mass, *fixed, seed) for mass, seed in product(masses, seeds))

    def with_seeds(self, seeds: Sequence[int]) -> Bench:
        """Return the same bench with other random numbers."""
        return Bench(self.study, self._team, seeds, self.sets)

    def tried(self, weights: Weights) -> Trial:
        """Run one set of weights."""
        study = with_weights(self.study, weights)
        tasks = ((study, case, self.sets) for case in self._cases)
        runs = list(self._team.results(judged, tasks))
        return Trial(
            weights,
            tuple(case.seed for case in self._cases),
            np.array([figures for figures, _ in runs]),
            sum(not stable for _, stable in runs),
        )


def judged(study: ResolvedStudy, case: Case, sets: int) -> tuple[FloatArray, bool]:
    """Return the figures of one run with the study's own gains, and whether it was stable."""
    own = study.study
    verification = own.verification.model_copy(update={"repeats": sets})
    asked = study.model_copy(
        update={"study": own.model_copy(update={"verification": verification})}
    )
    result = run_case(asked, case, own.gains, own.feedforward)
    return figures_of(result), result.status is CaseStatus.STABLE


class Limits(NamedTuple):
    """What no trial may exceed: converter ends, and pressures where the study's own keep them.

    The estimator knows no valve delay, so that real pressures pass p_min and p_max briefly. What
    the study's own weights do is therefore allowed to others. As single peaks are chance in a
    chaotic loop, their mean over the runs is what counts.
    """

    converter_travel: float  # m, from the centre
    pressure_min: float  # Pa
    pressure_max: float  # Pa

    def excesses(self, trial: Trial) -> tuple[float, ...]:
        """Return by how much a trial exceeds each of ``LIMITS``; a usable one is never above 0.

        Unstable runs, converter travel [mm], largest and least pressure [MPa].
        """
        low, high = pressures(trial)
        return (
            float(trial.unstable),
            1e3 * (trial.converter_peak - self.converter_travel),
            (high - self.pressure_max) / 1e6,
            (self.pressure_min - low) / 1e6,
        )

    def keeps(self, trial: Trial) -> bool:
        """Return whether a trial may be used."""
        return max(self.excesses(trial)) <= 0


def limits_of(study: ResolvedStudy, own: Trial) -> Limits:
    """Return the limits of a study, given what its own weights do."""
    controller = study.study.controller
    low, high = pressures(own)
    return Limits(
        _CONVERTER_SHARE * study.study.supplies.converter_travel,
        min(controller.pressure_min, low),
        max(controller.pressure_max, high),
    )


def pressures(trial: Trial) -> tuple[float, float]:
    """Return the runs' least and largest chamber pressures [Pa], each a mean over the runs."""
    return 1e6 * trial.mean("pressure_min_mpa"), 1e6 * trial.mean("pressure_max_mpa")
