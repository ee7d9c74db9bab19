"""The machine of another study in the comparison, and what of the feed-forward whom concerns."""

from __future__ import annotations

import pytest
from loads import CASE, MOVES, figures

from mptune.job.systems import neighbour, this_machine
from mptune.params.controller import Feedforward
from mptune.params.load import load_study
from mptune.systems.contender import contenders
from mptune.verify.verify import Case, run_case

pytestmark = pytest.mark.compiled
FEW = CASE._replace(repeats=2)
AHEAD = Feedforward.model_validate({"acceleration_mass": 30e3}, context={"si": True})


@pytest.fixture(scope="module")
def short(study_file):
    return load_study(study_file, [MOVES, "verification.repeats=2"])


def test_a_neighbour_moves_as_its_own_study_would_under_the_same_load(short, study_file):
    changes = [MOVES, "verification.repeats=2", "controller.delay_prediction=6.5 ms"]
    changed = load_study(study_file, changes)
    other = load_study(study_file, ["load.force=1 kN", "controller.delay_prediction=6.5 ms"])
    gains = other.study.gains
    entrant = neighbour("beside_1", short, (other, other), gains, AHEAD)
    assert (entrant.title, entrant.literature.name) == ("study boom", "its own")
    machine = Case(CASE.mass, (5e-3, 8e-3), CASE.oil_bulk_modulus, CASE.load_force, CASE.seed)
    for tuned, ahead in ((entrant.literature, Feedforward()), (entrant.others[0], AHEAD)):
        own = run_case(changed, machine, gains, ahead)
        assert figures(tuned.run(FEW, 1.0)) == figures(own)


def test_the_literature_s_four_chamber_controller_has_nothing_fed_forward(short):
    one = next(
        entrant
        for entrant in contenders(short, short.study.gains, AHEAD)
        if entrant.key == "four_chamber"
    )
    without = next(entrant for entrant in contenders(short) if entrant.key == "four_chamber")
    assert figures(one.literature.run(FEW, 1.0)) == figures(without.literature.run(FEW, 1.0))
    own, tuned = one.others
    assert tuned.run(FEW, 1.0).worth < 0.8 * own.run(FEW, 1.0).worth


def test_the_boundary_of_the_loss_is_where_the_machine_has_it(boom, load_shape):
    for study, words in ((boom, "accumulator"), (load_shape("four-chamber"), "lines but the")):
        entrants = this_machine(study, study.study.gains, study.study.feedforward)
        assert all(words in one.boundary for one in entrants)


def four_chambers_ahead(study, **changes):
    """Figures of the four-chamber cylinder under this study's gains with a feed-forward."""
    values = {"acceleration_mass": 30e3, **changes}
    ahead = Feedforward.model_validate(values, context={"si": True})
    entrants = contenders(study, study.study.gains, ahead)
    entrant = next(one for one in entrants if one.key == "four_chamber")
    return figures(entrant.others[1].run(FEW, 1.0))


def test_the_four_chambers_hear_the_acceleration_ahead_and_learn_no_mass(short):
    plain = four_chambers_ahead(short)
    assert four_chambers_ahead(short, preview=0.012) != plain
    assert four_chambers_ahead(short, coulomb_friction=750.0) != plain
    assert four_chambers_ahead(short, adaptive_mass=True) == plain
