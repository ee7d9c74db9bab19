"""The exported controller against mptune's own over a minute of simulated time, and its step time.

Recorded are mptune's simulator and controller, 24.5 t and 49 t; run with ``make trials``.
"""

import numpy as np
import pytest
import recording as rec
import target
from mockup import Unit
from recording import drive, first_case, record_case, rig_of
from target import EXACT, REPLAY, any_compiler, compile_c, replay

from mptune.export.fmu import write_units
from mptune.export.formats import Precision
from mptune.force.cost import force_limits
from mptune.job.export import prepare
from mptune.sim.judge import set_figures
from mptune.sim.machine_record import record_of
from mptune.verify.verify import run_case

pytestmark = [pytest.mark.bench, pytest.mark.trial]

SETS = 7  # of 9 s each
MASSES = (24500.0, 49000.0)


@pytest.fixture(scope="module")
def study(load_boom):
    return load_boom("verification.repeats=1", corners=True)


@pytest.fixture(scope="module", params=MASSES, ids=["24.5 t", "49 t"])
def recording(request, study):
    return record_case(study, first_case(study, request.param), SETS)


@pytest.fixture(scope="module")
def folders(study, tmp_path_factory):
    """The sources in both precisions."""
    base = tmp_path_factory.mktemp("c")
    for precision in Precision:
        target.write_sources(study, base / precision, precision)
    return base


def states_of(recording):
    return recording.decisions[:, [rec.STATE_A, rec.STATE_B]]


def test_valve_commands_are_identical_in_double_precision(folders, recording, tmp_path):
    compilers = {"gcc": target.gcc(), "clang": target.zig()}
    builds = [(name, found, EXACT) for name, found in compilers.items() if found]
    builds.append(("with sanitizers", *target.sanitizing()))
    for name, compiler, flags in builds:
        program = tmp_path / "replay"
        compile_c(compiler, folders / "double", program, *flags, extra=[REPLAY])
        found, longest = replay(program, recording, tmp_path, passes=3)
        same = (found[:, [target.STATE_A, target.STATE_B]] == states_of(recording)).all(axis=1)
        equal = found[:, target.FORCE] == recording.decisions[:, rec.FORCE]
        print(
            f"\n{name}: {len(found)} steps of 0.5 ms, {int(found[:, target.DECIDED].sum())} "
            f"decisions; steps with other valve commands {int((~same).sum())}, with another F_ref "
            f"{int((~equal).sum())}; longest step {1e-3 * longest:.1f} µs"
        )
        assert same.all()
        assert equal.all()
        assert not found[:, target.FAULT].any()


def test_single_precision_parts_at_a_near_tie(study, folders, recording, tmp_path):
    program = tmp_path / "replay"
    compile_c(any_compiler(), folders / "float", program, *EXACT, extra=[REPLAY])
    found, longest = replay(program, recording, tmp_path, passes=3)
    states = found[:, [target.STATE_A, target.STATE_B]]
    error = np.abs(found[:, target.FORCE] - recording.decisions[:, rec.FORCE])
    other = np.flatnonzero((states != states_of(recording)).any(axis=1) & (found[:, 5] == 1))
    print(
        f"\nfloat: {len(other)} of {int(found[:, target.DECIDED].sum())} decisions differ; "
        f"longest step {1e-3 * longest:.1f} µs"
    )
    if len(other):
        first = other[0]
        more, least = rec.extra_cost(study, recording.decisions[first], *states[first])
        print(
            f"first at step {first} ({first * 0.5e-3:.3f} s): states {states[first].astype(int)} "
            f"for {states_of(recording)[first].astype(int)}, dearer by {more:.2g} N of "
            f"{least:.0f} N; F_ref differs by {error[first]:.2g} N, {error.max():.2g} N at most"
        )
        assert 0 <= more <= 2 * error[first] + target.SINGLE_FORCE


@pytest.mark.parametrize("mass", MASSES)
@pytest.mark.parametrize("version", [2, 3])
def test_a_mock_up_unit_gives_the_figures_of_verify(study, mass, version, tmp_path):
    """One whole movement set; noise and valve delays are drawn in the simulator's order."""
    controller = prepare(study, target.gains_of(study), Precision.DOUBLE)
    paths = write_units(controller, tmp_path)
    case, rig = first_case(study, mass), rig_of(study, first_case(study, mass))
    energy, switched = rig.memory.energy.copy(), int(rig.memory.valves.counters[0])
    unit = Unit(paths[version - 2], rig.signals.sample_time)
    trace = drive(rig, unit)
    unit.close()
    record = record_of(
        trace, rig.moves, rig.memory.energy - energy,
        int(rig.memory.valves.counters[0]) - switched, rig.machine, rig.signals.sample_time,
        force_limits(rig.settings),
    )  # fmt: skip
    figures = set_figures(record)
    verified = run_case(study, case, study.study.gains, study.study.feedforward)
    index, loss = (
        (getattr(figures, name), verified.mean(name))
        for name in ("performance_index_ms", "energy_loss_j_per_mm")
    )
    print(
        f"\nFMI {version}.0, {mass / 1e3:g} t, {len(trace)} steps, beside verify's: index "
        f"{index[0]:.4f} {index[1]:.4f} ms, loss {loss[0]:.4f} {loss[1]:.4f} J/mm, "
        f"{figures.valve_switches} {verified.sets[0].valve_switches} switches"
    )
    assert figures == verified.sets[0]
    assert (trace == verified.traces).all()
