"""A figure of one loop: by its names, and as kernels take it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mptune.loops.broken import FORCE, POSITION, SAMPLED, VELOCITY

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.certify.problem import BoxedLoop
    from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant

EQUATION_17, EQUATION_21, MIXTURE, COMPLIANCE = 0, 1, 2, 3

Curve = tuple[tuple[float, float], ...]
"""Pairs of frequency [rad/s] and largest allowed ratio, frequencies rising."""

LOOPS = {"velocity": VELOCITY, "position": POSITION, "force_reference": FORCE}
EQUATIONS = {"equation_17": (EQUATION_17, VELOCITY), "equation_21": (EQUATION_21, POSITION)}
PEAK_COMPLIANCE = "peak_compliance"
SHARES = {  # of S and of T
    "sensitivity_peak": (1.0, 0.0),
    "complementary_peak": (0.0, 1.0),
    "disk_margin": (0.5, -0.5),
}


class Form(NamedTuple):
    """A figure of one loop, as kernels take it: all that does not vary over the box."""

    figure: int  # EQUATION_17, EQUATION_21, MIXTURE or COMPLIANCE
    loop: int  # of a mixture: VELOCITY, POSITION, FORCE or SAMPLED; of a compliance, the latter two
    share_s: float  # the mixture's part of S
    share_t: float  # and of T
    gains: LoopGains
    path: MeasurementPath
    nominal: NominalPlant
    share_a: float  # A_A/(A_A + A_B)
    period: float  # s, T_S


def form_of(problem: BoxedLoop, loop: str, path: str, figure: str) -> Form:
    """Return a figure as kernels take it.

    Raises
    ------
    ValueError
        If there is no such figure of that loop with that path.
    """
    which = LOOPS[loop]
    if figure in EQUATIONS:
        kind, belongs = EQUATIONS[figure]
        if which != belongs or path == "sampled":
            raise ValueError(f"{figure} is no figure of the {loop} loop with path {path!r}")
        shares = (0.0, 0.0)
    elif figure == PEAK_COMPLIANCE:
        if which != FORCE:
            raise ValueError(f"a compliance is the whole loop's, not the {loop} loop's")
        kind, shares = COMPLIANCE, (0.0, 0.0)
    else:
        kind, shares = MIXTURE, SHARES[figure]
    if path not in {"none", "sampled", problem.measured} or (
        path == "estimator" and which != FORCE
    ):
        raise ValueError(f"there is no {loop} loop with path {path!r}")
    if path == "sampled":
        if which != FORCE:
            raise ValueError(f"as it runs, the loop is broken at F_ref, not at {loop!r}")
        if not problem.holds_sampled:
            raise ValueError("some delay is below T_S/2, or there are no filters: nothing to run")
        which = SAMPLED
    return Form(
        kind,
        which,
        *shares,
        problem.gains,
        problem.path(path),
        problem.box.nominal,
        problem.share_a,
        problem.period,
    )


def scale_of(form: Form) -> float:
    """Return what a figure is to be multiplied by: a compliance is searched as |S|μ/|P|².

    With P = s m_N/K_P,vel that is |S|/(mω²) times K_P,vel²/m_N, whose inverse this is [m/N].
    """
    if form.figure != COMPLIANCE:
        return 1.0
    return form.nominal.mass / form.gains.k_p_vel**2


def curve_of(allowed: float | Curve) -> FloatArray:
    """Return a largest allowed ratio as kernels take it, ``(B, 2)``: empty for 1 throughout."""
    if isinstance(allowed, tuple):
        return np.array(allowed, np.float64).reshape(-1, 2)
    return np.zeros((0, 2)) if allowed == 1 else np.array([[1.0, float(allowed)]])
