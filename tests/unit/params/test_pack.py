"""What kernels are given: each value in the field of its name."""

from __future__ import annotations

from mptune.params.pack import pack_force, pack_machine
from mptune.params.packed import ForceSettings, Machine

SHARED = set(ForceSettings._fields) & set(Machine._fields)


def test_the_force_controller_knows_the_machine_field_by_field(boom):
    believed = boom.study.oil.bulk_modulus_estimate
    settings, machine = pack_force(boom), pack_machine(boom, 1.0, believed, 0.0)
    assert len(SHARED) == 11
    assert {name: getattr(settings, name) for name in SHARED} == {
        name: getattr(machine, name) for name in SHARED
    }


def test_the_two_sides_are_not_exchanged(load_boom):
    study = load_boom("cylinder.dead_volume_a=0.5 dm^3", "hose.length_b=1 m")
    settings, hose = pack_force(study), study.study.hose
    assert settings.area_a > settings.area_b
    assert settings.dead_a == 0.5e-3 + hose.volume(hose.length_a)
    assert settings.dead_b == 0.4e-3 + hose.volume(hose.length_b)
    assert (settings.hose_a, settings.hose_b) == (
        hose.volume(hose.length_a),
        hose.volume(hose.length_b),
    )
    assert (settings.oil, settings.hose) == (1.4e9, 6e8)
