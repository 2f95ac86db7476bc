r"""Contact features of two bodies of a planar arm, as harmonic forms of the arm's joints.

A core is a convex part without its radius. Two cores are more than R apart (R holds both radii and
the clearance) exactly if one of two conditions holds: all corners of one core are more than R
beyond an edge of the other; or two corners are the nearest places and more than R apart. Each
condition is made of features: an edge of one core and a corner of the other, or two corners. A
feature has one form f, positive on the free side, and at most four side conditions g. A contact is
``f = 0, all g >= 0``. These contacts together are the whole boundary of what the pair forbids.

Each form and side condition is a row: it is linear in the pose of one core's frame, seen from the
other's (`cspace.boundary.poses`). So only the joints between the two bodies occur, each in the
first degree. Rows are written once, for numbers of any type. `body_contacts` makes the features of
all pairs at once, in doubles with bounds of their errors. `ExactContacts` makes the same features
one at a time, in rationals and balls. `exact_separations` makes those of a robot with exact numbers
and any number of joints, for proofs. Not in the paper, which knows points.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Array, Bools, Floats, Indices, Ints, cross
from cspace.boundary.functions import coefficient_errors
from cspace.boundary.poses import (
    ONE,
    POSE,
    SQUARE,
    Axes,
    PlaneChain,
    U,
    V,
    X,
    Y,
    applied,
    bounds_bodies,
    flat_parts,
    mounts,
    placed_bodies,
    projected,
    refuse_off_plane,
    wall_of,
)
from cspace.forms.bending import extremes
from cspace.forms.factors import FACTORS
from cspace.geometry.convex import exact_parts
from cspace.model.exact import rational, rationals, root, sine_cosine, written_numbers
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot, Step
from cspace.printable import printable
from cspace.tolerances import ROUNDING, ZERO_AMPLITUDE
from qbound.forms import HarmonicForm

SIDES = 4
"""Most side conditions of one feature: two ends of an edge and two neighbours of a corner."""

NEAR_EDGE, FAR_EDGE, TWO_CORNERS, HEIGHT = range(4)
"""Kinds of features: an edge of the first core and a corner of the other, the reverse, a corner of
each, and a corner above a half-space."""

# --- features of numbers of any type --------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Corners:
    """The corners of convex cores in their frames, core by core, each core anticlockwise.

    A point has one corner and no edge; a segment has two corners and an edge on either side.

    Attributes
    ----------
    axes : Axes
        Of the plane.
    places : ndarray, shape (c, 2)
    before, after : ndarray of int, shape (c,)
        The neighbours of each corner.
    along : ndarray, shape (c, 2)
        Direction of the edge that begins at each corner: of length 1 in doubles, so that heights
        are lengths; else the edge itself, so that rationals stay rational.
    tangent, normal : ndarray, shape (c, 2)
        What multiplies the coordinates of a place along this direction, and to the right of it.
    reach : ndarray, shape (c,)
        Product of this direction and the edge.
    stretched : ndarray, shape (c,)
        Length of the direction over the stretch of the axes.
    lone : ndarray of bool, shape (c,)
        Whether the core is a point.
    """

    axes: Axes
    places: Array
    before: Indices
    after: Indices
    along: Array
    tangent: Array
    normal: Array
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
            reach = (axes.along(along) * along).sum(axis=-1)
            stretched = np.array([root(square) / axes.stretch for square in reach])
        else:
            reach, stretched = np.hypot(*along.T), np.ones(len(places))
            along = (
                np.where(reach > 0, along.T, [[1.0], [0.0]]).T
                / np.where(reach > 0, reach, 1.0)[:, None]
            )
        both = axes.along(along), axes.across_of(along)
        return cls(axes, places, before, after, along, *both, reach, stretched, many == 1)


class ViewRows:
    """What the edges of cores see of the corners of other ones, as rows for a pose.

    Parameters
    ----------
    mine, theirs : Corners
        With the edges, and with the corners.
    back : bool
        Whether the edges are those of the cores that the pose moves.
    """

    def __init__(self, mine: Corners, theirs: Corners, *, back: bool) -> None:
        self.mine, self.theirs, self.back = mine, theirs, back

    def height(self, e: Ints, c: Ints) -> Array:
        """Return how far corners are over the lines of edges, times `Corners.stretched`."""
        return self._from_start(self.mine.normal[e], e, c)

    def ahead(self, e: Ints, c: Ints) -> Array:
        """Return how far corners are ahead of the starts of edges, as products with `along`."""
        return self._from_start(self.mine.tangent[e], e, c)

    def behind(self, e: Ints, c: Ints) -> Array:
        """Return how far corners are behind the ends of edges, as products with `along`."""
        return less(-self.ahead(e, c), -self.mine.reach[e])

    def rising(self, e: Ints, c: Ints) -> Array:
        """Return how the edges that begin at corners rise from the lines of edges."""
        axes, steps = self.mine.axes, self.theirs.along[c]
        rows = projected(self.mine.normal[e], steps, axes, back=self.back)
        rows[..., [X, Y, U, V]] = 0  # directions, not places
        return rows

    def _from_start(self, along: Array, e: Ints, c: Ints) -> Array:
        rows = projected(along, self.theirs.places[c], self.mine.axes, back=self.back)
        return less(rows, (along * self.mine.places[e]).sum(axis=-1))


def less(rows: Array, numbers: Any) -> Array:
    """Return rows less constants."""
    rows[..., ONE] -= numbers
    return rows


def squared_distance(p: Array, u: Array, axes: Axes) -> Array:
    """Return rows of the squared distances of places of the observer and of the moved frame."""
    along, other = axes.along(p), axes.along(u)
    rows = projected(along, u, axes) * -2
    rows[..., ONE] = (along * p).sum(axis=-1) + (other * u).sum(axis=-1)
    rows[..., [U, V]], rows[..., SQUARE] = other * 2, 1
    return rows


def core_features(
    kind: int, cores: Sequence[Corners], i: Ints, k: Ints, keep: Any
) -> tuple[Array, Bools]:
    """Return the rows of features of one kind, and which side conditions are missing.

    An edge and a corner: the form is the height of the corner over the line of the edge, times
    `Corners.stretched`, less the required distance. The corner is beside the edge where it is ahead
    of the start and behind the end; it is the nearest one where its own edges rise from the line.
    Two corners: the form is their squared distance less the squared required distance. They are the
    nearest places where neither is beside an edge at the other.

    Parameters
    ----------
    kind : int
        `NEAR_EDGE`, `FAR_EDGE` or `TWO_CORNERS`.
    cores : sequence of two Corners
        Of the observer, and of the frame that the pose moves.
    i, k : ndarray of int, shape (f,)
        Corners of both, or the corners at which an edge begins.
    keep : number, or ndarray, shape (f,)
        Required distance of the cores, R.

    Returns
    -------
    rows : ndarray, shape (f, 5, POSE)
        The form, then the four side conditions; the constant 1 for a missing one.
    missing : ndarray of bool, shape (f, 5)
        Side conditions that are not there, because a point has no neighbours.
    """
    one, other = cores
    near, far = ViewRows(one, other, back=False), ViewRows(other, one, back=True)
    missing = np.zeros((len(i), 1 + SIDES), dtype=np.bool_)
    if kind == TWO_CORNERS:
        form = less(squared_distance(one.places[i], other.places[k], one.axes), keep * keep)
        sides = [-near.ahead(i, k), -near.behind(one.before[i], k)]
        sides += [-far.ahead(k, i), -far.behind(other.before[k], i)]
        missing[:, 1:3], missing[:, 3:] = one.lone[i, None], other.lone[k, None]
    else:
        view, e, c = (near, i, k) if kind == NEAR_EDGE else (far, k, i)
        kept = keep * view.mine.stretched[e] if np.any(keep) else keep
        form, before = less(view.height(e, c), kept), view.theirs.before[c]
        sides = [view.ahead(e, c), view.behind(e, c), view.rising(e, c), -view.rising(e, before)]
        missing[:, 3:] = view.theirs.lone[c, None]
    rows = np.stack([form, *sides], axis=1)
    rows[missing] = np.eye(1, POSE, dtype=int)[0]
    return rows, missing


def above(normal: Array, places: Array, level: Any, axes: Axes) -> Array:
    """Return rows of the heights of places of the moved frame, ``normal . r - level``."""
    return less(projected(axes.along(normal), places, axes), level)


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
        event; -1: a missing condition.
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


class Pairs(NamedTuple):
    """Pairs of convex parts that keep apart, or corners of parts above half-spaces, (p,) each.

    Attributes
    ----------
    boundary : ndarray of int
    near, far : ndarray of int
        Numbers of steps to both frames, the nearer one first.
    one, other : ndarray of int
        The part of the nearer body, -1 for a half-space, and the other one.
    own, within : ndarray of int
        See `Contacts.parts`.
    keep : ndarray
        Both radii and the clearance, R; of a half-space its level and the radius.
    swapped : ndarray of bool
        Whether names begin with the other part.
    """

    boundary: Ints
    near: Ints
    far: Ints
    one: Ints
    other: Ints
    own: Ints
    within: Ints
    keep: Floats
    swapped: Bools

    def some(self, chosen: Any) -> Pairs:
        """Return some of the pairs."""
        return Pairs(*(column[chosen] for column in self))


class Parts:
    """The convex parts of the bodies of boundaries, in doubles: their corners, names and sizes."""

    def __init__(self, robot: Robot, about: Sequence[Boundary], axes: Axes) -> None:
        cores: list[Floats] = []
        self.of: dict[str, list[int]] = {}
        radii: list[float] = []
        self.corner_names: list[str] = []
        self.edge_names: list[str] = []
        places: list[tuple[str, float, float]] = []
        bodies = {body.name: body for each in about for _, body in placed_bodies(robot, each)}
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
                radii.append(radius)
                places += [(body.name, x, y) for x, y in cores[-1].tolist()]
        self.corners, self.radius = Corners.of(cores, axes), np.array(radii)
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
        rows = [row for n, each in enumerate(about) for row in self._pairs(robot, n, each)]
        self.pairs = Pairs(*map(np.array, zip(*rows, strict=True)))

    def _pairs(self, robot: Robot, number: int, boundary: Boundary) -> Iterator[tuple[Any, ...]]:
        """Yield the pairs of parts of a boundary, as `Pairs` has them."""
        depths, bodies = zip(*placed_bodies(robot, boundary), strict=True)
        parts = [enumerate(self.of[body.name]) for body in bodies]
        if isinstance(boundary, HalfSpace):
            _, level = wall_of(robot, boundary, bodies[0])
            for n, part in parts[0]:
                keep = level + self.radius[part]
                for corner in range(self.count[part]):
                    yield number, 0, depths[0], -1, part, n, corner, keep, False
        elif isinstance(boundary, BodyPair):
            swapped = bodies[0].name != boundary.bodies[0]
            for (i, one), (k, other) in product(*parts):
                keep = self.radius[one] + self.radius[other] + boundary.clearance
                yield number, *depths, one, other, i, k, keep, swapped

    def doubts(self, kind: int, i: Ints, k: Ints) -> tuple[Ints, Floats]:
        """Return degrees (5,) and errors of directions (f, 5) of a form and its side conditions."""
        corners = self.corners
        size, lone = np.repeat(self.size, self.count), corners.lone
        edge = np.where(lone, 0.0, ROUNDING * (0.5 + size / np.where(lone, 1.0, corners.reach)))
        corner = np.maximum(edge, edge[corners.before])
        if kind == TWO_CORNERS:
            own, other = corner[i], corner[k]
            return np.array([2, 1, 1, 1, 1]), np.stack([0 * own, own, own, other, other], axis=1)
        e, c = (i, k) if kind == NEAR_EDGE else (k, i)
        own, rising = edge[e], edge[e] + corner[c]
        return np.array([1, 1, 1, 0, 0]), np.stack([own, own, own, rising, rising], axis=1)


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
    chain, free = PlaneChain.of(robot), robot.free(held)
    known = {j: FACTORS[robot.joints[j].kind].functions(value) for j, value in held.items()}
    parts = Parts(robot, about, chain.axes)
    pairs = parts.pairs
    ways = sorted({*zip(pairs.near.tolist(), pairs.far.tolist(), strict=True)})
    way = np.array([ways.index(each) for each in zip(pairs.near, pairs.far, strict=True)])
    one = np.eye(1, 9).reshape(3, 3)
    poses = [chain.pose(each, one, known, free) for each in ways]
    moved = {m.joint for near, far in ways for m in chain.moves[near:far] if m.slides}
    slides = {axis for axis, joint in enumerate(free) if joint in moved}
    discs = _discs(parts, pairs, way, poses)
    if ranges is not None:
        kept = np.flatnonzero(_may_meet(discs, slides, ranges))
        pairs, discs, way = pairs.some(kept), discs[kept], way[kept]
    if not len(way):
        return NO_CONTACTS
    kind, i, k, clause, pair = _rows(parts, pairs)
    lengths = np.array([chain.length(each, known) for each in ways])[way]
    lengths += np.where(pairs.one < 0, 0.0, parts.size[pairs.one]) + parts.size[pairs.other]
    keep, length = pairs.keep[pair], (lengths + np.abs(pairs.keep))[pair]
    normals = wall_normals(robot, about)
    tables = np.tile(one, (len(kind), 1 + SIDES, 1, 1))
    errors, missing = np.zeros_like(tables), np.zeros(tables.shape[:2], dtype=np.bool_)
    for w, (near, far) in enumerate(ways):
        for own in range(4):
            at = np.flatnonzero((way[pair] == w) & (kind == own))
            if own == HEIGHT:
                rows = above(normals[i[at]], parts.corners.places[k[at]], keep[at], chain.axes)
                tables[at, 0] = applied(rows, poses[w])
                errors[at, 0] = coefficient_errors(1, length[at], far - near, slides)
            elif len(at):
                both = i[at], k[at]
                rows, missing[at] = core_features(own, [parts.corners] * 2, *both, keep[at])
                degrees, doubts = parts.doubts(own, *both)
                tables[at], sizes = applied(rows, poses[w]), length[at, None]
                errors[at] = coefficient_errors(degrees, sizes, far - near, slides, doubts)
    errors[missing] = 0.0
    tables = np.where(np.abs(tables) > errors, tables, 0.0)  # terms that cancel leave rounding
    corners, counts = kind == TWO_CORNERS, parts.count[pairs.one] + parts.count[pairs.other]
    curves, keys, ends = _handovers(parts, kind, i, k, keep, missing[:, 1:])
    return Contacts(
        forms=tables[:, 0],
        sides=tables[:, 1:],
        errors=errors[:, 0],
        side_errors=errors[:, 1:],
        corners=corners,
        # Points and segments with zero clearance add no constraint, because touching is allowed.
        touching=(kind == HEIGHT) | (keep > 0) | (~corners & (counts[pair] > 3)),
        clause=clause,
        names=_names(parts, kind, i, k, pairs.swapped[pair]),
        pair=pair,
        curves=curves,
        keys=keys,
        ends=ends,
        boundaries=tuple(about[number].name for number in pairs.boundary),
        parts=np.stack([pairs.own, pairs.within], axis=1),
        discs=discs,
    )


def wall_normals(robot: Robot, boundaries: Sequence[Boundary]) -> Floats:
    """Return normals of half-spaces in the plane, shape (boundaries, 2); 0 of other ones."""
    across = robot.plane.across
    return np.array(
        [across @ b.normal if isinstance(b, HalfSpace) else (0.0, 0.0) for b in boundaries]
    )


def _discs(parts: Parts, pairs: Pairs, way: Ints, poses: Sequence[Array]) -> Floats:
    """Return the squared distance of the centres of two discs less that at which they touch.

    It is less by what rounding may add: discs that touch always are not apart.
    """
    discs = np.zeros((len(way), 3, 3))
    discs[:, 0, 0] = -1.0
    for w, pose in enumerate(poses):
        own = np.flatnonzero((way == w) & (pairs.one >= 0))
        one, other = pairs.one[own], pairs.other[own]
        keep = parts.reach[one] + parts.reach[other] + pairs.keep[own]
        p, u = parts.middle[one], parts.middle[other]
        discs[own] = applied(less(squared_distance(p, u, parts.corners.axes), keep * keep), pose)
        squares = (p * p).sum(axis=1) + (u * u).sum(axis=1) + keep * keep
        discs[own, 0, 0] -= FAR_APART * (np.abs(pose[SQUARE]).sum() + squares)
    return discs


def _may_meet(
    discs: Floats, slides: set[int], ranges: Sequence[tuple[float, float] | None]
) -> Bools:
    """Tell which discs are not certainly apart wherever the joints are."""
    reach = [
        max(map(abs, own or (np.inf,))) if j in slides else 1.0 for j, own in enumerate(ranges)
    ]
    powers = [np.array([1.0, x, x * x if j in slides else x]) for j, x in enumerate(reach)]
    scaled = np.where(discs != 0, discs, 0.0) * np.multiply.outer(*powers)
    low, _ = extremes(scaled, (0 not in slides, 1 not in slides))
    return np.asarray(~(low > FAR_APART * np.abs(scaled).sum(axis=(1, 2))))


def _rows(parts: Parts, pairs: Pairs) -> tuple[Ints, ...]:
    """Return kind, corners i and k, clause and pair of every feature, as `feature_rows` has them.

    Corners are numbered through; of a half-space i is the number of its boundary.
    """
    found, clauses = [], 0
    begin, many = parts.begin, parts.count
    for number, (boundary, _, _, one, other, _, within, keep, _) in enumerate(
        zip(*pairs, strict=True)
    ):
        if one < 0:
            own = np.array([[HEIGHT], [boundary], [begin[other] + within], [clauses]])
        else:
            m, n = int(many[one]), int(many[other])
            own = feature_rows(m, n)
            if not keep > 0 and max(m, n) > 2:
                own = own[:, : -m * n]
            own = own + np.array([[0], [begin[one]], [begin[other]], [clauses]])
        found.append(np.vstack([own, np.full(own.shape[1], number)]))
        clauses = int(own[3, -1]) + 1
    kind, i, k, clause, pair = np.concatenate(found, axis=1)
    return kind, i, k, clause, pair


def _names(parts: Parts, kind: Ints, i: Ints, k: Ints, swapped: Bools) -> tuple[str, ...]:
    """Return what touches: "corner 2 on edge 3", or the one corner above a half-space."""
    found = []
    for own, a, b, turned in zip(*(x.tolist() for x in (kind, i, k, swapped)), strict=True):
        names = [(parts.edge_names if own == FAR_EDGE else parts.corner_names)[b]]
        if own != HEIGHT:
            names.insert(0, (parts.edge_names if own == NEAR_EDGE else parts.corner_names)[a])
        found.append(" on ".join(names[::-1] if turned else names))
    return tuple(found)


def _handovers(
    parts: Parts, kind: Ints, i: Ints, k: Ints, keep: Floats, missing: Bools
) -> tuple[Ints, Ints, Ints]:
    """Give numbers to curves, to events at which another feature takes over, and to edges' ends.

    A contact of an edge and a corner goes over to one of two corners where the corner leaves the
    edge at one of its ends, and to one with a neighbour where two edges are parallel. Both features
    vanish there with a side condition of each, so the event has one name.
    """
    before, start = parts.corners.before, parts.place
    tip, kept = start[parts.corners.after], np.unique(keep, return_inverse=True)[1]
    many = max(2, len(start), int(kept.max()) + 1)

    def code(what: int, a: Ints, b: Ints, c: Ints | int) -> Ints:
        return ((what * many + a) * many + b) * many + c

    low, high = np.minimum(start, tip), np.maximum(start, tip)
    edge = np.unique(start * many + tip, return_inverse=True)[1]
    line = np.unique(low * many + high, return_inverse=True)[1]
    curves, ends = np.empty(len(kind), dtype=np.int64), np.full((len(kind), 2), -1)
    keys = np.full((len(kind), SIDES), -1)

    def pair(near: bool, a: Ints, b: Ints, c: Ints | int, what: int = 0) -> Ints:
        return code(what, a, b, c) if near else code(what, b, a, c)

    def end(near: bool, e: Ints, c: Ints, which: int) -> Ints:
        """Name the event at which a corner of the other core leaves an edge at one end of it."""
        named = code(1 if near else 2, edge[e], start[c], which)
        return np.where(keep[r] > 0, named, pair(near, (start, tip)[which][e], start[c], 0))

    for own in (NEAR_EDGE, FAR_EDGE, TWO_CORNERS):
        r, near = np.flatnonzero(kind == own), own != FAR_EDGE
        e, c = (i[r], k[r]) if near else (k[r], i[r])
        if own == TWO_CORNERS:
            first, names = start[e], [end(True, e, c, 0), end(True, before[e], c, 1)]
            names += [end(False, c, e, 0), end(False, before[c], e, 1)]
        else:
            first, names = edge[e], [end(near, e, c, 0), end(near, e, c, 1)]
            rims = line[c], line[before[c]]
            names += [pair(near, line[e], rim, kept[r], _PARALLEL) for rim in rims]
        curves[r], last = code(own, first, start[c], kept[r]), start if own == TWO_CORNERS else tip
        ends[r] = np.stack([pair(near, at[e], start[c], kept[r]) for at in (start, last)], axis=1)
        keys[r] = np.where(missing[r], -1, np.stack(names, axis=1))
    r = np.flatnonzero(kind == HEIGHT)
    curves[r] = code(HEIGHT, i[r], start[k[r]], 0)
    return _numbered(curves), _numbered(keys), _numbered(ends)


_PARALLEL = 3
"""Kind of an event at which two edges are parallel."""


def _numbered(codes: Ints) -> Ints:
    """Return small numbers for codes, in the order in which these first appear; -1 stays."""
    _, first, inverse = np.unique(codes, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return np.where(codes < 0, -1, rank[inverse.reshape(codes.shape)])


# --- in exact numbers -----------------------------------------------------------------------------


class ExactPlane:
    """The plane of motion of a robot in exact numbers: poses of frames and cores of bodies.

    Parameters
    ----------
    steps : sequence of Step
        Of the robot's chain.
    normal : ndarray, shape (3,)
        Of the plane, of any length.
    free : sequence of int
        Joints that are not held.
    held : mapping of int to number
        Values of the others, exact or balls.
    """

    def __init__(
        self, steps: Sequence[Step], normal: Array, free: Sequence[int], held: Mapping[int, Any]
    ) -> None:
        self.axes, self._steps = Axes.exact(normal), steps
        unit = [s._replace(axis=s.axis / _length(s.axis)) if s.slides else s for s in steps]
        self._chain = PlaneChain(unit, self.axes)
        sliding, known = {step.joint for step in steps if step.slides}, dict[int, Any]()
        for joint, value in held.items():
            if joint in sliding:
                known[joint] = value, value * value
            else:
                sine, cosine = sine_cosine(value)
                known[joint] = cosine, sine / self.axes.stretch
        self.one = rationals(np.eye(1, 3 ** len(free), dtype=int).reshape((3,) * len(free)))
        self.pose = cache(lambda way: self._chain.pose(way, self.one, known, free))

    def cores(self, depth: int, body: Body, loops: Sequence[Sequence[int]]) -> list[Corners]:
        """Return convex cores of a body, each by the numbers of its places."""
        at = self._chain.flat(depth, body.shape.places)
        cores = [at[list(loop)] for loop in loops]
        return [Corners.of([core[anticlockwise(core)]], self.axes) for core in cores]

    def required(self, boundary: Boundary, placed: Sequence[tuple[int, Body]]) -> Any:
        """Return the required distance of the cores of exact bodies, or their least height."""
        radius = sum(getattr(body.shape, "radius", 0) for _, body in placed)
        if isinstance(boundary, BodyPair):
            return boundary.clearance + radius
        assert isinstance(boundary, HalfSpace)
        level = (boundary.offset + radius) * _length(boundary.normal)
        normal, mounts = self.axes.normal, self._chain.mounts
        if (share := boundary.normal @ normal) == 0:
            return level
        depth, body = placed[0]
        place = mounts[depth] @ body.shape.places[0]
        for mount, step in zip(mounts, self._steps[:depth], strict=False):
            place = place + mount @ step.origin
        return level - share / (normal @ normal) * (normal @ place)

    def features(
        self, rows: Ints, depths: tuple[int, ...], cores: Sequence[Corners], keep: Any
    ) -> Array:
        """Return forms and side conditions of features of two cores, as tables, (f, 5, ...)."""
        kinds, i, k, _ = rows
        tables = np.empty((len(kinds), 1 + SIDES, *self.one.shape), dtype=object)
        for kind in set(kinds.tolist()):
            at = kinds == kind
            found, _ = core_features(kind, cores, i[at], k[at], keep)
            tables[at] = applied(found, self.pose(depths))
        return tables

    def heights(self, wall: HalfSpace, depth: int, places: Array, level: Any) -> Array:
        """Return the heights of places of a frame over a half-space, as tables."""
        normal = self._chain.flat(0, wall.normal)
        return applied(above(normal, places, level, self.axes), self.pose((0, depth)))


def _length(direction: Array) -> Any:
    """Return the length of a direction; exactly 1 for a unit vector up to rounding."""
    square = direction @ direction
    return rational(1) if abs(float(square) - 1) <= ROUNDING else root(square)


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
        self._robot, self._contacts = robot, contacts
        self._boundaries = {boundary.name: boundary for boundary in boundaries}
        self._numbers, free = written_numbers(robot, unit=False), robot.free(held)
        joints = map(self._numbers.joint, robot.joints)
        steps = [step for j, joint in enumerate(joints) for step in joint.steps(j)]
        normal = self._normal(steps)
        way = int(np.sign(normal.astype(float) @ cross(*robot.plane.across)))
        exact = {j: rational(value) for j, value in held.items()}
        self._plane = ExactPlane(steps, normal * rational(way), free, exact)
        self._pair, self._body = cache(self._made_pair), cache(self._made_body)
        # Tables hold the coefficients of sines divided by the stretch.
        stretch = self._plane.axes.stretch
        sines = [1 / stretch if robot.joints[j].turns else 1 for j in free]
        factors = (np.array([1, 1, sine], dtype=object) for sine in sines)
        self._factor = None if stretch == 1 else np.multiply.outer(*factors)

    def feature(self, k: int) -> tuple[Array, Array]:
        """Return form (3, 3) and side conditions (4, 3, 3) of a row of the contacts."""
        contacts, plane, pair = self._contacts, self._plane, int(self._contacts.pair[k])
        boundary, depths, cores, keep = self._pair(pair)
        if isinstance(boundary, HalfSpace):
            place = cores[0].places[contacts.parts[pair, 1]]
            tables = np.stack(
                [plane.heights(boundary, depths[0], place, keep), *[plane.one] * SIDES]
            )
        else:
            first = int(np.searchsorted(contacts.pair, pair))
            rows = feature_rows(*(len(core.places) for core in cores))[:, [k - first]]
            tables = plane.features(rows, depths, cores, keep)[0]
        if self._factor is not None:
            tables = tables * self._factor
        return tables[0], tables[1:]

    def _made_pair(self, pair: int) -> tuple[Boundary, tuple[int, ...], list[Corners], Any]:
        """Return the boundary, the depths of its bodies, the cores, and what these keep."""
        own = self._boundaries[self._contacts.boundaries[pair]]
        boundary, parts = self._numbers.boundary(own), self._contacts.parts[pair].tolist()
        bodies = [
            (depth, *self._body(body.name)) for depth, body in placed_bodies(self._robot, own)
        ]
        keep = self._plane.required(boundary, [(depth, body) for depth, body, _ in bodies])
        cores = [found[part] for (_, _, found), part in zip(bodies, parts, strict=False)]
        return boundary, tuple(depth for depth, *_ in bodies), cores, keep

    def _made_body(self, name: str) -> tuple[Body, list[Corners]]:
        """Return a body with exact numbers, and its cores."""
        own = self._robot.body(name)
        body, depth = self._numbers.body(own), self._robot.steps_to(own.frame)
        return body, self._plane.cores(depth, body, own.shape.loops)

    def _normal(self, steps: Sequence[Step]) -> Array:
        """Return a normal of the plane, of any length, chosen as `plane_of_motion` does."""
        turned = zip(mounts(steps)[1:], steps, strict=True)
        axes = [(mount @ step.axis, step.slides) for mount, step in turned]
        if turning := [axis for axis, slides in axes if not slides]:
            return np.asarray(turning[0])
        slides = [axis for axis, _ in axes]
        for axis in slides[1:]:
            normal = cross(slides[0], axis)
            sizes = (slides[0] @ slides[0]) * (axis @ axis)
            if float(normal @ normal) > ZERO_AMPLITUDE**2 * float(sizes):
                return normal
        return rationals(self._robot.plane.normal)


# --- for proofs, of any number of joints ----------------------------------------------------------


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
    held = held or {}
    normal, across = _coordinate_plane(robot)
    free, cores = robot.free(held), dict[str, list[Corners]]()
    plane, kinds = (
        ExactPlane(robot.steps, normal, free, held),
        tuple(robot.joints[j].kind for j in free),
    )
    found = []
    for boundary in about:
        placed = placed_bodies(robot, boundary)
        for depth, body in placed:
            if body.name not in cores:
                cores[body.name] = plane.cores(depth, body, _exact_loops(body, across[body.frame]))
        depths, keep = tuple(depth for depth, _ in placed), plane.required(boundary, placed)
        own = [cores[body.name] for _, body in placed]
        if isinstance(boundary, HalfSpace):
            places = np.concatenate([core.places for core in own[0]])
            tests = [[plane.heights(boundary, depths[0], places, keep)]]
        else:
            # Points and segments with zero clearance add no constraint: touching is allowed.
            pairs = [p for p in product(*own) if keep > 0 or sum(len(c.places) for c in p) > 3]
            tests = [_clauses(plane, depths, pair, keep) for pair in pairs]
        for clauses in tests:
            starts = np.cumsum([0, *map(len, clauses)])[:-1]
            found.append(ExactSeparation(HarmonicForm(np.concatenate(clauses), kinds), starts))
    return tuple(found)


def _clauses(
    plane: ExactPlane, depths: tuple[int, ...], cores: Sequence[Corners], keep: Any
) -> list[Array]:
    """Return the forms of each clause of two cores, all of which are to be positive."""
    m, n = (len(core.places) for core in cores)
    rows = feature_rows(m, n)
    tables = plane.features(rows, depths, cores, keep)
    said = [0, *[1, 2][: m - 1], *[3, 4][: n - 1]]  # a segment's corner has one neighbour
    edges = rows[0] != TWO_CORNERS
    clause, corners = rows[3, edges], [own[said] for own in tables[~edges]]
    return [*(tables[edges, 0][clause == own] for own in np.unique(clause)), *corners]


def _coordinate_plane(robot: Robot) -> tuple[Array, dict[str, int]]:
    """Return the normal of the plane of motion, along an axis of the base and of each frame."""
    turned = mounts(robot.steps)
    names = [robot.base, *(step.frame for step in robot.steps)]
    axes = [mount @ step.axis for mount, step in zip(turned[1:], robot.steps, strict=True)]
    for normal in (1, 2, 0):
        across = [k for k in range(3) if k != normal]
        both = zip(axes, robot.steps, strict=True)
        gone = [axis[k] for axis, s in both for k in ([normal] if s.slides else across)]
        own = {
            name: [k for k in range(3) if all(mount[i, k] == 0 for i in across)]
            for name, mount in zip(names, turned, strict=True)
        }
        if all(x == 0 for x in gone) and all(own.values()):
            way = 1 if (across[1] - across[0]) % 3 == 1 else -1
            unit = rationals(np.eye(3, dtype=int)[normal] * way)
            return unit, {name: found[0] for name, found in own.items()}
    raise ValueError(
        "a proof about bodies needs joints that move them exactly in a plane across x, y or z"
        " of every frame; a mount in rad is rounded, one in degrees is not"
    )


def _exact_loops(body: Body, flat: int) -> Sequence[Sequence[int]]:
    """Return the corners of each convex part of a body, of which one coordinate is constant."""
    places = list(body.shape.places)
    if any(place[flat] != places[0][flat] for place in places):
        raise ValueError(f"{printable(body.name)}: its places lie in no plane of motion")
    if len(places) < 3:
        return [range(len(places))]
    return exact_parts(
        [tuple(Fraction(int(p[k].p), int(p[k].q)) for k in range(3) if k != flat) for p in places]
    )
