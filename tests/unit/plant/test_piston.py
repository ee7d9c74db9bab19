"""Friction of the main cylinder."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.params.load import load_study
from mptune.params.pack import pack_machine
from mptune.plant.piston import friction


@pytest.fixture(scope="module")
def machine(boom):
    return pack_machine(boom, 24500.0, 1.2e9, 9700.0)


@given(velocity=st.floats(-0.5, 0.5))
def test_friction_is_odd_and_takes_energy(machine, velocity):
    force = friction(velocity, machine)
    assert force == -friction(-velocity, machine)
    assert force * velocity >= 0


def test_stiction_at_crawl_coulomb_and_viscous_friction_at_speed(machine):
    """Stribeck: highest well below 5 mm/s, least above it, then rising with the velocity."""
    crawl, dip, speed = (friction(v, machine) for v in (5e-4, 0.02, 0.2))
    print(f"0.5 mm/s {crawl:.0f} N, 20 mm/s {dip:.0f} N, 200 mm/s {speed:.0f} N")
    assert crawl == pytest.approx(machine.friction_static, rel=0.02)
    assert dip == pytest.approx(750 + 4000 * 0.02, rel=1e-5)
    assert speed == pytest.approx(750 + 4000 * 0.2, rel=1e-9)


@pytest.mark.parametrize("border", [20e-4, 6 * 0.005])
def test_shortcuts_of_the_formula_leave_no_step(machine, border):
    below, above = (friction(border * factor, machine) for factor in (1 - 1e-9, 1 + 1e-9))
    assert above == pytest.approx(below, abs=1e-4)


def test_without_friction_there_is_none(study_file):
    none = [f"load.friction_{kind}=0 N" for kind in ("coulomb", "static")]
    study = load_study(study_file, [*none, "load.friction_viscous=0 N s/m"])
    machine = pack_machine(study, 1.0, 1.2e9, 0.0)
    assert [friction(v, machine) for v in np.linspace(-0.2, 0.2, 9)] == [0.0] * 9
