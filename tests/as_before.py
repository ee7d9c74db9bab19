"""What the paper's machine did before its sizes became data: ``as_before.npz`` holds it.

``python tests/as_before.py`` in the root of the repository made it, at the commit before the
machine was made general (199ae8f), with numpy 2.4 on x86-64. Kept are the decisions at random
states and a fifth of a second of the closed loop; every operation in floating point is to stay as
it was.
"""

from pathlib import Path

import numpy as np
from deciding import chosen, states

from mptune.force.search_space import search_space
from mptune.params.load import load_study
from mptune.params.pack import pack_force
from mptune.sim import closed_loop as loop
from mptune.verify.verify import cases_of, run_case

ROOT = Path(__file__).parents[1]
FILE = Path(__file__).with_suffix(".npz")
STUDY = ROOT / "studies" / "boom" / "study.toml"
SEED = 20260101
# The decision's settings, and at how many states they are tried.
OPTIONS = {
    "paper": (10_000, ()),
    "delay predicted": (1000, ('controller.delay_prediction="6.25 ms"',)),
    "levers": (
        1000,
        (
            'controller.error="huber"',
            'controller.loss="path"',
            "controller.horizon=2",
            'controller.weight_common_mode="300 N/MPa"',
        ),
    ),
    "steady state": (
        1000,
        ('controller.force_model="steady-state"', 'controller.weight_compression="60 N/J"'),
    ),
}
TICKS = 400
COLUMNS = {
    "position": loop.POSITION,
    "velocity": loop.VELOCITY,
    "pressure_a": loop.CHAMBER_A,
    "pressure_b": loop.CHAMBER_B,
    "force_reference": loop.F_REF,
    "state_a": loop.STATE_A,
    "state_b": loop.STATE_B,
    "converter_3": loop.CONVERTER_1 + 2,
    "high_pressure": loop.HIGH_PRESSURE,
}


def decisions(name):
    """Return the states of A and B ``(n, 2)`` that are chosen at the random states."""
    count, options = OPTIONS[name]
    space, settings = search_space(), pack_force(load_study(STUDY, options))
    return np.array([chosen(case, space, settings) for case in states(count, SEED)], np.uint8)


def short_run():
    """Return the first ticks of the paper's machine on its moves, one column after another."""
    study = load_study(STUDY, ["verification.repeats=1", "verification.seeds=[7]"])
    case = run_case(study, cases_of(study)[0], study.study.gains, study.study.feedforward)
    return {name: case.traces[:TICKS, column] for name, column in COLUMNS.items()}


def main():
    np.savez_compressed(FILE, **{name: decisions(name) for name in OPTIONS}, **short_run())


if __name__ == "__main__":
    main()
