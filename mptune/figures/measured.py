"""Measured responses of the force loop and what was fitted to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.escaping import figure_text
from mptune.figures.style import WORST, legend_below, new_figure, style
from mptune.identify.fit import model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from mptune.identify.fitted import Fit
    from mptune.identify.response import FrequencyResponse

_LOOKS = (("o", "#0072b2"), ("s", "#009e73"), ("^", "#cc79a7"), ("D", "#56b4e9"), ("v", "#e69f00"))


def fitted_responses(
    responses: Sequence[FrequencyResponse], fits: Sequence[Fit], share_a: float
) -> Figure:
    """Draw magnitude and phase of each response with its fit, and its coherence."""
    with style():
        figure = new_figure(6.4)
        magnitude, phase, coherence = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 1.4))
        for number, (one, fitted) in enumerate(zip(responses, fits, strict=True)):
            marker, color = _LOOKS[number % len(_LOOKS)]
            look = {"color": color, "marker": marker, "markersize": 3, "linewidth": 0}
            used = one.valid
            omega = one.omega[used]
            value = model(
                omega, np.array([fitted.tau_a[0], fitted.tau_b[0], fitted.delay[0]]), share_a
            )
            degrees = np.degrees(np.unwrap(np.angle(value)))
            turns = 360 * np.rint((degrees - one.degrees[used])[0] / 360)
            magnitude.plot(omega, one.decibels[used], label=figure_text(one.name), **look)
            phase.plot(omega, one.degrees[used] + turns, **look)
            coherence.plot(omega, one.quality[used], **look)
            label = "Eq. 11 with dead time, fitted"
            magnitude.plot(omega, 20 * np.log10(np.abs(value)), label=label, **WORST)
            phase.plot(omega, degrees, **WORST)
        magnitude.set(xscale="log", ylabel="Magnitude [dB]")
        phase.set(ylabel="Phase [°]")
        coherence.set(xlabel="Frequency [rad/s]", ylabel="Coherence [–]", ylim=(-0.05, 1.05))
        legend_below(figure, magnitude)
    return figure
