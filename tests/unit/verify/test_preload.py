"""The integrator is preloaded with what the controller can hold, and with no more."""

import numpy as np
import pytest

from mptune.force.cost import force_limits
from mptune.params.pack import pack_force, pack_gains, pack_machine
from mptune.signals.outer_loop import INTEGRAL
from mptune.sim.closed_loop import POSITION, X_REF
from mptune.verify.verify import new_memory, verify

ONE_CASE = (
    'verification.masses=["24.5 t"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
    "verification.seeds=[1]",
    "verification.repeats=3",
)
PROPORTIONAL = ("gains.k_i_pos=0 1/s^2", "gains.omega=166.67 rad/s", "gains.xi=1")
RESTS = 4  # in a movement set


def preload(study, load):
    machine = pack_machine(study, 24500.0, 1.2e9, load)
    packed = pack_gains(study.study.gains)
    memory = new_memory(study, machine, packed, study.study.verification.start)
    return memory.outer[INTEGRAL] * packed.k_p_vel


@pytest.mark.parametrize("load", [9700.0, -9700.0, 0.0])
def test_an_integrator_carries_the_load_from_the_start(boom, load):
    assert preload(boom, load) == pytest.approx(load)


def test_without_an_integral_gain_nothing_carries_it(load_boom):
    assert preload(load_boom("gains.k_i_pos=0 1/s^2"), 9700.0) == 0


def test_no_integrator_carries_more_than_the_pressures_can_give(boom):
    least, largest = force_limits(pack_force(boom))
    assert preload(boom, 1e6) == pytest.approx(largest)
    assert preload(boom, -1e6) == pytest.approx(least)


@pytest.mark.compiled
def test_a_proportional_controller_stands_off_by_the_load_over_its_stiffness(load_boom):
    """F/(K_P,vel K_P,pos) = 1.07 mm at each rest, within what friction holds either way."""
    study = load_boom(*ONE_CASE, *PROPORTIONAL, corners=True)
    case = verify(study).cases[0]
    error = case.traces[:, X_REF] - case.traces[:, POSITION]
    ends = len(error) // RESTS * np.arange(1, RESTS + 1) - 1
    gains, load = study.study.gains, study.study.load
    stiffness = gains.k_p_vel * gains.k_p_pos
    print(f"error at the rests {np.round(1e3 * error[ends], 3)} mm")
    assert load.force / stiffness == pytest.approx(1.066e-3, abs=1e-6)
    assert error[ends] == pytest.approx(
        load.force / stiffness, abs=load.friction_static / stiffness
    )
