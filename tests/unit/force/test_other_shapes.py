"""Machines of other sizes: their states, their decisions against a plain law, their energies."""

import numpy as np
import pytest
from deciding import chosen, first_costs, states

from mptune.force.search_space import space_of
from mptune.params.pack import pack_force
from mptune.verify.verify import cases_of, run_case

ENERGY_LEFT = 5e-3  # of the input

SIZES = {"three-pressure": (13, 3), "digital-valve": (63, 2), "mixed": (1 + 3 + 3 + 7 + 3 + 9, 4)}


@pytest.mark.parametrize("name", SIZES)
def test_states_are_as_many_as_the_rule_says(load_shape, name):
    space = space_of(load_shape(name))
    assert (len(space.first), space.lines.shape[1]) == SIZES[name]
    assert len({row.tobytes() for row in space.valves}) == len(space.valves)
    assert not space.valves[0].any()


@pytest.mark.parametrize("name", SIZES)
@pytest.mark.parametrize("penalty", ["0 N/Pa", "0.05 N/Pa"])
def test_decisions_are_the_cheapest_by_the_plain_law(load_shape, name, penalty):
    now = 'controller.delay_prediction="0 ms"'  # the plain law begins where the state is
    study = load_shape(name, f"controller.weight_pressure={penalty}", now)
    supplies, space, settings = study.study.supplies, space_of(study), pack_force(study)
    high = supplies.high_pressure
    for case in states(12, 5, space, (0.9 * high, 1.1 * high), supplies.low_pressure):
        costs = first_costs(case, space, settings)[0]
        a, b = chosen(case, space, settings)
        assert costs[a, b] == pytest.approx(costs.min(), rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(
    "name",
    [
        "three-pressure",
        "digital-valve",
        "mixed",
        "following",
        "four-chamber",
        "four-converters",
        "four-hoses",
    ],
)
@pytest.mark.compiled
def test_energies_close_and_the_piston_follows(load_shape, name):
    study = load_shape(name, "verification.repeats=1", "verification.seeds=[1]")
    case = run_case(study, cases_of(study)[0], study.study.gains, study.study.feedforward)
    record = case.record
    print(f"{name}: {case.headline}, residual {record.energies.residual:.1e}, {case.broken}")
    assert record.energies.residual < ENERGY_LEFT
    chambers = study.study.all_chambers
    signs = [1 if one.side == "pushing" else -1 for one in chambers]
    areas = np.array([one.area for one in chambers]) * signs
    np.testing.assert_allclose(record.pressures @ areas, record.force, rtol=1e-9, atol=1e-6)
    assert np.abs(record.error).max() < 20e-3
    assert ("converter_peak_mm" in record.own_figures) == (study.study.converters > 0)


@pytest.mark.compiled
def test_a_mirrored_cylinder_decides_in_mirror_image(load_shape):
    """Equal areas and volumes; sides, velocity and force change places."""
    study = load_shape("mixed")
    space, settings = space_of(study), pack_force(study)
    mean = 0.5 * (settings.area_a + settings.area_b)
    settings = settings._replace(area_a=mean, area_b=mean)
    for case in states(60, 9, space, (12e6, 15e6), 1e6):
        mirror = {
            **case,
            "wanted": -case["wanted"],
            "p": case["p"][::-1],
            "x": settings.stroke - case["x"],
            "v": -case["v"],
            "present": case["present"][::-1],
        }
        assert chosen(mirror, space, settings) == chosen(case, space, settings)[::-1]
