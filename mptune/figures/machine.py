"""Fig. 6 and Fig. 7: one movement set of the nonlinear machine under its controller."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from mptune.figures.style import NOMINAL, REFERENCE, SECOND, WORST, legend_below, new_figure, style
from mptune.params.chambers import LETTERS
from mptune.sim import closed_loop as loop

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from mptune.params.controller import Feedforward
    from mptune.sim.record import RunRecord
    from mptune.verify.result import CaseResult

_LOOKS = (("0.0", "-"), ("0.25", "--"), ("0.4", "-."), ("0.5", ":"))
_DRAWN = 2000  # points per curve


def machine_traces(case: CaseResult, feedforward: Feedforward | None = None) -> Figure:
    """Draw position, error, velocity, pressures, force, its error, valve states and converters.

    Parameters
    ----------
    case
        The machine's verification.
    feedforward
        What was fed forward. Of a mass that is learnt on line the estimate is drawn too, beside the
        machine's own, which a boom's table multiplies.
    """
    learns = feedforward is not None and feedforward.adaptive_mass
    record = case.record
    chambers = 0 if record.pressures is None else record.pressures.shape[1]
    columns = loop.chamber_columns(case.converters, chambers).states
    few = slice(None, None, max(len(case.traces) // _DRAWN, 1))
    time, trace = record.time[few], case.traces[few]
    with style():
        figure = new_figure(9.3)
        count = 6 + len(columns) + (case.converters > 0) + learns
        axes = figure.subplots(count, 1, sharex=True)
        _motion(axes[:3], record, few)
        _forces(axes[3:6], record, few)
        rows = axes[6 : 6 + len(columns)]
        for one, column, chamber in zip(rows, columns, LETTERS, strict=False):
            one.step(time, trace[:, column], where="post", **{**NOMINAL, "linewidth": 0.7})
            for border in np.cumsum(case.states)[1:-1]:
                one.axhline(border - 0.5, **REFERENCE)  # between the kinds of valve states
            one.set(ylabel=f"State {chamber} [–]", ylim=(-1, sum(case.states)))
        behind = axes[6 + len(columns) :]
        for i, (grey, dashes) in zip(range(case.converters), cycle(_LOOKS)):
            look = {"linewidth": 1.1, "color": grey, "linestyle": dashes}
            place = 1e3 * trace[:, loop.CONVERTER_1 + i]
            behind[0].plot(time, place, label=f"converter {i + 1}", **look)
        if case.converters:
            behind[0].set_ylabel("Converter\n[mm]")
        if learns:
            axes[-1].plot(time, trace[:, loop.FED_MASS] / 1e3, **NOMINAL)
            axes[-1].axhline(case.mass_kg / 1e3, **REFERENCE)
            axes[-1].margins(y=0.2)
            axes[-1].set_ylabel("Learnt\nmass [t]")
        axes[-1].set(xlabel="Time [s]", xlim=(0, time[-1]))
        axes[0].set_title(
            f"{case.mass_kg / 1e3:g} t, oil {case.oil_bulk_modulus_pa / 1e6:g} MPa, "
            f"valve delay {_delays(case)} ms: {case.status.value}",
            loc="left",
        )
        figure.align_ylabels(axes)
        legend_below(figure, axes[0], axes[3], *behind)
    return figure


def _delays(case: CaseResult) -> str:
    low, high = (1e3 * delay for delay in case.valve_delay_s)
    return f"{low:g}" if low == high else f"{low:g}–{high:g}"


def _motion(
    axes: np.ndarray[tuple[int], np.dtype[np.object_]], record: RunRecord, few: slice
) -> None:
    position, error, velocity = axes
    time = record.time[few]
    position.plot(time, 1e3 * record.position[few], label="machine", **NOMINAL)
    position.plot(time, 1e3 * record.position_reference[few], label="reference", **REFERENCE)
    position.set_ylabel("Position\n[mm]")
    error.plot(time, 1e3 * record.error[few], **NOMINAL)
    error.set_ylabel("Error\n[mm]")
    velocity.plot(time, 1e3 * record.velocity[few], **NOMINAL)
    velocity.plot(time, 1e3 * record.velocity_reference[few], **REFERENCE)
    velocity.set_ylabel("Velocity\n[mm/s]")


def _forces(
    axes: np.ndarray[tuple[int], np.dtype[np.object_]], record: RunRecord, few: slice
) -> None:
    pressure, drawn, error = axes
    time, thin = record.time[few], {"linewidth": 0.9}
    if record.pressures is not None:
        looks = [{**SECOND, **thin, "linestyle": "-"}, {**WORST, **thin}]
        looks += [{**SECOND, **thin, "linestyle": ":"}, {**WORST, **thin, "linestyle": ":"}]
        for chamber, label, look in zip(record.pressures.T, LETTERS, looks, strict=False):
            pressure.plot(time, chamber[few] / 1e6, label=label, **look)
    pressure.set_ylabel("Pressure\n[MPa]")
    drawn.plot(time, record.force[few] / 1e3, **{**NOMINAL, **thin})
    drawn.plot(time, record.force_reference[few] / 1e3, **REFERENCE)
    drawn.set_ylabel("Force\n[kN]")
    active = np.where(record.active, record.force_error, np.nan)[few]
    error.plot(time, active / 1e3, **{**NOMINAL, **thin})
    error.set_ylabel("Force error\n[kN]")
