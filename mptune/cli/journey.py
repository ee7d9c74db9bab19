"""The list of commands as a user comes to them, each with a whole sentence."""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup

ORDER = (
    *("new", "run", "sweep", "tune", "verify", "compare", "explore"),
    *("identify", "campaign", "weights", "systems", "studies"),
    *("export", "warm", "ledger"),
)


class Journey(TyperGroup):
    """Commands in the order of a user's journey; one that has no place in it comes last."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the commands' names in that order."""
        places = {name: place for place, name in enumerate(ORDER)}
        return sorted(super().list_commands(ctx), key=lambda name: places.get(name, len(ORDER)))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command whose first paragraph is listed whole."""
        found: Any = super().get_command(ctx, cmd_name)
        if found is not None and not found.short_help and found.help:
            found.short_help = " ".join(found.help.split("\n\n")[0].split())
        return found
