"""Force references that excite the loop, and how a response is taken from each.

``sine`` is the paper's way: a run for each frequency. ``multisine`` excites all frequencies in one
run, in phases that keep its peak low; ``chirp`` sweeps through them. These two are faster, yet
at each frequency they have but a part of the amplitude, while the loop's ripple stays as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from mptune.errors import Fault, InputError
from mptune.identify.sine import fit_sine, whole_periods
from mptune.identify.spectrum import periodic_response, welch_response

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import ComplexArray, FloatArray, IntArray
    from mptune.params.controller import Controller
    from mptune.params.identification import Identification

    Analysis = Callable[[FloatArray, FloatArray], tuple[FloatArray, ComplexArray, FloatArray]]

_START_UP = 0.5  # s, left out of every record; the pressures settle within some sampling periods
_PERIODS = 4  # of the multisine
_ROUNDS, _CLIP = 300, 0.85  # of the search for a low peak, and where it clips
_SWEEPS = 3  # of the chirp


class Excitation(StrEnum):
    """Shape of the force reference."""

    SINE = "sine"
    MULTISINE = "multisine"
    CHIRP = "chirp"


def excitation_named(name: str) -> Excitation:
    """Return the excitation of that name.

    Raises
    ------
    InputError
        If there is none.
    """
    try:
        return Excitation(name)
    except ValueError as error:
        fault = Fault("", repr(name), "is no known shape", f"choose {', '.join(Excitation)}")
        raise InputError("--excitation", fault) from error


@dataclass(frozen=True)
class Run:
    """One force reference and its analysis.

    Attributes
    ----------
    reference
        ``(T,)`` F_ref at T_S,fast, start-up included [N].
    start_up
        Samples to leave out.
    analyse
        Takes the reference ``(T,)`` and the forces ``(N, T)`` without the start-up and returns
        frequencies ``(F,)``, responses ``(N, F)`` and their quality ``(N, F)``.
    """

    reference: FloatArray
    start_up: int
    analyse: Analysis


def runs_of(asked: Identification, controller: Controller, excitation: Excitation) -> list[Run]:
    """Return the runs that cover the frequencies asked for."""
    if excitation is Excitation.SINE:
        grid = np.geomspace(*asked.frequency, asked.frequencies)
        return [_sine(omega, asked, controller) for omega in grid]
    if excitation is Excitation.MULTISINE:
        return [_multisine(asked, controller)]
    return [_chirp(asked, controller)]


def _start_up(controller: Controller) -> int:
    return controller.ticks * int(np.ceil(_START_UP / controller.sampling_period))


def _sine(omega: float, asked: Identification, controller: Controller) -> Run:
    exact, length = whole_periods(omega, controller.sampling_period)
    tick, start_up = controller.fast_sampling_period, _start_up(controller)
    time = tick * np.arange(start_up + length * controller.ticks)

    def analyse(u: FloatArray, y: FloatArray) -> tuple[FloatArray, ComplexArray, FloatArray]:
        response, quality = fit_sine(u, y, tick, exact)
        return np.array([exact]), response[:, None], quality[:, None]

    return Run(asked.amplitude * np.sin(exact * time), start_up, analyse)


def _multisine(asked: Identification, controller: Controller) -> Run:
    """Return lines on a logarithmic grid, of equal amplitude."""
    low, high = asked.frequency
    samples = controller.ticks * int(np.ceil(2 * np.pi / (low * controller.sampling_period)))
    tick = controller.fast_sampling_period
    base = 2 * np.pi / (samples * tick)
    lines = np.unique(np.rint(np.geomspace(low, high, asked.frequencies) / base).astype(np.int64))
    best = _low_peak(samples, lines)
    best *= asked.amplitude / np.abs(best).max()
    omega = np.asarray(base * lines, np.float64)

    def analyse(u: FloatArray, y: FloatArray) -> tuple[FloatArray, ComplexArray, FloatArray]:
        found = [periodic_response(u, one, tick, omega, _PERIODS, "multisine") for one in y]
        return omega, np.stack([r.response for r in found]), np.stack([r.quality for r in found])

    return Run(np.tile(best, _PERIODS + 1), samples, analyse)


def _low_peak(samples: int, lines: IntArray) -> FloatArray:
    """Return lines of equal amplitude in phases that give a low peak, ``(T,)``.

    From random phases, the peaks are clipped and the clipped signal's phases are taken, again and
    again (van der Ouderaa, Schoukens and Renneboog 1988); the best signal on the way is returned.
    """
    phases = np.random.default_rng(0).uniform(-np.pi, np.pi, len(lines))
    best: FloatArray = np.full(samples, np.inf)
    for _ in range(_ROUNDS):
        spectrum = np.zeros(samples // 2 + 1, np.complex128)
        spectrum[lines] = np.exp(1j * phases)
        trial = np.fft.irfft(spectrum, samples)
        peak = np.abs(trial).max()
        if peak < np.abs(best).max():
            best[:] = trial
        phases = np.angle(np.fft.rfft(np.clip(trial, -_CLIP * peak, _CLIP * peak))[lines])
    return best


def _chirp(asked: Identification, controller: Controller) -> Run:
    """Return sweeps whose frequency rises by the same factor in the same time.

    A sweep takes two of the slowest periods, and so does a segment of Welch's method: below a few
    times the lowest frequency its window smears.
    """
    from scipy.signal import chirp

    low, high = asked.frequency
    tick, start_up = controller.fast_sampling_period, _start_up(controller)
    sweep = 2 * 2 * np.pi / low
    samples = round(sweep / tick)
    beyond = 1.1  # the ends of a sweep have little power
    one = chirp(
        tick * np.arange(samples),
        f0=low / beyond / (2 * np.pi),
        t1=sweep,
        f1=high * beyond / (2 * np.pi),
        method="logarithmic",
        phi=-90,
    )
    reference = asked.amplitude * np.tile(one, _SWEEPS)

    def analyse(u: FloatArray, y: FloatArray) -> tuple[FloatArray, ComplexArray, FloatArray]:
        found = [
            welch_response(u, one, tick, "chirp", segment=sweep, band=asked.frequency) for one in y
        ]
        omega = found[0].omega
        return omega, np.stack([r.response for r in found]), np.stack([r.quality for r in found])

    return Run(np.concatenate([np.zeros(start_up), reference]), start_up, analyse)
