"""A brief study, its controller in both precisions, its C sources, and a recorded closed loop."""

import pytest
from recording import first_case, record_case
from target import gains_of, write_sources

from mptune.export.formats import Precision
from mptune.job.export import prepare

MOVES = (
    'manoeuvre=[{distance="35 mm", duration="0.6 s", rest="0.5 s"},'
    ' {distance="-35 mm", duration="0.5 s", rest="0.4 s"}]'
)
SHORT = 'uncertainty.delay=["11 ms", "14 ms"]'  # the loop then runs with a reserve
FEEDFORWARD = (
    'feedforward.acceleration_mass="30 t"',
    'feedforward.reference_lag="12 ms"',
    'feedforward.velocity_reference_lag="10 ms"',
    'controller.delay_prediction="7 ms"',
    'controller.converter_flow="mean"',
)


@pytest.fixture(scope="session")
def study(load_boom):
    return load_boom(MOVES, SHORT, corners=True)


@pytest.fixture(scope="session")
def full_study(load_boom):
    """The same with everything switched on that the paper leaves off."""
    return load_boom(MOVES, SHORT, *FEEDFORWARD, corners=True)


@pytest.fixture(scope="session")
def proportional_study(load_boom):
    """The same without an integral, which then carries no load."""
    return load_boom(MOVES, "gains.k_i_pos=0 1/s^2", corners=True)


ESTIMATED = (
    'estimator.kind="state"',
    "estimator.reference_injection=true",
    'feedforward.acceleration_mass="37 t"',
    'feedforward.preview="11 ms"',
    'feedforward.viscous_friction="3000 N s/m"',
    'feedforward.coulomb_friction="600 N"',
)


@pytest.fixture(scope="session", params=["fixed", "jerk", "adaptive"])
def estimated_study(request, load_boom):
    """With a state estimator and all feed-forward, the mass fixed or learnt on line."""
    more = {
        "fixed": "",
        "jerk": "feedforward.jerk=true",
        "adaptive": "feedforward.adaptive_mass=true",
    }
    return load_boom(MOVES, *ESTIMATED, *filter(None, [more[request.param]]), corners=True)


@pytest.fixture(scope="session")
def prepared(study):
    return prepare(study, gains_of(study), Precision.DOUBLE)


@pytest.fixture(scope="session")
def controller(prepared):
    return prepared


@pytest.fixture(scope="session")
def single(study):
    return prepare(study, gains_of(study), Precision.FLOAT)


@pytest.fixture(scope="session")
def forced(study):
    """A controller whose margins were not satisfied."""
    return prepare(study, gains_of(study, margins="violated"), Precision.DOUBLE)


@pytest.fixture(scope="session")
def sources(study, tmp_path_factory):
    """The folder of the C sources in double precision."""
    folder = tmp_path_factory.mktemp("c")
    write_sources(study, folder)
    return folder


@pytest.fixture(scope="session")
def recording(study):
    return record_case(study, first_case(study, 24500.0))
