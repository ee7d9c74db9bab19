"""Measured force responses as members of the true family.

A measured response G(jω) takes the place of G_F(s) e^{−sd}: with every mass m of the family it
makes the velocity plant G/(ms). Within its band it is interpolated over the logarithm of frequency,
its log-magnitude and its unwrapped phase by monotone cubics. They go through the measured points
and never overshoot between them, so that a resonance between two points is missed: optimistic.
Outside its band it says nothing, and the box of parameters stands in for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from mptune.loops.position import position_error
from mptune.loops.velocity import error_of_factors
from mptune.params.packed import Plants
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.arrays import BoolArray, ComplexArray, FloatArray
    from mptune.params.packed import NominalPlant
    from mptune.params.study import ResolvedStudy


@dataclass(frozen=True, repr=False)
class ForceResponse(Summarised):
    """One measured response from force reference to force.

    Attributes
    ----------
    name
        Its file's name.
    omega, response
        ``(K,)`` measured frequencies [rad/s], rising, and the complex response there.
    phase
        ``(K,)`` its phase [rad] as it was followed; None where it is to be unwrapped.
    """

    name: str
    omega: FloatArray
    response: ComplexArray
    phase: FloatArray | None = None

    @property
    def headline(self) -> str:
        """Name and band."""
        band = f"{self.omega[0]:.4g} … {self.omega[-1]:.4g} rad/s"
        return f"Measured response {self.name}: {len(self.omega)} points, {band}"

    @cached_property
    def _logarithm(self) -> FloatArray:
        """``(2, K)``: log-magnitude and phase."""
        phase = self.phase
        if phase is None:
            phase = np.unwrap(np.angle(self.response))
            phase = phase - 2 * np.pi * np.rint(phase[0] / (2 * np.pi))
        return np.stack([np.log(np.abs(self.response)), phase])

    @cached_property
    def _curve(self) -> Callable[[FloatArray], FloatArray]:
        from scipy.interpolate import PchipInterpolator

        interpolated: Callable[[FloatArray], FloatArray] = PchipInterpolator(
            np.log(self.omega), self._logarithm, axis=1
        )
        return interpolated

    def at(self, omega: FloatArray) -> ComplexArray:
        """Return the response at frequencies ``(F,)``; NaN outside the band."""
        inside = self.covers(omega)
        log_magnitude, phase = self._curve(np.log(np.where(inside, omega, self.omega[0])))
        value = np.exp(log_magnitude + 1j * phase)
        return np.where(inside, value, np.nan + 0j)

    def covers(self, omega: FloatArray) -> BoolArray:
        """``(F,)``: whether each frequency lies within the band."""
        return np.asarray((omega >= self.omega[0]) & (omega <= self.omega[-1]))

    @cached_property
    def doubt(self) -> FloatArray:
        """``(K − 1,)``: how far G may be off between neighbouring points, relative to |G|.

        Infinite where the phase turns by more than 90° in a step: it may have turned the other way.
        """
        off = self._left_out
        turned = np.abs(np.diff(self._logarithm[1])) > np.pi / 2
        return np.where(turned, np.inf, _per_step(np.abs(np.exp(off[0] + 1j * off[1]) - 1)))

    @cached_property
    def magnitude_doubt(self) -> FloatArray:
        """``(K − 1,)``: how far |G| may be off between neighbouring points, relative to |G|."""
        return _per_step(np.abs(np.expm1(self._left_out[0])))

    @cached_property
    def _left_out(self) -> FloatArray:
        """``(2, K − 2)``: how far off log-magnitude and phase are when a point is left out.

        Each point is interpolated from its two neighbours. The steps are then twice as wide and the
        error about four times as large, so that this errs on the safe side.
        """
        place, logarithm = np.log(self.omega), self._logarithm
        share = (place[1:-1] - place[:-2]) / (place[2:] - place[:-2])
        guessed = logarithm[:, :-2] + share * (logarithm[:, 2:] - logarithm[:, :-2])
        return np.asarray(guessed - logarithm[:, 1:-1])


def _per_step(error: FloatArray) -> FloatArray:
    """Return the larger error of each step's two points; an end errs like its neighbour."""
    padded = np.concatenate([error[:1], error, error[-1:]])
    return np.asarray(np.maximum(padded[:-1], padded[1:]))


@dataclass(frozen=True, repr=False)
class Members(Summarised):
    """Measured responses times masses, the masses running fastest.

    Attributes
    ----------
    responses
        The responses, R of them.
    masses
        ``(M,)`` the family's different masses [kg].
    instead
        Whether the box's plants are left out where every measured response speaks.
    """

    responses: tuple[ForceResponse, ...]
    masses: FloatArray
    instead: bool

    @property
    def headline(self) -> str:
        """How many members there are, and where they stand."""
        place = "instead of" if self.instead else "beside"
        return f"{len(self)} measured members {place} the box"

    def __len__(self) -> int:
        """Return R × M."""
        return len(self.responses) * len(self.masses)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of the response behind each member."""
        return tuple(one.name for one in self.responses for _ in self.masses)

    @property
    def mass(self) -> FloatArray:
        """``(R M,)`` mass of each member [kg]."""
        return np.tile(self.masses, len(self.responses))

    @property
    def omega(self) -> FloatArray:
        """Every measured frequency [rad/s]."""
        return np.unique(np.concatenate([one.omega for one in self.responses]))

    def replaces(self, omega: FloatArray) -> BoolArray:
        """``(F,)``: where the members stand instead of the box's plants."""
        if not self.instead:
            return np.zeros(len(omega), np.bool_)
        return np.asarray(np.all([one.covers(omega) for one in self.responses], axis=0))

    def plants(self) -> Plants:
        """Return the members as plants: a mass each, and no delay or lags of their own."""
        unknown = np.full(len(self), np.nan)
        return Plants(self.mass, unknown, unknown, unknown, unknown)

    def errors(
        self, omega: FloatArray, nominal: NominalPlant, nominal_velocity_loop: ComplexArray
    ) -> FloatArray:
        """Return |Δ_vel| and |Δ_pos|, ``(2, R M, F)``; 0 where a member says nothing."""
        force = np.array([one.at(omega) for one in self.responses]).reshape(-1, len(omega))
        force = np.repeat(force, len(self.masses), axis=0)
        speaks = np.isfinite(force)
        lead = np.exp(1j * omega * nominal.delay)
        ratio = nominal.mass / self.mass[:, None]
        velocity = error_of_factors(np.where(speaks, force, 1.0), lead, ratio)
        position = position_error(velocity, nominal_velocity_loop)
        return np.where(speaks, np.abs(np.stack([velocity, position])), 0.0)


def members_of(study: ResolvedStudy, plants: Plants) -> Members | None:
    """Return the measured members of a study's true family; None where nothing was measured."""
    box = study.uncertainty
    if not box.measured:
        return None
    responses = []
    for one in box.measured:
        omega, real, imaginary = np.array(one.rows).T
        phase = np.array(one.phases) if one.phases else None
        responses.append(ForceResponse(one.name, omega, real + 1j * imaginary, phase))
    return Members(tuple(responses), np.unique(plants.mass), box.measured_place == "instead")


def whole_family(plants: Plants, members: Members | None) -> Plants:
    """Return the box's plants followed by the measured members."""
    return plants if members is None else plants.followed_by(members.plants())
