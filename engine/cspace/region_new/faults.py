"""The check of a region: margins at places at which the region says what is free.

The margins are those of the boundaries themselves. They know nothing of curves, cells and arcs.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from cspace.arrays import Floats
from cspace.region_new.arcs import ordered
from cspace.tolerances import ON_ARC

if TYPE_CHECKING:
    from cspace.region_new.region import Region

ALONG = np.array([-1.2, -0.4, 0.3, 1.0])
"""Where each arc is looked at: angles, from -pi/2 (start) to pi/2 (end)."""

WITHIN = np.array([[0.43, 0.43], [0.11, 0.83], [0.79, 0.19], [0.013, 0.5], [0.987, 0.5]])
"""Where each cell is looked at: parts of its width, and of its height there."""

BEYOND = 1e-6
"""How far beyond the ends of a cell it is asked what is free, in units of a joint."""

WIDE = 1e-5
"""Cells smaller than this, in units of a joint, are looked at in the middle only."""

SPREAD = np.modf(np.outer(np.arange(1, 65), [0.7548776662466927, 0.5698402909980532]))[0]
"""Places in the unit square that are spread evenly (Roberts's sequence), shape (64, 2)."""

CLEAR = 64.0
"""A margin beyond so many times its rounding has a sign."""

SAME_AREA = 1e-9
"""Part of the ranges' area by which areas by cells and by loops may differ."""


def faults(region: Region) -> list[str]:
    """Return sentences about what is wrong with a region; empty if nothing is.

    Arcs and vertices lie on their boundaries and nothing is violated there. Cells are free inside.
    Free places, all over the ranges and just beyond the ends of cells, lie in a cell. The area
    within the loops of a component is the area of its cells.
    """
    if region.problem.blocked:  # a boundary that touches everywhere leaves no component
        return []
    return [*_off(region), *_cells(region), *_areas(region)]


def _off(region: Region) -> Iterator[str]:
    """Yield the arcs that do not lie on their boundaries, or run where something is violated."""
    arcs = [arc for part in region.outlined for arc in chain(*part.loops)]
    if not arcs:
        return
    evaluator, problem = region.problem.evaluator, region.problem
    column = {name: k for k, name in enumerate(evaluator.names)}
    places = [arc.pieces[len(arc.pieces) // 2 :][:1].places(ALONG)[0] for arc in arcs]
    starts = [ordered(arc.pieces.start, arc.pieces.curves.base) for arc in arcs]
    of = np.concatenate([np.full(len(ALONG) + len(s), k) for k, s in enumerate(starts)])
    q = np.concatenate([np.concatenate(both) for both in zip(places, starts, strict=True)])
    limited = np.array([arc.row < 0 for arc in arcs])[of]
    rows = np.array([0 if arc.row < 0 else column[arc.boundary] for arc in arcs])[of]
    within = ON_ARC * evaluator.sizes
    held, more = (evaluator.at_least(q, least) for least in (-within, np.nextafter(within, np.inf)))
    off = np.take_along_axis(~held | more, rows[:, None], axis=1)[:, 0]
    ends = [(j, end) for j, limits in enumerate(problem.ranges) for end in limits or ()]
    scale = ordered(np.array(region.cells.curves.scale), region.base)
    if limited.any():
        gaps = [np.abs(q[limited, j] - end) / scale[j] for j, end in ends]
        off[limited] = np.min(gaps, axis=0) > ON_ARC
    for k in np.flatnonzero(off).tolist():
        yield f"an arc of {arcs[of[k]].boundary} is off it at {_shown(q[k])}"
    for k, lost in np.argwhere(~held).tolist():
        name = evaluator.names[lost]
        yield f"an arc of {arcs[of[k]].boundary} runs where {name} is violated, at {_shown(q[k])}"


def _cells(region: Region) -> Iterator[str]:
    """Yield places in cells that are not free, and free places in no cell."""
    cells, evaluator, base = region.cells, region.problem.evaluator, region.base
    doubt = CLEAR * evaluator.margin_rounding
    low, high = cells.range.T
    beside = low + (high - low) * SPREAD
    unit, lift_unit = cells.curves.scale
    inner = np.zeros((0, 2))
    if len(cells.span):
        every = np.arange(len(cells.span))
        start, end = cells.spans(every).T
        t = start[:, None] + (end - start)[:, None] * WITHIN[:, 0]
        bottom, top = cells.interval(every, t)
        v = bottom + (top - bottom) * WITHIN[:, 1]
        roomy = ((end - start) > WIDE * unit)[:, None] & (top - bottom > WIDE * lift_unit)
        inner = np.stack([t[roomy], v[roomy]], axis=1)
        over = [np.stack([t[:, 0], x[:, 0]], axis=1) for x in (bottom, top)]
        steps = (-BEYOND * lift_unit, BEYOND * lift_unit)
        over = [
            (place + [0.0, step])[cells.row[:, e] >= 0]
            for e, (place, step) in enumerate(zip(over, steps, strict=True))
        ]
        beside = np.concatenate([beside, *over])
        outside = ((beside < low) | (beside > high)) & ~np.array(cells.round)
        beside = beside[~outside.any(axis=1)]
    q = ordered(inner, base)
    for place in q[~evaluator.at_least(q, -doubt).all(axis=1)]:
        yield f"a cell about {_shown(place)} is not free"
    q = ordered(beside, base)
    q = q[evaluator.at_least(q, doubt).all(axis=1)]
    for place in q[cells.numbered(region.problem, q) < 0]:
        yield f"{_shown(place)} is free and in no cell"


def _areas(region: Region) -> Iterator[str]:
    """Yield the components within whose loops there is another area than in their cells.

    The loops integrate q_1 dq_2; components that go round a joint are left out.
    """
    size = float(np.prod(region.cells.curves.scale))
    for k, part in enumerate(region.outlined):
        if any(part.wraps) or not part.loops:
            continue
        middle = part.loops[0][0].start
        found = sum(
            float((q - middle)[:, 0] @ dq[:, 1])
            for arc in chain(*part.loops)
            for q, dq in [arc.nodes(24)]
        )
        if abs(found - part.area) > SAME_AREA * (size + region.area) + 1e-5 * part.area:
            yield f"component {k}: its loops have the area {found:.9g}, its cells {part.area:.9g}"


def _shown(q: Floats) -> str:
    return f"({q[0]:.9g}, {q[1]:.9g})"
