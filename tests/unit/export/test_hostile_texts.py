"""A corpus of hostile texts through every target: each is compiled or parsed, and none means more.

Names reach the writers here as they stand, without the rule that names of files pass.
"""

from __future__ import annotations

import io
import json
import re
import shutil
import subprocess
import tomllib
import zipfile
from html.parser import HTMLParser
from xml.etree import ElementTree as ET

import pypdf
import pytest
from hostile import TEXTS
from structured_text_language import PARSER
from target import gains_of, gcc, zig

from mptune.escaping import comment_text, figure_text, file_name, html_text, printable
from mptune.export.c_source import c_sources
from mptune.export.description import fmi2_description, fmi3_description
from mptune.export.formats import Precision
from mptune.export.structured_text import structured_text
from mptune.export.table import as_json, as_toml
from mptune.figures.style import new_figure, to_svg
from mptune.job.export import prepare
from mptune.params.gains import read_gains, write_gains
from mptune.params.judged_on import Difference
from mptune.report.blocks import Cell, Chapter, Document, Figure, FrontPage, Prose, Tabular, left
from mptune.report.pdf import pdf
from mptune.report.web import web_page

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-c", "-o")
COMPILERS = [one for one in (gcc(), zig()) if one]


@pytest.fixture(scope="module")
def controllers(load_boom):
    """A controller per text, of a study whose name, set and file are that text."""
    study = load_boom(corners=True)
    plain = prepare(study, gains_of(study), Precision.DOUBLE)
    found = []
    for text in TEXTS:
        named = study.model_copy(update={"name": text, "uncertainty_name": text})
        said = dict.fromkeys(("study", "uncertainty", "version", "date", "reason"), text)
        source = plain.source.model_copy(update=said)
        found.append(
            type(plain)(
                study=named,
                source=source,
                gains=plain.gains,
                feedforward=plain.feedforward,
                numbers=plain.numbers,
                margins=plain.margins,
                date=text,
                differs=(Difference(text, text, text),) * 30,
            )
        )
    return found


def without_comments(text):
    return re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)


def test_no_text_changes_the_code_of_any_c_file(controllers):
    plain = {name: without_comments(text) for name, text in c_sources(controllers[-1]).items()}
    date = re.compile(r'(?<=#define MPTUNE_DATE ")[\w .:+-]*(?=")')
    for controller in controllers:
        for name, text in c_sources(controller).items():
            assert date.sub("", without_comments(text)) == date.sub("", plain[name])
            assert max(map(len, text.splitlines())) < 4095


DATA = ("study", "ports", "lines", "chambers", "valves", "switches")
TYPES = ("parameters", "port", "line", "size", "real", "choice")


@pytest.mark.parametrize("compiler", COMPILERS, ids=lambda one: one[0].rsplit("/", 1)[-1])
def test_c_compiles_without_a_warning_and_defines_nothing_else(controllers, compiler, tmp_path):
    """Every text at once: the parameters' file of each in one source, under names of its own."""
    lines = []
    for number, controller in enumerate(controllers):
        sources = c_sources(controller)
        folder = tmp_path / str(number)
        folder.mkdir()
        for name in ("mptune_parameters.h", "mptune_parameters.c"):
            (folder / name).write_text(sources[name], encoding="utf-8")
        lines += [f"#define mptune_{name} own{number}_{name}" for name in (*DATA, *TYPES)]
        lines.append(f'#include "{number}/mptune_parameters.c"')
        lines += [
            f"#undef {name}"
            for name in (
                *(f"mptune_{one}" for one in (*DATA, *TYPES)),
                "MPTUNE_PARAMETERS_H",
                *re.findall(r"#define (MPTUNE_\w+) ", sources["mptune_parameters.h"]),
            )
        ]
    (tmp_path / "all.c").write_text("\n".join(lines) + "\n", encoding="utf-8")
    command = [*compiler, *STRICT, str(tmp_path / "all.o"), str(tmp_path / "all.c")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    listed = subprocess.run(
        [shutil.which("nm"), "--format=posix", str(tmp_path / "all.o")],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    symbols = {line.split()[0] for line in listed.splitlines()}
    assert symbols == {f"own{n}_{name}" for n in range(len(controllers)) for name in DATA}


def test_structured_text_parses_to_the_same_program(controllers):
    plain = PARSER.parse(structured_text(controllers[-1]))
    for controller in controllers:
        assert PARSER.parse(structured_text(controller)) == plain


def test_xml_parses_and_says_each_text_in_its_attribute_alone(controllers):
    shapes = set()
    for controller, text in zip(controllers, TEXTS, strict=True):
        for made in (fmi2_description(controller, "{}", ["a.c"]), fmi3_description(controller, "")):
            root = ET.fromstring(made.encode("utf-8"))  # noqa: S314 - our own
            assert printable(text) in root.attrib["description"]
            shapes.add((root.attrib["fmiVersion"], *(one.tag for one in root.iter())))
    assert len(shapes) == 2


def test_toml_and_json_parse_and_give_each_text_back(controllers, tmp_path):
    for controller, text in zip(controllers, TEXTS, strict=True):
        said = printable(text, keep="\n")
        written = as_toml(controller).encode("utf-8")
        values = tomllib.loads(written.decode())
        assert values["provenance"]["study"] == said
        assert set(values) == set(tomllib.loads(as_toml(controllers[-1])))
        assert json.loads(as_json(controller).encode())["provenance"]["study"] == said
        if text.isprintable():
            path = write_gains(tmp_path / "gains.toml", controller.source)
            assert read_gains(path) == controller.source


def document(texts):
    rows = [[text, Cell(text, "key"), Cell(text, "symbol"), Cell(text, "good")] for text in texts]
    table = Tabular("t", left(*"abcd"), rows, keep=False)
    front = FrontPage(texts, texts[0], texts, texts, [table])
    chapters = [Chapter.of(text, Prose(text)) for text in texts]
    chapters.append(Chapter.of("figure", *(Figure(text, "drawn") for text in texts[:2])))
    return Document(texts[0], texts[0], satisfied=True, front=front, chapters=chapters)


class Tags(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found, self.events = set(), []

    def handle_starttag(self, tag, attributes):
        self.found.add(tag)
        self.events += [key for key, _ in attributes if key.startswith("on")]
        self.events += [one for key, one in attributes if "script" in f"{one}{key}".lower()]


def drawn_svg():
    figure = new_figure(3)
    axes = figure.subplots()
    for n, text in enumerate(TEXTS):
        axes.plot([0, 1], [n, n], label=figure_text(text[:200]))
    axes.legend(fontsize=3)
    return to_svg(figure)


def test_html_holds_the_tags_of_a_harmless_report_and_no_script():
    svg = {"drawn": drawn_svg()}
    tags, plain = Tags(), Tags()
    tags.feed(web_page(document(TEXTS), svg).encode("utf-8").decode())
    plain.feed(web_page(document(["harmless"]), {"drawn": to_svg(new_figure(1))}))
    assert tags.events == plain.events == []
    assert tags.found - plain.found <= {"br", "use", "path", "g", "clippath", "rect", "defs", "sub"}


def test_svg_is_xml_without_a_script():
    root = ET.fromstring(drawn_svg())  # noqa: S314 - our own
    assert not [one for one in root.iter() if str(one.tag).lower().endswith("script")]


def test_the_pdf_prints_each_text_and_has_no_action():
    texts = [text[:300] for text in TEXTS]
    content = pdf(document(texts), {"drawn": drawn_svg()})
    reader = pypdf.PdfReader(io.BytesIO(content))
    said = "".join("".join(page.extract_text().split()) for page in reader.pages)
    assert '#read("/etc/passwd")' in said
    assert "root:x" not in said
    for name in (b"/JavaScript", b"/JS", b"/OpenAction", b"/Launch"):
        assert name not in content


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_a_name_becomes_a_file_an_entry_and_itself_again(text, tmp_path):
    name = file_name(text)
    assert file_name(name) == name
    assert name == name.strip()
    assert name[0] not in ".-"
    path = tmp_path / f"{name}.toml"
    path.write_bytes(b"x")
    assert [one.name for one in tmp_path.iterdir()] == [f"{name}.toml"]
    with zipfile.ZipFile(io.BytesIO(), "w") as archive:
        archive.writestr(name, "x")
        assert archive.namelist() == [name]


def test_names_that_were_changed_stay_apart():
    assert len({file_name(text) for text in TEXTS}) == len(set(TEXTS))
    assert file_name("boom-2dof") == "boom-2dof"
    assert file_name("käyttö (v2)") == "käyttö (v2)"


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_each_escaping_lets_through_what_it_allows_and_nothing_else(text):
    comment = comment_text(text)
    assert not set(comment) & set("*\\?{}$`;\n\r\x00\u2028") - {";"}
    assert comment.isprintable()
    assert not set(html_text(text)) & set("<>\"'`")
    assert printable(text).isprintable()
    printable(text).encode("utf-8")
