"""A family of plants, its loops, and the bounds that make their encirclement count certain."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numba
import numpy as np

from mptune.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    Real,
    kernel,
    parallel_kernel,
)
from mptune.loops.broken import FORCE, VELOCITY, loop_gain
from mptune.loops.estimated import estimated_terms, slowest_error, tail_of
from mptune.loops.force_dynamics import force_dynamics, pressure_time_constant
from mptune.loops.velocity import plant_at
from mptune.params.chambers import Side
from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant, Plants
from mptune.plant.bulk import effective_bulk_modulus
from mptune.signals.conditioning import filter_response
from mptune.summary import Summarised

if TYPE_CHECKING:
    from mptune.params.chambers import Chamber
    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy
    from mptune.params.uncertainty import UncertaintySet


def time_constants_at(
    study: ResolvedStudy, oil_bulk_modulus: Real, position: Real
) -> tuple[Real, Real]:
    """Return τ_A and τ_B [s] at one bulk modulus of the oil [Pa] and piston position [m].

    Arrays are broadcast. Where a side has more than one chamber its τ is their mean by area: with
    all references moved by F_ref/ΣA a side's force follows Σ A_i/(τ_i s + 1), which is lagged by
    one τ alone where they are equal, and else as by their mean up to the first power of s. See the
    ledger (``mptune.params.paper``) for how far that holds.
    """
    machine = study.study
    hose, stroke = machine.hose, machine.cylinder.stroke
    believed, period = machine.oil.bulk_modulus_estimate, machine.controller.sampling_period

    def lag(chamber: Chamber) -> Real:
        away = position if chamber.side is Side.PUSHING else stroke - position
        hose_volume = hose.volume(chamber.hose_length)
        volume = chamber.area * away + chamber.dead_volume + hose_volume
        actual = effective_bulk_modulus(oil_bulk_modulus, hose.bulk_modulus, hose_volume, volume)
        estimate = effective_bulk_modulus(believed, hose.bulk_modulus, hose_volume, volume)
        return pressure_time_constant(actual, estimate, period)

    def mean(side: Side) -> Real:
        chambers = machine.side(side)
        area = sum(one.area for one in chambers)
        return sum(one.area / area * lag(one) for one in chambers)

    return mean(Side.PUSHING), mean(Side.PULLING)


def derived_time_constants(study: ResolvedStudy) -> tuple[Range, Range]:
    """Return the ranges of τ_A and τ_B [s] that Eq. 4 and Eq. 12 give for the study's machine.

    The piston may stand anywhere in its stroke and the oil's bulk modulus anywhere in its range.
    Both time constants are monotone in either, so that the corners of the box hold the extremes.
    """
    moduli = np.array(study.study.oil.bulk_modulus)[:, None]
    positions = np.array([0.0, study.study.cylinder.stroke])
    tau_a, tau_b = time_constants_at(study, moduli, positions)
    return (float(tau_a.min()), float(tau_a.max())), (float(tau_b.min()), float(tau_b.max()))


def ranges_of(study: ResolvedStudy, *, explicit: bool = False) -> tuple[Range, Range, Range, Range]:
    """Return the ranges of mass [kg], total delay, τ_A and τ_B [s] of the study's uncertainty set.

    The delay is the lumped one, or that beside an explicit path. Time constants that the study
    leaves to be derived are ``derived_time_constants``.
    """
    box: UncertaintySet = study.uncertainty
    derived_a, derived_b = derived_time_constants(study)
    tau_a = derived_a if isinstance(box.tau_a, str) else box.tau_a
    tau_b = derived_b if isinstance(box.tau_b, str) else box.tau_b
    return box.mass, box.explicit_delay if explicit else box.lumped_delay, tau_a, tau_b


def plants_of(study: ResolvedStudy, *, explicit: bool = False) -> Plants:
    """Return the grid mass × delay × τ_A × τ_B of the study's uncertainty set, ``(N,)`` each.

    The delay is the lumped one, or that beside an explicit path: plant by plant both grids are the
    same machine, each delay at the same share of its range.
    """
    mass, delay, *lags = ranges_of(study, explicit=explicit)
    points = study.uncertainty.points
    crossover = study.study.gains.k_p_vel / study.uncertainty.nominal_mass
    wide = any(low < high for low, high in _delays(study))
    axes = [np.linspace(*mass, points), np.linspace(*delay, points if wide else 1)]
    axes += [_lags(pair, points, crossover) for pair in lags]
    # A range without width is one point; of delays only where both have none.
    axes = [axis if place == 1 else np.unique(axis) for place, axis in enumerate(axes)]
    mesh = [np.ascontiguousarray(axis.ravel()) for axis in np.meshgrid(*axes, indexing="ij")]
    share_a = np.full(len(mesh[0]), study.study.share_a)
    return Plants(*(*mesh, share_a))


def _delays(study: ResolvedStudy) -> tuple[Range, Range]:
    return study.uncertainty.lumped_delay, study.uncertainty.explicit_delay


def _lags(pair: Range, points: int, crossover: float) -> FloatArray:
    """Return time constants [s] between which G_F changes by about equal steps.

    At the crossover [rad/s] the phase of 1/(jωτ + 1) is −atan ωτ. Where ωτ stays below 1 that is
    nearly linear, and the range is divided equally, as in Fig. 5.
    """
    if crossover * pair[1] <= 1:
        return np.linspace(*pair, points)
    low, high = (float(np.arctan(crossover * end)) for end in pair)
    angles = np.linspace(low, high, points)
    return np.concatenate([pair[:1], np.tan(angles[1:-1]) / crossover, pair[1:]])


def nominal_plants(nominal: NominalPlant) -> Plants:
    """Return the nominal plant as a family of one: τ_A = τ_B = 0 makes Eq. 15 of Eq. 14."""
    zero = np.zeros(1)
    return Plants(np.array([nominal.mass]), np.array([nominal.delay]), zero, zero, zero + 0.5)


@dataclass(frozen=True, repr=False)
class FamilyLoops(Summarised):
    """The loops of a family under one set of gains, broken at one place for the pole count.

    Attributes
    ----------
    plants
        The family, ``(N,)``.
    gains, path
        Gains and measurement path.
    which
        ``VELOCITY`` or ``FORCE``. (The position loop shares its closed-loop poles with ``FORCE``.)
    """

    plants: Plants
    gains: LoopGains
    path: MeasurementPath
    which: int = FORCE

    @property
    def headline(self) -> str:
        """How many loops there are."""
        return f"Loops of {self.plants.number} plants"

    def __post_init__(self) -> None:
        """Refuse the position loop, whose inner loop may hold unstable poles of its own."""
        if self.which not in {VELOCITY, FORCE}:
            raise ValueError("count the closed-loop poles at FORCE: they are those of POSITION too")

    def broken_at(self, which: int) -> FamilyLoops:
        """Return the same loops, broken at ``VELOCITY`` or ``FORCE``."""
        return replace(self, which=which)

    def picked(self, rows: IntArray | BoolArray) -> FamilyLoops:
        """Return the loops around some of the plants."""
        return replace(self, plants=self.plants.picked(rows))

    def scaled(self, factor: float) -> FamilyLoops:
        """Return the loops with K_P,vel, and with it all of F_ref, multiplied."""
        gains = self.gains._replace(k_p_vel=factor * self.gains.k_p_vel)
        return replace(self, gains=gains)

    @property
    def integrators(self) -> int:
        """Poles at the origin: the mass's, the position's and the I-term's."""
        if self.which == VELOCITY:
            return 1
        if self.gains.k_i_pos > 0:
            return 3
        return 2 if self.gains.k_p_pos > 0 else 1

    @property
    def leading(self) -> FloatArray:
        """``(N,)``: c in L → c/s^k as s → 0."""
        factor = {1: 1.0, 2: self.gains.k_p_pos, 3: self.gains.k_i_pos}[self.integrators]
        return np.asarray(self.gains.k_p_vel * factor / self.plants.mass)

    @property
    def radius(self) -> FloatArray:
        """``(N,)``: below the pole of every lag [rad/s]."""
        slowest = np.maximum(self.plants.tau_a, self.plants.tau_b)
        slowest = np.maximum(slowest, self.path.filter_time)  # of an estimator, 1/ω_o
        if self.which == FORCE:
            slowest = np.maximum(slowest, self.gains.tau)
        return 0.9 / np.maximum(slowest, 1e-9)

    @property
    def tail(self) -> FloatArray:
        """``(N,)``: |L| ≤ 1/2 beyond it, as |G_F|, |e^{−sd}| and the path are at most 1 there."""
        gains = self.gains
        if self.path.estimator_mass > 0:
            if self.which == VELOCITY:
                gains = gains._replace(k_p_pos=0.0, k_i_pos=0.0)
            end = [tail_of(mass, gains, self.path) for mass in np.unique(self.plants.mass)]
            return np.array(end)[np.unique(self.plants.mass, return_inverse=True)[1]]
        plant = gains.k_p_vel / self.plants.mass
        if self.which == VELOCITY:
            return np.asarray(2 * plant)
        corner = gains.omega * gains.tau
        shape = 1 / corner**2 + gains.xi / corner + 1  # bounds |G_P|/K_P,pos without its I-term
        tail = 2 * plant
        for _ in range(200):
            bound = plant / tail * (1 + gains.k_p_pos * shape / tail + gains.k_i_pos / tail**2)
            if np.all(bound <= 0.5):
                break
            tail = np.where(bound <= 0.5, tail, 1.2 * tail)
        return np.asarray(tail)

    def response(self, s: ComplexArray, rows: IntArray) -> ComplexArray:
        """Return L(s[i]) of plant rows[i]."""
        return _responses(self.which, s, rows, self.plants, self.gains, self.path)

    def bound(self, omega: FloatArray, rows: IntArray) -> FloatArray:
        """Return the sum of the moduli of the terms of L(jω)."""
        return _bounds(self.which, omega, rows, self.plants, self.gains, self.path)

    def rate(self, omega: FloatArray, rows: IntArray) -> FloatArray:
        """Return a bound of every term's |d ln/dω| at ω and beyond.

        Each lag, lead or delay contributes its time, each power of s its exponent over ω, and
        Eq. 23, an average of delays up to five samples, the longest of them.
        """
        plants, path = self.plants, self.path
        lead = np.maximum(plants.tau_a, plants.tau_b)
        time = plants.delay + plants.tau_a + plants.tau_b + lead
        powers = float(self.integrators)
        if path.estimator_mass > 0:  # w up to four times; ŝ twice, |d ln ŝ/dω| ≤ π/(2ω)
            time = time + 4 * path.sample_time + slowest_error(path)[1]
            powers += np.pi
        elif path.sample_time > 0:
            filter_time = path.filter_pole * path.sample_time / (1 - path.filter_pole)
            time = time + 6 * path.sample_time + filter_time
        if self.which == FORCE:
            time = time + 2 * self.gains.tau
        return np.asarray(time[rows] + powers / omega)


@parallel_kernel
def _responses(
    which: int,
    s: ComplexArray,
    rows: IntArray,
    plants: Plants,
    gains: LoopGains,
    path: MeasurementPath,
) -> ComplexArray:
    values = np.empty(len(s), np.complex128)
    for i in numba.prange(len(s)):
        values[i] = loop_gain(which, s[i], plant_at(plants, rows[i]), gains, path)
    return values


@kernel
def _terms(which: int, omega: float, gains: LoopGains) -> float:
    """Return the sum of the moduli of the feedback's terms, path left out."""
    if which == VELOCITY:
        return 1.0
    ratio = omega / gains.omega
    shape = (ratio * ratio + 2 * gains.xi * ratio + 1) / (1 + (gains.tau * omega) ** 2)
    return 1 + (gains.k_p_pos * shape + gains.k_i_pos / omega) / omega


@parallel_kernel
def _bounds(
    which: int,
    omega: FloatArray,
    rows: IntArray,
    plants: Plants,
    gains: LoopGains,
    path: MeasurementPath,
) -> FloatArray:
    values = np.empty(len(omega))
    for i in numba.prange(len(omega)):
        s, plant = 1j * omega[i], plant_at(plants, rows[i])
        size = abs(force_dynamics(s, plant.tau_a, plant.tau_b, plant.share_a))
        if path.estimator_mass > 0:
            share = 0.0 if which == VELOCITY else 1.0
            values[i] = size * estimated_terms(omega[i], plant.mass, gains, path, share)
            continue
        if path.sample_time > 0:
            size *= abs(filter_response(s, path.sample_time, path.filter_pole))
        values[i] = gains.k_p_vel / (plant.mass * omega[i]) * size * _terms(which, omega[i], gains)
    return values
