"""What the commands print of the chain of gain factors at F_ref."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.cli.show import console, new_table, verdict
from mptune.robust.chain import factor_text
from mptune.robust.tables import place_text

if TYPE_CHECKING:
    from mptune.robust.chain import Link


def chain(links: tuple[Link, ...]) -> None:
    """Print how far the gain at F_ref may rise, as each model sees it."""
    table = new_table("How far the gain at F_ref may rise")
    table.add_column("model")
    table.add_column("factor", justify="right")
    table.add_column("limited by")
    for link in links:
        factor = verdict(factor_text(link.factor), good=link.factor >= 1)
        table.add_row(link.name, factor, place_text(link.at))
    console.print(table)
