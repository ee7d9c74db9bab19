"""The house: no circles, no name twice, small files."""

from __future__ import annotations

import ast
from collections import Counter
from graphlib import TopologicalSorter
from pathlib import Path
from statistics import median

import grimp

PACKAGE = Path(__file__).parents[2] / "mptune"
SOURCES = {path: path.read_text(encoding="utf-8") for path in sorted(PACKAGE.rglob("*.py"))}
LINES = {str(path.relative_to(PACKAGE)): text.count("\n") for path, text in SOURCES.items()}


def test_no_module_imports_itself_by_way_of_others():
    graph = grimp.build_graph("mptune", cache_dir=None)
    order = TopologicalSorter(
        {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    )
    order.prepare()  # raises CycleError, naming the circle


def test_no_class_name_stands_twice():
    names = Counter(
        node.name
        for text in SOURCES.values()
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.ClassDef)
    )
    assert {name: count for name, count in names.items() if count > 1} == {}


def test_files_are_small():
    assert median(LINES.values()) <= 110
    assert {name: lines for name, lines in LINES.items() if lines > 330} == {}
