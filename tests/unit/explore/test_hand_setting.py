"""What the sliders hold makes the study that ``--set`` makes, and fits into an address."""

import pytest

from mptune.errors import InputError
from mptune.explore.history import History
from mptune.explore.knobs import KNOBS
from mptune.explore.setting import KIND, HandSetting
from mptune.explore.study_text import as_toml
from mptune.params.load import load_study

TURNED = {
    "gains.k_p_vel": 650e3,
    "uncertainty.mass": (20e3, 60e3),
    "estimator.position_filter": 0.01,
    "feedforward.acceleration_mass": 2e4,
    KIND: "state",
}


@pytest.fixture(scope="module")
def study(load_boom):
    return load_boom(corners=True)


@pytest.fixture(scope="module")
def turned(study):
    setting = HandSetting(plant="nominal", loop="velocity", path="with")
    for key, value in TURNED.items():
        setting = setting.turn(key, value, study)
    return setting


@pytest.mark.parametrize("uncertainty", ["", "section-5-1"])
def test_it_makes_the_study_that_set_makes(study_file, turned, uncertainty):
    written = load_study(study_file, (), uncertainty)
    made = turned.put_over(written)
    loaded = load_study(study_file, turned.overrides(written), uncertainty)
    assert made.hash() == loaded.hash()
    assert made.study.gains == loaded.study.gains
    assert made.study.feedforward == loaded.study.feedforward
    assert made.hash() != written.hash()


def test_an_address_holds_it(turned):
    assert HandSetting.from_query("?" + turned.query()) == turned
    assert HandSetting().query() == ""


@pytest.mark.parametrize(
    "query",
    ["gains.xi=much", "uncertainty.mass=1", "gains.xi=1..2", "plant=best", "estimator.kind=none"],
)
def test_an_address_that_cannot_be_read_is_refused(query):
    with pytest.raises(InputError, match="the address"):
        HandSetting.from_query(query)


def test_what_no_study_may_say_is_refused_by_its_key(study):
    with pytest.raises(InputError, match=r"gains\.tau"):
        HandSetting().turn("gains.tau", -1.0, study).put_over(study)
    assert HandSetting.from_query("evil=1&__class__=2") == HandSetting()


def test_back_at_the_study_s_own_value_nothing_is_turned(study, turned):
    for key in TURNED:
        own = "filters" if key == KIND else KNOBS[key].value_in(study)
        turned = turned.turn(key, own, study)
    assert turned.turned == ()
    assert turned.put_over(study) == study


def test_every_slider_reaches_beyond_the_study_s_own_value(study):
    for knob in KNOBS.values():
        low, high, step = knob.ends(study)
        own = knob.value_in(study)
        least, largest = own if isinstance(own, tuple) else (own, own)
        assert knob.bounds[0] <= low <= least <= largest < high <= knob.bounds[1], knob.key
        assert 0 < step < (high - low) / 50, knob.key


def test_history_goes_back_and_forth(study):
    steps = [HandSetting().turn("gains.xi", 0.1 * n, study) for n in range(1, 4)]
    history = History(HandSetting())
    for one in steps:
        history = history.to(one)
    assert history.undone().now == steps[1]
    assert history.undone().undone().redone().now == steps[1]
    assert history.undone().to(HandSetting()).future == ()
    kept = history.undone().keeping().redone()
    assert (kept.swapped().now, kept.swapped().kept) == (steps[1], steps[2])
    assert History(steps[0]).undone().now == steps[0]


def test_toml_that_is_copied_loads_as_the_same_controller(study, turned, study_file, write_study):
    text = as_toml(turned.put_over(study), [key for key, _ in turned.turned])
    assert "[uncertainty]" not in text
    lines = [line for line in text.splitlines() if " = " in line]
    names = {line.split(" = ")[0]: line.split(" = ")[1] for line in lines}
    assert names["k_p_vel"] == '"650000.0 N s/m"'
    sections = {
        "position_filter": "estimator",
        "kind": "estimator",
        "acceleration_mass": "feedforward",
    }
    changes = {f"{sections.get(key, 'gains')}.{key}": value for key, value in names.items()}
    assert load_study(write_study(changes)).study.gains.k_p_vel == 650e3
