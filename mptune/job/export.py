"""A gains file turned into the controller's files, once its margins hold as written."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.export.as_written import rounded_section, written_gains
from mptune.export.c_source import c_sources
from mptune.export.constants import controller_numbers
from mptune.export.controller import TargetController
from mptune.export.formats import Precision, Target
from mptune.export.margins import written_margins
from mptune.export.table import as_json, as_toml
from mptune.files import make_folder, write_whole
from mptune.params.gains import accepted_gains, now, read_gains
from mptune.params.load import load_study
from mptune.progress import silent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.gains import GainsFile
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress


@dataclass(frozen=True)
class ExportResult:
    """What was exported.

    Attributes
    ----------
    controller
        The controller with its margins as written.
    files
        What was written; nothing where writing breaks a requirement that held before.
    """

    controller: TargetController
    files: tuple[Path, ...]

    @property
    def satisfied(self) -> bool:
        """Whether files were written and meet every requirement."""
        return bool(self.files) and self.controller.trusted

    def json(self) -> dict[str, Any]:
        """Return provenance, gains as written, requirements and files."""
        one = self.controller
        return {
            **one.provenance(),
            "verdict": one.word.value,
            "verdict_reason": one.reason,
            "margins": one.verdict,
            "closed_loop": one.source.closed_loop,
            "verdict_in_gains_file": one.source.verdict,
            "differs": [each.json() for each in one.differs],
            "requirements": one.verdicts(),
            "broken_by_writing": [check.label for check in one.margins.broken],
            "gains": one.gains.model_dump(),
            "gains_swept": one.margins.written.gains.model_dump(),
            "feedforward": one.feedforward.model_dump(),
            "satisfied": self.satisfied,
            "files": [str(path) for path in self.files],
        }


def export(
    gains: str | Path,
    to: Target,
    out: str | Path,
    *,
    study: str | Path | None = None,
    overrides: Sequence[str] = (),
    precision: Precision = Precision.DOUBLE,
    digits: int | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> ExportResult:
    """Export a gains file as the controller's files.

    Parameters
    ----------
    gains
        The gains file.
    to
        The format.
    out
        Folder for results; the files go into its folder named after the study.
    study, overrides
        The study's file, searched for where None, and values to replace in it. Its controller must
        be the one that the gains were made for; what else differs is said in every file.
    precision
        Arithmetic of the target.
    digits
        Significant digits of gains and feed-forward; all where None.
    force
        Take gains whose margins are not satisfied.
    progress
        Called with a stage and the share of it that is done.

    Raises
    ------
    InputError
        If gains or study cannot be used.
    MptuneError
        If a function mock-up unit cannot be compiled.
    """
    stated = read_gains(gains)
    loaded = load_study(study or find_study(gains, stated.study), overrides, stated.uncertainty)
    source, differs = accepted_gains(loaded, gains, force=force)
    progress("margins", 0.0)
    controller = prepare(loaded, source, precision, digits, differs)
    if controller.margins.broken:
        return ExportResult(controller, ())
    if not controller.trusted and not force:
        fault = Fault(
            "margins",
            controller.verdict,
            f"is what the numbers come to as written ({controller.word}: {controller.reason})",
            "tune again, or insist with --force",
        )
        raise InputError(gains, fault)
    progress(to, 0.0)
    folder = make_folder(Path(out) / loaded.name)
    return ExportResult(controller, _write(controller, to, folder))


def find_study(gains: str | Path, name: str) -> Path:
    """Return the study file of a gains file: beside it, or under ``studies`` here or above.

    Raises
    ------
    InputError
        If there is none.
    """
    beside = Path(gains).resolve().parent
    places = [beside / "study.toml"]
    plain = file_name(name) == name  # else no path of it: no folder above, no byte of zero
    for start in (beside, Path.cwd()) if plain else ():
        places += [folder / "studies" / name / "study.toml" for folder in (start, *start.parents)]
    for place in places:
        if place.is_file():
            return place
    fault = Fault(
        "study",
        repr(name),
        "has no file studies/…/study.toml here or above",
        "name it with --study",
    )
    raise InputError(gains, fault)


def prepare(
    study: ResolvedStudy,
    source: GainsFile,
    precision: Precision,
    digits: int | None = None,
    differs: tuple[Difference, ...] = (),
) -> TargetController:
    """Return the controller as it will be written, its margins computed for those very numbers."""
    study = source.put_over(study)
    gains = rounded_section(source.gains, digits)
    feedforward = rounded_section(source.feedforward, digits)
    numbers = controller_numbers(study, gains, feedforward, precision)
    margins = written_margins(study, source.gains, written_gains(numbers, gains))
    return TargetController(study, source, gains, feedforward, numbers, margins, now(), differs)


def _write(controller: TargetController, to: Target, folder: Path) -> tuple[Path, ...]:
    if to is Target.FMU:
        from mptune.export.fmu import write_units

        return write_units(controller, folder)
    if to is Target.C:
        place = make_folder(folder / "c")
        return tuple(
            write_whole(place / name, text) for name, text in c_sources(controller).items()
        )
    if to is Target.ST:
        from mptune.export.structured_text import structured_text

        return (write_whole(folder / "controller.st", structured_text(controller)),)
    text = as_toml(controller) if to is Target.TOML else as_json(controller)
    return (write_whole(folder / f"controller.{to}", text),)
