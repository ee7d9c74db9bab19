"""What a study file is refused with: each fault has file, rule and remedy."""

from __future__ import annotations

import pytest

from mptune.errors import InputError
from mptune.params.load import load_study


def faults_of(path, overrides=(), uncertainty=""):
    with pytest.raises(InputError) as caught:
        load_study(path, overrides, uncertainty)
    assert caught.value.where == str(path)
    for fault in caught.value.faults:
        assert f"{path}: {fault}" in str(caught.value)
        assert fault.rule
        assert fault.remedy
    return caught.value.faults


def refused(path, key, rule, remedy=""):
    """Check the one fault of a file."""
    (fault,) = faults_of(path)
    assert fault.key == key
    assert rule in fault.rule
    assert remedy in fault.remedy
    return fault
