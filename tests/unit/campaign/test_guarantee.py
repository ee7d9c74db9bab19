"""Clopper and Pearson's bound against scipy's own test, its definition, and experiment."""

import math

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from mptune.campaign.guarantee import guarantee, runs_needed, runs_table
from mptune.errors import InputError


@pytest.mark.parametrize(("runs", "failures"), [(10, 0), (100, 3), (1000, 1), (1375, 0), (50, 49)])
@pytest.mark.parametrize("doubt", [1e-6, 0.05])
def test_bound_is_that_of_the_exact_binomial_test(runs, failures, doubt):
    bound = guarantee(runs, failures, doubt).failure_probability
    test = binomtest(failures, runs, alternative="less")
    assert bound == pytest.approx(test.proportion_ci(1 - doubt, "exact").high, rel=1e-6)


@pytest.mark.parametrize(("runs", "failures"), [(10, 0), (100, 3), (400, 20)])
def test_at_the_bound_so_few_failures_have_the_probability_of_the_doubt(runs, failures):
    bound = guarantee(runs, failures, 1e-3).failure_probability
    assert binom.cdf(failures, runs, bound) == pytest.approx(1e-3, rel=1e-9)


def test_where_every_run_failed_nothing_is_guaranteed():
    assert guarantee(7, 7, 1e-3).failure_probability == 1.0


def test_the_true_probability_is_missed_no_more_often_than_promised():
    random, true, doubt = np.random.default_rng(1), 0.03, 0.1
    counts = random.binomial(200, true, 4000)
    missed = [guarantee(200, int(k), doubt).failure_probability < true for k in counts]
    assert np.mean(missed) <= doubt + 3 * math.sqrt(doubt * (1 - doubt) / 4000)


@pytest.mark.parametrize(
    ("epsilon", "delta"), [(0.01, 1e-6), (0.1, 0.05), (0.5, 0.5), (1e-4, 0.01)]
)
def test_runs_needed_without_a_failure_have_a_closed_form(epsilon, delta):
    assert runs_needed(epsilon, delta) == math.ceil(math.log(delta) / math.log1p(-epsilon))


@pytest.mark.parametrize("failures", [0, 1, 5])
def test_one_run_less_is_not_enough(failures):
    needed = runs_needed(0.02, 1e-3, failures)
    assert guarantee(needed, failures, 1e-3).failure_probability <= 0.02
    assert guarantee(needed - 1, failures, 1e-3).failure_probability > 0.02


@pytest.mark.parametrize("numbers", [(0.0, 0.1), (0.1, 1.0), (2.0, 0.1), (0.1, -1.0)])
def test_what_is_no_probability_is_refused(numbers):
    with pytest.raises(InputError, match="is not between 1e-12 and 1"):
        runs_table(*numbers)
