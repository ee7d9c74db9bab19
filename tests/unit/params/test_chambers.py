"""Chambers of a study: what they make of the machine, and what is refused."""

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.export.constants import controller_numbers
from mptune.export.formats import Precision
from mptune.loops.family import derived_time_constants, time_constants_at
from mptune.loops.force_dynamics import force_dynamics
from mptune.params.pack import pack_chambers, pack_force, pack_machine
from mptune.params.packed import AREA, DEAD, HOSE, SIZE

TWO_LINES = (
    'lines=[{kind="tank", pressure="1 MPa"}, {kind="constant", pressure="12 MPa"}]',
    'edges={sizes=[1], states=["all"]}',
)


def chamber(side, area="10 cm^2", **others):
    values = {"side": side, "area": area, "dead_volume": "0.2 dm^3", **others}
    shown = (f'{key} = "{one}"' if isinstance(one, str) else f"{key} = {one}"
             for key, one in values.items())  # fmt: skip
    return f"{{{', '.join(shown)}}}"


def chambers(*texts):
    return f"chambers=[{', '.join(texts)}]"


PUSH, PULL = chamber("pushing"), chamber("pulling")
FOUR = chambers(PUSH, PULL, PUSH, PULL)


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        ((PUSH,), "1 chambers, where two or four"),
        ((PUSH, PULL, PUSH), "3 chambers, where two or four"),
        ((PUSH,) * 5, "5 chambers, where two or four"),
        ((PULL, PUSH), "chamber 1 pulling, where it is to be pushing"),
        ((PUSH, PUSH, PULL, PULL), "chamber 2 pushing, where it is to be pulling"),
        ((PUSH, chamber("pulling", valves=0.5)), "valves of different sizes"),
        ((PUSH, chamber("sideways")), "'pushing' or 'pulling'"),
        ((PUSH, chamber("pulling", "-1 cm^2")), "at least"),
    ],
)
def test_chambers_that_make_no_machine_are_refused(load_boom, texts, words):
    with pytest.raises(InputError, match=words):
        load_boom(chambers(*texts), *TWO_LINES, corners=True)


def test_more_combinations_than_allowed_are_refused_with_their_number(load_boom):
    with pytest.raises(InputError, match="4 chambers and 81 combinations"):
        load_boom(FOUR, *TWO_LINES, "controller.max_combinations=80", corners=True)


@pytest.mark.parametrize("key", ["hose.dynamics=true", "campaign.lines=[0, 1]"])
def test_hoses_too_short_for_lines_are_refused(load_boom, key):
    """Not those of no length, which one of four chambers may have; one of two has one always."""
    far, near = (chamber("pushing", hose_length=f"{length} m") for length in (0.06, 0.05))
    load_boom(chambers(far, PULL, PUSH, PULL), *TWO_LINES, key, corners=True)
    with pytest.raises(InputError, match=r"chambers\[3\].hose_length"):
        load_boom(chambers(far, PULL, near, PULL), *TWO_LINES, key, corners=True)
    with pytest.raises(InputError, match=r"hose.length_b.* = 0 mm is too short"):
        load_boom("hose.length_b=0 m", key, corners=True)


def test_the_cylinder_written_out_is_its_short_form(load_boom, boom):
    own, hose = boom.study.all_chambers, boom.study.hose
    written = [
        chamber(one.side, f"{one.area!r} m^2", hose_length=f"{one.hose_length!r} m",
                dead_volume=f"{one.dead_volume!r} m^3")
        for one in own
    ]  # fmt: skip
    study = load_boom(chambers(*written))
    packed = (pack_machine(one, 1.0, 1.2e9, 0.0) for one in (study, boom))
    assert next(packed) == pytest.approx(next(packed), rel=1e-14)
    assert pack_force(study) == pytest.approx(pack_force(boom), rel=1e-14)
    assert pack_chambers(study) is None
    assert study.study.share_a == pytest.approx(4 / 7, rel=1e-12)
    for one, other in zip(derived_time_constants(study), derived_time_constants(boom), strict=True):
        assert one == pytest.approx(other, rel=1e-13)
    assert hose.diameter == study.study.hose.diameter


def test_valves_that_both_of_two_chambers_have_are_the_machine_s(load_boom, boom):
    study = load_boom(chambers(*(chamber(side, valves=2) for side in ("pushing", "pulling"))))
    one = pack_machine(boom, 1.0, 1.2e9, 0.0).flow_coefficient
    assert pack_machine(study, 1.0, 1.2e9, 0.0).flow_coefficient == 2 * one
    gains, ahead = study.study.gains, study.study.feedforward
    numbers = controller_numbers(study, gains, ahead, Precision.DOUBLE)
    for own in numbers.chambers:
        assert {n.key: n.value for n in own}["flow_coefficient"] == 2 * one


def test_of_the_short_form_nothing_counts_beside_chambers(load_boom):
    plain, other = (
        load_boom(chambers(PUSH, PULL), f"cylinder.bore={bore} mm", corners=True)
        for bore in (80, 100)
    )
    assert np.isnan(other.study.cylinder.bore)
    assert plain.hash() == other.hash()
    assert "bore" not in plain.model_values()["cylinder"]
    assert plain.hash() != load_boom(chambers(PUSH, chamber("pulling", "9 cm^2"))).hash()


def test_chambers_are_packed_one_by_one_and_summed_by_side(load_shape):
    study = load_shape("four-chamber")
    packed, machine = pack_chambers(study), pack_machine(study, 1.0, 1.2e9, 0.0)
    assert packed.table[AREA] == pytest.approx([32e-4, -16e-4, 8e-4, -4e-4])
    assert packed.table[DEAD] == pytest.approx([0.2e-3] * 4)
    assert packed.table[HOSE] == pytest.approx([0.0] * 4)
    assert packed.table[SIZE].tolist() == [2, 1, 0.5, 0.5]
    assert (machine.area_a, machine.area_b) == pytest.approx((40e-4, 20e-4))
    assert machine.dead_a == pytest.approx(0.4e-3)
    whole = pack_force(study)
    for settings, size in zip(packed.settings, packed.table[SIZE], strict=True):
        assert settings.flow_coefficient == size * whole.flow_coefficient
        assert settings.weight_loss == whole.weight_loss


def test_a_side_s_lag_is_the_mean_of_its_chambers_by_area(load_boom):
    """Up to the first power of s; where all its lags are equal, G_F is Eq. 11 itself."""
    texts = [chamber("pushing", "30 cm^2", hose_length="1 m"), PULL]
    texts += [chamber("pushing", hose_length="2 m"), PULL]
    study = load_boom(chambers(*texts), *TWO_LINES, corners=True)
    tau_a, tau_b = time_constants_at(study, 9e8, 0.1)
    singles = [
        time_constants_at(load_boom(chambers(one, PULL), corners=True), 9e8, 0.1)[0]
        for one in (texts[0], texts[2])
    ]
    assert singles[0] != pytest.approx(singles[1], rel=1e-3)
    assert tau_a == pytest.approx(0.75 * singles[0] + 0.25 * singles[1], rel=1e-12)
    shares = np.array([30, 10, 10, 10]) / 60
    s = 1j * 1e-3 / max(singles)
    exact = sum(a / (tau * s + 1) for a, tau in zip(
        shares, (singles[0], tau_b, singles[1], tau_b), strict=True))  # fmt: skip
    lumped = force_dynamics(s, tau_a, tau_b, study.study.share_a)
    assert abs(lumped - exact) < 1e-2 * abs(s * tau_a) ** 2
