"""Tuning a loop of one's own: any plant, any family, any controller linear in its parameters.

::

    from mptune import design, pi_structure

    found = design(lambda s: 1 / (s + 1) ** 3, pi_structure(), maximise="k_i", sensitivity_peak=1.4)
    found.gains  # {"k_p": 0.63, "k_i": 0.325}
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from mptune.errors import Fault, InputError
from mptune.interop import frequency_response, transfer_function
from mptune.shape.problem import (
    Function,
    Loops,
    Maximise,
    Peak,
    Problem,
    WeightedSensitivity,
)
from mptune.shape.responses import Response, between, own_range, response_of
from mptune.shape.shaping import Shaped, shape_loop
from mptune.shape.turns import SampledStability
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from control import FrequencyResponseData, TransferFunction

    from mptune.arrays import ComplexArray, FloatArray
    from mptune.shape.problem import Curve, Objective, Requirement
    from mptune.shape.structure import Structure

NOMINAL, FAMILY = "nominal", "family"
_WIDENINGS = 4  # by a decade each
_SETTLED = 0.1  # of |L| at the upper end, and of |S| − 1 at the lower


@dataclass(frozen=True, repr=False)
class Design(Summarised):
    """A designed controller.

    Attributes
    ----------
    structure
        The controller's structure, with the bounds used.
    gains
        Its parameters by name; where ``shaped.status`` is infeasible, the nearest found.
    shaped
        Status, verdict of every requirement, iterates, and what stands in the way if anything.
    omega
        ``(F,)`` the frequencies of the verdict [rad/s], before refinement about peaks.
    """

    structure: Structure
    gains: dict[str, float]
    shaped: Shaped
    omega: FloatArray

    @property
    def headline(self) -> str:
        """The status, and the parameters."""
        found = ", ".join(f"{name} {value:.6g}" for name, value in self.gains.items())
        return f"Design: {self.shaped.status}, {found}"

    def json(self) -> dict[str, Any]:
        """Return parameters, status and requirements."""
        return strict({"gains": self.gains, **self.shaped.json()})

    def to_control(self) -> TransferFunction | FrequencyResponseData:
        """Return the controller as python-control's object.

        A transfer function where the structure's functions are fractions, as in all of mptune's
        own; its frequency response at ``omega`` where they are functions of the user's, whose dead
        time, if any, a transfer function could only approximate.

        Raises
        ------
        InputError
            If python-control is not installed.
        """
        x = self.shaped.parameters
        if self.structure.denominator:
            return transfer_function(*self.structure.fraction(x), "controller")
        values = self.structure.controller(x, self.omega)
        return frequency_response(values, self.omega, "controller")


def design(
    plant: Any,
    structure: Structure,
    omega: FloatArray | None = None,
    *,
    maximise: str | None = None,
    sensitivity_weight: Curve | None = None,
    sensitivity_peak: Curve | None = None,
    complementary_peak: Curve | None = None,
    ratio: float | None = None,
    requirements: Sequence[Requirement] = (),
    low: Mapping[str, float] | None = None,
    high: Mapping[str, float] | None = None,
    family: Sequence[Any] = (),
    start: Mapping[str, float] | None = None,
    integrators: int | None = None,
    unstable_poles: int | None = None,
) -> Design:
    """Return the controller that is locally best within the requirements.

    Parameters
    ----------
    plant
        The nominal plant: values ``(F,)`` at ``omega``, a function of s, or a continuous-time
        FrequencyResponseData, TransferFunction or StateSpace object of python-control.
    structure
        The controller: ``mptune.pi_structure`` and others beside it make P, PI, PID and Eq. 22,
        ``mptune.structure_of`` one of any functions.
    omega
        Frequencies [rad/s]; for functions found from the nominal plant where None.
    maximise
        The parameter to make largest; else give ``sensitivity_weight``.
    sensitivity_weight
        w(ω) whose largest product with the nominal |S| is to be made small.
    sensitivity_peak, complementary_peak
        Largest M_S and M_T of the nominal plant and of every plant of the family; a number or a
        function of ω.
    ratio
        Largest left/right ratio of max|P_n/P − 1| over the family to |(1 + L)/L| of the nominal
        loop, the condition of Eq. 17 and Eq. 21: below 1 the family is robustly stable.
    requirements
        More requirements; their loops are ``"nominal"`` and ``"family"``.
    low, high
        Bounds by the parameters' names, in place of the structure's.
    family
        More plants, each given as the nominal one.
    start
        Parameters to start from; found where None or not stabilising.
    integrators, unstable_poles
        Open-loop poles of every plant at the origin and in the right half plane, without the
        controller's; read from objects that know their poles, else 0 where None.

    Raises
    ------
    InputError
        Where something is missing or contradicts itself, and where the frequencies given cannot
        decide whether a loop is stable.
    """
    nominal = response_of(plant, omega, "plant")
    others = [response_of(one, omega, f"family[{n}]") for n, one in enumerate(family)]
    grid = _grid(nominal, others, omega)
    bounded = _bounded(structure, low or {}, high or {})
    loops = {NOMINAL: _loops(grid, [nominal])}
    if others:
        loops[FAMILY] = _loops(grid, others)
    wanted = [
        Peak(f"{name} ({which})", function, largest, which)
        for name, function, largest in (
            ("sensitivity_peak", Function.SENSITIVITY, sensitivity_peak),
            ("complementary_peak", Function.COMPLEMENTARY, complementary_peak),
        )
        if largest is not None
        for which in loops
    ]
    if ratio is not None:
        wanted.append(_ratio_peak(ratio, nominal, others))
    known_integrators = nominal.integrators if integrators is None else integrators
    known_poles = nominal.unstable_poles if unstable_poles is None else unstable_poles
    stability = SampledStability(bounded, loops, known_integrators or 0, known_poles or 0)
    problem = Problem(
        structure=bounded,
        loops=loops,
        objective=_objective(bounded, maximise, sensitivity_weight),
        requirements=(*wanted, *requirements),
        stable=stability,
    )
    problem, shaped = _shaped_to_the_ends(problem, _first(bounded, start))
    if not shaped.stable and stability.reasons:
        raise InputError("design", *(stability.reasons))
    gains = dict(zip(bounded.names, shaped.parameters.tolist(), strict=True))
    return Design(bounded, gains, shaped, problem.loops[NOMINAL].omega)


def _shaped_to_the_ends(problem: Problem, start: FloatArray | None) -> tuple[Problem, Shaped]:
    """Shape the loop; where it still acts at an end of the grid and more is known, widen it."""
    shaped = shape_loop(problem, start)
    for _ in range(_WIDENINGS):
        added = [
            _beyond(one, one.gain(shaped.parameters @ problem.structure.response(one.omega)))
            for one in problem.loops.values()
            if one.between is not None
        ]
        new = np.unique(np.concatenate([np.zeros(0), *added]))
        if not shaped.stable or not len(new):
            break
        loops = {name: one.refined(new) for name, one in problem.loops.items()}
        problem = replace(problem, loops=loops)
        shaped = shape_loop(problem, shaped.parameters)
    return problem, shaped


def _beyond(loops: Loops, gain: ComplexArray) -> FloatArray:
    """Return frequencies beyond the ends where |S| has not settled there."""
    low, high = loops.omega[0], loops.omega[-1]
    size = np.abs(1 / (1 + gain))
    moving = np.abs(np.diff(np.log(size[:, [0, 1, -2, -1]]), axis=1)).max(axis=0)
    added = np.zeros(0)
    if np.abs(gain[:, -1]).max() > _SETTLED and moving[2] > 0:
        added = np.geomspace(high, 10 * high, 60)[1:]
    if moving[0] > 0 and size[:, 0].max() > 1 + _SETTLED:
        added = np.concatenate([np.geomspace(low / 10, low, 60)[:-1], added])
    return added


def _grid(nominal: Response, others: list[Response], omega: FloatArray | None) -> FloatArray:
    """Return the common frequencies: those of sampled plants, the given, or the plant's own."""
    sampled = [one.omega for one in (nominal, *others) if one.omega is not None]
    if sampled:
        if any(not np.array_equal(one, sampled[0]) for one in sampled):
            _refuse("family", "is sampled at other frequencies than the plant", "use the same")
        return sampled[0]
    return own_range(nominal, "plant") if omega is None else np.asarray(omega, np.float64)


def _loops(grid: FloatArray, plants: list[Response]) -> Loops:
    return Loops.of(grid, np.stack([one.at(grid) for one in plants]), between(plants))


def _bounded(
    structure: Structure, low: Mapping[str, float], high: Mapping[str, float]
) -> Structure:
    """Return the structure with some bounds replaced."""
    lows, highs = list(structure.low), list(structure.high)
    for bounds, given in ((lows, low), (highs, high)):
        for name, value in given.items():
            bounds[structure.index(name)] = float(value)
    for name, one, other in zip(structure.names, lows, highs, strict=True):
        if one > other:
            _refuse(name, f"has a lower bound {one:g} above its upper bound {other:g}", "swap them")
    return replace(structure, low=tuple(lows), high=tuple(highs))


def _objective(structure: Structure, maximise: str | None, weight: Curve | None) -> Objective:
    if weight is not None and maximise is None:
        return WeightedSensitivity(weight, NOMINAL)
    if maximise is None or weight is not None:
        _refuse("objective", "is not exactly one", "give `maximise` or `sensitivity_weight`")
    return Maximise(np.eye(len(structure.names))[structure.index(maximise)])


def _ratio_peak(ratio: float, nominal: Response, others: list[Response]) -> Peak:
    """Return Eq. 17's requirement on |T|, ratio over max|Δ|."""
    if not others:
        _refuse("ratio", "needs a family to take max|Δ| over", "give `family`")

    def allowed(omega: FloatArray) -> FloatArray:
        centre = nominal.at(omega)
        error = np.max([np.abs(one.at(omega) / centre - 1) for one in others], axis=0)
        return np.asarray(ratio / np.maximum(error, 1e-300))

    return Peak("ratio", Function.COMPLEMENTARY, allowed, NOMINAL)


def _first(structure: Structure, start: Mapping[str, float] | None) -> FloatArray | None:
    if start is None:
        return None
    missing = [name for name in structure.names if name not in start]
    if missing:
        _refuse("start", f"has no {', '.join(missing)}", "give every parameter, or no start")
    return np.array([float(start[name]) for name in structure.names])


def _refuse(key: str, rule: str, remedy: str) -> NoReturn:
    raise InputError("design", Fault(key, "", rule, remedy))
