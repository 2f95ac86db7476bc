"""How are the triangles of a mesh covered by few balls? Proved, triangle by triangle.

A ball about a place of the solid, at least a depth d below its surface, sticks out of the solid by
its radius less d at most. So every place has a largest ball for an excess. Balls are chosen
greedily from the largest (`inner_balls`) to hold samples of the triangles; what halving then finds
uncovered is asked for too, until nothing is.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from qbound.extras import require
from qbound.geometry.covering import Cover, few, fewer, uncovered, within
from qbound.geometry.inner_balls import convex_balls, solid_balls
from qbound.geometry.mesh_solids import (
    Convex,
    OrientedBox,
    as_box,
    convex_solid,
    hull_of,
    unit_normals,
)
from qbound.geometry.simplices import edges, halved
from qbound.geometry.solid_covers import box_cover
from qbound.tolerances import OUTWARD

Floats = NDArray[np.float64]

MOST_SAMPLES = 300_000
"""Samples of the triangles, about, from which depths are known."""

MOST_DEMANDS = 10_000
"""Samples, about, that balls are chosen to hold at first."""

MOST_PLACES = 6_000
"""Balls, about, that are tried."""

NEARLY_CONVEX = 1e-3
"""Part of the excess by which a mesh may differ from a convex solid, or a box, and count as one."""

ROUNDS = 4
"""So often a smaller choice is searched for, with what was found uncovered by the one before."""

MOST_ADDED = 40
"""Times that balls are added to those chosen, for what is still uncovered."""

MOST_STEPS, MOST_CHANGES = 400, 30_000
"""Exchanges of a search at most, and exchanges times balls."""

MOST_BALLS = 500
"""Balls of a mesh that is no box at most: with more an arm has too many pairs, and choosing takes
minutes."""

SURE = 1 / 12
"""Part of the excess by which a chosen ball is larger than what it has to hold a sample: between
samples few gaps are left then."""


def mesh_cover(triangles: Floats, closed: bool, excess: float) -> Cover:
    """Cover the triangles of a mesh: all of them, but not what they enclose.

    A body meets them before it lies in what they enclose: a motion that starts clear of the solid
    and stays clear of its surface is clear of the solid. A mesh that is a box is covered as one,
    all of it.

    Parameters
    ----------
    triangles : ndarray, shape (N, 3, 3)
    closed : bool
        Whether they are the whole surface of a solid. If not, the excess is that beyond their
        convex hull.
    excess : float
        Above 0.

    Raises
    ------
    ValueError
        If the mesh is too large for the excess.
    ModuleNotFoundError
        If there is no SciPy; it comes with ``qbound[arms]``.
    """
    require("scipy", "covering a mesh")
    corners = triangles.reshape(-1, 3)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    moved = triangles - middle
    size = float(np.abs(triangles).max()) + float(np.abs(moved).max())
    allowed = excess - 8 * OUTWARD * size
    if allowed <= 0:
        raise ValueError(f"an excess of {excess:g} is rounding beside a mesh of size {size:g}")
    nearly = NEARLY_CONVEX * excess
    distinct = np.unique(moved.reshape(-1, 3), axis=0)
    convex = convex_solid(moved, nearly) if closed else hull_of(distinct)
    box = as_box(convex, distinct, nearly) if closed and convex is not None else None
    if box is not None:
        cover = _box_cover(box, allowed)
    else:
        samples = _samples(moved, allowed, allowed / (12 if closed and convex is None else 6))
        centres, depths = _places(moved, closed, convex, samples, allowed)
        cover = Cover(*_chosen(moved, centres, depths + allowed, samples[0], allowed), excess)
    return Cover(cover.centres + middle, cover.radii + 4 * OUTWARD * size, cover.excess)


def _box_cover(box: OrientedBox, excess: float) -> Cover:
    """Cover a box where it stands."""
    cover = box_cover(box.size, excess - box.error)
    return Cover(box.middle + cover.centres @ box.axes.T, cover.radii, cover.excess + box.error)


def _samples(triangles: Floats, excess: float, longest: float) -> tuple[Floats, Floats, float]:
    """Return places of the triangles, outward normals there, and a spread.

    Within the spread of one of the places are all others: two thirds of a median, which is no
    longer than an edge.
    """
    normals, areas = unit_normals(triangles)
    longest = max(longest, math.sqrt(2 * float(areas.sum()) / MOST_SAMPLES))
    if longest > excess / 2 or np.abs(edges(triangles)).max() > MOST_SAMPLES * longest:
        raise ValueError(f"the mesh is too large for an excess of {excess:g}; allow more")
    sign = np.sign(np.einsum("ni,ni->", triangles[:, 0], normals * areas[:, None]))
    cells, owners = triangles, sign * normals
    done, turned = [], []
    while len(cells):
        lengths = np.linalg.norm(edges(cells), axis=-1)
        short = lengths.max(axis=1) <= longest
        done.append(cells[short].mean(axis=1))
        turned.append(owners[short])
        cells = halved(cells[~short], lengths[~short].argmax(axis=1))
        owners = np.repeat(owners[~short], 2, axis=0)
    return np.concatenate(done), np.concatenate(turned), longest * 2 / 3


def _thinned(places: Floats, most: int, size: float) -> NDArray[np.int64]:
    """Choose one place of each cell of a grid, of size or, where that leaves too many, coarser."""
    while True:
        cells = np.floor(places / size).astype(np.int64)
        cells -= cells.min(axis=0)
        number = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(axis=0) + 1))
        _, first = np.unique(number, return_index=True)
        if len(first) <= most:
            return np.sort(first)
        size *= max(1.05, math.sqrt(len(first) / most))


def _places(
    triangles: Floats,
    closed: bool,
    convex: Convex | None,
    samples: tuple[Floats, Floats, float],
    excess: float,
) -> tuple[Floats, Floats]:
    """Return centres, inside and on the surface, and how deep each lies at least."""
    surface, normals, spread = samples
    on_it = _thinned(surface, MOST_PLACES // 4, excess / 2)
    most = MOST_PLACES if convex is not None else MOST_PLACES // 2  # which take longer
    starts = _thinned(surface, most, excess / 6)
    centres, depths = np.zeros((0, 3)), np.zeros(0)
    touched, outward = surface[starts], normals[starts]
    if convex is not None:
        if not closed:  # triangles that have no outside
            touched, outward = np.vstack([touched, touched]), np.vstack([outward, -outward])
        centres, depths = convex_balls(convex, touched, outward)
    elif closed:
        centres, depths = solid_balls(triangles, surface, spread, touched, outward)
    return np.vstack([centres, surface[on_it]]), np.append(depths, np.zeros(len(on_it)))


def _chosen(
    triangles: Floats, centres: Floats, radii: Floats, surface: Floats, excess: float
) -> tuple[Floats, Floats]:
    """Choose balls until all triangles are proved to be covered.

    What is found uncovered is asked for too, in the next round. After the last round balls are
    added for it to those that were chosen.
    """
    demands = surface[_thinned(surface, MOST_DEMANDS, excess / 4)]
    held = within(demands, centres, radii - SURE * excess)
    lost = demands[~held.any(axis=1)]  # of a large mesh, to which few places are tried
    if len(lost):  # those get balls of their own
        lost = lost[_thinned(lost, MOST_PLACES, excess / 2)]
        centres, radii = np.vstack([centres, lost]), np.append(radii, np.full(len(lost), excess))
        held = np.hstack([held, within(demands, lost, np.full(len(lost), (1 - SURE) * excess))])
    chosen = few(held.T)
    for k in range(ROUNDS + MOST_ADDED):
        if len(chosen) > MOST_BALLS:
            raise ValueError(
                f"an excess of {excess:g} takes more than {MOST_BALLS} balls; allow more"
            )
        if k < ROUNDS:
            steps = min(MOST_STEPS, MOST_CHANGES // len(chosen))
            chosen = fewer(np.ascontiguousarray(held.T), chosen, steps)
        left = uncovered(triangles, centres[chosen], radii[chosen])
        if not len(left):
            return centres[chosen], radii[chosen]
        missed = left.reshape(-1, 3)
        missed = missed[_thinned(missed, MOST_DEMANDS, excess / 20)]
        held = np.vstack([held, within(missed, centres, radii - SURE * excess)])
        open_ones = ~held[:, chosen].any(axis=1)
        chosen = np.append(chosen, few(held[open_ones].T))
    raise ValueError(f"the mesh is not covered to an excess of {excess:g}; allow more")
