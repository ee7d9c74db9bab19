"""The terminal: colour only there and never against NO_COLOR, and tables at any width."""

import io
import os
import pty
import subprocess
import sys

import pytest
from rich.console import Console

from mptune.cli import terminal
from mptune.report.blocks import Note, Tabular, left, right, verdict, wide

SCRIPT = """
from mptune.cli.show import headline
from mptune.params.headline import Headline
from mptune.robust.headline import Judgement
word = Headline.MET if {met} else Headline.NOT_MET
headline(Judgement(word, "so it was asked"))
"""


def on_terminal(met, **environment):
    """Return what the outcome prints where stdout is a terminal."""
    main, other = pty.openpty()
    variables = {k: v for k, v in os.environ.items() if k not in {"NO_COLOR", "FORCE_COLOR"}}
    variables |= {"TERM": "xterm-256color", **environment}
    code = SCRIPT.format(met=met)
    subprocess.run([sys.executable, "-c", code], stdout=other, env=variables, check=True)
    os.close(other)
    text = b""
    try:
        while part := os.read(main, 4096):
            text += part
    except OSError:
        pass  # the end of a closed terminal
    os.close(main)
    return text.decode()


def test_a_terminal_gets_verdicts_in_colour():
    assert "\x1b[32m" in on_terminal(met=True)
    assert "\x1b[1;31m" in on_terminal(met=False)


def test_no_color_is_obeyed():
    text = on_terminal(met=True, NO_COLOR="1")
    assert "\x1b[3" not in text
    assert "Verdict: met: so it was asked" in text


@pytest.mark.parametrize("met", [True, False])
def test_a_pipe_gets_plain_text(met):
    command = [sys.executable, "-c", SCRIPT.format(met=met)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "\x1b" not in done.stdout
    assert done.stdout.startswith("Verdict: " + ("met:" if met else "not met:"))


WHERE = "24.5 t, d 21.5 ms, τ 12.2/11.9 ms, ω 55.6 rad/s"
ROWS = [
    ["velocity_ratio (Eq. 17)", "0.649912 kN s/m", "13.1–30.4", WHERE],
    ["position_ratio (Eq. 21)", "0.4798", "—", verdict("not met", good=False)],
]
COLUMNS = [*left("Requirement"), *right("Found", "Measured\n[kN² s]"), wide("Where")]
TABLE = Tabular("What was asked", COLUMNS, ROWS)


@pytest.fixture
def printed(monkeypatch):
    """Return what ``show`` prints on a terminal of some width."""

    def at(width, *blocks, **options):
        file = io.StringIO()
        console = Console(width=width, file=file, markup=False, emoji=False, highlight=False)
        monkeypatch.setattr(terminal, "console", console)
        terminal.show(*blocks, **options)
        return file.getvalue()

    return at


def test_no_number_and_no_word_is_broken_and_nothing_lost_at_any_width(printed):
    for width in range(30, 121):
        out = printed(width, TABLE)
        assert max(map(len, out.splitlines())) <= width
        for word in ("13.1–30.4", "0.4798", "velocity_ratio", "position_ratio", *WHERE.split()):
            assert word in out
        assert "…" not in out
        assert out.startswith("What was asked")
        if "·" not in out:
            assert "0.649912 kN s/m" in out


def test_the_widest_column_gives_way_first(printed):
    out = printed(80, TABLE)
    assert "velocity_ratio (Eq. 17)" in out
    assert WHERE not in out


def test_a_table_that_fits_is_as_wide_as_its_texts_and_its_headings_keep_their_lines(printed):
    lines = printed(120, TABLE).splitlines()
    assert "Measured" in lines[1]
    assert "[kN² s]" in lines[2]
    assert lines[4].startswith("velocity_ratio (Eq. 17)  0.649912 kN s/m  13.1–30.4  24.5 t")
    assert len(lines[3]) == len(lines[4]) == 23 + 15 + 9 + len(WHERE) + 3 * 2


def test_what_does_not_fit_is_a_list_with_each_value_behind_its_heading(printed):
    words = " ".join(printed(36, TABLE).split())
    assert "· velocity_ratio (Eq. 17); Found 0.649912 kN s/m; Measured [kN² s] 13.1–30.4" in words


def test_a_list_of_numbers_names_the_first_as_well(printed):
    table = Tabular("Runs", right("Mass\n[t]", "A long heading"), [["24.5", "1" * 20]])
    assert "· Mass [t] 24.5; A long heading" in " ".join(printed(22, table).split())


def test_a_table_without_rows_keeps_its_headings_and_notes_are_for_paper(printed):
    assert "Requirement" in printed(80, Tabular("None", COLUMNS, []))
    assert printed(80, Note("small print")) == ""
