"""The machines under commanded speeds, which have no position index."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.report.blocks import Block, Note, Row, Tabular, right
from mptune.sim.merit import OF_SPEEDS

if TYPE_CHECKING:
    from mptune.verify.result import VerifyResult


def commanded_speeds(verified: VerifyResult) -> Tabular | None:
    """Return how each machine follows the commanded speeds; None where the study has none."""
    if all(move.kind != "velocity" for move in verified.study.study.manoeuvre):
        return None
    rows: list[Row] = [
        [
            f"{case.mass_kg / 1e3:g}",
            f"{case.oil_bulk_modulus_pa / 1e6:g}",
            str(case.seed),
            *(one.text(case.figure(one.key)) for one in OF_SPEEDS),
        ]
        for case in verified.cases
    ]
    columns = right("Mass\n[t]", "Oil\n[MPa]", "Seed", *(one.title("\n") for one in OF_SPEEDS))
    return Tabular("Commanded speeds", columns, rows)


def followed_speeds(verified: VerifyResult) -> list[Block]:
    """Return that table with what its figures are; nothing where the study has no such moves."""
    table = commanded_speeds(verified)
    if table is None:
        return []
    note = Note(
        "Root mean square of the velocity error while a speed is commanded; lag where half of the "
        "speed is reached; the largest way beyond the place where the reference stopped. Moves of "
        "this kind have no position index."
    )
    return [*table.titled(), note]
