"""Before and after on the machine: better, equal within the spread, or worse."""

from dataclasses import replace

import pytest

from mptune.verify.before_after import FIGURES, Mark, changes, in_a_sentence
from mptune.verify.result import CaseResult, CaseStatus, VerifyResult

SMALLEST = 1e-9


class Sets:
    """Figures of one movement set, all the same number."""

    def __init__(self, value):
        for key in FIGURES:
            setattr(self, key, value)


def case(*values, mass=24500.0, seed=1, oil=1.2e9, status=CaseStatus.STABLE):
    sets = tuple(Sets(value) for value in values)
    return CaseResult(
        mass, (0.005, 0.008), oil, 9.7e3, seed, status, "", float("nan"), sets, None, None
    )


def result(*cases):
    return VerifyResult(None, None, None, cases)


def marks(before, after):
    return {one.mark for one in changes(result(*before), result(*after))}


def test_what_lies_inside_the_scatter_of_sets_is_equal_and_beyond_it_is_not():
    before = [case(10.0, 12.0), case(11.0, 13.0, seed=2)]  # rms about 11.5: sqrt(5/3)
    spread = changes(result(*before), result(*before))[0].spread
    assert spread == pytest.approx((5 / 3) ** 0.5)

    def moved(by):
        return [
            replace(one, sets=tuple(Sets(s.final_error_mm + by) for s in one.sets))
            for one in before
        ]

    assert marks(before, moved(0.99 * spread)) == {Mark.EQUAL}
    assert marks(before, moved(-0.99 * spread)) == {Mark.EQUAL}
    assert marks(before, moved(1.01 * spread)) == {Mark.WORSE}
    assert marks(before, moved(-1.01 * spread)) == {Mark.BETTER}


def test_how_machines_differ_from_one_another_is_no_spread():
    before = [case(10.0, 10.2), case(30.0, 30.2, oil=0.8e9)]
    after = [case(11.0, 11.2), case(31.0, 31.2, oil=0.8e9)]
    assert marks(before, after) == {Mark.WORSE}


def test_a_single_set_of_a_single_seed_has_no_spread():
    assert marks([case(10.0)], [case(10.0)]) == {Mark.EQUAL}
    assert marks([case(10.0)], [case(10.0 + SMALLEST)]) == {Mark.WORSE}


def test_what_is_no_longer_stable_is_worse_whatever_its_figures_say():
    lost = case(1.0, 1.0, status=CaseStatus.LIMIT_CYCLE)
    assert marks([case(10.0, 10.0)], [lost]) == {Mark.WORSE}
    assert marks([lost], [case(10.0, 10.0)]) == {Mark.BETTER}


def test_means_are_of_all_sets_and_the_largest_counts_where_the_largest_is_meant():
    found = {one.key: one for one in changes(result(case(1.0, 3.0)), result(case(1.0, 3.0)))}
    assert found["performance_index_ms"].before == 2.0
    assert found["final_error_mm"].after == 3.0


def test_a_sentence_names_every_figure_with_the_masses_where_it_changed():
    before = [case(10.0), case(10.0, mass=49e3)]
    after = [case(9.0), case(11.0, mass=49e3)]
    text = in_a_sentence(changes(result(*before), result(*after)))
    start = "On the machine the tuned gains are better in performance index (24.5 t),"
    assert text.startswith(start)
    assert "; worse in performance index (49 t), loss (49 t)," in text
    assert "equal" not in text
    assert in_a_sentence(()) == ""
    said = in_a_sentence(changes(result(*before), result(*before)))
    figures = "performance index, loss, ∫ΔF², final, switches"
    assert said == f"On the machine the tuned gains are equal in {figures}."
