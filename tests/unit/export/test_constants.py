"""The controller's numbers: those of the kernels, rounded where the target rounds."""

import math

import numpy as np
import pytest
from target import gains_of

from mptune.errors import InputError
from mptune.export.constants import controller_numbers
from mptune.export.formats import Precision
from mptune.force.cost import force_limits
from mptune.params.pack import pack_force, pack_gains, pack_signals
from mptune.signals.tustin import discretise


def numbers_of(study, precision=Precision.DOUBLE):
    file = gains_of(study)
    return controller_numbers(study, file.gains, file.feedforward, precision)


def test_the_numbers_are_the_kernels_own(study):
    numbers = numbers_of(study)
    controller = study.study.controller
    for packed in (pack_force(study), discretise(pack_gains(study.study.gains), 0.01)):
        for key, value in packed._asdict().items():
            assert numbers.value("integral_rate" if key == "integral" else key) == value
    for key in ("sample_time", "position_pole", "supply_pole", "backlash", "stop_tolerance"):
        assert numbers.value(key) == getattr(pack_signals(controller), key)
    assert (numbers.value("force_least"), numbers.value("force_largest")) == force_limits(
        pack_force(study)
    )
    assert numbers.ticks == controller.ticks


def test_poles_are_computed_at_export_so_that_the_target_needs_no_exponential(full_study):
    numbers = numbers_of(full_study)
    assert numbers.value("reference_pole") == math.exp(-0.5e-3 / 12e-3)
    assert numbers.value("position_pole") == math.exp(-0.5e-3 / 12e-3)
    assert numbers.value("acceleration_mass") == 30e3
    assert numbers.value("predicted_share") == 0.5


def test_every_number_has_a_name_of_its_own_and_a_meaning(study):
    numbers = numbers_of(study).all()
    assert len({one.key for one in numbers}) == len(numbers)
    assert all(one.unit and one.meaning and one.meaning.isascii() for one in numbers)


def test_single_precision_rounds_every_number(study):
    exact, rounded = numbers_of(study), numbers_of(study, Precision.FLOAT)
    for one, other in zip(exact.all(), rounded.all(), strict=True):
        assert other.value == float(np.float32(one.value))
    assert rounded.value("b0") != exact.value("b0")


@pytest.mark.parametrize("value", ["1e-50 N s/m^6", "1e-40 N s/m^6", "1e39 N s/m^6"])
def test_a_number_beyond_single_precision_is_refused(load_boom, value):
    study = load_boom(f'controller.weight_converter="{value}"', corners=True)
    numbers_of(study)
    with pytest.raises(InputError, match=r"weight_converter.*single precision.*--precision double"):
        numbers_of(study, Precision.FLOAT)
