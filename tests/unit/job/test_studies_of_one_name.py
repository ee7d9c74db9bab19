"""Studies that are run side by side have names of their own: each has a folder for its results."""

import pytest

from mptune.errors import InputError
from mptune.job.studies import run_studies


def test_two_studies_of_one_name_are_refused_before_anything_is_run(boom, load_boom, tmp_path):
    for pair in ([boom, boom], [boom, load_boom('load.force="5 kN"')]):
        with pytest.raises(InputError, match="boom is the name of more than one"):
            run_studies(pair, tmp_path / "out")
    assert not (tmp_path / "out").exists()
