"""Jobs on other processes and machines, through Dask: as they come, none lost with a worker.

A worker that dies takes no result with it: the scheduler gives its jobs to others. What comes back
is written by this process alone, so workers need no common disk. Dask sends jobs between its own
processes with pickle; whoever can reach a scheduler can run code on its workers. So the local one
listens on this machine alone, and any other one is the user's own.
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import Any

from qbound.extras import require
from qbound.printable import printable
from qbound.sweeps.cells import Job, Measured, measure_job

AHEAD = 64
"""Jobs that are sent before the first has come back: the scheduler never holds a whole sweep."""

PATIENCE = 30
"""Seconds in which a scheduler has to answer."""

Outcome = tuple[Job, Measured | None, str]
"""A job, what was found, or None and why nothing was."""


def on_dask(jobs: Iterable[Job], client: Any, compute: Callable[..., Any]) -> Iterator[Outcome]:
    """Yield the outcome of every job as it comes, in no order.

    Raises
    ------
    OSError
        If the scheduler is gone.
    Exception
        What a worker raised; `measure_job` raises what says nothing about an arm.
    """
    from distributed import KilledWorker, as_completed

    waiting = iter(jobs)
    sent = {_send(client, compute, job): job for job in islice(waiting, AHEAD)}
    coming = as_completed(list(sent), loop=client.loop)
    for future in coming:
        job = sent.pop(future)
        try:  # a result that was lost with its worker since it came is computed again meanwhile
            yield job, future.result(), ""
        except KilledWorker:
            yield job, None, "worker after worker died of it"
        except CancelledError:
            raise OSError("the scheduler is gone; the same command goes on") from None
        for new in islice(waiting, 1):
            sent[extra := _send(client, compute, new)] = new
            coming.add(extra)


def _send(client: Any, compute: Callable[..., Any], job: Job) -> Any:
    return client.submit(compute, job, pure=False)  # no name that another sweep could have


@contextmanager
def connected(address: str | None, workers: int) -> Iterator[Any]:
    """Connect with a scheduler, or start one with some workers on this machine alone.

    Raises
    ------
    ValueError
        If the address is none.
    OSError
        If nobody answers there.
    """
    require("distributed")
    from distributed import Client, LocalCluster

    with ExitStack() as stack:
        if address is None:
            scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="qbound-"))
            cluster: Any = stack.enter_context(
                LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address=None,
                    local_directory=scratch,
                    silence_logs=logging.CRITICAL,
                )
            )
        try:
            where = cluster if address is None else address
            client = Client(where, timeout=PATIENCE, set_as_default=False)
        except OSError:
            raise OSError(printable(f"scheduler {address}: no scheduler answers")) from None
        except ValueError as error:
            raise ValueError(printable(f"scheduler {address}: {error}")) from None
        yield stack.enter_context(client)


def run_jobs(jobs: Iterable[Job], address: str | None, workers: int) -> Iterator[Outcome]:
    """Measure jobs on a cluster; as `on_dask` and `connected`."""
    with connected(address, workers) as client:
        yield from on_dask(jobs, client, measure_job)
