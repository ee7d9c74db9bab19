"""Stop motion logic: all valves shut while the piston stands where it should (§2.3.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.arrays import kernel

if TYPE_CHECKING:
    from mptune.params.packed import SignalSettings


@kernel
def stopped(was: bool, error: float, velocity_reference: float, settings: SignalSettings) -> bool:  # noqa: FBT001 - kernels know no keywords
    """Return whether the valves are to be shut.

    Parameters
    ----------
    was
        Whether they were.
    error
        x_ref − x [m].
    velocity_reference
        v_ref [m/s].
    settings
        Tolerances.
    """
    still = abs(velocity_reference) <= settings.velocity_tolerance
    if was:
        return still and abs(error) <= settings.start_tolerance  # Eq. 10
    return still and abs(error) <= settings.stop_tolerance  # Eq. 9
