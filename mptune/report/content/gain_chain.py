"""How far the gain at F_ref may rise, model by model: figure, table, and a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mptune.report.blocks import (
    Cell,
    Chapter,
    Figure,
    Note,
    Row,
    Tabular,
    left,
    right,
    verdict,
    wide,
)
from mptune.robust.chain import GAIN_RESERVE, factor_text
from mptune.robust.tables import place_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.report.results import Results
    from mptune.robust.chain import Link

_OF_FACTORS = (
    "Factor: where stability is lost, or for Eq. 17 and 21 no longer guaranteed. Guaranteed: "
    "proved for the whole box; —: rests on a grid, or on runs."
)


def gain_chain(results: Results) -> Chapter | None:
    """Return how far the gain at F_ref may rise, model by model."""
    if not results.chain:
        return None
    table = gain_factors(results.chain)
    around = (
        " Around a state estimator no velocity loop stands apart: Eq. 17 and 21 and the true "
        "family leave it out and are for information."
        if results.sweep.model.estimated
        else ""
    )
    return Chapter.of(
        table.title,
        Figure(
            "Factor on K_P,vel, which multiplies all of F_ref, at which stability is lost, or for "
            "Eq. 17 and Eq. 21 no longer guaranteed. Hatched, left of 1: lost as it is.",
            "chain",
        ),
        table,
        Note(
            "Each model is more complete than the one before; the machine is the study's "
            "verification cases, which are not the family's corners. A finite grid, and on the "
            "machine few movement sets, can only miss what limits sooner: the factors err on the "
            "high side. “Lumped delay”: the delays of Eq. 14 to 21 kept where path and sampling "
            f"are explicit, another reading, on which no verdict rests.{around}"
        ),
    )


def gain_factors(links: Sequence[Link]) -> Tabular:
    """Return the chain's factors and what limits each."""
    rows: list[Row] = [
        [
            link.name,
            factor_text(link.factor)
            if link.beside
            else verdict(factor_text(link.factor), good=link.safe >= GAIN_RESERVE),
            "—" if np.isnan(link.guaranteed) else factor_text(link.guaranteed),
            Cell(link.note or place_text(link.at), "small"),
        ]
        for link in links
    ]
    columns = [*left("Model"), *right("Factor", "Guaranteed"), wide("Limited by")]
    return Tabular("How far the gain at F_ref may rise", columns, rows, legend=_OF_FACTORS)


def factors_text(links: Sequence[Link]) -> str:
    """Return the chain's factors in a line."""
    counted = [link for link in links if not link.beside]
    factors = ", ".join(f"{link.name} {factor_text(link.factor)}" for link in counted)
    return f"Gain at F_ref may rise by: {factors}."
