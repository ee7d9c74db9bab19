"""Options of the machine: hoses as lines of their own, and a boom's table of load and inertia."""

import numpy as np
import pytest
from opened import opened

from mptune.errors import InputError
from mptune.params.line_table import paper_table
from mptune.params.load import load_study
from mptune.params.pack import pack_machine, pack_table
from mptune.params.packed import NO_TABLE
from mptune.plant import hoses
from mptune.plant import machine as plant
from mptune.plant.piston import burden_at

STATES = plant.CONVERTER + 4  # of the paper's machine
LINES = paper_table(2e6)


def with_table(write_study, tmp_path, text):
    (tmp_path / "boom.csv").write_text(text)
    return write_study({"load.table": '"boom.csv"'})


def test_table_is_interpolated_between_its_rows(write_study, tmp_path):
    text = "position [mm],force [kN],inertia [-]\n0,-3,1.2\n150,0,1\n300,4,0.8\n"
    study = load_study(with_table(write_study, tmp_path, text))
    machine, table = pack_machine(study, 20e3, 1.2e9, 9700.0), pack_table(study)
    at = burden_at(0.075, machine, table)
    assert at.force == pytest.approx(9700 - 1500)
    assert at.mass == pytest.approx(1.1 * 20e3)
    assert at.mass_slope == pytest.approx(-0.2 / 0.15 * 20e3)
    assert at.stiffness == pytest.approx(3000 / 0.15)
    assert burden_at(1.0, machine, table).mass == pytest.approx(0.8 * 20e3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("position [mm],force [kN]\n0,1\n1,2\n", "header"),
        ("position [mm],force [kN],inertia [-]\n0,1,1\n", "2 are needed"),
        ("position [mm],force [kN],inertia [-]\n0,1,1\n1,2,-1\n", "inertia"),
        ("position [mm],force [kN],inertia [-]\n1,1,1\n0,2,1\n", "line 3"),
    ],
)
def test_a_bad_table_is_refused(write_study, tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        load_study(with_table(write_study, tmp_path, text))


def test_varying_inertia_keeps_kinetic_energy(boom):
    """Without force or friction m(x) v²/2 stays: v (m a + m' v²/2) = 0."""
    machine = pack_machine(boom, 20e3, 1.2e9, 0.0)._replace(
        friction_coulomb=0.0, friction_static=0.0, friction_viscous=0.0
    )
    table = np.array([[0.0, 0.0, 1.3], [0.3, 0.0, 0.7]])
    balanced = 5e6
    state = np.zeros(STATES + hoses.LINE_STATES)
    state[plant.X], state[plant.V] = 0.12, 0.08
    state[plant.PRESSURE_A], state[plant.PRESSURE_B] = balanced, balanced
    machine = machine._replace(area_b=machine.area_a)
    burden = burden_at(state[plant.X], machine, table)
    slope, power = np.zeros(STATES), np.zeros(plant.ENERGIES)
    plant.rates(state, opened(LINES, 0.0, 0.0), 0.0, machine, burden, slope, power)
    change = state[plant.V] * (
        burden.mass * slope[plant.V] + 0.5 * burden.mass_slope * state[plant.V] ** 2
    )
    assert slope[plant.V] > 0
    assert change == pytest.approx(0, abs=1e-9)


def test_powers_balance_with_lines(load_boom):
    study = load_boom("hose.dynamics=true")
    machine, random = pack_machine(study, 24500.0, 1.2e9, 9700.0), np.random.default_rng(5)
    for _ in range(50):
        state = np.zeros(STATES + hoses.LINE_STATES)
        state[plant.X], state[plant.V] = random.uniform(0.05, 0.25), random.uniform(-0.1, 0.1)
        state[[2, 3, 9, 10]] = random.uniform(2e6, 14e6, 4)
        state[[11, 12]] = random.uniform(-5e-4, 5e-4, 2)
        state[plant.OIL] = 8e-4
        open_a, open_b = random.integers(0, 3, (2, 6)).astype(float)
        slope, power = np.zeros(STATES + hoses.LINE_STATES), np.zeros(plant.ENERGIES)
        burden = burden_at(state[plant.X], machine, NO_TABLE)
        hoses.rates_with_lines(
            state, opened(LINES, open_a, open_b), 1.0, machine, burden, slope, power
        )
        given = power[plant.ACCUMULATOR] + power[plant.TANK]
        spent = power[[plant.PISTON, plant.THROTTLING, plant.CONVERTER_FRICTION, plant.COMPRESSION]]
        assert given == pytest.approx(spent.sum(), rel=1e-9, abs=1e-3)


def test_lines_at_rest_stay_at_rest(load_boom):
    machine = pack_machine(load_boom("hose.dynamics=true"), 24500.0, 1.2e9, 9700.0)
    state = np.zeros(STATES + hoses.LINE_STATES)
    state[plant.X], state[plant.OIL] = 0.15, 8e-4
    state[[3, 10]] = 6e6
    state[[2, 9]] = (9700.0 + machine.area_b * 6e6) / machine.area_a
    slope, power = np.zeros(STATES + hoses.LINE_STATES), np.zeros(plant.ENERGIES)
    burden = burden_at(0.15, machine, NO_TABLE)
    hoses.rates_with_lines(state, opened(LINES, 0.0, 0.0), 0.0, machine, burden, slope, power)
    np.testing.assert_allclose(slope, 0, atol=1e-12)
