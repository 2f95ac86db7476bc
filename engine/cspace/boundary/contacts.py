r"""Contact features of two bodies of a planar arm, as harmonic forms of the arm's joints.

A core is a convex part without its radius. Two cores are more than R apart (R holds both radii and
the clearance) exactly if one of two conditions holds: all corners of one core are more than R
beyond an edge of the other; or two corners are the nearest places and more than R apart. Each
condition is made of features: an edge of one core and a corner of the other, or two corners. A
feature has one form f, positive on the free side, and at most four side conditions g. A contact is
``f = 0, all g >= 0``. These contacts together are the whole boundary of what the pair forbids.

Places are seen from the frame of the pair's first body. So only the joints between the two bodies
occur, each in the first degree.

Every formula is written once, for numbers of any type. `body_contacts` makes the features of all
pairs at once, in doubles with bounds of their errors. `ExactContacts` makes one of the same
features at a time, in rationals and balls. `exact_separations` makes those of a robot with exact
numbers and any number of joints, for proofs.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Array, Bools, Floats, Indices, Ints, cross
from cspace.boundary.functions import Sizes, coefficient_errors
from cspace.boundary.poses import (
    Axes,
    Move,
    Pose,
    Vector,
    bounded_bodies,
    bounds_bodies,
    flat_parts,
    flat_steps,
    refuse_off_plane,
    wall_of,
)
from cspace.forms.bending import extremes
from cspace.geometry.convex import exact_parts
from cspace.model.exact import ExactNumbers, rational, rationals, root, sine_cosine, written_numbers
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot, Step
from cspace.printable import printable
from cspace.tolerances import ROUNDING, ZERO_AMPLITUDE
from qbound.forms import HarmonicForm

SIDES = 4
"""Most side conditions of one feature: two ends of an edge and two neighbours of a corner."""

NEAR_EDGE, FAR_EDGE, TWO_CORNERS, HEIGHT = range(4)
"""Kinds of features: an edge of the first core and a corner of the other, the reverse, a corner of
each, and a corner above a half-space."""

Tables = Any
"""Arrays of tables of forms, shape (..., 3, ..., 3), with one axis for each free joint."""

# --- features of numbers of any type --------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Corners:
    """The corners of convex cores in their frames, core by core, each core anticlockwise.

    A point has one corner and no edge; a segment has two corners and an edge on either side.

    Attributes
    ----------
    places : ndarray, shape (c, 2)
        In the axes of the plane.
    before, after : ndarray of int, shape (c,)
        The neighbours of each corner.
    along : ndarray, shape (c, 2)
        Direction of the edge that begins at each corner: of length 1 in doubles, so that heights
        are lengths; else the edge itself, so that rationals stay rational.
    reach : ndarray, shape (c,)
        Product of this direction and the edge.
    stretched : ndarray, shape (c,)
        Length of the direction over the stretch of the axes.
    lone : ndarray of bool, shape (c,)
        Whether the core is a point.
    """

    places: Array
    before: Indices
    after: Indices
    along: Array
    reach: Array
    stretched: Array
    lone: Bools

    @classmethod
    def of(cls, cores: Sequence[Array], axes: Axes) -> Corners:
        """Gather the corners of cores, shape (m, 2) each."""
        counts = np.array([len(core) for core in cores])
        begin = np.repeat(np.cumsum(counts) - counts, counts)
        many, place = np.repeat(counts, counts), np.arange(counts.sum())
        before, after = (begin + (place - begin + step) % many for step in (-1, 1))
        places = np.concatenate(cores)
        along = places[after] - places
        if along.dtype == object:
            reach = axes.dot(along.T, along.T)
            stretched = np.array([root(square) / axes.stretch for square in reach])
        else:
            reach, stretched = np.hypot(*along.T), np.ones(len(places))
            along = along / np.where(many > 1, reach, 1.0)[:, None]
        return cls(places, before, after, along, reach, stretched, many == 1)

    def steps(self, k: Any) -> tuple[Array, Array]:
        """Return the directions of the edges at corners, away from them: to the next, and back."""
        return self.along[k], -self.along[self.before[k]]


def core_features(
    kind: int, moved: Pose, one: Corners, other: Corners, i: Any, k: Any, keep: Any
) -> tuple[Tables, Tables]:
    """Return forms (..., 3, 3) and side conditions (..., 4, 3, 3) of features of one kind.

    Parameters
    ----------
    kind : int
        `NEAR_EDGE`, `FAR_EDGE` or `TWO_CORNERS`.
    moved : Pose
        Of the other cores' frame, seen from the first ones'.
    i, k : int or ndarray of int, shape (...)
        Corners of both, or the corners at which an edge begins.
    keep : number, or ndarray, shape (...)
        Required distance of the cores, R.

    Returns
    -------
    forms, sides
        A height in length times `Corners.stretched`, or a squared length. The constant 1 stands for
        a missing side condition: a point has no neighbours.
    """
    pair, number = moved.vector, moved.number
    if kind == TWO_CORNERS:
        p, u = pair(one.places[i]), pair(other.places[k])
        steps, far_steps = ([pair(x) for x in y.steps(at)] for y, at in ((one, i), (other, k)))
        form, sides = two_corners(moved, p, u, steps, far_steps, number(keep))
        missing = [one.lone[i]] * 2 + [other.lone[k]] * 2
    else:
        near = kind == NEAR_EDGE
        mine, theirs, edge, corner = (one, other, i, k) if near else (other, one, k, i)
        seen, turned = (moved.seen, moved.turned) if near else (moved.seen_back, moved.turned_back)
        rims = [turned(pair(step)) for step in theirs.steps(corner)]
        kept = number(keep * mine.stretched[edge] if np.any(keep) else keep)
        along, start, place = mine.along[edge], mine.places[edge], seen(pair(theirs.places[corner]))
        reach = number(mine.reach[edge])
        form, sides = edge_and_corner(moved, pair(along), pair(start), reach, place, rims, kept)
        missing = [np.zeros_like(theirs.lone[corner])] * 2 + [theirs.lone[corner]] * 2
    found = np.stack(sides, axis=-1 - moved.joints)
    found[np.stack(missing, axis=-1)] = moved.one
    return form, found


def edge_and_corner(
    moved: Pose,
    along: Vector,
    start: Vector,
    reach: Tables,
    seen: Vector,
    rims: Sequence[Vector],
    kept: Any,
) -> tuple[Tables, list[Tables]]:
    """Return form and side conditions of an edge of one core and a corner of the other.

    The form is the height of the corner over the line of the edge, times the length of `along` over
    the stretch, less `kept`. The corner is beside the edge where it is behind the start and before
    the end; it is the nearest one where its own edges rise from it.

    Parameters
    ----------
    along : Vector
        Direction of the edge, of any length.
    start : Vector
        Corner at which the edge begins.
    reach : number
        Product of `along` and the edge.
    seen : pair of tables
        The corner of the other core, seen from the first one's frame.
    rims : sequence of pairs of tables
        Directions of its own edges, away from it.
    kept : number
        Required distance, times the factor of the height.
    """
    axes = moved.axes
    height = moved.plus(axes.cross(along, seen), -(axes.cross(along, start) + kept))
    behind = moved.plus(axes.dot(along, seen), -axes.dot(along, start))
    return height, [behind, moved.plus(-behind, reach), *(axes.cross(along, rim) for rim in rims)]


def two_corners(
    moved: Pose,
    p: Vector,
    u: Vector,
    steps: Sequence[Vector],
    far_steps: Sequence[Vector],
    kept: Any,
) -> tuple[Tables, list[Tables]]:
    """Return form and side conditions of a corner p of one core and a corner u of the other.

    The form is the squared distance of the corners less the squared required distance. The corners
    are the nearest places where each corner lies beyond the other one's edges.

    Parameters
    ----------
    steps, far_steps : sequence of Vector
        Directions of the edges at p and at u, away from it.
    kept : number
        Required distance.
    """
    axes, ahead, back = moved.axes, moved.seen(u), moved.seen_back(p)
    squared = moved.squared - axes.dot(p, ahead) * 2 + axes.dot(u, moved.back) * 2
    squared = moved.plus(squared, axes.dot(p, p) + axes.dot(u, u) - kept * kept)
    sides = [moved.plus(-axes.dot(step, ahead), axes.dot(step, p)) for step in steps]
    sides += [moved.plus(-axes.dot(step, back), axes.dot(step, u)) for step in far_steps]
    return squared, sides


@cache
def feature_rows(m: int, n: int) -> Ints:
    """Return the features of cores of m and n corners, shape (4, features).

    The rows are kind, corner or edge of the first core, the same of the other one, and clause: the
    number of the separating test, which is an edge against all corners, or one pair of corners.
    """
    e, f = (m if m > 1 else 0), (n if n > 1 else 0)
    found = [(NEAR_EDGE, i, k, i) for i in range(e) for k in range(n)]
    found += [(FAR_EDGE, i, k, e + k) for k in range(f) for i in range(m)]
    found += [(TWO_CORNERS, i, k, e + f + i * n + k) for i in range(m) for k in range(n)]
    return np.array(found, dtype=np.int64).T


def anticlockwise(corners: Array) -> list[int]:
    """Return the numbers of the corners of a core, shape (m, 2), in anticlockwise order."""
    numbers = list(range(len(corners)))
    x, y = (corners - corners[0]).T
    clockwise = len(corners) > 2 and float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) < 0
    return numbers[::-1] if clockwise else numbers


# --- in doubles, of all boundaries of a robot -----------------------------------------------------


@dataclass(frozen=True, eq=False)
class Contacts:
    """The features of all pairs of bodies that are to keep apart, one in each row.

    A corner above a half-space is a pair of its own, with one feature without side conditions.

    Attributes
    ----------
    forms : ndarray, shape (f, 3, 3)
        Positive on the free side: a length, of two corners a squared length.
    sides : ndarray, shape (f, 4, 3, 3)
        Side conditions: none is negative at a contact. Missing ones are the constant 1.
    errors, side_errors : ndarray, shapes (f, 3, 3) and (f, 4, 3, 3)
        How far each coefficient may be from the exact one, after the exact form was multiplied by
        the positive number that makes it as large; 0 for missing side conditions.
    corners : ndarray of bool, shape (f,)
        Whether the feature is made of two corners.
    touching : ndarray of bool, shape (f,)
        Whether it can bound what the pair forbids; else it only parts.
    clause : ndarray of int, shape (f,)
        The separating test that it belongs to, ascending: an edge against all corners, or one pair
        of corners.
    names : tuple of str
        What touches, in the order of the boundary's bodies: "corner 2 on edge 3".
    pair : ndarray of int, shape (f,)
        Index of the pair of convex parts that the feature belongs to, ascending.
    curves : ndarray of int, shape (f,)
        Features with one number have one form.
    keys : ndarray of int, shape (f, 4)
        Events at which a side condition vanishes on the form. Equal numbers at one place mean one
        event. Even: an end of an edge; odd: two edges that are parallel; -1: a missing condition.
    ends : ndarray of int, shape (f, 2)
        Pairs of corners by number: for two corners the same pair twice, for an edge the pairs at
        both of its ends; -1 for a half-space.
    boundaries : tuple of str
        The boundary of each pair of parts.
    parts : ndarray of int, shape (pairs, 2)
        Which part of each body, the nearer one first; of a half-space the part and the corner.
    discs : ndarray, shape (pairs, 3, 3)
        Where a form is positive, discs about both parts are apart; for a half-space the form is -1.
    """

    forms: Floats
    sides: Floats
    errors: Floats
    side_errors: Floats
    corners: Bools
    touching: Bools
    clause: Ints
    names: tuple[str, ...]
    pair: Ints
    curves: Ints
    keys: Ints
    ends: Ints
    boundaries: tuple[str, ...]
    parts: Ints
    discs: Floats

    @property
    def pairs(self) -> int:
        """Number of pairs of convex parts."""
        return len(self.boundaries)

    def without(self, dropped: Sequence[str]) -> Contacts:
        """Return the features without those of some boundaries."""
        kept = np.array([name not in dropped for name in self.boundaries], dtype=np.bool_)
        rows, pairs = np.flatnonzero(kept[self.pair]), np.flatnonzero(kept)
        of_pairs = {"boundaries", "parts", "discs"}
        less: dict[str, Any] = {}
        for field in fields(self):
            own, chosen = getattr(self, field.name), pairs if field.name in of_pairs else rows
            few = tuple(own[k] for k in chosen.tolist()) if isinstance(own, tuple) else own[chosen]
            less[field.name] = few
        return replace(self, **{**less, "pair": (np.cumsum(kept) - 1)[self.pair[rows]]})


NO_CONTACTS = Contacts(
    forms=np.zeros((0, 3, 3)),
    sides=np.zeros((0, SIDES, 3, 3)),
    errors=np.zeros((0, 3, 3)),
    side_errors=np.zeros((0, SIDES, 3, 3)),
    corners=np.zeros(0, dtype=np.bool_),
    touching=np.zeros(0, dtype=np.bool_),
    clause=np.zeros(0, dtype=np.int64),
    names=(),
    pair=np.zeros(0, dtype=np.int64),
    curves=np.zeros(0, dtype=np.int64),
    keys=np.zeros((0, SIDES), dtype=np.int64),
    ends=np.zeros((0, 2), dtype=np.int64),
    boundaries=(),
    parts=np.zeros((0, 2), dtype=np.int64),
    discs=np.zeros((0, 3, 3)),
)
"""Of a robot without bodies that keep apart."""


FAR_APART = 1e-12
"""A form of two discs above this, relative to its terms, parts the discs, whatever its rounding."""


class _Pair(NamedTuple):
    """Two convex parts that keep apart, or a corner of a part above a half-space."""

    boundary: int
    frames: tuple[int, int]
    """Numbers of steps to both frames, the nearer one first."""
    one: int
    """The part of the nearer body; -1 for a half-space."""
    other: int
    keep: float
    """Both radii and the clearance, R; of a half-space its level and the radius."""
    within: tuple[int, int]
    """See `Contacts.parts`."""
    swapped: bool = False
    """Whether names begin with the other part."""


class _Parts:
    """The convex parts of the bodies of boundaries, in doubles: their corners, names and sizes."""

    def __init__(self, robot: Robot, about: Sequence[Boundary]) -> None:
        cores: list[Floats] = []
        self.of: dict[str, list[int]] = {}
        self.radius: list[float] = []
        self.corner_names: list[str] = []
        self.edge_names: list[str] = []
        places: list[tuple[str, float, float]] = []
        bodies = {body.name: body for each in about for body in bounded_bodies(robot, each)}
        for body in bodies.values():
            found = flat_parts(robot, body)
            self.of[body.name] = list(range(len(cores), len(cores) + len(found)))
            for n, (corners, radius) in enumerate(found):
                part = f"part {n}, " if len(found) > 1 else ""
                m, order = len(corners), anticlockwise(corners)
                edges = [(k - 1) % m for k in order] if order[0] > order[-1] else order
                self.corner_names += [f"{part}corner {k}" for k in order]
                self.edge_names += [f"{part}edge {k}" for k in edges]
                cores.append(corners[order])
                self.radius.append(radius)
                places += [(body.name, x, y) for x, y in cores[-1].tolist()]
        self.corners = Corners.of(cores, Axes())
        self.count: Ints = np.array([len(core) for core in cores])
        self.begin: Ints = np.cumsum(self.count) - self.count
        self.size: Floats = np.array([np.abs(core).max() for core in cores])
        self.middle: Floats = np.array([(c.min(axis=0) + c.max(axis=0)) / 2 for c in cores])
        off = self.corners.places - np.repeat(self.middle, self.count, axis=0)
        self.reach: Floats = np.maximum.reduceat(np.hypot(*off.T), self.begin)
        # Parts of one outline share corners. Corners of two bodies differ, even at one place:
        # doubles do not tell that they are exactly there.
        numbers: dict[Hashable, int] = {}
        self.place: Ints = np.array([numbers.setdefault(p, len(numbers)) for p in places])

    @cached_property
    def doubts(self) -> tuple[Floats, Floats]:
        """Error of each edge's direction, and the larger one of both edges at each corner."""
        size, reach = np.repeat(self.size, self.count), self.corners.reach
        lone = self.corners.lone
        doubt = np.where(lone, 0.0, ROUNDING * (0.5 + size / np.where(lone, 1.0, reach)))
        return doubt, np.maximum(doubt, doubt[self.corners.before])


class _Rows(NamedTuple):
    """Features of pairs: as `feature_rows` has them, corners numbered through; pair and way."""

    kind: Ints
    i: Ints
    k: Ints
    clause: Ints
    pair: Ints
    keep: Floats


def body_contacts(
    robot: Robot,
    held: Mapping[int, float],
    boundaries: Sequence[Boundary],
    ranges: Sequence[tuple[float, float] | None] | None = None,
) -> Contacts:
    """Return the features of all boundaries about bodies, as forms of the two free joints.

    Parameters
    ----------
    held : mapping of int to float
        Values of all joints but two, by index; rad or length.
    ranges : sequence of two (low, high) or None, optional
        Ranges of the free joints. Pairs of parts are left out if discs about both are apart
        wherever the joints are.

    Raises
    ------
    ValueError
        If the robot or a body leaves every plane.
    """
    about = [boundary for boundary in boundaries if bounds_bodies(boundary)]
    if not about:
        return NO_CONTACTS
    refuse_off_plane(robot, about)
    parts = _Parts(robot, about)
    pairs = [pair for n, each in enumerate(about) for pair in _pairs(robot, n, each, parts)]
    moves = _moves(robot, held)
    ways: dict[tuple[int, int], tuple[Pose, Sizes]] = {}
    for near, far in dict.fromkeys(pair.frames for pair in pairs):
        part = moves[near:far]
        ways[near, far] = Pose.after(part, Axes(), np.zeros((3, 3))), _sizes(part)
    slides: frozenset[int] = frozenset().union(*(sizes.slides for _, sizes in ways.values()))
    discs = _discs(parts, pairs, ways)
    if ranges is not None:
        kept = np.flatnonzero(_may_meet(discs, slides, ranges))
        pairs, discs = [pairs[p] for p in kept.tolist()], discs[kept]
    if not pairs:
        return NO_CONTACTS
    rows = _rows(parts, pairs)
    forms, sides = np.empty((len(rows.kind), 3, 3)), np.zeros((len(rows.kind), SIDES, 3, 3))
    sides[..., 0, 0] = 1.0
    way = np.array([list(ways).index(pair.frames) for pair in pairs])[rows.pair]
    normals = np.array(
        [robot.plane.across @ b.normal if isinstance(b, HalfSpace) else (0, 0) for b in about]
    )
    for w, (moved, _) in enumerate(ways.values()):
        for kind in range(4):
            at = np.flatnonzero((way == w) & (rows.kind == kind))
            i, k, keep = rows.i[at], rows.k[at], rows.keep[at]
            if kind == HEIGHT:
                forms[at] = height(moved, normals[i], parts.corners.places[k], keep)
            elif len(at):
                both = parts.corners, parts.corners
                forms[at], sides[at] = core_features(kind, moved, *both, i, k, keep)
    errors, side_errors = _errors(parts, pairs, rows, [sizes for _, sizes in ways.values()], way)
    corners, plain = rows.kind == TWO_CORNERS, rows.kind == HEIGHT
    counts = np.array([parts.count[pair.one] + parts.count[pair.other] for pair in pairs])
    curves, keys, ends = _handovers(parts, rows)
    return Contacts(
        # A remainder of terms that cancel is rounding.
        forms=np.where(np.abs(forms) > errors, forms, 0.0),
        sides=np.where(np.abs(sides) > side_errors, sides, 0.0),
        errors=errors,
        side_errors=side_errors,
        corners=corners,
        # Points and segments with zero clearance add no constraint, because touching is allowed.
        touching=plain | (rows.keep > 0) | (~corners & (counts[rows.pair] > 3)),
        clause=rows.clause,
        names=_names(parts, pairs, rows),
        pair=rows.pair,
        curves=curves,
        keys=keys,
        ends=ends,
        boundaries=tuple(about[pair.boundary].name for pair in pairs),
        parts=np.array([pair.within for pair in pairs]),
        discs=discs,
    )


def height(moved: Pose, normal: Array, places: Array, level: Any) -> Tables:
    """Return the height of places of the moved frame over a line, ``normal . r >= level``."""
    heights = moved.axes.dot(moved.vector(normal), moved.seen(moved.vector(places)))
    return moved.plus(heights, -moved.number(level))


def _moves(robot: Robot, held: Mapping[int, float]) -> list[Move]:
    """Return the motion of every step in the plane, in the plane's axes at all joint values 0."""
    free, found = robot.free(held), []
    flat = zip(robot.steps, robot.plane.senses, flat_steps(robot), strict=True)
    for step, sense, (origin, along) in flat:
        if step.joint in free:
            found.append(Move(origin, sense, along, free.index(step.joint)))
        else:
            value = held[step.joint]
            turn = (np.cos(value), np.sin(value)) if sense else (value,)
            found.append(Move(origin, sense, along, None, turn))
    return found


def _sizes(moves: Sequence[Move]) -> Sizes:
    """Return the lengths that go into the pose after some moves."""
    lengths = [np.hypot(*move.origin) for move in moves]
    held = [move for move in moves if move.free is None and not move.sense]
    lengths += [abs(move.value[0]) * np.hypot(*move.along) for move in held]
    slides = frozenset(move.free for move in moves if move.free is not None and not move.sense)
    return Sizes(float(sum(lengths)), slides, len(moves))


def _pairs(robot: Robot, number: int, boundary: Boundary, parts: _Parts) -> Iterator[_Pair]:
    """Yield the pairs of parts of a boundary."""
    bodies = bounded_bodies(robot, boundary)
    depths = [robot.steps_to(body.frame) for body in bodies]
    if isinstance(boundary, HalfSpace):
        (body,) = bodies
        _, level = wall_of(robot, boundary, body)
        for n, part in enumerate(parts.of[body.name]):
            for corner in range(parts.count[part]):
                keep = level + parts.radius[part]
                yield _Pair(number, (0, depths[0]), -1, part, keep, (n, corner))
    elif isinstance(boundary, BodyPair):
        swapped = depths[0] > depths[1]
        near, far = (parts.of[body.name] for body in (bodies[::-1] if swapped else bodies))
        frames = min(depths), max(depths)
        for (i, one), (k, other) in product(enumerate(near), enumerate(far)):
            keep = parts.radius[one] + parts.radius[other] + boundary.clearance
            yield _Pair(number, frames, one, other, keep, (i, k), swapped)


def _discs(
    parts: _Parts, pairs: Sequence[_Pair], ways: Mapping[tuple[int, int], tuple[Pose, Sizes]]
) -> Floats:
    """Return the squared distance of the centres of two discs less that at which they touch.

    It is less by what rounding may add: discs that touch always are not apart.
    """
    discs = np.zeros((len(pairs), 3, 3))
    discs[:, 0, 0] = -1.0
    for frames, (moved, _) in ways.items():
        own = [n for n, pair in enumerate(pairs) if pair.frames == frames and pair.one >= 0]
        one, other = [pairs[n].one for n in own], [pairs[n].other for n in own]
        keep = parts.reach[one] + parts.reach[other] + np.array([pairs[n].keep for n in own])
        p, u = moved.vector(parts.middle[one]), moved.vector(parts.middle[other])
        discs[own], _ = two_corners(moved, p, u, (), (), moved.number(keep))
        squares = sum((parts.middle[x] ** 2).sum(axis=1) for x in (one, other)) + keep * keep
        discs[own, 0, 0] -= FAR_APART * (np.abs(moved.squared).sum() + squares)
    return discs


def _may_meet(
    discs: Floats, slides: frozenset[int], ranges: Sequence[tuple[float, float] | None]
) -> Bools:
    """Tell which discs are not certainly apart wherever the joints are."""
    reach = [
        max(map(abs, own or (np.inf,))) if j in slides else 1.0 for j, own in enumerate(ranges)
    ]
    powers = [np.array([1.0, x, x * x if j in slides else x]) for j, x in enumerate(reach)]
    scaled = np.where(discs != 0, discs, 0.0) * np.multiply.outer(*powers)
    low, _ = extremes(scaled, (0 not in slides, 1 not in slides))
    return np.asarray(~(low > FAR_APART * np.abs(scaled).sum(axis=(1, 2))))


def _rows(parts: _Parts, pairs: Sequence[_Pair]) -> _Rows:
    """Return the features of pairs."""
    found, clauses = [], 0
    for pair in pairs:
        begin = int(parts.begin[pair.other])
        if pair.one < 0:
            own = np.array([[HEIGHT], [pair.boundary], [begin + pair.within[1]], [clauses]])
        else:
            m, n = int(parts.count[pair.one]), int(parts.count[pair.other])
            own = feature_rows(m, n)
            if not pair.keep > 0 and max(m, n) > 2:
                own = own[:, : -m * n]
            own = own + np.array([[0], [parts.begin[pair.one]], [begin], [clauses]])
        found.append(own)
        clauses = int(own[3, -1]) + 1
    pair_of = np.repeat(np.arange(len(pairs)), [own.shape[1] for own in found])
    keep = np.array([pair.keep for pair in pairs])[pair_of]
    kind, i, k, clause = np.concatenate(found, axis=1)
    return _Rows(kind, i, k, clause, pair_of, keep)


def _errors(
    parts: _Parts, pairs: Sequence[_Pair], rows: _Rows, sizes: Sequence[Sizes], way: Ints
) -> tuple[Floats, Floats]:
    """Return bounds of the errors of forms and of side conditions; see `Contacts`."""
    kind, i, k, *_ = rows
    near, corners = kind == NEAR_EDGE, kind == TWO_CORNERS
    edges = near | (kind == FAR_EDGE)
    first = np.where(kind == HEIGHT, k, i)  # a half-space has no corners
    edge, corner = np.where(near, first, k), np.where(near, k, first)
    degrees = np.array([[own.relative(degree) for own in sizes] for degree in range(3)])
    zeroth, linear, square = degrees[:, way]
    direction, about = parts.doubts
    relative = np.where(corners, square, linear + np.where(edges, direction[edge], 0.0))
    sides = np.zeros((len(kind), SIDES))
    sides[:, :2] = np.where(corners, about[first] + linear, direction[edge] + linear)[:, None]
    rims = direction[edge] + about[corner] + zeroth
    sides[:, 2:] = np.where(corners, about[k] + linear, rims)[:, None]
    lone = parts.corners.lone
    missing = np.stack([corners & lone[first], np.where(corners, lone[k], lone[corner])], axis=1)
    sides[np.repeat(missing, 2, axis=1) | (kind == HEIGHT)[:, None]] = 0.0
    own = [
        (parts.size[pair.one] if pair.one >= 0 else 0.0) + parts.size[pair.other] + abs(pair.keep)
        for pair in pairs
    ]
    lengths = np.array([each.length for each in sizes])[way] + np.array(own)[rows.pair]
    degree = np.ones((len(kind), SIDES), dtype=np.int64)
    degree[edges, 2:] = 0  # products of two directions: no length
    slides = frozenset[int]().union(*(each.slides for each in sizes))
    errors = coefficient_errors(1 + corners, lengths, relative, slides)
    return errors, coefficient_errors(degree, lengths[:, None], sides, slides)


def _names(parts: _Parts, pairs: Sequence[_Pair], rows: _Rows) -> tuple[str, ...]:
    """Return what touches: "corner 2 on edge 3", or the one corner above a half-space."""
    found = []
    swapped = [pair.swapped for pair in pairs]
    for kind, i, k, pair in zip(
        rows.kind.tolist(), rows.i.tolist(), rows.k.tolist(), rows.pair.tolist(), strict=True
    ):
        second = (parts.edge_names if kind == FAR_EDGE else parts.corner_names)[k]
        if kind == HEIGHT:
            found.append(second)
            continue
        first = (parts.edge_names if kind == NEAR_EDGE else parts.corner_names)[i]
        found.append(f"{second} on {first}" if swapped[pair] else f"{first} on {second}")
    return tuple(found)


def _handovers(parts: _Parts, rows: _Rows) -> tuple[Ints, Ints, Ints]:
    """Give numbers to curves, to events at which another feature takes over, and to edges' ends.

    A contact of an edge and a corner goes over to one of two corners where the corner leaves the
    edge at one of its ends, and to one with a neighbour where two edges are parallel. Both features
    vanish there with a side condition of each, so the event has one name.
    """
    kind, i, k, _, _, keep = rows
    before, lone, place = parts.corners.before, parts.corners.lone, parts.place
    tip = place[parts.corners.after]
    kept = np.unique(keep, return_inverse=True)[1]
    many = max(2, len(place), int(kept.max()) + 1)

    def code(what: int, a: Ints, b: Ints, c: Ints | int) -> Ints:
        return ((what * many + a) * many + b) * many + c

    edge = np.unique(code(0, place * 0, place, tip), return_inverse=True)[1]
    low, high = np.minimum(place, tip), np.maximum(place, tip)
    line = np.unique(code(0, low * 0, low, high), return_inverse=True)[1]
    curves = np.empty(len(kind), dtype=np.int64)
    ends, keys = np.full((len(kind), 2), -1), np.full((len(kind), SIDES), -1)

    def end(own: int, from_: Ints, which: int, other: Ints, r: Ints) -> Ints:
        """Name the event at which a corner of the other core leaves an edge at one end of it."""
        at = (tip if which else place)[from_]
        pair = (at, other) if own == NEAR_EDGE else (other, at)
        named = code(1 + own, edge[from_], other, which)
        return np.where(keep[r] > 0, named, code(0, *pair, 0))

    for own in (NEAR_EDGE, FAR_EDGE):
        r = np.flatnonzero(kind == own)
        a, b = (i[r], k[r]) if own == NEAR_EDGE else (k[r], i[r])
        curves[r] = code(own, edge[a], place[b], kept[r])
        for which, at in enumerate((place[a], tip[a])):
            pair = (at, place[b]) if own == NEAR_EDGE else (place[b], at)
            ends[r, which] = code(0, *pair, kept[r])
            keys[r, which] = end(own, a, which, place[b], r)
        for n, rim in enumerate((b, before[b]), start=2):
            first, second = (a, rim) if own == NEAR_EDGE else (rim, a)
            parallel = code(_PARALLEL, line[first], line[second], kept[r])
            keys[r, n] = np.where(lone[b], -1, parallel)
    r = np.flatnonzero(kind == TWO_CORNERS)
    a, b = i[r], k[r]
    curves[r] = code(TWO_CORNERS, place[a], place[b], kept[r])
    ends[r] = code(0, place[a], place[b], kept[r])[:, None]
    for n, (own, at, other) in enumerate([(NEAR_EDGE, a, b)] * 2 + [(FAR_EDGE, b, a)] * 2):
        from_ = before[at] if n % 2 else at
        keys[r, n] = np.where(lone[at], -1, end(own, from_, n % 2, place[other], r))
    r = np.flatnonzero(kind == HEIGHT)
    curves[r] = code(HEIGHT, i[r], place[k[r]], 0)
    odd = keys // many**3 == _PARALLEL
    events = np.where(keys < 0, -1, 2 * _numbered(keys) + odd)
    return _numbered(curves), events, _numbered(ends)


_PARALLEL = 3
"""Kind of an event at which two edges are parallel."""


def _numbered(codes: Ints) -> Ints:
    """Return small numbers for codes, in the order in which these first appear; -1 stays."""
    _, first, inverse = np.unique(codes, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return np.where(codes < 0, -1, rank[inverse.reshape(codes.shape)])


# --- in exact numbers, one at a time --------------------------------------------------------------


@dataclass(frozen=True)
class PlaneAxes(Axes):
    r"""Axes of the plane of motion, turned as those of `Robot.plane` are.

    Attributes
    ----------
    first, second : ndarray, shape (3,)
        Seen from the base; the second is the product of the normal and the first.
    """

    first: Any = None
    second: Any = None

    @classmethod
    def across(cls, normal: Array) -> PlaneAxes:
        """Return axes at right angles to a normal of any length."""
        base = rationals(np.eye(3, dtype=int)[int(np.argmin(np.abs(normal.astype(float))))])
        first, square = cross(base, normal), normal @ normal
        return cls(first @ first, square, root(square), first, cross(normal, first))

    def flat(self, vector: Array) -> Vector:
        """Return the plane's coordinates of a vector of the base, shape (3,)."""
        return self.first @ vector / self.size, self.second @ vector / (self.size * self.ratio)


class ExactChain:
    """The chain of a robot with exact numbers in its plane of motion; frames by the steps to them.

    Parameters
    ----------
    steps : sequence of Step
    axes : PlaneAxes
        Of the plane.
    senses : sequence of int
        +1 or -1 for a turn, from the first axis to the second or back; 0 for a slide.
    free : sequence of int
        Joints that are not held.
    held : mapping of int to number
        Values of the others, exact or balls.
    """

    def __init__(
        self,
        steps: Sequence[Step],
        axes: PlaneAxes,
        senses: Sequence[int],
        free: Sequence[int],
        held: Mapping[int, Any],
    ) -> None:
        self.axes, self._steps, self._senses = axes, steps, senses
        self._free, self._held, self._mounts = free, held, mounts(steps)
        self._poses: dict[tuple[int, int], Pose] = {}

    def flat(self, k: int, place: Array) -> Vector:
        """Return a place of a frame in the axes of the plane, turned as at all joint values 0."""
        return self.axes.flat(self._mounts[k] @ place)

    def pose(self, near: int, far: int) -> Pose:
        """Return the pose of a frame seen from one before it."""
        if (near, far) not in self._poses:
            none = np.full((3,) * len(self._free), rational(0), dtype=object)
            moves = [self._move(k) for k in range(near, far)]
            self._poses[near, far] = Pose.after(moves, self.axes, none)
        return self._poses[near, far]

    def _move(self, k: int) -> Move:
        """Return a step as it moves in the plane."""
        step, sense = self._steps[k], self._senses[k]
        origin = self.flat(k, step.origin)
        along = self.flat(k + 1, step.axis * step.sense / _length(step.axis))
        if step.joint in self._free:
            return Move(origin, sense, along, self._free.index(step.joint))
        value = self._held[step.joint]
        if not sense:
            return Move(origin, sense, along, None, (value,))
        sine, cosine = sine_cosine(value)
        return Move(origin, sense, along, None, (cosine, sine / self.axes.stretch))


def mounts(steps: Sequence[Step]) -> list[Array]:
    """Return the rotation of each frame at all joint values 0, seen from the base."""
    found = [rationals(np.eye(3, dtype=int))]
    for step in steps:
        found.append(found[-1] @ step.mount)
    return found


class ExactContacts:
    """The features of a robot's bodies by their rows, made one at a time.

    A form and its side conditions are those of the same row of `Contacts` times a positive number:
    no edge is brought to length 1, so that whole numbers stay rational. Numbers that are not
    rational are balls of the precision that is set.

    Parameters
    ----------
    robot : Robot
    held : mapping of int to number
        Values of all joints but two, by index.
    boundaries : sequence of Boundary
        The boundaries about bodies.
    contacts : Contacts
        Their features in doubles.
    """

    def __init__(
        self,
        robot: Robot,
        held: Mapping[int, Any],
        boundaries: Sequence[Boundary],
        contacts: Contacts,
    ) -> None:
        self._robot, self._held, self._contacts = robot, held, contacts
        self._boundaries = {boundary.name: boundary for boundary in boundaries}
        self._cores: dict[str, tuple[Any, list[Corners]]] = {}
        self._pairs: dict[int, tuple[int, Pose, Any, Any, Any]] = {}

    def feature(self, k: int) -> tuple[Array, Array]:
        """Return form (3, 3) and side conditions (4, 3, 3) of a row of the contacts."""
        pair = int(self._contacts.pair[k])
        if pair not in self._pairs:
            self._pairs[pair] = self._pair(pair)
        first, moved, one, other, keep = self._pairs[pair]
        if isinstance(one, Corners):
            rows = feature_rows(len(one.places), len(other.places))
            kind, i, j, _ = rows[:, k - first].tolist()
            form, sides = core_features(kind, moved, one, other, i, j, keep)
        else:
            form, sides = height(moved, one, other, keep), np.stack([moved.one] * SIDES)
        if self._factor is None:
            return form, sides
        return form * self._factor, sides * self._factor

    def _pair(self, pair: int) -> tuple[int, Pose, Any, Any, Any]:
        """Return the first row of a pair, the pose, both cores, and the required distance.

        Of a half-space the normal and the corner stand for the cores, the level for the distance.
        """
        contacts, robot = self._contacts, self._robot
        first, name = int(np.searchsorted(contacts.pair, pair)), contacts.boundaries[pair]
        boundary, (a, b) = self._boundaries[name], contacts.parts[pair].tolist()
        exact: Any = self._numbers.boundary(boundary)
        bodies = sorted(bounded_bodies(robot, boundary), key=lambda b: robot.steps_to(b.frame))
        depths, cores = [robot.steps_to(body.frame) for body in bodies], map(self._cores_of, bodies)
        if isinstance(boundary, HalfSpace):
            ((radius, own),) = cores
            level = (exact.offset + radius) * _length(exact.normal)
            normal = np.array(self._chain.flat(0, exact.normal))
            return first, self._chain.pose(0, depths[0]), normal, own[a].places[b], level
        (radius, near), (far_radius, far) = cores
        keep = radius + far_radius + exact.clearance
        return first, self._chain.pose(depths[0], depths[1]), near[a], far[b], keep

    @cached_property
    def _factor(self) -> Array | None:
        """What tables lack: the coefficients of sines are divided by the stretch; None for 1."""
        stretch, unit = self._chain.axes.stretch, rational(1)
        if stretch == 1:
            return None
        turns = [self._robot.joints[j].turns for j in self._robot.free(self._held)]
        one, other = (np.array([unit, unit, 1 / stretch if turn else unit]) for turn in turns)
        return np.asarray(np.multiply.outer(one, other))

    @cached_property
    def _numbers(self) -> ExactNumbers:
        return written_numbers(self._robot, unit=False)

    @cached_property
    def _steps(self) -> list[Step]:
        """The steps of the chain with exact numbers."""
        joints = map(self._numbers.joint, self._robot.joints)
        return [step for j, joint in enumerate(joints) for step in joint.steps(j)]

    @cached_property
    def _chain(self) -> ExactChain:
        """The chain in axes of the plane, turned as those of the robot's plane in floats."""
        plane, free = self._robot.plane, self._robot.free(self._held)
        normal = self._normal()
        way = np.sign(normal.astype(float) @ cross(*plane.across))
        axes = PlaneAxes.across(normal * rational(int(way)))
        held = {j: rational(value) for j, value in self._held.items()}
        return ExactChain(self._steps, axes, plane.senses, free, held)

    def _normal(self) -> Array:
        """Return a normal of the plane, of any length, chosen as `plane_of_motion` does."""
        turned = zip(mounts(self._steps)[1:], self._steps, strict=True)
        axes = [mount @ step.axis for mount, step in turned]
        turning = [axis for axis, step in zip(axes, self._steps, strict=True) if not step.slides]
        if turning:
            return np.asarray(turning[0])
        for axis in axes[1:]:
            normal = cross(axes[0], axis)
            sizes = (axes[0] @ axes[0]) * (axis @ axis)
            if float(normal @ normal) > ZERO_AMPLITUDE**2 * float(sizes):
                return normal
        return rationals(self._robot.plane.normal)

    def _cores_of(self, body: Body) -> tuple[Any, list[Corners]]:
        """Return the radius and the convex cores of a body."""
        if body.name not in self._cores:
            shape, frame = self._numbers.body(body).shape, self._robot.steps_to(body.frame)
            at = np.array([self._chain.flat(frame, p) for p in shape.places], dtype=object)
            cores = [at[list(loop)] for loop in body.shape.loops]
            made = [Corners.of([core[anticlockwise(core)]], self._chain.axes) for core in cores]
            self._cores[body.name] = getattr(shape, "radius", rational(0)), made
        return self._cores[body.name]


def _length(direction: Array) -> Any:
    """Return the length of a direction; exactly 1 for a unit vector up to rounding."""
    square = direction @ direction
    return rational(1) if abs(float(square) - 1) <= ROUNDING else root(square)


# --- in exact numbers, of any number of joints, for proofs ----------------------------------------


@dataclass(frozen=True, eq=False)
class ExactSeparation:
    """The features of two convex parts, or the corners of a body above a half-space.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        Coefficients (dtype object) are rationals or balls.
    starts : ndarray of int, shape (features,)
        First form of each feature; a feature separates where all of its forms are positive.
    """

    forms: HarmonicForm
    starts: Indices


def exact_separations(
    robot: Robot, boundaries: Sequence[Boundary], held: Mapping[int, Any] | None = None
) -> tuple[ExactSeparation, ...]:
    """Return the separating tests of the bodies that boundaries are about; not in the paper.

    A cell of joint values is feasible where some feature's forms are all positive throughout, and
    infeasible where every feature has a form that is negative throughout.

    Parameters
    ----------
    robot : Robot
        A robot from `exact_robot`.
    held : mapping of int to ball, optional
        Values of joints that are held, rad or length.

    Raises
    ------
    ValueError
        If an outline cannot be cut into convex parts, or the joints do not move the bodies exactly
        in one plane across an axis of the base and of their frames.
    """
    about = [boundary for boundary in boundaries if bounds_bodies(boundary)]
    if not about:
        return ()
    chain = _CoordinatePlane(robot, held or {})
    bodies = {body.name: body for each in about for body in bounded_bodies(robot, each)}
    cores = {name: list(_exact_cores(body, robot, chain)) for name, body in bodies.items()}
    found = []
    for boundary in about:
        for tests in _tests(boundary, robot, chain, cores):
            forms = np.array([form for test in tests for form in test])
            starts = np.cumsum([0, *map(len, tests)])[:-1]
            found.append(ExactSeparation(HarmonicForm(forms, chain.kinds), starts))
    return tuple(found)


_Tests = list[list[Array]]
"""The forms of each clause, all of which are to be positive."""


def _tests(
    boundary: Boundary,
    robot: Robot,
    chain: _CoordinatePlane,
    cores: Mapping[str, Sequence[Corners]],
) -> Iterator[_Tests]:
    """Yield the tests of each pair of parts of a boundary, or of a body above a half-space."""
    bodies = sorted(bounded_bodies(robot, boundary), key=lambda b: robot.steps_to(b.frame))
    depths = [robot.steps_to(body.frame) for body in bodies]
    radius = sum(map(_exact_radius, bodies))
    if isinstance(boundary, HalfSpace):
        (body,), moved = bodies, chain.pose(0, depths[0])
        above = chain.above(body.frame, body.shape.places[0], boundary.normal)
        places = np.concatenate([core.places for core in cores[body.name]])
        normal = np.array(chain.flat(0, boundary.normal))
        yield [list(height(moved, normal, places, boundary.offset + radius - above))]
    elif isinstance(boundary, BodyPair):
        keep, moved = boundary.clearance + radius, chain.pose(depths[0], depths[1])
        for near, far in product(*(cores[body.name] for body in bodies)):
            # Points and segments with zero clearance add no constraint: touching is allowed.
            if keep > 0 or len(near.places) + len(far.places) > 3:
                yield _of_cores(moved, near, far, keep)


def _of_cores(moved: Pose, near: Corners, far: Corners, keep: Any) -> _Tests:
    """Return the tests of all features of two cores."""
    m, n = len(near.places), len(far.places)
    kind, i, k, clause = feature_rows(m, n)
    made = [
        core_features(own, moved, near, far, i[kind == own], k[kind == own], keep)
        for own in np.unique(kind)
    ]
    forms, sides = (np.concatenate(each) for each in zip(*made, strict=True))
    said = [0, 1][: m - 1] + [2, 3][: n - 1]  # a segment's corner has one neighbour
    two = kind == TWO_CORNERS
    tests = [list(forms[clause == own]) for own in np.unique(clause[~two])]
    return tests + [[form, *own[said]] for form, own in zip(forms[two], sides[two], strict=True)]


def _exact_radius(body: Body) -> Any:
    return body.parts[0].radius if len(body.shape.places) < 3 else 0


class _CoordinatePlane(ExactChain):
    """The chain of an exact robot in its plane of motion, which lies across an axis of the base.

    Attributes
    ----------
    kinds : tuple of {"revolute", "prismatic"}
        Kinds of the joints that are not held.
    own : dict of str to int
        The coordinate of each frame that is across the plane.
    """

    def __init__(self, robot: Robot, held: Mapping[int, Any]) -> None:
        free, self._robot, self._turned = robot.free(held), robot, mounts(robot.steps)
        self.kinds = tuple(robot.joints[j].kind for j in free)
        turned = zip(self._turned[1:], robot.steps, strict=True)
        axes = [mount @ step.axis for mount, step in turned]
        (i, k), self._along, self.own = self._plane(axes)
        first, second = (rationals(np.eye(3, dtype=int)[x]) for x in (i, k))
        sign = 1 if (k - i) % 3 == 1 else -1  # of e_i x e_k
        senses = [
            0 if step.slides else int(np.sign(float(axis[self._along]))) * step.sense * sign
            for step, axis in zip(robot.steps, axes, strict=True)
        ]
        super().__init__(robot.steps, PlaneAxes(first=first, second=second), senses, free, held)
        self._above = [rational(0)]
        for before, step in zip(self._turned, robot.steps, strict=False):
            self._above.append(self._above[-1] + (before @ step.origin)[self._along])

    def _plane(self, axes: Sequence[Array]) -> tuple[list[int], int, dict[str, int]]:
        """Return the plane's coordinates, the one across it, and that of each frame, exactly."""
        robot = self._robot
        names = [robot.base, *(step.frame for step in robot.steps)]
        for normal in (1, 2, 0):
            across = [k for k in range(3) if k != normal]
            both = zip(axes, robot.steps, strict=True)
            gone = [axis[k] for axis, s in both for k in ([normal] if s.slides else across)]
            if not all(x == 0 for x in gone):
                continue
            own = {
                name: [k for k in range(3) if all(turned[i, k] == 0 for i in across)]
                for name, turned in zip(names, self._turned, strict=True)
            }
            if all(own.values()):
                return across, normal, {name: found[0] for name, found in own.items()}
        raise ValueError(
            "a proof about bodies needs joints that move them exactly in a plane across x, y or z"
            " of every frame; a mount in rad is rounded, one in degrees is not"
        )

    def above(self, frame: str, place: Array, normal: Array) -> Any:
        """Return the part of ``normal . place`` that is across the plane."""
        k = self._robot.steps_to(frame)
        return normal[self._along] * (self._above[k] + (self._turned[k] @ place)[self._along])


def _exact_cores(body: Body, robot: Robot, chain: _CoordinatePlane) -> Iterator[Corners]:
    """Yield the convex cores of a body."""
    places, flat = list(body.shape.places), chain.own[body.frame]
    if any(place[flat] != places[0][flat] for place in places):
        raise ValueError(f"{printable(body.name)}: its places lie in no plane of motion")
    own = [tuple(_fraction(place[k]) for k in range(3) if k != flat) for place in places]
    seen = [chain.flat(robot.steps_to(body.frame), place) for place in places]
    loops = exact_parts(own) if len(places) > 2 else [list(range(len(places)))]
    order = anticlockwise(np.array([[float(x) for x in corner] for corner in seen]))
    for loop in loops:
        turned = loop[::-1] if order[0] > order[-1] else loop
        yield Corners.of([np.array([seen[k] for k in turned], dtype=object)], chain.axes)


def _fraction(x: Any) -> Fraction:
    return Fraction(int(x.p), int(x.q))
