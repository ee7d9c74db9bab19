"""CSV files: one tolerance for whoever reads them, and refusals that show what would do."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.headings import label_and_unit
from mptune.identify.responses import read_response
from mptune.identify.timeseries import Asked, read_record
from mptune.params.load import load_study
from mptune.params.table import read_table

HEADING = "a [m],b [s]"


def joined(rows, separator=",", end="\n"):
    return end.join(separator.join(row) for row in rows) + end


def with_commas(rows):
    return [rows[0], *([cell.replace(".", ",") for cell in row] for row in rows[1:])]


FORMS = {
    "plain": joined,
    "byte-order mark": lambda rows: "\ufeff" + joined(rows),
    "semicolons": lambda rows: joined(rows, ";"),
    "decimal commas": lambda rows: joined(with_commas(rows), ";"),
    "byte-order mark, semicolons, decimal commas, Windows": lambda rows: (
        "\ufeff" + joined(with_commas(rows), ";", "\r\n")
    ),
    "tabs": lambda rows: joined(rows, "\t"),
    "line ends of Windows": lambda rows: joined(rows, end="\r\n"),
    "line ends of old": lambda rows: joined(rows, end="\r"),
    "no last line end": lambda rows: joined(rows).rstrip("\n"),
    "blank lines around": lambda rows: "\n \n" + joined(rows) + "\n   \n\n",
    "empty cells at the end": lambda rows: joined([*rows, ["", ""], [" ", " "]]),
    "spaces": lambda rows: joined([[f" {cell}  " for cell in row] for row in rows]),
    "units in round brackets": lambda rows: joined(
        [[cell.replace("[", "(").replace("]", ")") for cell in row] for row in rows]
    ),
    "capitals": lambda rows: joined([[cell[0].upper() + cell[1:] for cell in row] for row in rows]),
    "quotes": lambda rows: joined([[f'"{cell}"' for cell in row] for row in rows]),
}


def reference(path, write_study):
    move = f'[{{kind = "file", file = "{path.name}", rest = "1 s"}}]'
    return load_study(write_study({"manoeuvre": move})).study.manoeuvre[0].samples


def load_table(path, write_study):
    return load_study(write_study({"load.table": f'"{path.name}"'})).study.load.table


def measured(path, write_study):
    study = load_study(write_study({"uncertainty.measured": f'["{path.name}"]'}))
    return study.uncertainty.measured[0].rows


def response(path, _):
    found = read_response(path)
    return found.omega.tolist(), found.response.tolist(), found.quality.tolist()


def record(path, _):
    found = read_record(path, Asked("F_ref", "F"))
    return found.reference.tolist(), found.force.tolist(), found.sample_time


RESPONSE_ROWS = [
    ["frequency [rad/s]", "real", "imaginary", "coherence"],
    *([f"{10.5 * n}", f"{1 / n}", f"{-0.1 * n}", "0.5"] for n in range(1, 6)),
]
USERS = {
    "reference": (
        reference,
        [["time [s]", "position [mm]"], *([f"{0.25 * n}", f"{1.5 * n}"] for n in range(5))],
    ),
    "load table": (
        load_table,
        [
            ["position [mm]", "force [kN]", "inertia [-]"],
            ["0", "-3.5", "1.2"],
            ["150", "0", "1"],
            ["300", "4.25", "0.8"],
        ],
    ),
    "measured response": (measured, RESPONSE_ROWS),
    "response": (response, RESPONSE_ROWS),
    "record": (
        record,
        [["t [ms]", "F_ref [kN]", "F [N]"], *([f"{0.5 * n}", "1.5", f"{n}e3"] for n in range(6))],
    ),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("user", USERS)
def test_every_user_takes_every_form(write_study, tmp_path, user, form):
    read, rows = USERS[user]
    path = tmp_path / "data.csv"
    path.write_bytes(joined(rows).encode())
    plain = read(path, write_study)
    path.write_bytes(FORMS[form](rows).encode())
    assert read(path, write_study) == plain


@pytest.mark.parametrize("user", USERS)
def test_every_user_refuses_a_file_without_headings_and_shows_one(write_study, tmp_path, user):
    read, rows = USERS[user]
    path = tmp_path / "data.csv"
    path.write_text(joined(rows[1:]))
    with pytest.raises(InputError, match=r"line 1` holds numbers and no headings; .* like .*\["):
        read(path, write_study)


@pytest.mark.parametrize("user", USERS)
def test_every_user_names_the_file_that_is_not_there(write_study, tmp_path, user):
    with pytest.raises(InputError, match=r"gone\.csv: does not exist; check the path") as caught:
        USERS[user][0](tmp_path / "gone.csv", write_study)
    assert "mptune new" not in str(caught.value)


def table_of(tmp_path, text):
    path = tmp_path / "data.csv"
    path.write_text(text, encoding="utf-8")
    return read_table(path, HEADING)


def test_columns_come_with_name_unit_and_line(tmp_path):
    table = table_of(tmp_path, "\nx [mm];y\n1,5;2\n\n;-3e1\n")
    assert table.labels == ("x", "y")
    assert table.units == ("mm", "")
    np.testing.assert_array_equal(table.columns, [[1.5, np.nan], [2.0, -30.0]])
    assert table.lines == (3, 5)


def test_a_row_of_empty_cells_that_others_follow_is_kept(tmp_path):
    np.testing.assert_array_equal(
        table_of(tmp_path, "a,b\n1,2\n,\n3,4\n,\n").columns, [[1, np.nan, 3], [2, np.nan, 4]]
    )


@pytest.mark.parametrize(
    ("heading", "label", "unit"),
    [
        ("F_ref [kN]", "F_ref", "kN"),
        ("F[kN]", "F", "kN"),
        ("Frequency (Hz)", "Frequency", "Hz"),
        ("Time(s)", "Time", "s"),
        ("omega (rad/s)", "omega", "rad/s"),
        ("Gain (dB)", "Gain", "dB"),
        ("inertia (-)", "inertia", "-"),
        ("real [1]", "real", "1"),
        ("u[1]", "u[1]", ""),
        ("u(2,3)", "u(2,3)", ""),
        ("u[1] [kN]", "u[1]", "kN"),
        ("Force (filtered)", "Force (filtered)", ""),
        ("Force (filtered) [kN]", "Force (filtered)", "kN"),
        ("Force [filtered]", "Force", "filtered"),
        ("position", "position", ""),
        (" [m] ", "", "m"),
    ],
)
def test_a_heading_is_a_name_and_a_unit(heading, label, unit):
    assert label_and_unit(heading) == (label, unit)


def test_an_index_behind_a_name_that_is_known_is_a_plain_unit(write_study, tmp_path):
    path = tmp_path / "data.csv"
    path.write_text("position[mm],force(kN),inertia[1]\n0,1,1.2\n300,2,0.8\n")
    assert load_table(path, write_study) == ((0.0, 1e3, 1.2), (0.3, 2e3, 0.8))
    rows = [["frequency[Hz]", "real[1]", "imaginary[1]"], *RESPONSE_ROWS[1:]]
    path.write_text(joined([row[:3] for row in rows]))
    assert len(measured(path, write_study)) == 5


def test_a_comma_in_a_unit_is_no_separator_where_there_are_semicolons(tmp_path):
    assert table_of(tmp_path, "a, peak [m];b [s]\n1;2\n").labels == ("a, peak", "b")


@pytest.mark.parametrize(
    ("text", "rule", "remedy"),
    [
        ("a;b\n1;2\n1,500;2.5\n", "`line 3` has a comma within a number", "one decimal sign"),
        ("a;b\n1.500,5;2\n", "`line 2` has a comma", "group no digits"),
        ("a;b\n1,500,000;2\n", "`line 2` = 1,500,000,2 is no row of numbers", HEADING),
        ("a\tb\n1,5\t2\n", "`line 2` = 1,5,2 is no row of numbers", "decimal point"),
        ("a,b\n1,5,2,5\n", "`line 2` has 4 cells where the header has 2", "by semicolons"),
        ("a,b\n1,2\n3\n", "`line 3` has 1 cells where the header has 2", "cut off"),
        ("a,b\n1,two\n", "`line 2` = 1,two is no row of numbers", HEADING),
        ("a [m],a [s]\n1,2\n", "names two columns", HEADING),
        ("0,5;1\n1;2\n", "holds numbers and no headings", HEADING),
        ("\ufeff", "is empty", "check the path"),
        ("\n\n", "is empty", "check the path"),
        ('a,b\n"' + 200_000 * "1", "is no row of cells", "mend it"),
    ],
)
def test_what_cannot_be_read_is_refused_by_line_rule_and_remedy(tmp_path, text, rule, remedy):
    with pytest.raises(InputError) as caught:
        table_of(tmp_path, text)
    assert rule in str(caught.value)
    assert remedy in str(caught.value)


@pytest.mark.parametrize(
    ("user", "heading", "would_do"),
    [
        ("reference", "t [s],position [mm]", "time [s],position [m]"),
        ("reference", "time [s],position [MPa]", "time [s],position [m]"),
        ("load table", "position [mm],force [kN]", "position [m],force [N],inertia [1]"),
        ("load table", "position [m],force [N],inertia [kg]", "inertia [1]"),
        ("measured response", "w [rad/s],real", "frequency [rad/s],magnitude [dB],phase [deg]"),
        ("record", "t [ms],F_reference [kN],F [N]", "F_reference"),
    ],
)
def test_a_heading_that_will_not_do_is_met_with_one_that_would(
    write_study, tmp_path, user, heading, would_do
):
    read, rows = USERS[user]
    path = tmp_path / "data.csv"
    count = heading.count(",") + 1
    path.write_text(joined([heading.split(","), *(row[:count] for row in rows[1:])]))
    with pytest.raises(InputError) as caught:
        read(path, write_study)
    assert would_do in str(caught.value)


def test_a_value_that_is_not_finite_is_refused_by_its_line(write_study, tmp_path):
    path = tmp_path / "data.csv"
    path.write_text("time [s],position [mm]\n\n0,0\n1,1\ninf,2\ninf,3\n")
    with pytest.raises(InputError, match="line 5"):
        reference(path, write_study)
