"""A sweep from its specification to its values: begun, or gone on with where it was left."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from qbound.extras import require
from qbound.sweeps import grid
from qbound.sweeps.cells import Job
from qbound.sweeps.cluster import Outcome, run_jobs
from qbound.sweeps.specification import Study, read_specification
from qbound.sweeps.store import Store, begin, measure_unit, number_unit


def with_unit(text: str, unit: str) -> str:
    """Write a unit behind a number; a plain number has none."""
    return text if unit == "1" else f"{text} {unit}"


Runner = Callable[[Iterable[Job]], Iterator[Outcome]]
Tell = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Swept:
    """What a sweep found.

    Attributes
    ----------
    study : Study
        What was asked.
    axes : tuple of ndarray
        Values of each varied number, in the robot file's unit.
    values : dict of str to ndarray
        Each measure over the grid; NaN where it was refused or is missing.
    reasons : dict of tuple of int to str
        Why, by the arm's index on each axis.
    missing : dict of tuple of int to str
        Chunks that could not be measured, and why; the sweep can be gone on with.
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

    The same folder again goes on where it was left: a chunk that is there is not computed again.
    The bytes in it do not depend on who computes, how many, or in what order.

    Parameters
    ----------
    specification : str or Path
        A file, as `qbound.sweeps.specification` has it.
    folder : str or Path
        New, empty, or of the same sweep.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``tcp://host:8786``; default: workers of this machine.
    workers : int
        Processes on this machine, where no scheduler is given.
    tell : callable
        Told how many chunks are there, and of how many.

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
    if any(name.startswith("reach.") for name in study.specification.measure):
        require("scipy", "a map of reach")
    return execute(study, folder, lambda jobs: run_jobs(jobs, scheduler, workers), tell)


def execute(
    study: Study, folder: str | Path, runner: Runner, tell: Tell = lambda done, total: None
) -> Swept:
    """Measure what is missing of a study by a runner of jobs, and read all that is there."""
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
