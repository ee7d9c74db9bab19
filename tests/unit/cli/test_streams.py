"""What a shell does to the standard streams: closed, cut short, full, or of few characters."""

import errno
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from mptune.cli import terminal
from mptune.cli.main import status
from mptune.cli.options import a_path
from mptune.cli.show import ledger
from mptune.cli.spelling import SPELLING, spelt
from mptune.cli.streams import Outlet
from mptune.errors import InputError

posix = pytest.mark.skipif(os.name != "posix", reason="redirections of a POSIX shell")
LONG = "2·10⁻³ ≤ τ_A ± 1 µm … „K“ × B̂ → 10² · 5 °"


@pytest.mark.parametrize(
    ("encoding", "wanted"),
    [
        ("utf-8", LONG),
        ("cp1252", "2·10^-3 <= tau_A ± 1 µm … „K“ × B_hat -> 10² · 5 °"),
        ("latin-1", '2·10^-3 <= tau_A ± 1 µm ... "K" × B_hat -> 10² · 5 °'),
        ("ascii", '2*10^-3 <= tau_A +/- 1 um ... "K" x B_hat -> 10^2 * 5 deg'),
    ],
)
def test_a_character_that_an_encoding_lacks_is_spelt_out(encoding, wanted):
    assert spelt(LONG, encoding) == wanted


@pytest.mark.parametrize(
    ("text", "wanted"),
    [("Ω ω ξ ά", "Omega omega xi alpha"), ("─⠋", "--"), ("é", "e"), ("\udcff漢", "\\udcff\\u6f22")],
)
def test_any_character_at_all_can_be_printed(text, wanted):
    assert spelt(text, "ascii") == wanted
    assert text.encode("ascii", SPELLING).decode() == wanted


class Encoded(io.StringIO):
    """A text stream that says which encoding it has."""

    def __init__(self, encoding):
        super().__init__()
        self.name_of_encoding = encoding

    @property
    def encoding(self):
        return self.name_of_encoding


@pytest.mark.parametrize("width", [60, 80])
@pytest.mark.parametrize("encoding", ["cp1252", "latin-1", "ascii"])
def test_tables_in_few_characters_keep_their_columns(monkeypatch, encoding, width):
    file = Encoded(encoding)
    console = Console(width=width, file=file, markup=False, emoji=False, highlight=False)
    monkeypatch.setattr(terminal, "console", console)
    ledger()
    text = file.getvalue()
    text.encode(encoding)  # nothing is left for the error handler
    assert "tau_A" in text
    rules = {line for line in text.splitlines() if line.startswith("---")}
    assert len(rules) == 1
    places = [n for n, one in enumerate(rules.pop()) if one == "+"]
    for line in text.splitlines()[1:-1]:
        assert len(line) <= width
        assert [line[n] for n in places] in (["|"] * len(places), ["+"] * len(places))


def test_a_text_for_a_file_keeps_its_lines_at_any_width(monkeypatch):
    file = io.StringIO()
    monkeypatch.setattr(terminal, "console", Console(width=40, file=file, markup=False))
    text = f'measured = ["{"a" * 60}.csv"]\ntau_a = ["1 ms", "2 ms"]'
    terminal.verbatim(text)
    assert file.getvalue() == text + "\n"


class Broken(io.RawIOBase):
    """A stream whose every write fails, and counts."""

    def __init__(self, number):
        super().__init__()
        self.number, self.asked = number, 0

    def write(self, _):
        self.asked += 1
        raise OSError(self.number, os.strerror(self.number))


@pytest.mark.parametrize("number", [errno.EPIPE, errno.ENOSPC, errno.EIO])
def test_an_outlet_takes_everything_and_notes_what_was_lost(number):
    broken = Broken(number)
    outlet = Outlet(broken)
    stream = io.TextIOWrapper(io.BufferedWriter(outlet), write_through=True)
    for _ in range(3):
        stream.write("x" * 10_000)
        stream.flush()
    assert broken.asked == 1  # a stream that is lost is left alone
    failure = outlet.failure.errno if outlet.failure else None
    assert failure == (None if number == errno.EPIPE else number)


def shell(redirection, *arguments, **environment):
    """Return the status of a command line under a redirection, and what stderr says."""
    command = f'"{sys.executable}" -m mptune.cli {" ".join(arguments)} {redirection}'
    done = subprocess.run(
        ["/bin/bash", "-o", "pipefail", "-c", command],
        capture_output=True,
        env={**os.environ, **environment},
        check=False,
    )
    return done.returncode, done.stdout, done.stderr.decode()


@posix
@pytest.mark.parametrize(
    ("command", "redirection"),
    [("ledger", "| head -1"), ("--help", "2>&- | head -c 1"), ("--help", "<&- >&- 2>&-")],
)
def test_a_stream_that_is_closed_changes_no_status(command, redirection):
    code, _, err = shell(redirection, command)
    assert code == 0
    assert err == ""


@posix
@pytest.mark.parametrize("redirection", ["2>&-", ">&-", "2>/dev/full"])
def test_bad_input_stays_bad_input(redirection):
    code, _, err = shell(redirection, "new", "''")
    assert code == 2
    assert ("is no plain folder name" in err) is (redirection == ">&-")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a full device of Linux")
def test_a_full_disk_behind_stdout_is_a_result_that_could_not_be_written():
    code, _, err = shell(">/dev/full", "--help")
    assert code == 3
    assert err.startswith("mptune: standard output could not be written (No space left")
    assert len(err.splitlines()) == 1


@posix
def test_stdout_of_a_few_characters_is_no_reason_to_fail():
    code, out, err = shell("", "ledger", PYTHONIOENCODING="cp1252")
    assert (code, err) == (0, "")
    assert "where B = B_hat" in " ".join(out.decode("cp1252").split())


@pytest.mark.parametrize(
    "arguments",
    [["sweep", "STUDY", "--out", ""], ["new", "name", "--in", ""], ["export", "", "--to", "c"]],
)
def test_an_empty_path_is_refused(capsys, study_file, arguments):
    code = status([str(study_file) if one == "STUDY" else one for one in arguments])
    assert code == 2
    assert "is empty where a path is needed" in capsys.readouterr().err


def test_a_path_is_taken_as_it_stands(tmp_path):
    assert a_path(str(tmp_path)) == tmp_path
    with pytest.raises(InputError, match="is empty"):
        a_path("")
