"""Margins of a planar arm as a user types them in NumPy: sines, cosines, and no library but arrays.

What a pair of frames has between it depends on the joints between them alone: over a grid
(``q[0]`` of shape (n, 1), ``q[1]`` of shape (1, n)) most of the work is done once a row or column.
`tests/test_side_by_side_planar.py` holds it to the margins of `qbound`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.model.robot import Body, BodyPair, Capsule, Disc, HalfSpace, Pair, Polygon, Robot

Floats = NDArray[np.float64]
BLOCK = 16_384
"""Configurations at once: what is computed of them stays in the cache."""


class Place(NamedTuple):
    """Coordinates in the plane of motion: numbers, or arrays that broadcast."""

    x: Any
    y: Any


class Turn(NamedTuple):
    """Cosine and sine of a joint's angle."""

    cos: Any
    sin: Any


Turns = Sequence[Turn]
Margin = Callable[[Turns], Floats]


class PlanarArm:
    """Turning joints of an arm in one plane, and what it keeps clear of.

    Attributes
    ----------
    ranges : ndarray, shape (joints, 2)
        Limits of each joint; (-pi, pi) where it turns all the way round.
    turning : tuple of bool
        Which joints turn all the way round.
    signs : ndarray, shape (joints,)
        Which way round, in the plane, each joint turns.
    slopes : tuple of float
        No margin changes faster than this with each joint; length per rad.
    """

    def __init__(self, robot: Robot) -> None:
        axes = np.array([joint.mount @ joint.axis for joint in robot.joints])
        flat = int(np.argmax(np.abs(axes[0])))
        self._plane = [(1, 2), (0, 2), (0, 1)][flat]
        handed = -1.0 if flat == 1 else 1.0  # a turn about y takes z to x
        self.signs = handed * axes[:, flat]
        self._robot = robot
        self._origins = [self.place(joint.origin) for joint in robot.joints]
        limits = [joint.limits for joint in robot.joints]
        self.turning = tuple(ends is None for ends in limits)
        self.ranges = np.array([ends or (-np.pi, np.pi) for ends in limits])
        self._margins = [self._margin(boundary) for boundary in robot.used]
        self.slopes = tuple(self._reach(j) for j in range(len(robot.joints)))

    def margin(self, q: Sequence[Floats]) -> Floats:
        """Return the least margin, a length; one array a joint, of shapes that broadcast."""
        turns = [Turn(np.cos(x), sign * np.sin(x)) for sign, x in zip(self.signs, q, strict=True)]
        least = np.full(np.broadcast_shapes(*(np.shape(turn.cos) for turn in turns)), np.inf)
        for margin in self._margins:
            np.minimum(least, margin(turns), out=least)
        return least

    def of(self, q: Floats) -> Floats:
        """Return the least margin of configurations, shape (joints, n), block by block."""
        n = q.shape[1]
        blocks = [self.margin(q[:, k : k + BLOCK]) for k in range(0, n, BLOCK)]
        return np.concatenate([np.empty(0), *blocks])

    def over_grid(self, x: Floats, y: Floats) -> Floats:
        """Return the least margin of two joints over a grid, shape (len(x), len(y))."""
        rows = max(1, BLOCK // len(y))
        result = np.empty((len(x), len(y)))
        for k in range(0, len(x), rows):
            result[k : k + rows] = self.margin([x[k : k + rows, None], y[None]])
        return result

    def place(self, at: Any) -> Place:
        """Return a place or a direction of three coordinates in the plane of motion."""
        across, up = self._plane
        return Place(float(at[across]), float(at[up]))

    def seen(self, turns: Turns, frames: tuple[int, int], at: Place) -> Place:
        """Return the place of a point of frame `frames[1]`, seen from frame `frames[0]`."""
        for j in reversed(range(*frames)):
            origin, (c, s) = self._origins[j], turns[j]
            at = Place(origin.x + c * at.x - s * at.y, origin.y + s * at.x + c * at.y)
        return at

    def _reach(self, joint: int) -> float:
        """Return how far from a joint's axis a point on what it moves can be."""
        links = sum(float(np.hypot(*place)) for place in self._origins[joint + 1 :])
        depth, moved = self._robot.depth, list[Place]()
        moved += [self.place(p.at) for p in self._robot.points if depth(p.frame) > joint]
        for body in self._robot.bodies:
            if depth(body.frame) > joint:
                moved += [self.place(corner) for corner in body.shape.places]
        return links + max(float(np.hypot(*place)) for place in moved)

    def _margin(self, boundary: Any) -> Margin:
        robot = self._robot
        if isinstance(boundary, HalfSpace):
            point = robot.point(boundary.point)
            normal, least = self.place(boundary.normal), boundary.offset + point.radius
            frames, at = (0, robot.depth(point.frame)), self.place(point.at)

            def height(turns: Turns) -> Floats:
                x, y = self.seen(turns, frames, at)
                if normal.x == 0 or normal.y == 0:
                    return np.asarray(normal.y * y if normal.x == 0 else normal.x * x) - least
                return np.asarray(normal.x * x + normal.y * y - least)

            return height
        if isinstance(boundary, Pair):
            points = [robot.point(name) for name in boundary.points]
            one, other = sorted(points, key=lambda point: robot.depth(point.frame))
            between = robot.depth(one.frame), robot.depth(other.frame)
            to, end = self.place(one.at), self.place(other.at)
            apart = robot.required_distance(boundary)

            def distance(turns: Turns) -> Floats:
                x, y = self.seen(turns, between, end)
                return _length(x - to.x, y - to.y) - apart

            return distance
        if isinstance(boundary, BodyPair):
            return self._apart(*(robot.body(name) for name in boundary.bodies), boundary.clearance)
        raise TypeError(f"no closed form for {boundary!r}")

    def _apart(self, link: Body, block: Body, clearance: float) -> Margin:
        """Return the distance of a capsule, on a link, from a disc or polygon at the base."""
        shape, core = link.shape, block.shape
        if not isinstance(shape, Capsule) or block.frame != self._robot.base:
            raise TypeError(f"no closed form for {link.name} and {block.name}")
        frames = 0, self._robot.depth(link.frame)
        ends = self.place(shape.start), self.place(shape.end)
        if isinstance(core, Disc):
            corners, thick = [self.place(core.at)], core.radius
        elif isinstance(core, Polygon):
            corners, thick = [self.place(corner) for corner in core.corners], 0.0
        else:
            raise TypeError(f"no closed form for {block.name}")
        apart, length = shape.radius + thick + clearance, float(_length(*_minus(*ends)))

        def distance(turns: Turns) -> Floats:
            start, end = (self.seen(turns, frames, at) for at in ends)
            return segment_distance(start, end, length, corners) - apart

        return distance


def segment_distance(start: Place, end: Place, length: float, corners: Sequence[Place]) -> Floats:
    """Return distances of segments of one length from a point or polygon, 0 where they cross it."""
    unit = Place(*(part / length for part in _minus(end, start)))
    seen = []  # the corners: along the segment, and beside it
    for corner in corners:
        x, y = _minus(corner, start)
        seen.append(Place(unit.x * x + unit.y * y, unit.x * y - unit.y * x))
    squares = _least((w.x - np.clip(w.x, 0, length)) ** 2 + w.y * w.y for w in seen)
    if len(corners) == 1:
        return np.sqrt(squares)
    crossed = np.zeros(np.shape(squares), dtype=bool)
    for (a, w), (b, v) in pairwise(zip([*corners, corners[0]], [*seen, seen[0]], strict=True)):
        edge = _minus(b, a)
        long = edge.x**2 + edge.y**2
        for tip in (start, end):
            x, y = _minus(tip, a)
            part = np.clip((x * edge.x + y * edge.y) / long, 0, 1)
            squares = np.minimum(squares, (x - part * edge.x) ** 2 + (y - part * edge.y) ** 2)
        down = v.y - w.y
        meets = (v.y * w.x - v.x * w.y) * down  # where the edge meets the line, times down^2
        crossed |= (w.y * v.y < 0) & (meets >= 0) & (meets <= length * down * down)
    return np.where(crossed, 0.0, np.sqrt(squares))


def _minus(one: Place, other: Place) -> Place:
    return Place(one.x - other.x, one.y - other.y)


def _length(x: Any, y: Any) -> Floats:
    return np.sqrt(x * x + y * y)


def _least(arrays: Iterable[Floats]) -> Floats:
    first, *others = arrays
    for other in others:
        first = np.minimum(first, other)
    return first
