"""How large weights are for a machine: ladders and ranges about what the paper's machine has.

A weight turns switches, energies and converter volumes into newtons of force error. What a newton
is worth follows from the force of one pressure step on all that pushes, F_1 = A_A Δp. So W_sw goes
by F_1; W_loss by F_1/(Q Δp T_S), what one valve throttles at a whole step in a sampling period; and
W_conv by F_1/(Q x³) at a converter's end, as ``mptune.params.sizing`` has it. These scales are
derived; that the best weights of another machine stand near them is assumed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.params import sizing
from mptune.params.chambers import Side

if TYPE_CHECKING:
    from mptune.params.study import ResolvedStudy, Study

_PAPER = {  # the same scales of the paper's machine, by the keys of its weights
    "weight_switching": 12.064e3,  # N
    "weight_loss": 1.3766e3,  # N/J
    "weight_converter": 1.1075e11,  # N s/m⁶
    "weight_common_mode": 5.0265e-3,  # N/Pa
}
_AS = {"error_width": "weight_switching", "weight_compression": "weight_loss"}  # of their units


def times_the_papers(study: ResolvedStudy, weight: str) -> float:
    """Return how many times as large a weight is as on the paper's machine.

    To three digits: on the paper's machine it is 1 without rounding.

    Parameters
    ----------
    study
        The study.
    weight
        A key of ``[controller]``: one of the weights, or ``error_width``.
    """
    key = _AS.get(weight, weight)
    return float(f"{_scale(study.study, key) / _PAPER[key]:.3g}")


def _scale(machine: Study, weight: str) -> float:
    step = sizing.pressure_step(machine)
    force = machine.area_a * step
    if weight == "weight_switching":
        return force
    if weight == "weight_common_mode":
        return machine.area_a
    if weight == "weight_converter":
        return 2 * sizing.converter_weights(machine)[0]
    sizes = max(map(max, machine.edge_rule.sizes)) * sum(
        one.valves for one in machine.side(Side.PUSHING)
    )
    flow = machine.valves.flow_coefficient * sizes * math.sqrt(step)  # Q [m³/s], Eq. 2
    return force / (flow * step * machine.controller.sampling_period)
