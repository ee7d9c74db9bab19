"""Where work runs: all cores of this machine, or a cluster behind a scheduler's address."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError, MptuneError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

_AHEAD = 2  # tasks per worker under way; more would wait outside joblib's own queue
_CONNECT = 10.0  # s
_GLANCE = 0.5  # s, between a worker's looks at whether the main process is still there
_ADDRESS = re.compile(r"(?:(?:tcp|tls)://)?(?:\[[0-9a-fA-F:.]+\]|[\w.-]+):\d{1,5}", re.ASCII)


class Workers:
    """Workers that take tasks in order and give back their results in order."""

    def __init__(self, count: int, backend: dict[str, Any]) -> None:
        self.count = count
        self._backend = backend

    def results(
        self, function: Callable[..., Any], tasks: Iterable[tuple[Any, ...]]
    ) -> Generator[Any, None, None]:
        """Yield ``function(*task)`` of each task, in order, as they come.

        Only a few tasks are under way at a time, so that memory does not grow with their number.
        """
        from joblib import Parallel, delayed, parallel_config

        with parallel_config(**self._backend):
            parallel = Parallel(
                n_jobs=self.count,
                return_as="generator",
                pre_dispatch=_AHEAD * self.count,
                batch_size=1,
            )
        yield from parallel(delayed(function)(*task) for task in tasks)


@contextmanager
def workers(count: int | None = None, scheduler: str = "") -> Iterator[Workers]:
    """Open workers and close them at the end.

    Parameters
    ----------
    count
        How many processes on this machine; one per core where None.
    scheduler
        The address of a Dask scheduler; its own workers are then used, each with one task per
        thread that it offers.

    Raises
    ------
    InputError
        If the address is none, nobody answers there, or ``distributed`` is not installed.
    """
    with warnings.catch_warnings():
        # Told of by joblib where results are left lying: after an interrupt, that is meant.
        warnings.filterwarnings("ignore", category=UserWarning, module=r"joblib\.parallel")
        yield from _open(count, scheduler)


def _open(count: int | None, scheduler: str) -> Iterator[Workers]:
    from joblib import cpu_count

    if not scheduler:
        begun = {"backend": "loky", "initializer": _serve, "initargs": (os.getpid(),)}
        yield Workers(count or cpu_count(), begun)
        return
    client = _connect(scheduler)
    try:
        threads = sum(client.nthreads().values())
        if not threads:
            raise MptuneError(
                f"{scheduler} has no worker; start one with `dask worker {scheduler}`"
            )
        yield Workers(threads, {"backend": "dask", "client": client})
    finally:
        client.close()


def _serve(master: int) -> None:
    """Make a worker of a new process, which ends with the main one.

    Ctrl-C, which a terminal sends to workers as well, is the main process's to answer. Where that
    is killed, nobody tells its workers, which would wait for tasks for ever.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if os.name == "posix":  # elsewhere a process keeps the number of a parent that has ended
        threading.Thread(target=_end_with, args=(master,), daemon=True).start()


def _end_with(master: int) -> None:
    while os.getppid() == master:
        time.sleep(_GLANCE)
    os._exit(1)  # at once: there is nobody to hand anything to


def _connect(scheduler: str) -> Any:
    try:
        from distributed import Client
    except ImportError as error:
        fault = Fault("", scheduler, "needs the extra `cluster`", "pip install 'mptune[cluster]'")
        raise InputError("--scheduler", fault) from error
    if _ADDRESS.fullmatch(scheduler) is None:
        rule, remedy = "is no address of a scheduler", "write it like tcp://host:8786"
        raise InputError("--scheduler", Fault("", repr(scheduler), rule, remedy))
    try:
        return Client(scheduler, timeout=_CONNECT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        fault = Fault(
            "", scheduler, f"does not answer: {error}", "give the address that the scheduler prints"
        )
        raise InputError("--scheduler", fault) from error
