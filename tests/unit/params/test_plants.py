"""Families of plants as kernels take them: rows picked out, and families one behind the other."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.params.packed import Plant, Plants

FEW = (
    Plant(24500.0, 0.011, 0.0, 0.0, 0.5),
    Plant(30000.0, 0.014, 0.001, 0.002, 0.57),
    Plant(49000.0, 0.0215, 0.0122, 0.0119, 0.6),
)


def family(*plants):
    return Plants(*np.array(plants).T.copy())


def rows_of(plants):
    return [Plant(*row) for row in zip(*plants, strict=True)]


def test_a_family_has_the_columns_of_a_plant():
    assert Plants._fields == Plant._fields
    assert family(*FEW).number == 3
    assert family(FEW[1]).number == 1


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([2, 0], [2, 0]),
        ([1, 1], [1, 1]),
        ([True, False, True], [0, 2]),
        ([False, True, False], [1]),
        ([False] * 3, []),
    ],
)
def test_plants_are_picked_by_number_or_by_mask(rows, expected):
    found = family(*FEW).picked(np.array(rows))
    assert rows_of(found) == [FEW[n] for n in expected]
    assert found.number == len(expected)


def test_picked_columns_are_whole_copies_as_kernels_want_them():
    plants = Plants(*np.array(FEW).T)  # columns with gaps between their values
    found = plants.picked(np.array([0, 2]))
    assert not any(column.flags.c_contiguous for column in plants)
    assert all(column.flags.c_contiguous for column in found)
    found.mass[0] = 1.0
    assert plants.mass[0] == 24500.0


def test_plants_behind_others_keep_their_order():
    found = family(*FEW[:2]).followed_by(family(FEW[2], FEW[0]))
    assert rows_of(found) == [FEW[0], FEW[1], FEW[2], FEW[0]]


def test_what_is_picked_from_both_parts_is_what_was_put_together():
    whole = family(*FEW)
    light = whole.mass < 40e3
    assert rows_of(whole.picked(light).followed_by(whole.picked(~light))) == rows_of(whole)
