"""The position filter among what the tuner may turn: searched, written, used by all that run."""

from __future__ import annotations

import math

import pytest

from mptune.errors import InputError
from mptune.export.constants import controller_numbers
from mptune.export.formats import Precision
from mptune.params.gains import GainsFile, gains_for, now, version, write_gains
from mptune.params.judged_on import judged_on
from mptune.params.load import load_study
from mptune.params.pack import pack_gains, pack_measured
from mptune.robust.model import LinearModel
from mptune.robust.sweep import noises_of
from mptune.tune.space import Choice, space_of
from mptune.tune.tuner import Tuner
from mptune.verify.verify import cases_of, rig_of

pytestmark = pytest.mark.compiled

SHORT = 0.008  # s
FREE = (
    "uncertainty.points=2",
    'objective={kind="tracking", tracking_loop="sampled", free=["position_filter"]}',
    "requirements.velocity_ratio=1.0",
    "requirements.position_ratio=1.0",
    'requirements.peak_compliance="3.2e-7 m/N"',
    "requirements.gain_margin=1.25",
)


@pytest.fixture(scope="module")
def load_free(study_file):
    def load(*options):
        return load_study(study_file, [*FREE, *options], "section-5-1")

    return load


@pytest.fixture(scope="module")
def study(load_free):
    return load_free()


def test_the_filter_is_free_and_put_over_the_model(study):
    model = LinearModel.of(study)
    own = Choice.of(model)
    assert own.estimator.position_filter == 0.012
    space = space_of(model, 3e6)
    assert "position_filter" in space.names
    assert space.choice(space.point(own)).estimator.position_filter == pytest.approx(0.012)
    short = own._replace(estimator=own.estimator.model_copy(update={"position_filter": SHORT}))
    moved = short.put_over(model)
    assert moved.filters.filter_time == SHORT
    assert moved.filters == pack_measured(moved.study)
    assert moved.gains == model.gains


def test_where_it_would_do_nothing_or_move_the_inequalities_it_is_refused(load_free):
    with pytest.raises(InputError, match="a state estimator in its place"):
        load_free('estimator.kind="state"')
    with pytest.raises(InputError, match="one filter only"):
        load_free('model.measurement_path="filters"')


def test_a_search_turns_it_where_its_lag_costs_the_margin(load_free):
    tuner = Tuner(load_free('estimator.position_filter="20 ms"'))
    before = tuner.figures(tuner.before)
    own = tuner.before.gains
    held = {key: (getattr(own, key),) * 2 for key in ("omega", "xi", "tau", "k_i_pos")}
    found = tuner.searched(extra=held, first=tuner.before)[1]
    assert found.feasible
    assert found.choice.estimator.position_filter < 0.019
    assert tuner.figures(found.choice).tracking < before.tracking


def test_a_gains_file_takes_it_to_every_model_machine_and_target(study, study_file, tmp_path):
    inner = study.study
    estimator = inner.estimator.model_copy(update={"position_filter": SHORT})
    made = GainsFile(
        study=study.name,
        study_hash=study.hash(),
        version=version(),
        date=now(),
        margins="satisfied",
        closed_loop="not run",
        gains=inner.gains,
        feedforward=inner.feedforward,
        estimator=estimator,
        figures={},
        judged_on=judged_on(study),
    )
    path = write_gains(tmp_path / "gains.toml", made)
    other = load_study(study_file, [*FREE, "verification.repeats=1"], "section-5-1")
    file, differs = gains_for(other, path)
    assert differs == ()
    there, pole = file.put_over(other), math.exp(-0.5e-3 / SHORT)
    rig = rig_of(there, cases_of(there)[0], file.gains, file.feedforward)
    numbers = controller_numbers(there, file.gains, file.feedforward, Precision.DOUBLE)
    assert pack_measured(there).filter_pole == pole
    assert rig.signals.position_pole == pole
    assert numbers.value("position_pole") == pole
    noises = [noises_of(LinearModel.of(one), pack_gains(file.gains)) for one in (there, other)]
    assert noises[0]["noise_gain"] > noises[1]["noise_gain"]
