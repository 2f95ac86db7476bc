"""Signed distances of the bodies of a planar arm, at millions of configurations.

The distance of two parts is that of their cores less both radii. Where the cores overlap, it is
minus the depth. The distance of two bodies is that of their nearest parts. No form is needed, so
any number of joints will do: the rows of contact features are applied to poses in numbers.

The module also finds the nearest places of two bodies: their corners, edges and coordinates.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats, Indices
from cspace.boundary.contacts import (
    FAR_APART,
    Pairs,
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
    refuse_off_plane,
    step_lengths,
)
from cspace.forms.factors import FACTORS
from cspace.model.robot import BodyPair, Boundary, HalfSpace, Held, Pair, Robot
from cspace.order import ordered_by
from cspace.tolerances import ROUNDING

CACHED, MOST = 2**17, 2**20
"""Numbers of a block of configurations: what the passes over all of them read again stays in the
cache; where discs leave few to look at, larger blocks cost less."""

MOST_POSES = 2**12
"""Configurations of a block at most: a larger product is cut by the library over all cores, at a
cost above its own. For the same reason products go row by row."""

LINEAR = POSE - 1
"""Rows of a pose without the squared length, which no margin needs."""


class View(NamedTuple):
    """Corners of one core seen from the edges of another."""

    across: Floats
    """How far beyond the line of the edge, shape (e, k, ...)."""
    along: Floats
    """How far from the edge's middle along it, shape (e, k, ...)."""
    half: Floats
    """Half the length of the edge, shape (e, 1, ...)."""
    solid: bool
    """Whether the edges are those of a polygon, which has an inside."""

    def single(self) -> View:
        """Return the view of the first pair of cores at the first configuration."""
        across, along, half = (x[..., 0, 0] for x in (self.across, self.along, self.half))
        return View(across, along, half, self.solid)

    @property
    def squares(self) -> Floats:
        """The squared distance of each corner from each edge, shape (e, k, ...)."""
        past = np.maximum(np.abs(self.along) - self.half, 0.0)
        return np.asarray(self.across**2 + past**2)

    @property
    def gaps(self) -> Floats:
        """The gap along the normal of each edge, (e, ...); of segments the larger of both sides."""
        least: Floats = np.asarray(self.across.min(axis=1))
        return least if self.solid else np.maximum(least, -self.across.max(axis=1))


def signed(views: Sequence[View]) -> Floats:
    """Return the signed distance of two cores that see each other.

    The signed distance is the Euclidean distance of cores that are apart, zero where they touch,
    and minus the length of the shortest translation that separates cores that overlap.

    Two cores that are apart are nearest at a corner of one and an edge of the other. The shortest
    translation that separates overlapping cores is along a normal of an edge, because the edges of
    their Minkowski difference are the edges of both cores (separating axes).
    """
    depth = np.maximum.reduce([view.gaps.max(axis=0) for view in views])
    apart = depth >= 0
    if not any(view.solid for view in views):
        # Segments on one line may be apart along it although both normals show only rounding.
        for view in views:
            low, high = view.along[0].min(axis=0), view.along[0].max(axis=0)
            apart = apart | (np.maximum(low, -high) > view.half[0, 0])
    squared = np.minimum.reduce([view.squares.min(axis=(0, 1)) for view in views])
    return np.asarray(np.where(apart, np.sqrt(squared), depth))


class Seeing:
    """Edges that see corners, by the corners at which they begin; of segments one edge of the two.

    Attributes
    ----------
    edges, corners : ndarray of int, shapes (e, p) and (k, p)
        Of p cores each.
    back : bool
        Whether the edges are those of the frame that the pose moves.
    solid : bool
        Whether the edges are those of polygons.
    """

    def __init__(self, core: Indices, corners: Indices, *, back: bool) -> None:
        self.solid = len(core) > 2
        self.edges, self.corners, self.back = core if self.solid else core[:1], corners, back


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
    views : list of Seeing
        Which edges and corners the features are made of.
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
    views: list[Seeing]
    kept: Floats
    discs: Floats
    reach: Floats

    @classmethod
    def of(cls, parts: Parts, pairs: Pairs) -> PartPairs:
        """Return pairs of equal frames and numbers of corners."""
        one, other = pairs.one, pairs.other
        m, n = int(parts.count[one[0]]), int(parts.count[other[0]])
        p, r = parts.begin[one] + np.arange(m)[:, None], parts.begin[other] + np.arange(n)[:, None]
        views = [Seeing(p, r, back=False)] if m > 1 or n == 1 else []
        views += [Seeing(r, p, back=True)] if n > 1 else []
        rows, half = [], []
        for view in views:
            e, c = view.edges[:, None], view.corners[None]
            seen = ViewRows(parts.corners, parts.corners, back=view.back)
            middle = np.broadcast_to(parts.corners.reach[e] / 2, (*e.shape[:1], *c.shape[1:]))
            both = np.stack([seen.height(e, c), less(seen.ahead(e, c), middle)])
            rows.append(both.reshape(2, -1, len(one), POSE)[..., :LINEAR])
            half.append(middle.reshape(-1, len(one), 1))
        middles = parts.middle[one], parts.middle[other]
        return cls(
            frames=(int(pairs.near[0]), int(pairs.far[0])),
            boundary=pairs.boundary,
            rows=np.concatenate(rows, axis=1),
            half=np.concatenate(half),
            views=views,
            kept=pairs.keep[:, None],
            discs=squared_distance(*middles, parts.corners.axes),
            reach=(parts.reach[one] + parts.reach[other])[:, None],
        )

    @property
    def numbers(self) -> int:
        """How many numbers a configuration takes."""
        return int(self.rows.size) // LINEAR

    def margins(self, pose: Floats) -> Floats:
        """Return the margin of every pair, shape (p, n), at poses of shape (POSE, n)."""
        return np.asarray(signed(self.seen(pose)) - self.kept)

    def margins_of(self, pairs: Indices, pose: Floats) -> Floats:
        """Return the margins of single pairs, shape (e,), each at its pose, shape (POSE, e)."""
        step = max(1, CACHED // (LINEAR * self.rows.shape[1]))
        found = [np.empty(0)]
        for part in (slice(i, i + step) for i in range(0, len(pairs), step)):
            own = pairs[part]
            values = np.einsum("cfer,re->cfe", self.rows[:, :, own], pose[:LINEAR, part])
            seen = self._views(values, self.half[:, own, 0])
            found.append(signed(seen) - self.kept[own, 0])
        return np.concatenate(found)

    def seen(self, pose: Floats) -> list[View]:
        """Return what edges see of corners, at poses of shape (POSE, n)."""
        return self._views(self.rows @ pose[:LINEAR], self.half)

    def near(self, pose: Floats, at_least: Floats) -> Bools:
        """Tell which pairs may be no farther apart than `at_least`, shape (p, 1); discs suffice."""
        far = np.maximum(self.reach + self.kept + at_least, 0.0) ** 2
        rounding = FAR_APART * (self.discs[:, :1] + far + pose[-1].max(initial=0.0))
        return np.asarray((self.discs[:, None] @ pose)[:, 0] <= far + rounding)

    def _views(self, values: Floats, half: Floats) -> list[View]:
        found, start = [], 0
        for view in self.views:
            shape = len(view.edges), len(view.corners)
            end = start + shape[0] * shape[1]
            across, along = (x[start:end].reshape(*shape, *x.shape[1:]) for x in values)
            own = half[start : end : shape[1], None]
            found.append(View(across, along, own, view.solid))
            start = end
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
    def of(cls, parts: Parts, pairs: Pairs, normals: Floats) -> Heights:
        """Return corners above half-spaces, of all boundaries' normals, shape (boundaries, 2)."""
        places = parts.corners.places[parts.begin[pairs.other] + pairs.within]
        rows = above(normals[pairs.boundary], places, 0.0, parts.corners.axes)
        frames = int(pairs.near[0]), int(pairs.far[0])
        return cls(frames, pairs.boundary, rows[:, :LINEAR], pairs.keep[:, None])

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
        self.chain = PlaneChain.of(robot)
        self.pairs: list[PartPairs] = []
        self.heights: list[Heights] = []
        if boundaries:
            self.parts = Parts(robot, boundaries, self.chain.axes)
            self._group_pairs(self.parts)
        self._groups: list[PartPairs | Heights] = [*self.pairs, *self.heights]
        self.rounding = ROUNDING * self._sizes()

    def _group_pairs(self, parts: Parts) -> None:
        """Put pairs of parts of equal frames and numbers of corners together."""
        pairs, normals = parts.pairs, wall_normals(self.robot, self.boundaries)
        sizes = np.where(pairs.one < 0, 0, parts.count[np.stack([pairs.one, pairs.other])])
        keys = np.stack([pairs.near, pairs.far, *sizes])
        group = np.unique(keys, axis=1, return_inverse=True)[1].ravel()
        for number in range(group.max() + 1):
            own = pairs.some(group == number)
            if own.one[0] < 0:
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
        found = np.concatenate(list(self._told(full, at_least, whole=False)), axis=1)
        return found.T.reshape(*full.shape[:-1], len(self.names))

    def all_separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell where every margin is above `at_least`, shape (...); as `separated`, and faster."""
        full = self.robot.with_held(q, self.held)
        found = [told.all(axis=0) for told in self._told(full, at_least, whole=True)]
        return np.concatenate(found).reshape(full.shape[:-1])

    def _told(self, q: Floats, at_least: ArrayLike, whole: bool) -> Iterator[Bools]:
        """Yield which margins are above `at_least`, shape (boundaries, n), block by block.

        With `whole`, a configuration with one that is not above is not looked at again.
        """
        flat, count = q.reshape(-1, q.shape[-1]), len(self.names)
        least = np.broadcast_to(np.asarray(at_least, dtype=float), (count,))
        yield np.ones((count, 0), dtype=np.bool_)
        for part in self._blocks(len(flat), MOST):
            found = np.ones((count, len(flat[part])), dtype=np.bool_)
            self._rule_out(found, flat[part], least, whole)
            yield found

    def _rule_out(self, found: Bools, q: Floats, least: Floats, whole: bool) -> None:
        """Clear `found`, shape (boundaries, n), where a margin is at most `least`; as `_told`."""
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
                hit = group.margins_of(pair, pose[:, at]) <= least[group.boundary[pair]]
                pair, at = pair[hit], at[hit]
            found[group.boundary[pair], at] = False

    def _poses(self, q: Floats) -> dict[tuple[int, int], Floats]:
        """Return the poses of all groups, shape (POSE, n) each, at configurations (n, joints)."""
        columns, ones = np.ascontiguousarray(q.T), np.ones(len(q))
        ways = {group.frames for group in self._groups}
        joints = {m.joint for near, far in ways for m in self.chain.moves[near:far]}
        kinds = self.robot.kinds
        known = {j: FACTORS[kinds[j]].functions(columns[j]) for j in joints}
        return {way: self.chain.pose(way, ones, known) for way in ways}

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


def _lower(found: Floats, boundary: Indices, margins: Floats) -> None:
    """Replace entries of `found`, shape (boundaries, n), by smaller margins of parts."""
    first = np.flatnonzero(np.diff(boundary, prepend=-1))
    if len(first) < len(boundary):
        boundary, margins = boundary[first], np.minimum.reduceat(margins, first, axis=0)
    found[boundary] = np.minimum(found[boundary], margins)


# --- the nearest places ---------------------------------------------------------------------------


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
    separation, values = BodyMargins(robot, boundaries=[boundary]), robot.configuration(q)
    if values.ndim != 1:
        raise ValueError(f"one configuration is wanted, found the shape {values.shape}")
    known = {j: FACTORS[kind].functions(values[j, None]) for j, kind in enumerate(robot.kinds)}
    parts, rounding = separation.parts, float(separation.rounding[0])
    pairs, one = parts.pairs, np.ones(1)
    way = int(pairs.near[0]), int(pairs.far[0])
    frames = [_frame(separation.chain.pose((0, depth), one, known)) for depth in way]
    if isinstance(boundary, HalfSpace):
        at, turn = frames[1]
        corners = parts.begin[pairs.other] + pairs.within
        places = at + parts.corners.places[corners] @ turn.T
        normal = wall_normals(robot, [boundary])[0]
        heights = places @ normal - pairs.keep
        k = int(np.argmax(heights <= heights.min() + rounding))
        distance, unit = float(heights[k]), normal / np.hypot(*normal)
        low = places[k] - parts.radius[pairs.other[k]] * unit
        names, features = (str(boundary.body), boundary.name), parts.corner_names[corners[k]]
        return Nearest(names, (features, "edge"), np.array([low, low - distance * unit]), distance)
    assert isinstance(boundary, BodyPair)
    pose = separation.chain.pose(way, one, known)
    every = [pairs.some([n]) for n in range(len(pairs.keep))]
    found = [_between(boundary, parts, pair, pose, frames, rounding) for pair in every]
    return ordered_by(found, [lambda nearest: (nearest.distance, rounding)])[0]


def _between(
    boundary: BodyPair,
    parts: Parts,
    pair: Pairs,
    pose: Floats,
    frames: Sequence[tuple[Floats, Floats]],
    rounding: float,
) -> Nearest:
    """Find the nearest features of two parts."""
    own, corners = PartPairs.of(parts, pair), parts.corners
    views = [view.single() for view in own.seen(pose)]
    distance = float(signed(views))
    tries = sorted((*fit, n) for n, view in enumerate(views) for fit in _fits(view, distance))
    _, edge, corner, sense, _, n = ordered_by(tries, [lambda fit: (fit[4], rounding)])[0]
    view, seeing = views[n], own.views[n]
    e, c = int(seeing.edges[edge, 0]), int(seeing.corners[corner, 0])
    along, half, after = view.along[edge, corner], view.half[edge, 0], corners.after[e]
    if distance < 0 or abs(along) < half:
        foot = corners.places[e] + (half + along) * corners.along[e]
        feature = parts.edge_names[after if sense < 0 else e]  # a segment has two edges
    else:
        end = e if along < 0 or half == 0 else after
        foot, feature = corners.places[end], parts.corner_names[end]
    (at, turn), (other, other_turn) = frames[::-1] if seeing.back else frames
    places = np.array([at + turn @ foot, other + other_turn @ corners.places[c]])
    outward = sense * (turn @ corners.normal[e])
    if distance > 0:
        outward = (places[1] - places[0]) / distance
    radii = parts.radius[[pair.one[0], pair.other[0]]]
    places = places + np.outer((radii[::-1] if seeing.back else radii) * [1, -1], outward)
    features = feature, parts.corner_names[c]
    if seeing.back != pair.swapped[0]:
        features, places = (features[1], features[0]), places[::-1]
    return Nearest(boundary.bodies, features, places, distance - float(radii.sum()))


def _fits(view: View, distance: float) -> Iterator[tuple[bool, int, int, int, float]]:
    """Yield all pairs of an edge and a corner, and their misfit to the distance of two cores.

    Of each whether the corner's foot is beyond an edge that overlaps, edge, corner, sense, misfit.
    The sense is -1 if the corner is on the back of a segment.
    """
    sides = np.where(view.solid | (view.across >= 0), 1, -1)
    misfit, beyond = np.sqrt(view.squares) - distance, np.zeros_like(sides)
    if distance < 0:
        least, beyond = view.across.min(axis=1), np.abs(view.along) > view.half
        sides[:] = np.where(view.solid | (least == view.gaps), 1, -1)[:, None]
        across = sides * view.across
        misfit = distance - view.gaps[:, None] + across - across.min(axis=1)[:, None]
    for (edge, corner), sense in np.ndenumerate(sides):
        at = edge, corner
        yield bool(beyond[at]), edge, corner, int(sense), float(misfit[at])


def _frame(pose: Floats) -> tuple[Floats, Floats]:
    """Return origin, shape (2,), and rotation, shape (2, 2), of a pose at one configuration."""
    _, x, y, c, s, *_ = pose[:, 0]
    return np.array([x, y]), np.array([[c, -s], [s, c]])
