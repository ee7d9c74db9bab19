"""What the tuner may choose beside the controller's gains: feed-forward, estimator, filter."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.section import Range
    from mptune.robust.model import LinearModel

_LONGEST_LAG = 0.1  # s
_SLOWEST_ESTIMATOR, _FASTEST_ESTIMATOR = 5.0, 200.0  # rad/s


class Beside(NamedTuple):
    """What may be free beside the controller's gains: one row of ``BESIDE`` makes it so."""

    part: str  # field of ``Choice`` that holds it
    name: str  # its name there
    unit: float  # its scale: it may be 0, and so is not searched on a logarithmic one
    bounds: Callable[[LinearModel], Range]  # where the study does not say


def _up_to(largest: float) -> Callable[[LinearModel], Range]:
    return lambda _: (0.0, largest)


def _masses(model: LinearModel, least: float, largest: float) -> Range:
    """Return shares of the family's least and largest mass [kg]."""
    return least * float(model.plants.mass.min()), largest * float(model.plants.mass.max())


BESIDE = {
    "acceleration_mass": Beside(
        "feedforward", "acceleration_mass", 1e4, lambda model: _masses(model, 0.0, 2.0)
    ),
    "preview": Beside("feedforward", "preview", 1e-2, _up_to(_LONGEST_LAG)),
    "reference_lag": Beside("feedforward", "reference_lag", 5e-3, _up_to(_LONGEST_LAG)),
    "velocity_reference_lag": Beside(
        "feedforward", "velocity_reference_lag", 5e-3, _up_to(_LONGEST_LAG)
    ),
    "estimator_bandwidth": Beside(
        "estimator", "bandwidth", 10.0, lambda _: (_SLOWEST_ESTIMATOR, _FASTEST_ESTIMATOR)
    ),
    "estimator_mass": Beside("estimator", "mass", 1e4, lambda model: _masses(model, 0.5, 1.0)),
    "position_filter": Beside(
        "estimator",
        "position_filter",
        1e-2,
        lambda model: (model.filters.sample_time, _LONGEST_LAG),
    ),
}
"""By its name in ``objective.free``; what is not here is a gain, searched on its logarithm."""
