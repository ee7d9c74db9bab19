"""The PDF: its text holds verdict and gains, and a study's text is never taken as markup."""

import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pypdf
import pytest

from mptune.job.report import LinearPart, results_of
from mptune.job.run import run
from mptune.job.studies import rows_of, run_studies
from mptune.loops.broken import FORCE
from mptune.params.headline import Headline
from mptune.params.pack import pack_gains
from mptune.report.document import write_report
from mptune.robust.chain import factor_text
from mptune.robust.encirclements import encirclements
from mptune.robust.headline import Judgement
from mptune.robust.one_at_a_time import one_at_a_time
from mptune.robust.sweep import sweep
from mptune.signals.tustin import discretise
from mptune.units import shown

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def job(load_boom, tmp_path_factory):
    brief = (
        "verification.repeats=2",
        "verification.seeds=[1]",
        'verification.oil_bulk_moduli=["1200 MPa"]',
    )
    return run(load_boom(*brief, corners=True), tmp_path_factory.mktemp("out"))


def text_of(path):
    reader = pypdf.PdfReader(io.BytesIO(path.read_bytes()))
    return "\n".join(page.extract_text() for page in reader.pages)


def changed(job, tmp_path, **changes):
    """Return what the report of a job shows, with changes."""
    swept = job.tuned.sweep
    linear = LinearPart(encirclements(swept), one_at_a_time(swept), {}, b"")
    return replace(results_of(tmp_path, job, linear), **changes)


def written(path, results):
    """Return the text of both reports, written without figures."""
    pdf, html = write_report(path / "one", results, {})
    return text_of(pdf), html.read_text(encoding="utf-8")


def written_pages(path, results):
    """Return the text of each page of a report, written without figures."""
    pdf, _ = write_report(path / "pages", results, {})
    return [page.extract_text() for page in pypdf.PdfReader(pdf).pages]


def pdf_of(job):
    return next(path for path in job.files if path.suffix == ".pdf")


@pytest.fixture(scope="module")
def text(job):
    return text_of(pdf_of(job))


def test_the_report_repeats_what_is_doubtful_about_the_study(job, tmp_path):
    (delay, moduli) = job.study.doubts
    for text in written(tmp_path, changed(job, tmp_path)):
        words = " ".join(text.split())
        for doubt in (delay, moduli):
            assert " ".join(doubt.rule.split()) in words


def test_text_holds_verdict_gains_and_sources(job, text):
    assert f"Verdict: {job.judgement.word}" in text
    for key, unit, _, _ in job.tuned.gains.quantities():
        assert shown(getattr(job.tuned.gains, key), unit) in text
    assert "published: Table 2" in text
    assert "Where mptune differs from the paper" in text


def test_the_chain_is_in_the_report_with_every_factor(job, text):
    assert [link.name for link in job.chain if not link.beside][-1] == "nonlinear machine"
    assert [link.name for link in job.chain if link.beside][-1] == "sampled, lumped delay"
    text = " ".join(text.split())
    after = text[text.index("How far the gain at") :]
    for link in job.chain:
        assert f"{link.name} {factor_text(link.factor)}" in after


def test_pdf_is_small(job):
    size = pdf_of(job).stat().st_size
    print(f"{size / 1e6:.2f} MB")
    assert size < 3e6


TITLES = [
    '#panic("typst") $x^2$ *bold* _it_ @ref <label> \\ `raw` // end',
    r"\input{secret} \section{LaTeX} $\alpha$ %",
    '<script>alert(1)</script> &amp; <b>bold</b> "quoted"',
    "Ääkkösiä: nosturin käyttölaite, Δοκιμή ρευστών",
]


class Texts(HTMLParser):
    """Collects the text outside style and pictures, the tags, and where links lead."""

    def __init__(self):
        super().__init__()
        self.text, self.tags, self.links, self._inside = [], [], [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.links += [value for name, value in attributes if name in {"href", "src", "xlink:href"}]
        if tag in {"style", "svg", "title"}:
            self._inside.append(tag)

    def handle_endtag(self, tag):
        if self._inside and self._inside[-1] == tag:
            self._inside.pop()

    def handle_data(self, data):
        if not self._inside:
            self.text.append(data)


def parsed(html):
    found = Texts()
    found.feed(html)
    return found


def squeezed(text):
    return "".join(text.split())


@pytest.mark.parametrize("title", TITLES)
def test_a_study_s_words_are_printed_as_they_stand(load_boom, job, tmp_path, title):
    study = load_boom(f"title={json.dumps(title)}", corners=True)
    sources = {**study.study.sources, "cylinder": f"assumed: {title}"}
    sourced = study.study.model_copy(update={"sources": sources})
    study = study.model_copy(update={"study": sourced})
    pdf, html = written(tmp_path, changed(job, tmp_path, study=study))
    assert squeezed(title)[:25] in squeezed(pdf)
    assert f"assumed:{squeezed(title)[:12]}" in squeezed(pdf)
    found = parsed(html)
    text = "".join(found.text)
    assert title in text[: text.index("Study boom")]
    assert f"assumed: {title}" in text
    assert not {"script", "b"} & set(found.tags)


def test_report_without_some_results_leaves_only_those_out(job, tmp_path):
    bare = {"tuned": None, "verified": None, "moves": (), "moves_before": (), "chain": ()}
    bare |= {"encirclements": (), "influences": (), "changes": (), "sweep": job.published}
    bare |= {"judgement": Judgement(Headline.ON_PAPER, "so it is"), "verified_before": None}
    whole = written(tmp_path, changed(job, tmp_path))
    for text, before in zip(written(tmp_path, changed(job, tmp_path, **bare)), whole, strict=True):
        assert "Verdict: met on paper only" in text
        assert "So it is" in text
        assert "nothing was tuned" in text
        assert "published: Table 2" in text
        for missing in ("Linear check", "The nonlinear machine", "Encirclements of"):
            assert missing in before
            assert missing not in text


@pytest.mark.parametrize("missing", ["tuned", "verified", "chain", "influences", "moves"])
def test_each_result_may_be_missing_alone(job, tmp_path, missing):
    empty = None if missing in {"tuned", "verified"} else ()
    changes = {missing: empty} | ({"moves_before": ()} if missing == "moves" else {})
    pdf, html = written(tmp_path, changed(job, tmp_path, **changes))
    assert "Parameters and their sources" in pdf
    assert "Parameters and their sources" in html


def test_unstable_plants_with_the_measurement_path_are_said_on_the_first_page(
    job, tmp_path, load_boom
):
    unstable = changed(job, tmp_path, sweep=sweep(load_boom(corners=True, twice=True)))
    pdf, _ = write_report(tmp_path / "one", unstable, {})
    first = pypdf.PdfReader(pdf).pages[0].extract_text()
    assert "unstable with the measurement path" in " ".join(first.split())


def test_html_stands_alone_and_says_what_the_pdf_says(job):
    path = next(path for path in job.files if path.suffix == ".html")
    html = path.read_text(encoding="utf-8")
    found = parsed(html)
    assert found.links
    assert all(link.startswith("#") for link in found.links)
    assert not {"script", "link", "iframe", "object", "img"} & set(found.tags)
    text = " ".join("".join(found.text).split())
    assert f"Verdict: {job.judgement.word}" in text
    for key, unit, _, _ in job.tuned.gains.quantities():
        assert shown(getattr(job.tuned.gains, key), unit) in text
    for link in job.chain:
        assert factor_text(link.factor) in text
    identifiers = re.findall(r'<section id="([^"]+)"', html)
    assert identifiers == [link[1:] for link in found.links if link.startswith("#section")]
    assert path.stat().st_size < 3e6


def test_every_figure_stands_in_the_html_once_with_identifiers_of_its_own(job):
    html = next(path for path in job.files if path.suffix == ".html").read_text(encoding="utf-8")
    drawn = {path.stem for path in job.files if path.suffix == ".svg"}
    assert {"nyquist", "sensitivity", "load"} <= drawn
    for name in drawn:
        assert html.count(f'id="{name}-figure_1"') == 1
    used = set(re.findall(r'(?:href="#|url\(#)([^")]+)', html))
    assert used <= set(re.findall(r'\bid="([^"]+)"', html))


def test_no_page_of_the_pdf_is_all_but_empty_and_all_are_numbered(job):
    pages = pypdf.PdfReader(pdf_of(job)).pages
    for number, page in enumerate(pages, 1):
        text = " ".join(page.extract_text().split())
        assert f"{number} / {len(pages)}" in text
        drawn = len(page.get_contents().get_data())
        assert len(text) > 400 or drawn > 20_000
        if number > 1:
            assert job.study.hash()[:12] in text


@pytest.mark.parametrize("doubts", [0, 6])
def test_contents_that_run_over_have_no_page_to_themselves(job, tmp_path, doubts):
    study = job.study.model_copy(update={"doubts": job.study.doubts[:1] * doubts})
    results = replace(changed(job, tmp_path), study=study)
    pages = written_pages(tmp_path, results)
    chapter = next(n for n, page in enumerate(pages) if "Both inequalities" in page and n > 0)
    assert chapter == 1
    assert ("11 Where mptune" in pages[1]) == (doubts > 0)  # their last line


def test_section_7_is_beside_with_what_is_predicted_and_what_calibrated(text):
    text = " ".join(text.split())
    after = text[text.index("(§7)") :]
    for value in ("19.5", "18.9", "45", "29", "15.9", "50.8", "31"):
        assert f" {value} " in after
    assert "performance index [ms] 13.1–30.4" in after
    assert "predicted" in after
    assert "calibrated" in after


def test_another_machine_is_beside_no_measurement_of_the_paper(job, tmp_path):
    cases = tuple(replace(case, mass_kg=case.mass_kg + 1) for case in job.verified.cases)
    moves = tuple(replace(move, mass_kg=move.mass_kg + 1) for move in job.moves)
    changes = tuple(replace(one, mass_kg=one.mass_kg + 1) for one in job.changes)
    other = {"verified": replace(job.verified, cases=cases), "changes": changes}
    other |= {"moves": moves, "moves_before": moves, "verified_before": None}
    for text in written(tmp_path, changed(job, tmp_path, **other)):
        words = " ".join(text.split())
        assert "The figures of" in words
        assert "Before and after" in words
        for of_the_paper in ("beside the paper", "Other systems that", "published gains; here"):
            assert of_the_paper.lower() not in words.lower()


def test_discrete_coefficients_are_those_of_tustin(job, text):
    text = squeezed(text).replace("−", "-")
    law = discretise(pack_gains(job.tuned.gains), job.study.study.controller.sampling_period)
    for value in law:
        assert f"{value:.12g}" in text


def test_the_paper_s_own_frame_stands_beside_as_a_comparison(job, text):
    text = " ".join(text.split())
    assert job.papers_frame.index < 0.9 * job.papers_frame.index_before
    assert "Tuned in the paper's own frame".replace("'", "’") in text.replace("'", "’")
    assert f"{1e3 * job.papers_frame.index:.2f} ms on paper" in text
    values = job.json()["papers_frame"]
    assert {one["figure"] for one in values["changes"]} >= {"force_error_integral_kn2s"}
    assert values["gains"] != job.json()["tune"]["gains"]


def test_studies_stand_in_one_table_and_figure(job, tmp_path, monkeypatch):
    from mptune.job import studies as job_of_studies

    monkeypatch.setattr(job_of_studies, "run", lambda *_: job)
    found = run_studies([job.study, job.study.model_copy(update={"name": "other"})], tmp_path)
    rows = rows_of(job)
    assert list(found.rows) == [*rows, *rows]
    assert [(row["gains"], row["mass_kg"]) for row in rows] == [
        (gains, mass) for gains in ("own", "tuned") for mass in (24500.0, 49000.0)
    ]
    for row, machine in zip(rows[2:], job.verified.worst_per_mass(), strict=True):
        assert row["performance_index_ms"] == machine.figure("performance_index_ms")
    assert rows[0]["noise_force_n"] == job.published.noise_force
    assert rows[2]["gain_margin"] == job.tuned.sweep.sampled.worst("gain_margin", FORCE)[0]
    assert rows[2]["disk_margin_guaranteed"] <= rows[2]["disk_margin"]
    assert (tmp_path / "studies.md").read_text(encoding="utf-8").count("| boom |") == 8
    again = results_of(tmp_path, job, LinearPart((), (), {}, b""))
    assert again.leftovers.studies == found.rows
    assert "studies" in again.leftovers.figures
    assert "Studies beside the paper" in written(tmp_path, again)[0]
