"""The paper's comparison on the study's own load: every system, a table, a figure."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mptune.files import make_folder, write_whole
from mptune.job.leftovers import keep
from mptune.params.gains import read_gains
from mptune.progress import silent
from mptune.systems.compare import compare_systems
from mptune.systems.contender import LITERATURE, Contender, Tuned, contenders, gains_text
from mptune.systems.eq22 import cascade_gains, pid_gains
from mptune.systems.outcome import Outcome
from mptune.verify.verify import Case, run_case

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.systems.bench import Trial
    from mptune.systems.result import SystemsResult

THIS_MACHINE = "this machine, dynamic controller"
_BOUNDARY = "p_HP·Q_HP out of the accumulator; what flows into the tank line is lost (§7.1)"


def systems_study(
    study: ResolvedStudy,
    out: str | Path,
    progress: Progress = silent,
    gains: str | Path | None = None,
) -> tuple[SystemsResult, tuple[Path, ...]]:
    """Compare the study's machine with the systems of its ``[systems]``.

    Parameters
    ----------
    study
        The study.
    out
        Folder for the results.
    progress
        Told of the stages ``"tune"`` and those of ``compare_systems``.
    gains
        A gains file; the tuner finds gains where there is none.

    Raises
    ------
    InputError
        If the gains belong to another model.
    """
    from mptune.figures.style import to_svg
    from mptune.figures.systems import loss_over_index
    from mptune.tune.tuner import tune

    folder = make_folder(Path(out) / study.name)
    if gains is None:
        found = tune(study, progress)
        tuned, ahead = found.gains, found.feedforward
    else:
        file = read_gains(gains, study.hash())
        tuned, ahead = file.gains, file.feedforward
    result = compare_systems(
        study,
        lambda one: (*contenders(one, tuned, ahead), *this_machine(one, tuned, ahead)),
        progress,
    )
    files = (
        write_whole(folder / "systems.svg", to_svg(loss_over_index(result.rows()))),
        keep(folder, "systems", study, result.rows()),
    )
    return result, files


def this_machine(study: ResolvedStudy, tuned: Gains, ahead: Feedforward) -> Iterator[Contender]:
    """Yield this machine: under the study's own gains, and under its literature's outer loops.

    Parameters
    ----------
    study
        The study.
    tuned, ahead
        The tuner's gains and feed-forward, which the common rule may choose.
    """
    own, none = study.study.gains, study.study.feedforward
    best = _under(study, "tuned", tuned, ahead)
    published = _under(study, LITERATURE, own, none)
    yield Contender("this_machine", THIS_MACHINE, _BOUNDARY, published, (best,))
    asked = study.study.systems
    if asked.pid_loop is not None:
        under = _under(study, LITERATURE, pid_gains(asked.pid_loop), none)
        yield Contender("pid_loop", "this machine, PID outer loop", _BOUNDARY, under)
    if asked.cascade_loop is not None:
        under = _under(study, LITERATURE, cascade_gains(asked.cascade_loop), none)
        yield Contender("cascade_loop", "this machine, P + PI outer loops", _BOUNDARY, under)


def _under(study: ResolvedStudy, name: str, gains: Gains, ahead: Feedforward) -> Tuned:
    def run(trial: Trial, factor: float) -> Outcome:
        asked = study.study.verification.model_copy(update={"repeats": trial.repeats})
        short = study.model_copy(
            update={"study": study.study.model_copy(update={"verification": asked})}
        )
        delay = asked.delay_ranges()[0]
        case = Case(trial.mass, delay, trial.oil_bulk_modulus, trial.load_force, trial.seed)
        scaled = gains.model_copy(update={"k_p_vel": factor * gains.k_p_vel})
        found = run_case(short, case, scaled, ahead)
        return Outcome(found.sets, found.record, found.broken)

    return Tuned(name, gains_text(gains), run)
