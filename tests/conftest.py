"""What the tests share: the paper's study, its sweeps, and study files to spoil."""

from __future__ import annotations

import os
import tomllib
from functools import partial
from pathlib import Path

# The workers of pytest-xdist share the cores: threads of their own would wait for one another.
os.environ["NUMBA_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numba
import numpy as np
import pytest
import tomlkit
from hypothesis import Phase, settings

from mptune.params.load import load_study
from mptune.robust.sweep import sweep

EXAMPLES = 8 if numba.config.DISABLE_JIT else 50
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=EXAMPLES)
settings.register_profile("explore", deadline=None, max_examples=200)
UNSHRUNK = (Phase.explicit, Phase.generate)  # that an example fails is all that mutants ask
settings.register_profile("unshrunk", settings.get_profile("repeatable"), phases=UNSHRUNK)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))

ROOT = Path(__file__).parents[1]
STUDY = ROOT / "studies" / "boom" / "study.toml"

TWICE = 'uncertainty.delay_as_it_runs=["11 ms", "21.5 ms"]'

# Tests that start commands of their own come last: these find kernels that others compiled.
LATE = {"browser", "docs", "faults"}

SHAPES = {
    # A converter between tank and accumulator, a constant line, and unequal valves on one line.
    "mixed": {
        "lines": '[{kind = "tank", pressure = "1 MPa"}, '
        '{kind = "converter", between = [1, 4], share = 0.3}, '
        '{kind = "constant", pressure = "8 MPa", sizes = [0.5, 1.0, 2.0]}, '
        '{kind = "accumulator", pressure = "14 MPa"}]',
        "edges.states": '["subsets", "crossflow"]',
    },
    # Four chambers between lines of which two are made by converters.
    "four-converters": {
        "chambers": '[{side = "pushing", area = "32 cm^2", dead_volume = "0.2 dm^3", valves = 2}, '
        '{side = "pulling", area = "16 cm^2", dead_volume = "0.2 dm^3", hose_length = "0.4 m"}, '
        '{side = "pushing", area = "8 cm^2", dead_volume = "0.2 dm^3", valves = 0.5}, '
        '{side = "pulling", area = "4 cm^2", dead_volume = "0.2 dm^3", valves = 0.5}]',
        "lines": '[{kind = "tank", pressure = "1 MPa"}, '
        '{kind = "converter", between = [1, 4], share = 0.3}, '
        '{kind = "converter", between = [1, 4], share = 0.7}, '
        '{kind = "accumulator", pressure = "14 MPa"}]',
        "edges": '{sizes = [1], states = ["all", "crossflow"]}',
        "controller.weight_pressure": '"0.05 N/Pa"',
    },
    "following": {
        "lines": '[{kind = "tank", pressure = "0.5 MPa"}, {kind = "pump", pressure = "16 MPa", '
        'margin = "2 MPa", standby = "2 MPa", lag = "60 ms"}]',
        "edges.sizes": "[1, 1, 2]",
    },
}

SHAPES["four-hoses"] = SHAPES["four-converters"] | {"hose.dynamics": "true"}

# Interpreted kernels are slow; the corners of the box hold the worst plants of the paper's sets.
POINTS = 2 if numba.config.DISABLE_JIT else 7


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: item.path.relative_to(ROOT / "tests").parts[0] in LATE)


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def study_file() -> Path:
    return STUDY


@pytest.fixture(scope="session")
def load_boom():
    """Load the boom study with overrides: on the whole grid, or on its corners only.

    ``twice`` counts Fig. 5's delays where the measurement path is explicit as well.
    """

    return partial(_load, STUDY)


def _load(study, *overrides, uncertainty="", corners=False, twice=False):
    points = 2 if corners else POINTS
    place = f"uncertainty.sets.{uncertainty}" if uncertainty else "uncertainty"
    written = [f"{place}.points={points}", *([TWICE] if twice else []), *overrides]
    return load_study(study, written, uncertainty)


@pytest.fixture(scope="session")
def load_in_paper_s_frame(tmp_path_factory):
    """Load the boom as the paper tunes it: on its continuous loop, whatever the noise gain."""
    document = tomlkit.parse(STUDY.read_text(encoding="utf-8")).unwrap()
    del document["requirements"]["noise_gain"], document["objective"]["tracking_loop"]
    path = tmp_path_factory.mktemp("paper") / "boom" / "study.toml"
    path.parent.mkdir()
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    return partial(_load, path)


@pytest.fixture(scope="session")
def boom():
    return load_study(STUDY)


@pytest.fixture(scope="session")
def fig_5(load_boom):
    """The sweep of the published gains over the ranges of Fig. 5."""
    return sweep(load_boom())


@pytest.fixture(scope="session")
def fig_5_twice(load_boom):
    """The same with Fig. 5's delays beside the explicit path too: some plants are unstable."""
    return sweep(load_boom(twice=True))


@pytest.fixture(scope="session")
def section_5_1(load_boom):
    """The sweep of the published gains over the ranges of §5.1."""
    return sweep(load_boom(uncertainty="section-5-1"))


@pytest.fixture(scope="session")
def load_shape(load_boom):
    """Load the corners of a machine of another size: a study, or the boom with other lines."""

    def load(name, *overrides):
        if name in SHAPES:
            changes = [f"{key}={value}" for key, value in SHAPES[name].items()]
            return load_boom(*changes, *overrides, corners=True)
        return _load(ROOT / "studies" / name / "study.toml", *overrides, corners=True)

    return load


@pytest.fixture
def write_study(tmp_path):
    """Write the boom study with some keys set to TOML values, or removed where None."""

    def write(changes):
        document = tomlkit.parse(STUDY.read_text(encoding="utf-8")).unwrap()
        for key, text in changes.items():
            *parents, last = key.split(".")
            section = document
            for parent in parents:
                section = section.setdefault(parent, {})
            if text is None:
                del section[last]
            else:
                section[last] = tomllib.loads(f"value = {text}")["value"]
        path = tmp_path / "study.toml"
        path.write_text(tomlkit.dumps(document), encoding="utf-8")
        return path

    return write


@pytest.fixture
def load_measured(write_study, tmp_path):
    """Load the corners of the boom study with one measured force response, named "rig"."""

    def load(omega, force, *overrides, place="beside"):
        table = np.stack([omega, force.real, force.imag], axis=1)
        rows = [",".join(map(repr, row)) for row in table.tolist()]
        text = "\n".join(["frequency [rad/s],real,imaginary", *rows]) + "\n"
        (tmp_path / "rig.csv").write_text(text, encoding="utf-8")
        changes = {
            "uncertainty.measured": '["rig.csv"]',
            "uncertainty.measured_place": f'"{place}"',
            "uncertainty.points": "2",
        }
        return load_study(write_study(changes), overrides)

    return load
