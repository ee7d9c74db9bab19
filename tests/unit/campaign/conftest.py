"""Short campaigns: one small move, milliseconds per run."""

import pytest

from mptune.campaign.campaign import run_campaign
from mptune.campaign.plan import plan_campaign
from mptune.campaign.workers import Workers

SHORT = 'manoeuvre=[{distance="5 mm", duration="0.3 s", rest="0.1 s"}]'


@pytest.fixture(scope="session")
def plan(load_boom):
    """Plan a short campaign of the boom with overrides of ``[campaign]``."""

    def planned(*overrides):
        return plan_campaign(load_boom(SHORT, *(f"campaign.{one}" for one in overrides)))

    return planned


@pytest.fixture
def run(tmp_path):
    """Run a plan in this process and return its result."""

    def result(one, folder=tmp_path, **options):
        folder.mkdir(exist_ok=True)
        return run_campaign(one, folder, Workers(1, {"backend": "sequential"}), **options)

    return result
