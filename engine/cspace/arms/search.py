"""Search for a path: a straight line first, then two trees that grow towards each other.

The search is in doubles. It looks at points of each leg, the closer together the nearer something
is. A path that it finds is not proved, and a failure does not show that there is no path. `why`
gives a path to the certificates, and the configurations that refute one to the next search. Rapidly
exploring random trees (Kuffner and LaValle 2000), then cutting corners; not in the paper.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.boundary.balls import judge
from cspace.boundary.separation import largest_speeds
from cspace.model.robot import Robot
from qbound.circle import nearest_turn

TRIES = 4000
"""Places drawn before a search gives up."""

STEP = 0.5
"""Longest step of a tree, rad, or part of a slide's range."""

LOOKS = 0.02
"""Distance of the places of a leg that are looked at first, in the same measure."""

HALVINGS = 6
"""How often that distance is halved where something may lie between two places."""

CUTS = 300
"""Corners that are tried to be cut."""

ROOM = 1e-3
"""Part of the arm's reach that a path keeps from everything, where both ends keep it."""


def find_path(
    robot: Robot,
    start: ArrayLike,
    goal: ArrayLike,
    seed: int = 0,
    *,
    tries: int = TRIES,
    hold: bool = False,
    refuted: Sequence[Floats] = (),
) -> Floats | None:
    """Search for a path of straight legs in joint values from a start to a goal.

    Parameters
    ----------
    robot : Robot
    start, goal : array_like, shape (n,)
        rad or length; both feasible.
    seed : int
        Seed of the random numbers; the same seed gives the same path.
    tries : int
        Places drawn before the search gives up.
    hold : bool
        Whether joints with equal values at both ends keep this value.
    refuted : sequence of ndarray, shape (n,)
        Configurations that a proof found infeasible; no leg passes near one.

    Returns
    -------
    ndarray, shape (k, n), or None
        Corners, start first. The last corner is the goal; joints without limits may be full turns
        away from it.

    Raises
    ------
    ValueError
        If an end is not a configuration.

    Examples
    --------
    >>> from cspace import load_robot
    >>> path = find_path(load_robot("minervabot-v2"), [0.0, 0.0], [0.2, -0.5])
    >>> path.tolist()
    [[0.0, 0.0], [0.2, -0.5]]
    """
    ends = np.stack([robot.configuration(q) for q in (start, goal)])
    space = _Space(robot, ends, hold, refuted)
    first, last = space.ends
    if space.is_free_leg(first, last):
        return space.unrolled([first, last])
    rng = np.random.default_rng(seed)
    corners = _grown(space, rng, tries)
    return None if corners is None else space.unrolled(_cut(space, corners, rng))


class _Space:
    """The space between two configurations: which points are free, and how far apart they are."""

    def __init__(
        self, robot: Robot, ends: Floats, hold: bool, refuted: Sequence[Floats] = ()
    ) -> None:
        self.ends, self.evaluator, self.count = ends, judge(robot), len(robot.used)
        joints = robot.joints
        self.circles = np.array([joint.turns and joint.limits is None for joint in joints])
        pairs = zip(joints, ends[0], strict=True)
        limits = [joint.limits or (x - math.pi, x + math.pi) for joint, x in pairs]
        self.low, self.high = np.array(limits, dtype=float).T
        self.scale = np.where([j.turns for j in joints], 1.0, self.high - self.low)
        if hold:
            still = ends[0] == ends[1]
            self.low, self.high = (np.where(still, ends[0], x) for x in (self.low, self.high))
        margins = self.evaluator.margins(ends)[:, : self.count]
        least = float(margins.min()) if self.count else 1.0
        self.room = min(ROOM * robot.reach, max(least, 0.0) / 2)
        self.speeds = np.array([largest_speeds(robot, boundary) for boundary in robot.used])
        halfway = [float(self.length(self.step(ends, q)).min()) / 2 for q in refuted]
        self.refuted = [(q, min(LOOKS, r)) for q, r in zip(refuted, halfway, strict=True)]

    def step(self, p: Floats, q: Floats) -> Floats:
        """Return the step from p to q, shape (..., n), the short way round."""
        return np.where(self.circles, nearest_turn(q, p) - p, q - p)

    def length(self, step: Floats) -> Floats:
        return np.asarray(np.linalg.norm(step / self.scale, axis=-1))

    def margins(self, q: Floats) -> Floats | None:
        """Return the margins of configurations, shape (k, n); None if not all keep the room."""
        margins = self.evaluator.margins(q)
        ours, limits = margins[:, : self.count], margins[:, self.count :]
        return ours if (ours >= self.room).all() and (limits >= 0).all() else None

    def is_free_leg(self, p: Floats, q: Floats) -> bool:
        """Tell whether some points of a leg are free, its middle first.

        Between two points a margin falls below their mean by at most half of what its speed allows.
        Where that could be below zero the middle is looked at too, again and again.
        """
        step = self.step(p, q)
        looks = max(2, math.ceil(float(self.length(step)) / LOOKS))
        if self.margins((p + step / 2)[None]) is None or self.is_refuted(p, step):
            return False
        places, width = np.linspace(0, 1, looks + 1), 1 / looks
        margins = self.margins(p + places[:, None] * step)
        if margins is None:
            return False
        if not self.count:
            return True
        low, one, other = places[:-1], margins[:-1], margins[1:]
        change = self.speeds @ np.abs(step)
        for _ in range(HALVINGS):
            doubtful = (one + other < change * width).any(axis=1)
            if not doubtful.any():
                break
            low, one, other, width = low[doubtful], one[doubtful], other[doubtful], width / 2
            margins = self.margins(p + (low + width)[:, None] * step)
            if margins is None:
                return False
            low = np.concatenate([low, low + width])
            one, other = np.concatenate([one, margins]), np.concatenate([margins, other])
        return True

    def is_refuted(self, p: Floats, step: Floats) -> bool:
        """Tell whether a leg passes near a configuration that is known to be infeasible."""
        for q, radius in self.refuted:
            ahead, way = self.step(p, q) / self.scale, step / self.scale
            part = np.clip(ahead @ way / np.maximum(way @ way, 1e-300), 0, 1)
            if np.linalg.norm(ahead - part * way) < radius:
                return True
        return False

    def drawn(self, rng: np.random.Generator) -> Floats:
        """Draw a configuration: about half of them near the two ends, the others anywhere."""
        if rng.random() < 0.5:
            return np.asarray(rng.uniform(self.low, self.high))
        low, high = self.ends.min(axis=0) - self.scale, self.ends.max(axis=0) + self.scale
        low, high = np.clip(low, self.low, self.high), np.clip(high, self.low, self.high)
        return np.asarray(rng.uniform(low, high))

    def unrolled(self, corners: list[Floats]) -> Floats:
        """Shift corners by full turns so that none jumps by a turn from the one before."""
        path = [corners[0]]
        for corner in corners[1:]:
            path.append(path[-1] + self.step(path[-1], corner))
        path[-1] = np.where(self.circles, path[-1], corners[-1])
        return np.array(path)


class _Tree:
    """Configurations, each with the one that it was reached from."""

    def __init__(self, space: _Space, root: Floats, most: int) -> None:
        self.space, self.count = space, 1
        self.nodes = np.empty((most, len(root)))
        self.nodes[0], self.before = root, [0]

    def grow(self, target: Floats) -> tuple[int, bool]:
        """Step from the nearest node towards a target until the target or an obstacle is met."""
        space = self.space
        lengths = space.length(space.step(self.nodes[: self.count], target))
        k, left = int(lengths.argmin()), float(lengths.min())
        moved = False
        while self.count < len(self.nodes) and left > 0:
            step = space.step(self.nodes[k], target)
            q = target if left <= STEP else self.nodes[k] + step * (STEP / left)
            if not space.is_free_leg(self.nodes[k], q):
                return (k if moved else -1), False
            self.nodes[self.count] = q
            self.before.append(k)
            k, moved = self.count, True
            self.count += 1
            left = float(space.length(space.step(self.nodes[k], target))) if left > STEP else 0.0
        return k, left == 0

    def back(self, k: int) -> list[Floats]:
        """Return the way back to the root."""
        way = [self.nodes[k]]
        while k:
            k = self.before[k]
            way.append(self.nodes[k])
        return way


def _grown(space: _Space, rng: np.random.Generator, tries: int) -> list[Floats] | None:
    """Grow two trees: in turn, one towards a drawn point, the other towards its new node."""
    trees = [_Tree(space, end, 20 * tries + 2) for end in space.ends]
    for turn in range(tries):
        one, other = trees[turn % 2], trees[1 - turn % 2]
        k, _ = one.grow(space.drawn(rng))
        if k < 0:
            continue
        m, met = other.grow(one.nodes[k])
        if met:
            ways = [one.back(k)[::-1], other.back(m)[1:]]
            corners = [*ways[0], *ways[1]]
            return corners if turn % 2 == 0 else corners[::-1]
    return None


def _cut(space: _Space, corners: list[Floats], rng: np.random.Generator) -> list[Floats]:
    """Shorten a path: replace the part between two of its points by a straight leg, many times."""
    path = list(space.unrolled(corners))
    for _ in range(CUTS):
        if len(path) < 3:
            break
        i, j = sorted(rng.choice(len(path) - 1, 2, replace=False))
        p = path[i] + rng.random() * (path[i + 1] - path[i])
        q = path[j] + rng.random() * (path[j + 1] - path[j])
        if space.is_free_leg(p, q) and float(space.length(space.step(p, q))) > 0:
            path = [*path[: i + 1], p, q, *path[j + 1 :]]
    return _straightened(space, path)


def _straightened(space: _Space, path: list[Floats]) -> list[Floats]:
    """Leave out every corner that is not needed, beginning at the start."""
    kept, k = [path[0]], 0
    while k < len(path) - 1:
        ahead = range(len(path) - 1, k, -1)
        k = next(m for m in ahead if m == k + 1 or space.is_free_leg(path[k], path[m]))
        kept.append(path[k])
    return kept
