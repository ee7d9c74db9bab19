"""Function mock-up units: valid, and mptune's own controller to the last bit."""

import importlib.util
import io
import math
import shutil
import subprocess
import zipfile

import fmpy
import numpy as np
import pytest
import recording as rec
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from mockup import INPUTS, Unit
from recording import drive, first_case, record_case, rig_of
from target import any_compiler, gains_of, renumbered, zig

from mptune.errors import MptuneError
from mptune.export.fmu import build_unit, write_units
from mptune.export.formats import Precision
from mptune.force.search_space import search_space
from mptune.job.export import prepare

pytestmark = pytest.mark.compiled  # they simulate at length

STEP = 0.5e-3
VALVES = [f"valve_{side}[{supply},{n}]" for side in "ab" for supply in range(1, 7) for n in (1, 2)]


@pytest.fixture(scope="module")
def folder(controller, tmp_path_factory):
    any_compiler()
    folder = tmp_path_factory.mktemp("units")
    write_units(controller, folder)
    return folder


@pytest.fixture(params=[2, 3])
def path(request, folder):
    return folder / f"controller-fmi{request.param}.fmu"


@pytest.fixture
def unit(path):
    unit = Unit(path, STEP)
    yield unit
    unit.close()


def test_units_pass_fmpy_s_validation(path):
    assert validate_fmu(str(path)) == []


def test_the_machine_under_a_unit_runs_as_under_mptune(unit, study, recording):
    trace = drive(rig_of(study, first_case(study, 24500.0)), unit)
    assert (trace == recording.trace).all()


def test_a_unit_decides_as_mptune_does_with_every_option(load_boom, tmp_path):
    """The sources are those of the C export, where each option is compared on its own."""
    move = 'manoeuvre=[{distance="20 mm", duration="0.5 s", rest="0.2 s"}]'
    study = load_boom(
        move, 'controller.error="huber"', 'controller.loss="path"', "controller.horizon=2",
        'controller.weight_common_mode="300 N/MPa"', corners=True,
    )  # fmt: skip
    any_compiler()
    paths = write_units(prepare(study, gains_of(study), Precision.DOUBLE), tmp_path)
    recording = record_case(study, first_case(study, 24500.0))
    for path in paths:
        unit = Unit(path, STEP)
        trace = drive(rig_of(study, first_case(study, 24500.0)), unit)
        unit.close()
        assert (trace == recording.trace).all()


def test_a_unit_of_four_chambers_decides_as_mptune_does(load_shape, controller, tmp_path):
    move = 'manoeuvre=[{distance="20 mm", duration="0.5 s", rest="0.2 s"}]'
    study = load_shape("four-chamber", move)
    any_compiler()
    recording = record_case(study, first_case(study, 24500.0))
    for path in write_units(renumbered(controller, study), tmp_path):
        assert validate_fmu(str(path)) == []
        unit = Unit(path, STEP)
        assert unit.inputs[-2:] == ["pressure_c", "pressure_d"]
        assert unit.states == [f"state_{one}" for one in "abcd"]
        trace = drive(rig_of(study, first_case(study, 24500.0)), unit)
        unit.close()
        assert (trace == recording.trace).all()


def test_fmpy_s_own_simulation_is_stepping_by_hand(path, unit, recording):
    """fmpy initializes with the first inputs and interpolates them: to rounding, these are they."""
    inputs = recording.inputs[:400]
    names = ["force_reference", "stopped", "state_a", "state_b"]
    rows = [(number * STEP, *row) for number, row in enumerate(inputs)]
    result = fmpy.simulate_fmu(
        str(path),
        stop_time=STEP * (len(inputs) - 1),
        output_interval=STEP,
        start_values={"load_force": recording.load},
        input=np.array(rows, dtype=[(name, np.float64) for name in ("time", *INPUTS)]),
        output=names,
        fmi_type="CoSimulation",
    )
    unit.start(inputs[0], recording.load)
    by_hand = np.array([unit.step(row) for row in inputs[:-1]])
    found = np.column_stack([result[name][1:] for name in names])
    np.testing.assert_allclose(found[:, 0], by_hand[:, 0], rtol=1e-9)
    assert (found[:, 1:] == by_hand[:, 1:]).all()
    assert len(np.unique(found[:, 2])) > 3


def test_valves_have_the_names_of_their_supplies(unit, recording):
    space = search_space()
    unit.start(recording.first, recording.load)
    seen = set()
    for row in recording.inputs[:1500]:
        _, _, state_a, state_b = unit.step(row)
        wanted = [*space.valves[state_a], *space.valves[state_b]]
        assert [int(value) for value in unit.boolean(*VALVES)] == wanted
        seen |= {state_a, state_b}
    assert len(seen) > 5


def test_a_whole_multiple_of_t_s_fast_holds_its_inputs(unit, recording):
    row = recording.inputs[0]
    unit.start(recording.first, recording.load)
    for _ in range(40):
        single = unit.step(row)
    unit.slave.reset()
    unit.start(recording.first, recording.load)
    unit.time_step = 40 * STEP
    assert unit.step(row) == single


@pytest.mark.parametrize("step", [1.2e-3, 0.4e-3, 0.0, -STEP, math.inf, math.nan])
def test_another_communication_step_is_refused(unit, recording, step):
    unit.start(recording.first, recording.load)
    unit.time_step = step
    with pytest.raises(FMICallException):
        unit.step(recording.inputs[0])


def test_a_start_outside_the_limits_is_refused(unit, recording):
    first = recording.first.copy()
    first[3] = 9.9
    with pytest.raises(FMICallException):
        unit.start(first, 0.0)


def test_no_number_shuts_all_valves_and_is_a_fault(unit, recording):
    unit.start(recording.first, recording.load)
    for row in recording.inputs[:200]:
        unit.step(row)
    spoilt = recording.inputs[200].copy()
    spoilt[4] = math.nan
    unit.step(spoilt)
    assert list(unit.integer("fault")) == [4]
    assert not any(unit.boolean(*VALVES))


def test_a_kept_state_is_gone_back_to(unit, recording):
    unit.start(recording.first, recording.load)
    for row in recording.inputs[:300]:
        unit.step(row)
    getter = "getFMUState" if hasattr(unit.slave, "getFMUState") else "getFMUstate"
    kept = getattr(unit.slave, getter)()
    once = [unit.step(row) for row in recording.inputs[300:400]]
    getattr(unit.slave, getter.replace("get", "set"))(kept)
    assert [unit.step(row) for row in recording.inputs[300:400]] == once
    getattr(unit.slave, getter.replace("get", "free"))(kept)


def test_a_reset_unit_starts_again(unit, recording):
    unit.start(recording.first, recording.load)
    once = [unit.step(row) for row in recording.inputs[:100]]
    unit.slave.reset()
    unit.start(recording.first, recording.load)
    assert [unit.step(row) for row in recording.inputs[:100]] == once


def test_inputs_cannot_be_outputs_nor_the_load_change_under_way(unit, recording):
    unit.start(recording.first, recording.load)
    for name in ("force_reference", "load_force"):
        with pytest.raises(FMICallException):
            unit.set({name: 1.0})


def test_the_description_carries_provenance_and_units(path, study):
    description = fmpy.read_model_description(str(path))
    assert study.hash() in description.description
    assert "margins as written: satisfied" in description.description
    units = {one.name: one.unit for one in description.modelVariables}
    assert (units["position"], units["pressure_a"], units["force_reference"]) == ("m", "Pa", "N")
    assert float(description.defaultExperiment.stepSize) == STEP
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
    assert {"resources/controller.toml", "sources/mptune_force.c", "sources/unit.c"} <= names


def test_a_forced_unit_says_so_loudly(forced):
    any_compiler()
    for version in (2, 3):
        description = fmpy.read_model_description(io.BytesIO(build_unit(forced, version)))
        assert "NOT satisfied" in description.description


def test_sources_inside_compile_for_another_system(path, tmp_path):
    if zig() is None:
        pytest.skip("clang is needed to compile for another system")
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path)
    sources = [str(file) for file in sorted((tmp_path / "sources").glob("*.c"))]
    flags = ["-target", "aarch64-linux-gnu", "-std=c99", "-O2", "-ffp-contract=off", "-c"]
    done = subprocess.run(
        [*zig(), *flags, *sources], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert list(tmp_path.glob("*.o"))


def test_zig_s_compiler_takes_the_place_of_a_missing_one(
    controller, recording, tmp_path, monkeypatch
):
    if zig() is None:
        pytest.skip("another C compiler is here, this one is not")
    monkeypatch.setattr(shutil, "which", lambda name: None)
    (tmp_path / "unit.fmu").write_bytes(build_unit(controller, 3))
    unit = Unit(tmp_path / "unit.fmu", STEP)
    unit.start(recording.first, recording.load)
    forces = [unit.step(row)[0] for row in recording.inputs[:200]]
    unit.close()
    assert forces == recording.decisions[:200, rec.FORCE].tolist()


def test_a_unit_in_single_precision_steps_as_one_in_double_nearly_does(single, recording, tmp_path):
    any_compiler()
    (tmp_path / "unit.fmu").write_bytes(build_unit(single, 2))
    unit = Unit(tmp_path / "unit.fmu", STEP)
    unit.start(recording.first, recording.load)
    forces = [unit.step(row)[0] for row in recording.inputs[:200]]
    unit.close()
    np.testing.assert_allclose(forces, recording.decisions[:200, rec.FORCE], atol=100)
    assert forces != recording.decisions[:200, rec.FORCE].tolist()


def test_no_compiler_at_all_is_said_clearly(controller, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name == "ziglang" else found(name)
    )
    with pytest.raises(MptuneError, match=r"no C compiler.*--to c"):
        build_unit(controller, 2)


def test_without_fmpy_the_extra_is_named(controller, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "fmpy", None)
    with pytest.raises(MptuneError, match=r"extra `fmu`"):
        build_unit(controller, 3)


def test_nothing_is_written_where_a_unit_is_not_valid(controller, tmp_path, monkeypatch):
    monkeypatch.setattr("fmpy.validation.validate_fmu", lambda content: ["a broken thing"])
    any_compiler()
    with pytest.raises(MptuneError, match="a broken thing"):
        write_units(controller, tmp_path)
    assert list(tmp_path.iterdir()) == []
