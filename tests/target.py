"""The exported controller in C: compiled, fed with recordings, and called directly."""

from __future__ import annotations

import ctypes
import importlib.util
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mptune.export.c_source import c_sources
from mptune.export.constants import controller_numbers
from mptune.export.formats import Precision
from mptune.job.export import prepare
from mptune.params.gains import GainsFile, now

REPLAY = Path(__file__).with_name("replay.c")
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
EXACT = ("-O2", "-ffp-contract=off")
UNDEFINED = ("-O1", "-g", "-ffp-contract=off", "-fno-sanitize-recover=all")
FORCE, FAULT, STOPPED, STATE_A, STATE_B, DECIDED = range(6)
VALVES = slice(6, 30)
SINGLE_FORCE = 0.8  # N, what single precision makes of forces of 80 kN after eight steps of Eq. 5


def gcc():
    return [name] if (name := shutil.which("gcc") or shutil.which("cc")) else None


def zig():
    return [sys.executable, "-m", "ziglang", "cc"] if importlib.util.find_spec("ziglang") else None


def any_compiler():
    """Return the command of a C compiler; the test is skipped only where there is none at all."""
    found = gcc() or zig()
    if not found:
        pytest.skip("no C compiler at all")
    return found


def sanitizing():
    """Return a compiler and its flags to find undefined behaviour; zig's brings no ASan."""
    if gcc():
        return gcc(), (*UNDEFINED, "-fsanitize=address,undefined")
    return any_compiler(), (*UNDEFINED, "-fsanitize=undefined")


def gains_of(study, **changes):
    """Return a gains file of the study's own gains."""
    values = {
        "study": study.name,
        "study_hash": study.hash(),
        "uncertainty": study.uncertainty_name,
        "version": "0.1.0",
        "date": now(),
        "margins": "satisfied",
        "closed_loop": "not run",
        "gains": study.study.gains.model_dump(),
        "feedforward": study.study.feedforward.model_dump(),
        "figures": {},
        **changes,
    }
    return GainsFile.model_validate(values, context={"si": True})


def renumbered(controller, study):
    """Return a controller with the numbers of a study, and its verdict left: margins take long."""
    own = study.study
    numbers = controller_numbers(study, own.gains, own.feedforward, controller.numbers.precision)
    return replace(controller, study=study, numbers=numbers)


def write_sources(study, folder, precision=Precision.DOUBLE, like=None, **changes):
    """Write the controller's C files and return the controller, its verdict that of another."""
    if like is None:
        controller = prepare(study, gains_of(study, **changes), precision)
    else:
        controller = renumbered(like, study)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in c_sources(controller).items():
        (folder / name).write_text(text, encoding="utf-8")
    return controller


def compile_c(compiler, folder, target, *flags, extra=()):
    """Compile the sources of a folder; what the compiler says is an error of the test."""
    sources = [str(path) for path in (*sorted(folder.glob("*.c")), *extra)]
    command = [*compiler, *STRICT, *flags, f"-I{folder}", "-o", str(target), *sources, "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return target


def replay(program, recording, folder, passes=1):
    """Return what the compiled controller does with recorded inputs ``(T, 30)``, and ns."""
    inputs, outputs = folder / "inputs.bin", folder / "outputs.bin"
    rows = (np.array([recording.load]), recording.first, recording.inputs.ravel())
    np.concatenate(rows).tofile(inputs)
    done = subprocess.run(
        [str(program), str(inputs), str(outputs), str(passes)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return np.fromfile(outputs).reshape(len(recording.inputs), -1), float(done.stdout)


class Inputs(ctypes.Structure):
    """``mptune_inputs`` in double precision."""

    _fields_ = [
        (name, ctypes.c_double)
        for name in (
            "position_reference",
            "velocity_reference",
            "acceleration_reference",
            "position",
            "pressure_a",
            "pressure_b",
            "pressure_high",
            "pressure_low",
        )
    ] + [("converter", ctypes.c_double * 4), ("further", ctypes.c_double * 1)]

    @classmethod
    def of(cls, row):
        return cls(*row[:8], (ctypes.c_double * 4)(*row[8:]))


class Outputs(ctypes.Structure):
    """``mptune_outputs`` in double precision."""

    _fields_ = [
        ("valve", ctypes.c_uint8 * 24),
        ("state_a", ctypes.c_uint8),
        ("state_b", ctypes.c_uint8),
        ("state_further", ctypes.c_uint8 * 1),
        ("stopped", ctypes.c_uint8),
        ("decided", ctypes.c_uint8),
        ("fault", ctypes.c_uint32),
        ("force_reference", ctypes.c_double),
    ]


class Controller:
    """The controller as a shared library, called from here."""

    def __init__(self, library):
        self.library = ctypes.CDLL(str(library))
        for function in (self.library.mptune_init, self.library.mptune_step):
            function.restype = ctypes.c_uint32
        self.state = (ctypes.c_double * 512)()  # more than mptune_state takes
        self.outputs = Outputs()

    def init(self, row, load=0.0):
        inputs = Inputs.of(row)
        return self.library.mptune_init(
            ctypes.byref(self.state), ctypes.byref(inputs), ctypes.c_double(load)
        )

    def step(self, row):
        inputs = Inputs.of(row)
        return self.library.mptune_step(
            ctypes.byref(self.state), ctypes.byref(inputs), ctypes.byref(self.outputs)
        )

    def shut(self):
        return not any(self.outputs.valve)
