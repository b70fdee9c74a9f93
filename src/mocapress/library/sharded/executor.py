"""Where the tasks of a job run: here, in processes of this machine, or on a Dask cluster."""

import errno
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import active_children, get_context
from typing import Any, Protocol, TypeVar

from mocapress.errors import ParameterError, UnsupportedError

T = TypeVar("T")
R = TypeVar("R")
LOCAL = "local:"
_WAIT = 10
"""Seconds in which a cluster must answer."""


class Executor(Protocol):
    """Runs tasks; several threads may wait for one each."""

    width: int
    """Tasks that are worth being asked for at a time."""

    def call(self, work: Callable[[T], R], task: T) -> R:
        """Run a task somewhere, and wait for its result, or raise its error."""

    def stop(self) -> None:
        """End what runs on this machine, as this process ends at once."""


class _Here:
    width = 1

    def stop(self) -> None:
        pass

    def call(self, work: Callable[[T], R], task: T) -> R:
        return work(task)


class _Processes:
    def __init__(self, pool: ProcessPoolExecutor, width: int) -> None:
        self._pool, self.width = pool, width

    def call(self, work: Callable[[T], R], task: T) -> R:
        try:
            return self._pool.submit(work, task).result()
        except BrokenProcessPool as error:
            raise OSError(errno.ECHILD, "the process that worked on it died") from error

    def stop(self) -> None:
        for process in active_children():
            process.terminate()


class _Dask:
    def __init__(self, client: Any) -> None:
        self._client = client
        threads = sum(client.nthreads().values())
        self.width = max(2 * threads, 2)

    def call(self, work: Callable[[T], R], task: T) -> R:
        # A task that is asked for again is done again: it may have to write what was lost.
        future = self._client.submit(work, task, pure=False)
        try:
            found: R = future.result()
        except Exception as error:
            if not type(error).__module__.startswith("distributed"):
                raise
            what = f"the cluster gave it up ({type(error).__name__}: workers died, or it ended)"
            raise OSError(errno.ECHILD, what) from error
        return found

    def stop(self) -> None:
        pass  # workers that were started here end with their parent


@contextmanager
def executor(cluster: str | None = None, jobs: int = 1) -> Iterator[Executor]:
    """Give what runs tasks.

    Parameters
    ----------
    cluster
        Address of a Dask scheduler, e.g. ``tcp://scheduler:8786``, or ``local:N`` for N workers
        that are started here; without it, processes of this machine.
    jobs
        Processes; 0: as many as there are cores.

    Raises
    ------
    UnsupportedError
        When Dask is not installed.
    ParameterError
        When it is no address.
    OSError
        When there is no cluster.

    """
    if cluster is not None:
        with _client(cluster) as client:
            yield _Dask(client)
        return
    jobs = jobs or os.cpu_count() or 1
    if jobs == 1:
        yield _Here()
        return
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        yield _Processes(pool, jobs)


@contextmanager
def _client(cluster: str) -> Iterator[Any]:
    try:
        dask: Any = import_module("distributed")
    except ImportError:
        raise UnsupportedError(
            "a cluster needs Dask", expected="pip install 'mocapress[cluster]'"
        ) from None
    if not cluster.startswith(LOCAL):
        if "://" not in cluster:
            raise ParameterError(
                "no cluster",
                expected="local:N or an address such as tcp://host:8786",
                found=cluster,
            )
        try:
            client = dask.Client(cluster, timeout=_WAIT, set_as_default=False)
        except (OSError, ValueError) as error:
            raise OSError(
                errno.ECONNREFUSED, f"no Dask scheduler answers ({error})", cluster
            ) from error
        with client:
            yield client
        return
    number = cluster.removeprefix(LOCAL)
    if not number.isdecimal() or not int(number):
        raise ParameterError("no cluster", expected="local:N, e.g. local:2", found=cluster)
    with (
        dask.LocalCluster(
            n_workers=int(number), threads_per_worker=1, dashboard_address=":0", silence_logs=50
        ) as workers,
        dask.Client(workers, set_as_default=False) as client,
    ):
        yield client
