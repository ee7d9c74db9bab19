"""Two delays: the lumped one in Eq. 14 to 21, its own where path and sampling stand explicitly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mptune.certify.bounds import bound
from mptune.certify.margins import margin
from mptune.certify.problem import BoxedLoop
from mptune.certify.radius import radius
from mptune.certify.result import Stability
from mptune.certify.stability import box_stability
from mptune.loops.broken import FORCE
from mptune.params.packed import NO_PATH
from mptune.robust.chain import chain, other_reading
from mptune.robust.model import LinearModel
from mptune.robust.place import PlantPoint
from mptune.robust.sweep import sweep

LUMPED, EXPLICIT = (0.011, 0.0215), (0.010, 0.014)


def ends(plants):
    return float(plants.delay.min()), float(plants.delay.max())


def the_same_machines(model):
    pairs = zip(model.lumped, model.explicit, strict=True)
    return all((a == b).all() for key, (a, b) in zip(model.lumped._fields, pairs, strict=True)
               if key != "delay")  # fmt: skip


@pytest.fixture(scope="module")
def model(load_boom):
    return LinearModel.of(load_boom(corners=True))


@pytest.fixture(scope="module")
def with_path(load_boom):
    return LinearModel.of(load_boom('model.measurement_path="filters"', corners=True))


def test_inequalities_without_the_path_take_the_lumped_delay(model):
    assert ends(model.plants) == ends(model.loops(model.gains).plants) == LUMPED
    assert ends(model.explicit) == ends(model.as_it_runs(model.gains).plants) == EXPLICIT
    assert ends(model.loops(model.gains, model.path_of("filters")).plants) == EXPLICIT
    assert model.nominal.delay == LUMPED[0]
    assert model.nominal_along(model.filters).delay == EXPLICIT[0]
    assert the_same_machines(model)


def test_inequalities_with_the_path_take_the_delay_that_goes_with_it(with_path):
    assert ends(with_path.plants) == EXPLICIT
    assert with_path.nominal.delay == EXPLICIT[0]
    assert ends(with_path.loops(with_path.gains, NO_PATH).plants) == LUMPED


@pytest.mark.parametrize("wide", ["delay", "delay_as_it_runs"])
def test_a_range_without_width_stands_beside_one_with(load_boom, wide):
    narrow = {"delay": "delay_as_it_runs", "delay_as_it_runs": "delay"}[wide]
    model = LinearModel.of(load_boom(f'uncertainty.{narrow}=["12 ms", "12 ms"]', corners=True))
    assert model.lumped.number == model.explicit.number == 16
    assert the_same_machines(model)
    assert len(model.corners()) == 4


def test_the_nominal_machine_may_have_its_own_delay_as_it_runs(load_boom):
    box = load_boom("uncertainty.nominal.delay=12 ms").uncertainty
    assert (box.nominal_delay, box.nominal_delay_as_it_runs) == (0.012, EXPLICIT[0])
    given = "uncertainty.nominal.delay_as_it_runs=13 ms"
    assert load_boom(given).uncertainty.nominal_delay_as_it_runs == 0.013
    same = load_boom("uncertainty.sets.section-5-1.nominal.delay=12 ms", uncertainty="section-5-1")
    assert same.uncertainty.nominal_delay_as_it_runs == 0.012


def test_a_plant_that_joins_has_both_its_delays(model):
    at = PlantPoint(30e3, 0.012, 1e-3, 2e-3, 50.0)
    joined = model.joined_by(at, as_it_runs=True)
    assert joined.explicit.delay[-1] == 0.012
    assert joined.lumped.delay[-1] == pytest.approx(LUMPED[0] + 0.5 * (LUMPED[1] - LUMPED[0]))
    assert joined.holds(at, as_it_runs=True)
    assert not joined.holds(at, as_it_runs=False)
    lumped = model.joined_by(replace(at, delay_s=LUMPED[1]), as_it_runs=False)
    assert (lumped.lumped.delay[-1], lumped.explicit.delay[-1]) == (LUMPED[1], EXPLICIT[1])
    assert model.plant(replace(at, delay_s=LUMPED[1]), as_it_runs=True).delay[0] == EXPLICIT[1]


@pytest.mark.compiled
def test_the_published_gains_are_stable_as_they_run_over_fig_5(load_boom):
    """Factor 1.24 as it runs; with Fig. 5's delays counted there as well, 0.87."""
    result = sweep(load_boom(corners=True))
    for path in ("none", "filters", "sampled"):
        assert result.family(path).unstable_count == 0
        assert result.certificates.stable("force_reference", path).status is Stability.STABLE
    factors = {link.name: link for link in chain(result)}
    assert factors["with measurement path"].factor == pytest.approx(1.232, abs=0.005)
    assert factors["sampled"].factor == pytest.approx(1.240, abs=0.005)
    assert factors["sampled"].at.delay_s == EXPLICIT[1]
    assert not any(link.beside for link in factors.values())
    other = other_reading(result)
    print([link.headline for link in other])
    assert [link.name for link in other] == [
        "with measurement path, lumped delay",
        "sampled, lumped delay",
    ]
    for link in other:
        assert link.beside
        assert link.json()["beside"]
        assert link.factor == pytest.approx(0.875, abs=0.005)
        assert link.at.delay_s == LUMPED[1]


@pytest.mark.compiled
def test_counted_twice_some_plants_are_unstable(load_boom):
    result = sweep(load_boom(corners=True, twice=True))
    assert other_reading(result) == ()
    proof = result.certificates.stable("force_reference", "sampled")
    assert proof.status is Stability.UNSTABLE
    assert (proof.witness.mass, proof.witness.delay) == (24500.0, LUMPED[1])
    assert result.family("sampled").first_unstable().delay_s == LUMPED[1]
    assert np.isnan(result.family("sampled").worst("gain_margin", FORCE)[0])


def test_certificates_take_the_box_of_their_path(load_boom):
    problem = BoxedLoop.of(load_boom())
    assert problem.along("none").box.delay == LUMPED
    for path in ("filters", "sampled"):
        along = problem.along(path)
        assert along.box.delay == EXPLICIT
        assert along.box.nominal.delay == EXPLICIT[0]
        assert along.along(path) == along
    assert BoxedLoop.of(load_boom(uncertainty="section-5-1")).explicit is None


@pytest.mark.compiled
def test_stability_peaks_margins_and_radius_are_those_of_that_box(load_boom):
    """As over §5.1's box, of which a growing box keeps the nominal delay too."""
    both, alone = (BoxedLoop.of(load_boom(uncertainty=name)) for name in ("", "section-5-1"))
    assert box_stability(both, "sampled") == box_stability(alone, "sampled")
    for figure in ("sensitivity_peak", "disk_margin"):
        asked = ("force_reference", "sampled", figure)
        assert bound(both, *asked) == bound(alone, *asked)
    assert margin(both, "sampled", "gain_margin") == margin(alone, "sampled", "gain_margin")
    assert radius(both, "sampled") == radius(alone, "sampled")
    assert radius(both, "none").upper < radius(alone, "none").lower


def test_one_range_for_both_is_the_study_of_before(load_boom):
    """The key may be written or left out; the hash does not tell."""
    pair = '["11 ms", "21.5 ms"]'
    child = load_boom(f"uncertainty.delay_as_it_runs={pair}")
    values = child.model_values()["uncertainty"]
    assert "delay_as_it_runs" not in values
    assert "delay_as_it_runs" not in values["nominal"]
    assert child.hash() != load_boom().hash()
    derived = load_boom('uncertainty.delay_as_it_runs="derived"')
    assert derived.hash() == load_boom().hash()
