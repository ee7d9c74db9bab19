"""Plants that know their poles, zeros and dead time."""

import control
import numpy as np
import pytest

from mptune.errors import InputError
from mptune.shape.rational import RationalPlant, landmarks, rational_form
from mptune.shape.responses import response_of

S = control.tf("s")
OMEGA = np.geomspace(1e-3, 1e3, 200)
OBJECTS = {
    "lag": 1 / (S + 1) ** 3,
    "lead over a mode": (S + 3) * 5 / ((S + 1) * (S**2 + 2e-4 * S + 9)),
    "double integrator": 2 / (S**2 * (S + 4)),
    "slow and fast": 1 / ((S + 1e-6) * (S + 1e3)),
    "biproper": (S + 2) / (S + 1),
    "gain": control.tf([3.0], [1.0]),
}


@pytest.mark.parametrize("name", OBJECTS)
@pytest.mark.parametrize("convert", [lambda g: g, control.ss], ids=["tf", "ss"])
def test_objects_give_their_own_response(name, convert):
    plant = convert(OBJECTS[name])
    found = RationalPlant.of(plant, delay=0.3)
    expected = np.asarray(plant(1j * OMEGA)) * np.exp(-0.3j * OMEGA)
    assert found(1j * OMEGA) == pytest.approx(expected, rel=1e-6)
    assert found.delay == 0.3
    assert found.integrators == (2 if name == "double integrator" else 0)


def test_dead_times_add():
    once = RationalPlant.of(OBJECTS["lag"], delay=0.2)
    assert RationalPlant.of(once, delay=0.3).delay == pytest.approx(0.5)


def test_unstable_poles_are_counted():
    plant = RationalPlant([], [1.0, 2j, -2j, 0.0, 0.1 + 1j, 0.1 - 1j], 1.0)
    assert (plant.integrators, plant.unstable_poles) == (1, 3)


def test_what_does_not_know_its_poles_has_no_form():
    assert rational_form(lambda s: 1 / (s + 1)) is None
    with pytest.raises(InputError, match="give RationalPlant"):
        RationalPlant.of(lambda s: 1 / (s + 1))


def test_roots_that_mislead_are_not_used():
    """An object whose zeros are not those of its response."""

    class Misled:
        def __call__(self, s):
            return (s + 2) / (s + 1) ** 2

        def poles(self):
            return np.array([-1.0, -1.0])

        def zeros(self):
            return np.array([-2.01])

    assert rational_form(Misled()) is None
    assert response_of(Misled(), None, "plant").rational is None


def test_landmarks_see_a_light_mode():
    damping = 1e-4
    marks = landmarks([complex(-3 * damping, 3.0), complex(-3 * damping, -3.0), -7.0, 0.0])
    away = np.abs(marks - 3.0)
    assert 3.0 in marks
    assert 7.0 in marks
    assert np.sort(away)[1] < 0.5 * 3 * damping
    near = np.sort(away[(marks > 3.0) & (marks < 3.9)])
    assert (near[1:] / near[:-1]).max() < 1.6  # every distance from the mode is looked at
    assert np.all(marks > 0)


BAD = {
    "no conjugate": (([], [-1 + 2j], 1.0), "without its conjugate"),
    "improper": (([-1.0, -2.0], [-3.0], 1.0), "more"),
    "delay": (([], [-1.0], 1.0, -0.1), "no dead time"),
    "gain": (([], [-1.0], np.nan), "not finite"),
    "pole": (([], [np.inf], 1.0), "finite numbers"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_plant_is_refused(case):
    arguments, message = BAD[case]
    with pytest.raises(InputError, match=message):
        RationalPlant(*arguments)


def test_several_channels_are_refused():
    plant = control.ss(np.diag([-1.0, -2.0]), np.eye(2), np.eye(2), np.zeros((2, 2)))
    with pytest.raises(InputError, match="2 inputs and 2 outputs"):
        response_of(plant, None, "plant")
