"""The plants that are looked at: the nominal one, the chosen one, and the corners of the box."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from mptune.explore.setting import PLANTS
from mptune.loops.family import nominal_plants
from mptune.params.packed import NO_PATH
from mptune.robust.place import plant_point
from mptune.robust.tables import place_text

if TYPE_CHECKING:
    from mptune.explore.sides import GridSides
    from mptune.params.packed import MeasurementPath, Plants
    from mptune.robust.model import LinearModel
    from mptune.robust.place import PlantPoint

NOMINAL, CHOSEN = 0, 1
"""Rows of ``Looked.plants``; the corners of the box stand behind them."""


@dataclass(frozen=True)
class Looked:
    """Plants with the delays that go with the path that is looked along.

    Attributes
    ----------
    plants
        ``(2 + C,)``: nominal, chosen, corners.
    path
        The measurement path.
    names
        What the plants are, for print.
    """

    plants: Plants
    path: MeasurementPath
    names: tuple[str, ...]


def corner_model(model: LinearModel) -> LinearModel:
    """Return the model whose family is the corners of the box.

    τ_A and τ_B stand at the same end, so that there are eight. What is found on it is optimistic:
    worse plants may stand between them.
    """
    box = model.study.uncertainty.model_copy(update={"points": 2})
    whole = type(model).of(model.study.model_copy(update={"uncertainty": box}))
    lumped = whole.lumped
    alike = (lumped.tau_a == lumped.tau_a.min()) == (lumped.tau_b == lumped.tau_b.min())
    return replace(whole, lumped=lumped.picked(alike), explicit=whole.explicit.picked(alike))


def looked_at(sides: GridSides, corners: LinearModel, plant: str, *, with_path: bool) -> Looked:
    """Return the plants that are drawn.

    Parameters
    ----------
    sides
        Both inequalities, which know their worst plants.
    corners
        The model whose family is the corners of the box.
    plant
        The chosen one, one of ``PLANTS``. A measured response has no loop of its own here: the
        slowest light plant stands for it.
    with_path
        Whether they are looked at along the measurement path as it runs.
    """
    model = sides.model
    path = model.filters if with_path else NO_PATH
    family = corners.explicit if with_path else corners.lumped
    nominal = nominal_plants(model.nominal_along(path))
    chosen = _chosen(sides, corners, plant, with_path=with_path)
    if chosen is None:
        chosen = nominal
    plants = nominal.followed_by(chosen).followed_by(family)
    names = tuple(
        f"{label}{_said(plant_point(plants, row, float('nan')))}"
        for row, label in enumerate(["nominal: ", f"{plant}: ", *([""] * family.number)])
    )
    return Looked(plants, path, names)


def _said(at: PlantPoint) -> str:
    return place_text(at)


def _chosen(
    sides: GridSides, corners: LinearModel, plant: str, *, with_path: bool
) -> Plants | None:
    """Return the chosen plant as a family of one; None for the nominal one."""
    which = PLANTS.index(plant)
    if which == 2:
        return None
    if which < 2:
        _, at = sides.worst(which)
        if at.response is None:
            return sides.model.plant(at, as_it_runs=with_path)
        which = 4
    heavy, slow = divmod(which - 3, 2)
    rows = corners.corners()
    family = (corners.explicit if with_path else corners.lumped).picked(rows)
    wanted = (family.mass == (family.mass.max() if heavy else family.mass.min())) & (
        family.delay == (family.delay.max() if slow else family.delay.min())
    )
    return family.picked(np.flatnonzero(wanted)[:1])
