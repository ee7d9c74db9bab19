"""Front, knee, limits and recommendation on trials whose figures are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mptune.campaign.simulate import FIGURES
from mptune.progress import silent
from mptune.weigh.recommend import STAGE, front, knee, not_dominated, recommended
from mptune.weigh.trial import OBJECTIVES, Limits, Trial, Weights, limits_of

OWN = Weights(100.0, 80.0, 2e11, 0.01, 5e-4, 7e-4)
LIMITS = Limits(0.0675, 0.5e6, 16e6)
SEEDS = (1, 2, 1, 2)


def trial(objectives, weights=OWN, jitter=0.01, converter=40.0, pressure=15.0, unstable=0):
    """Four runs, two seeds, whose means are ``objectives`` and whose seeds part by ``jitter``."""
    figures = np.ones((4, len(FIGURES)))
    sign = np.array([1, -1, 1, -1])
    for figure, value in zip(OBJECTIVES, objectives, strict=True):
        figures[:, FIGURES.index(figure)] = value * (1 + jitter * sign)
    figures[:, FIGURES.index("converter_peak_mm")] = converter
    figures[:, FIGURES.index("pressure_max_mpa")] = pressure
    return Trial(weights, SEEDS, figures, unstable)


@given(arrays(float, (7, 4), elements=st.integers(0, 4).map(float)))
def test_the_front_is_what_its_definition_says(values):
    best = not_dominated(values)
    for row, kept in zip(values, best, strict=True):
        beaten = any((other <= row).all() and (other < row).any() for other in values)
        assert kept != beaten
    assert best.any()


def test_the_knee_is_the_balanced_point():
    values = np.array([[0.0, 10.0, 0, 0], [2.0, 2.0, 0, 0], [10.0, 0.0, 0, 0]])
    assert knee(values) == 1


def test_spread_is_that_of_the_seeds_means():
    one = trial((20.0, 15.0, 40.0, 800.0), jitter=0.1)
    assert one.spread("energy_loss_j_per_mm") == pytest.approx(np.std([22, 18], ddof=1))
    assert one.mean("energy_loss_j_per_mm") == pytest.approx(20)


@pytest.mark.parametrize(
    "broken", [{"converter": 68.0}, {"pressure": 16.1}, {"unstable": 1}], ids=str
)
def test_what_breaks_a_limit_is_not_on_the_front(broken):
    better = trial((1.0, 1.0, 1.0, 1.0), **broken)
    assert max(LIMITS.excesses(better)) > 0
    assert front([trial((20.0, 15.0, 40.0, 800.0)), better], LIMITS) == (0,)


def test_without_converters_none_goes_anywhere():
    """Their figure is none; a run that has no figure at all is lost."""
    none = trial((20.0, 15.0, 40.0, 800.0), converter=np.nan)
    assert none.converter_peak == 0
    lost = Trial(OWN, SEEDS, np.full_like(none.figures, np.nan), 4)
    assert lost.converter_peak > 100


def test_limits_are_the_controllers_or_what_the_own_weights_do(boom):
    inside = limits_of(boom, trial((20.0, 15.0, 40.0, 800.0), pressure=15.0))
    beyond = limits_of(boom, trial((20.0, 15.0, 40.0, 800.0), pressure=17.0))
    assert (inside.pressure_max, beyond.pressure_max) == (16e6, 17e6)
    assert inside.converter_travel == pytest.approx(0.9 * 0.075)


class Known:
    """A bench that knows every weight's figures."""

    def __init__(self, study, table):
        self.study = study
        self._table = table

    def tried(self, weights):
        return trial(self._table[weights], weights)


def recommend(boom, others, progress=silent):
    own = (20.0, 15.0, 40.0, 800.0)
    table = {OWN: own}
    for number, objectives in enumerate(others):
        table[OWN._replace(weight_loss=float(number))] = objectives
    bench = Known(boom, table)
    trials = [bench.tried(weights) for weights in table]
    return recommended(bench, trials[0], [trials[k] for k in front(trials, LIMITS)], progress)


def test_the_recommendation_tells_how_far_it_is(boom):
    told = []
    recommend(boom, [(19.0, 15.0, 40.0, 700.0)], lambda *one: told.append(one))
    assert told == [(STAGE, 0.0), (STAGE, 1 / 7), (STAGE, 2 / 7)]


def test_weights_that_lose_nothing_and_win_clearly_are_recommended(boom):
    found = recommend(boom, [(19.0, 15.0, 40.0, 700.0), (10.0, 30.0, 20.0, 800.0)])
    assert found.dominates
    assert found.trial.weights.weight_loss == 0
    assert "valve_switches -12.5 %" in found.reason


def test_without_such_weights_the_knee_is_given_and_what_stands_in_the_way(boom):
    found = recommend(boom, [(19.0, 20.0, 40.0, 800.0), (10.0, 30.0, 20.0, 800.0)])
    assert not found.dominates
    assert "knee" in found.reason
    assert "performance_index_ms" in found.reason.split("at the knee that is")[1]


def test_better_by_less_than_chance_is_no_better(boom):
    found = recommend(boom, [(19.99, 15.0, 40.0, 800.0)])
    assert not found.dominates
    assert "clearly better in any figure" in found.reason


def test_alone_on_the_front_the_own_weights_stay(boom):
    found = recommend(boom, [])
    assert found.trial.weights == OWN
    assert not found.dominates
