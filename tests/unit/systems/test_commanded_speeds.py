"""Systems are compared by the index of moves to a place: commanded speeds alone have none."""

import pytest

from mptune.errors import InputError
from mptune.job.systems import compare_systems
from mptune.params.load import load_study


def test_speeds_alone_are_refused_before_anything_runs(study_file):
    speed = 'kind = "velocity", speed = "50 mm/s", duration = "1 s", rest = "1 s"'
    study = load_study(study_file, [f"manoeuvre=[{{{speed}}}]"])
    with pytest.raises(InputError, match="has no move to a place"):
        compare_systems(study)
