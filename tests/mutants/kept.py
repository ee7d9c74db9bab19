"""The kept list of mutants: small wrong changes of mptune, and the tests that must catch each."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
LIST = Path(__file__).with_name("mutants.toml")


@dataclass(frozen=True)
class Mutant:
    """One change of one line, and who must notice it.

    Attributes
    ----------
    name
        What it is called on the command line and in the table.
    file
        The file it changes, from the root of the tree.
    old, new
        Text that occurs exactly once in the file, and what takes its place.
    tests
        The tests that must catch it: files, or ``file::test``.
    why
        What would go wrong unnoticed.
    compiled
        Whether the tests need the compiler; interpreted kernels are quicker for all others.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    why: str
    compiled: bool = False

    def occurrences(self, root: Path = ROOT) -> int:
        """Return how often the old text occurs in the file; 0 where there is no such file."""
        path = root / self.file
        return path.read_text(encoding="utf-8").count(self.old) if path.is_file() else 0

    def missing_tests(self, root: Path = ROOT) -> list[str]:
        """Return those named tests that do not exist."""
        return [test for test in self.tests if not _exists(test, root)]

    def applied(self, text: str) -> str:
        """Return the file's text with the change."""
        return text.replace(self.old, self.new)


def _exists(test: str, root: Path) -> bool:
    file, *names = test.split("::")
    path = root / file
    if not path.is_file():
        return False
    text = path.read_text(encoding="utf-8")
    return all(f"def {name}(" in text for name in names)


def kept_mutants(path: Path = LIST) -> tuple[Mutant, ...]:
    """Return the mutants of a list, in its order."""
    rows = tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    return tuple(Mutant(**{**row, "tests": tuple(row["tests"])}) for row in rows)
