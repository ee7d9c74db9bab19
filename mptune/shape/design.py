"""Tuning a loop of one's own: any plant, any family, any controller linear in its parameters.

::

    from mptune import design, pi_structure

    found = design(lambda s: 1 / (s + 1) ** 3, pi_structure(), maximise="k_i", sensitivity_peak=1.4)
    found.gains  # {"k_p": 0.63, "k_i": 0.325}
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from mptune.errors import Fault, InputError
from mptune.interop import frequency_response, transfer_function
from mptune.shape.grids import common_grid
from mptune.shape.problem import (
    Function,
    Maximise,
    Peak,
    Problem,
    WeightedSensitivity,
)
from mptune.shape.proofs import FAMILY, NOMINAL, RATIO, Proofs, loops_of
from mptune.shape.responses import response_of
from mptune.shape.rounds import shape_with_proof
from mptune.strict import strict
from mptune.summary import Summarised

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from control import FrequencyResponseData, TransferFunction

    from mptune.arrays import FloatArray
    from mptune.certify.result import Grounds
    from mptune.shape.problem import Curve, Objective, Requirement
    from mptune.shape.proofs import PeakVerdict
    from mptune.shape.responses import Response
    from mptune.shape.shaping import Shaped
    from mptune.shape.structure import Structure


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
    verdicts
        Attained value, guaranteed bound and certainty of every requirement over frequency; none
        where the loops are not stable.
    stability
        Whether stability is certified, or counted on the grid.
    """

    structure: Structure
    gains: dict[str, float]
    shaped: Shaped
    omega: FloatArray
    verdicts: tuple[PeakVerdict, ...]
    stability: Grounds

    @property
    def headline(self) -> str:
        """The status, and the parameters."""
        found = ", ".join(f"{name} {value:.6g}" for name, value in self.gains.items())
        return f"Design: {self.shaped.status}, {found}"

    def json(self) -> dict[str, Any]:
        """Return parameters, status and requirements, and what of them is certified."""
        verdicts = [asdict(verdict) for verdict in self.verdicts]
        proofs = {"stability": self.stability.value, "verdicts": verdicts}
        return strict({"gains": self.gains, **self.shaped.json(), **proofs})

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
        The nominal plant: values ``(F,)`` at ``omega``, a function of s, a continuous-time
        FrequencyResponseData, TransferFunction or StateSpace object of python-control, or a
        ``RationalPlant``, which has exact dead time beside poles and zeros. Of those that know
        their poles and zeros the result is certified.
    structure
        The controller: ``mptune.pi_structure`` and others beside it make P, PI, PID and Eq. 22,
        ``mptune.structure_of`` one of any functions.
    omega
        Frequencies [rad/s]; for functions found from the nominal plant where None. Certificates
        are over all frequencies all the same.
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

    Returns
    -------
    Design
        Gains and verdicts. Rational plants with dead time under a structure that is known as a
        fraction are certified: closed-loop poles are counted with certainty, every bound on |S|,
        |T|, |CS| that is a number and ``ratio`` are guaranteed over all frequencies, and what the
        grid missed is added to it and the loop shaped again. A function, an array, a bound that
        is a curve and a basis of one's own are judged on the grid only, which is optimistic.

    Raises
    ------
    InputError
        Where something is missing or contradicts itself, and where the frequencies given cannot
        decide whether a loop is stable.

    Examples
    --------
    A transfer function of python-control with 0.4 s of dead time::

        plant = RationalPlant.of(control.tf([9], [1, 1.2, 9.2, 9]), delay=0.4)
        found = design(plant, pi_structure(), maximise="k_i", sensitivity_peak=1.4)
        found.verdicts[0].bound  # below 1.4 at every frequency
    """
    nominal = response_of(plant, omega, "plant")
    others = [response_of(one, omega, f"family[{n}]") for n, one in enumerate(family)]
    bounded = _bounded(structure, low or {}, high or {})
    grid = common_grid(nominal, others, bounded, omega)
    plants = {NOMINAL: [nominal], FAMILY: others} if others else {NOMINAL: [nominal]}
    loops = {name: loops_of(grid, members) for name, members in plants.items()}
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
        if any(one.omega is not None for one in others):  # max|Δ| is known on the grid only
            loops[NOMINAL] = replace(loops[NOMINAL], between=None)
    proofs = Proofs(bounded, plants, grid, integrators, unstable_poles)
    problem = Problem(
        structure=bounded,
        loops=loops,
        objective=_objective(bounded, maximise, sensitivity_weight),
        requirements=(*wanted, *requirements),
        stable=proofs.stable,
    )
    problem, shaped, verdicts = shape_with_proof(problem, _first(bounded, start), proofs, ratio)
    if not shaped.stable and proofs.reasons:
        raise InputError("design", *proofs.reasons)
    gains = dict(zip(bounded.names, shaped.parameters.tolist(), strict=True))
    seen = problem.loops[NOMINAL].omega
    return Design(bounded, gains, shaped, seen, verdicts, proofs.stability)


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

    return Peak(RATIO, Function.COMPLEMENTARY, allowed, NOMINAL)


def _first(structure: Structure, start: Mapping[str, float] | None) -> FloatArray | None:
    if start is None:
        return None
    missing = [name for name in structure.names if name not in start]
    if missing:
        _refuse("start", f"has no {', '.join(missing)}", "give every parameter, or no start")
    return np.array([float(start[name]) for name in structure.names])


def _refuse(key: str, rule: str, remedy: str) -> NoReturn:
    raise InputError("design", Fault(key, "", rule, remedy))
