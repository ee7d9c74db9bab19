"""The chain of gain factors on the corners of the box, until the certified one is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.certify.result import Stability
from mptune.loops.broken import FORCE
from mptune.loops.stability import count_unstable_poles
from mptune.robust.chain import Link, gain_limit
from mptune.robust.condition import sides
from mptune.robust.families import as_sampled, true_family

if TYPE_CHECKING:
    from mptune.arrays import FloatArray
    from mptune.robust.family import Family
    from mptune.robust.model import LinearModel

_NAMES = {
    "none": "true family",
    "filters": "with measurement path",
    "estimator": "with state estimator",
    "sampled": "sampled",
}
_CLOSE = 1e-4  # relative width in which a factor is found


def corner_chain(corners: LinearModel, omega: FloatArray) -> tuple[Link, ...]:
    """Return the linear links, found on the corners of the box alone.

    Every factor errs on the high side, further than those of ``mptune.robust.chain``. A model that
    is not stable as it is has no factor here: what would restore it the certified chain says.

    Parameters
    ----------
    corners
        The model whose family is the corners of the box.
    omega
        ``(F,)`` frequencies [rad/s] from which margins are refined.
    """
    families = [true_family(corners, corners.gains, path, omega) for path in corners.paths]
    sampled = as_sampled(corners, corners.gains, omega)
    links = [_inequalities(corners, omega)]
    links += [_of_family(one) for one in families]
    if sampled is not None:
        links.append(_of_family(sampled))
    return tuple(links)


def _inequalities(corners: LinearModel, omega: FloatArray) -> Link:
    nominal = corners.nominal_loop(corners.gains)
    dense = np.union1d(omega, np.geomspace(omega[0], 3 * omega[-1], len(omega)))

    def holds(factor: float) -> bool:
        scaled = nominal.scaled(factor)
        found = sides(dense, corners.loops(scaled.gains), corners.nominal)
        return bool(found.ratio.max() < 1 and count_unstable_poles(scaled).stable[0])

    return Link("Eq. 17 and 21", gain_limit(holds, _CLOSE), None)


def _of_family(family: Family) -> Link:
    name = _NAMES[family.path]
    if family.stable.all():
        factor, at = family.worst("gain_margin", FORCE)
        return Link(name, factor, at)
    status = Stability.UNSTABLE if (family.decided & ~family.stable).any() else Stability.UNDECIDED
    note = f"{family.unstable_count} of {len(family.stable)} corners are not stable"
    return Link(name, float("nan"), None, stability=status, note=note)
