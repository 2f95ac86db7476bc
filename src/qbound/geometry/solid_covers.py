"""Covers of capsules, cylinders and boxes by few balls, proved for the whole solid.

Each function takes the allowed excess: how far a ball may stick out of the shape. Shapes stand
about the origin, capsules and cylinders along z.
"""

from __future__ import annotations

import math

import numpy as np

from qbound.arrays import Floats
from qbound.geometry.bisection import last_before
from qbound.geometry.covering import Cover, few, uncovered, within
from qbound.tolerances import OUTWARD

MOST_OF_A_KIND = 4000
"""Balls of a cover at most: more is a slip in the excess asked for."""

RINGS = 14
"""So many numbers of balls are tried for a ring in a cylinder, from 3 on."""


def ball_cover(radius: float) -> Cover:
    """Cover a ball by itself."""
    return Cover(np.zeros((1, 3)), np.array([radius]), 0.0)


def capsule_cover(radius: float, length: float, excess: float) -> Cover:
    r"""Cover a capsule by the fewest equal balls on its segment, as small as that number allows.

    Balls of radius :math:`R = r + e` on the axis cover all within r of it where they are at most
    :math:`2\sqrt{R^2 - r^2}` apart, and a cap where the last is at most e from its centre.

    Parameters
    ----------
    radius, length : float
        The length is that of the segment.
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
    cells = np.where(cells == cells.min(), out, np.inf)  # of the fewest, what sticks out least
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
    (rho, z) is covered at all directions where it is at the worst one:

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
    """Return candidates (k, a, z, R), one ball on the axis being k = 1, and their discs."""
    places = _grid([0.0, -length / 2], [radius, length / 2], step)
    depth = np.minimum(radius - places[:, 0], length / 2 - np.abs(places[:, 1]))
    every = np.column_stack([places, np.maximum(depth, 0) + excess])
    on_axis = places[:, 0] == 0
    rings = [np.insert(every[on_axis], 0, 1, axis=1)]
    most = max(RINGS, 4 * radius / excess)  # balls as large as the excess about the rim, and more
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
