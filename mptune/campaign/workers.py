"""Where work runs: all cores of this machine, or a cluster behind a scheduler's address."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from mptune.errors import Fault, InputError, MptuneError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

_AHEAD = 3  # tasks handed out per worker before the oldest result is taken
_CONNECT = 10.0  # s


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
    from joblib import cpu_count

    if not scheduler:
        yield Workers(count or cpu_count(), {"backend": "loky"})
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


def _connect(scheduler: str) -> Any:
    try:
        from distributed import Client
    except ImportError as error:
        fault = Fault("", scheduler, "needs the extra `cluster`", "pip install 'mptune[cluster]'")
        raise InputError("--scheduler", fault) from error
    try:
        return Client(scheduler, timeout=_CONNECT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        fault = Fault(
            "", scheduler, f"does not answer: {error}", "give the address that the scheduler prints"
        )
        raise InputError("--scheduler", fault) from error
