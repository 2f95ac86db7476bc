"""Check a certificate of qbound with nothing but Python's own integers.

    python -I check.py FILE [--robot ARM.toml]
    python -I check.py FILE --print robot

A certificate claims that every configuration of a set keeps a robot clear of all that it has to
keep clear of, or that one configuration does not, or that no path leads from one configuration to
another. This file decides whether the proof holds. It imports nothing but the standard library,
uses no floating point, and can be copied and run alone. The page "The certificate" of the book
defines the format; what that page does not list is refused.

Read it from top to bottom. The first three parts are the kernel:

    numbers       whole numbers of 2^-224, and how far they can be off
    kinematics    where the frames are, where a place is, how it moves, how much its path bends
    inequality    why everything is kept, or not kept, all over a leaf
    cells         boxes and simplices, and the trees that cut them
    claims        sets, witnesses, and configurations between which no path leads
    reading       JSON, TOML, the robot and its normal form
    answer        the statement, written from what was verified, and the exit status

Exit status: 0 proved, 3 refuted, 2 anything else, 130 interrupted. 1 is never an answer, because
Python ends with 1 where a program cannot run. Python's option -I keeps the modules of other folders
away.
"""

import sys  # part of Python itself: no file stands for it, as one could for `json`

if __name__ == "__main__" and not getattr(sys.flags, "safe_path", False):
    del sys.path[0]  # this folder, whose json.py, say, would come before Python's own
if sys.version_info < (3, 11):  # noqa: UP036
    sys.stdout.write("not proved: check.py needs Python 3.11 or newer\n")
    sys.exit(2)

import hashlib
import itertools
import json
import math
import os
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from operator import lt, mul
from pathlib import Path
from typing import Any, NamedTuple

SCHEMA = "qbound/certificate/6"

Table = dict[str, Any]
Reader = Callable[[Any, str], Any]
Exact = tuple[Fraction, ...]
"""A configuration in the units of the robot file, or three coordinates."""


class Refused(ValueError):
    """The reason why a file proves nothing, in a sentence that names what and where."""


def demand(condition: object, text: str) -> None:
    """Refuse the file unless a condition holds."""
    if not condition:
        raise Refused(text)


class Work:
    """Multiplications since the check began; a file that asks for too many is refused."""

    MOST = 25_000_000
    done = 0

    @classmethod
    def add(cls, count: int) -> None:
        """Count multiplications that are about to be made."""
        cls.done += count
        demand(cls.done <= cls.MOST, "the proof asks for too much work")


# --- numbers --------------------------------------------------------------------------------------
# A number is a whole number of units of 2^-224. Lengths are parts of the largest length of the
# robot, angles are in radians. Products are rounded down, so numbers are a little off. How far?
#
# - A cosine or sine is off by less than 2^16 units (see `cos_sin`), an entry of a rotation about a
#   unit axis by less than 2^18, so a rotation moves a vector of length 1 by less than 2^20 too far.
# - Rotations do not lengthen vectors, so errors add up. At most 14 steps with 4 rotations each lie
#   between two frames: a rotated vector of length 1 is off by less than 2^26 units.
# - A place is a sum of at most 30 vectors of length 2 or less. So it is shorter than 2^6 and off by
#   less than 2^32 units, its derivatives by less than 2^34. A joint that takes any value projects
#   both on its axis, which adds as much again: with 14 of them 2^38.
# - Configurations are rounded to units. Middles of edges are too, so after 120 cuts the parts of a
#   cell may miss a part of it by 60 units.
# - A joint moves by less than 2^9 within a leaf. In the inequality at most 14 derivatives occur,
#   each times such a step, and in the bend two steps: an error of less than 2^60 units.
#
# Each inequality has to hold with `SLACK` to spare, which is 16 times more. `>>` binds less than
# `+` and `*`, so `x * y + z >> BITS` is the sum in units.

BITS = 224
ONE = 1 << BITS
SLACK = 1 << 64

NEARLY = 1 << BITS - 40
"""About 1e-12: what angles in a file that were rounded may leave of what should be 0."""

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
"""Eighty digits: the error is far below a unit."""

Vector = tuple[int, int, int]
Matrix = tuple[Vector, Vector, Vector]
"""Three columns."""


def in_units(x: Fraction) -> int:
    """Return a number in units, rounded down."""
    return (x.numerator << BITS) // x.denominator


TURN = 2 * (PI.numerator << BITS) // PI.denominator
"""A whole turn in units, rounded down."""


@lru_cache(maxsize=1000)
def cos_sin(angle: int) -> tuple[int, int]:
    """Return the cosine and the sine of an angle in radians, at most 2^10 in size.

    Whole turns are taken away, which makes an error of less than 2^8. Taylor's series at
    x = angle / 128, less than 1/16, leaves out less than a unit after 48 terms and rounds by less
    than 50. Then cos 2x = cos^2 x - sin^2 x and sin 2x = 2 sin x cos x seven times. The error of
    the vector (cos, sin) doubles each time and grows by 2; so it is less than 2^15.
    """
    Work.add(150)
    x, term, sums = angle % TURN >> 7, ONE, [0, 0, 0, 0]
    for k in range(48):
        sums[k % 4] += term
        term = (term * x >> BITS) // (k + 1)
    c, s = sums[0] - sums[2], sums[1] - sums[3]
    for _ in range(7):
        c, s = c * c - s * s >> BITS, 2 * c * s >> BITS
    return c, s


def dot(u: Vector, v: Vector) -> int:
    """Return the sum of products."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2] >> BITS


def plus(u: Vector, v: Vector) -> Vector:
    """Add vectors."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


def minus(u: Vector, v: Vector) -> Vector:
    """Subtract vectors."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


def times(x: int, u: Vector) -> Vector:
    """Multiply a vector by a number."""
    return x * u[0] >> BITS, x * u[1] >> BITS, x * u[2] >> BITS


def cross(u: Vector, v: Vector) -> Vector:
    """Return the cross product."""
    a, b, c = u
    x, y, z = v
    return b * z - c * y >> BITS, c * x - a * z >> BITS, a * y - b * x >> BITS


def size(u: Vector) -> int:
    """Return the length of a vector, rounded up."""
    return math.isqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) + 1


def image(matrix: Matrix, u: Vector) -> Vector:
    """Multiply a matrix with a vector."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = u
    return (
        a * x + d * y + g * z >> BITS,
        b * x + e * y + h * z >> BITS,
        c * x + f * y + i * z >> BITS,
    )


def product(a: Matrix, b: Matrix) -> Matrix:
    """Multiply matrices."""
    return image(a, b[0]), image(a, b[1]), image(a, b[2])


AXES: Matrix = (ONE, 0, 0), (0, ONE, 0), (0, 0, ONE)


def unit(v: Sequence[Fraction | int]) -> Vector:
    """Return a vector scaled to length 1; each coordinate is off by less than two units."""
    whole = math.lcm(*(Fraction(x).denominator for x in v))
    x, y, z = (int(x * whole) for x in v)
    length = math.isqrt((x * x + y * y + z * z) << 2 * BITS)
    return (x << 2 * BITS) // length, (y << 2 * BITS) // length, (z << 2 * BITS) // length


def rotation(axis: Vector, angle: int) -> Matrix:
    """Return the turn about a unit axis: cos v + sin (axis x v) + (1 - cos) (axis . v) axis."""
    c, s = cos_sin(angle)
    x, y, z = (
        plus(plus(times(c, e), times(s, cross(axis, e))), times(times(ONE - c, axis)[k], axis))
        for k, e in enumerate(AXES)
    )
    return x, y, z


# --- kinematics -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Step:
    """A translation, a fixed rotation, and a turn about an axis or a slide along it.

    Its value is factor * (value of its joint); factor is 1 or -1. `sweep` is at least the distance
    of a slide from the middle of its range, within its limits.
    """

    joint: int
    turns: bool
    factor: int
    origin: Vector
    mount: Matrix
    axis: Vector
    sweep: int


class Pose:
    """An arm at one configuration: its frames, and the axes of its steps, seen from the base."""

    def __init__(self, steps: Sequence[Step], q: Sequence[int]) -> None:
        Work.add(60 * len(steps))
        turned, at = AXES, (0, 0, 0)
        self.frames: list[tuple[Matrix, Vector]] = [(turned, at)]
        self.axes: list[tuple[Vector, Vector]] = []
        for step in steps:
            at = plus(at, image(turned, step.origin))
            turned = product(turned, step.mount)
            axis = image(turned, step.axis)
            self.axes.append((axis, at))
            value = step.factor * q[step.joint]
            if step.turns:
                turned = product(turned, rotation(step.axis, value))
            else:
                at = plus(at, times(value, axis))
            self.frames.append((turned, at))

    def place(self, frame: int, corner: Vector) -> Vector:
        """Return where a place of a frame is, seen from the base."""
        turned, at = self.frames[frame]
        return plus(at, image(turned, corner))


class Motion(NamedTuple):
    """Where a place is and how it moves: seen from a frame that holds still, at a leaf's middle.

    For every offset d of the joints within the leaf the place is at most `bend` + `radius` away
    from `place` + the sum of d_k `slopes[k]`, over the steps k of the arm.
    """

    place: Vector
    slopes: dict[int, Vector]
    bend: int
    radius: int


def motion(
    steps: Sequence[Step],
    pose: Pose,
    near: int,
    far: int,
    corner: Vector,
    widths: Sequence[int],
    free: Sequence[bool],
) -> Motion:
    """Follow a corner of frame `far` inwards to frame `near`, one step of the arm at a time.

    widths : for each joint at least the distance from the middle of the leaf to any place of it.
    free : for each joint whether it takes any value; `pose` has the middle of a slide's range.

    Let E_k be the motion by d_k about the axis of step k as it lies at the middle. Then the place r
    goes to E_1 ... E_n r, and this differs from r by the sum of L_1 ... L_{k-1} (E_k r - r), where
    L_i is the rotation of E_i. The chord E_k r - r is the integral of the slope s_k, turned by 0 to
    d_k, and the rotations before it turn it by up to the sum of their d_i. A vector that is turned
    by an angle moves by at most this angle times its length. So what is not linear is at most

        bend = sum over k of D_k |s_k| (sum over i < k that turn of D_i, and D_k / 2 if k turns).

    A free step that turns: it keeps what is along its axis and turns what is across it anywhere. So
    the place and each slope are replaced by their parts along the axis, and the length of what is
    across is added to `radius`. A turn of the part along is bounded as before.
    """
    Work.add(25 * (far - near + 1))
    r, slopes, radius = pose.place(far, corner), dict[int, Vector](), 0
    for k in reversed(range(near, far)):
        step, (axis, pivot) = steps[k], pose.axes[k]
        if not free[step.joint]:
            slopes[k] = cross(axis, minus(r, pivot)) if step.turns else axis
        elif not step.turns:
            radius += step.sweep
        else:
            foot = plus(pivot, times(dot(axis, minus(r, pivot)), axis))
            r, across = foot, size(minus(r, foot))
            for i, slope in slopes.items():
                slopes[i] = times(dot(axis, slope), axis)
                across += (widths[steps[i].joint] * size(minus(slope, slopes[i])) >> BITS) + 1
            radius += across
    bend = turned = 0
    for k in sorted(slopes):
        width = widths[steps[k].joint]
        own = width if steps[k].turns else 0
        bend += (width * size(slopes[k]) >> BITS) * (2 * turned + own)
        turned += own
    return Motion(r, slopes, (bend >> BITS + 1) + len(slopes) + 1, radius)


# --- the inequality -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Hull:
    """The convex hull of some corners of a frame."""

    frame: int
    corners: tuple[Vector, ...]


@dataclass(frozen=True)
class Keep:
    """Two hulls that stay more than `gap` apart, or one above a plane of the base.

    near : of the frame that is not beyond that of `far`; for a plane the origin of the base.
    asked : whether `gap`, which is rounded, stands for more than 0.
    along : the coordinate of the near frame along which both are seen; None in space.
    normal : unit vector; normal . place is at least `gap`; None for two hulls.
    """

    name: str
    near: Hull
    far: Hull
    gap: int
    asked: bool
    along: int | None
    normal: Vector | None


def is_kept(steps: Sequence[Step], pose: Pose, keep: Keep, u: Vector, cell: "Cell") -> bool:
    """Prove that something is kept all over a leaf; u is a unit vector, seen from the near frame.

    The distance of r and p is at least u . (r - p), and over the leaf u . r is at least its linear
    part less the bend. What is linear is least at a corner of the leaf, and least or largest over a
    hull at one of its corners.
    """
    Work.add(3 * len(keep.near.corners))
    matrix, at = pose.frames[keep.near.frame]
    w, none_free = image(matrix, u), [False] * len(cell.widths)
    nearest = max(dot(u, p) for p in keep.near.corners)
    for corner in keep.far.corners:
        frames = keep.near.frame, keep.far.frame
        found = motion(steps, pose, *frames, corner, cell.widths, none_free)
        slopes = [0] * len(none_free)
        for k, slope in found.slopes.items():
            slopes[steps[k].joint] += steps[k].factor * dot(w, slope)
        low = dot(w, minus(found.place, at)) + cell.least(slopes) - found.bend
        if low <= nearest + keep.gap + SLACK:
            return False
    return True


class Spots(NamedTuple):
    """A place of each hull, and the sum of the radii of discs about them that lie in the hulls."""

    near: Vector
    far: Vector
    radii: int


def is_violated(
    steps: Sequence[Step],
    pose: Pose,
    keep: Keep,
    spots: Spots,
    cell: "Cell",
    free: Sequence[bool],
) -> bool:
    """Prove that something is not kept anywhere on a leaf, whatever the free joints.

    The distance of the two places is convex in the offset from the middle, so it is largest at a
    corner of the leaf. Discs lie in planes that are parallel within `NEARLY` at joint values 0 and
    at one height within `NEARLY`, so their radii are good to the product of both, times 2^6.
    """
    frames = keep.near.frame, keep.far.frame
    found = motion(steps, pose, *frames, spots.far, cell.widths, free)
    start = minus(found.place, pose.place(keep.near.frame, spots.near))
    spare = NEARLY if spots.radii else SLACK
    allowed = keep.gap + spots.radii - found.bend - found.radius - spare
    for offset in cell.offsets({steps[k].joint for k in found.slopes}):
        Work.add(10 + 3 * len(found.slopes))
        w = start
        for k, slope in found.slopes.items():
            w = plus(w, times(steps[k].factor * offset[steps[k].joint], slope))
        if keep.along is not None:
            axis = pose.frames[keep.near.frame][0][keep.along]
            w = minus(w, times(dot(axis, w), axis))
        if (size(w) if keep.normal is None else dot(keep.normal, w)) >= allowed:
            return False
    return True


# --- cells ----------------------------------------------------------------------------------------
# Values of joints are in units too: radians, or parts of the largest length. The corners of the
# cells of a claim are rounded to units, which the slack covers. Cuts lie at whole numbers, so that
# the two halves have the same face.

Point = tuple[int, ...]


@dataclass(frozen=True)
class Box:
    """All configurations between a low and a high corner."""

    low: Point
    high: Point

    @cached_property
    def middle(self) -> Point:
        """Return the middle."""
        return tuple(a + b >> 1 for a, b in zip(self.low, self.high, strict=True))

    @cached_property
    def widths(self) -> Point:
        """Return for each joint the distance from the middle to the ends, rounded up."""
        return tuple(b - a + 1 >> 1 for a, b in zip(self.low, self.high, strict=True))

    def least(self, slopes: Sequence[int]) -> int:
        """Return the least sum of slope * offset over all corners, rounded down."""
        return -sum((abs(s) * d >> BITS) + 1 for s, d in zip(slopes, self.widths, strict=True))

    def offsets(self, joints: set[int]) -> Iterator[Point]:
        """Yield the way from the middle to each corner, as far as some joints tell them apart."""
        ends = [(d, -d) if d and j in joints else (0,) for j, d in enumerate(self.widths)]
        return itertools.product(*ends)

    def halves(self, letter: int) -> "tuple[Box, Box]":
        """Cut at the middle of a joint: the lower half and the upper one."""
        wide = letter < len(self.low) and self.low[letter] < self.high[letter]
        demand(wide, "proof: a tree cuts a joint that the box does not have, or that is held")
        cut = self.middle[letter]
        below = (*self.high[:letter], cut, *self.high[letter + 1 :])
        above = (*self.low[:letter], cut, *self.low[letter + 1 :])
        return Box(self.low, below), Box(above, self.high)


@dataclass(frozen=True)
class Simplex:
    """A segment or a triangle."""

    ends: tuple[Point, ...]

    @cached_property
    def middle(self) -> Point:
        """Return the mean of the corners, rounded."""
        return tuple(sum(column) // len(self.ends) for column in zip(*self.ends, strict=True))

    @cached_property
    def steps(self) -> list[Point]:
        """Return the way from the middle to each corner."""
        middle = self.middle
        return [tuple(x - m for x, m in zip(q, middle, strict=True)) for q in self.ends]

    @cached_property
    def widths(self) -> Point:
        """Return for each joint the largest distance of a corner from the middle."""
        return tuple(max(map(abs, column)) for column in zip(*self.steps, strict=True))

    def least(self, slopes: Sequence[int]) -> int:
        """Return the least sum of slope * offset over all corners, rounded down."""
        rises = (sum(s * d for s, d in zip(slopes, step, strict=True)) for step in self.steps)
        return min(rises) >> BITS

    def offsets(self, joints: set[int]) -> Iterator[Point]:
        """Yield the way from the middle to each corner."""
        del joints
        return iter(self.steps)

    def halves(self, letter: int) -> "tuple[Simplex, Simplex]":
        """Cut an edge at its middle: the half that keeps its first end, then the other one."""
        edges = [*itertools.combinations(range(len(self.ends)), 2)]
        demand(letter < len(edges), "proof: a tree cuts an edge that its cell does not have")
        i, k = edges[letter]
        cut = tuple(a + b >> 1 for a, b in zip(self.ends[i], self.ends[k], strict=True))
        first, second = list(self.ends), list(self.ends)
        first[k], second[i] = cut, cut
        return Simplex(tuple(first)), Simplex(tuple(second))


Cell = Box | Simplex


# --- the claims -----------------------------------------------------------------------------------

MAX_DEPTH = 120
"""Cuts on top of each other in a tree."""

LETTER = re.compile("[a-g]|(?:0|[1-9][0-9]{0,5})?[.]")


def tokens(tree: Any, where: str) -> Iterator[str]:
    """Yield the letters and leaves of a tree one after the other."""
    at, end = 0, len(tree) if type(tree) is str else 0
    while at < end:
        found = LETTER.match(tree, at)
        if found is None:
            raise Refused(f"{where}: no tree of letters and leaves")
        yield found.group()
        at = found.end()


Walk = Iterator[tuple[Any, int, dict[str, str]]]


def walk(cell: Cell, trees: dict[str, Any]) -> Walk:
    """Walk some trees of a cell together: yield its parts, how often each was cut, and its leaves.

    A part that several trees have comes once, because the arm is placed there once. Trees, and the
    leaves of a part without their dots, are known by the names of their places in the file.
    """
    letters = {where: tokens(tree, where) for where, tree in trees.items()}
    todo = [(cell, [*trees], 0)]
    while todo:
        part, group, depth = todo.pop()
        Work.add(10 * len(group))
        cuts, leaves = dict[str, list[str]](), dict[str, str]()
        for where in group:
            token = next(letters[where], "")
            demand(token, f"{where}: a tree ends before its last leaf")
            if token[-1] == ".":
                leaves[where] = token[:-1]
            else:
                demand(depth < MAX_DEPTH, f"{where}: more than {MAX_DEPTH} cuts in a tree")
                cuts.setdefault(token, []).append(where)
        yield part, depth, leaves
        for letter, those in cuts.items():
            first, second = part.halves(ord(letter) - ord("a"))
            todo += [(second, those, depth + 1), (first, those, depth + 1)]
    for where, rest in letters.items():
        demand(not next(rest, ""), f"{where}: a tree goes on after its last leaf")


def prove_safe(arm: "Arm", cells: Sequence[Cell], proof: Any) -> None:
    """Verify the trees of all things to keep, cell by cell."""
    count, some = len(arm.keeps), items(anything, 0, len(cells))
    spec = {"directions": items(_direction, 0, MAX_CELLS), "trees": items(some, count, count)}
    found = table(spec)(proof, "proof")
    for k, row in enumerate(found["trees"]):
        wanted = len(cells) if arm.needs_proof[k] else 0
        demand(len(row) == wanted, f"proof.trees[{k}]: {wanted} trees are wanted")
    for c, cell in enumerate(cells):
        things = {f"proof.trees[{k}][{c}]": k for k, row in enumerate(found["trees"]) if row}
        trees = {where: found["trees"][k][c] for where, k in things.items()}
        for part, _, leaves in walk(cell, trees):
            pose = Pose(arm.steps, part.middle) if leaves else Pose([], ())
            for where, number in leaves.items():
                keep = arm.keeps[things[where]]
                u = _direction_of(keep, number, found["directions"], where)
                kept = is_kept(arm.steps, pose, keep, u, part)
                demand(kept, f"{where}: the bound of {shown(keep.name)} fails on a leaf")


def _direction(value: Any, where: str) -> tuple[Vector, list[int]]:
    """Read a direction; return it as a unit vector, and as the three integers that are written."""
    row: list[int] = items(anything, 3, 3)(value, where)
    known = all(type(x) is int for x in row) and any(row)
    demand(known, f"{where}: three integers, not all 0, are wanted")
    return unit(row), row


def _direction_of(
    keep: Keep, number: str, directions: Sequence[tuple[Vector, list[int]]], where: str
) -> Vector:
    """Return the direction that a leaf names; that of a half-space is its normal."""
    if keep.normal is not None:
        demand(not number, f"{where}: a leaf of a half-space names a direction")
        return keep.normal
    known = number and int(number) < len(directions)
    demand(known, f"{where}: a leaf names no direction of the list")
    u, row = directions[int(number)]
    across = keep.along is None or row[keep.along] == 0
    demand(across, f"{where}: a direction between bodies has a 0 along the common axis")
    return u


def refute(arm: "Arm", claim: "Claim", value: Any) -> str:
    """Verify a witness, and say what is violated where."""
    robot, kind = arm.robot, "limit" if type(value) is dict and "limit" in value else "place"
    spec: Table = {kind: anything}
    if claim.kind == "box":
        q = table({**spec, "at": configuration(robot)})(value, "witness")["at"]
        ends = zip(*claim.loops[0], q, strict=True)
        demand(all(a <= x <= b for a, b, x in ends), "witness.at: not in the box")
    else:
        spec |= {"cell": index(len(claim.corners)), "weights": weights(len(claim.corners[0]))}
        found = table(spec)(value, "witness")
        q = mean(found["weights"], claim.corners[found["cell"]])
    values = (
        f"{name!a} = {exactly(x)} {robot.unit_of(j)}"
        for j, (name, x) in enumerate(zip(robot.joints, q, strict=True))
    )
    said, named = f"is violated at {', '.join(values)}", value[kind]
    if kind == "limit":
        beyond = type(named) is str and named in robot.beyond(q)
        demand(beyond, "witness.limit: no limit of that name is violated")
        return f"the limit {named!a} {said}"
    demand(not robot.beyond(q), "witness.place: a limit is violated there: name that")
    keep, spots = read_spots(arm)(named, "witness.place")
    point = Box(arm.placed(q), arm.placed(q))
    pose, none_free = Pose(arm.steps, point.low), [False] * len(q)
    violated = is_violated(arm.steps, pose, keep, spots, point, none_free) or _cross(pose, keep)
    demand(violated, f"witness: {shown(keep.name)} is not violated there")
    return f"{keep.name!a} {said}"


def _cross(pose: Pose, keep: Keep) -> bool:
    """Tell whether two segments that keep no distance cross, seen along the common axis."""
    if keep.asked or keep.along is None:
        return False
    hulls = [[pose.place(hull.frame, p) for p in hull.corners] for hull in (keep.near, keep.far)]
    if [len(corners) for corners in hulls] != [2, 2]:
        return False
    normal, ((a, b), (c, d)) = pose.frames[keep.near.frame][0][keep.along], hulls

    def side(p: Vector, q: Vector, r: Vector) -> int:
        return dot(normal, cross(minus(q, p), minus(r, p)))

    sides = [(side(a, b, c), side(a, b, d)), (side(c, d, a), side(c, d, b))]
    return all(min(pair) < -SLACK and max(pair) > SLACK for pair in sides)


def read_spots(arm: "Arm") -> Reader:
    """Return the reader of a place of each hull of a thing to keep, and the discs about them."""
    radii = Maybe(items(not_negative(decimal), 2, 2), (ZERO, ZERO))
    spec = {"keep": index(len(arm.keeps)), "near": anything, "far": anything, "inside": radii}

    def read(value: Any, where: str) -> tuple[Keep, Spots]:
        found = table(spec)(value, where)
        keep, row, inside = arm.keeps[found["keep"]], arm.rows[found["keep"]], found["inside"]
        demand(not any(inside) or keep.along is not None, f"{where}.inside: of bodies only")
        sides = list[Vector]()
        for key, radius in zip(("near", "far"), inside, strict=True):
            if key not in row:
                demand(found[key] == [], f"{where}.{key}: an empty list is wanted")
                sides.append((0, 0, 0))
                continue
            hull = arm.hulls[row[key]]
            at = mean(weights(len(hull["corners"]))(found[key], f"{where}.{key}"), hull["corners"])
            seen = [k for k in range(3) if k != arm.robot.flat.get(hull["frame"])]
            within = not radius or _holds_disc(hull["corners"], seen, at, radius)
            demand(within, f"{where}.inside: the disc does not lie within the part")
            sides.append(arm.scaled(at))
        near, far = sides
        return keep, Spots(near, far, in_units(sum(inside) / arm.largest))

    return read


def _holds_disc(corners: Sequence[Exact], seen: Sequence[int], at: Exact, radius: Fraction) -> bool:
    """Tell whether a disc lies within a convex part: every edge is that far from its middle."""
    Work.add(120 * len(corners))
    i, k = seen
    flat = [(p[i], p[k]) for p in corners]
    sense = 1 if doubled_area(flat) > 0 else -1
    for (a, b), (c, d) in around(flat):
        x, y = c - a, d - b
        inwards = sense * (x * (at[k] - b) - y * (at[i] - a))
        if inwards <= 0 or inwards**2 < radius**2 * (x * x + y * y):
            return False
    return True


TOUCH = 1 << BITS - 100
"""Open leaves that are nearer than this touch: 8e-31 of a radian or of the largest length."""


class Leaves:
    """The boxes of a tree in preorder; `after` has for each the number that follows its parts."""

    def __init__(self, shifts: Sequence[Point]) -> None:
        self.spans, self.is_open, self.after = list[Box](), list[bool](), list[int]()
        self.shifts, self.above = shifts, list[int]()

    def add(self, span: Box, depth: int, is_open: bool) -> None:
        """Add the next box."""
        while len(self.above) > depth:
            self.after[self.above.pop()] = len(self.spans)
        self.above.append(len(self.spans))
        self.spans.append(span)
        self.is_open.append(is_open)
        self.after.append(MAX_FILE)  # the end, unless a box follows that is no part of this one

    def touching(self, box: Box) -> Iterator[int]:
        """Yield the open leaves that touch a box, over the seams of joints too."""
        for shift in self.shifts:
            low = [x + s - TOUCH for x, s in zip(box.low, shift, strict=True)]
            high = [x + s + TOUCH for x, s in zip(box.high, shift, strict=True)]
            k = 0
            while k < len(self.spans):
                Work.add(5)
                span = self.spans[k]
                apart = any(map(lt, span.high, low)) or any(map(lt, high, span.low))
                if self.is_open[k] and not apart:
                    yield k
                k = self.after[k] if apart else k + 1


def prove_no_path(arm: "Arm", claim: "Claim", proof: Any) -> None:
    """Verify that the leaves on which something is violated lie in every path.

    A path that keeps everything lies in open leaves. They are closed and finitely many, so a path
    stays within a group of leaves that touch.
    """
    places = items(read_spots(arm), 0, MAX_CELLS)
    found = table({"places": places, "tree": anything})(proof, "proof")
    [ends] = claim.loops
    for end, q in zip(("start", "goal"), ends, strict=True):
        demand(not arm.robot.beyond(q), f"claim.points: the {end} is beyond a limit")
    free, turns = [kind == "any" for kind in claim.joints], list[int]()
    low, high = [*arm.placed(ends[0])], [*arm.placed(ends[0])]
    for j, kind in enumerate(claim.joints):
        if kind != "held":
            low[j], high[j] = arm.whole_range(j)
        if free[j]:  # of a slide the middle is where its sweep is measured from
            low[j] = high[j] = low[j] + high[j] >> 1
        turns.append(TURN if kind == "moves" and arm.joints[j]["limits"] is None else 0)
    leaves = Leaves([*itertools.product(*({-t, 0, t} for t in turns))])
    root = Box(tuple(low), tuple(high))
    for part, depth, found_leaf in walk(root, {"proof.tree": found["tree"]}):
        Work.add(90)  # a node takes half a kilobyte
        number = found_leaf.get("proof.tree")
        leaves.add(part, depth, number == "")
        if number:
            known = int(number) < len(found["places"])
            demand(known, "proof.tree: a leaf names no place of the list")
            keep, spots = found["places"][int(number)]
            violated = is_violated(arm.steps, Pose(arm.steps, part.middle), keep, spots, part, free)
            demand(violated, f"proof.tree: {shown(keep.name)} is not violated all over a leaf")
    sides = []
    for end_at in map(arm.placed, ends):
        at = [x - (x + t // 2) // t * t if t else x for x, t in zip(end_at, turns, strict=True)]
        place = tuple(a if f else x for a, x, f in zip(low, at, free, strict=True))
        sides.append({*leaves.touching(Box(place, place))})
        demand(sides[-1], "proof.tree: the start or the goal is on no open leaf")
    reached, new = {*sides[0]}, [*sides[0]]
    while new:
        near = {*leaves.touching(leaves.spans[new.pop()])} - reached
        reached |= near
        new += near
    demand(not reached & sides[1], "proof.tree: open leaves lead from the start to the goal")


# --- reading: values ------------------------------------------------------------------------------
# A reader takes a value and the name of its place. It returns what the value says, or refuses the
# file. `True` is an integer to `isinstance`, so types are compared by `type(...) is`.

MAX_FILE, MAX_ROBOT = 4_000_000, 500_000
"""Bytes of a certificate; characters of the robot's text."""

MAX_JOINTS, MAX_BOUNDARIES, MAX_ROWS, MAX_CORNERS = 7, 2_000, 2_000, 1_000
"""Joints; boundaries in use; points, bodies or rows of another kind; corners of an outline."""

MAX_CELLS, MAX_KEEPS = 20_000, 20_000
"""Configurations, triangles, directions or places; pairs of parts to keep apart."""

MAX_DIGITS, LARGEST = 40, Fraction(10**100)
"""Digits of a number, and its size; one that is not 0 is at least 1 / LARGEST."""

ZERO = Fraction(0)


def shown(value: Any) -> str:
    """Write a value for a message: short, in ASCII, on one line."""
    if type(value) is str:
        return ascii(value if len(value) <= 60 else f"{value[:57]}...")
    names = {dict: "a table", list: "a list", int: "a number", bool: "a truth value"}
    return names.get(type(value), "a value of another type")


def anything(value: Any, where: str) -> Any:
    """Return a value as it is: it is read later."""
    del where
    return value


def such(test: Callable[[Any], object], wanted: str, reader: Reader = anything) -> Reader:
    """Return the reader of a value that has to pass a test."""

    def read(value: Any, where: str) -> Any:
        found = reader(value, where)
        demand(test(found), f"{where}: {wanted}")
        return found

    return read


class Maybe(NamedTuple):
    """What a key that may be missing holds, and what counts where it is missing."""

    reader: Reader
    missing: Any = None


def table(spec: Table) -> Reader:
    """Return the reader of a table: one row for each key that it may have."""
    readers = {k: row.reader if isinstance(row, Maybe) else row for k, row in spec.items()}
    missing = {k: row.missing for k, row in spec.items() if isinstance(row, Maybe)}

    def read(value: Any, where: str) -> Table:
        demand(type(value) is dict, f"{where}: a table is wanted")
        for key in value:
            demand(key in readers, f"{where}: unknown key {shown(key)}")
        for key in readers:
            demand(key in value or key in missing, f"{where}: the key {key!r} is missing")
        return missing | {key: readers[key](value[key], f"{where}.{key}") for key in value}

    return read


def items(reader: Reader, least: int, most: int) -> Reader:
    """Return the reader of a list of `least` to `most` values of one kind."""
    wanted = str(least) if least == most else f"{least} to {most}"

    def read(value: Any, where: str) -> tuple[Any, ...]:
        fits = type(value) is list and least <= len(value) <= most
        demand(fits, f"{where}: a list of {wanted} is wanted")
        return tuple(reader(item, f"{where}[{i}]") for i, item in enumerate(value))

    return read


def text(most: int) -> Reader:
    """Return the reader of a text of 1 to `most` characters, none of them half of one."""
    wanted = f"a text of 1 to {most} characters is wanted"
    written = such(lambda value: type(value) is str and 1 <= len(value) <= most, wanted)
    return such(lambda value: not re.search("[\ud800-\udfff]", value), "half a character", written)


def one_of(*choices: Any) -> Reader:
    """Return the reader of a value that is among some."""
    wanted = " or ".join(map(str, choices))
    return such(
        lambda x: any(type(x) is type(c) and x == c for c in choices), f"{wanted} is wanted"
    )


def index(count: int) -> Reader:
    """Return the reader of a number from 0 to `count` - 1."""
    return such(lambda x: type(x) is int and 0 <= x < count, f"0 to {count - 1} is wanted")


NUMBER = re.compile("[+-]?([0-9]+)(?:[.]([0-9]+))?(?:[eE][+-]?[0-9]{1,3})?")


def exact(written: str, where: str) -> Fraction:
    """Return the value of a decimal; its digits and its size are bounded."""
    found = NUMBER.fullmatch(written)
    demand(found, f"{where}: {shown(written)} is no decimal number")
    digits = sum(map(len, found.groups(""))) if found else 0
    demand(digits <= MAX_DIGITS, f"{where}: a number of more than {MAX_DIGITS} digits")
    value = Fraction(written)
    fits = not value or 1 / LARGEST <= abs(value) <= LARGEST
    demand(fits, f"{where}: a number that is not 0 has a size between 1e-100 and 1e100")
    return value


def decimal(value: Any, where: str) -> Fraction:
    """Read a decimal of a certificate: a string such as "-12.5"."""
    known = type(value) is str and len(value) <= 60 and value.isascii() and value[:1] != "+"
    demand(known, f'{where}: a decimal number in quotes is wanted, such as "-12.5"')
    return exact(value, where)


def not_negative(reader: Reader) -> Reader:
    """Return the reader of a number of 0 or more."""
    return such(lambda x: x >= 0, "a number of 0 or more is wanted", reader)


def weights(count: int) -> Reader:
    """Return the reader of the weights of a mean of corners."""
    shares = items(not_negative(decimal), count, count)
    return such(lambda row: sum(row) == 1, "weights whose sum is 1 are wanted", shares)


def mean(shares: Sequence[Fraction], corners: Sequence[Exact]) -> Exact:
    """Return a mean of corners."""
    Work.add(20 * len(shares))
    columns = zip(*corners, strict=True)
    return tuple(sum(map(mul, shares, column), ZERO) for column in columns)


def read_json(data: bytes) -> Any:
    """Read JSON of which no key stands twice, and whose only numbers are short integers."""
    demand(len(data) <= MAX_FILE, f"the file has more than {MAX_FILE} bytes")
    numbers: Table = dict.fromkeys(("parse_int", "parse_float", "parse_constant"), _integer)
    try:
        return json.loads(data.decode("utf-8"), object_pairs_hook=_unique, **numbers)
    except UnicodeDecodeError:
        raise Refused("the file is not UTF-8 text") from None
    except RecursionError:
        raise Refused("the file is nested too deeply") from None
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise Refused(f"the file is not JSON: {where}: {error.msg}") from None


def _unique(pairs: list[tuple[str, Any]]) -> Table:
    found = dict(pairs)
    demand(len(found) == len(pairs), "the file has a key twice in one object")
    return found


def _integer(written: str) -> int:
    known = re.fullmatch("0|-?[1-9][0-9]{0,8}", written)
    demand(known, f"the file has the number {shown(written)}: decimals are written as strings")
    return int(written)


# --- reading: TOML --------------------------------------------------------------------------------


@dataclass(frozen=True)
class TomlFloat:
    """A float as the robot's text writes it; so it is neither rounded nor taken for a string."""

    text: str


TOKEN = re.compile(
    r"""(?P<string> "[^"\\\n]*(?:\\[^\n][^"\\\n]*)*" | '[^'\n]*' )
      | (?P<comment> \#[^\n]* )
      | (?P<mark> [=,\[\]{}\n] )
      | (?P<blanks> [ \t\r]+ )
      | (?P<word> [^"'\#=,\[\]{}\n\ \t\r]+ )
      | (?P<other> . )""",
    re.VERBOSE | re.DOTALL,
)
LONGEST = {"string": 302, "word": 100}
"""Characters as they are written, quotes included."""

MAX_NESTED = 8


def read_toml(written: str) -> Any:
    """Read TOML after a look at its marks, on which the reader of TOML could work for long.

    Dotted keys cost that reader the square of their number of parts, tables in tables more. No
    robot needs either: between two marks there is at most one string or word.
    """
    line, depth, between = 1, 0, list[str]()
    for token in TOKEN.finditer(written):
        kind, found, where = str(token.lastgroup), token.group(), f"robot: line {line}"
        demand(kind != "other", f"{where}: a string that does not end")
        demand(len(found) <= LONGEST.get(kind, MAX_ROBOT), f"{where}: {shown(found)} is too long")
        if kind in ("string", "word"):
            between.append(found)
            demand(len(between) == 1, f"{where}: {shown(found)} follows another word or string")
            demand(kind == "string" or found.count(".") <= 1, f"{where}: a word with two dots")
        if kind == "mark":
            dotted = any("." in key and key[0] not in "\"'" for key in between)
            demand(found != "=" or not dotted, f"{where}: a key with a dot")
            depth += (found in "[{") - (found in "]}")
            demand(depth <= MAX_NESTED, f"{where}: more than {MAX_NESTED} brackets in each other")
            line += found == "\n"
            between.clear()
    try:
        return tomllib.loads(written, parse_float=TomlFloat)
    except ValueError as error:  # also an integer of thousands of digits
        raise Refused(f"robot: no TOML: {error}") from None


def number(value: Any, where: str) -> Fraction:
    """Read an integer or a float of TOML."""
    if type(value) is int:
        demand(abs(value) < 10**MAX_DIGITS, f"{where}: a number of more than {MAX_DIGITS} digits")
        return Fraction(value)
    demand(isinstance(value, TomlFloat), f"{where}: a number is wanted")
    return exact(value.text.replace("_", ""), where)


label, vector, size_of = text(200), items(number, 3, 3), not_negative(number)
corner, two_labels = items(number, 2, 3), items(label, 2, 2)
direction = such(any, "a direction must not be 0", vector)
clearance, own_name = Maybe(size_of, ZERO), Maybe(label, "")

KINDS = ("revolute", "prismatic", "parallelogram", "continuous")
JOINT = {
    "name": label,
    "type": one_of(*KINDS),
    "parent": label,
    "frame": label,
    "origin": vector,
    "rpy": Maybe(vector, (ZERO,) * 3),
    "axis": direction,
    "limits": Maybe(such(lambda x: x[0] < x[1], "the first one must be less", items(number, 2, 2))),
    "velocity": Maybe(such(lambda x: x > 0, "a number of more than 0 is wanted", number)),
    "crank": Maybe(vector),
    "bar": Maybe(label),
}
POINT = {"name": label, "frame": label, "at": vector, "radius": Maybe(size_of, ZERO)}
SHAPES = {
    "polygon": Maybe(items(corner, 3, MAX_CORNERS)),
    "capsule": Maybe(table({"from": corner, "to": corner, "radius": size_of})),
    "disc": Maybe(table({"at": corner, "radius": size_of})),
}
BOUNDARY = {
    "pair": {"points": two_labels, "clearance": clearance},
    "bodies": {"bodies": two_labels, "clearance": clearance},
    "half-space": {
        "normal": direction,
        "offset": number,
        "point": Maybe(label),
        "body": Maybe(label),
    },
}


def boundary_row(value: Any, where: str) -> Any:
    """Read a boundary by its type."""
    kind = one_of(*BOUNDARY)(value.get("type") if type(value) is dict else None, f"{where}.type")
    head = {"name": label, "type": anything, "used": Maybe(one_of(True, False), True)}
    return table({**head, **BOUNDARY[kind]})(value, where)


def rows(spec: Table) -> Maybe:
    """Return the row of a list of tables that may be missing."""
    return Maybe(items(table(spec), 0, MAX_ROWS), ())


FILE = table(
    {
        "schema": one_of(1),
        "name": label,
        "length_unit": one_of("m", "cm", "mm"),
        "angle_unit": one_of("deg", "rad"),
        "home": anything,
        "tool": label,
        "joint": items(table(JOINT), 1, MAX_JOINTS),
        "point": items(table(POINT), 1, MAX_ROWS),
        "boundary": Maybe(items(boundary_row, 0, MAX_ROWS), ()),
        "body": rows({"name": own_name, "frame": label, **SHAPES}),
        "obstacle": rows({"name": own_name, **SHAPES}),
        "collisions": Maybe(one_of("all")),
        "clearance": clearance,
        "allowed": Maybe(items(two_labels, 0, MAX_ROWS), ()),
    }
)

# --- reading: the robot ---------------------------------------------------------------------------


class Thing(NamedTuple):
    """A point, or a body: a core of one corner, of a segment, or of an outline, with a radius."""

    name: str
    kind: str
    frame: int
    corners: tuple[Exact, ...]
    radius: Fraction


class Boundary(NamedTuple):
    """Two things that keep `distance` plus their radii apart; with a normal, one above a plane."""

    name: str
    things: tuple[Thing, ...]
    normal: Exact | None
    distance: Fraction


@dataclass(frozen=True)
class Robot:
    """What a robot's text says, as far as it bears on claims.

    Attributes
    ----------
    exact : the normal form, see the page, with exact numbers
    frames : names, the base first
    boundaries : those in use
    left_out : what is not to be kept, in words
    flat : of each frame with bodies, its coordinate along the common axis
    """

    exact: Table
    frames: tuple[str, ...]
    boundaries: tuple[Boundary, ...]
    left_out: tuple[str, ...]
    flat: dict[int, int]

    @property
    def joints(self) -> list[str]:
        """Return the names of joints."""
        return [joint["name"] for joint in self.exact["joints"]]

    def unit_of(self, j: int) -> str:
        """Return the unit of a joint's values."""
        turns = self.exact["joints"][j]["turns"]
        return str(self.exact["angle_unit" if turns else "length_unit"])

    def beyond(self, q: Exact) -> list[str]:
        """Return the names of the limits that a configuration is beyond: compared exactly."""
        found = []
        for joint, value in zip(self.exact["joints"], q, strict=True):
            low, high = joint["limits"] or (value, value)
            found += [f"{joint['name']}.lower"] * (value < low)
            found += [f"{joint['name']}.upper"] * (value > high)
        return found

    @cached_property
    def form(self) -> Table:
        """Return the normal form, its decimals written in full."""
        found: Table = _written(self.exact)
        return found


def _written(value: Any) -> Any:
    """Return a value for JSON: decimals are written in full."""
    if isinstance(value, Fraction):
        return exactly(value)
    if isinstance(value, dict):
        return {key: _written(item) for key, item in value.items()}
    return [*map(_written, value)] if isinstance(value, list | tuple) else value


def exactly(x: Fraction) -> str:
    """Write a decimal with all its digits and without an exponent."""
    twos = (x.denominator & -x.denominator).bit_length() - 1
    fives, power = 0, 1 << twos
    while power < x.denominator:
        fives, power = fives + 1, 5 * power
    digits = max(twos, fives)
    Work.add(digits)
    whole = str(abs(x.numerator) * 10**digits // x.denominator).rjust(digits + 1, "0")
    point = len(whole) - digits
    return "-" * (x < 0) + whole[:point] + ("." + whole[point:] if digits else "")


def read_robot(written: str, parts: Any) -> Robot:
    """Read a robot's text and bring it to its normal form."""
    file = FILE(read_toml(written), "robot")
    joints, steps, frames = _joints(file)
    points = [_thing(row, frames) for row in file["point"]]
    links = [_thing(row, frames) for row in file["body"]]
    others = [_thing({**row, "frame": frames[0]}, frames) for row in file["obstacle"]]
    known = _named("point", points)
    demand(not {*known} & {*frames}, "robot: a point has the name of a frame")
    demand(file["tool"] in known, "robot: the tool is no point")
    table({joint["name"]: number for joint in joints})(file["home"], "robot.home")
    demand(len(links) + len(others) <= MAX_ROWS, f"robot: more than {MAX_ROWS} bodies")
    bodies = _named("body", _called([*links, *others], len(links), frames))
    boundaries, left_out = _boundaries(file, known, bodies, joints)
    used = {t.frame for boundary in boundaries for t in boundary.things if t.kind != "point"}
    flat = _common_axis(joints, steps, file["angle_unit"], used)
    hulls, keeps = _keeps(boundaries, flat, parts)
    form = {key: file[key] for key in ("name", "length_unit", "angle_unit")}
    form |= {"joints": joints, "steps": steps, "hulls": hulls, "keep": keeps}
    return Robot(form, tuple(frames), boundaries, left_out, flat)


def _named(what: str, things: Iterable[Any]) -> dict[str, Any]:
    """Return things by name; refuse a name that stands for two."""
    found = dict[str, Any]()
    for thing in things:
        called = thing["name"] if isinstance(thing, dict) else thing.name
        demand(called not in found, f"robot: {what}: two are called {shown(called)}")
        found[called] = thing
    return found


LARGEST_ANGLE = {"deg": Fraction(1800), "rad": Fraction(30)}


def _joints(file: Table) -> tuple[list[Table], list[Table], list[str]]:
    """Return joints, the steps that they make, and the names of frames, the base first."""
    joints, steps, frames = list[Table](), list[Table](), [file["joint"][0]["parent"]]
    most = 100 * {"deg": Fraction(360), "rad": 2 * PI}[file["angle_unit"]]
    for j, row in enumerate(file["joint"]):
        where, turns, limits = f"robot.joint[{j}]", row["type"] != "prismatic", row["limits"]
        demand(row["parent"] == frames[-1], f"{where}: its parent is not the frame before")
        bars = [row[key] is not None for key in ("crank", "bar")]
        fits = bars == [row["type"] == "parallelogram"] * 2
        demand(fits, f"{where}: crank and bar belong to a parallelogram")
        demand(turns or limits, f"{where}: a prismatic joint needs limits")
        endless = row["type"] == "continuous"
        demand(not (endless and limits), f"{where}: a continuous joint has no limits")
        small = all(abs(angle) <= LARGEST_ANGLE[file["angle_unit"]] for angle in row["rpy"])
        demand(small, f"{where}.rpy: an angle of more than five turns")
        near = not (turns and limits) or limits[1] - limits[0] <= most
        demand(near, f"{where}.limits: more than 100 turns apart")
        joints.append({"name": row["name"], "turns": turns, "limits": limits})
        step = {"joint": j, "factor": Fraction(1), "offset": ZERO, "axis": row["axis"]}
        steps.append({**step, "origin": row["origin"], "rpy": row["rpy"]})
        if all(bars):
            frames.append(row["bar"])
            back = {"factor": Fraction(-1), "origin": row["crank"], "rpy": (ZERO,) * 3}
            steps.append({**step, **back})
        frames.append(row["frame"])
    _named("joint", joints)
    demand(len({*frames}) == len(frames), "robot: a frame has the name of another one")
    return joints, steps, frames


def _thing(row: Table, frames: Sequence[str]) -> Thing:
    """Return a point or a body; the corners of a body have two numbers or three."""
    demand(row["frame"] in frames, f"robot: no frame is called {shown(row['frame'])}")
    kinds = [kind for kind in SHAPES if row.get(kind)] or ["point"] * ("at" in row)
    demand(len(kinds) == 1, "robot: a body has one shape: a polygon, a capsule or a disc")
    shape = row.get(kinds[0], row)
    corners, radius = shape, ZERO
    if kinds != ["polygon"]:
        corners, radius = (
            [shape[end] for end in ("at", "from", "to") if end in shape],
            shape["radius"],
        )
    return Thing(row["name"], kinds[0], frames.index(row["frame"]), tuple(corners), radius)


def _called(bodies: Sequence[Thing], links: int, frames: Sequence[str]) -> list[Thing]:
    """Order bodies along the chain, obstacles last; one without a name is called by its frame."""
    found = list[Thing]()
    for k, body in enumerate(bodies):
        count = 1 + sum(other.frame == body.frame for other in bodies[:k])
        usual = frames[body.frame] + (f"/{count}" if count > 1 else "")
        found.append(body if body.name else body._replace(name=usual))
    return sorted(found[:links], key=lambda body: body.frame) + found[links:]


def _boundaries(
    file: Table, points: dict[str, Thing], bodies: dict[str, Thing], joints: Sequence[Table]
) -> tuple[tuple[Boundary, ...], tuple[str, ...]]:
    """Return the boundaries in use, those that `collisions` makes last, and what is left out."""
    found, unused = list[Boundary](), list[str]()
    apart = [_things(names, bodies, "allowed") for names in file["allowed"]]
    left_out = [f"{len(apart)} allowed pairs"] * bool(apart)
    for i, row in enumerate(file["boundary"]):
        where, kind = f"robot.boundary[{i}]", row["type"]
        ends = [key for key in ("points", "bodies", "point", "body") if row.get(key)]
        demand(len(ends) == 1, f"{where}: a point or a body is wanted")
        names = (row[ends[0]],) if kind == "half-space" else row[ends[0]]
        things = _things(names, points if ends[0][:5] == "point" else bodies, where)
        same = kind == "bodies" and things[0].frame == things[1].frame
        demand(not same, f"{where}: two bodies of one frame")
        apart += [things] if kind == "bodies" else []
        distance = row["offset"] if kind == "half-space" else row["clearance"]
        found.append(Boundary(row["name"], things, row.get("normal"), distance))
        unused += [row["name"]] * (not row["used"])
    settled = {frozenset(thing.name for thing in pair) for pair in apart}
    for pair in itertools.combinations(bodies.values(), 2) if file["collisions"] else ():
        Work.add(2)
        names = [thing.name for thing in pair]
        if pair[0].frame != pair[1].frame and frozenset(names) not in settled:
            demand(len(found) < 2 * MAX_ROWS, "robot: too many pairs of bodies")
            found.append(Boundary(", ".join(names), pair, None, file["clearance"]))
    limits = {f"{joint['name']}.{side}" for joint in joints for side in ("lower", "upper")}
    demand(not limits & {*_named("boundary", found)}, "robot: a boundary has the name of a limit")
    without = {*unused}
    used = tuple(boundary for boundary in found if boundary.name not in without)
    demand(len(used) <= MAX_BOUNDARIES, f"robot: more than {MAX_BOUNDARIES} boundaries in use")
    left_out = [*(f"{named!a} (used = false)" for named in unused), *left_out]
    left_out += ["bodies of one frame" if file["collisions"] else "other bodies"] * bool(bodies)
    return used, tuple(left_out)


def _things(names: Sequence[str], known: dict[str, Thing], where: str) -> tuple[Thing, ...]:
    """Return some different things by their names."""
    for named in names:
        demand(named in known, f"{where}: nothing is called {shown(named)}")
    demand(len({*names}) == len(names), f"{where}: two different names are wanted")
    return tuple(known[named] for named in names)


# --- reading: the normal form ---------------------------------------------------------------------


def in_radians(angle: Fraction, unit_name: str) -> int:
    """Return an angle of the file in units."""
    return in_units(angle * PI / 180 if unit_name == "deg" else angle)


def mount_of(rpy: Exact, unit_name: str) -> Matrix:
    """Return Rz(yaw) Ry(pitch) Rx(roll)."""
    turned = AXES
    for axis, angle in zip(reversed(AXES), reversed(rpy), strict=True):
        if angle:
            turned = product(turned, rotation(axis, in_radians(angle, unit_name)))
    return turned


def _common_axis(
    joints: Sequence[Table], steps: Sequence[Table], unit_name: str, frames: set[int]
) -> dict[int, int]:
    """Return for each frame with bodies its coordinate along the common axis of the joints."""
    if not frames:
        return {}
    every, axes = [AXES], list[tuple[bool, Vector]]()
    for step in steps:
        every.append(product(every[-1], mount_of(step["rpy"], unit_name)))
        axes.append((joints[step["joint"]]["turns"], image(every[-1], unit(step["axis"]))))
    still = (e for e in (AXES[1], AXES[2], AXES[0]) if all(_across(e, z) for _, z in axes))
    common = next((axis for turns, axis in axes if turns), None) or next(still, None)
    if common is None:
        raise Refused("robot: the joints slide across no axis of the base: bodies have no plane")
    for turns, axis in axes:
        fits = _parallel(common, axis) if turns else _across(common, axis)
        demand(fits, "robot: bodies keep apart in a plane only, and the arm leaves it")
    flat = dict[int, int]()
    for frame in frames:
        along = [k for k in range(3) if _parallel(common, every[frame][k])]
        demand(along, "robot: no axis of a frame with bodies is along the common axis")
        flat[frame] = along[0]
    return flat


def _across(u: Vector, v: Vector) -> bool:
    return abs(dot(u, v)) <= NEARLY


def _parallel(u: Vector, v: Vector) -> bool:
    return size(cross(u, v)) <= NEARLY


def _keeps(
    boundaries: Sequence[Boundary], flat: dict[int, int], parts: Any
) -> tuple[list[Table], list[Table]]:
    """Return the hulls and the things to keep of the normal form."""
    pairs = [thing for boundary in boundaries if not boundary.normal for thing in boundary.things]
    outlines = {t.name: t for t in pairs if t.kind == "polygon"}
    seen = {key: _seen(_lifted(t, flat), flat[t.frame]) for key, t in outlines.items()}
    for key, outline in seen.items():
        demand(doubled_area(outline), f"robot: the outline of {shown(key)} has no area")
    pieces = items(items(anything, 3, MAX_CORNERS), 1, MAX_CORNERS)
    cut = table({key: pieces for key, outline in seen.items() if not is_convex(outline)})(
        parts, "parts"
    )
    for key, loops in cut.items():
        where, known = f"parts.{key!a}", index(len(seen[key]))
        corners = [[seen[key][known(k, where)] for k in loop] for loop in loops]
        demand_filled([seen[key]], corners, where)
    hulls, numbers, shapes = list[Table](), dict[Any, int](), dict[str, int]()

    def hull(thing: Thing, loop: Sequence[int] | None = None) -> int:
        key = thing.kind == "point", thing.name, loop
        if key not in numbers:
            whole = _lifted(thing, flat)
            corners = whole if loop is None else tuple(whole[k] for k in loop)
            numbers[key] = shapes.setdefault(f"{thing.frame} {_written(corners)}", len(hulls))
            if numbers[key] == len(hulls):
                hulls.append({"frame": thing.frame, "corners": corners})
        return numbers[key]

    keeps = list[Table]()
    for named, things, normal, distance in boundaries:
        row = {"name": named, "gap": distance + sum(thing.radius for thing in things)}
        if normal is not None:
            keeps.append({**row, "far": hull(things[0]), "normal": normal})
            continue
        near, far = sorted(things, key=lambda thing: thing.frame)
        row["along"] = None if near.kind == "point" else flat[near.frame]
        loops = [cut.get(t.name, [None]) if t.kind == "polygon" else [None] for t in (near, far)]
        for one, other in itertools.product(*loops):
            demand(len(keeps) < MAX_KEEPS, f"robot: more than {MAX_KEEPS} pairs of parts")
            keeps.append({**row, "near": hull(near, one), "far": hull(far, other)})
    return hulls, keeps


def _lifted(thing: Thing, flat: dict[int, int]) -> tuple[Exact, ...]:
    """Return the corners of a thing; one of two numbers has a 0 along the common axis."""
    k = flat.get(thing.frame, 0)
    return tuple(p if len(p) == 3 else (*p[:k], ZERO, *p[k:]) for p in thing.corners)


def _seen(corners: Sequence[Exact], flat: int) -> list[tuple[int, int]]:
    """Return an outline along the common axis, anticlockwise, in whole numbers."""
    pairs = [[x for k, x in enumerate(p) if k != flat] for p in corners]
    whole = math.lcm(*(x.denominator for pair in pairs for x in pair))
    found = [(int(x * whole), int(y * whole)) for x, y in pairs]
    return found if doubled_area(found) > 0 else [(-x, y) for x, y in found]


def around(loop: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    """Return the pairs of neighbours around a loop."""
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def doubled_area(loop: Sequence[tuple[Any, Any]]) -> Any:
    """Return twice the area of a loop, more than 0 if it goes anticlockwise."""
    Work.add(2 * len(loop))
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in around(loop))


def is_convex(loop: Sequence[tuple[int, int]]) -> bool:
    """Tell whether every corner is on the left of every edge or on its line, and one is not."""
    Work.add(5 * len(loop) ** 2)
    for (x, y), (u, v) in around(loop):
        sides = [(u - x) * (q - y) - (v - y) * (p - x) for p, q in loop]
        if min(sides) < 0 or not any(sides):
            return False
    return True


def demand_filled(
    loops: Sequence[Sequence[tuple[int, int]]],
    pieces: Sequence[Sequence[tuple[int, int]]],
    where: str,
) -> None:
    """Refuse pieces that do not fill loops: convex, inner edges in pairs, all others the loops.

    Then the edges of all pieces add up to the loops. So around any place the loops wind as often as
    pieces hold it, and a place that they wind around lies in a piece. Points are known by their
    text, because the hash of a number can be chosen and that of a text cannot.
    """
    for piece in pieces:
        demand(is_convex(piece), f"{where}: a piece is not convex, flat, or goes clockwise")
    numbers = dict[str, int]()

    def edges(loop: Sequence[tuple[int, int]]) -> Iterator[tuple[int, int]]:
        return around([numbers.setdefault(f"{x} {y}", len(numbers)) for x, y in loop])

    outer = [edge for loop in loops for edge in edges(loop)]
    inner = [edge for piece in pieces for edge in edges(piece)]
    outline, sides = {*outer}, {*inner}
    demand(len(sides) == len(inner), f"{where}: two pieces lie on one side of an edge")
    demand(len(outline) == len(outer), f"{where}: an edge of the loops stands there twice")
    for a, b in outer:
        alone = (a, b) in sides and (b, a) not in sides
        demand(alone, f"{where}: an edge of the loops is not the edge of one piece alone")
    for a, b in sides - outline:
        demand((b, a) in sides, f"{where}: an inner edge has a piece on one side alone")


# --- reading: the arm of the kernel ---------------------------------------------------------------


class Arm:
    """A robot in units, and what it has to keep with the margin of a claim."""

    def __init__(self, robot: Robot, margin: Fraction) -> None:
        self.robot, form = robot, robot.exact
        self.joints, self.hulls, self.rows = form["joints"], form["hulls"], form["keep"]
        gaps = [row["gap"] + margin for row in self.rows]
        lengths = [x for hull in self.hulls for p in hull["corners"] for x in p] + gaps
        lengths += [x for step in form["steps"] for x in step["origin"]]
        lengths += [x for joint in self.joints if not joint["turns"] for x in joint["limits"]]
        self.largest = max(map(abs, lengths), default=ZERO) or Fraction(1)
        self.steps = [self._step(row) for row in form["steps"]]
        hulls = [Hull(h["frame"], tuple(map(self.scaled, h["corners"]))) for h in self.hulls]
        base = Hull(0, ((0, 0, 0),))
        self.keeps = [
            Keep(
                row["name"],
                hulls[row["near"]] if "near" in row else base,
                hulls[row["far"]],
                in_units(gap / self.largest),
                gap != 0,
                row.get("along"),
                unit(row["normal"]) if "normal" in row else None,
            )
            for row, gap in zip(self.rows, gaps, strict=True)
        ]
        self.needs_proof = [
            keep.normal or keep.asked or len(keep.near.corners) + len(keep.far.corners) > 3
            for keep in self.keeps
        ]
        self._demand_one_height()

    def _demand_one_height(self) -> None:
        """Refuse bodies whose corners have not one height along the common axis."""
        ends = [(k.near, k.far) for k in self.keeps if k.along is not None]
        hulls = {id(hull): hull for pair in ends for hull in pair}.values()
        pose, heights = Pose(self.steps if ends else [], [0] * len(self.joints)), list[int]()
        for hull in hulls:
            axis = pose.frames[ends[0][0].frame][0][self.robot.flat[ends[0][0].frame]]
            heights += [dot(axis, pose.place(hull.frame, p)) for p in hull.corners]
        level = not heights or max(heights) - min(heights) <= NEARLY
        demand(level, "robot: two bodies to keep apart are not at one height")

    def _step(self, row: Table) -> Step:
        turns, origin = self.joints[row["joint"]]["turns"], self.scaled(row["origin"])
        low, high = (0, 0) if turns else self.whole_range(row["joint"])
        mount, sweep = mount_of(row["rpy"], self.robot.exact["angle_unit"]), high - low + 3 >> 1
        return Step(
            row["joint"], turns, int(row["factor"]), origin, mount, unit(row["axis"]), sweep
        )

    def scaled(self, place: Sequence[Fraction]) -> Vector:
        """Return three lengths in units."""
        x, y, z = (in_units(x / self.largest) for x in place)
        return x, y, z

    def placed(self, q: Exact) -> Point:
        """Return a configuration in units."""
        return tuple(itertools.starmap(self._value, enumerate(q)))

    def _value(self, j: int, x: Fraction) -> int:
        turns = self.joints[j]["turns"]
        return in_radians(x, self.robot.unit_of(j)) if turns else in_units(x / self.largest)

    def whole_range(self, j: int) -> tuple[int, int]:
        """Return the limits of a joint; without limits a turn, in radians a little more."""
        ends = {"deg": Fraction(180), "rad": Fraction("3.1416")}[self.robot.exact["angle_unit"]]
        low, high = self.joints[j]["limits"] or (-ends, ends)
        return self._value(j, low), self._value(j, high)


# --- reading: the claim ---------------------------------------------------------------------------


class Claim(NamedTuple):
    """What a certificate claims: a set with the corners of its cells, or two configurations."""

    kind: str
    margin: Fraction
    loops: Sequence[Sequence[Exact]]
    corners: Sequence[Sequence[Exact]]
    joints: Sequence[str]


def configuration(robot: Robot) -> Reader:
    """Return the reader of one value for each joint; angles are not too large."""
    unit_name = robot.exact["angle_unit"]
    largest, turning = LARGEST_ANGLE[unit_name], [j["turns"] for j in robot.exact["joints"]]
    return such(
        lambda q: all(abs(x) <= largest for x, turns in zip(q, turning, strict=True) if turns),
        f"an angle of more than {largest} {unit_name}",
        items(decimal, len(turning), len(turning)),
    )


def read_claim(value: Any, robot: Robot) -> Claim:
    """Read a claim and the cells of its set."""
    q, count = configuration(robot), len(robot.joints)
    two = {"points": items(items(q, 2, 2), 1, 1)}
    kinds = one_of("moves", "held", "any")
    specs = {
        "box": two,
        "path": {"points": items(items(q, 2, MAX_CELLS), 1, MAX_CELLS)},
        "polygon": {
            "points": items(items(q, 3, MAX_CELLS), 1, MAX_CELLS),
            "triangles": items(anything, 1, MAX_CELLS),
        },
        "no path": {**two, "joints": items(kinds, count, count)},
    }
    kind = one_of(*specs)(value.get("set") if type(value) is dict else None, "claim.set")
    head = {"set": anything, "margin": not_negative(decimal)}
    found = table({**head, **specs[kind]})(value, "claim")
    loops, joints, corners = found["points"], found.get("joints", ()), list[Sequence[Exact]]()
    points = [q for loop in loops for q in loop]
    demand(len(points) <= MAX_CELLS, f"claim.points: more than {MAX_CELLS} configurations")
    if kind == "box":
        rises = all(a <= b for a, b in zip(*points, strict=True))
        demand(rises, "claim.points: the first corner is the low one in every joint")
        corners = [points]
    elif kind == "path":
        corners = [pair for loop in loops for pair in itertools.pairwise(loop)]
    elif kind == "polygon":
        flat = _flat(loops)
        for loop in flat:
            once = len({f"{x} {y}" for x, y in loop}) == len(loop)
            demand(once, "claim.points: a loop passes a configuration twice")
        numbered = items(items(index(len(points)), 3, 3), 1, MAX_CELLS)
        triangles = numbered(value["triangles"], "claim.triangles")
        places = [place for loop in flat for place in loop]
        demand_filled(flat, [[places[k] for k in row] for row in triangles], "claim.triangles")
        corners = [[points[k] for k in row] for row in triangles]
    else:
        demand("moves" in joints, "claim.joints: at least one joint moves")
        held = [a == b for a, b, each in zip(*points, joints, strict=True) if each == "held"]
        demand(all(held), "claim.joints: start and goal differ in a joint that is held")
    return Claim(kind, found["margin"], loops, corners, joints)


def _flat(loops: Sequence[Sequence[Exact]]) -> list[list[tuple[int, int]]]:
    """Return the loops of a polygon in the two joints that vary, in whole numbers."""
    columns = [*zip(*(q for loop in loops for q in loop), strict=True)]
    plane = [j for j, column in enumerate(columns) if min(column) != max(column)]
    demand(len(plane) == 2, f"claim.points: {len(plane)} joints of a polygon vary, not two")
    (i, m), (k, n) = ((j, math.lcm(*(x.denominator for x in columns[j]))) for j in plane)
    return [[(int(q[i] * m), int(q[k] * n)) for q in loop] for loop in loops]


# --- the answer -----------------------------------------------------------------------------------


class Answer(NamedTuple):
    """What a certificate shows: that its claim is refuted, else that it is proved."""

    refuted: bool
    said: str


def normal_form(written: str, parts: Any) -> Table:
    """Return the normal form of a robot's text; for those who write certificates."""
    Work.done = 0
    return read_robot(written, parts).form


def canonical(form: Table) -> str:
    """Return the text of a normal form, whose hash stands in a certificate."""
    return json.dumps(form, indent=1, sort_keys=True) + "\n"


def digest(written: str) -> str:
    """Return the SHA-256 of a text."""
    return hashlib.sha256(written.encode()).hexdigest()


def read(data: str | bytes) -> tuple[Table, Robot]:
    """Read a certificate and its robot, and compare the hash of the normal form."""
    Work.done = 0
    cos_sin.cache_clear()  # so that the work does not depend on what was checked before
    content = read_json(data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data)
    schema = content.get("schema") if type(content) is dict else None
    demand(schema == SCHEMA, f"schema: {SCHEMA} is wanted; older formats are not read any more")
    spec = {"robot": text(MAX_ROBOT), "parts": anything, "sha256": text(64), "claim": anything}
    spec |= {"schema": anything, "witness" if "witness" in content else "proof": anything}
    content = table(spec)(content, "the file")
    robot = read_robot(content["robot"], content["parts"])
    sha256 = digest(canonical(robot.form))
    demand(content["sha256"] == sha256, f"sha256: the hash of the normal form is {sha256}")
    return content, robot


def check(data: str | bytes, pin: str | None = None, file: str = "the file given") -> Answer:
    """Return what a certificate shows, and what is to be said of it.

    data : the certificate.
    pin : the text of a robot file that the certificate must be about; `file` is its name.

    Raises `Refused`, a `ValueError` that names what is wrong and where, if it shows nothing.
    """
    content, robot = read(data)
    compared = "not compared with any robot file"
    if pin is not None:
        other = f"the robot is not that of {shown(file)}"
        try:
            told = read_robot(pin, content["parts"])
        except Refused as error:
            raise Refused(f"{other}: {error}") from None
        demand(told.form == robot.form, other)
        robot = told  # what is said is said in the words of the file that the reader has
        compared = f"compared with {shown(file)}: the same"
    claim = read_claim(content["claim"], robot)
    arm, evidence = Arm(robot, claim.margin), content.get("witness", content.get("proof"))
    if "witness" in content:
        demand(claim.kind != "no path", "witness: a claim of no path has a proof")
        said = f"refuted: {refute(arm, claim, evidence)}\nthe claim was that the set keeps"
    elif claim.kind == "no path":
        prove_no_path(arm, claim, evidence)
        said = "proved: no path from {} to {} keeps all of the following".format(
            *map(_in_brackets, claim.loops[0])
        )
    else:
        for q in (q for cell in claim.corners for q in cell):  # the limits of cells, exactly
            beyond = robot.beyond(q)
            demand(not beyond, f"claim: beyond the limit {shown(next(iter(beyond), ''))}")
        placed = [[*map(arm.placed, corners)] for corners in claim.corners]
        box = claim.kind == "box"
        prove_safe(arm, [Box(*c) if box else Simplex(tuple(c)) for c in placed], evidence)
        said = "proved: at every configuration of the set all of the following is kept"
    heading = f"robot {robot.exact['name']!a}, sha256 of its normal form {content['sha256']}"
    lines = [f"{heading}, {compared}", said, *kept(robot, claim), *described(robot, claim)]
    return Answer("witness" in content, "\n".join(lines))


def kept(robot: Robot, claim: Claim) -> Iterator[str]:
    """Say what was to be kept, and what was not."""
    length = robot.exact["length_unit"]
    yield f"all limits of joints, and with {exactly(claim.margin)} {length} to spare each of"
    for named, things, normal, distance in robot.boundaries:
        ends = [
            f"{'outline' if thing.kind == 'polygon' else thing.kind} {thing.name!a}"
            f" of frame {robot.frames[thing.frame]!a}"
            + (f", radius {exactly(thing.radius)} {length}" if thing.radius else "")
            for thing in things
        ]
        told = f"at least {exactly(distance)} {length}"
        if normal is not None:
            told += f" of height along {_in_brackets(normal)}, in all its places"
        else:
            told = f"{told} apart" if distance else "not overlapping"
            told += "" if things[0].kind == "point" else ", seen along the common axis"
        yield f"  {named!a}: {' and '.join(ends)}: {told}"
    if robot.left_out:
        yield f"not claimed: {', '.join(robot.left_out)}"


def _in_brackets(numbers: Exact) -> str:
    return f"({', '.join(map(exactly, numbers))})"


MOST_SHOWN = 50
"""Configurations that are printed; of larger sets their hash is, and what else names them."""

LOOPS = {"box": "from low to high", "no path": "from start to goal", "path": "path"}
JOINTS = {"any": "takes any value, even jumps", "held": "is held", "moves": "moves"}


def described(robot: Robot, claim: Claim) -> Iterator[str]:
    """Describe the set by the numbers that were verified."""
    points = [q for loop in claim.loops for q in loop]
    printed = [" ".join(map(_in_brackets, loop)) for loop in claim.loops]
    units = [robot.unit_of(j) for j in range(len(robot.joints))]
    names = ", ".join(f"{name!a} / {u}" for name, u in zip(robot.joints, units, strict=True))
    told = [LOOPS.get(claim.kind, "")] * len(printed)
    if claim.kind == "polygon":
        told = ["outline" if doubled_area(loop) > 0 else "hole" for loop in _flat(claim.loops)]
    counted = [f"{told.count(kind)} {kind}(s)" for kind in ("outline", "hole") if kind in told]
    yield f"set: {', '.join([claim.kind, *counted])}; {len(points)} configurations ({names})"
    if len(points) <= MOST_SHOWN:
        yield from (f"  {kind}: {said}" for kind, said in zip(told, printed, strict=True))
    else:
        yield f"  their text is in the certificate; its sha256 is {digest(chr(10).join(printed))}"
        for loop in claim.loops if claim.kind == "path" else ():
            yield f"  path from {_in_brackets(loop[0])} to {_in_brackets(loop[-1])}"
    turn = 360 if robot.exact["angle_unit"] == "deg" else 2 * PI + Fraction(1, 10**70)
    for j, (name, column) in enumerate(zip(robot.joints, zip(*points, strict=True), strict=True)):
        if claim.joints:
            yield f"  {name!a} {JOINTS[claim.joints[j]]}"
            continue
        if len(points) > MOST_SHOWN:
            ends = f"{exactly(min(column))} and {exactly(max(column))}"
            yield f"  {name!a} is between {ends} {units[j]} in the set"
        if robot.exact["joints"][j]["turns"] and _longest(claim, j) >= turn:
            yield f"  {name!a} takes every angle"


def _longest(claim: Claim, j: int) -> Fraction:
    """Return the length of the longest range of a joint that the cells take without a gap."""
    Work.add(50 * len(claim.corners))
    ranges = sorted((min(q[j] for q in cell), max(q[j] for q in cell)) for cell in claim.corners)
    (start, end), longest = ranges[0], Fraction(0)
    for low, high in ranges:
        start, end = (start, max(end, high)) if low <= end else (low, high)
        longest = max(longest, end - start)
    return longest


# --- the command ----------------------------------------------------------------------------------

PROVED, REFUTED, NO_ANSWER = 0, 3, 2
"""Exit statuses; not 1, which a Python that cannot run this file ends with."""

USAGE = """usage: python -I check.py FILE [--robot ARM.toml]
       python -I check.py FILE --print robot

Check a certificate of qbound: 0 proved, 3 refuted, 2 anything else.

  --robot ARM.toml  the robot file that the certificate must be about
  --print robot     print the normal form of the certificate's robot; its SHA-256 is in the file
  --version         print the format that this file checks
  --help            print this text"""


def main(arguments: Sequence[str]) -> int:
    """Do what the arguments ask for, print the answer, and return the exit status."""
    status, said = NO_ANSWER, "not proved: a fault of the checker itself"
    try:
        status, said = _answer([*arguments])
    except Refused as error:
        said = f"not proved: {error}"
    except MemoryError:
        said = "not proved: the file needs more memory than there is"
    except KeyboardInterrupt:
        status, said = 130, "not proved: interrupted"
    except Exception:  # whatever a hostile file sets off
        pass
    return status if _printed(said) else NO_ANSWER


def _answer(arguments: list[str]) -> tuple[int, str]:
    """Return the exit status and what is to be printed."""
    told = {"--help": USAGE, "--version": f"check.py of {SCHEMA}"}
    if len(arguments) == 1 and arguments[0] in told:
        return PROVED, told[arguments[0]]
    known = 1 <= len(arguments) <= 3 and len(arguments) != 2 and "" not in arguments
    demand(known and arguments[0][:2] != "--", USAGE)
    option = arguments[1] if len(arguments) > 1 else ""
    demand(option in ("", "--robot") or arguments[1:] == ["--print", "robot"], USAGE)
    data = _read_file(arguments[0])
    if option == "--print":
        return PROVED, canonical(read(data)[1].form)[:-1]
    if not option:
        answer = check(data)
    else:
        try:  # as qbound reads a robot file: without a mark, with one sort of line end
            pin = _read_file(arguments[2]).decode("utf-8-sig")
        except UnicodeDecodeError:
            raise Refused(f"{shown(arguments[2])}: not UTF-8 text") from None
        answer = check(data, pin.replace("\r\n", "\n").replace("\r", "\n"), arguments[2])
    return (REFUTED if answer.refuted else PROVED), answer.said


def _read_file(file: str) -> bytes:
    try:
        with Path(file).open("rb") as stream:
            data = stream.read(MAX_FILE + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no such file"
        raise Refused(f"{shown(file)}: cannot be read: {reason}") from None
    demand(len(data) <= MAX_FILE, f"{shown(file)}: more than {MAX_FILE} bytes")
    return data


def _printed(said: str) -> bool:
    """Print a text in ASCII and tell whether it arrived."""
    safe = re.sub(r"[^\n -~]", lambda found: ascii(found[0])[1:-1], said)
    try:
        sys.stdout.write(f"{safe}\n")  # `print` is silent where there is no output
        sys.stdout.flush()
    except (OSError, ValueError, AttributeError):
        try:  # leave nothing for Python to complain about when it closes a broken output
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        except (OSError, ValueError, AttributeError):
            sys.stdout = None
        return False
    return True


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
