"""More chambers than two as Eq. 11 has them: their sides, and by how much that is off."""

import numpy as np
import pytest

from mptune.loops.family import time_constants_at
from mptune.loops.force_dynamics import force_dynamics, pressure_time_constant
from mptune.params.chambers import Side
from mptune.plant.bulk import effective_bulk_modulus

OMEGA = np.geomspace(0.1, 3000, 300)
HOSES = (0.3, 1.0, 2.5, 0.0)  # m


@pytest.fixture
def machine(load_shape):
    """The four-chamber study with hoses of different lengths."""
    study = load_shape("four-chamber")
    pairs = zip(study.study.chambers, HOSES, strict=True)
    chambers = tuple(one.model_copy(update={"hose_length": length}) for one, length in pairs)
    return study.model_copy(update={"study": study.study.model_copy(update={"chambers": chambers})})


def lag_of(chamber, study, oil, position):
    """Eq. 4 and Eq. 12 of one chamber."""
    hose, stroke = study.study.hose, study.study.cylinder.stroke
    held = hose.volume(chamber.hose_length)
    away = position if chamber.side is Side.PUSHING else stroke - position
    volume = chamber.area * away + chamber.dead_volume + held
    pair = (effective_bulk_modulus(one, hose.bulk_modulus, held, volume) for one in (oil, 1.4e9))
    return float(pressure_time_constant(*pair, 0.01))


def test_sides_are_off_by_no_more_than_the_ledger_says(machine):
    chambers, worst = machine.study.all_chambers, 0.0
    share = np.array([one.area for one in chambers])
    share /= share.sum()
    pushes = np.array([one.side is Side.PUSHING for one in chambers])
    for oil in (8e8, 1.1e9, 1.39e9):
        for position in (0.0, 0.1, 0.3):
            lags = np.array([lag_of(one, machine, oil, position) for one in chambers])
            means = [
                float(np.average(lags[side], weights=share[side])) for side in (pushes, ~pushes)
            ]
            assert time_constants_at(machine, oil, position) == pytest.approx(means, rel=1e-12)
            s = 1j * OMEGA
            exact = sum(a / (tau * s + 1) for a, tau in zip(share, lags, strict=True))
            off = np.abs(exact - force_dynamics(s, *means, machine.study.share_a))
            most = np.zeros(len(OMEGA))
            for side, mean in zip((pushes, ~pushes), means, strict=True):
                spread = np.average((lags[side] - mean) ** 2, weights=share[side])
                root = (1 + (OMEGA * lags[side].min()) ** 2) ** 1.5
                most += share[side].sum() * OMEGA**2 * spread / root
            assert np.all(off <= most * (1 + 1e-9) + 1e-12)
            worst = max(worst, off.max() / most.max())
    assert worst > 0.5  # no bound that says nothing


def test_without_hoses_the_sides_are_exact(load_shape):
    study = load_shape("four-chamber")
    for oil in (8e8, 1.2e9):
        lags = {lag_of(one, study, oil, 0.1) for one in study.study.all_chambers}
        tau_a, tau_b = time_constants_at(study, oil, 0.1)
        assert max(lags) == pytest.approx(min(lags), rel=1e-12)
        assert (tau_a, tau_b) == pytest.approx((max(lags), max(lags)), rel=1e-12)
