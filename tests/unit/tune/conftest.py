"""The tuner's tests tune in the paper's own frame, but for those that name a study themselves."""

import pytest

from mptune.tune.tuner import tune


@pytest.fixture(scope="session")
def load_boom(load_in_paper_s_frame):
    return load_in_paper_s_frame


@pytest.fixture(scope="session")
def tuned_boom(load_boom):
    """The boom tuned in the paper's frame, on the corners of its box."""
    return tune(load_boom(corners=True))
