"""The closed loop in time: the linear check, and the nonlinear machine beside §7."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.params.paper import (
    MEASURED_FINAL_ERROR,
    MEASURED_FORCE_ERROR,
    MEASURED_INDEX_RANGE,
    MEASURED_LOSS,
    OTHER_SYSTEMS,
)
from mptune.report.blocks import (
    Block,
    Break,
    Cell,
    Chapter,
    Figure,
    Note,
    Prose,
    Row,
    Tabular,
    left,
    right,
    verdict,
    wide,
)
from mptune.report.content.commanded import followed_speeds
from mptune.report.content.kind_of_machine import (
    largest_words,
    loss_source,
    loss_words,
    supply_words,
    valve_state_words,
)
from mptune.sim.merit import TABULATED, merit
from mptune.units import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.report.results import Results
    from mptune.sim.sampled import LinearMove
    from mptune.verify.result import CaseResult, VerifyResult

_INDEX, _FINAL = merit("performance_index_ms"), merit("final_error_mm")
_OF_THE_PAPER = (
    "The paper's figures are of its published gains; here the gains of the first page were used. "
)


def machine_figure(mass: float) -> str:
    """Return the name of the figure of one mass's traces."""
    return f"machine-{mass / 1e3:g}t"


def linear_check(results: Results) -> Chapter | None:
    """Return the sampled linear loop's movement sets."""
    if not results.moves:
        return None
    return Chapter.of(
        "Linear check",
        Prose(
            "The gains on the linear loop as it runs: held over the sampling period, discretised "
            "by Tustin's approximation, with median, filter and Eq. 23 at the fast sampling "
            "period, velocity feed-forward, and the pressure time constants of Eq. 4 and Eq. 12 "
            "at the start position."
        ),
        Figure("The movement set, for each mass the machine with the largest index.", "moves"),
        movement_sets(results.moves_before, results.moves),
        Note(
            "Linear-check index: peak position error over peak velocity. Predicted, without "
            "fitting. Load force carried by the integrator from the start; dead zone and stop "
            "logic left out."
        ),
        new_page=True,
    )


def movement_sets(own: Sequence[LinearMove], moves: Sequence[LinearMove]) -> Tabular:
    """Return the sampled linear loop's index with the study's own gains and with others."""
    rows: list[Row] = [
        [
            f"{case.mass_kg / 1e3:g} t",
            f"{1e3 * case.valve_delay_s:g} ms",
            f"{case.oil_bulk_modulus_pa / 1e6:g} MPa",
            index_text([before]),
            Cell(index_text([case]), "strong" if case.stable else "bad"),
            milliseconds(MEASURED_INDEX_RANGE.get(case.mass_kg)),
        ]
        for case, before in zip(moves, own, strict=True)
    ]
    title = "Linear-check\nindex [ms]"
    index = (f"{title}\nown gains", f"{title}\nthese gains", "Index [ms]\npaper")
    columns = right("Mass", "Delay", "Oil", *index)
    return Tabular("Linear check: sampled loop with its filters", columns, rows)


def nonlinear_machine(results: Results) -> Chapter | None:
    """Return the verified cases, §7's comparison, and the traces of each mass."""
    verified = results.verified
    if verified is None or not verified.cases:
        return None
    traces: list[Block] = []
    study = results.study
    for case in verified.worst_per_mass():
        caption = (
            f"One movement set of the nonlinear machine with {case.mass_kg / 1e3:g} t, the worst "
            f"case of its mass.{valve_state_words(study)}"
        )
        traces += [Break(), Figure(caption, machine_figure(case.mass_kg))]
    table = machines(verified)
    return Chapter.of(
        table.title,
        Prose(
            "The exported gains on the bundled simulator: valves with delays of their own and "
            f"opening ramps, signed orifices, hoses, friction, {supply_words(study)}, sensor "
            "noise, the filters, and the force controller of Eq. 5 to Eq. 10. The first movement "
            "set of each case is left out of the figures."
        ),
        table,
        Note(
            f"Means over the movement sets; {largest_words(study)}. Loss: {loss_words(study)}, per "
            "millimetre of travel. " + busiest_valve(verified)
        ),
        *followed_speeds(verified),
        *_measured(verified).titled(),
        Note(
            (_OF_THE_PAPER if papers_masses(verified) else "")
            + f"Predicted: without fitting. Calibrated: {loss_source(study)}, the force error "
            "through the position noise."
        ),
        *(_other_systems().titled() if papers_masses(verified) else ()),
        *traces,
        new_page=True,
    )


def machines(verified: VerifyResult) -> Tabular:
    """Return each machine's figures and how it came out."""
    rows: list[Row] = [
        [
            f"{case.mass_kg / 1e3:g}",
            f"{case.oil_bulk_modulus_pa / 1e6:g}",
            str(case.seed),
            *(one.text(case.figure(one.key)) for one in TABULATED),
            verdict(_fate(case), good=case.stable),
        ]
        for case in verified.cases
    ]
    columns = [
        *right("Mass\n[t]", "Oil\n[MPa]", "Seed", *(one.title("\n") for one in TABULATED)),
        wide("Status"),
    ]
    return Tabular("The nonlinear machine", columns, rows, keep=False)


def busiest_valve(verified: VerifyResult) -> str:
    """Return how often the valve that switches most does so, per second and per year."""
    per_s = [case.figure("busiest_valve_per_s") for case in verified.cases]
    known = [one for one in per_s if math.isfinite(one)]
    if not known:
        return "Switches of single valves were not counted."
    duty = verified.study.study.verification.duty
    return (
        f"The busiest valve switches up to {number(max(known), 3)} times a second while the "
        f"machine works, {number(verified.busiest_per_year / 1e6, 3)} million times a year at a "
        f"duty of {100 * duty:g} %."
    )


def _fate(case: CaseResult) -> str:
    status = case.status.value
    return f"{status}, {case.broken} from {case.broken_at_s:.1f} s on" if case.broken else status


def _measured(verified: VerifyResult) -> Tabular:
    """Return §7's figures, by mass: the paper's, here, and whether predicted or calibrated."""
    rows: list[Row] = []
    for mass in sorted({case.mass_kg for case in verified.cases}):
        cases = of_mass(verified, mass)
        losses = f"{MEASURED_LOSS[mass]:g}" if mass in MEASURED_LOSS else "—"
        force = f"{MEASURED_FORCE_ERROR:g}" if mass == max(MEASURED_LOSS) else "—"
        index = milliseconds(MEASURED_INDEX_RANGE.get(mass))
        final = f"≤ {MEASURED_FINAL_ERROR:g}" if mass in MEASURED_INDEX_RANGE else "—"
        loss, pump, error = (
            _means(cases, key)
            for key in ("energy_loss_j_per_mm", "pump_loss_j_per_mm", "force_error_integral_kn2s")
        )
        rows += [
            [f"{mass / 1e3:g} t", *texts]
            for texts in (
                (_INDEX.axis.lower(), index, _span(cases, _INDEX.key), _FREE),
                (_FINAL.axis.lower(), final, _span(cases, _FINAL.key, 2), _FREE),
                ("energy loss, mean [J/mm]", losses, loss, _FITTED),
                ("… by pump power, as in §7.1 [J/mm]", losses, pump, _FITTED),
                ("∫ΔF² per set [kN² s]", force, error, _FITTED),
            )
        ]
    columns = [*right("Mass"), wide("Figure"), *right("Paper", "Here"), *left("Kind")]
    beside = papers_masses(verified)
    title = "Beside the paper's measurements (§7)" if beside else "The figures of §7"
    return Tabular(title, columns, rows)


def papers_masses(verified: VerifyResult) -> bool:
    """Return whether any case has a mass that the paper measured; another machine has none."""
    return any(case.mass_kg in MEASURED_LOSS for case in verified.cases)


_FREE, _FITTED = "predicted", "calibrated"


def _other_systems() -> Tabular:
    rows: list[Row] = [
        [one.name, number(one.loss, 3), number(one.force_error, 3), one.where]
        for one in OTHER_SYSTEMS
    ]
    columns = [wide("System"), *right("Loss [J/mm]", "∫ΔF² [kN² s]"), *left("Cited")]
    return Tabular("Other systems that §7 cites", columns, rows)


def of_mass(verified: VerifyResult | None, mass: float) -> list[CaseResult]:
    """Return the verified cases of one mass."""
    return [case for case in (verified.cases if verified else ()) if case.mass_kg == mass]


def index_text(cases: Sequence[LinearMove]) -> str:
    """Return the largest performance index [ms] of linear cases."""
    if not all(case.stable for case in cases):
        return "unstable"
    return _fixed(max(case.performance_index_ms for case in cases))


def milliseconds(pair: tuple[float, float] | None) -> str:
    """Return a range of seconds in milliseconds, without the unit."""
    return f"{1e3 * pair[0]:.1f}–{1e3 * pair[1]:.1f}" if pair else "—"


def _span(cases: list[CaseResult], name: str, digits: int = 1) -> str:
    low = min(case.span(name)[0] for case in cases)
    high = max(case.span(name)[1] for case in cases)
    return "—" if math.isnan(low) else f"{low:.{digits}f}–{high:.{digits}f}"


def _means(cases: list[CaseResult], name: str) -> str:
    means = [case.mean(name) for case in cases]
    return "—" if math.isnan(means[0]) else f"{min(means):.1f}–{max(means):.1f}"


def _fixed(value: float) -> str:
    return "—" if math.isnan(value) else f"{value:.1f}"
