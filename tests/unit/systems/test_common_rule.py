"""The rule that chooses a system's best controller, on made-up systems."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from mptune.systems.bench import LoadCase
from mptune.systems.contender import Contender, Tuned
from mptune.systems.rule import best_of, candidates, judged

CASES = tuple(LoadCase(mass, 1.2e9, 9.7e3, 1, 5) for mass in (24.5e3, 49e3))


def made_up(gain, limit=10.0):
    """A system whose index falls with the gain, heavier loads being slower, up to a limit."""

    def run(case, factor):
        stable = factor * gain < limit
        index = case.mass / 1e3 / (factor * gain)
        return SimpleNamespace(stable=stable, worth=index if stable else np.inf)

    return Tuned(f"gain {gain:g}", "", run)


def test_the_worst_mass_counts_at_the_gain_as_it_is():
    assert judged(made_up(5.0), CASES, 1.5) == pytest.approx(49 / 5)


def test_a_gain_must_stand_being_raised():
    assert judged(made_up(7.0), CASES, 1.4) == pytest.approx(7.0)
    assert judged(made_up(7.0), CASES, 1.5) == np.inf


def test_the_least_worst_index_wins_among_those_that_stand():
    contender = Contender("x", "x", "", made_up(2.0), tuple(map(made_up, (4.0, 6.0, 8.0))))
    worsts = [judged(one, CASES, 1.5) for one in candidates(contender)]
    assert best_of(contender, worsts).name == "gain 6"


def test_there_is_no_best_one_where_none_stands():
    contender = Contender("x", "x", "", made_up(20.0))
    assert best_of(contender, [np.inf]) is None
