"""Runs of the three systems for their tests: few moves, and what they are run with."""

from __future__ import annotations

from dataclasses import asdict
from functools import partial

from mptune.params.load import load_study
from mptune.params.pack import pack_gains
from mptune.params.packed import FeedforwardTuple
from mptune.systems.bench import LoadCase, bench_of
from mptune.systems.digital_valves import run_digital_valves
from mptune.systems.eq22 import pi_gains
from mptune.systems.four_chamber import run_four_chamber
from mptune.systems.load_sensing import run_load_sensing

KEYS = ("load_sensing", "digital_valves", "four_chamber")
NO_FEEDFORWARD = FeedforwardTuple(0.0, 0.0, 0.0)
MOVES = (
    'manoeuvre=[{distance="50 mm", duration="1 s", rest="0.5 s"}, '
    '{distance="-50 mm", duration="1 s", rest="0.5 s"}]'
)
CASE = LoadCase(mass=49e3, oil_bulk_modulus=1.2e9, load_force=9700.0, seed=1, repeats=3)


def figures(outcome):
    """Figures of each set as text, in full: those that are not numbers are alike as well."""
    return str([asdict(one) for one in outcome.sets])


def runner(study, key):
    """The system of a study under its literature's controller: from a bench to records."""
    asked = study.study.systems
    if key == "load_sensing":
        return partial(
            run_load_sensing,
            position_gain=asked.load_sensing.k_x,
            system=asked.load_sensing,
        )
    if key == "digital_valves":
        return partial(
            run_digital_valves,
            position_gain=asked.digital_valves.k_x,
            system=asked.digital_valves,
        )
    system = asked.four_chamber
    gains = pack_gains(pi_gains(system.k_p_vel, system.k_p_pos, system.k_i_pos))
    return partial(run_four_chamber, system=system, gains=gains, ahead=NO_FEEDFORWARD)


def records_of(study_file, key, case=CASE, overrides=(MOVES,)):
    study = load_study(study_file, overrides)
    return runner(study, key)(bench_of(study, case))
