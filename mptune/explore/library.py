"""The studies that the page offers: the one that was named, and those that stand beside it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.escaping import file_name
from mptune.explore.jobs import Ask
from mptune.params.load import load_study

if TYPE_CHECKING:
    from pathlib import Path

    from mptune.explore.setting import HandSetting
    from mptune.params.study import ResolvedStudy

_MOST = 30  # studies that are offered


@dataclass(frozen=True)
class Library:
    """Studies by name.

    Attributes
    ----------
    paths
        Name and file of each, the named one first.
    overrides, uncertainty
        ``--set`` texts and uncertainty set of the named study.
    """

    paths: tuple[tuple[str, Path], ...]
    overrides: tuple[str, ...] = ()
    uncertainty: str = ""

    @classmethod
    def around(cls, path: Path, overrides: tuple[str, ...] = (), uncertainty: str = "") -> Library:
        """Return a study and its neighbours: ``study.toml`` in the folders beside its own.

        Raises
        ------
        InputError
            If the study cannot be loaded.
        """
        named = load_study(path, overrides, uncertainty)
        found = {named.name: path}
        folder = path.resolve().parent.parent
        beside = sorted(folder.glob("*/study.toml"))[:_MOST] if path.name == "study.toml" else ()
        for one in beside:
            found.setdefault(file_name(one.parent.name), one)
        return cls(tuple(found.items()), overrides, uncertainty)

    @property
    def names(self) -> list[str]:
        """The studies' names."""
        return [name for name, _ in self.paths]

    def path(self, name: str) -> Path:
        """Return a study's file; that of the named one where the name is empty.

        Raises
        ------
        InputError
            If there is no such study.
        """
        found = dict(self.paths)
        if name and name not in found:
            remedy = f"choose one of {', '.join(found)}"
            raise InputError("the address", Fault("study", name, "is not known here", remedy))
        return found[name] if name else self.paths[0][1]

    def is_named(self, name: str) -> bool:
        """Return whether it is the study that was named."""
        return name in {"", self.paths[0][0]}

    def load(self, name: str, uncertainty: str) -> ResolvedStudy:
        """Return a study as it is written, with one of its uncertainty sets.

        Raises
        ------
        InputError
            If it cannot be loaded.
        """
        overrides = self.overrides if self.is_named(name) else ()
        return _loaded(self.path(name), overrides, uncertainty)

    def sets(self, name: str) -> list[str]:
        """Return the names of a study's uncertainty sets, the default's empty one first."""
        return ["", *sorted(self.load(name, "").study.uncertainty.sets)]

    def ask(self, setting: HandSetting) -> Ask:
        """Return what slow work asks of a setting."""
        study = self.load(setting.study, setting.uncertainty)
        own = self.overrides if self.is_named(setting.study) else ()
        return Ask(
            self.path(setting.study).resolve(),
            (*own, *setting.overrides(study)),
            setting.uncertainty,
        )


@lru_cache(maxsize=32)
def _loaded(path: Path, overrides: tuple[str, ...], uncertainty: str) -> ResolvedStudy:
    return load_study(path, overrides, uncertainty)
