"""From study objects to kernel tuples: numbers that are computed on the way, against their laws."""

from __future__ import annotations

import math

import pytest

from mptune.params.pack import pack_feedforward, pack_filters, pack_machine, pack_signals


def machine_of(study):
    return pack_machine(study, 24500.0, 1.2e9, 9700.0)


def test_a_hose_s_resistance_is_that_of_hagen_and_poiseuille(load_boom):
    """Δp = 128 μ l Q/(π d⁴), and another length for each side."""
    study = load_boom("hose.dynamics=true", "hose.length_b=1.3 m")
    hose, machine = study.study.hose, machine_of(study)
    per_metre = 128 * hose.oil_viscosity / (math.pi * hose.diameter**4)
    assert machine.line_resistance == pytest.approx(0.8 * per_metre, rel=1e-12)
    assert machine.line_resistance_b == pytest.approx(1.3 * per_metre, rel=1e-12)


def test_a_hose_s_inertance_is_its_oil_over_its_section(load_boom):
    """Δp = ρ l/A dQ/dt; none where the hose is part of its chamber."""
    study = load_boom("hose.dynamics=true", "hose.length_b=1.3 m")
    hose, machine = study.study.hose, machine_of(study)
    per_metre = hose.oil_density / (math.pi * hose.diameter**2 / 4)
    assert machine.line_inertance == pytest.approx(0.8 * per_metre, rel=1e-12)
    assert machine.line_inertance_b == pytest.approx(1.3 * per_metre, rel=1e-12)
    assert machine_of(load_boom()).line_inertance == 0.0


def test_a_chamber_s_dead_volume_holds_its_hose(boom):
    cylinder, hose, machine = boom.study.cylinder, boom.study.hose, machine_of(boom)
    assert (machine.hose_a, machine.hose_b) == (
        hose.volume(hose.length_a),
        hose.volume(hose.length_b),
    )
    assert machine.dead_a == cylinder.dead_volume_a + hose.volume(hose.length_a)
    assert machine.dead_b == cylinder.dead_volume_b + hose.volume(hose.length_b)


def test_each_filter_has_the_pole_of_its_own_time_constant(boom):
    """12, 4.5 and 24 ms at 0.5 ms (§5.2): a first-order filter loses all but 1/e of a step."""
    signals, path = pack_signals(boom.study.controller), pack_filters(boom.study.controller)
    for pole, time_constant in (
        (signals.position_pole, 12e-3),
        (signals.pressure_pole, 4.5e-3),
        (signals.supply_pole, 24e-3),
        (path.filter_pole, 12e-3),
    ):
        assert pole ** (time_constant / 0.5e-3) == pytest.approx(1 / math.e, rel=1e-12)


def test_a_lag_of_the_feed_forward_has_the_pole_of_its_own_time_constant(load_boom):
    study = load_boom("feedforward.reference_lag=8 ms", "feedforward.velocity_reference_lag=3 ms")
    packed = pack_feedforward(study.study.feedforward, 5e-4)
    assert packed.reference_pole == pytest.approx(math.exp(-5e-4 / 8e-3), rel=1e-12)
    assert packed.velocity_reference_pole == pytest.approx(math.exp(-5e-4 / 3e-3), rel=1e-12)
    assert pack_feedforward(load_boom().study.feedforward, 5e-4)[1:3] == (0.0, 0.0)
