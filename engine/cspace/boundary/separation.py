"""Signed distances of the bodies of a planar arm, at millions of configurations.

The distance of two parts is that of their cores less both radii. Where the cores overlap, it is
minus the depth. The distance of two bodies is that of their nearest parts. No form is needed, so
any number of joints will do: the rows of contact features are applied to poses in numbers.

The module also finds the nearest places of two bodies: their corners, edges and coordinates.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats, Indices
from cspace.boundary.contacts import (
    FAR_APART,
    PartPair,
    Parts,
    ViewRows,
    above,
    less,
    squared_distance,
    wall_normals,
)
from cspace.boundary.poses import (
    POSE,
    PlaneChain,
    bounded_bodies,
    bounds_bodies,
    flat_parts,
    refuse_off_plane,
    step_lengths,
    wall_of,
)
from cspace.forms.factors import FACTORS
from cspace.geometry.distance import View, closest, signed
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Held, Pair, Robot
from cspace.tolerances import ROUNDING

CACHED, MOST = 2**17, 2**20
"""Numbers of a block of configurations: what the passes over all of them read again stays in the
cache; where discs leave few to look at, larger blocks cost less."""

MOST_POSES = 2**12
"""Configurations of a block at most: a larger product is cut by the library over all cores, at a
cost above its own. For the same reason products go row by row."""

LINEAR = POSE - 1
"""Rows of a pose without the squared length, which no margin needs."""


@dataclass(frozen=True, eq=False)
class PartPairs:
    """Pairs of parts of two frames with cores of m and of k corners, as rows for their poses.

    Attributes
    ----------
    frames : (int, int)
        Numbers of steps to both frames, the nearer one first.
    boundary : ndarray of int, shape (p,)
        Ascending: which boundary each pair belongs to.
    rows : ndarray, shape (2, features, p, LINEAR)
        Of each corner and each edge that sees it: across the edge, and along it from its middle.
    half : ndarray, shape (features, p, 1)
        Half the length of that edge.
    views : tuple of (edges, corners, solid)
        Numbers of edges, and which cores are solid, from which the features are made.
    kept : ndarray, shape (p, 1)
        Both radii and the clearance.
    discs : ndarray, shape (p, POSE)
        Squared distance of the middles of both cores.
    reach : ndarray, shape (p, 1)
        Sum of the two cores' radii about their middles.
    """

    frames: tuple[int, int]
    boundary: Indices
    rows: Floats
    half: Floats
    views: tuple[tuple[int, int, bool], ...]
    kept: Floats
    discs: Floats
    reach: Floats

    @classmethod
    def of(cls, parts: Parts, pairs: Sequence[PartPair]) -> PartPairs:
        """Return pairs of equal frames and numbers of corners."""
        one, other = (np.array([pair[k] for pair in pairs]) for k in (2, 3))
        m, n = int(parts.count[one[0]]), int(parts.count[other[0]])
        p, r = parts.begin[one, None] + np.arange(m), parts.begin[other, None] + np.arange(n)
        seeing = [(p, r, False)] if m > 1 or n == 1 else []
        seeing += [(r, p, True)] if n > 1 else []
        rows, half, views = [], [], []
        for core, corner, back in seeing:
            solid, view = core.shape[1] > 2, ViewRows(parts.corners, parts.corners, back=back)
            e = core if solid else core[:, :1]  # of a segment one of its two edges
            both = e.T[:, None], corner.T[None]
            middle = parts.corners.reach[both[0]] / 2
            seen = np.stack([view.height(*both), less(view.ahead(*both), middle)])
            rows.append(seen.reshape(2, -1, len(pairs), POSE)[..., :LINEAR])
            half.append(np.repeat(middle[:, 0], corner.shape[1], axis=0))
            views.append((e.shape[1], corner.shape[1], solid))
        middles = parts.middle[one], parts.middle[other]
        return cls(
            frames=pairs[0].frames,
            boundary=np.array([pair.boundary for pair in pairs]),
            rows=np.concatenate(rows, axis=1),
            half=np.concatenate(half)[..., None],
            views=tuple(views),
            kept=np.array([pair.keep for pair in pairs])[:, None],
            discs=squared_distance(*middles, parts.corners.axes),
            reach=(parts.reach[one] + parts.reach[other])[:, None],
        )

    @property
    def numbers(self) -> int:
        """How many numbers a configuration takes."""
        return int(self.rows.size) // LINEAR

    def margins(self, pose: Floats) -> Floats:
        """Return the margin of every pair, shape (p, n), at poses of shape (POSE, n)."""
        values = self.rows @ pose[:LINEAR]
        return np.asarray(signed(self._seen(values, self.half)) - self.kept)

    def margins_of(self, pairs: Indices, pose: Floats) -> Floats:
        """Return the margins of single pairs, shape (e,), each at its pose, shape (POSE, e)."""
        values = np.einsum("cfer,re->cfe", self.rows[:, :, pairs], pose[:LINEAR])
        return np.asarray(signed(self._seen(values, self.half[:, pairs, 0])) - self.kept[pairs, 0])

    def near(self, pose: Floats, at_least: Floats) -> Bools:
        """Tell which pairs may be no farther apart than `at_least`, shape (p, 1); discs suffice."""
        far = np.maximum(self.reach + self.kept + at_least, 0.0) ** 2
        rounding = FAR_APART * (self.discs[:, :1] + far + pose[-1].max(initial=0.0))
        return np.asarray((self.discs[:, None] @ pose)[:, 0] <= far + rounding)

    def _seen(self, values: Floats, half: Floats) -> list[View]:
        found, start = [], 0
        for e, k, solid in self.views:
            across, along = values[:, start : start + e * k].reshape(2, e, k, *values.shape[2:])
            lengths = half[start : start + e * k : k].reshape(e, 1, *half.shape[1:])
            found.append(View(across, along, lengths, solid))
            start += e * k
        return found


@dataclass(frozen=True, eq=False)
class Heights:
    """Corners of one frame above half-spaces; attributes as those of `PartPairs`."""

    frames: tuple[int, int]
    boundary: Indices
    rows: Floats
    """Shape (p, LINEAR)."""
    kept: Floats

    @classmethod
    def of(cls, parts: Parts, pairs: Sequence[PartPair], normals: Floats) -> Heights:
        """Return corners above half-spaces, of all boundaries' normals, shape (boundaries, 2)."""
        boundary = np.array([pair.boundary for pair in pairs])
        corners = [parts.begin[pair.other] + pair.within[1] for pair in pairs]
        rows = above(normals[boundary], parts.corners.places[corners], 0.0, parts.corners.axes)
        kept = np.array([pair.keep for pair in pairs])[:, None]
        return cls(pairs[0].frames, boundary, rows[:, :LINEAR], kept)

    @property
    def numbers(self) -> int:
        """How many numbers a configuration takes."""
        return len(self.rows)

    def margins(self, pose: Floats) -> Floats:
        """Return the height of every corner, shape (p, n), at poses of shape (POSE, n)."""
        return np.asarray(self.rows @ pose[:LINEAR] - self.kept)


class BodyMargins:
    """Margins of the boundaries of a planar robot that are about bodies.

    Parameters
    ----------
    robot : Robot
    held : mapping of int or str to float, optional
        Values of the joints that are held, by index or name; rad or length.
    boundaries : sequence of Boundary, optional
        Pairs of bodies, and half-spaces that keep a body; default all in use.

    Attributes
    ----------
    names : tuple of str
        One a column.
    rounding : ndarray, shape (columns,)
        A margin that is no farther below zero than this is rounding.

    Raises
    ------
    ValueError
        If the robot or a body leaves every plane, or a boundary is about points.
    """

    def __init__(
        self,
        robot: Robot,
        held: Held | None = None,
        boundaries: Sequence[Boundary] | None = None,
    ) -> None:
        if boundaries is None:
            boundaries = [b for b in robot.used if bounds_bodies(b)]
        for boundary in boundaries:
            if not bounds_bodies(boundary):
                raise ValueError(f"{boundary.name}: it is about points, not about bodies")
        refuse_off_plane(robot, boundaries)
        self.robot = robot
        self.held = robot.held_indices(held or {})
        self.boundaries = tuple(boundaries)
        self.names = tuple(boundary.name for boundary in boundaries)
        self._chain = PlaneChain.of(robot)
        self.pairs: list[PartPairs] = []
        self.heights: list[Heights] = []
        if boundaries:
            self._group_pairs(Parts(robot, boundaries, self._chain.axes))
        self._groups: list[PartPairs | Heights] = [*self.pairs, *self.heights]
        self.rounding = ROUNDING * self._sizes()

    def _group_pairs(self, parts: Parts) -> None:
        """Put pairs of parts of equal frames and numbers of corners together."""
        groups = defaultdict[tuple[object, ...], list[PartPair]](list)
        for pair in parts.pairs:
            wall = pair.one < 0
            groups[pair.frames, *(() if wall else parts.count[[pair.one, pair.other]])].append(pair)
        normals = wall_normals(self.robot, self.boundaries)
        for own in groups.values():
            if own[0].one < 0:
                self.heights.append(Heights.of(parts, own, normals))
            else:
                self.pairs.append(PartPairs.of(parts, own))

    def margins(self, q: ArrayLike) -> Floats:
        """Return the margin of every boundary, shape (..., free joints) to (..., boundaries).

        A margin is a length. For a pair it is the signed distance of the bodies less the clearance;
        where bodies overlap, the signed distance is minus the depth. For a half-space it is the
        least height of a place of the body. A margin that is negative by rounding alone is returned
        as zero.

        Raises
        ------
        ValueError
            If the last axis has not one value a free joint, or one is NaN or infinite.
        """
        full = self.robot.with_held(q, self.held)
        flat = full.reshape(-1, full.shape[-1])
        found = np.full((len(self.names), len(flat)), np.inf)
        for part in self._blocks(len(flat), CACHED):
            poses = self._poses(flat[part])
            for group in self._groups:
                _lower(found[:, part], group.boundary, group.margins(poses[group.frames]))
        found[(found < 0) & (found > -self.rounding[:, None])] = 0.0
        return found.T.reshape(*full.shape[:-1], len(self.names))

    def separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell which boundaries have a margin above `at_least`, shape (..., boundaries).

        For most pairs, discs round their parts decide. Nothing is set to zero as rounding.
        Arguments and errors as in `margins`; `at_least` is one length, or one for each boundary.
        """
        full = self.robot.with_held(q, self.held)
        flat = full.reshape(-1, full.shape[-1])
        least = np.broadcast_to(np.asarray(at_least, dtype=float), (len(self.names),))
        found = np.ones((len(self.names), len(flat)), dtype=np.bool_)
        for part in self._blocks(len(flat), MOST):
            self._rule_out(found[:, part], flat[part], least, whole=False)
        return found.T.reshape(*full.shape[:-1], len(self.names))

    def all_separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell where every margin is above `at_least`, shape (...); as `separated`, and faster."""
        full = self.robot.with_held(q, self.held)
        flat = full.reshape(-1, full.shape[-1])
        least = np.broadcast_to(np.asarray(at_least, dtype=float), (len(self.names),))
        found = np.ones(len(flat), dtype=np.bool_)
        for part in self._blocks(len(flat), MOST):
            block = np.ones((len(self.names), len(flat[part])), dtype=np.bool_)
            self._rule_out(block, flat[part], least, whole=True)
            found[part] = block.all(axis=0)
        return found.reshape(full.shape[:-1])

    def _rule_out(self, found: Bools, q: Floats, least: Floats, whole: bool) -> None:
        """Clear `found`, shape (boundaries, n), where a margin is at most `least`.

        With `whole`, a configuration with one such margin is not looked at again.
        """
        poses = self._poses(q)
        for height in self.heights:
            above = height.margins(poses[height.frames]) > least[height.boundary, None]
            i, at = np.nonzero(~above)
            found[height.boundary[i], at] = False
        for group in self.pairs:
            pose = poses[group.frames]
            near = group.near(pose, least[group.boundary, None])
            if whole:
                near &= found.all(axis=0)
            pair, at = np.nonzero(near)
            if 3 * len(pair) > near.size:
                hit = near & (group.margins(pose) <= least[group.boundary, None])
                pair, at = np.nonzero(hit)
            else:
                hit = _margins_of(group, pair, pose, at) <= least[group.boundary[pair]]
                pair, at = pair[hit], at[hit]
            found[group.boundary[pair], at] = False

    def _poses(self, q: Floats) -> dict[tuple[int, int], Floats]:
        """Return the poses of all groups, shape (POSE, n) each, at configurations (n, joints)."""
        columns, ones = np.ascontiguousarray(q.T), np.ones(len(q))
        ways = {group.frames for group in self._groups}
        joints = {m.joint for near, far in ways for m in self._chain.moves[near:far]}
        kinds = self.robot.kinds
        known = {j: FACTORS[kinds[j]].functions(columns[j]) for j in joints}
        return {way: self._chain.pose(way, ones, known) for way in ways}

    def _blocks(self, count: int, most: int) -> Iterator[slice]:
        numbers = max((group.numbers for group in self._groups), default=1)
        step = min(MOST_POSES, max(16, most // numbers))
        return (slice(start, start + step) for start in range(0, count, step))

    def _sizes(self) -> Floats:
        """Return for each boundary the largest length that goes into its margin."""
        sizes, lengths = np.zeros(len(self.names)), step_lengths(self.robot)
        for i, boundary in enumerate(self.boundaries):
            (first, near), (last, far) = _ends(self.robot, boundary)
            bodies = bounded_bodies(self.robot, boundary)
            radii = sum(max(part.radius for part in body.parts) for body in bodies)
            assert isinstance(boundary, BodyPair | HalfSpace)
            level = boundary.offset if isinstance(boundary, HalfSpace) else boundary.clearance
            sizes[i] = sum(lengths[first:last]) + near + far + radii + abs(level)
        return sizes


def largest_speeds(robot: Robot, boundary: Boundary) -> Floats:
    """Return how fast the margin of a boundary changes at most, shape (joints,).

    The unit is a length for each unit of a joint. Seen from the nearer of two things, a turn moves
    no place of the other one faster than its distance from the joint's axis, a slide no faster than
    1. A signed distance changes by no more than a thing moves.
    """
    (first, _), (last, far) = _ends(robot, boundary)
    lengths, speeds = step_lengths(robot), np.zeros(len(robot.joints))
    for k, step in enumerate(robot.steps[first:last], start=first):
        speeds[step.joint] += 1.0 if step.slides else sum(lengths[k + 1 : last]) + far
    if isinstance(boundary, HalfSpace):
        speeds *= float(np.linalg.norm(boundary.normal))
    return np.asarray(speeds)


def _ends(robot: Robot, boundary: Boundary) -> list[tuple[int, float]]:
    """Return the depths of both things that a boundary is about, nearer first; (0, 0) of a wall.

    With each goes the distance of its farthest place from the origin of its frame.
    """
    found = []
    for body in bounded_bodies(robot, boundary):
        corners = (np.linalg.norm(part.corners, axis=-1).max() for part in body.parts)
        found.append((robot.steps_to(body.frame), float(max(corners))))
    names: tuple[str, ...] = boundary.points if isinstance(boundary, Pair) else ()
    if isinstance(boundary, HalfSpace) and boundary.body is None:
        names = (boundary.point,)
    for point in map(robot.point, names):
        found.append((robot.steps_to(point.frame), float(np.linalg.norm(point.at))))
    return sorted(found) if len(found) == 2 else [(0, 0.0), *found]


def _margins_of(group: PartPairs, pairs: Indices, pose: Floats, at: Indices) -> Floats:
    """Return the margins of single pairs at single configurations, some at a time."""
    step = max(1, CACHED // (LINEAR * group.rows.shape[1]))
    parts = (slice(i, i + step) for i in range(0, len(pairs), step))
    found = [group.margins_of(pairs[part], pose[:, at[part]]) for part in parts]
    return np.concatenate([np.empty(0), *found])


def _lower(found: Floats, boundary: Indices, margins: Floats) -> None:
    """Replace entries of `found`, shape (boundaries, n), by smaller margins of parts."""
    first = np.flatnonzero(np.diff(boundary, prepend=-1))
    if len(first) < len(boundary):
        boundary, margins = boundary[first], np.minimum.reduceat(margins, first, axis=0)
    found[boundary] = np.minimum(found[boundary], margins)


# --- the nearest places ---------------------------------------------------------------------------


Placed = tuple[str, Floats, float]


class Nearest(NamedTuple):
    """The features of two bodies, or of a body and a half-space, that are nearest."""

    names: tuple[str, str]
    """Of the bodies; of a half-space the boundary's."""
    features: tuple[str, str]
    """Such as "corner 2" and "edge 3" of their outlines, counted from 0, with the part where a
    body has several; a half-space has only its "edge"."""
    places: Floats
    """One of each, shape (2, 2), in the plane's coordinates seen from the base; length."""
    distance: float
    """Between these places; negative by the depth where the bodies overlap."""


def nearest_features(robot: Robot, boundary: Boundary, q: ArrayLike) -> Nearest:
    """Return where the bodies of a boundary are nearest, or deepest in each other.

    Parameters
    ----------
    boundary : Boundary
        About two bodies, or a half-space that keeps a body.
    q : array_like, shape (n,)
        One configuration.

    Raises
    ------
    ValueError
        If the boundary is about points, the robot leaves every plane, or `q` is not a
        configuration.
    """
    if not bounds_bodies(boundary):
        raise ValueError(f"{boundary.name}: it is about points, not about bodies")
    values = robot.configuration(q)
    if values.ndim != 1:
        raise ValueError(f"one configuration is wanted, found the shape {values.shape}")
    bodies = bounded_bodies(robot, boundary)
    placed = [list(_placed(robot, body, values)) for body in bodies]
    if isinstance(boundary, HalfSpace):
        return _above(robot, boundary, bodies[0], placed[0])
    names = bodies[0].name, bodies[1].name
    found = (_between(names, one, other) for one, other in product(*placed))
    return min(found, key=lambda nearest: nearest.distance)


def _between(names: tuple[str, str], one: Placed, other: Placed) -> Nearest:
    """Find the nearest features of two parts."""
    (part, p, p_radius), (other_part, r, r_radius) = one, other
    found = closest(p, r)
    offsets = np.array([p_radius, -r_radius])[:, None] * found.direction
    return Nearest(
        names=names,
        features=(part + found.features[0], other_part + found.features[1]),
        places=found.places + offsets,
        distance=found.distance - p_radius - r_radius,
    )


def _above(robot: Robot, wall: HalfSpace, body: Body, parts: list[Placed]) -> Nearest:
    """Find the lowest place of a body over a half-space."""
    normal, level = wall_of(robot, wall, body)
    heights = [corners @ normal - radius - level for _, corners, radius in parts]
    lowest = int(np.argmin([height.min() for height in heights]))
    (part, corners, radius), corner = parts[lowest], int(np.argmin(heights[lowest]))
    distance = float(heights[lowest][corner])
    size = float(np.hypot(*normal))
    unit = normal / size if size > 0 else normal
    place = corners[corner] - radius * unit
    foot = place - distance * unit
    features = (f"{part}corner {corner}", "edge")
    return Nearest((body.name, wall.name), features, np.array([place, foot]), distance)


def _placed(robot: Robot, body: Body, q: Floats) -> Iterator[Placed]:
    """Yield the name of each part of a body, its core at this configuration, and its radius."""
    known = {j: FACTORS[kind].functions(q[j, None]) for j, kind in enumerate(robot.kinds)}
    pose = PlaneChain.of(robot).pose((0, robot.steps_to(body.frame)), np.ones(1), known)
    _, c, s, x, y, *_ = pose[:, 0]
    turn = np.array([[c, s], [-s, c]])
    parts = flat_parts(robot, body)
    for i, (core, radius) in enumerate(parts):
        yield f"part {i}, " if len(parts) > 1 else "", core @ turn + [x, y], radius
