"""What the documentation shows is run: scripts, the README's Python, each command's options."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from mptune.cli.main import app

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "docs" / "examples").glob("*.py"))
CHEAP = {"own_loop"}
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs" / "guide").glob("*.md"))]
IN_THE_TEXT = re.compile(r"^mptune .+$", re.MULTILINE)
GROUP = typer.main.get_command(app)


def blocks(page, language):
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def commands():
    for page in PAGES:
        for block in blocks(page, "sh"):
            for line in IN_THE_TEXT.findall(block):
                yield pytest.param(shlex.split(line, comments=True)[1:], id=line.split("  ")[0])


@pytest.mark.parametrize("words", list(commands()))
def test_a_command_that_is_shown_is_understood(words):
    command = GROUP.commands[words[0]]
    command.make_context(words[0], words[1:])


def test_the_commands_that_are_shown_are_nearly_all():
    shown = {words.values[0][0] for words in commands()}
    assert shown >= set(GROUP.commands) - {"explore", "warm"}


def test_an_option_that_does_not_exist_is_noticed():
    with pytest.raises(Exception, match="No such option"):
        GROUP.commands["sweep"].make_context("sweep", ["study.toml", "--nothing"])


def run(source, folder):
    """Run a program at the repository's root, its results in a folder of their own."""
    done = subprocess.run(
        [sys.executable, "-c", source.replace("reports/", f"{folder.as_posix()}/")],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(path, id=path.stem, marks=[] if path.stem in CHEAP else pytest.mark.examples)
        for path in SCRIPTS
    ],
)
def test_a_script_runs(script, tmp_path):
    printed = run(script.read_text(encoding="utf-8"), tmp_path)
    assert printed
    assert any((tmp_path / "examples").iterdir())


def test_the_readme_s_designs_come_out_as_it_says(tmp_path):
    shown = [block for block in blocks(ROOT / "README.md", "python") if "mptune.design(" in block]
    assert len(shown) == 2
    printed = run("\n".join(["import mptune", *shown]), tmp_path).splitlines()
    assert re.match(r"optimal \{'k_p': 0\.63\d+, 'k_i': 0\.3253\d*\}", printed[0])
    assert re.match(r"certified 1\.399", printed[1])


@pytest.mark.examples
def test_the_readme_s_python_runs(tmp_path):
    printed = run("\n".join(blocks(ROOT / "README.md", "python")), tmp_path)
    assert printed.startswith("0.641")
