"""Weights tried, ordered and searched on the simulator, with short moves."""

import numpy as np
import pytest

from mptune.campaign.workers import Workers
from mptune.errors import InputError
from mptune.params.controller import Controller
from mptune.params.load import load_study
from mptune.weigh.procedure import STEPS, by_the_papers_order
from mptune.weigh.search import open_search
from mptune.weigh.trial import (
    OBJECTIVES,
    Bench,
    Limits,
    Trial,
    limits_of,
    own_weights,
    with_weights,
)

MOVES = (
    'manoeuvre=[{distance="10 mm", duration="0.4 s", rest="0.1 s"},'
    ' {distance="-10 mm", duration="0.4 s", rest="0.1 s"}]'
)
TEAM = Workers(1, {"backend": "sequential"})


@pytest.fixture(scope="module")
def bench(load_boom):
    return Bench(load_boom(MOVES), TEAM, seeds=(1, 2), sets=1)


@pytest.mark.compiled
def test_the_same_weights_give_the_same_figures_and_others_do_not(bench):
    own = own_weights(bench.study)
    one, again = bench.tried(own), bench.tried(own)
    assert np.array_equal(one.figures, again.figures, equal_nan=True)
    other = bench.tried(own._replace(weight_switching=800.0))
    assert other.mean("valve_switches") < one.mean("valve_switches")  # what W_sw is for
    assert len(one.figures) == 4  # two masses, two seeds


@pytest.mark.compiled
def test_without_its_weight_converter_pistons_go_further(load_boom):
    bench = Bench(load_boom(), TEAM, seeds=(1,), sets=2)
    own = own_weights(bench.study)
    assert bench.tried(own).unstable == 0
    without = bench.tried(own._replace(weight_converter=0.0))
    assert without.converter_peak == pytest.approx(0.075)  # at their ends, as FINDINGS has it
    assert without.unstable == 2
    assert not limits_of(bench.study, bench.tried(own)).keeps(without)


def test_only_the_weights_of_a_study_change(boom):
    own = own_weights(boom)
    changed = with_weights(boom, own._replace(weight_loss=1.0)).study
    assert changed.controller.weight_loss == 1.0
    assert changed.model_copy(update={"controller": boom.study.controller}) == boom.study


class Modelled:
    """A bench with laws instead of a machine: every weight does one thing."""

    def __init__(self, study):
        self.study = study
        self.tried_weights = []

    def tried(self, weights):
        self.tried_weights.append(weights)
        figures = np.ones((2, 12))
        columns = dict(zip(OBJECTIVES, (0, 0, 0, 0), strict=True))
        columns["performance_index_ms"] = 15 * (1 + weights.weight_loss / 1000)
        columns["force_error_integral_kn2s"] = 40 * (1 + weights.weight_switching / 1000)
        columns["converter_peak_mm"] = min(75, 75 * (1e11 / weights.weight_converter) ** 0.25)
        from mptune.campaign.simulate import FIGURES

        for name, value in columns.items():
            figures[:, FIGURES.index(name)] = value
        return Trial(weights, (1, 2), figures, int(columns["converter_peak_mm"] >= 75))


def test_the_papers_order_stops_each_weight_where_its_error_grows(boom):
    bench = Modelled(boom)
    weights, steps = by_the_papers_order(bench, own_weights(boom))
    # 75 mm (1e11/W)^¼ ≤ 60 mm from W = 2.44e11 on: the next of the ladder is 6.3e11.
    assert weights.weight_converter == pytest.approx(2e9 * 10**2.5)
    assert weights.weight_loss == 80.0  # 160 would cost 16 % of the index
    assert weights.weight_switching == 200.0  # 400 would cost 40 % of the force error
    order = [step.weight for step in steps]
    assert order == sorted(order, key=["weight_converter", "weight_loss", "weight_switching"].index)
    assert [step.kept for step in steps].count(False) == len(steps) - 1 - 4 - 5


def test_without_converters_their_weight_is_left_alone(root, tmp_path):
    study = load_study(root / "studies" / "three-pressure" / "study.toml")
    own, limits = own_weights(study), Limits(np.inf, 0.0, 20e6)
    weights, steps = by_the_papers_order(Modelled(study), own)
    assert {step.weight for step in steps} == {"weight_loss", "weight_switching"}
    assert weights.weight_converter == own.weight_converter

    class Model(Bench):
        def tried(self, weights):
            return Modelled(study).tried(weights)

    storage = f"sqlite:///{tmp_path / 'one.db'}"
    trials = open_search(Model(study, TEAM), storage).run(5, (own,), limits)
    assert {one.weights.weight_converter for one in trials} == {own.weight_converter}
    assert len({one.weights.weight_loss for one in trials}) == 5


def test_the_papers_order_tells_how_far_it_is(boom):
    told, bench = [], Modelled(boom)
    _, steps = by_the_papers_order(bench, own_weights(boom), lambda *one: told.append(one))
    assert [share for _, share in told] == [(n + 1) / STEPS for n in range(len(steps))]
    assert {stage for stage, _ in told} == {"weights by the paper's order"}


@pytest.mark.parametrize("sampler", ["tpe", "nsga2"])
def test_an_interrupted_search_goes_on_as_if_it_had_not_been(boom, tmp_path, sampler):
    """Killed within a trial, after seven others: the remaining ones are the same."""
    own, limits = own_weights(boom), Limits(0.075, 0.0, 20e6)

    class Killed(Bench):
        def __init__(self, after):
            super().__init__(boom, TEAM)
            self._model, self._after = Modelled(boom), after

        def tried(self, weights):
            if len(self._model.tried_weights) == self._after:
                raise KeyboardInterrupt
            return self._model.tried(weights)

    def search(name, after=1000):
        storage = f"sqlite:///{tmp_path / name}.db"
        return open_search(Killed(after), storage, sampler=sampler).run(20, (own,), limits)

    with pytest.raises(KeyboardInterrupt):
        search("killed", after=7)
    resumed, undisturbed = search("killed"), search("undisturbed")
    assert [trial.weights for trial in resumed] == [trial.weights for trial in undisturbed]
    assert resumed[0].weights == pytest.approx(own)
    assert len({trial.weights for trial in resumed}) > 15


def test_another_study_has_a_search_of_its_own(boom, load_boom, tmp_path):
    storage, limits = f"sqlite:///{tmp_path / 'one.db'}", Limits(0.075, 0.0, 20e6)

    class Model(Bench):
        def tried(self, weights):
            return Modelled(boom).tried(weights)

    first = open_search(Model(boom, TEAM), storage).run(3, (own_weights(boom),), limits)
    other = load_boom("cylinder.bore=81 mm")
    again = open_search(Model(other, TEAM), storage).run(1, (own_weights(other),), limits)
    assert (len(first), len(again)) == (3, 1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"sampler": "dice"}, "--sampler"),
        ({"also": ("mass",)}, "--also"),
        ({"storage": "nothing://x"}, "--storage"),
    ],
)
def test_bad_options_are_refused(boom, tmp_path, options, message):
    options = {"storage": f"sqlite:///{tmp_path / 'one.db'}", **options}
    with pytest.raises(InputError, match=message):
        open_search(Bench(boom, TEAM), **options)


def test_without_optuna_the_extra_is_named(boom, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "optuna", None)
    with pytest.raises(InputError, match=r"mptune\[weights\]"):
        open_search(Bench(boom, TEAM), "sqlite://")


def test_sampling_period_and_tolerances_are_searched_where_asked(boom, tmp_path):
    class Model(Bench):
        def tried(self, weights):
            return Modelled(boom).tried(weights)

    storage = f"sqlite:///{tmp_path / 'one.db'}"
    search = open_search(Model(boom, TEAM), storage, also=("sampling_period", "tolerances"))
    tried = search.run(10, (own_weights(boom),), Limits(0.075, 0.0, 20e6))
    periods = {round(1e3 * trial.weights.sampling_period, 6) for trial in tried}
    assert len(periods) > 3
    assert min(periods) > 8  # the valve delay
    assert all(2 * period == round(2 * period) for period in periods)  # whole ticks
    stops = [trial.weights.position_tolerance_stop for trial in tried]
    starts = [trial.weights.position_tolerance_start for trial in tried]
    assert len(set(stops)) > 3
    assert starts == pytest.approx([1.4 * stop for stop in stops])


NEW_TERMS = ("error_width", "candidates", "weight_common_mode", "weight_compression")


@pytest.mark.parametrize(
    ("options", "also", "searched"),
    [
        ((), (), set()),
        (('controller.error="huber"', "controller.horizon=2"), (), {"error_width", "candidates"}),
        ((), ("common_mode",), {"weight_common_mode"}),
        (('controller.weight_common_mode="100 N/MPa"',), (), {"weight_common_mode"}),
        (('controller.force_model="steady-state"',), (), {"weight_compression"}),
    ],
)
def test_terms_that_the_decision_has_are_searched_and_no_others(
    load_boom, tmp_path, options, also, searched
):
    study = load_boom(*options)

    class Model(Bench):
        def tried(self, weights):
            return Modelled(study).tried(weights)

    own, storage = own_weights(study), f"sqlite:///{tmp_path / 'one.db'}"
    search = open_search(Model(study, TEAM), storage, also=also)
    tried = search.run(8, (own,), Limits(0.075, 0.0, 20e6))
    for name in NEW_TERMS:
        values = {getattr(trial.weights, name) for trial in tried}
        assert (len(values) > 3) == (name in searched)
        if name not in searched:
            assert values == {getattr(own, name)}
    for trial in tried:
        changed = with_weights(study, trial.weights).study.controller
        Controller.model_validate(changed.model_dump(), context={"si": True})
        assert isinstance(changed.candidates, int)
