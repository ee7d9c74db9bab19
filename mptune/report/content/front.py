"""The verdict page: verdict, what to mind, gains, requirements, and beside what they stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.params.controller import Feedforward
from mptune.params.estimator import Estimator
from mptune.params.headline import Headline
from mptune.report.blocks import (
    Cell,
    Column,
    FrontPage,
    Row,
    Tabular,
    left,
    right,
    symbol,
    verdict,
    wide,
)
from mptune.report.content.before_after import beside_the_paper
from mptune.report.content.tradeoff import controllers
from mptune.robust.result import Status
from mptune.robust.tables import place_text, undecided_text
from mptune.units import number, shown
from mptune.verify.before_after import in_a_sentence
from mptune.verify.checks import machine_checks

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from mptune.params.judged_on import Difference
    from mptune.params.section import Section
    from mptune.params.study import ResolvedStudy
    from mptune.report.results import Results
    from mptune.robust.headline import Judgement
    from mptune.robust.result import Check, SweepResult
    from mptune.tune.result import TuneResult


NOT_RUN = "The nonlinear machine was not run: the requirements are to be met first."
_GROUNDS = (
    "Certified: proved for the whole box; grid only: found on the plants of a grid. "
    "—: rests on no family of plants, or on none of them alone."
)


def front_page(results: Results) -> FrontPage:
    """Return the verdict with its reasons, and the tables of the first page."""
    study, swept, judged = results.study, results.sweep, results.verdict
    words = f"Study {study.name}, uncertainty set {study.uncertainty_name or 'default'}, "
    own, found = study.study, swept.study.study
    tables = (
        gains(
            (swept.gains, results.feedforward, found.estimator),
            (results.published.gains, own.feedforward, own.estimator),
        ),
        requirements((*swept.checks, *_of_machine(results))),
        beside_the_paper(results),
        controllers(results.leftovers.compared).brief(),
    )
    return FrontPage(
        about=[f"{words}measurement path in the model: {study.study.model.measurement_path}"],
        headline=f"Verdict: {judged.word}",
        status=[f"{judged.because[:1].upper()}{judged.because[1:]}.", *_status(results)],
        warnings=[
            *warnings(swept),
            *doubts(study),
            *standing(study),
            *results.leftovers.left_out,
        ],
        blocks=[block for table in tables for block in table.titled()],
    )


def doubts(study: ResolvedStudy) -> list[str]:
    """Return what may be meant otherwise in a study, in one text; none where nothing may."""
    briefs = [f"{one.brief}." for one in study.doubts]
    return [" ".join(briefs)] if briefs else []


def verdict_line(judgement: Judgement) -> str:
    """Return the first line wherever gains are judged."""
    return f"Verdict: {judgement.line}"


def _status(results: Results) -> Iterator[str]:
    if results.tuned is None:
        yield "The study's own gains were swept; nothing was tuned."
    else:
        yield " ".join(tuning(results.tuned))
    if results.changes:
        yield in_a_sentence(results.changes)
    elif results.verified is None and results.verdict.word not in (Headline.MET, Headline.ON_PAPER):
        yield NOT_RUN
    if results.papers_frame is not None:
        yield results.papers_frame.brief


def tuning(tuned: TuneResult) -> list[str]:
    """Return how a tuning came out, what it gained, and what limits it."""
    before, after = tuned.figures_before, tuned.figures
    loop = tuned.sweep.study.study.objective.tracking_loop
    gained = (
        f"Study's own gains → tuned: worst linear tracking index ({loop} loop) "
        f"{1e3 * before.tracking:.2f} → {1e3 * after.tracking:.2f} ms, integral gain "
        f"{before.integral_gain:.3g} → {after.integral_gain:.3g} 1/s², load step "
        f"{1e6 * before.load_step:.3g} → {1e6 * after.load_step:.3g} mm/kN, bandwidth "
        f"{before.bandwidth:.3g} → {after.bandwidth:.3g} rad/s"
    )
    if after.disk_margin == after.disk_margin:  # else no hold fits into some delay
        both = number(before.disk_margin, 3), number(after.disk_margin, 3)
        gained += f", disk margin α as it runs {both[0]} → {both[1]}"
    texts = [f"Tuning: {tuned.status.value}.", f"{gained}."]
    if tuned.binding:
        texts.append(f"The gains lie at: {', '.join(tuned.binding)}.")
    blocking = tuned.blocking
    if blocking is not None:
        texts.append(
            f"Blocked by {blocking.requirement} at {place_text(blocking.at)}: {blocking.remedy}."
        )
        texts += [
            f"With all else kept, {relief.requirement} would have to give by a factor "
            f"{number(relief.factor)}."
            for relief in blocking.reliefs
        ]
    return texts


_MEASURED = {
    "none": "without the measurement path",
    "filters": "with the measurement path",
    "estimator": "with the state estimator",
}


def warnings(swept: SweepResult) -> list[str]:
    """Return what the verdict does not say: undecided, unstable and unevaluated."""
    undecided = undecided_text(swept)
    found = [undecided] if undecided else []
    for family in swept.families:
        if not family.unstable_count:
            continue
        found.append(
            f"{family.unstable_count} of {len(family.stable)} plants are unstable "
            f"{_MEASURED[family.path]}, for instance "
            f"{place_text(family.first_unstable())}."
        )
        if family.path != "none" and swept.study.study.model.measurement_path == "none":
            found[-1] += " Eq. 17 and Eq. 21 as stated leave that path out."
    found += [
        f"{check.label} {check.limit}: cannot be evaluated, as some total delay is below half a "
        "sampling period."
        for check in swept.checks
        if check.status is Status.NOT_EVALUATED
    ]
    return found


def standing(study: ResolvedStudy) -> list[str]:
    """Return that moves cover no distance, where none does: then there is no index."""
    if not all(move.stands for move in study.study.manoeuvre):
        return []
    return ["No move covers any distance: there is no performance index, and no loss per travel."]


def gains(
    found: Sequence[Section], before: Sequence[Section], heading: str = "Study's own"
) -> Tabular:
    """Return gains beside others; feed-forward and estimator where used: the paper has neither."""
    nothing = Feedforward(), Estimator()
    rows: list[Row] = [
        [
            symbol(mark),
            Cell(key, "key"),
            Cell(_shown(getattr(one, key), unit), "strong"),
            _shown(getattr(other, key), unit),
            meaning,
        ]
        for one, other in zip(found, before, strict=True)
        if not (one == other and one in nothing)
        for key, unit, mark, meaning in one.quantities()
        if not (isinstance(one, Estimator) and one.unused(key))
    ]
    key, meaning = Column("Key", detail=True), wide("Meaning", detail=True)
    return Tabular("Gains", [*left("Symbol"), key, *right("Value", heading), meaning], rows)


def _shown(value: float | None, unit: str) -> str:
    return "by default" if value is None else shown(value, unit)


def _of_machine(results: Results) -> tuple[Check, ...]:
    return machine_checks(results.verified) if results.verified else ()


def requirements(checks: Iterable[Check]) -> Tabular:
    """Return the requirements with what was found."""
    rows: list[Row] = [
        [
            check.label,
            check.limit,
            check.found_text,
            verdict(check.status.value, good=check.status is Status.SATISFIED),
            Cell(check.grounds.value if check.grounds else "—", "small"),
            Cell(place_text(check.at), "small"),
        ]
        for check in checks
    ]
    # A requirement on the machine names its case, which is long.
    columns = [wide("Requirement"), *left("Limit"), *right("Found"), *left("Verdict", "Rests on")]
    columns.append(wide("Where", detail=True))
    return Tabular("Requirements", columns, rows, legend=_GROUNDS)


def differs(found: Iterable[Difference], title: str = "Made for another model") -> Tabular:
    """Return in what a model differs from the one that gains were made for."""
    rows: list[Row] = [[Cell(one.key, "key"), one.made_for, one.here] for one in found]
    return Tabular(title, [*left("Key"), wide("In the gains file, SI"), wide("Here, SI")], rows)
