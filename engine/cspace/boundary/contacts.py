r"""Contact features of two bodies of a planar arm, as harmonic forms of two joints.

A core is a convex part without its radius. Two cores are more than R apart (R holds both radii and
the clearance) exactly if one of two conditions holds: all corners of one core are more than R
beyond an edge of the other; or two corners are the nearest places and more than R apart. Each
condition is made of features: an edge of one core and a corner of the other, or two corners. A
feature has one form f, positive on the free side, and at most four side conditions g. A contact is
``f = 0, all g >= 0``. These contacts together are the whole boundary of what the pair forbids.

Places are seen from the frame of the pair's first body. So only the joints between the two bodies
occur, each in the first degree.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Bools, Floats, Ints
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
)
from cspace.forms.harmonic import add_constant
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot
from cspace.tolerances import ROUNDING

Rows = tuple[Floats, Floats, Floats, Floats]
"""Forms, sides, and the errors of both."""

SIDES = 4
"""Most side conditions of one feature: two ends of an edge and two neighbours of a corner."""


Tables = Any
"""Numbers, or arrays of tables of forms, shapes (..., 3, 3)."""

# --- one feature, of numbers of any type ----------------------------------------------------------


def edge_and_corner(
    axes: Axes,
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
    height = _plus(axes.cross(along, seen), -(axes.cross(along, start) + kept))
    behind = _plus(axes.dot(along, seen), -axes.dot(along, start))
    return height, [behind, _plus(-behind, reach), *(axes.cross(along, rim) for rim in rims)]


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
    squared = _plus(squared, axes.dot(p, p) + axes.dot(u, u) - kept * kept)
    sides = [_plus(-axes.dot(step, ahead), axes.dot(step, p)) for step in steps]
    sides += [_plus(-axes.dot(step, back), axes.dot(step, u)) for step in far_steps]
    return squared, sides


def _plus(tables: Tables, constant: Tables) -> Tables:
    """Add a constant, or one for each table, to the constant coefficients of tables."""
    constant = np.asarray(constant)
    each = constant[..., 0, 0] if constant.ndim > 1 else constant
    return add_constant(tables, np.broadcast_to(each, tables.shape[:-2]))


# --- the features of two cores --------------------------------------------------------------------


def anticlockwise(corners: NDArray[Any]) -> list[int]:
    """Return the numbers of the corners of a core, shape (m, 2), in anticlockwise order."""
    numbers = list(range(len(corners)))
    x, y = (corners - corners[0]).T
    clockwise = len(corners) > 2 and float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) < 0
    return numbers[::-1] if clockwise else numbers


@dataclass(frozen=True, eq=False)
class Core:
    """A convex core in its frame's plane coordinates.

    Attributes
    ----------
    corners : ndarray, shape (m, 2)
        Anticlockwise; one is a point, two a segment, which has an edge on either side.
    corner_names, edge_names : tuple of str
        An edge has the number of the corner at which it begins.
    body : str
        Whose part it is.
    """

    corners: Floats
    corner_names: tuple[str, ...]
    edge_names: tuple[str, ...]
    body: str = ""

    @classmethod
    def of(cls, corners: Floats, part: str = "", body: str = "") -> Core:
        """Make a core of corners in either sense; corners and edges keep their numbers."""
        m, order = len(corners), anticlockwise(corners)
        clockwise = order[0] > order[-1]
        edges = [(k - 1) % m for k in order] if clockwise else order
        return cls(
            corners[order],
            tuple(f"{part}corner {k}" for k in order),
            tuple(f"{part}edge {k}" for k in edges) if m > 1 else (),
            body,
        )

    @cached_property
    def edges(self) -> tuple[Floats, Floats]:
        """The directions of its edges, unit vectors (e, 2), and their lengths (e,)."""
        ahead = np.roll(self.corners, -1, axis=0) - self.corners
        lengths = np.hypot(*ahead.T)
        count = len(self.edge_names)
        return ahead[:count] / lengths[:count, None], lengths[:count]

    @cached_property
    def disc(self) -> tuple[Floats, float]:
        """The middle, shape (2,), and the radius of a disc about it."""
        middle = (self.corners.min(axis=0) + self.corners.max(axis=0)) / 2
        return middle, float(np.hypot(*(self.corners - middle).T).max())

    @cached_property
    def size(self) -> float:
        """The largest coordinate of a corner."""
        return float(np.abs(self.corners).max())

    @cached_property
    def doubts(self) -> Floats:
        """Error of each edge's direction, (e,): largest for a short edge far from the origin."""
        return ROUNDING * (0.5 + self.size / self.edges[1])

    @cached_property
    def doubts_about(self) -> Floats:
        """The larger error of the two edges at each corner, shape (m,); see `doubts`."""
        doubts = self.doubts
        return np.maximum(doubts, np.roll(doubts, 1)) if len(doubts) else np.zeros(1)

    @cached_property
    def steps(self) -> Floats:
        """The directions from each corner to its neighbours, unit vectors (m, 2 or 0, 2)."""
        along, _ = self.edges
        if not len(along):
            return np.zeros((len(self.corners), 0, 2))
        return np.stack([along, -np.roll(along, 1, axis=0)], axis=1)


@dataclass(frozen=True, eq=False)
class Features:
    """Contact features, one in each row.

    Attributes
    ----------
    forms : ndarray, shape (f, 3, 3)
        Positive on the free side: a length, of two corners a squared length.
    sides : ndarray, shape (f, 4, 3, 3)
        Side conditions: none is negative at a contact. Missing ones are the constant 1.
    corners : ndarray of bool, shape (f,)
        Whether the feature is made of two corners.
    touching : ndarray of bool, shape (f,)
        Whether it can bound what the pair forbids; else it only parts.
    clause : ndarray of int, shape (f,)
        The separating test that it belongs to, ascending: an edge against all corners, or one pair
        of corners.
    names : tuple of str
        What touches, the first body's first: "corner 2 on edge 3".
    sizes : Sizes
        The lengths that go into them.
    relative : ndarray, shape (f,)
        Error of each form's coefficients, relative to these lengths
        (`functions.coefficient_errors`).
    side_relative : ndarray, shape (f, 4)
        The same for the side conditions; 0 for missing ones.
    curves : tuple
        One a feature; features with the same one have the same form.
    keys : tuple of tuple
        One a side condition: the event at which it vanishes on the form, see `_handovers`.
    ends : tuple of tuple
        The pair of corners, or the two pairs that an edge and a corner end at.
    discs : ndarray, shape (3, 3), optional
        A form: where it is positive, discs about both cores are apart, and so are the cores.
    """

    forms: Floats
    sides: Floats
    corners: Bools
    touching: Bools
    clause: Ints
    names: tuple[str, ...]
    sizes: Sizes
    relative: Floats
    side_relative: Floats
    curves: tuple[Hashable, ...]
    keys: tuple[tuple[tuple[Any, ...], ...], ...]
    ends: tuple[tuple[Hashable, ...], ...]
    discs: Floats | None = None


def features(
    one: Core, other: Core, moved: Pose, keep: float, sizes: Sizes, *, swapped: bool
) -> Features:
    """Return the features of two convex cores that are to keep a distance.

    Parameters
    ----------
    moved : Pose
        Of the other core's frame, seen from the first one's.
    keep : float
        Both radii plus the clearance, R; length.
    sizes : Sizes
        The lengths that go into the pose.
    swapped : bool
        Whether names begin with the other core's part.
    """
    sizes = sizes.further(one.size + other.size + keep)
    found = [
        _edges(one, other, moved.axes, moved.seen, moved.turned, keep, sizes),
        _edges(other, one, moved.axes, moved.seen_back, moved.turned_back, keep, sizes),
    ]
    names = [(a, b) for a in one.edge_names for b in other.corner_names]
    names += [(b, a) for a in other.edge_names for b in one.corner_names]
    (e, k), (j, i) = ((len(x.edge_names), len(y.corners)) for x, y in ((one, other), (other, one)))
    clause = np.concatenate([np.repeat(np.arange(e), k), np.repeat(np.arange(e, e + j), i)])
    of_edges = len(names)
    if keep > 0 or max(i, k) < 3:
        found.append(_corners(one, other, moved, keep, sizes))
        names += [(a, b) for a in one.corner_names for b in other.corner_names]
        clause = np.concatenate([clause, e + j + np.arange(i * k)])
    corners = np.arange(len(names)) >= of_edges
    # Points and segments with zero clearance add no constraint, because touching is allowed.
    forbids = keep > 0 or i + k > 3
    forms, sides, relative, side_relative = map(np.concatenate, zip(*found, strict=True))
    return Features(
        forms=forms,
        sides=sides,
        corners=corners,
        touching=(~corners | (keep > 0)) & forbids,
        clause=clause,
        names=tuple(" on ".join(pair[::-1] if swapped else pair) for pair in names),
        sizes=sizes,
        relative=relative,
        side_relative=side_relative,
        **_handovers(one, other, keep, len(names)),
        discs=_discs(one, other, moved, keep),
    )


def _discs(one: Core, other: Core, moved: Pose, keep: float) -> Floats:
    """Return the squared distance of two discs' centres less the one at which the discs touch."""
    (p, one_reach), (u, other_reach) = one.disc, other.disc
    squared, _ = two_corners(moved, p, u, (), (), one_reach + other_reach + keep)
    return np.asarray(squared)


def _handovers(one: Core, other: Core, keep: float, count: int) -> dict[str, Any]:
    """Name the curves of features, and the events at which a contact goes over to another feature.

    A contact of an edge and a corner goes over to one of two corners where the corner leaves the
    edge at one of its ends, and to one with a neighbour where two edges are parallel. Both features
    vanish there with a side condition of each, so the event has one name. Corners are named by
    their bodies and places, because parts of one outline share some. Corners of two bodies are
    not, even at one place: doubles do not tell that they are exactly there.
    """
    p, u = ([(core.body, *corner) for corner in core.corners.tolist()] for core in (one, other))
    curves: list[Hashable] = []
    keys: list[tuple[Hashable, ...]] = []
    ends: list[tuple[Hashable, ...]] = []

    def end(side: int, edge: Hashable, a: Hashable, b: Hashable) -> Hashable:
        """Name the event at which corner b of the other core leaves an edge at its end a."""
        if not keep:
            return ("end", None, a, b) if side == 0 else ("end", None, b, a)
        return ("end", side, edge, a, b)

    def edges_of(places: list[Any], core: Core) -> list[tuple[Any, Any]]:
        n = len(places)
        return [(places[k], places[(k + 1) % n]) for k in range(len(core.edge_names))]

    def around(edges: list[tuple[Any, Any]], k: int) -> list[tuple[Any, Any]]:
        return [edges[k], edges[k - 1]] if edges else []

    mine, theirs = edges_of(p, one), edges_of(u, other)
    for side, (own, near, far) in enumerate(((mine, theirs, u), (theirs, mine, p))):
        for a, b in own:
            edge = frozenset((a, b))
            for k, corner in enumerate(far):
                curves.append(("edge", side, a, b, corner, keep))
                pairs = [(x, corner) if side == 0 else (corner, x) for x in (a, b)]
                ends.append(tuple((*pair, keep) for pair in pairs))
                parallel = (
                    frozenset(((side, edge), (1 - side, frozenset(f)))) for f in around(near, k)
                )
                keys.append(
                    (
                        end(side, (a, b), a, corner),
                        end(side, (a, b), b, corner),
                        *(("parallel", f, keep) for f in parallel),
                    )
                )
    if len(curves) < count:
        for i, a in enumerate(p):
            for k, b in enumerate(u):
                curves.append(("corners", a, b, keep))
                ends.append(((a, b, keep), (a, b, keep)))
                keys.append(
                    (
                        *(end(0, f, a, b) for f in around(mine, i)),
                        *(end(1, f, b, a) for f in around(theirs, k)),
                    )
                )
    return {"curves": tuple(curves), "keys": tuple(keys), "ends": tuple(ends)}


def heights(
    core: Core, moved: Pose, normal: Floats, level: float, sizes: Sizes
) -> Iterator[Features]:
    """Yield each corner of a core above a line, ``normal . r >= level``: features without sides."""
    forms = _plus(moved.axes.dot(normal, moved.seen(_vectors(core.corners))), -level)
    sizes = sizes.further(core.size + abs(level))
    errors = np.full(1, sizes.relative(1)), np.zeros((1, SIDES))
    places = core.corners.tolist()
    for form, name, corner in zip(forms, core.corner_names, places, strict=True):
        free = np.zeros((1, SIDES, 3, 3))
        free[..., 0, 0] = 1.0
        no, clause = np.zeros(1, dtype=np.bool_), np.zeros(1, dtype=np.int64)
        curve = "height", core.body, *corner, *normal.tolist(), level
        own = ((curve,), ((),), ((),))
        yield Features(form[None], free, no, ~no, clause, (name,), sizes, *errors, *own)


def _edges(
    mine: Core,
    theirs: Core,
    axes: Axes,
    place: Callable[[Vector], Vector],
    direction: Callable[[Vector], Vector],
    keep: float,
    sizes: Sizes,
) -> Rows:
    """Forms and sides of each edge of one core with each corner of the other, seen from the one."""
    along, lengths = mine.edges
    own, start = (_vectors(x[:, None]) for x in (along, mine.corners[: len(along)]))
    reach = lengths[:, None, None, None]
    rims = [direction(_vectors(theirs.steps[:, n])) for n in range(theirs.steps.shape[1])]
    seen = place(_vectors(theirs.corners))
    height, sides = edge_and_corner(axes, own, start, reach, seen, rims, keep)
    relative = np.zeros((*height.shape[:2], SIDES))
    relative[:, :, :2] = (mine.doubts + sizes.relative(1))[:, None, None]
    both = mine.doubts[:, None] + theirs.doubts_about + sizes.relative(0)
    relative[:, :, 2 : len(sides)] = both[:, :, None]
    return (
        height.reshape(-1, 3, 3),
        _padded(sides),
        relative[:, :, 0].ravel(),
        relative.reshape(-1, SIDES),
    )


def _corners(one: Core, other: Core, moved: Pose, keep: float, sizes: Sizes) -> Rows:
    """Forms and sides of each corner of one core with each of the other."""
    p, u = _vectors(one.corners[:, None]), _vectors(other.corners)
    steps = [_vectors(one.steps[:, n, None]) for n in range(one.steps.shape[1])]
    far_steps = [_vectors(other.steps[:, n]) for n in range(other.steps.shape[1])]
    squared, sides = two_corners(moved, p, u, steps, far_steps, keep)
    shape = squared.shape[:2]
    relative, own = np.zeros((*shape, SIDES)), len(steps)
    relative[:, :, :own] = (one.doubts_about + sizes.relative(1))[:, None, None]
    relative[:, :, own : len(sides)] = (other.doubts_about + sizes.relative(1))[:, None]
    return (
        squared.reshape(-1, 3, 3),
        _padded([np.broadcast_to(side, squared.shape) for side in sides]),
        np.full(shape[0] * shape[1], sizes.relative(2)),
        relative.reshape(-1, SIDES),
    )


def _vectors(places: Floats) -> Vector:
    """Return places, shape (..., 2), as a pair of arrays that multiply tables."""
    return places[..., 0, None, None], places[..., 1, None, None]


def _padded(sides: Sequence[Floats]) -> Floats:
    """Return side conditions, up to 4 of shape (e, k, 3, 3), as (e k, 4, 3, 3), 1 for the rest."""
    e, k = sides[0].shape[:2] if sides else (1, 1)
    full = np.zeros((e, k, SIDES, 3, 3))
    full[..., 0, 0] = 1.0
    for n, side in enumerate(sides):
        full[:, :, n] = side
    return full.reshape(-1, SIDES, 3, 3)


# --- of all pairs ---------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Contacts:
    """The features of all pairs of bodies that are to keep apart, one in each row.

    Attributes
    ----------
    forms, sides, corners, clause, names, relative, side_relative
        As in `Features`; clauses and pairs are numbered through, ascending.
    pair : ndarray of int, shape (f,)
        Index of the pair of convex parts that the feature belongs to.
    touching : ndarray of bool, shape (f,)
        Whether it can bound what the pair forbids; else it only parts.
    boundaries : tuple of str
        The boundary of each pair of parts.
    curves : ndarray of int, shape (f,)
        Features with one number have one form.
    keys : ndarray of int, shape (f, 4)
        Events at which a side condition vanishes on the form. Equal numbers at one place mean one
        event. Even: an end of an edge; odd: two edges that are parallel; -1: a missing condition.
    ends : ndarray of int, shape (f, 2)
        Pairs of corners by number: for two corners the same pair twice, for an edge the pairs at
        both of its ends; -1 for a half-space.
    discs : ndarray, shape (pairs, 3, 3)
        Where a form is positive, discs about both parts are apart; for a half-space the form is -1.
    lengths : ndarray, shape (f,)
        Sum of the lengths that go into each feature.
    slides : frozenset of int
        Which of the two free joints slide.
    """

    forms: Floats
    sides: Floats
    corners: Bools
    clause: Ints
    names: tuple[str, ...]
    pair: Ints
    touching: Bools
    boundaries: tuple[str, ...]
    relative: Floats
    side_relative: Floats
    lengths: Floats
    slides: frozenset[int]
    curves: Ints
    keys: Ints
    ends: Ints
    discs: Floats

    @cached_property
    def sharp(self) -> Bools:
        """Whether nothing is kept between the cores of a feature's pair, shape (f,)."""
        rounded = np.zeros(self.pairs, dtype=np.bool_)
        rounded[self.pair[self.corners & self.touching]] = True
        return np.asarray(~rounded[self.pair])

    @cached_property
    def errors(self) -> Floats:
        """How far each coefficient of a form may be from the exact one, shape (f, 3, 3).

        The exact form is first multiplied by the positive number that makes it as large.
        """
        return coefficient_errors(1 + self.corners, self.lengths, self.relative, self.slides)

    @cached_property
    def side_errors(self) -> Floats:
        """The same for the side conditions, shape (f, 4, 3, 3); 0 for missing ones."""
        degree = np.ones((len(self.corners), SIDES), dtype=np.int64)
        degree[~self.corners, 2:] = 0  # products of two directions: no length
        lengths = self.lengths[:, None]
        return coefficient_errors(degree, lengths, self.side_relative, self.slides)

    @property
    def pairs(self) -> int:
        """Number of pairs of convex parts."""
        return len(self.boundaries)

    def without(self, dropped: Sequence[str]) -> Contacts:
        """Return the features without those of some boundaries."""
        kept = np.array([name not in dropped for name in self.boundaries], dtype=np.bool_)
        rows = np.flatnonzero(kept[self.pair])
        return Contacts(
            self.forms[rows],
            self.sides[rows],
            self.corners[rows],
            self.clause[rows],
            tuple(self.names[row] for row in rows.tolist()),
            (np.cumsum(kept) - 1)[self.pair[rows]],
            self.touching[rows],
            tuple(name for name in self.boundaries if name not in dropped),
            self.relative[rows],
            self.side_relative[rows],
            self.lengths[rows],
            self.slides,
            self.curves[rows],
            self.keys[rows],
            self.ends[rows],
            self.discs[kept],
        )


def gathered(found: Sequence[tuple[str, Features, tuple[int, int]]]) -> Contacts:
    """Gather the features of pairs of parts, each with its boundary and its frames' depths."""
    if not found:
        return NO_CONTACTS
    every = [rows for _, rows, _ in found]
    frames = [depths for _, _, depths in found]
    clauses = np.cumsum([0, *(rows.clause[-1] + 1 for rows in every)])
    numbers: dict[Hashable, int] = {}
    curves = [
        numbers.setdefault((at, curve), len(numbers))
        for at, rows in zip(frames, every, strict=True)
        for curve in rows.curves
    ]
    keys = np.full((len(curves), SIDES), -1)
    ends = np.full((len(curves), 2), -1)
    names: dict[Hashable, int] = {}
    k = 0
    for at, rows in zip(frames, every, strict=True):
        for own, pairs in zip(rows.keys, rows.ends, strict=True):
            for side, key in enumerate(own):
                number = names.setdefault((at, key), len(names))
                keys[k, side] = 2 * number + (key[0] == "parallel")
            for end, name in enumerate(pairs):
                ends[k, end] = numbers.setdefault((at, name), len(numbers))
            k += 1
    made = Contacts(
        np.concatenate([rows.forms for rows in every]),
        np.concatenate([rows.sides for rows in every]),
        np.concatenate([rows.corners for rows in every]),
        np.concatenate([rows.clause + n for rows, n in zip(every, clauses, strict=False)]),
        tuple(name for rows in every for name in rows.names),
        np.concatenate([np.full(len(rows.forms), k) for k, rows in enumerate(every)]),
        np.concatenate([rows.touching for rows in every]),
        tuple(boundary for boundary, _, _ in found),
        np.concatenate([rows.relative for rows in every]),
        np.concatenate([rows.side_relative for rows in every]),
        np.concatenate([np.full(len(rows.forms), rows.sizes.length) for rows in every]),
        frozenset().union(*(rows.sizes.slides for rows in every)),
        np.array(curves),
        keys,
        ends,
        np.array([_NEVER if rows.discs is None else rows.discs for rows in every]),
    )
    # A remainder of terms that cancel is rounding.
    forms = np.where(np.abs(made.forms) > made.errors, made.forms, 0.0)
    sides = np.where(np.abs(made.sides) > made.side_errors, made.sides, 0.0)
    return replace(made, forms=forms, sides=sides)


_NEVER = np.zeros((3, 3))
_NEVER[0, 0] = -1.0

NO_CONTACTS = Contacts(
    np.zeros((0, 3, 3)),
    np.zeros((0, SIDES, 3, 3)),
    np.zeros(0, dtype=np.bool_),
    np.zeros(0, dtype=np.int64),
    (),
    np.zeros(0, dtype=np.int64),
    np.zeros(0, dtype=np.bool_),
    (),
    np.zeros(0),
    np.zeros((0, SIDES)),
    np.zeros(0),
    frozenset(),
    np.zeros(0, dtype=np.int64),
    np.zeros((0, SIDES), dtype=np.int64),
    np.zeros((0, 2), dtype=np.int64),
    np.zeros((0, 3, 3)),
)
"""Of a robot without bodies that keep apart."""


# --- of all boundaries of a robot -----------------------------------------------------------------


Named = tuple[str, Features, tuple[int, int]]


def body_contacts(
    robot: Robot, held: Mapping[int, float], boundaries: Sequence[Boundary]
) -> Contacts:
    """Return the features of all boundaries about bodies, as forms of the two free joints.

    Parameters
    ----------
    held : mapping of int to float
        Values of all joints but two, by index; rad or length.

    Raises
    ------
    ValueError
        If the robot or a body leaves every plane.
    """
    about = [boundary for boundary in boundaries if bounds_bodies(boundary)]
    if not about:
        return gathered([])
    refuse_off_plane(robot, about)
    moves, axes = _moves(robot, held), Axes()

    @cache
    def between(near: int, far: int) -> tuple[Pose, Sizes]:
        part = moves[near:far]
        return Pose.after(part, axes, np.zeros((3, 3))), _sizes(part)

    found: list[Named] = []
    for boundary in about:
        bodies = bounded_bodies(robot, boundary)
        depths = [robot.steps_to(body.frame) for body in bodies]
        if isinstance(boundary, BodyPair):
            found += _of_pair(robot, boundary, bodies, *between(min(depths), max(depths)))
        elif isinstance(boundary, HalfSpace):
            found += _over(robot, boundary, bodies[0], *between(0, depths[0]))
    return gathered(found)


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


def _of_pair(
    robot: Robot, boundary: BodyPair, bodies: Sequence[Body], moved: Pose, sizes: Sizes
) -> Iterator[Named]:
    """Yield the features of the parts of two bodies, seen from the one nearer to the base."""
    swapped = robot.steps_to(bodies[0].frame) > robot.steps_to(bodies[1].frame)
    ordered = bodies[::-1] if swapped else bodies
    near, far = (_cores(robot, body) for body in ordered)
    depths = robot.steps_to(ordered[0].frame), robot.steps_to(ordered[1].frame)
    for (one, radius), (other, other_radius) in product(near, far):
        keep = radius + other_radius + boundary.clearance
        found = features(one, other, moved, keep, sizes, swapped=swapped)
        yield boundary.name, found, depths


def _over(robot: Robot, wall: HalfSpace, body: Body, moved: Pose, sizes: Sizes) -> Iterator[Named]:
    """Yield the corners of a body that are to stay above a half-space, each a test of its own."""
    normal = robot.plane.across @ wall.normal
    off = robot.plane.height(body.frame, body.parts[0].corners)[0]
    level = wall.offset - off * float(wall.normal @ robot.plane.normal)
    for core, radius in _cores(robot, body):
        for one in heights(core, moved, normal, level + radius, sizes):
            yield wall.name, one, (0, robot.steps_to(body.frame))


def _cores(robot: Robot, body: Body) -> list[tuple[Core, float]]:
    """Return the cores of a body's parts, anticlockwise, and their radii."""
    parts = flat_parts(robot, body)
    called = [f"part {i}, " if len(parts) > 1 else "" for i in range(len(parts))]
    return [
        (Core.of(corners, name, body.name), radius)
        for (corners, radius), name in zip(parts, called, strict=True)
    ]
