"""What the paper's own frame alone would give: what it asks, and how the machine judges it."""

from __future__ import annotations

from mptune.params.controller import Gains
from mptune.tune.papers_frame import has_papers_frame, in_papers_frame
from mptune.verify.before_after import FIGURES
from mptune.verify.beside import beside
from mptune.verify.result import CaseResult, CaseStatus, VerifyResult


class Sets:
    """Figures of one movement set, all the same number."""

    def __init__(self, value):
        for key in FIGURES:
            setattr(self, key, value)


def machine(*values):
    sets = tuple(Sets(value) for value in values)
    return CaseResult(
        24500.0, (0.005, 0.008), 1.2e9, 9.7e3, 1, CaseStatus.STABLE, "", float("nan"), sets, None,
        None,
    )  # fmt: skip


def result(*cases):
    return VerifyResult(None, None, None, cases)


def test_the_paper_s_frame_keeps_ratios_and_bounds_and_nothing_else(boom, load_in_paper_s_frame):
    found, own = in_papers_frame(boom).study, boom.study
    assert found.requirements.position_ratio == own.requirements.position_ratio
    assert found.requirements.bounds == own.requirements.bounds
    assert own.requirements.noise_gain is not None
    assert found.requirements.noise_gain is None
    written = load_in_paper_s_frame().study  # a file without those keys
    assert (found.requirements, found.objective) == (written.requirements, written.objective)
    assert found.gains == own.gains
    assert in_papers_frame(boom).uncertainty.points == 2


def test_only_sets_that_both_have_run_are_compared():
    """The study's own gains were worse in later sets, which the other gains were spared."""
    before = result(machine(10.0, 10.2, 50.0, 50.0))
    one = beside(before, Gains(k_p_vel="1 N s/m", k_p_pos="1 1/s", k_i_pos="1 1/s^2",
                               omega="1 rad/s", xi=1.0, tau="1 ms"),
                 (14e-3, 10e-3), result(machine(12.0, 12.2)))  # fmt: skip
    change = one.changes[0]
    assert (change.before, change.after) == (10.1, 12.1)
    assert change.mark.value == "worse"
    assert one.brief.endswith(
        "14.00 → 10.00 ms on paper, worse on the machine in performance index, loss, ∫ΔF², final, "
        "switches."
    )
    assert "14.00 → 10.00 ms on paper. On the machine those gains are worse in" in one.headline


def test_around_a_state_estimator_there_is_no_paper_s_frame(boom, load_boom):
    assert has_papers_frame(boom)
    assert not has_papers_frame(load_boom('estimator.kind="state"'))
    assert not has_papers_frame(load_boom("verification.papers_frame=false"))
