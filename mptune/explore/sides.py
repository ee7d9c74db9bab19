"""Both sides of Eq. 17 and Eq. 21 over the whole family, quickly enough to follow a hand.

A coarse grid of frequencies, laid finer about its highest ratios: a worst ratio is found to about
1e-4, and errs on the low side, as every grid's does. Verdicts are the certificate's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mptune.robust.grid import frequency_range, refinement

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.robust.condition import Sides
    from mptune.robust.model import LinearModel
    from mptune.robust.place import PlantPoint

_COARSE = 140  # frequencies
_ROUNDS = 2
_WITHIN = 0.02  # peaks lower than the highest by more than this share are left alone


@dataclass(frozen=True)
class GridSides:
    """Both inequalities on a grid.

    Attributes
    ----------
    model
        The linear model, its study holding the gains.
    omega
        ``(F,)`` frequencies [rad/s].
    found
        Both sides, ``(2, F)``, and the plants behind the left ones.
    """

    model: LinearModel
    omega: FloatArray
    found: Sides

    def worst(self, loop: int) -> tuple[float, PlantPoint]:
        """Return the largest ratio of Eq. 17 (0) or Eq. 21 (1), and where it is."""
        ratio = self.found.ratio[loop]
        place = int(np.argmax(ratio))
        at = self.model.point(int(self.found.plant[loop, place]), float(self.omega[place]))
        return float(ratio[place]), at


def grid_sides(model: LinearModel) -> GridSides:
    """Return both sides for the gains of the model's study."""
    gains = model.gains
    low, high = frequency_range(model.plants, model.nominal, gains)
    omega = np.geomspace(low, high, _COARSE)
    if model.members is not None:
        omega = np.union1d(omega, model.members.omega)
    found = model.sides(omega, gains)
    for _ in range(_ROUNDS):
        added = np.unique(
            np.concatenate([refinement(omega, ratio, _WITHIN) for ratio in found.ratio])
        )
        if not len(added):
            break
        omega, found = _joined(omega, found, added, model.sides(added, gains))
    return GridSides(model, omega, found)


def _joined(
    omega: FloatArray, old: Sides, added: FloatArray, new: Sides
) -> tuple[FloatArray, Sides]:
    """Return two evaluations as one, frequencies rising; plants' own worst are not kept."""
    both = np.concatenate([omega, added])
    order = np.argsort(both)
    left, plant, right = (
        np.concatenate([getattr(old, name), getattr(new, name)], axis=1)[:, order]
        for name in ("left", "plant", "right")
    )
    return both[order], old._replace(left=left, plant=plant, right=right)
