"""Ladders and ranges of weights: the paper's on its machine, and as large as another machine."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mptune.weigh.ladders import ladder
from mptune.weigh.scales import times_the_papers

PAPER = {
    "weight_switching": (12.5, 25, 50, 100, 200, 400, 800),
    "weight_loss": (10, 20, 40, 80, 160, 320, 640),
    "weight_converter": tuple(2e9 * 10**k for k in (0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5)),
}
OTHERS = ("error_width", "weight_common_mode", "weight_compression")


@pytest.mark.parametrize("name", ["boom", "boom-2dof", "boom-estimator"])
def test_the_papers_machine_has_the_papers_ladders_to_the_last_bit(load_shape, name):
    study = load_shape(name)
    assert {one: ladder(study, one) for one in PAPER} == PAPER
    assert {times_the_papers(study, one) for one in OTHERS} == {1.0}


@pytest.mark.parametrize(
    "name", ["crane", "fast", "three-pressure", "digital-valve", "four-chamber"]
)
def test_what_a_study_takes_itself_lies_on_its_ladders(load_shape, name):
    """So do Table 2's; the studies' own were chosen by other rules or by hand."""
    study = load_shape(name)
    for weight in PAPER if study.study.converters else list(PAPER)[:2]:
        rungs, own = ladder(study, weight), getattr(study.study.controller, weight)
        print(f"{name} {weight} {own:.3g}: {rungs[0]:.3g} to {rungs[-1]:.3g}")
        assert rungs[0] < own < rungs[-1]


def scaled(study, lengths, pressures, periods):
    """Return a machine like this one: all lengths, pressures and times so many times as large."""
    own = study.study
    flow = lengths**3 / periods / pressures**0.5
    changes = {
        "cylinder": {"bore": lengths, "rod": lengths},
        "valves": {"flow_coefficient": flow},
        "controller": {"sampling_period": periods},
        "supplies": {
            "low_pressure": pressures, "high_pressure": pressures, "converter_travel": lengths,
        },
    }  # fmt: skip
    update = {}
    for section, factors in changes.items():
        part = getattr(own, section)
        values = {key: factor * getattr(part, key) for key, factor in factors.items()}
        update[section] = part.model_copy(update=values)
    return study.model_copy(update={"study": own.model_copy(update=update)})


FACTORS = st.floats(0.2, 5.0)


@given(lengths=FACTORS, pressures=FACTORS, periods=FACTORS)
def test_weights_follow_their_units(boom, lengths, pressures, periods):
    """A machine alike in all but its size, its pressures and its pace decides alike."""
    other, force = scaled(boom, lengths, pressures, periods), pressures * lengths**2
    wanted = {
        "weight_switching": force,
        "weight_loss": force / (pressures * lengths**3),
        "weight_converter": force / (lengths**3 / periods * lengths**3),
        "error_width": force,
        "weight_common_mode": force / pressures,
        "weight_compression": force / (pressures * lengths**3),
    }
    found = {name: times_the_papers(other, name) for name in wanted}
    assert found == pytest.approx(wanted, rel=5e-3)
