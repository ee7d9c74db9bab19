"""The machine under a study's own gains beside the search: the same, or nothing at all."""

import threading
from contextlib import nullcontext

import pytest

from mptune.job import own_machine as beside


@pytest.fixture
def verifying(monkeypatch):
    """A verification of three machines, each of which waits to be let go."""
    go, told = threading.Semaphore(0), []

    def verify(study, progress):
        for number in range(3):
            go.acquire()
            told.append(number)
            progress("verify", (number + 1) / 3)
        return f"verified {study}"

    monkeypatch.setattr(beside, "verify", verify)
    monkeypatch.setattr(beside, "precompiling", lambda _: nullcontext(lambda: None))
    return go, told


def test_what_is_waited_for_is_what_verify_returns_and_how_far_it_is_is_told(verifying):
    go, _ = verifying
    shares = []

    def progress(stage, share):
        shares.append((stage, share))
        go.release()

    with beside.own_machine("boom") as own:
        assert own.result(progress) == "verified boom"
    assert {stage for stage, _ in shares} == {"verify own"}
    assert shares == sorted(shares)


def test_no_further_machine_is_run_where_none_is_asked_for(verifying):
    go, told = verifying
    with beside.own_machine("boom") as own:
        own.drop()
        go.release()
    assert told in ([], [0])  # the one under way ends


def test_the_block_s_error_is_the_one_that_is_seen(verifying):
    go, told = verifying

    def interrupted():
        with beside.own_machine("boom"):
            go.release()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert len(told) <= 1


def test_a_verification_that_fails_says_so_where_it_is_asked_for(monkeypatch, verifying):
    def verify(_study, progress):
        raise ValueError("too slow a valve")

    monkeypatch.setattr(beside, "verify", verify)
    with beside.own_machine("boom") as own, pytest.raises(ValueError, match="too slow a valve"):
        own.result(lambda _stage, _share: None)
