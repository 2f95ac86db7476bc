"""Covers of a mesh by few balls, proved triangle by triangle.

Let the centre of a ball lie inside the solid, at least a depth d below the surface. Then the ball
sticks out of the solid by at most its radius less d. So each centre has a largest ball for a given
excess. Balls are chosen greedily from the largest (`inner_balls`) until they hold samples of the
triangles. Halving then looks for uncovered places; these join the samples until none is left.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.extras import require
from qbound.geometry.covering import Cover, Work, few, fewer, uncovered, within
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
from qbound.geometry.surface_distance import SurfaceDistance, one_a_cell
from qbound.tolerances import OUTWARD

MOST_SAMPLES = 700_000
"""Samples of the triangles, about, from which depths are known."""

PARTS = 3
"""So many parts has a triangle, about, for each square of the longest edge that it holds: halving
leaves edges of half that length."""

MOST_DEMANDS = 10_000
"""Samples, about, that balls are chosen to hold at first."""

MOST_PLACES = 6_000
"""Balls, about, that are tried."""

MOST_TURNS = 20_000_000
"""Planes of a convex solid, times places of its surface from which balls are sought."""

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

MOST_WORK = 300_000_000
"""Distances, some 4 ns each, after which a mesh is refused."""

SURE = 1 / 12
"""Part of the excess by which a chosen ball is larger than what it has to hold a sample: between
samples few gaps are left then."""

SMALLEST, LARGEST = 1e-30, 1e30
"""Lengths between which no square of an area underflows or overflows."""


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
        If the mesh is too large for the excess, or takes too many balls or too much work; or if
        there is no triangle, or a number that is not finite.
    ModuleNotFoundError
        If there is no SciPy; it comes with ``qbound[arms]``.
    """
    require("scipy", "covering a mesh")
    _refuse_numbers(triangles, excess)
    corners = triangles.reshape(-1, 3)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    moved = triangles - middle
    size = float(np.abs(triangles).max()) + float(np.abs(moved).max())
    allowed = excess - 8 * OUTWARD * size
    if allowed <= 0:
        raise ValueError(f"an excess of {excess:g} is rounding beside a mesh of size {size:g}")
    cover = _small_cover(moved, allowed) or _large_cover(moved, closed, excess, allowed)
    return Cover(cover.centres + middle, cover.radii + 4 * OUTWARD * size, cover.excess)


def _refuse_numbers(triangles: Floats, excess: float) -> None:
    if not len(triangles):
        raise ValueError("a mesh without triangles")
    if not SMALLEST <= excess <= LARGEST:
        raise ValueError(f"an excess of {excess:g}: {SMALLEST:g} to {LARGEST:g} is wanted")
    if not np.abs(triangles).max() <= LARGEST:
        raise ValueError(f"a corner of the mesh is no number, or farther away than {LARGEST:g}")


def _small_cover(triangles: Floats, allowed: float) -> Cover | None:
    """Cover a mesh by one ball about a corner of it, if the excess is as large as that."""
    corners = triangles.reshape(-1, 3)
    centre = corners[np.abs(corners).max(axis=1).argmin()]
    radius = 2 * float(np.abs(corners - centre).max())  # no squares, which a tiny mesh would lose
    return Cover(centre[None], np.array([radius]), radius) if radius <= allowed else None


def _large_cover(triangles: Floats, closed: bool, excess: float, allowed: float) -> Cover:
    """Cover a mesh about the origin, as a box if it is one."""
    nearly = NEARLY_CONVEX * excess
    distinct = np.unique(triangles.reshape(-1, 3), axis=0)
    convex = convex_solid(triangles, nearly) if closed else hull_of(distinct)
    box = as_box(convex, distinct, nearly) if closed and convex is not None else None
    if box is not None:
        return _box_cover(box, allowed)
    samples = _samples(triangles, allowed, allowed / (10 if closed and convex is None else 5))
    centres, depths = _places(triangles, closed, convex, samples, allowed)
    return Cover(*_chosen(triangles, centres, depths + allowed, samples[0], allowed), excess)


def _box_cover(box: OrientedBox, excess: float) -> Cover:
    """Cover a box where it stands."""
    cover = box_cover(box.size, excess - box.error)
    return Cover(box.middle + cover.centres @ box.axes.T, cover.radii, cover.excess + box.error)


def _samples(triangles: Floats, excess: float, longest: float) -> tuple[Floats, Floats, float]:
    """Return places of the triangles, outward normals there, and a spread.

    Within the spread of one of the places are all others.
    """
    normals, areas = unit_normals(triangles)
    longest = _edge_of_samples(triangles, areas, longest)
    if longest > excess / 2:
        raise ValueError(f"the mesh is too large for an excess of {excess:g}; allow more")
    sign = np.sign(np.einsum("ni,ni->", triangles[:, 0], normals * areas[:, None]))
    cells, owners = triangles, sign * normals
    done, turned, spread = [], [], 0.0
    while len(cells):
        lengths = np.linalg.norm(edges(cells), axis=-1)
        short = lengths.max(axis=1) <= longest
        middles = cells[short].mean(axis=1)
        away = np.linalg.norm(cells[short] - middles[:, None], axis=-1)
        spread = max(spread, float(away.max(initial=0.0)))
        done.append(middles)
        turned.append(owners[short])
        cells = halved(cells[~short], lengths[~short].argmax(axis=1))
        owners = np.repeat(owners[~short], 2, axis=0)
    return np.concatenate(done), np.concatenate(turned), spread * (1 + OUTWARD)


def _edge_of_samples(triangles: Floats, areas: Floats, longest: float) -> float:
    """Return the least edge, no shorter than one, of parts of triangles that are not too many."""
    base = np.linalg.norm(edges(triangles), axis=-1).max(axis=1)
    height = 2 * areas / np.where(base > 0, base, 1.0)
    longest = max(longest, math.sqrt(PARTS * 2 * float(areas.sum()) / MOST_SAMPLES))
    while PARTS * ((1 + base / longest) * (1 + height / longest) - 1).sum() > MOST_SAMPLES:
        longest *= 1.1
    return longest


def _places(
    triangles: Floats,
    closed: bool,
    convex: Convex | None,
    samples: tuple[Floats, Floats, float],
    excess: float,
) -> tuple[Floats, Floats]:
    """Return centres, inside and on the surface, and how deep each lies at least."""
    surface, normals, spread = samples
    on_it, _ = one_a_cell(surface, MOST_PLACES // 4, excess / 2)
    most = MOST_PLACES // 2  # which take longer
    if convex is not None:
        most = min(MOST_PLACES, max(1, MOST_TURNS // len(convex.planes)))
    starts, _ = one_a_cell(surface, most, excess / 6)
    centres, depths = np.zeros((0, 3)), np.zeros(0)
    touched, outward = surface[starts], normals[starts]
    if convex is not None:
        if not closed:  # triangles that have no outside
            touched, outward = np.vstack([touched, touched]), np.vstack([outward, -outward])
        centres, depths = convex_balls(convex, touched, outward)
    elif closed:
        known = SurfaceDistance(surface, spread)
        centres, depths = solid_balls(triangles, known, touched, outward, excess / 24)
    return np.vstack([centres, surface[on_it]]), np.append(depths, np.zeros(len(on_it)))


def _chosen(
    triangles: Floats, centres: Floats, radii: Floats, surface: Floats, excess: float
) -> tuple[Floats, Floats]:
    """Choose balls until all triangles are proved to be covered.

    What is found uncovered is asked for too, in the next round. After the last round balls are
    added for it to those that were chosen.
    """
    work = Work(MOST_WORK, f"the mesh takes too long for an excess of {excess:g}; allow more")
    demands = surface[one_a_cell(surface, MOST_DEMANDS, excess / 4)[0]]
    work.spend(len(demands) * len(centres))
    held = within(demands, centres, radii - SURE * excess)
    lost = demands[~held.any(axis=1)]  # of a large mesh, to which few places are tried
    if len(lost):  # those get balls of their own
        lost = lost[one_a_cell(lost, MOST_PLACES, excess / 2)[0]]
        centres, radii = np.vstack([centres, lost]), np.append(radii, np.full(len(lost), excess))
        held = np.hstack([held, within(demands, lost, np.full(len(lost), (1 - SURE) * excess))])
    chosen = few(held.T, most=2 * MOST_BALLS)
    for k in range(ROUNDS + MOST_ADDED):
        if len(chosen) > MOST_BALLS:
            raise ValueError(
                f"an excess of {excess:g} takes more than {MOST_BALLS} balls; allow more"
            )
        if k < ROUNDS:
            steps = min(MOST_STEPS, MOST_CHANGES // len(chosen))
            chosen = fewer(_transposed(held), chosen, steps)
        left = uncovered(triangles, centres[chosen], radii[chosen], work)
        if not len(left):
            return centres[chosen], radii[chosen]
        missed = left.reshape(-1, 3)
        missed = missed[one_a_cell(missed, MOST_DEMANDS, excess / 20)[0]]
        work.spend(len(missed) * len(centres) + held.size // 8)  # which is copied
        held = np.vstack([held, within(missed, centres, radii - SURE * excess)])
        open_ones = ~held[:, chosen].any(axis=1)
        chosen = np.append(chosen, few(held[open_ones].T))
    raise ValueError(f"the mesh is not covered to an excess of {excess:g}; allow more")


def _transposed(table: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the transposed table, row by row in memory: by blocks, a third of the time."""
    found = np.empty(table.shape[::-1], dtype=bool)
    for k in range(0, len(table), 256):
        found[:, k : k + 256] = table[k : k + 256].T
    return found
