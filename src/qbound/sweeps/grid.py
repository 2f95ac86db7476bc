"""The arms of a sweep: a grid, an axis for each row of `vary`, cut into chunks along the last."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import numpy as np
from msgspec import UNSET

from qbound.arrays import Floats
from qbound.model.robotfile import robot_table
from qbound.sweeps.cells import Job, versions
from qbound.sweeps.specification import Specification, Study

Chunk = tuple[int, ...]


def axes(specification: Specification) -> tuple[Floats, ...]:
    """Return the values of each varied number, in the robot file's unit."""
    return tuple(np.linspace(row.first, row.last, row.count) for row in specification.vary)


def shape(specification: Specification) -> tuple[int, ...]:
    """Return the number of values on each axis."""
    return tuple(row.count for row in specification.vary)


def chunk_shape(specification: Specification) -> tuple[int, ...]:
    """Return how many arms a chunk has on each axis; it does not hang on who computes."""
    *before, last = shape(specification)
    return (*(1 for _ in before), min(last, specification.chunk))


def chunks(specification: Specification) -> Iterator[Chunk]:
    """Yield the index of every chunk, the last axis first to change."""
    return product(*map(range, _chunk_counts(specification)))


def count_chunks(specification: Specification) -> int:
    """Return how many chunks there are."""
    return math.prod(_chunk_counts(specification))


def _chunk_counts(specification: Specification) -> list[int]:
    sizes = zip(shape(specification), chunk_shape(specification), strict=True)
    return [-(-count // size) for count, size in sizes]


def window(specification: Specification, chunk: Chunk) -> tuple[slice, ...]:
    """Return the part of the grid that a chunk is; the last on an axis may be smaller."""
    places = zip(chunk, chunk_shape(specification), shape(specification), strict=True)
    return tuple(slice(k * size, min((k + 1) * size, count)) for k, size, count in places)


def job(study: Study, chunk: Chunk) -> Job:
    """Return what is to be measured of a chunk, as plain data."""
    specification = study.specification
    parts = zip(axes(specification), window(specification, chunk), strict=True)
    values = product(*(axis[part].tolist() for axis, part in parts))
    return Job(
        chunk=chunk,
        table=robot_table(study.robot),
        held=specification.slice,
        rule=specification.rule,
        tolerance=specification.tolerance,
        fibre=None if specification.fibre is UNSET else specification.fibre,
        voxel=None if specification.voxel is UNSET else specification.voxel,
        measures=tuple(specification.measure),
        arms=tuple(_numbers(study, arm) for arm in values),
        versions=versions(),
    )


def _numbers(study: Study, values: tuple[float, ...]) -> dict[str, float]:
    """Return the number of each name in the arm with these values on the axes."""
    rows = zip(study.specification.vary, values, strict=True)
    return {name: value for row, value in rows for name in row.numbers}
