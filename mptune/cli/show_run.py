"""What ``mptune run`` prints: a summary of one screen, or all the details."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from mptune.cli.show import console, new_table, verdict, verified
from mptune.robust.chain import factor_text
from mptune.robust.result import Status
from mptune.robust.tables import EQUATIONS, place_text, undecided_text
from mptune.units import number, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.job.result import JobResult
    from mptune.params.section import Section
    from mptune.sim.sampled import LinearMove


def summary(result: JobResult) -> None:
    """Print what matters of a whole job on one screen: gains, requirements, figures, files."""
    _gains(result)
    _requirements(result)
    _figures(result)
    for text in _mind(result):
        console.print(verdict(text, good=False))
    report = [path for path in result.files if path.suffix in {".pdf", ".html"}]
    gains = [path for path in result.files if path.suffix == ".toml"]
    others = len(result.files) - len(report) - len(gains)
    for path in (*report, *gains):
        console.print(Text(f"wrote {path}"), soft_wrap=True)
    console.print(f"and {others} figures and data files beside; -v lists them and all the details")


def _gains(result: JobResult) -> None:
    tuned = result.tuned
    pairs: list[tuple[Section, Section]] = [(tuned.gains, tuned.before)]
    if tuned.feedforward != tuned.sweep.study.study.feedforward:
        pairs.append((tuned.feedforward, tuned.sweep.study.study.feedforward))
    table = new_table(f"Gains: {tuned.status.value}")
    table.add_column("")
    for heading in ("value", "study's own"):
        table.add_column(heading, justify="right")
    for found, before in pairs:
        for key, unit, mark, _ in found.quantities():
            table.add_row(mark, *(shown(getattr(one, key), unit) for one in (found, before)))
    console.print(table)


def _requirements(result: JobResult) -> None:
    table = new_table("Requirements")
    for heading in ("requirement", "limit", "found", "verdict"):
        table.add_column(heading)
    for check in result.tuned.sweep.checks:
        good = check.status is Status.SATISFIED
        status = verdict(check.status.value, good=good)
        table.add_row(check.label, check.limit, number(check.found), status)
    console.print(table)


def _figures(result: JobResult) -> None:
    for condition in result.tuned.sweep.conditions:
        console.print(
            f"{EQUATIONS[condition.name]}: margin {condition.margin:.3f}, worst at "
            f"{place_text(condition.at)}"
        )
    factors = ", ".join(f"{link.name} {factor_text(link.factor)}" for link in result.chain)
    console.print(f"Gain at F_ref may rise by: {factors}")
    for text in _by_mass(result):
        console.print(text)
    if result.verified is None:
        console.print("The nonlinear machine was not run: the controller refuses these margins.")


def _by_mass(result: JobResult) -> Iterator[str]:
    """Yield the figures of each mass: the worst linear case, and the machine's means."""
    for mass in sorted({case.mass_kg for case in result.moves}):
        pairs = zip(result.moves_before, result.moves, strict=True)
        before, after = zip(*(pair for pair in pairs if pair[1].mass_kg == mass), strict=True)
        text = f"{mass / 1e3:g} t: linear index {_index(before)} → {_index(after)}"
        every = result.verified.cases if result.verified else ()
        cases = [case for case in every if case.mass_kg == mass]
        if cases:
            stable = sum(case.stable for case in cases)
            index = max(case.mean("performance_index_ms") for case in cases)
            loss = max(case.mean("energy_loss_j_per_mm") for case in cases)
            text += (
                f"; machine: {stable} of {len(cases)} stable, index up to {number(index, 3)} ms, "
                f"loss up to {number(loss, 3)} J/mm"
            )
        yield text


def _index(cases: tuple[LinearMove, ...]) -> str:
    if not all(case.stable for case in cases):
        return "unstable"
    return f"{max(case.performance_index_ms for case in cases):.1f} ms"


def _mind(result: JobResult) -> Iterator[str]:
    """Yield what stands in the way, and what the inequalities do not see."""
    blocking, swept = result.tuned.blocking, result.tuned.sweep
    if blocking is not None:
        yield (
            f"Blocked by {blocking.requirement} at {place_text(blocking.at)}: {blocking.remedy}."
        )
    undecided = undecided_text(swept)
    if undecided:
        yield undecided
    for family in swept.families:
        if family.unstable_count:
            path = "with" if family.path == "filters" else "without"
            yield (
                f"{family.unstable_count} of {len(family.stable)} plants are unstable {path} the "
                f"measurement path."
            )


def details(result: JobResult) -> None:
    """Print what the whole job found beyond its tuning."""
    table = new_table("Linear check: sampled loop with its filters")
    for heading in ("mass", "valve delay", "index, study's own gains", "index, tuned"):
        table.add_column(heading, justify="right")
    for case, before in zip(result.moves, result.moves_before, strict=True):
        table.add_row(
            f"{case.mass_kg / 1e3:g} t",
            f"{1e3 * case.valve_delay_s:g} ms",
            *(
                f"{one.performance_index_ms:.1f} ms"
                if one.stable
                else verdict("unstable", good=False)
                for one in (before, case)
            ),
        )
    console.print(table)
    if result.verified is None:
        console.print("The nonlinear machine was not run: the controller refuses these margins.")
    else:
        verified(result.verified)


def outcome(*, met: bool) -> None:
    """Print the last line of a whole job."""
    console.print(
        verdict("Every requirement is met." if met else "Some requirement is not met.", good=met)
    )
