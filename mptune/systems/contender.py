"""A system to be compared: its literature's controller, others to try, and how each is run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from mptune.params.controller import Feedforward
from mptune.params.pack import pack_feedforward, pack_gains
from mptune.sim.judge import set_figures
from mptune.systems.bench import bench_of
from mptune.systems.digital_valves import run_digital_valves
from mptune.systems.eq22 import pi_gains
from mptune.systems.four_chamber import run_four_chamber
from mptune.systems.load_sensing import run_load_sensing
from mptune.systems.outcome import Outcome

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from mptune.params.controller import Gains
    from mptune.params.study import ResolvedStudy
    from mptune.params.systems import FourChamber, Systems
    from mptune.sim.record import RunRecord
    from mptune.systems.bench import LoadBench, LoadCase

# Position gains [1/s] that are tried where a speed is controlled: steps of a third or less.
POSITION_GAINS = (1.0, 1.3, 1.7, 2.2, 3.0, 4.0, 5.0, 6.5, 8.0, 10.0, 13.0, 17.0)
LITERATURE, ITS_OWN = "literature", "its own"


@dataclass(frozen=True)
class Tuned:
    """A system under one controller.

    Attributes
    ----------
    name
        Whose gains they are, like ``"literature"``.
    gains
        The gains in words.
    run
        Runs a case with the loop's gain times a factor.
    """

    name: str
    gains: str
    run: Callable[[LoadCase, float], Outcome]


@dataclass(frozen=True)
class Contender:
    """A system of the comparison.

    Attributes
    ----------
    key
        Its section in ``[systems]``.
    title
        Its name in print.
    boundary
        Where the boundary of its loss lies.
    literature
        Under its literature's controller; where it is a study's, under that study's own.
    others
        Under the other controllers that the common rule may choose.
    """

    key: str
    title: str
    boundary: str
    literature: Tuned
    others: tuple[Tuned, ...] = ()


_IDEAL_PUMP = "pump power p_S·Q_in; the pump itself is ideal, and costs nothing at rest"
_IDEAL_LINES = "p_HP·Q_HP; what flows into the low line is lost; the lines are ideal"


def contenders(
    study: ResolvedStudy, tuned: Gains | None = None, ahead: Feedforward | None = None
) -> tuple[Contender, ...]:
    """Return the systems that the study's ``[systems]`` names, but for this machine.

    Parameters
    ----------
    study
        The study.
    tuned, ahead
        The tuner's gains and feed-forward, tried on whatever has this machine's outer loops.
    """
    return tuple(_named(study, study.study.systems, tuned, ahead or study.study.feedforward))


def _named(
    study: ResolvedStudy, asked: Systems, tuned: Gains | None, ahead: Feedforward
) -> Iterator[Contender]:
    valve, digital, chambers = asked.load_sensing, asked.digital_valves, asked.four_chamber
    if valve is not None:
        run = partial(_speed_run, study, partial(run_load_sensing, system=valve))
        yield _by_speed("load_sensing", "load sensing, proportional valve", valve.k_x, run)
    if digital is not None:
        run = partial(_speed_run, study, partial(run_digital_valves, system=digital))
        yield _by_speed("digital_valves", "load sensing, digital valves", digital.k_x, run)
    if chambers is not None:
        under = partial(_by_force, study, chambers)
        others = [under("the study's own", study.study.gains, study.study.feedforward)]
        if tuned is not None:
            others.append(under("tuned", tuned, ahead))
        yield Contender(
            "four_chamber",
            "four-chamber cylinder",
            _IDEAL_LINES,
            under(LITERATURE, _of_literature(chambers), Feedforward()),
            tuple(others),
        )


def _by_speed(
    key: str,
    title: str,
    literature: float,
    run: Callable[[float, LoadCase, float], Outcome],
) -> Contender:
    def under(name: str, gain: float) -> Tuned:
        return Tuned(name, f"K_x {gain:g} 1/s", partial(run, gain))

    others = tuple(under("scanned", gain) for gain in POSITION_GAINS)
    return Contender(key, title, _IDEAL_PUMP, under(LITERATURE, literature), others)


def _speed_run(
    study: ResolvedStudy,
    simulate: Callable[[LoadBench, float], tuple[RunRecord, ...]],
    gain: float,
    case: LoadCase,
    factor: float,
) -> Outcome:
    return outcome_of(simulate(bench_of(study, case), factor * gain))


def _by_force(
    study: ResolvedStudy, system: FourChamber, name: str, gains: Gains, feedforward: Feedforward
) -> Tuned:
    ahead = pack_feedforward(feedforward, study.study.controller.fast_sampling_period)

    def run(case: LoadCase, factor: float) -> Outcome:
        packed = pack_gains(gains)
        scaled = packed._replace(k_p_vel=factor * packed.k_p_vel)
        return outcome_of(run_four_chamber(bench_of(study, case), system, scaled, ahead))

    return Tuned(name, gains_text(gains), run)


def _of_literature(system: FourChamber) -> Gains:
    return pi_gains(system.k_p_vel, system.k_p_pos, system.k_i_pos)


def gains_text(gains: Gains) -> str:
    """Return the gains of Eq. 18 and Eq. 22 in a line."""
    return (
        f"K_P,vel {gains.k_p_vel / 1e3:.4g} kN s/m, K_P,pos {gains.k_p_pos:.3g} 1/s, "
        f"K_I,pos {gains.k_i_pos:.3g} 1/s²"
    )


def outcome_of(records: Iterable[RunRecord]) -> Outcome:
    """Return what a run came to; its first set is left out where there are more."""
    kept = tuple(records)
    judged = kept[1:] or kept
    return Outcome(
        sets=tuple(set_figures(record) for record in judged),
        record=kept[-1],
        broken=next((record.broken[0].name for record in kept if record.broken), ""),
    )
