"""Extreme studies: refused at once with what to change, or done in bounded time and memory."""

from __future__ import annotations

import os
import random
import time
from collections import defaultdict

import numpy as np
import pytest
from extremes import extremes, fields
from worker import BRIEF, outcomes

from mptune.errors import InputError
from mptune.figures.panels import step_horizon
from mptune.params.load import load_study
from mptune.robust.model import LinearModel
from mptune.sim.judge import performance_index
from mptune.sim.response import farthest
from mptune.sim.sampled import linear_moves

LONGEST, MOST = 20.0, 1000.0  # s, MB
EXTREMES = int(os.environ.get("EXTREMES", "100000"))  # studies that `make fuzz` runs at the most


@pytest.fixture(scope="module")
def brief(study_file):
    return load_study(study_file, BRIEF)


def test_every_quantity_states_its_least_and_its_largest_value():
    for key, extra, *_ in fields():
        assert extra["at_most"] is not None, key
        assert extra["at_least"] is not None or extra["above"] is not None, key


@pytest.mark.parametrize(
    ("key", "least", "largest"),
    [
        ("uncertainty.mass", "0.1 t", "1000 t"),
        ("uncertainty.delay", "1 ms", "1 s"),
        ("uncertainty.tau_a", "0 s", "1 s"),
        ("gains.tau", "0.1 ms", "1 s"),
    ],
)
def test_the_ranges_are_wide(study_file, key, least, largest):
    for value in (least, largest):
        text = f'"{value}"' if key == "gains.tau" else f'["{value}", "{value}"]'
        load_study(study_file, (*BRIEF, f"{key}={text}"))


_LONGER = 'manoeuvre=[{distance="1 mm", duration="1 s", rest="2 s"}]'
_SINE = 'manoeuvre=[{kind="sine", distance="1 mm", duration="1 s", rest="0 s", cycles=1000000000}]'
_SPEED = 'manoeuvre=[{kind="velocity", speed="11 m/s", duration="1 s", rest="0 s"}]'
REFUSED = [
    ('gains.tau="1e6 s"', "at most 1 s"),
    ('gains.tau="1e-9 s"', "at least"),
    ('gains.k_p_vel="1e300 N s/m"', "at most"),
    ('gains.omega="1e-6 rad/s"', "at least"),
    ("gains.xi=1e9", "at most"),
    ('uncertainty.mass=["1e-6 kg", "1e-6 kg"]', "at least"),
    ('uncertainty.mass=["1e12 kg", "1e12 kg"]', "at most"),
    ('uncertainty.delay=["1 ns", "1 ns"]', "at least"),
    ('uncertainty.delay=["2 s", "1000 s"]', "at most 1 s"),
    ('controller.fast_sampling_period="1e-7 s"', "at least"),
    ('manoeuvre=[{distance="1 mm", duration="1 s", rest="1e12 s"}]', "at most"),
    (_SINE, "at most"),
    ('manoeuvre=[{distance="1 mm", duration="1e-9 s", rest="1 s"}]', "shorter than a tick"),
    ('manoeuvre=[{distance="1 mm", duration="1 s", rest="9e3 s"}]', "GB for 1 machines"),
    ("verification.repeats=99999|controller.fast_sampling_period=10 us", "ticks"),
    ('systems.repeats=1000|manoeuvre=[{distance="1 mm", duration="1500 s", rest="0 s"}]', "system"),
    (_SPEED, "at most"),
    ("estimator.bandwidth=1e6 rad/s", "at most"),
    ("estimator.mass=1e9 kg", "at most"),
    ("uncertainty.points=51", "plants"),
    (f'{_LONGER}|uncertainty.delay=["1 us", "1 us"]', "steps of a move"),
]


@pytest.mark.parametrize(("override", "words"), REFUSED, ids=range(len(REFUSED)))
def test_what_does_not_fit_is_refused_at_once_with_its_size(study_file, override, words):
    begun = time.monotonic()
    with pytest.raises(InputError, match=words) as caught:
        load_study(study_file, (*BRIEF, *override.split("|")))
    assert time.monotonic() - begun < 1
    assert all(fault.remedy and fault.key for fault in caught.value.faults)


def test_every_extreme_loads_or_is_refused_with_a_remedy(study_file, brief):
    every = extremes(brief.study)
    assert len(every) > 1000
    some = random.Random(2).sample(every, 200)  # noqa: S311 - no secret
    for extreme in some:
        try:
            load_study(study_file, (*BRIEF, *extreme.overrides))
        except InputError as error:
            wordless = [fault for fault in error.faults if not (fault.rule and fault.remedy)]
            assert not wordless


@pytest.mark.parametrize("gain", ["0 1/s", "1e-9 1/s"])
def test_a_position_loop_that_is_open_or_nearly_so_is_drawn_in_bounded_time(study_file, gain):
    """Its position step never ends, or ends long after anything that matters."""
    study = load_study(study_file, (*BRIEF, f"gains.k_p_pos={gain}", "gains.k_i_pos=0 1/s^2"))
    model = LinearModel.of(study)
    loops = model.loops(study.study.gains)
    velocity, position = step_horizon(loops.gains, model.plants)
    assert position == velocity if gain[0] == "0" else position > 1e9
    assert farthest(loops) < 100


def test_moves_of_no_distance_have_no_index(study_file):
    still = 'manoeuvre=[{distance="0 mm", duration="0.3 s", rest="0 s"}]'
    for move in linear_moves(load_study(study_file, (*BRIEF, still))):
        assert move.stable
        assert move.json()["linear_check_index_ms"] is None


def test_an_index_without_motion_is_infinite_or_none():
    zeros = np.zeros(3)
    assert performance_index(np.ones(3), zeros) == np.inf
    assert np.isnan(performance_index(zeros, zeros))


@pytest.mark.fuzz
def test_extreme_studies_end_in_bounded_time_and_memory(study_file, brief):
    """Those that load are run; prints kind, tried, refused, failed, the most of time, and which.

    All of them take an hour; ``EXTREMES=300`` runs as many, picked at random.
    """
    every = extremes(brief.study)
    loading, table = [], defaultdict(lambda: [0, 0, 0, 0.0, 0.0, ""])
    for extreme in every:
        row = table[extreme.kind]
        row[0] += 1
        try:
            load_study(study_file, (*BRIEF, *extreme.overrides))
        except InputError:
            row[1] += 1
        else:  # what no command here runs is loaded alone
            loading += [extreme] * (not extreme.overrides[0].startswith("systems."))
    assert len(loading) >= 200
    picked = np.random.default_rng(len(loading)).permutation(len(loading))[:EXTREMES]
    loading = [loading[place] for place in sorted(picked)]
    print(f"{len(every)} studies, of which {len(loading)} are run")
    failed, ran = [], 0
    try:
        for one in outcomes(study_file, loading, LONGEST):
            row, ran = table[one.extreme.kind], ran + 1
            if one.seconds > row[3]:
                row[3], row[5] = one.seconds, ", ".join(one.extreme.overrides)
            row[4] = max(row[4], one.megabytes)
            if (
                one.words not in {"done", "refused"}
                or one.seconds > LONGEST
                or one.megabytes > MOST
            ):
                row[2] += 1
                failed.append(one)
                print(one)
    finally:  # interrupted, what was tried is shown as well
        print(f"{'kind':30} {'tried':>6} {'refused':>8} {'failed':>7} {'most s':>7} {'most MB':>8}")
        for kind, (tried, refused, wrong, seconds, size, slowest) in table.items():
            counts = f"{tried:6} {refused:8} {wrong:7}"
            print(f"{kind:30} {counts} {seconds:7.1f} {size:8.0f}  {slowest}")
        print(f"{ran} were run")
    assert not failed
