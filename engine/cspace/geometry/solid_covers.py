"""Covers of capsules, cylinders and boxes by few balls, proved for the whole solid.

Each function takes the allowed excess: how far a ball may stick out of the shape. Shapes stand
about the origin, capsules and cylinders along z.

A mesh is covered by few balls too, proved triangle by triangle.

Let the centre of a ball lie inside the solid, at least a depth d below the surface. Then the ball
sticks out of the solid by at most its radius less d. So each centre has a largest ball for a given
excess. Balls are chosen greedily from the largest ones (`solid_balls`) until they hold all samples
of the triangles. Halving then looks for uncovered places, which are added to the samples, until no
place is uncovered.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats
from cspace.extras import require
from cspace.geometry.arcs import last_before
from cspace.geometry.covering import Cover, Work, few, fewer, uncovered, within
from cspace.geometry.mesh_solids import (
    Convex,
    OrientedBox,
    SurfaceDistance,
    as_box,
    convex_balls,
    convex_solid,
    hull_of,
    one_a_cell,
    solid_balls,
    unit_normals,
)
from cspace.geometry.simplices import edges, halved
from cspace.tolerances import OUTWARD

MOST_OF_A_KIND = 4000
"""Balls of a cover at most: more is a slip in the excess asked for."""

RINGS = 14
"""So many numbers of balls are tried for a ring in a cylinder, from 3 on."""


def ball_cover(radius: float) -> Cover:
    """Cover a ball by itself."""
    return Cover(np.zeros((1, 3)), np.array([radius]), 0.0)


def capsule_cover(radius: float, length: float, excess: float) -> Cover:
    r"""Cover a capsule by the fewest equal balls on its segment, as small as that number allows.

    Balls of radius :math:`R = r + e` on the axis cover all places within r of the axis if they are
    at most :math:`2\sqrt{R^2 - r^2}` apart. They cover a round end if the last centre is at most e
    from the end of the segment.

    Parameters
    ----------
    radius, length : float
        Radius of the capsule and length of its segment.
    excess : float
        Above 0.

    Raises
    ------
    ValueError
        If that takes more than `MOST_OF_A_KIND` balls.

    Examples
    --------
    >>> centres, radii, excess = capsule_cover(0.05, 0.4, 0.02)
    >>> len(radii), round(excess, 4)
    (5, 0.0177)
    """

    def reach(e: Floats) -> Floats:
        return np.asarray(2 * e + 2 * (count - 1) * np.sqrt(2 * radius * e + e * e))

    more = OUTWARD * (radius + length)
    excess = excess - more
    apart = 2 * math.sqrt(2 * radius * excess + excess * excess)
    count = max(1, math.ceil((length - 2 * excess) / apart) + 1)
    _check_count(count, excess)
    _, high = last_before(lambda e: reach(e) < length, [0.0], [max(excess, length)])
    least = min(float(high[0]), excess)
    end = length / 2 - least if count > 1 else 0.0
    centres = np.zeros((count, 3))
    centres[:, 2] = np.linspace(-end, end, count)
    return Cover(centres, np.full(count, radius + least + more), least + more)


def box_cover(size: Floats, excess: float) -> Cover:
    """Cover a box by the balls about the cells of a grid, the grid with the fewest cells.

    A ball about a cell sticks out of a face by its radius less half the cell's width there.

    Raises
    ------
    ValueError
        If that takes more than `MOST_OF_A_KIND` balls.

    Examples
    --------
    >>> import numpy as np
    >>> cover = box_cover(np.array([0.1, 0.1, 0.3]), 0.02)
    >>> len(cover.radii), round(cover.excess, 4)
    (24, 0.0183)
    """
    more = OUTWARD * float(size.sum())
    most = [math.ceil(length / excess) + 1 for length in size]
    _check_count(math.prod(most) // 64, excess)
    counts = np.stack(np.meshgrid(*(np.arange(1, n + 1) for n in most), indexing="ij"), axis=-1)
    halves = size / (2 * counts)
    out = np.linalg.norm(halves, axis=-1) - halves.min(axis=-1)
    cells = np.where(out <= excess - more, counts.prod(axis=-1), np.inf)
    cells = np.where(cells == cells.min(), out, np.inf)  # of the fewest, least excess
    best = np.unravel_index(int(cells.argmin()), cells.shape)
    axes = [
        (np.arange(n) - (n - 1) / 2) * (length / n)
        for n, length in zip(counts[best], size, strict=True)
    ]
    centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    _check_count(len(centres), excess)
    radius = float(np.linalg.norm(halves[best])) + more
    return Cover(centres, np.full(len(centres), radius), float(out[best]) + more)


def cylinder_cover(radius: float, length: float, excess: float) -> Cover:
    r"""Cover a cylinder with flat ends by balls on its axis and in rings about it.

    Of k balls in a ring of radius a, one is within :math:`\pi/k` of every direction. So a place
    (rho, z) is covered in all directions if it is covered in the worst one:

    .. math:: (\rho - a\cos(\pi/k))^2 + (z - z_0)^2 \le R^2 - a^2 \sin^2(\pi/k),

    a disc of the half-plane of rho and z. Discs that cover the rectangle of the cylinder are
    chosen greedily, k being the cost, and proved to cover it by halving triangles.

    Raises
    ------
    ValueError
        If that takes more than `MOST_OF_A_KIND` balls.

    Examples
    --------
    >>> cover = cylinder_cover(0.09, 0.3, 0.02)
    >>> len(cover.radii) < 40, cover.excess <= 0.02
    (True, True)
    """
    _check_count(int(max(length * radius / excess, length) / excess), excess)
    corners = np.array([(0, 1), (radius, 1), (0, -1), (radius, -1)]) * (1, length / 2)
    triangles = corners[[[0, 1, 2], [1, 2, 3]]]
    side = math.sqrt(length * radius)
    allowed = excess - OUTWARD * (radius + length)
    for fineness in (1.0, 1.5, 2.0):
        coarse = max(excess / 3, side / 20) / fineness
        fine = max(excess / 6, side / 60) / fineness
        rings, centres, radii = _rings(radius, length, allowed, coarse)
        points = _grid([0.0, -length / 2], [radius, length / 2], fine)
        covers = within(points, centres, radii - fine * math.sqrt(0.5))
        chosen = few(covers.T, rings[:, 0])
        if not len(uncovered(triangles, centres[chosen], radii[chosen])):
            return _ring_cover(rings[chosen], radius + length, excess)
    raise ValueError(f"a cylinder of radius {radius:g} is not covered to an excess of {excess:g}")


def _rings(radius: float, length: float, excess: float, step: float) -> tuple[Floats, ...]:
    """Return candidates (k, a, z, R) and their discs; k = 1 is one ball on the axis."""
    places = _grid([0.0, -length / 2], [radius, length / 2], step)
    depth = np.minimum(radius - places[:, 0], length / 2 - np.abs(places[:, 1]))
    every = np.column_stack([places, np.maximum(depth, 0) + excess])
    on_axis = places[:, 0] == 0
    rings = [np.insert(every[on_axis], 0, 1, axis=1)]
    most = max(RINGS, 4 * radius / excess)  # balls of the excess about the rim, and more
    counts = np.unique(np.geomspace(3, most, RINGS).round())
    rings += [np.insert(every[~on_axis], 0, k, axis=1) for k in counts]
    found = np.concatenate(rings)
    k, a, z, large = found.T
    squared = large**2 - np.where(k > 1, (a * np.sin(math.pi / k)) ** 2, 0)
    kept = squared > (excess / 4) ** 2
    centres = np.column_stack([np.where(k > 1, a * np.cos(math.pi / k), 0), z])
    return found[kept], centres[kept], np.sqrt(squared[kept])


def _ring_cover(rings: Floats, size: float, excess: float) -> Cover:
    """Return the balls of rings."""
    centres, radii = [], []
    for k, a, z, large in rings:
        angles = 2 * math.pi * np.arange(int(k)) / k
        centres += [np.column_stack([a * np.cos(angles), a * np.sin(angles), np.full(int(k), z)])]
        radii += [large + OUTWARD * size] * int(k)  # the centres are rounded
    return Cover(np.concatenate(centres), np.array(radii), excess)


def _grid(low: list[float], high: list[float], step: float) -> Floats:
    """Return the points of a grid from corner to corner, at most a step apart."""
    axes = [
        np.linspace(a, b, max(2, math.ceil((b - a) / step) + 1))
        for a, b in zip(low, high, strict=True)
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _check_count(count: int, excess: float) -> None:
    if count > MOST_OF_A_KIND:
        raise ValueError(f"an excess of {excess:g} takes more than {MOST_OF_A_KIND} balls")


# --- covers of meshes -----------------------------------------------------------------------------


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
    """Cover all triangles of a mesh, but not the solid that they enclose.

    This is enough, because a body has to meet the triangles before it gets inside: a motion that
    starts clear of the solid and stays clear of its surface stays clear of the solid. A mesh that
    is a box is covered as a whole box.

    Parameters
    ----------
    triangles : ndarray, shape (N, 3, 3)
    closed : bool
        Whether the triangles are the whole surface of a solid. If not, the excess is measured from
        their convex hull.
    excess : float
        Above 0.

    Raises
    ------
    ValueError
        If the mesh is too large for the excess, needs too many balls or too much work, has no
        triangle, or has a number that is not finite.
    ModuleNotFoundError
        If SciPy is missing; it comes with ``cspace[arms]``.
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
    radius = 2 * float(np.abs(corners - centre).max())  # squares of a tiny mesh underflow
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

    Every place of the triangles is within the spread of one of the returned places.
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
    """Return the least edge of parts, not below a given one, that gives not too many parts."""
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
    """Return centres, inside and on the surface, and a lower bound of the depth of each."""
    surface, normals, spread = samples
    on_it, _ = one_a_cell(surface, MOST_PLACES // 4, excess / 2)
    most = MOST_PLACES // 2  # which take longer
    if convex is not None:
        most = min(MOST_PLACES, max(1, MOST_TURNS // len(convex.planes)))
    starts, _ = one_a_cell(surface, most, excess / 6)
    centres, depths = np.zeros((0, 3)), np.zeros(0)
    touched, outward = surface[starts], normals[starts]
    if convex is not None:
        if not closed:  # triangles without an outside
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

    Places found uncovered are added to the demands of the next round. After the last round, balls
    for uncovered places are added to the chosen ones.
    """
    work = Work(MOST_WORK, f"the mesh takes too long for an excess of {excess:g}; allow more")
    demands = surface[one_a_cell(surface, MOST_DEMANDS, excess / 4)[0]]
    work.spend(len(demands) * len(centres))
    held = within(demands, centres, radii - SURE * excess)
    lost = demands[~held.any(axis=1)]  # only in a large mesh, because few places are tried there
    if len(lost):  # these places get balls of their own
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
