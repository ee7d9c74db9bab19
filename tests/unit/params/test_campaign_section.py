"""What a study may say of a campaign, and what it may not."""

import pytest

from mptune.errors import InputError


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["campaign.runs=0"], "must be at least 1"),
        (["campaign.method=dice"], "is not a known word"),
        (["campaign.method=grid", "campaign.runs=10"], "points decide their number"),
        (["campaign.points=3"], "has no grid"),
        (["campaign.method=sobol", "campaign.failure_probability=0.1"], "no independent draws"),
        (["campaign.mass=[1, 2]"], "has no unit"),
        (['campaign.mass=["2 t", "1 t"]'], "reversed range"),
        (['campaign.temperature=["20 degC", "60 degC"]'], "must be at most 400 K"),
        (["campaign.chunk=0"], "must be at least 1"),
        (["campaign.doubt=0"], "must be greater than 0"),
        (["campaign.limits.final_error=1"], "has no unit"),
        (["campaign.worker=2"], "is an unknown key"),
    ],
)
def test_a_campaign_that_breaks_a_rule_is_refused(load_boom, overrides, message):
    with pytest.raises(InputError, match=message):
        load_boom(*overrides)
