"""Margins of the sampled loop, and the requirements that rest on it and on the noise gain."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mptune.errors import InputError
from mptune.loops.broken import FORCE
from mptune.loops.family import FamilyLoops
from mptune.loops.sampled import (
    coefficient_count,
    multipliers,
    sampled_loop,
    sampled_plant,
    stable_as_sampled,
)
from mptune.params.load import load_study
from mptune.params.packed import LoopGains, MeasurementPath, Plant, Plants
from mptune.robust.grid import first_grid
from mptune.robust.margins import sampled_margins
from mptune.robust.result import Status
from mptune.robust.sweep import sweep

PERIOD, FAST, SHARE_A = 0.01, 0.0005, 4 / 7
PATH = MeasurementPath(FAST, float(np.exp(-FAST / 0.012)), 0.012)
GAINS = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
GRID = first_grid(0.05, 2000.0)
DENSE = np.concatenate([np.geomspace(0.05, 20, 2000), np.linspace(20, np.pi / PERIOD, 12000)])

PLANTS = {
    "Sec. 5.1's worst": Plant(24500.0, 0.014, 0.0122, 0.0119, SHARE_A),
    "heavy": Plant(49000.0, 0.0123, 0.003, 0.0101, SHARE_A),
    "the hold alone": Plant(24500.0, 0.005, 0.0, 0.0, SHARE_A),
    "late": Plant(49000.0, 0.0215, 0.0, 0.0119, SHARE_A),
}


def alone(plant, gains=GAINS):
    """Return the loop of one plant."""
    return FamilyLoops(Plants(*(np.array([value]) for value in plant)), gains, PATH)


def margins_of(plant, gains=GAINS):
    found = sampled_margins(GRID, alone(plant, gains), PERIOD)
    return {name: float(getattr(found, name)[FORCE, 0]) for name in found._fields}


def dense_loop(plant):
    one = sampled_plant(plant, PATH, PERIOD, coefficient_count(plant.delay, PATH, PERIOD))
    return np.array([sampled_loop(1j * omega, one, GAINS, PERIOD) for omega in DENSE])


@pytest.mark.compiled
@pytest.mark.parametrize("name", PLANTS)
def test_margins_are_those_of_a_dense_grid(name):
    margins, loop = margins_of(PLANTS[name]), dense_loop(PLANTS[name])
    peak, other = np.abs(1 / (1 + loop)).max(), np.abs(loop / (1 + loop)).max()
    crossing = (np.diff(np.sign(loop.imag)) != 0) & (loop[1:].real < 0)
    factors = -1 / loop[1:][crossing].real
    least = factors[factors > 1].min()
    print(
        f"{name}: M_S {margins['sensitivity_peak']:.5f}, dense {peak:.5f}; "
        f"gain margin {margins['gain_margin']:.5f}, dense {least:.5f}"
    )
    assert margins["sensitivity_peak"] == pytest.approx(peak, rel=1e-5)
    assert margins["sensitivity_peak"] >= peak * (1 - 1e-12)
    assert margins["complementary_peak"] == pytest.approx(other, rel=1e-5)
    assert margins["gain_margin"] == pytest.approx(least, rel=2e-3)
    assert 1 / margins["disk_margin"] == pytest.approx(
        np.abs((1 - loop) / (1 + loop)).max() / 2, rel=1e-5
    )
    assert np.isnan(margins["delay_margin"])


def test_a_louder_loop_has_so_much_less_gain_margin():
    plant, louder = PLANTS["heavy"], GAINS._replace(k_p_vel=1.1 * GAINS.k_p_vel)
    left = margins_of(plant)["gain_margin"] / margins_of(plant, louder)["gain_margin"]
    assert left == pytest.approx(1.1, rel=1e-6)


def radius(loops):
    return np.abs(multipliers(loops, PERIOD)).max()


@pytest.mark.compiled  # interpreted, it would take minutes
@given(
    plant=st.builds(
        Plant,
        st.floats(8e3, 1e5),
        st.floats(0.005, 0.03),
        st.floats(0.0, 0.015),
        st.floats(0.0, 0.015),
        st.just(SHARE_A),
    ),
    gains=st.builds(
        LoopGains,
        st.floats(5e4, 1.2e6),
        st.floats(2.0, 30.0),
        st.floats(1.0, 60.0),
        st.floats(20.0, 100.0),
        st.floats(0.2, 1.5),
        st.floats(0.002, 0.03),
    ),
)
def test_at_the_gain_margin_a_multiplier_lies_on_the_circle(plant, gains):
    """And between the reduction and the margin the loop stays stable."""
    loops = alone(plant, gains)
    assume(stable_as_sampled(loops, PERIOD)[0][0])
    margins = margins_of(plant, gains)
    for name in ("gain_margin", "gain_reduction"):
        factor = margins[name]
        if not 0 < factor < np.inf:
            continue
        assert radius(loops.scaled(factor)) == pytest.approx(1, abs=1e-7)
    for share in (0.02, 0.5, 0.98):
        inner = margins["gain_reduction"] ** (1 - share) * margins["gain_margin"] ** share
        if 0 < inner < np.inf:
            assert radius(loops.scaled(inner)) < 1


def check_of(result, name):
    (check,) = [check for check in result.checks if check.key == name]
    return check


def found_with(load_boom, name, **options):
    """Return what the published gains have."""
    limit = "1 N/m" if name == "noise_gain" else "50"
    return check_of(sweep(load_boom(f"requirements.{name}={limit}", **options)), name).found


NEW = ["gain_margin", "sampled_sensitivity_peak", "noise_gain"]


@pytest.mark.compiled  # interpreted, it would take minutes
@pytest.mark.parametrize("name", NEW)
def test_a_limit_is_met_on_one_side_of_what_is_found_and_violated_on_the_other(load_boom, name):
    options = {"uncertainty": "section-5-1", "corners": True}
    found = found_with(load_boom, name, **options)
    unit = " N/m" if name == "noise_gain" else ""
    at_least = name == "gain_margin"
    print(f"{name}: {found:.6g}{unit}")
    for factor in (1 - 2e-5, 1 + 2e-5):  # what is sampled is certified to about 1e-5
        study = load_boom(f"requirements.{name}={factor * found!r}{unit}", **options)
        result = sweep(study)
        met = (factor < 1) == at_least
        assert check_of(result, name).status is (Status.SATISFIED if met else Status.VIOLATED)
        assert result.satisfied == met


@pytest.mark.compiled  # interpreted, it would take minutes
@pytest.mark.parametrize("name", ["gain_margin", "sampled_sensitivity_peak"])
def test_an_unstable_family_has_no_sampled_margin(load_boom, name):
    result = sweep(load_boom(f"requirements.{name}=1.1", corners=True, twice=True))
    check = check_of(result, name)
    assert check.status is Status.UNSTABLE
    assert np.isnan(check.found)
    assert check.at is not None
    assert not result.satisfied


@pytest.mark.compiled  # interpreted, it would take minutes
@pytest.mark.parametrize(("shortest", "room"), [("4.99 ms", False), ("5 ms", True)])
def test_without_room_for_the_hold_nothing_sampled_is_evaluated(load_boom, shortest, room):
    result = sweep(
        load_boom(
            f'uncertainty.delay_as_it_runs=["{shortest}", "11 ms"]',
            "objective.tracking_loop=continuous",
            "requirements.gain_margin=1.01",
            "requirements.sampled_sensitivity_peak=50",
            corners=True,
        )
    )
    assert (result.sampled is not None) == room
    for name in ("gain_margin", "sampled_sensitivity_peak"):
        status = check_of(result, name).status
        assert (status is Status.NOT_EVALUATED) != room
    assert result.satisfied == room


@pytest.mark.compiled  # interpreted, it would take minutes
def test_without_an_integral_term_the_sampled_family_is_as_stable_as_the_others(load_boom):
    result = sweep(
        load_boom("gains.k_i_pos=0 1/s^2", uncertainty="section-5-1", corners=True),
    )
    assert result.sampled.unstable_count == result.family("filters").unstable_count == 0


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("gain_margin", "1.0"),
        ("gain_margin", "-2"),
        ("gain_margin", '"6 dB"'),
        ("sampled_sensitivity_peak", "1.0"),
        ("sampled_sensitivity_peak", "nan"),
        ("noise_gain", '"0 N/m"'),
        ("noise_gain", '"1e7 N"'),
        ("noise_gain", "1e7"),
    ],
)
def test_a_bad_limit_is_refused_by_name(write_study, key, value):
    with pytest.raises(InputError, match=rf"requirements\.{key}"):
        load_study(write_study({f"requirements.{key}": value}))


def test_limits_are_read_in_their_units(write_study):
    limits = {"gain_margin": "1.5", "sampled_sensitivity_peak": "2", "noise_gain": '"30 kN/mm"'}
    study = load_study(write_study({f"requirements.{key}": v for key, v in limits.items()}))
    asked = study.study.requirements
    assert (asked.gain_margin, asked.sampled_sensitivity_peak) == (1.5, 2.0)
    assert asked.noise_gain == pytest.approx(30e6)
