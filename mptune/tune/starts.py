"""Where the search starts: the study's own gains, the convex core's, and points about them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.tune.core import Core
from mptune.tune.space import Choice

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mptune.arrays import FloatArray
    from mptune.params.controller import Feedforward
    from mptune.params.packed import LoopGains
    from mptune.robust.model import LinearModel
    from mptune.tune.space import Space

_TAU_SHARES = (0.0, 0.5)  # of τ's range, on its logarithm, where the convex core is solved; where
# the velocity gain is free too, points all over the space take the place of the second
_SCATTERED, _SCATTER = 4, 0.8  # random starts where it is free, and how far off, in logarithms
_SCREENED, _TAKEN = 256, 6  # points looked at all over the space, and starts taken of them
_APART = 0.2  # of the space's sides: starts nearer to one another lead to the same
_SMALLER = (0.5, 0.25)  # of the position gains, tried where no convex start is known


def first_points(
    model: LinearModel, space: Space, gains: LoopGains, kind: str
) -> Iterator[FloatArray]:
    """Yield points to polish, each found only when it is asked for.

    Parameters
    ----------
    model, space
        The study's linear model, and what is free.
    gains
        The study's own gains, with the velocity gain to start from.
    kind
        The objective that weighs most.
    """
    own = Choice.of(model)._replace(gains=gains, feedforward=_matched_feedforward(model, space))
    yield space.point(own)
    if space.structure != "eq22":
        for share in _SMALLER:
            yield _scaled(space, own, share)
        return
    if kind == "robustness" or model.estimated:  # no convex core stands in for either
        yield from _scattered(space, space.point(own))
        return
    limits = space.limits()
    low, high = np.log(limits["tau"])
    core = Core(model, gains, model.corners(), limits)
    for share in _TAU_SHARES[: 1 if low == high or space.crowded else None]:
        _, found = core.shaped(float(np.exp(low + share * (high - low))), kind)
        yield space.point(own._replace(gains=found))
    if space.crowded:
        yield from _scattered(space, space.point(own))


def _scattered(space: Space, centre: FloatArray) -> Iterator[FloatArray]:
    """Yield points about the first start."""
    from scipy.stats import qmc

    shares = qmc.Sobol(len(centre), rng=np.random.default_rng(0)).random(_SCATTERED)
    yield from np.clip(centre + _SCATTER * (2 * shares - 1), space.low, space.high)


def screened(space: Space, merit: Callable[[FloatArray], float]) -> Iterator[FloatArray]:
    """Yield the best of many points all over the space, each far from those before.

    Local optima abound where single bounds bind, and all starts near the study's own gains may lead
    to the same poor one.
    """
    from scipy.stats import qmc

    if not len(space.names):
        return
    shares = qmc.Sobol(len(space.names), rng=np.random.default_rng(0)).random(_SCREENED)
    points = space.low + shares * (space.high - space.low)
    order = np.argsort([merit(point) for point in points])
    taken: list[FloatArray] = []
    for place in order:
        near = [np.abs(shares[place] - one).max() < _APART for one in taken]
        if any(near):
            continue
        taken.append(shares[place])
        yield points[place]
        if len(taken) == _TAKEN:
            return


def _matched_feedforward(model: LinearModel, space: Space) -> Feedforward:
    """Return the study's feed-forward, what is free of it and off matched to the machine.

    The reference is as late as the measured position, the acceleration as early as the force is
    late, and the mass in the middle.
    """
    late = 0.5 * float(model.explicit.delay.min() + model.explicit.delay.max())
    matched = {
        "acceleration_mass": float(np.sqrt(model.plants.mass.min() * model.plants.mass.max())),
        "preview": late + model.period / 2,
        "reference_lag": 0.0 if model.estimated else model.filters.filter_time,
        "velocity_reference_lag": 0.0,
    }
    own = model.study.study.feedforward
    free = {name: getattr(own, name) or matched[name] for name in space.names if name in matched}
    return own.model_copy(update=free)


def _scaled(space: Space, choice: Choice, share: float) -> FloatArray:
    gains = choice.gains
    smaller = gains._replace(k_p_pos=share * gains.k_p_pos, k_i_pos=share**2 * gains.k_i_pos)
    return space.point(choice._replace(gains=smaller))
