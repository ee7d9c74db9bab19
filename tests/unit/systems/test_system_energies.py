"""Energies of every system: they close by what the integration adds up, and by the states alone."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from loads import CASE, KEYS, MOVES, records_of

from mptune.job.systems import this_machine
from mptune.params.load import load_study
from mptune.params.pack import pack_machine
from mptune.plant.piston import friction
from mptune.systems.cylinder import two_chambers, volume_of
from mptune.systems.secondary_force import four_chambers

pytestmark = pytest.mark.compiled


@pytest.fixture(scope="module")
def machine(boom):
    return pack_machine(boom, CASE.mass, CASE.oil_bulk_modulus, CASE.load_force)


def chambers_of(key, boom, machine):
    if key == "four_chamber":
        system = boom.study.systems.four_chamber
        return four_chambers(system.smallest_area, system.dead_volume)
    return two_chambers(machine)


def held(record, row, machine, chambers):
    """Energy in the load and, with the volumes of the moment, in the compressed oil [J]."""
    x, v = record.position[row], record.velocity[row]
    stored = 0.5 * machine.mass * v**2 + machine.load * x
    for i, pressure in enumerate(record.pressures[row]):
        volume = volume_of(x, i, chambers, machine.stroke)
        compliance = 1 / machine.oil + chambers.hose[i] / volume / machine.hose  # Eq. 4
        stored += 0.5 * pressure**2 * volume * compliance
    return stored


@pytest.mark.parametrize("key", KEYS)
def test_energies_close_by_the_states_alone(key, study_file, boom, machine):
    """Neither what the piston was given nor what compression took is asked of the integration."""
    records = records_of(study_file, key)
    chambers = chambers_of(key, boom, machine)
    for now, later in itertools.pairwise(records):
        given = now.energies.drawn + now.energies.returned
        rubbed = [friction(v, machine) * v for v in np.append(now.velocity, later.velocity[0])]
        gained = held(later, 0, machine, chambers) - held(now, 0, machine, chambers)
        used = now.energies.spent["throttling"] + gained
        used += np.trapezoid(rubbed, dx=now.sample_time)
        print(f"{key}: {given:.1f} J given, {used:.1f} J found, {abs(given - used) / given:.1e}")
        assert given > 500
        assert abs(given - used) <= 0.005 * given


@pytest.mark.parametrize("decision", ["this_machine", "steady_state"])
def test_energies_of_this_machine_close_by_the_states_alone(decision, study_file, machine):
    """As those of the others, but for the half millisecond after the last row of the set."""
    study = load_study(study_file, [MOVES])
    entrants = this_machine(study, study.study.gains, study.study.feedforward)
    own = next(one for one in entrants if one.key == decision).literature
    now = own.run(CASE, 1.0).record
    given = now.energies.drawn + now.energies.returned
    chambers = two_chambers(machine)
    gained = held(now, -1, machine, chambers) - held(now, 0, machine, chambers)
    used = now.energies.spent["throttling"] + now.energies.spent["converter friction"] + gained
    used += np.trapezoid([friction(v, machine) * v for v in now.velocity], dx=now.sample_time)
    print(f"{decision}: {given:.1f} J given, {used:.1f} J found, {abs(given - used) / given:.1e}")
    assert given > 500
    assert abs(given - used) <= 0.005 * given


@pytest.mark.parametrize("key", KEYS)
def test_energies_close_by_what_the_integration_adds_up(key, study_file):
    for record in records_of(study_file, key):
        assert record.energies.residual < 1e-9
        assert record.energies.spent["throttling"] > 0
        assert record.energies.loss > 0


@pytest.mark.parametrize("key", KEYS)
def test_halving_the_step_moves_no_figure_by_more_than_its_spread(key, study_file):
    """Runs of on/off valves part at a near-tie: compared by means, as they are printed."""
    from mptune.systems.contender import outcome_of

    whole = outcome_of(records_of(study_file, key, CASE._replace(repeats=5)))
    case = CASE._replace(repeats=5, substeps=2 * CASE.substeps)
    halved = outcome_of(records_of(study_file, key, case))
    for figure in ("performance_index_ms", "energy_loss_j_per_mm", "final_error_mm"):
        spread = max(whole.spread(figure), halved.spread(figure))
        assert abs(whole.mean(figure) - halved.mean(figure)) <= spread
