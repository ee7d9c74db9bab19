"""The paper's comparison on the study's own load: every system, a table, a figure.

It takes minutes and is not kept in parts: once interrupted it leaves nothing, and starts anew.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.job.beside import studies_beside
from mptune.job.leftovers import keep
from mptune.params.beside import on_the_load_of
from mptune.params.gains import gains_for
from mptune.progress import silent
from mptune.systems.compare import contest
from mptune.systems.contender import ITS_OWN, LITERATURE, Contender, Tuned, contenders, gains_text
from mptune.systems.eq22 import cascade_gains, pid_gains
from mptune.systems.outcome import Outcome
from mptune.verify.verify import Case, run_case

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.params.controller import Feedforward, Gains
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy
    from mptune.params.systems import SteadyState
    from mptune.progress import Progress
    from mptune.systems.bench import LoadCase
    from mptune.systems.result import SystemsResult

THIS_MACHINE = "this machine"
_LOST = "what flows into the tank line is lost (§7.1)"


@dataclass(frozen=True)
class ComparedSystems:
    """The comparison, and what was left of it.

    Attributes
    ----------
    result
        What was found.
    differs
        In what the model differs from the one that a gains file was made for.
    files
        What was written.
    """

    result: SystemsResult
    differs: tuple[Difference, ...]
    files: tuple[Path, ...]

    def json(self) -> dict[str, Any]:
        """Return the runs, the calibrated values, and what differs."""
        return {**self.result.json(), "differs": [one.json() for one in self.differs]}


def systems_study(
    study: ResolvedStudy,
    out: str | Path,
    progress: Progress = silent,
    gains: str | Path | None = None,
) -> ComparedSystems:
    """Compare the study's machine with other systems; draw it, and leave it for the report.

    Parameters
    ----------
    study
        The study.
    out
        Folder for the results.
    progress
        See ``compare_systems``.
    gains
        A gains file, made for any model with this study's controller; the tuner finds gains where
        there is none.

    Raises
    ------
    InputError
        If the gains are of another controller, or a study beside this one cannot be compared.
    """
    from mptune.figures.style import to_svg
    from mptune.figures.systems import loss_over_index

    file, differs = (None, ()) if gains is None else gains_for(study, gains)
    folder = make_folder(Path(out) / study.name)
    if file is None:
        result = compare_systems(study, progress=progress)
    else:
        chosen = {"estimator": file.estimator or study.study.estimator}
        around = study.model_copy(update={"study": study.study.model_copy(update=chosen)})
        result = compare_systems(around, file.gains, file.feedforward, progress)
    files = (
        write_whole(folder / "systems.svg", to_svg(loss_over_index(result.rows()))),
        keep(folder, "systems", study, result.rows()),
    )
    return ComparedSystems(result, differs, files)


def compare_systems(
    study: ResolvedStudy,
    gains: Gains | None = None,
    feedforward: Feedforward | None = None,
    progress: Progress = silent,
) -> SystemsResult:
    """Compare the study's machine with the systems of its ``[systems]``.

    Each is run with its literature's controller and with the best one by a common rule, on every
    mass of ``[verification]``; what was calibrated is varied. So is the machine of each study that
    ``[systems]`` names beside this one, with its own gains and its own tuner's.

    Parameters
    ----------
    study
        The study.
    gains, feedforward
        What the rule may choose for whatever has this machine's outer loops; the tuner's where
        None.
    progress
        Told of the stages ``"tune"``, ``"best controllers"``, ``"systems"`` and ``"calibrated
        values"``.

    Raises
    ------
    InputError
        If a study beside this one cannot be read, its machine cannot make these moves, or none of
        the moves is to a place.
    """
    from mptune.tune.tuner import tune

    if all(move.kind == "velocity" for move in study.study.manoeuvre):
        rule, remedy = "has no move to a place, whose index is compared", 'add kind = "quintic"'
        raise InputError(study.name, Fault("manoeuvre", "velocity", rule, remedy))
    others = studies_beside(study)
    if gains is None:
        tuned = tune(study, progress)
        study, gains, feedforward = tuned.sweep.study, tuned.gains, tuned.feedforward
    ahead = feedforward or study.study.feedforward
    neighbours: list[Contender] = []
    for other in others:
        theirs = tune(other, progress)  # on its own model, by its own requirements
        key, best = f"beside_{len(neighbours) + 1}", theirs.sweep.study
        neighbours.append(neighbour(key, study, (other, best), theirs.gains, theirs.feedforward))
    return contest(
        study,
        lambda one: (
            *contenders(one, gains, ahead), *this_machine(one, gains, ahead), *neighbours,
        ),
        progress,
    )  # fmt: skip


def this_machine(study: ResolvedStudy, tuned: Gains, ahead: Feedforward) -> Iterator[Contender]:
    """Yield this machine: as the study has it, under other outer loops, and by another decision.

    Parameters
    ----------
    study
        The study.
    tuned, ahead
        The tuner's gains and feed-forward, which the common rule may choose.
    """
    own, none = study.study.gains, study.study.feedforward
    boundary = _boundary(study)
    best = _under(study, "tuned", tuned, ahead)
    published = _under(study, LITERATURE, own, none)
    yield Contender("this_machine", THIS_MACHINE, boundary, published, (best,))
    asked = study.study.systems
    if asked.pid_loop is not None:
        under = _under(study, LITERATURE, pid_gains(asked.pid_loop), none)
        yield Contender("pid_loop", "this machine, PID outer loop", boundary, under)
    if asked.cascade_loop is not None:
        under = _under(study, LITERATURE, cascade_gains(asked.cascade_loop), none)
        yield Contender("cascade_loop", "this machine, P + PI outer loops", boundary, under)
    if asked.steady_state is not None:
        settled = _on_settled_pressures(study, asked.steady_state)
        under = _under(settled, LITERATURE, own, none)
        other = _under(settled, "tuned", tuned, ahead)
        yield Contender("steady_state", "this machine, steady state", boundary, under, (other,))


def _boundary(study: ResolvedStudy) -> str:
    """Return from where on a machine of on/off valves draws power."""
    if study.study.supplies.accumulator_volume > 0:
        return f"p_HP·Q_HP out of the accumulator; {_LOST}"
    return f"p·Q out of all lines but the lowest, as they keep their pressures; {_LOST}"


def neighbour(
    key: str,
    study: ResolvedStudy,
    others: tuple[ResolvedStudy, ResolvedStudy],
    tuned: Gains,
    ahead: Feedforward,
) -> Contender:
    """Return another study's machine under a study's load and moves.

    Parameters
    ----------
    key
        Its key in the comparison.
    study
        Whose load and moves.
    others
        Whose machine, controller and own gains; the same around the tuner's state estimator.
    tuned, ahead
        The gains and the feed-forward of the other's tuner, which the common rule may choose.

    Raises
    ------
    InputError
        If the other's machine cannot make these moves.
    """
    other = others[0]
    moved, around = (on_the_load_of(study, one) for one in others)
    own = _under(moved, ITS_OWN, other.study.gains, other.study.feedforward)
    best = _under(around, "tuned", tuned, ahead)
    return Contender(key, f"study {other.name}", _boundary(other), own, (best,))


def _on_settled_pressures(study: ResolvedStudy, weights: SteadyState) -> ResolvedStudy:
    """Return the study with ref. 16's decision; what its weights do not name stays."""
    controller = study.study.controller.model_copy(
        update={"force_model": "steady-state", **weights.model_dump()}
    )
    return study.model_copy(
        update={"study": study.study.model_copy(update={"controller": controller})}
    )


def _under(study: ResolvedStudy, name: str, gains: Gains, ahead: Feedforward) -> Tuned:
    def run(case: LoadCase, factor: float) -> Outcome:
        asked = study.study.verification.model_copy(update={"repeats": case.repeats})
        short = study.model_copy(
            update={"study": study.study.model_copy(update={"verification": asked})}
        )
        delay = asked.delay_ranges()[0]
        machine = Case(case.mass, delay, case.oil_bulk_modulus, case.load_force, case.seed)
        scaled = gains.model_copy(update={"k_p_vel": factor * gains.k_p_vel})
        found = run_case(short, machine, scaled, ahead)
        return Outcome(found.sets, found.record, found.broken)

    return Tuned(name, gains_text(gains), run)
