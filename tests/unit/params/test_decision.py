"""The choices of ``[controller]`` for the decision: the paper's by default, and what is refused."""

import pytest

from mptune.errors import InputError
from mptune.params.pack import pack_force


def test_by_default_the_decision_is_the_paper_s(boom):
    controller, packed = boom.study.controller, pack_force(boom)
    assert (controller.error, controller.loss, controller.horizon) == ("absolute", "ends", 1)
    assert controller.force_model == "dynamic"
    assert controller.weight_common_mode == controller.weight_compression == 0
    assert packed.error_width == packed.path_loss == packed.candidates == packed.steady_state == 0


def test_each_choice_reaches_the_kernels_in_si(load_boom):
    packed = pack_force(
        load_boom(
            'controller.error="huber"', 'controller.error_width="1.5 kN"',
            'controller.loss="path"', "controller.horizon=2", "controller.candidates=9",
            'controller.weight_common_mode="300 N/MPa"',
            'controller.force_model="steady-state"', 'controller.weight_compression="60 N/J"',
        )
    )  # fmt: skip
    assert packed.error_width == 1500
    assert packed.path_loss == packed.steady_state == 1
    assert packed.candidates == 9
    assert packed.weight_common_mode == pytest.approx(3e-4)
    assert packed.weight_compression == 60
    assert packed.rest_velocity == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ('controller.error="square"', "controller.error"),
        ('controller.error_width="0 N"', "at least 0.001 N"),
        ("controller.horizon=3", "controller.horizon"),
        ("controller.candidates=0", "at least 1"),
        ("controller.candidates=785", "at most 784"),
        ('controller.weight_common_mode="3 N"', "controller.weight_common_mode"),
        ('controller.weight_compression="60 N/J"', "only the steady-state decision knows"),
    ],
)
def test_what_makes_no_sense_is_refused(load_boom, override, message):
    with pytest.raises(InputError, match=message):
        load_boom(override)
