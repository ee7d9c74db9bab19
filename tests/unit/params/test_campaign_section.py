"""What a study may say of a campaign, and what it may not."""

import re

import pytest

from mptune.errors import InputError
from mptune.params.load import load_study
from mptune.params.template import write_template


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
        (['campaign.temperature=["20 degC", "160 degC"]'], "must be at most 400 K"),
        (["campaign.chunk=0"], "must be at least 1"),
        (["campaign.doubt=0"], "must be greater than 0"),
        (["campaign.limits.final_error=1"], "has no unit"),
        (["campaign.worker=2"], "is an unknown key"),
    ],
)
def test_a_campaign_that_breaks_a_rule_is_refused(load_boom, overrides, message):
    with pytest.raises(InputError, match=message):
        load_boom(*overrides)


def test_the_templates_campaign_is_valid_once_its_marks_are_gone(tmp_path):
    path = write_template(tmp_path, "crane")
    text = path.read_text(encoding="utf-8")
    begin, end = text.index("# [campaign]"), text.rindex("[sources]")
    path.write_text(
        text[:begin] + re.sub(r"(?m)^# ", "", text[begin:end]) + text[end:], encoding="utf-8"
    )
    campaign = load_study(path).study.campaign
    assert campaign.friction == (0.5, 2.0)
    assert campaign.limits.final_error == 1e-3
