"""The valve states of a move: as many lines as the machine has chambers."""

from types import SimpleNamespace

import numpy as np
import pytest

from mptune.explore.move_view import MoveView


def move(chambers):
    zero = np.zeros(3)
    return SimpleNamespace(
        time=np.arange(3.0), error=zero, force=zero, force_reference=zero,
        states=tuple(np.full(3, i) for i in range(chambers)),
        case=SimpleNamespace(mass_kg=24500.0, seed=1),
    )  # fmt: skip


@pytest.mark.parametrize("chambers", [2, 4])
def test_each_chamber_that_there_is_has_a_line_and_an_entry(chambers):
    view = MoveView()
    view.show(move(chambers), move(chambers))
    plot = view.plots[2]
    shown = [one.visible for one in plot.legend[0].items]
    assert (
        [one.visible for one in view._steps]
        == shown
        == [True] * chambers + [False] * (4 - chambers)
    )
    assert view._now.data["B"].tolist() == [1, 1, 1]
    assert np.isnan(view._now.data["D"]).all() == (chambers == 2)
