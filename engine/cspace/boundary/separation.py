"""Signed distances of the bodies of a planar arm, at millions of configurations.

The distance of two parts is that of their cores less both radii. Where the cores overlap, it is
minus the depth. The distance of two bodies is that of their nearest parts. No form is needed, so
any number of joints will do.

The module also finds the nearest places of two bodies: their corners, edges and coordinates.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats, Indices
from cspace.boundary.poses import (
    Axes,
    Pose,
    Vector,
    bounded_bodies,
    bounds_bodies,
    flat_parts,
    flat_steps,
    refuse_off_plane,
    step_lengths,
    wall_of,
)
from cspace.geometry.distance import View, closest, edges, signed
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Held, Pair, Robot
from cspace.tolerances import ROUNDING

CACHED, MOST = 2**17, 2**20
"""Numbers of a block of configurations: what the passes over all of them read again stays in the
cache; where discs leave few to look at, larger blocks cost less."""


POSE = 7
"""Rows of a pose: 1, cosine and sine of its turn, its origin (x, y) seen from the observer, and the
same vector seen from the turned frame."""

_ROW = np.eye(POSE)
ROWS = Pose(Axes(), (_ROW[1], _ROW[2]), (_ROW[3], _ROW[4]), (_ROW[5], _ROW[6]), 0 * _ROW[0])
"""Every pose: its tables are rows, whose products with the rows of a pose are its numbers."""


class PlanePoses:
    """Poses of the frames of a robot in its plane of motion, frames by the steps to them.

    Raises
    ------
    ValueError
        If the robot leaves every plane.
    """

    def __init__(self, robot: Robot) -> None:
        self._senses, self._joints = robot.plane.senses, [step.joint for step in robot.steps]
        self._origins, self._slides = zip(*flat_steps(robot), strict=True)
        self._lengths = step_lengths(robot)

    def length(self, near: int, far: int) -> float:
        """Return the length of the chain between two frames, stretched out."""
        return sum(self._lengths[near:far])

    def of(self, q: Floats, pairs: set[tuple[int, int]]) -> dict[tuple[int, int], Floats]:
        """Return the pose of a frame seen from one nearer to the base, for each of some pairs.

        Parameters
        ----------
        q : ndarray, shape (n, joints)
        pairs : set of (near, far)
            Numbers of steps from the base; equal ones are the frame itself.

        Returns
        -------
        dict of (near, far) to ndarray, shape (POSE, n)
        """
        columns = np.ascontiguousarray(q.T)
        steps = {k for near, far in pairs for k in range(near, far) if self._senses[k]}
        turning = {self._joints[k] for k in steps}
        known = {j: (np.cos(columns[j]), np.sin(columns[j])) for j in turning}
        both = ((k, known[self._joints[k]]) for k in steps)
        turns = {k: (cosine, self._senses[k] * sine) for k, (cosine, sine) in both}
        return {pair: self._pose(columns, turns, *pair) for pair in pairs}

    def _pose(
        self, columns: Floats, turns: dict[int, tuple[Floats, Floats]], near: int, far: int
    ) -> Floats:
        c, s, x, y = (np.full(columns.shape[1], value) for value in (1.0, 0.0, 0.0, 0.0))
        for k in range(near, far):
            (u, v), (du, dv) = self._origins[k], self._slides[k]
            value = columns[self._joints[k]]
            u, v = u + du * value, v + dv * value
            x, y = x + c * u - s * v, y + s * u + c * v
            if k in turns:
                ck, sk = turns[k]
                c, s = c * ck - s * sk, s * ck + c * sk
        return np.stack([np.ones_like(c), c, s, x, y, c * x + s * y, c * y - s * x])


def coordinates(direction: Floats, seen: Vector, level: Floats) -> Floats:
    """Return rows whose products with a pose are ``direction . seen - level``, shape (..., POSE).

    `seen` are places of one frame as `ROWS` sees them from the other, in which the direction is.
    """
    along = ROWS.axes.dot(ROWS.vector(direction), seen)
    return ROWS.plus(along, -ROWS.number(level))


@dataclass(frozen=True, eq=False)
class PartPairs:
    """Pairs of parts of two frames with cores of m and of k corners, as rows for their poses.

    Attributes
    ----------
    frames : (int, int)
        Numbers of steps to both frames, the nearer one first.
    boundary : ndarray of int, shape (p,)
        Ascending: which boundary each pair belongs to.
    rows : ndarray, shape (2, features, p, POSE)
        Of each corner and each edge that sees it: across the edge, and along it.
    half : ndarray, shape (features, p, 1)
        Half the length of that edge.
    views : tuple of (edges, corners, solid)
        Numbers of edges, and which cores are solid, from which the features are made.
    kept : ndarray, shape (p, 1)
        Both radii and the clearance.
    middles : ndarray, shape (2, p, POSE)
        From the middle of one core to the middle of the other.
    reach : ndarray, shape (p, 1)
        Sum of the two cores' radii about their middles.
    """

    frames: tuple[int, int]
    boundary: Indices
    rows: Floats
    half: Floats
    views: tuple[tuple[int, int, bool], ...]
    kept: Floats
    middles: Floats
    reach: Floats

    @property
    def numbers(self) -> int:
        """How many numbers a configuration takes."""
        return int(self.rows.size) // POSE

    def margins(self, pose: Floats) -> Floats:
        """Return the margin of every pair, shape (p, n), at poses of shape (POSE, n)."""
        values = self.rows.reshape(-1, POSE) @ pose
        values = values.reshape(*self.rows.shape[:-1], pose.shape[1])
        return np.asarray(signed(self._seen(values, self.half)) - self.kept)

    def margins_of(self, pairs: Indices, pose: Floats) -> Floats:
        """Return the margins of single pairs, shape (e,), each at its pose, shape (POSE, e)."""
        values = np.einsum("cfer,re->cfe", self.rows[:, :, pairs], pose)
        return np.asarray(signed(self._seen(values, self.half[:, pairs, 0])) - self.kept[pairs, 0])

    def near(self, pose: Floats, at_least: Floats) -> Bools:
        """Tell which pairs may be no farther apart than `at_least`, shape (p, 1); discs suffice."""
        x, y = (self.middles.reshape(-1, POSE) @ pose).reshape(2, len(self.kept), -1)
        far = np.maximum(self.reach + self.kept + at_least, 0.0)
        return np.asarray(x * x + y * y <= far * far)

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
    """Parts of one frame above half-spaces; attributes as those of `PartPairs`."""

    frames: tuple[int, int]
    boundary: Indices
    rows: Floats
    """Shape (m, p, POSE): of each corner, above the half-space."""
    kept: Floats

    @property
    def numbers(self) -> int:
        """How many numbers a configuration takes."""
        return int(self.rows.size) // POSE

    def margins(self, pose: Floats) -> Floats:
        """Return the margin of every part, shape (p, n), at poses of shape (POSE, n)."""
        values = self.rows.reshape(-1, POSE) @ pose
        corners, parts, _ = self.rows.shape
        return np.asarray(values.reshape(corners, parts, -1).min(axis=0) - self.kept)


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
        self._poses = PlanePoses(robot)
        self.pairs = tuple(_part_pairs(robot, self.boundaries))
        self.heights = tuple(_heights(robot, self.boundaries))
        self._groups: tuple[PartPairs | Heights, ...] = (*self.pairs, *self.heights)
        self.rounding = ROUNDING * self._sizes()

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
            poses = self._poses.of(flat[part], self._frames)
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
        poses = self._poses.of(q, self._frames)
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

    @cached_property
    def _frames(self) -> set[tuple[int, int]]:
        return {group.frames for group in self._groups}

    def _blocks(self, count: int, most: int) -> Iterator[slice]:
        numbers = max((group.numbers for group in self._groups), default=1)
        step = max(16, most // numbers)
        return (slice(start, start + step) for start in range(0, count, step))

    def _sizes(self) -> Floats:
        """Return for each boundary the largest length that goes into its margin."""
        sizes = np.zeros(len(self.names))
        for i, boundary in enumerate(self.boundaries):
            bodies = bounded_bodies(self.robot, boundary)
            depths = [self.robot.steps_to(body.frame) for body in bodies]
            radii = sum(max(part.radius for part in body.parts) for body in bodies)
            corners = sum(
                max(float(np.linalg.norm(p.corners, axis=-1).max()) for p in body.parts)
                for body in bodies
            )
            first = min(depths) if len(bodies) == 2 else 0
            level = boundary.offset if isinstance(boundary, HalfSpace) else _clearance(boundary)
            sizes[i] = self._poses.length(first, max(depths)) + corners + radii + abs(level)
        return sizes


def largest_speeds(robot: Robot, boundary: Boundary) -> Floats:
    """Return how fast the margin of a boundary changes at most, shape (joints,).

    The unit is a length for each unit of a joint. Seen from the nearer of two things, a turn moves
    no place of the other one faster than its distance from the joint's axis, a slide no faster than
    1. A signed distance changes by no more than a thing moves.
    """
    ends = sorted((robot.steps_to(frame), size) for frame, size in _things(robot, boundary))
    (first, _), (last, far) = ends if len(ends) == 2 else ((0, 0.0), *ends)
    lengths, speeds = step_lengths(robot), np.zeros(len(robot.joints))
    for k, step in enumerate(robot.steps[first:last], start=first):
        speeds[step.joint] += 1.0 if step.slides else sum(lengths[k + 1 : last]) + far
    if isinstance(boundary, HalfSpace):
        speeds *= float(np.linalg.norm(boundary.normal))
    return np.asarray(speeds)


def _things(robot: Robot, boundary: Boundary) -> Iterator[tuple[str, float]]:
    """Yield the frame of each thing that moves, and its farthest place from the frame's origin."""
    for body in bounded_bodies(robot, boundary):
        corners = (np.linalg.norm(part.corners, axis=-1).max() for part in body.parts)
        yield body.frame, float(max(corners))
    names: tuple[str, ...] = boundary.points if isinstance(boundary, Pair) else ()
    if isinstance(boundary, HalfSpace) and boundary.body is None:
        names = (boundary.point,)
    for point in map(robot.point, names):
        yield point.frame, float(np.linalg.norm(point.at))


def _part_pairs(robot: Robot, boundaries: Sequence[Boundary]) -> Iterator[PartPairs]:
    """Yield the pairs of parts of all pairs of bodies, those of equal frames and sizes together."""
    found = defaultdict(list)
    for i, boundary in enumerate(boundaries):
        if not isinstance(boundary, BodyPair):
            continue
        bodies = bounded_bodies(robot, boundary)
        one, other = sorted(bodies, key=lambda body: robot.steps_to(body.frame))
        frames = robot.steps_to(one.frame), robot.steps_to(other.frame)
        for (p, p_radius), (r, r_radius) in product(
            flat_parts(robot, one), flat_parts(robot, other)
        ):
            kept = p_radius + r_radius + boundary.clearance
            found[frames, len(p), len(r)].append((i, p, r, kept))
    for (frames, _, _), items in found.items():
        index, p_cores, r_cores, kepts = zip(*items, strict=True)
        kept_each = np.array(kepts, dtype=float)[:, None]
        yield _pairs(frames, np.array(index), np.array(p_cores), np.array(r_cores), kept_each)


def _pairs(
    frames: tuple[int, int], boundary: Indices, p: Floats, r: Floats, kept: Floats
) -> PartPairs:
    """Write the rows of pairs of cores, shapes (p, m, 2) and (p, k, 2), seen as `views` does."""
    seeing = [(p, r, ROWS.seen)] if p.shape[1] > 1 or r.shape[1] == 1 else []
    seeing += [(r, p, ROWS.seen_back)] if r.shape[1] > 1 else []
    across: list[Floats] = []
    along: list[Floats] = []
    half, views = [], []
    for core, corners, seen in seeing:
        of = edges(core)
        shape = (of.half.shape[1], corners.shape[1])
        for rows, direction in ((across, of.normal), (along, of.tangent)):
            level = (direction * of.middle).sum(axis=-1)[:, :, None]
            found = coordinates(direction[:, :, None], seen(ROWS.vector(corners[:, None])), level)
            rows.append(np.moveaxis(found, 0, 2).reshape(-1, len(p), POSE))
        half.append(np.repeat(of.half.T, shape[1], axis=0))
        views.append((*shape, core.shape[1] >= 3))
    (p_middle, p_reach), (r_middle, r_reach) = _disc(p), _disc(r)
    middle = ROWS.seen(ROWS.vector(r_middle))
    return PartPairs(
        frames=frames,
        boundary=boundary,
        rows=np.stack([np.concatenate(across), np.concatenate(along)]),
        half=np.concatenate(half)[..., None],
        views=tuple(views),
        kept=kept,
        middles=np.stack([coordinates(x, middle, p_middle @ x) for x in np.eye(2)]),
        reach=(p_reach + r_reach)[:, None],
    )


def _heights(robot: Robot, boundaries: Sequence[Boundary]) -> Iterator[Heights]:
    """Yield the parts of all bodies above half-spaces, those of equal frames and sizes together."""
    found = defaultdict(list)
    for i, boundary in enumerate(boundaries):
        if not isinstance(boundary, HalfSpace):
            continue
        (body,) = bounded_bodies(robot, boundary)
        normal, level = wall_of(robot, boundary, body)
        for corners, radius in flat_parts(robot, body):
            item = i, corners, normal, level + radius
            found[robot.steps_to(body.frame), len(corners)].append(item)
    for (depth, _), items in found.items():
        index, cores, normals, kepts = zip(*items, strict=True)
        seen = ROWS.seen(ROWS.vector(np.array(cores)))
        rows = coordinates(np.array(normals)[:, None], seen, np.zeros(1))
        kept_each = np.array(kepts, dtype=float)[:, None]
        by_corner = np.ascontiguousarray(np.swapaxes(rows, 0, 1))
        yield Heights((0, depth), np.array(index), by_corner, kept_each)


def _disc(cores: Floats) -> tuple[Floats, Floats]:
    """Return the middle and the radius of a disc round each core, shapes (p, 2) and (p,)."""
    middle = (cores.min(axis=1) + cores.max(axis=1)) / 2
    return middle, np.linalg.norm(cores - middle[:, None], axis=-1).max(axis=1)


def _margins_of(group: PartPairs, pairs: Indices, pose: Floats, at: Indices) -> Floats:
    """Return the margins of single pairs at single configurations, some at a time."""
    step = max(1, CACHED // (POSE * group.rows.shape[1]))
    parts = (slice(i, i + step) for i in range(0, len(pairs), step))
    found = [group.margins_of(pairs[part], pose[:, at[part]]) for part in parts]
    return np.concatenate([np.empty(0), *found])


def _lower(found: Floats, boundary: Indices, margins: Floats) -> None:
    """Replace entries of `found`, shape (boundaries, n), by smaller margins of parts."""
    first = np.flatnonzero(np.diff(boundary, prepend=-1))
    if len(first) < len(boundary):
        boundary, margins = boundary[first], np.minimum.reduceat(margins, first, axis=0)
    found[boundary] = np.minimum(found[boundary], margins)


def _clearance(boundary: Boundary) -> float:
    return boundary.clearance if isinstance(boundary, BodyPair) else 0.0


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
    pair = (0, robot.steps_to(body.frame))
    _, c, s, x, y, *_ = PlanePoses(robot).of(q[None], {pair})[pair][:, 0]
    turn = np.array([[c, s], [-s, c]])
    parts = flat_parts(robot, body)
    for i, (core, radius) in enumerate(parts):
        yield f"part {i}, " if len(parts) > 1 else "", core @ turn + [x, y], radius
