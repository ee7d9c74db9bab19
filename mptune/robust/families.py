"""The true family's stability and margins: without and with the measurement path, and sampled."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.arrays import FloatArray, frozen
from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.sampled import stable_as_sampled
from mptune.loops.stability import PoleCount, count_unstable_poles
from mptune.robust.family import Family
from mptune.robust.margins import Margins, family_margins, sampled_margins

if TYPE_CHECKING:
    from mptune.arrays import BoolArray, IntArray
    from mptune.params.controller import Gains
    from mptune.params.packed import LoopGains, Plants
    from mptune.robust.model import LinearModel


def true_family(model: LinearModel, gains: LoopGains, path: str, omega: FloatArray) -> Family:
    """Return stability and margins of the true family with one of the model's continuous paths.

    Where measured members stand instead of the box, the box's plants are not asked: what lies
    beyond the measured band then rests on the loop being small at its end.
    """
    loops, members = model.loops(gains, model.path_of(path)), model.members
    parts = []
    if members is None or not members.instead:
        counts = [count_unstable_poles(loops.broken_at(which)) for which in (VELOCITY, FORCE)]
        parts.append(_part(path, loops.plants, counts, family_margins(omega, loops)))
    if members is not None:
        from mptune.robust.measured_loops import count_members, member_margins

        counts = [count_members(which, members, gains, loops.path) for which in (VELOCITY, FORCE)]
        margins = member_margins(members, gains, loops.path)
        parts.append(_part(path, members.plants(), counts, margins, members.names))
    return parts[0] if len(parts) == 1 else parts[0].joined(parts[1])


def stable_plants(
    model: LinearModel, gains: Gains, family: Family, rows: IntArray, factor: float
) -> BoolArray:
    """Return whether some plants of a family are certainly stable with K_P,vel multiplied.

    Parameters
    ----------
    model, gains
        The linear model and the gains that the family was judged with.
    family
        The family; with or without measurement path, or as it runs.
    rows
        Numbers of plants of the family.
    factor
        Factor on K_P,vel, and with it on all of F_ref.
    """
    box = family.plants.number - len(family.responses)
    of_box, of_members = rows[rows < box], rows[rows >= box] - box
    if family.path == "sampled":
        loops = model.as_it_runs(gains, family.plants.picked(of_box)).scaled(factor)
        return stable_as_sampled(loops, model.period)[0]
    path = model.path_of(family.path)
    loops = model.loops(gains, path, family.plants.picked(of_box)).scaled(factor)
    stable = count_unstable_poles(loops).stable
    if model.members is None or not len(of_members):
        return stable
    from mptune.robust.measured_loops import count_members

    counted = count_members(FORCE, model.members, loops.gains, path)
    return np.concatenate([stable, counted.stable[of_members]])


def _part(
    name: str,
    plants: Plants,
    counts: list[PoleCount],
    margins: Margins,
    responses: tuple[str, ...] = (),
) -> Family:
    velocity, whole = counts
    unstable = np.stack([~velocity.stable, ~whole.stable, ~whole.stable])
    if name == "estimator":  # no velocity loop separates: there is but the loop at F_ref
        velocity, unstable[:2] = whole, True
    masked = Margins(*(frozen(np.where(unstable, np.nan, figure)) for figure in margins))
    return Family(
        path=name,
        plants=plants,
        velocity_stable=frozen(velocity.stable),
        stable=frozen(whole.stable),
        decided=frozen(velocity.decided & whole.decided),
        margins=masked,
        responses=responses,
    )


def as_sampled(model: LinearModel, gains: LoopGains, omega: FloatArray) -> Family | None:
    """Return stability and margins of the true family as it runs.

    None where some plant's total delay is below half a sampling period: no hold fits into it.
    """
    if not model.runs:
        return None
    loops = model.as_it_runs(gains)
    stable, decided = stable_as_sampled(loops, model.period)
    margins = sampled_margins(omega, loops, model.period)
    masked = Margins(*(frozen(np.where(stable, figure, np.nan)) for figure in margins))
    return Family(
        path="sampled",
        plants=model.explicit,
        velocity_stable=frozen(stable),
        stable=frozen(stable),
        decided=frozen(decided),
        margins=masked,
    )
