"""The PDF: its text holds verdict and gains, and a study's text is never taken as markup."""

import io
import json

import pypdf
import pytest

from mptune.job.run import run
from mptune.job.report import results_of
from mptune.report.content import document
from mptune.report.pdf import write_pdf
from mptune.report.web import write_html
from mptune.robust.encirclements import encirclements
from mptune.robust.chain import factor_text
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
    return replace(results_of(tmp_path, job, encirclements(job.tuned.sweep)), **changes)


def written(path, results):
    """Return the text of both reports, written without figures."""
    words = document(results, ())
    return text_of(write_pdf(path / "one.pdf", words, {})), write_html(
        path / "one.html", words, {}
    ).read_text(encoding="utf-8")


def pdf_of(job):
    return next(path for path in job.files if path.suffix == ".pdf")


def test_text_holds_verdict_gains_and_sources(job):
    text = text_of(pdf_of(job))
    assert "Every requirement is met" in text
    for key, unit, _, _ in job.tuned.gains.quantities():
        assert shown(getattr(job.tuned.gains, key), unit) in text
    assert "published: Table 2" in text
    assert "Where this differs from the paper" in text


def test_the_chain_is_in_the_report_with_every_factor(job):
    assert job.chain[-1].name == "nonlinear machine"
    text = " ".join(text_of(pdf_of(job)).split())
    after = text[text.index("How far the gain at") :]
    for link in job.chain:
        assert f"{link.name} {factor_text(link.factor)}" in after


def test_pdf_is_small(job):
    size = pdf_of(job).stat().st_size
    print(f"{size / 1e6:.2f} MB")
    assert size < 3e6


@pytest.mark.parametrize(
    "title",
    [
        '#panic("typst") $x^2$ *bold* _it_ @ref <label> \\ `raw` // end',
        r"\input{secret} \section{LaTeX} $\alpha$ %",
        "Ääkkösiä: nosturin käyttölaite, Δοκιμή ρευστών",
    ],
)
def test_title_is_printed_as_it_stands(load_boom, job, tmp_path, title):
    study = load_boom(f"title={json.dumps(title)}", corners=True)
    path = write_report(tmp_path / "titled.pdf", results_of(job, study=study), {})
    assert "".join(title.split())[:25] in "".join(text_of(path).split())


def test_report_without_some_figure_leaves_only_that_out(job, tmp_path):
    results = results_of(job, sweep=job.published, tuned=None, verified=None, satisfied=False)
    path = write_report(tmp_path / "bare.pdf", results, {})
    text = text_of(path)
    assert "Some requirement is not met" in text
    assert "nothing was tuned" in text


def test_unstable_plants_with_the_measurement_path_are_said_on_the_first_page(job):
    first = pypdf.PdfReader(pdf_of(job)).pages[0].extract_text()
    assert "unstable with the measurement path" in " ".join(first.split())
