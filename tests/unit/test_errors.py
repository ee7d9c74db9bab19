"""Errors in words that say how to mend them."""

from __future__ import annotations

from mptune.errors import Fault, InputError, MptuneError


def test_a_fault_reads_as_key_value_rule_remedy():
    fault = Fault("oil.bulk_modulus", "'5 m'", "has the wrong dimension", "use Pa")
    assert str(fault) == "`oil.bulk_modulus` = '5 m' has the wrong dimension; use Pa"


def test_a_fault_of_a_whole_file_begins_with_its_rule():
    assert str(Fault("", "", "is empty", "restore it")) == "is empty; restore it"


def test_an_input_error_puts_the_file_before_every_fault():
    faults = Fault("a", "", "is bad", "mend it"), Fault("b", "", "is worse", "mend it")
    error = InputError("study.toml", *faults)
    assert isinstance(error, MptuneError)
    assert str(error).splitlines() == [
        "study.toml: `a` is bad; mend it",
        "study.toml: `b` is worse; mend it",
    ]
