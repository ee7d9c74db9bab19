"""Eq. 22 as python-control's transfer function, continuous or as the target runs it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.interop import transfer_function
from mptune.params.pack import pack_gains
from mptune.shape.structure import position, position_parameters
from mptune.signals.tustin import discretise

if TYPE_CHECKING:
    from control import TransferFunction

    from mptune.params.controller import Gains


def controller_to_control(gains: Gains, sampling_period: float | None = None) -> TransferFunction:
    """Return the position controller, from position error to velocity reference [1/s].

    It has no dead time, so that nothing is approximated. The velocity controller is the number
    ``gains.k_p_vel``; a loop with its dead time is ``SweepResult.to_control``.

    Parameters
    ----------
    gains
        The gains of Eq. 22.
    sampling_period
        T_S [s] for the controller discretised by Tustin, with ``dt``; continuous where None.

    Raises
    ------
    InputError
        If python-control is not installed.
    """
    packed = pack_gains(gains)
    if sampling_period is None:
        x = position_parameters(packed.k_p_pos, packed.k_i_pos, packed.omega, packed.xi)
        return transfer_function(*position(packed.tau).fraction(x), "position controller")
    law = discretise(packed, sampling_period)
    numerator, denominator = [law.b0, law.b1, law.b2], [1.0, law.a1, law.a2]
    if packed.k_i_pos > 0:
        integral = law.integral * np.polymul([1.0, 1.0], denominator)  # of (z + 1)/(z − 1)
        numerator = list(np.polyadd(np.polymul(numerator, [1.0, -1.0]), integral))
        denominator = list(np.polymul(denominator, [1.0, -1.0]))
    return transfer_function(
        numerator, denominator, "position controller under Tustin", sampling_period
    )
