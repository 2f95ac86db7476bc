"""A whole sweep, from its specification to its values; an interrupted sweep is continued.

Jobs run on other processes and machines through Dask.

A worker that dies takes no result with it: the scheduler gives its jobs to others. Only this
process writes the results, so workers need no common disk. Dask sends jobs between its own
processes with pickle; anybody who can reach a scheduler can run code on its workers. So the local
scheduler listens on this machine only. The user is responsible for any other scheduler.
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.extras import require
from qbound.printable import printable
from qbound.sweeps import specification as grid
from qbound.sweeps.measures import Job, Measured, measure_job
from qbound.sweeps.specification import Study, read_specification
from qbound.sweeps.store import Store, begin, measure_unit, number_unit


def with_unit(text: str, unit: str) -> str:
    """Write a unit behind a number; a plain number has none."""
    return text if unit == "1" else f"{text} {unit}"


Outcome = tuple[Job, Measured | None, str]
"""A job, what was found, or None and why nothing was."""

Runner = Callable[[Iterable[Job]], Iterator[Outcome]]
Tell = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Swept:
    """The results of a sweep.

    Attributes
    ----------
    study : Study
        The question that the sweep answers.
    axes : tuple of ndarray
        Values of each varied number, in the robot file's unit.
    values : dict of str to ndarray
        Each measure over the grid; NaN where it failed or is missing.
    reasons : dict of tuple of int to str
        Reason of each NaN, by the arm's index on each axis.
    missing : dict of tuple of int to str
        Chunks that could not be measured, and why; the sweep can be continued.
    """

    study: Study
    axes: tuple[NDArray[np.float64], ...]
    values: dict[str, NDArray[np.float64]]
    reasons: dict[tuple[int, ...], str]
    missing: dict[tuple[int, ...], str]

    @property
    def whole(self) -> bool:
        """Whether every measure of every arm has a value."""
        return not self.reasons and not self.missing

    def measure_unit(self, measure: str) -> str:
        """Return the unit of a measure; ``1`` for a plain number."""
        return measure_unit(self.study, measure)

    def axis_unit(self, k: int) -> str:
        """Return the unit of a varied number, by its index in `vary`."""
        return number_unit(self.study, self.study.specification.vary[k].number)

    def arm_text(self, index: tuple[int, ...]) -> str:
        """Write the varied numbers of one arm with their units, by its index on each axis."""
        rows = zip(self.study.specification.vary, self.axes, index, strict=True)
        texts = [f"{row.number} = {axis[i]:.6g}" for row, axis, i in rows]
        return ", ".join(map(with_unit, texts, map(self.axis_unit, range(len(texts)))))

    def best(self, measure: str) -> tuple[int, ...] | None:
        """Return the index of the first arm with the largest value; None if no arm has any."""
        values = self.values[measure]
        if np.isnan(values).all():
            return None
        return tuple(int(i) for i in np.unravel_index(np.nanargmax(values), values.shape))


def sweep(
    specification: str | Path,
    folder: str | Path,
    *,
    scheduler: str | None = None,
    workers: int = 1,
    tell: Tell = lambda done, total: None,
) -> Swept:
    """Measure every arm of a specification; not in the paper.

    A second call with the same folder continues: chunks that exist are not computed again. The
    bytes in the folder do not depend on the workers, their number or their order.

    Parameters
    ----------
    specification : str or Path
        A file, described in `qbound.sweeps.specification`.
    folder : str or Path
        New, empty, or of the same sweep.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``tcp://host:8786``; default: workers of this machine.
    workers : int
        Processes on this machine, where no scheduler is given.
    tell : callable
        Called with the number of finished chunks and the number of all chunks.

    Raises
    ------
    qbound.sweeps.specification.SpecificationError
        If the specification is wrong.
    qbound.sweeps.store.OtherSweepError
        If the folder holds something else.
    ModuleNotFoundError
        If ``qbound[cluster]`` is not installed.
    OSError
        If the scheduler does not answer, or a file cannot be written.
    """
    study = read_specification(specification)
    if not workers >= 1:
        raise ValueError(f"{workers} workers; one or more are wanted")
    require("distributed")
    return execute(study, folder, lambda jobs: run_jobs(jobs, scheduler, workers), tell)


def execute(
    study: Study, folder: str | Path, runner: Runner, tell: Tell = lambda done, total: None
) -> Swept:
    """Measure the missing chunks of a study by a runner of jobs, and read all values."""
    store = begin(study, folder)
    todo = [chunk for chunk in grid.chunks(study.specification) if not store.has(chunk)]
    total = grid.count_chunks(study.specification)
    missing: dict[tuple[int, ...], str] = {}
    tell(total - len(todo), total)
    if todo:
        jobs = (grid.job(study, chunk) for chunk in todo)
        for done, (job, measured, why) in enumerate(runner(jobs), total - len(todo) + 1):
            if measured is None:
                missing[job.chunk] = why
            else:
                store.write(job.chunk, measured)
            tell(done, total)
    if not missing:
        store.finish()
    return _swept(store, missing)


def _swept(store: Store, missing: dict[tuple[int, ...], str]) -> Swept:
    specification = store.study.specification
    values = {str(name): store.values(name) for name in specification.measure}
    return Swept(store.study, grid.axes(specification), values, store.reasons(), missing)


# --- jobs on other processes ----------------------------------------------------------------------


AHEAD = 64
"""Jobs that are sent before the first has come back: the scheduler never holds a whole sweep."""

PATIENCE = 30
"""Seconds in which a scheduler has to answer."""


def on_dask(jobs: Iterable[Job], client: Any, compute: Callable[..., Any]) -> Iterator[Outcome]:
    """Yield the outcome of every job when it is finished, in any order.

    Raises
    ------
    OSError
        If the scheduler is gone.
    Exception
        Error of a worker; `measure_job` raises only errors that say nothing about an arm.
    """
    from distributed import KilledWorker, as_completed

    waiting = iter(jobs)
    sent = {_send(client, compute, job): job for job in islice(waiting, AHEAD)}
    coming = as_completed(list(sent), loop=client.loop)
    for future in coming:
        job = sent.pop(future)
        try:  # Dask computes a result again that was lost with its worker
            yield job, future.result(), ""
        except KilledWorker:
            yield job, None, "worker after worker died of it"
        except CancelledError:
            raise OSError("the scheduler is gone; the same command goes on") from None
        for new in islice(waiting, 1):
            sent[extra := _send(client, compute, new)] = new
            coming.add(extra)


def _send(client: Any, compute: Callable[..., Any], job: Job) -> Any:
    return client.submit(compute, job, pure=False)  # a name that no other sweep has


@contextmanager
def connected(address: str | None, workers: int) -> Iterator[Any]:
    """Connect with a scheduler, or start one with some workers on this machine alone.

    Raises
    ------
    ValueError
        If it is not an address.
    OSError
        If no scheduler answers there.
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
                    # Its server of numbers takes a free port: two sweeps may run at one time.
                    scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
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
