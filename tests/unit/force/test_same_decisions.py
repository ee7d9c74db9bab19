"""The paper's machine decides and moves as it did before its sizes became data."""

import as_before
import numpy as np
import pytest

pytestmark = pytest.mark.compiled


@pytest.fixture(scope="module")
def before():
    with np.load(as_before.FILE) as file:
        return dict(file)


@pytest.mark.parametrize("name", as_before.OPTIONS)
def test_random_states_are_decided_as_before(before, name):
    found = as_before.decisions(name)
    assert len(found) == as_before.OPTIONS[name][0]
    np.testing.assert_array_equal(found, before[name])


def test_a_run_begins_as_before(before):
    """Up to what another mathematical library rounds otherwise; here it is the same to the bit."""
    found = as_before.short_run()
    for name in as_before.COLUMNS:
        np.testing.assert_allclose(found[name], before[name], rtol=1e-9, atol=1e-12, err_msg=name)
    same = [np.array_equal(found[name], before[name]) for name in as_before.COLUMNS]
    print(f"{sum(same)} of {len(same)} columns are the same to the last bit")
