"""How long the figures and both reports take once results exist, and how large they are."""

import time

import pytest

from mptune.job.report import draw_chain, draw_machine, linear_part, report, results_of
from mptune.job.run import run

pytestmark = pytest.mark.bench


def test_report_of_the_boom_study(load_boom, tmp_path):
    brief = ("verification.repeats=3", "verification.seeds=[1]")
    result = run(load_boom(*brief), tmp_path)
    start = time.perf_counter()
    linear = linear_part(result.tuned.sweep, result.moves)
    figures = {**linear.figures, **draw_chain(result.chain), **draw_machine(result.verified)}
    drawn = time.perf_counter()
    pdf, html = report(tmp_path, results_of(tmp_path, result, linear), figures)
    end = time.perf_counter()
    sizes = [path.stat().st_size / 1e6 for path in (pdf, html)]
    print(f"figures {drawn - start:.1f} s, reports {end - drawn:.1f} s")
    print(f"PDF {sizes[0]:.2f} MB, HTML {sizes[1]:.2f} MB")
    assert end - start < 15
    assert max(sizes) < 3
