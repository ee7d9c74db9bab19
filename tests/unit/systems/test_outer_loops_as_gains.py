"""The literature's outer loops are Eq. 22 with the gains that stand for them."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.loops.position import position_controller
from mptune.params.pack import pack_gains
from mptune.params.systems import CascadeLoop, PidLoop
from mptune.systems.eq22 import cascade_gains, pi_gains, pid_gains

S = 1j * np.geomspace(0.1, 1000, 60)


def eq22(gains):
    return position_controller(S, *pack_gains(gains)[1:])


def test_pi():
    gains = pi_gains(7e5, 13.0, 22.0)
    assert eq22(gains) == pytest.approx(13 + 22 / S)
    assert gains.k_p_vel == 7e5


def test_pid_with_a_filtered_derivative():
    loop = PidLoop.model_validate(
        {"k_p_vel": 7e5, "k_p": 12.0, "k_i": 22.0, "derivative_time": 0.02, "filter_time": 0.006},
        context={"si": True},
    )
    wanted = 12 * (1 + 0.02 * S / (0.006 * S + 1)) + 22 / S
    assert eq22(pid_gains(loop)) == pytest.approx(wanted)


def test_a_p_loop_around_a_pi_loop():
    """F = (K_P + K_I/s)(v_ref + K_x e − v), and of the reference's own velocity s e = v_ref − v."""
    loop = CascadeLoop.model_validate({"k_p": 7e5, "k_i": 1.5e6, "k_x": 10.0}, context={"si": True})
    gains = cascade_gains(loop)
    error = 1.0  # of position; its velocity is s e
    cascade = (7e5 + 1.5e6 / S) * (S * error + 10 * error)
    assert gains.k_p_vel * (S * error + eq22(gains) * error) == pytest.approx(cascade)
