"""Several studies run one after the other, in one table and one figure beside the paper's figures.

::

    <out>/studies.md, .json, .svg       the table, its rows, and loss over index
    <out>/<study>/studies.json, .svg    the same beside each study, for its next report
    <out>/…                             what ``mptune run`` writes of each
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.job.leftovers import keep
from mptune.job.run import run
from mptune.loops.broken import FORCE
from mptune.progress import silent
from mptune.report.content.studies import OWN, TUNED, compared_studies, markdown
from mptune.robust.place import finite
from mptune.strict import strict

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from mptune.job.result import JobResult
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.robust.result import SweepResult
    from mptune.verify.result import CaseResult, VerifyResult

_MACHINE = (
    "performance_index_ms", "energy_loss_j_per_mm", "force_error_integral_kn2s", "valve_switches",
    "final_error_mm",
)  # fmt: skip


@dataclass(frozen=True)
class StudiesCompared:
    """What several runs found, side by side.

    Attributes
    ----------
    rows
        One per study, set of gains and mass; figures of the machine keep §7's units, what there is
        none of is None.
    runs
        The runs, in the order asked for.
    files
        What was written beside what each run names.
    """

    rows: tuple[dict[str, Any], ...]
    runs: tuple[JobResult, ...]
    files: tuple[Path, ...]

    @property
    def satisfied(self) -> bool:
        """Whether every study's verdict is *met*."""
        return all(one.satisfied for one in self.runs)

    def json(self) -> dict[str, Any]:
        """Return the rows, each study's verdict, and the files."""
        verdicts = {one.study.name: one.judgement.json() for one in self.runs}
        written = (*(path for one in self.runs for path in one.files), *self.files)
        files = [str(path) for path in written]
        return {"rows": list(self.rows), "studies": verdicts, "files": files}


def run_studies(
    studies: Sequence[ResolvedStudy], out: str | Path, progress: Progress = silent
) -> StudiesCompared:
    """Run each study, and leave one table and one figure of all.

    Parameters
    ----------
    studies
        The studies.
    out
        Folder for the results.
    progress
        Told of the stages of each run.

    Raises
    ------
    InputError
        If two studies have one name, so that their results would meet in one folder.
    OutputError
        If results cannot be written.
    """
    _refuse_one_name_for_two(studies)
    from mptune.figures.studies import studies_apart
    from mptune.figures.style import to_svg

    out = make_folder(out)
    runs = tuple(run(study, out, progress) for study in studies)
    rows = [row for one in runs for row in rows_of(one)]
    drawn = to_svg(studies_apart(rows))
    files = [
        write_whole(out / "studies.md", markdown(compared_studies(rows))),
        write_whole(out / "studies.json", json.dumps(rows, indent=1) + "\n"),
        write_whole(out / "studies.svg", drawn),
    ]
    for study in studies:
        folder = make_folder(out / study.name)
        files.append(keep(folder, "studies", study, rows))
        files.append(write_whole(folder / "studies.svg", drawn))
    return StudiesCompared(tuple(rows), runs, tuple(files))


def _refuse_one_name_for_two(studies: Sequence[ResolvedStudy]) -> None:
    for name, count in Counter(one.name for one in studies).items():
        if count > 1:
            rule = "is the name of more than one of them: their results would meet in one folder"
            raise InputError("the studies", Fault("", name, rule, "name each once, or rename one"))


def rows_of(result: JobResult) -> list[dict[str, Any]]:
    """Return the rows of one run: under the study's own gains, and under the tuned ones.

    One row alone for each, without figures of the machine, where it was not run.

    Parameters
    ----------
    result
        What ``run`` returns.
    """
    before, after = result.verified_before, result.verified
    own = [] if after is not None and before is after else [(OWN, result.published, before)]
    rows: list[dict[str, Any]] = []
    for gains, swept, machine in (*own, (TUNED, result.tuned.sweep, after)):
        linear = {"study": result.study.name, "gains": gains, **_linear(swept)}
        masses = list(_by_mass(machine)) or [{"mass_kg": None, "stable": None}]
        rows += [strict({**dict.fromkeys(_MACHINE), **linear, **one}) for one in masses]
    return rows


def _linear(swept: SweepResult) -> dict[str, Any]:
    """Return margins at F_ref as it runs, the disk margin's guaranteed end beside it, and noise."""
    family, proofs = swept.sampled, swept.certificates
    disk = proofs.of("force_reference", "sampled", "disk_margin") if proofs else None
    return {
        "gain_margin": finite(family.worst("gain_margin", FORCE)[0]) if family else None,
        "disk_margin": finite(family.worst("disk_margin", FORCE)[0]) if family else None,
        "disk_margin_guaranteed": finite(disk.bound) if disk else None,
        "noise_force_n": finite(swept.noise_force),
    }


def _by_mass(machine: VerifyResult | None) -> Iterator[dict[str, Any]]:
    """Yield the machine's figures on each mass: means over its cases, of the final error most."""
    cases = machine.cases if machine else ()
    for mass in sorted({case.mass_kg for case in cases}):
        mine = [case for case in cases if case.mass_kg == mass]
        stable = all(case.stable for case in mine)
        figures = {key: _over(key, mine) if stable else None for key in _MACHINE}
        yield {"mass_kg": mass, "stable": stable, **figures}


def _over(key: str, cases: Sequence[CaseResult]) -> float | None:
    found = [case.figure(key) for case in cases]
    return finite(float(max(found) if key == "final_error_mm" else np.mean(found)))
