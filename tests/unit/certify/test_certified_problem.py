"""Boxes: what is refused, corners, growth, coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.certify.problem import PlantBox, edges_of
from mptune.params.packed import NominalPlant

SIDES = {"mass": (20e3, 40e3), "delay": (0.01, 0.02), "tau_a": (0.001, 0.01), "tau_b": (0.0, 0.02)}


def box(**sides):
    return PlantBox(NominalPlant(25e3, 0.012), **{**SIDES, **sides})


@pytest.mark.parametrize(
    ("sides", "words"),
    [
        ({"delay": (0.02, 0.01)}, "delay"),
        ({"tau_a": (-0.001, 0.01)}, "tau_a"),
        ({"tau_b": (0.0, float("nan"))}, "tau_b"),
        ({"mass": (0.0, 1.0)}, "positive masses"),
    ],
)
def test_what_is_no_box_is_refused(sides, words):
    with pytest.raises(ValueError, match=words):
        box(**sides)


def test_corners_are_each_counted_once():
    assert len(box().corners(0.5).mass) == 16
    assert len(box(mass=(20e3, 20e3), tau_b=(0.0, 0.0)).corners(0.5).mass) == 4


def test_a_box_grows_about_its_nominal_plant():
    grown = box().grown(2.0)
    assert grown.mass == (15e3, 55e3)
    assert grown.delay == pytest.approx((0.008, 0.028))
    assert grown.tau_a == (0.002, 0.02)
    assert grown.tau_b == (0.0, 0.04)
    assert box().grown(1.0) == box()


def test_growth_stops_at_floors():
    grown = box().grown(100.0, least_delay=0.005)
    assert grown.mass[0] == 25.0  # kg, a thousandth of the nominal mass
    assert grown.delay[0] == 0.005
    assert box().grown(0.0, 0.02).delay == (0.02, 0.02)


def test_boxes_are_joined_and_the_nominal_plant_is_one_of_them():
    far = PlantBox(NominalPlant(50e3, 0.005), **SIDES)
    joined = far.joined(far.grown(0.0))
    assert joined.mass == (20e3, 50e3)
    assert joined.delay == (0.005, 0.02)
    assert joined.tau_a == (0.0, 0.01)


def test_coordinates_hold_every_mass(published):
    problem = published["fig_5"]
    edges = edges_of(problem, (0.0, 300.0), phase=0.1)
    nominal = problem.box.nominal.mass
    masses = np.linspace(*problem.box.mass, 1001)
    assert np.all((edges[0, 1] <= nominal / masses) & (nominal / masses <= edges[1, 1]))
    assert edges[0, 5] == -edges[1, 5] == -0.1
