"""Runs one study after another in a process of its own, so that one that hangs can be ended."""

from __future__ import annotations

import contextlib
import multiprocessing as mp
import os
import resource
import time
import warnings
from typing import NamedTuple

_THERE_AND_BACK = (
    'manoeuvre=[{distance="35 mm", duration="0.6 s", rest="0.3 s"},'
    ' {distance="-35 mm", duration="0.6 s", rest="0.3 s"}]'
)
BRIEF = (
    "uncertainty.points=2",
    "verification.repeats=1",
    "verification.seeds=[1]",
    'verification.masses=["24500 kg"]',
    'verification.oil_bulk_moduli=["1200 MPa"]',
    _THERE_AND_BACK,
)
_TUNED = {"least", "largest", "two at once"}  # kinds that are tuned as well: a search takes longest
_PATIENCE = 1.5  # times the longest that a study may take of the processor: then it hangs
_STANDSTILL = 900.0  # s by the clock, on however busy a machine
_GLANCE = 1.0  # s
_FEW = 100_000  # ticks: the nonlinear machine runs as well


class Outcome(NamedTuple):
    """What became of a study."""

    extreme: tuple
    words: str  # "done", "refused", or what went wrong
    seconds: float  # of the processor, all threads: others may share the machine
    megabytes: float  # that the process grew by


def run(study, *, tuned=False):
    """Do what ``sweep`` does, check in time, and draw what a report draws; tune where asked."""
    from mptune.figures.certificates import certified_worst_cases
    from mptune.figures.moves import move_traces
    from mptune.figures.panels import four_panels
    from mptune.figures.sensitivity import load_response, sensitivity_functions
    from mptune.figures.style import to_svg
    from mptune.robust.chain import chain, other_reading
    from mptune.robust.sweep import sweep, with_radii
    from mptune.sim.sampled import linear_moves
    from mptune.tune.tuner import tune
    from mptune.verify.verify import verify

    swept = with_radii(sweep(study))
    chain(swept)
    other_reading(swept)
    moves = linear_moves(study)
    figures = (four_panels(swept), sensitivity_functions(swept), load_response(swept))
    figures += (certified_worst_cases(swept),)
    for figure in (*figures, move_traces(moves)):
        to_svg(figure)
    said = study.study
    ticks = sum(move.duration + move.rest for move in said.manoeuvre)
    if ticks / said.controller.fast_sampling_period < _FEW:
        verify(study)
    if tuned:
        tune(study)


def _work(pipe, path, extremes):
    from mptune.errors import InputError
    from mptune.params.load import load_study

    warnings.simplefilter("error", RuntimeWarning)
    run(load_study(path, BRIEF), tuned=True)  # compiles and imports what the others use
    pipe.send(None)
    for extreme in extremes:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        begun = time.process_time()
        try:
            study = load_study(path, (*BRIEF, *extreme.overrides))
            run(study, tuned=extreme.kind in _TUNED)
            words = "done"
        except InputError:
            words = "refused"
        except Exception as error:  # noqa: BLE001 - whatever it is, it is told
            words = f"{type(error).__name__}: {str(error)[:80]}"
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        pipe.send((words, time.process_time() - begun, grown / 1024))


def _spent(process):
    """Return the time [s] that a process has taken of the processor."""
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as stream:  # noqa: PTH123 - no path of ours
        ticks = stream.read().rpartition(")")[2].split()[11:13]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def _answers(pipe, process, longest):
    """Return whether a study comes to its end within what it may take."""
    end, most = time.monotonic() + _STANDSTILL, _spent(process) + _PATIENCE * longest
    while not pipe.poll(_GLANCE):
        if not process.is_alive() or _spent(process) > most or time.monotonic() > end:
            return pipe.poll(0)
    return True


def outcomes(path, extremes, longest=20.0):
    """Yield what becomes of each study; one that takes far longer [s] is ended with its process."""
    todo = list(extremes)
    while todo:
        ours, theirs = mp.Pipe()
        process = mp.get_context("spawn").Process(target=_work, args=(theirs, path, todo))
        process.start()
        theirs.close()
        ours.recv()
        with contextlib.suppress(EOFError):
            while todo and _answers(ours, process, longest):
                yield Outcome(todo[0], *ours.recv())
                todo.pop(0)
        if todo:
            words = "hangs" if process.is_alive() else "dies"
            yield Outcome(todo.pop(0), words, longest, 0.0)
            process.kill()
        process.join()
