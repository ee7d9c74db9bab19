"""The search over the weights: four objectives, limits, and a database that survives a kill.

Each trial's sampler is seeded by how many trials are done. A search that was interrupted therefore
goes on exactly as if it had not been.
"""

from __future__ import annotations

import hashlib
import json
import math
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError, OutputError
from mptune.params.gains import version
from mptune.progress import silent
from mptune.weigh.scales import times_the_papers
from mptune.weigh.trial import LIMITS, OBJECTIVES, Trial, Weights

if TYPE_CHECKING:
    from collections.abc import Sequence

    import optuna
    from optuna.trial import FrozenTrial

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.weigh.trial import Bench, Limits

SAMPLERS = ("tpe", "nsga2")
ALSO = ("sampling_period", "tolerances", "common_mode")
_RANGE = 1 / 20, 5.0  # about the study's own weights, logarithmic
_PUBLISHED = {"weight_switching": 100.0, "weight_loss": 80.0, "weight_converter": 2e11}  # Table 2
# What else the decision may weigh; assumed. About these, on another machine so many times as large
# as ``mptune.weigh.scales`` says, is searched where the study gives none.
_TERMS = {"error_width": 2000.0, "weight_common_mode": 3e-4, "weight_compression": 60.0}
_CANDIDATES = 2, 12
_PERIODS = 8  # how many sampling periods above the valve delay are tried, 1 ms apart
_TOLERANCES = 0.5, 2.0  # about the study's own, logarithmic


def open_search(
    bench: Bench, storage: str, *, seed: int = 1, sampler: str = "tpe", also: Sequence[str] = ()
) -> WeightSearch:
    """Open a search in a database, new or as far as it came.

    Parameters
    ----------
    bench
        Where weights are tried.
    storage
        Address of the database, ``sqlite:///file.db`` or any other of optuna's.
    seed, sampler
        What draws the trials: "tpe" or "nsga2".
    also
        What is searched beside the three weights and the terms that the study's decision has:
        "sampling_period", "tolerances", "common_mode".

    Raises
    ------
    InputError
        If optuna is not installed, a word is unknown, or the database cannot be opened.
    """
    try:
        import optuna
    except ImportError as error:
        fault = Fault("", "", "needs the extra `weights`", "pip install 'mptune[weights]'")
        raise InputError("mptune weights", fault) from error
    _check_words("--sampler", [sampler], SAMPLERS)
    _check_words("--also", also, ALSO)
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    settings = {
        "model": bench.study.model_values(),
        "gains": bench.study.study.gains.model_dump(),
        "feedforward": bench.study.study.feedforward.model_dump(),
        "verification": bench.study.study.verification.model_dump(),
        "bench": [list(bench.seeds), bench.sets],
        "search": [seed, sampler, sorted(also)],
        "version": version(),
    }
    text = json.dumps(settings, sort_keys=True)
    name = f"{bench.study.name}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    try:
        study = optuna.create_study(
            study_name=name,
            storage=storage,
            directions=["minimize"] * len(OBJECTIVES),
            load_if_exists=True,
        )
    except Exception as error:  # whatever the database's driver raises
        full = _full(error)
        if full is not None:
            raise full from error
        fault = Fault("", storage, f"cannot be opened: {error}", "give an address as optuna does")
        raise InputError("--storage", fault) from error
    return WeightSearch(bench, study, seed, sampler, tuple(also))


def _full(error: BaseException) -> OutputError | None:
    """Return the error of a disk without room for the database; None where that is not why."""
    cause: BaseException | None = error
    while cause is not None:
        driver = getattr(cause, "orig", None)  # the database driver's own, of SQLAlchemy's
        if getattr(driver, "sqlite_errorname", "") in {"SQLITE_FULL", "SQLITE_IOERR_WRITE"}:
            return _failed(error)
        cause = cause.__cause__
    return None


def _failed(error: BaseException) -> OutputError:
    reason = str(error).partition("\n")[0]  # the rest is SQL
    return OutputError(
        f"the database of the search failed ({reason}); what it holds is kept: free some space "
        "where the disk is full, and run the command again to go on"
    )


def _check_words(where: str, words: Sequence[str], known: Sequence[str]) -> None:
    for word in words:
        if word not in known:
            fault = Fault("", word, "is not known", f"choose among {', '.join(known)}")
            raise InputError(where, fault)


class WeightSearch:
    """A search in its database; made by ``open_search``."""

    def __init__(
        self, bench: Bench, study: optuna.Study, seed: int, sampler: str, also: tuple[str, ...]
    ) -> None:
        self._bench = bench
        self._study = study
        self._seed = seed
        self._sampler = sampler
        self._also = also

    def run(
        self,
        trials: int,
        first: Sequence[Weights],
        limits: Limits,
        progress: Progress = silent,
    ) -> tuple[Trial, ...]:
        """Go on until the database holds so many trials, and return them all.

        Parameters
        ----------
        trials
            How many in all.
        first
            Weights to begin with: the study's own, say.
        limits
            What a usable trial keeps.
        progress
            Told of the stage ``"search, … trials"``.

        Raises
        ------
        OutputError
            If the database fails while the search is under way.
        """
        from optuna.exceptions import StorageInternalError
        from sqlalchemy.exc import SQLAlchemyError

        try:
            return self._run(trials, first, limits, progress)
        except (SQLAlchemyError, StorageInternalError) as error:
            raise _failed(error) from error

    def _run(
        self,
        trials: int,
        first: Sequence[Weights],
        limits: Limits,
        progress: Progress,
    ) -> tuple[Trial, ...]:
        from optuna.trial import TrialState

        for cut_off in self._study.get_trials(states=(TrialState.RUNNING,)):
            self._study.tell(cut_off.number, state=TrialState.FAIL)
        finished = self._finished()
        while len(finished) < trials:
            progress(f"search, {trials} trials", len(finished) / trials)
            self._study.sampler = self._sampler_for(len(finished))
            if len(finished) < len(first):
                self._study.enqueue_trial(self._named(first[len(finished)]), skip_if_exists=True)
            asked = self._study.ask()
            trial = self._bench.tried(self._drawn(asked))
            for name, excess in zip(LIMITS, limits.excesses(trial), strict=True):
                asked.set_constraint(name, excess)
            asked.set_user_attr("weights", trial.weights._asdict())
            asked.set_user_attr("seeds", list(trial.seeds))
            figures = [[_sayable(value) for value in row] for row in trial.figures.tolist()]
            asked.set_user_attr("figures", figures)
            asked.set_user_attr("unstable", trial.unstable)
            self._study.tell(asked, list(trial.objectives))
            finished = self._finished()
        progress(f"search, {trials} trials", 1.0)
        return tuple(_trial_of(one) for one in finished)

    def _finished(self) -> list[FrozenTrial]:
        from optuna.trial import TrialState

        return self._study.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))

    def _sampler_for(self, done: int) -> optuna.samplers.BaseSampler:
        import optuna

        seed = (self._seed * 1_000_003 + done) % 2**32
        if self._sampler == "nsga2":
            return optuna.samplers.NSGAIISampler(population_size=24, seed=seed)
        return optuna.samplers.TPESampler(n_startup_trials=16, multivariate=True, seed=seed)

    def _drawn(self, asked: optuna.Trial) -> Weights:
        """Return the weights that a trial proposes."""
        own = self._bench.study.study
        values: dict[str, Any] = {
            name: asked.suggest_float(name, *_range(self._bench.study, name), log=True)
            for name in (*self._weights(), *self._terms())
        }
        if own.controller.horizon == 2:
            values["candidates"] = asked.suggest_int("candidates", *self._candidate_range())
        if "sampling_period" in self._also:
            tick = own.controller.fast_sampling_period
            ticks = asked.suggest_int("sampling_ticks", *self._tick_range(), step=self._tick_step())
            values["sampling_period"] = ticks * tick
        if "tolerances" in self._also:
            factor = asked.suggest_float("tolerance_factor", *_TOLERANCES, log=True)
            for name in ("position_tolerance_stop", "position_tolerance_start"):
                values[name] = factor * getattr(own.controller, name)
        return Weights(
            **{name: values.get(name, getattr(own.controller, name)) for name in Weights._fields}
        )

    def _weights(self) -> tuple[str, ...]:
        """Return which of the three weights are searched: without converters W_conv is none."""
        converters = self._bench.study.study.converters
        return tuple(name for name in _PUBLISHED if converters or name != "weight_converter")

    def _terms(self) -> tuple[str, ...]:
        """Return the terms of the cost, beside the three weights, that are searched."""
        own = self._bench.study.study.controller
        wanted = {
            "error_width": own.error == "huber",
            "weight_common_mode": own.weight_common_mode > 0 or "common_mode" in self._also,
            "weight_compression": own.force_model == "steady-state",
        }
        return tuple(name for name, searched in wanted.items() if searched)

    def _candidate_range(self) -> tuple[int, int]:
        """Return how many candidates are searched; the study's own number is among them."""
        own = self._bench.study.study.controller.candidates
        return min(_CANDIDATES[0], own), max(_CANDIDATES[1], own)

    def _tick_step(self) -> int:
        return max(round(1e-3 / self._bench.study.study.controller.fast_sampling_period), 1)

    def _tick_range(self) -> tuple[int, int]:
        """Return the sampling periods searched, in ticks; the study's own is among them."""
        own, step = self._bench.study.study, self._tick_step()
        slowest = max(longest for _, longest in own.verification.delay_ranges())
        room = math.ceil(own.controller.ticks - slowest / own.controller.fast_sampling_period) - 1
        low = own.controller.ticks - step * max(room // step, 0)
        return low, low + step * _PERIODS

    def _named(self, weights: Weights) -> dict[str, Any]:
        """Return weights as the parameters of a trial, moved into the ranges where outside."""
        own = self._bench.study.study
        named: dict[str, Any] = {}
        for name in (*self._weights(), *self._terms()):
            low, high = _range(self._bench.study, name)
            named[name] = min(max(getattr(weights, name), low), high)
        if own.controller.horizon == 2:
            named["candidates"] = weights.candidates
        if "sampling_period" in self._also:
            tick = own.controller.fast_sampling_period
            named["sampling_ticks"] = round(weights.sampling_period / tick)
        if "tolerances" in self._also:
            named["tolerance_factor"] = 1.0
        return named


def _range(study: ResolvedStudy, name: str) -> tuple[float, float]:
    centre: float = getattr(study.study.controller, name)
    if centre == 0:
        centre = {**_PUBLISHED, **_TERMS}[name] * times_the_papers(study, name)
    return centre * _RANGE[0], centre * _RANGE[1]


def _sayable(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _trial_of(stored: FrozenTrial) -> Trial:
    import numpy as np

    said = stored.user_attrs
    figures = [[np.nan if value is None else value for value in row] for row in said["figures"]]
    return Trial(
        Weights(**said["weights"]), tuple(said["seeds"]), np.array(figures), said["unstable"]
    )
