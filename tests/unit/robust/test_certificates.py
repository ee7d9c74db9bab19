"""Verdicts that rest on certificates: over the whole box, and told from a grid's."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mptune.certify.result import Grounds, Stability
from mptune.loops.family import ranges_of
from mptune.params.packed import Plants
from mptune.robust.certificates import against, radii_of
from mptune.robust.condition import sides
from mptune.robust.model import LinearModel
from mptune.robust.result import Status
from mptune.robust.sweep import sweep, with_radii

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def on_corners(load_boom):
    """The sweep of the published gains over the corners of §5.1's box."""
    return sweep(load_boom(uncertainty="section-5-1", corners=True))


def test_the_worst_ratio_is_the_certificates_and_not_below_the_grids(fig_5, section_5_1):
    for swept in (fig_5, section_5_1):
        for condition in swept.conditions:
            assert condition.grounds is Grounds.CERTIFIED
            assert condition.worst_ratio == condition.certified.attained
            assert condition.worst_ratio >= condition.ratio.max() * (1 - 1e-6)
            assert condition.certified.bound <= 1.0011 * condition.worst_ratio


def test_the_named_place_attains_the_named_ratio(section_5_1):
    model = section_5_1.model
    for row, condition in enumerate(section_5_1.conditions):
        omega = np.array([condition.at.frequency_rad_s])
        loops = model.loops(section_5_1.gains, plants=model.plant(condition.at))
        found = sides(omega, loops, model.nominal)
        assert found.ratio[row, 0] == pytest.approx(condition.worst_ratio, rel=1e-9)


def test_what_lies_between_the_grids_points_is_found(load_boom):
    """Over a wide range of τ_B Eq. 21 is worst within it, where no point of a grid need lie."""
    swept = sweep(load_boom('uncertainty.tau_b=["0 ms", "240 ms"]', corners=True))
    position = swept.position
    assert position.worst_ratio == pytest.approx(0.76318, abs=2e-5)
    assert 0.1 < position.at.tau_b_s < 0.23
    assert position.worst_ratio > 1.004 * position.ratio.max()
    assert position.status is Status.VIOLATED


def test_random_plants_of_the_box_keep_the_bounds(section_5_1):
    rng, model = np.random.default_rng(3), section_5_1.model
    columns = [rng.uniform(*pair, 400) for pair in ranges_of(model.study)]
    plants = Plants(*columns, np.full(400, model.plants.share_a[0]))
    omega = np.geomspace(0.3, 300, 600)
    found = sides(omega, model.loops(section_5_1.gains, plants=plants), model.nominal)
    for row, condition in enumerate(section_5_1.conditions):
        assert found.ratio[row].max() <= condition.certified.bound


def test_a_limit_between_both_bounds_is_told_by_a_finer_proof(on_corners):
    proofs = on_corners.certificates
    found = proofs.of("position", "none", "equation_21")
    for share, kept in ((1 - 1e-4, False), (1 + 1e-4, True)):
        limit = share * found.attained
        finer, grounds = against(proofs.problem, found, limit)
        assert grounds is Grounds.CERTIFIED
        assert (finer.bound <= limit) == kept
    _, grounds = against(proofs.problem, found, found.attained)
    assert grounds is Grounds.OPEN


def test_a_requirement_that_only_an_open_proof_could_tell_is_undecided(load_boom, on_corners):
    limit = on_corners.position.worst_ratio
    swept = sweep(
        load_boom(f"requirements.position_ratio={limit!r}", uncertainty="section-5-1", corners=True)
    )
    assert swept.position.status is Status.UNDECIDED
    assert swept.position.grounds is Grounds.OPEN
    assert not swept.satisfied


@pytest.mark.parametrize(
    ("limit", "status"),
    [("1.20", Status.SATISFIED), ("1.2399", Status.SATISFIED), ("1.2402", Status.VIOLATED)],
)
def test_a_gain_margin_is_certified_as_it_runs(load_boom, limit, status):
    study = load_boom(f"requirements.gain_margin={limit}", uncertainty="section-5-1", corners=True)
    check = next(one for one in sweep(study).checks if one.key == "gain_margin")
    assert check.status is status
    assert check.grounds is Grounds.CERTIFIED
    assert study.uncertainty.mass[0] <= check.at.mass_kg <= study.uncertainty.mass[1]


def test_a_curve_is_certified_over_frequency(load_boom):
    pairs = '[["10 rad/s", 0.4], ["100 rad/s", 0.36]]'
    swept = sweep(load_boom(f"requirements.position_ratio={pairs}", uncertainty="section-5-1"))
    use = swept.position.ratio / swept.position.allowed
    assert swept.position.worst_use == pytest.approx(use.max(), rel=1e-4)
    assert swept.position.status is Status.SATISFIED
    assert swept.position.grounds is Grounds.CERTIFIED


def test_an_unstable_plant_that_the_grid_lacks_is_a_witness(load_boom):
    """Fig. 5's worst plant with the path is unstable; a grid of light plants alone has it."""
    study = load_boom('model.measurement_path="filters"', corners=True, twice=True)
    swept = sweep(study)
    check = next(one for one in swept.checks if one.key == "unstable_plants")
    assert check.status is Status.UNSTABLE
    proofs = swept.certificates
    assert proofs.stable("force_reference", "filters").status is Stability.UNSTABLE
    assert proofs.of("force_reference", "filters", "sensitivity_peak").attained == np.inf


def test_measured_responses_are_judged_on_their_points(load_measured):
    omega = np.geomspace(0.5, 600, 200)
    force = np.exp(-1j * omega * 0.012) / (1 + 1j * omega * 0.005)
    beside = sweep(load_measured(omega, force, "uncertainty.points=2"))
    assert {one.grounds for one in beside.conditions} == {Grounds.GRID}
    assert beside.velocity.certified is not None
    instead = sweep(load_measured(omega, force, "uncertainty.points=2", place="instead"))
    assert instead.certificates is None
    assert instead.velocity.certified is None


def test_json_holds_bounds_and_radii(on_corners):
    values = with_radii(on_corners).json()
    json.dumps(values, allow_nan=False)
    assert set(values["velocity"]["certified"]) == {"attained", "bound", "closed"}
    assert values["velocity"]["grounds"] == "certified"
    words = {(one["loop"], one["path"], one["figure"]) for one in values["bounds"]}
    assert ("force_reference", "sampled", "disk_margin") in words
    assert len(words) == len(values["bounds"]) == 20
    assert set(values["radius"]) == {"equation_17", "equation_21", "true", "with_path", "sampled"}
    expected = {"equation_17": 6.04, "equation_21": 2.668, "with_path": 1.3955, "sampled": 1.406}
    for name, radius in expected.items():
        low, high = values["radius"][name]
        assert low <= radius <= high <= 1.0101 * low


def test_radii_can_be_closed_further(on_corners):
    closer = radii_of(on_corners.certificates, "none", 1e-3)
    for one in closer.values():
        assert one.closed
        assert one.upper <= 1.0011 * one.lower


def test_no_hold_fits_into_a_short_delay(load_boom):
    study = load_boom(
        'uncertainty.delay=["2 ms", "10 ms"]',
        'uncertainty.delay_as_it_runs=["2 ms", "10 ms"]',
        'uncertainty.nominal.delay="2 ms"',
        "objective.tracking_loop=continuous",
        corners=True,
    )
    proofs = sweep(study).certificates
    assert {one.path for one in proofs.bounds} == {"none", "filters"}


def test_gains_without_position_control_are_certified(load_boom):
    model = LinearModel.of(load_boom(uncertainty="section-5-1", corners=True))
    gains = model.study.study.gains
    for changes in ({"k_i_pos": 0.0}, {"k_i_pos": 0.0, "k_p_pos": 0.0}):
        swept = sweep(model, gains.model_copy(update=changes))
        assert swept.velocity.worst_ratio == pytest.approx(0.50866, abs=1e-4)
        assert all(one.closed for one in swept.certificates.bounds)
