"""Fig. 3: the force loop simulated at every operating point, beside Eq. 11 (§2.4)."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mptune.arrays import frozen
from mptune.errors import Fault, InputError
from mptune.force.cost import line_pressures
from mptune.force.search_space import space_of
from mptune.identify.excitation import Excitation, runs_of
from mptune.identify.experiment import Loop, chambers_at, run_force_loop
from mptune.identify.result import FitStatus, IdentifyResult, Panel
from mptune.loops.family import time_constants_at
from mptune.loops.force_dynamics import force_dynamics
from mptune.params.pack import pack_chambers, pack_force, pack_machine, pack_signals
from mptune.progress import silent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.identify.excitation import Run
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress

_OUTSIDE = 0.1  # largest share of the time with a pressure outside its limits
_LEAST_QUALITY = {Excitation.SINE: 0.0, Excitation.MULTISINE: 0.5, Excitation.CHIRP: 0.5}


class Setting(NamedTuple):
    """What the points of a panel have in common."""

    valve_delay: float  # s
    oil_bulk_modulus: float  # Pa
    position: float  # m


class RunResponse(NamedTuple):
    """What one run found at the operating points of one velocity."""

    omega: FloatArray  # (F,)
    response: ComplexArray  # (N, F)
    quality: FloatArray  # (N, F)
    status: IntArray  # (N, F)


def identify(
    study: ResolvedStudy,
    excitation: Excitation = Excitation.SINE,
    progress: Progress = silent,
) -> IdentifyResult:
    """Simulate the force loop's frequency response at the study's operating points.

    Parameters
    ----------
    study
        The study; its ``[identification]`` names excitation and operating points.
    excitation
        Shape of the force reference.
    progress
        Told of the stage ``"identify"``.

    Raises
    ------
    InputError
        If an operating point does not fit the machine, or a frequency the sampling period.
    """
    from joblib import Parallel, delayed

    check(study)
    asked = study.study.identification
    settings = tuple(
        Setting(*one) for one in product(asked.valve_delays, asked.oil_bulk_moduli, asked.positions)
    )
    runs = runs_of(asked, study.study.controller, excitation)
    least = _LEAST_QUALITY[excitation]
    parts = list(product(settings, runs, asked.velocities))
    jobs = (delayed(run_points)(study, *part, least) for part in parts)
    found = []
    for one in Parallel(n_jobs=-1, prefer="threads", return_as="generator")(jobs):
        found.append(one)
        progress("identify", len(found) / len(parts))
    each = len(parts) // len(settings)
    panels = (
        _panel(study, setting, found[k * each : (k + 1) * each])
        for k, setting in enumerate(settings)
    )
    return IdentifyResult(study, excitation, tuple(panels))


def check(study: ResolvedStudy) -> None:
    """Refuse operating points and frequencies that the machine does not have.

    Raises
    ------
    InputError
        With every fault found.
    """
    machine, asked = study.study, study.study.identification
    period = machine.controller.sampling_period
    dynamic = machine.controller.force_model == "dynamic"
    half_rate, stroke = math.pi / period, machine.cylinder.stroke
    estimate = machine.oil.bulk_modulus_estimate
    rules = (
        (
            "frequency", max(asked.frequency), half_rate, "rad/s",
            "is not below half the sampling frequency", "lower it",
        ),
        (
            "valve_delays", max(asked.valve_delays), period if dynamic else math.inf, "s",
            "is not below the sampling period (Table 2)", "take faster valves",
        ),
        (
            "positions", max(asked.positions), math.nextafter(stroke, math.inf), "m",
            "is beyond the stroke", "give positions within it",
        ),
        (
            "oil_bulk_moduli", max(asked.oil_bulk_moduli), math.nextafter(estimate, math.inf),
            "Pa", "is above the estimate; Eq. 12 needs B ≤ B̂", "raise oil.bulk_modulus_estimate",
        ),
    )  # fmt: skip
    faults = [
        Fault(f"identification.{key}", f"{value:g} {unit}", f"{rule}, {limit:g} {unit}", remedy)
        for key, value, limit, unit, rule, remedy in rules
        if value >= limit
    ]
    if not any(_start_pressures(study)[1]):
        rule = "leaves no operating point: p_B,0 is above p_max at each"
        faults.append(Fault("identification.pressures", "", rule, "add lower pressures"))
    if faults:
        raise InputError(study.name, *faults)


def _start_pressures(study: ResolvedStudy) -> tuple[list[float], list[bool]]:
    """Return every p_A,0 [Pa], and whether p_B,0 at zero load stays within p_max."""
    highest = study.study.controller.pressure_max
    ratio = study.study.area_a / study.study.area_b
    pressures = list(study.study.identification.pressures)
    return pressures, [ratio * one <= highest * (1 + 1e-9) for one in pressures]


def run_points(
    study: ResolvedStudy, setting: Setting, run: Run, velocity: float, least_quality: float
) -> RunResponse:
    """Simulate one run at each start pressure of one velocity, and take the responses."""
    machine = pack_machine(study, 1.0, setting.oil_bulk_modulus, 0.0)  # the piston is held
    signals, settings = pack_signals(study.study.controller), pack_force(study)
    space, lines = space_of(study), study.study.supplies
    supplies = line_pressures(lines.low_pressure, lines.high_pressure, space)
    more = pack_chambers(study)
    chambers = chambers_at(machine, setting.position, velocity, more)
    delay = setting.valve_delay
    loop = Loop(signals.sample_time, signals.ticks, delay, signals.pressure_pole, delay > 0)
    starts = [p for p, usable in zip(*_start_pressures(study), strict=True) if usable]
    forces = np.empty((len(starts), len(run.reference) - run.start_up))
    outside = np.empty(len(starts))
    areas = chambers.areas[:, None]
    pressures = np.empty((len(areas), len(run.reference)))
    for k, start in enumerate(starts):
        # All that pushes, and all that pulls, at one pressure each: they hold no load.
        balanced = start * machine.area_a / machine.area_b
        begin = np.where(chambers.areas > 0, start, balanced)
        run_force_loop(
            run.reference, begin, chambers, loop, supplies, space, settings, pressures, more
        )
        kept = pressures[:, run.start_up :]
        forces[k] = (areas * kept).sum(axis=0)
        beyond = (kept < settings.pressure_min) | (kept > settings.pressure_max)
        outside[k] = beyond.any(axis=0).mean()
    finite = np.isfinite(forces).all(axis=1)
    forces[~finite] = 0.0
    omega, response, quality = run.analyse(run.reference[run.start_up :], forces)
    status = np.full(response.shape, FitStatus.FITTED, np.int64)
    status[~(quality >= least_quality)] = FitStatus.POOR
    status[outside > _OUTSIDE] = FitStatus.OUT_OF_RANGE
    status[~finite] = FitStatus.NOT_FINITE
    response[status != FitStatus.FITTED] = np.nan
    return RunResponse(omega, response, quality, status)


def _panel(study: ResolvedStudy, setting: Setting, found: list[RunResponse]) -> Panel:
    """Put the runs of a panel together; they come run by run, each velocity by velocity."""
    velocities = study.study.identification.velocities
    starts, usable = _start_pressures(study)
    used = np.array(starts)[np.array(usable)]
    count = len(velocities)
    per_run = [found[k : k + count] for k in range(0, len(found), count)]
    omega = np.concatenate([parts[0].omega for parts in per_run])

    def joined(name: str) -> NDArray[Any]:
        rows = [np.concatenate([getattr(one, name) for one in parts]) for parts in per_run]
        return frozen(np.concatenate(rows, axis=1))

    tau_a, tau_b = time_constants_at(study, setting.oil_bulk_modulus, setting.position)
    period = study.study.controller.sampling_period
    s = 1j * omega
    theory = force_dynamics(s, tau_a, tau_b, study.study.share_a)  # Eq. 11
    return Panel(
        position_m=setting.position,
        oil_bulk_modulus_pa=setting.oil_bulk_modulus,
        valve_delay_s=setting.valve_delay,
        tau_a_s=float(tau_a),
        tau_b_s=float(tau_b),
        omega=frozen(omega),
        velocity=frozen(np.repeat(np.array(velocities), len(used))),
        pressure_a=frozen(np.tile(used, count)),
        skipped=count * (len(starts) - len(used)),
        response=joined("response"),
        quality=joined("quality"),
        status=joined("status"),
        theory=frozen(theory * np.exp(-s * (period / 2 + setting.valve_delay))),
    )
