"""Commanded speeds of made-up runs, by hand, and of manoeuvres as they are put together."""

import numpy as np
import pytest

from mptune.params.manoeuvre import Manoeuvre
from mptune.signals.trajectory import reference
from mptune.sim.commanded import commanded_ticks, following
from mptune.sim.judge import set_figures
from mptune.sim.moves import moves_of
from mptune.sim.record import CommandedSpeed, Energies, RunRecord

TICK = 1e-3
TIME = TICK * np.arange(2000)
COMMAND = CommandedSpeed(0.0, 1.0, 2.0, 0.1)


def ramped(late=0.0):
    """0.1 m/s within 0.2 s and out again within the last 0.2 s of one, so much later."""
    return 0.1 * np.clip(np.minimum(TIME - late, 1 + late - TIME) / 0.2, 0, 1)


def run(velocity, place=0.0, sign=1.0, commands=(COMMAND,), travel=0.08):
    still, wanted = np.zeros(len(TIME)), ramped()
    way = np.cumsum(wanted) * TICK
    return RunRecord(
        sample_time=TICK,
        position_reference=sign * way,
        velocity_reference=sign * wanted,
        position=sign * (way + place),
        velocity=sign * velocity,
        force_reference=still,
        force=still,
        active=still == 0,
        ends=np.array([2.0]),
        travel=travel,
        energies=Energies(1.0, 1.0, 0.0, 1.0, {}),
        commands=tuple(one._replace(speed=sign * one.speed) for one in commands),
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_lag_is_that_of_the_half_speed_and_error_the_mean_square_s_root(sign):
    late = 0.1 * np.clip(np.minimum(TIME - 0.015, 1.015 - TIME) / 0.2, 0, 1)
    found = following(run(late, sign=sign))
    assert found.lag == pytest.approx(0.015, abs=1e-9)
    # 0.015 s of a ramp of 0.5 m/s² in 0.37 of the second, two ends of it cut off
    square = ((ramped() - late)[:1000] ** 2).mean()
    assert found.error == pytest.approx(np.sqrt(square))
    assert found.error == pytest.approx(0.0075 * np.sqrt(0.385), rel=0.02)
    assert found.overshoot == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_overshoot_is_the_way_beyond_the_stop_and_not_short_of_it(sign):
    beyond = np.where((TIME > 1.1) & (TIME < 1.2), 0.0007, -0.002)
    assert following(run(ramped(), beyond, sign)).overshoot == pytest.approx(0.0007)
    early = np.where(TIME < 1.0, 0.005, 0.0)  # before the reference stands
    assert following(run(ramped(), early, sign)).overshoot == pytest.approx(0.0, abs=1e-12)


def test_a_speed_that_is_never_reached_has_no_end_to_its_lag():
    assert following(run(0.4 * ramped())).lag == np.inf


def test_a_commanded_speed_has_no_position_index_and_a_move_no_lag():
    speed = set_figures(run(ramped(), 0.001))
    assert np.isnan(speed.performance_index_ms)
    assert speed.velocity_lag_ms == pytest.approx(0.0)
    move = set_figures(run(ramped(), 0.001, commands=()))
    assert move.performance_index_ms == pytest.approx(10.0)
    assert np.isnan([move.velocity_error_mm_s, move.velocity_lag_ms, move.stop_overshoot_mm]).all()


def test_of_a_mixed_set_the_index_is_of_the_moves_to_a_place():
    second = COMMAND._replace(begin=1.0, stop=1.5)
    place = np.where(TIME < 1.0, 0.002, 0.009)
    found = set_figures(run(ramped(), place, commands=(second,)))
    assert found.performance_index_ms == pytest.approx(20.0)
    assert commanded_ticks((second,), TICK, 2000).sum() == 1000


def manoeuvre(**values):
    return Manoeuvre.model_validate(values, context={"si": True})


def test_a_manoeuvre_of_a_speed_ramps_up_holds_and_stops_where_it_says():
    quintic = manoeuvre(distance=0.03, duration=0.5, rest=0.5)
    speed = manoeuvre(kind="velocity", speed=-0.05, ramp=0.1, duration=0.6, rest=0.4)
    moves = moves_of([quintic, speed])
    assert moves.commands == (CommandedSpeed(1.0, 1.6, 2.0, -0.05),)
    assert speed.net_distance == pytest.approx(-0.025)
    for at, wanted in ((1.0, 0.0), (1.05, -0.025), (1.1, -0.05), (1.5, -0.05), (1.55, -0.025)):
        assert reference(at, moves.pieces)[1] == pytest.approx(wanted, abs=1e-12)
    assert reference(1.7, moves.pieces) == pytest.approx((0.005, 0.0, 0.0), abs=1e-12)
    assert moves.travel == pytest.approx(0.055)
