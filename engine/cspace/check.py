"""Check a certificate of cspace with nothing but Python's own integers.

usage: python -I check.py FILE [--robot ARM.toml]
       python -I check.py FILE --print robot

    --robot ARM.toml  the robot file that the certificate must be about
    --print robot     print the normal form of its robot, whose SHA-256 is in the file
    --version         print the format that this file checks
    --help            print this text

A certificate claims that every configuration of a set keeps a robot clear of all that it has to
keep clear of, or that one configuration does not, or that no path leads from one configuration to
another. This file decides whether the proof holds. It imports nothing but the standard library,
uses no floating point, and can be copied and run alone. The page "The certificate" of the book
defines the format; what that page does not list is refused.

Read it from top to bottom. The first four parts are the kernel:

    numbers       whole numbers of 2^-224, and how far they can be off
    cells         boxes, segments and triangles, and how they are cut
    kinematics    where the frames are, where a place is, how it moves, how much its path bends
    inequality    why everything is kept, or not kept, all over a leaf
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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Context, Decimal, Inexact
from fractions import Fraction
from functools import cached_property, lru_cache
from operator import lt, mul, sub
from pathlib import Path
from typing import Any, NamedTuple

SCHEMA = "qbound/certificate/6"

Table = dict[str, Any]
Rows = list[Table]
Reader = Callable[[Any, str], Any]
Exact = tuple[Fraction, ...]
"""A configuration in the units of the robot file, or three coordinates."""
Loop = list[tuple[int, int]]


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
#   unit axis by less than 2^18, so it takes a vector of length 1 to a place off by less than 2^20.
# - Rotations do not lengthen vectors, so errors add up. At most 14 steps with 4 rotations each lie
#   between two frames: a rotated vector of length 1 is off by less than 2^26 units.
# - A place is a sum of at most 30 vectors of length 2 or less. So it is shorter than 2^6 and off by
#   less than 2^32 units, its derivatives by less than 2^34. A joint that takes any value projects
#   both on its axis, which adds as much again: with 14 of them 2^38.
# - Configurations are rounded to units. Middles of edges are too, so after 120 cuts the parts of a
#   cell may miss a part of it by 60 units.
# - A joint moves by less than 2^9 within a leaf. In the inequality at most 14 derivatives occur,
#   each times such a step, and in the bend two steps: an error of less than 2^63 units.
# - Seven joints of two steps each, and the sizes of limits and configurations, are what the reader
#   (at the end of this file) lets pass.
#
# Each inequality has to hold with `SLACK` to spare, which is twice as much. `>>` binds less than
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


# --- cells ----------------------------------------------------------------------------------------
# Values of joints are in units too: radians, or parts of the largest length. The corners of the
# cells of a claim are rounded to units, which the slack covers. Cuts lie at whole numbers, so that
# the two halves have the same face.

Point = tuple[int, ...]


@dataclass(frozen=True)
class Cell:
    """A segment or a triangle, by its corners."""

    ends: tuple[Point, ...]

    @cached_property
    def middle(self) -> Point:
        """Return the mean of the corners, rounded down."""
        return tuple(sum(column) // len(self.ends) for column in zip(*self.ends, strict=True))

    @cached_property
    def steps(self) -> list[Point]:
        """Return the way from the middle to each corner."""
        return [tuple(map(sub, corner, self.middle)) for corner in self.ends]

    @cached_property
    def widths(self) -> Point:
        """Return for each joint the largest distance of a corner from the middle."""
        return tuple(max(map(abs, column)) for column in zip(*self.steps, strict=True))

    def least(self, slopes: Sequence[int]) -> int:
        """Return the least sum of slope * offset over all corners, rounded down."""
        least: int = min(sum(map(mul, slopes, step)) for step in self.steps)
        return least >> BITS

    def offsets(self, joints: set[int]) -> Iterable[Point]:
        """Return the ways from the middle to the corners, as far as some joints tell them apart."""
        del joints
        return self.steps

    def halves(self, letter: int) -> "tuple[Cell, Cell]":
        """Cut an edge at its middle: the half that keeps its first end, then the other one."""
        edges = [*itertools.combinations(range(len(self.ends)), 2)]
        demand(letter < len(edges), "proof: a tree cuts an edge that its cell does not have")
        i, k = edges[letter]
        first, second = [*self.ends], [*self.ends]
        first[k] = second[i] = Cell((self.ends[i], self.ends[k])).middle
        return Cell(tuple(first)), Cell(tuple(second))


class Box(Cell):
    """All configurations between a low and a high corner, which are its ends."""

    def least(self, slopes: Sequence[int]) -> int:
        """Return the least sum of slope * offset over all corners, rounded down."""
        return -sum((abs(s) * d >> BITS) + 1 for s, d in zip(slopes, self.widths, strict=True))

    def offsets(self, joints: set[int]) -> Iterable[Point]:
        """Return the ways from the middle to the corners, as far as some joints tell them apart."""
        ends = [(d, -d) if d and j in joints else (0,) for j, d in enumerate(self.widths)]
        return itertools.product(*ends)

    def halves(self, letter: int) -> "tuple[Cell, Cell]":
        """Cut at the middle of a joint: the lower half and the upper one."""
        low, high = self.ends
        wide = letter < len(low) and low[letter] < high[letter]
        demand(wide, "proof: a tree cuts a joint that the box does not have, or that has no range")
        cut = low[letter] + high[letter] >> 1
        above, below = ((*end[:letter], cut, *end[letter + 1 :]) for end in self.ends)
        return Box((low, below)), Box((above, high))


# --- kinematics -----------------------------------------------------------------------------------


class Step(NamedTuple):
    """A translation, a fixed rotation, and a turn about an axis or a slide along it.

    Its value is factor * (value of its joint); factor is 1 or -1.
    """

    joint: int
    turns: bool
    factor: int
    origin: Vector
    mount: Matrix
    axis: Vector


class Motion(NamedTuple):
    """Where a place is and how it moves, in coordinates of the base, at a leaf's middle.

    The near frame is held where it is at the middle. Let the steps k of the arm be off their middle
    by d_k, within the leaf: then the place is at most `bend` + `radius` away from `place` + the sum
    of d_k `slopes[k]`.
    """

    place: Vector
    slopes: dict[int, Vector]
    bend: int
    radius: int


class Leaf:
    """An arm on a cell: at the middle its frames, and the axes of its steps, seen from the base.

    free : joints that take any value, each with a number that is at least the distance of its
        values from the middle, if it slides.
    """

    def __init__(self, steps: Sequence[Step], cell: Cell, free: Mapping[int, int] = {}) -> None:
        Work.add(60 * len(steps))
        self.steps, self.cell, self.free = steps, cell, free
        self.widths = [cell.widths[step.joint] for step in steps]
        turned, at = AXES, (0, 0, 0)
        self.frames: list[tuple[Matrix, Vector]] = [(turned, at)]
        self.axes: list[tuple[Vector, Vector]] = []
        for step in steps:
            at = plus(at, image(turned, step.origin))
            turned = product(turned, step.mount)
            axis = image(turned, step.axis)
            self.axes.append((axis, at))
            value = step.factor * cell.middle[step.joint]
            if step.turns:
                turned = product(turned, rotation(step.axis, value))
            else:
                at = plus(at, times(value, axis))
            self.frames.append((turned, at))

    def place(self, frame: int, corner: Vector) -> Vector:
        """Return where a place of a frame is at the middle, seen from the base."""
        turned, at = self.frames[frame]
        return plus(at, image(turned, corner))

    def motion(self, near: int, far: int, corner: Vector) -> Motion:
        """Follow a corner of frame `far` inwards to frame `near`, one step of the arm at a time.

        Let E_k be the motion by d_k about the axis of step k as it lies at the middle. Move the
        outermost step first: the axes nearer the base then still lie as at the middle. So the place
        r goes to E_1 ... E_n r, and this differs from r by the sum of
        L_1 ... L_{k-1} (E_k r - r), where L_i is the rotation of E_i. The chord E_k r - r is the
        integral of the slope s_k, turned by 0 to d_k, and the rotations before it turn it by up to
        the sum of their d_i. A vector that is turned by an angle moves by at most this angle times
        its length. So what is not linear is at most, with D_k the half width of the leaf in d_k,

            bend = sum over k of D_k |s_k| (sum over i < k that turn of D_i, + D_k / 2 if k turns).

        A free step that turns: it keeps what is along its axis and turns what is across it
        anywhere. So the place and each slope are replaced by their parts along the axis, and the
        length of what is across is added to `radius`. A turn of the part along is bounded as
        before.
        """
        Work.add(25 * (far - near + 1))
        r, slopes, radius = self.place(far, corner), dict[int, Vector](), 0
        for k in reversed(range(near, far)):
            step, (axis, pivot) = self.steps[k], self.axes[k]
            if step.joint not in self.free:
                slopes[k] = cross(axis, minus(r, pivot)) if step.turns else axis
            elif not step.turns:
                radius += self.free[step.joint]
            else:
                foot = plus(pivot, times(dot(axis, minus(r, pivot)), axis))
                r, across = foot, size(minus(r, foot))
                for i, slope in slopes.items():
                    slopes[i] = times(dot(axis, slope), axis)
                    across += (self.widths[i] * size(minus(slope, slopes[i])) >> BITS) + 1
                radius += across
        bend = turned = 0
        for k in sorted(slopes):
            own = self.widths[k] if self.steps[k].turns else 0
            bend += (self.widths[k] * size(slopes[k]) >> BITS) * (2 * turned + own)  # twice it
            turned += own
        return Motion(r, slopes, (bend >> BITS + 1) + len(slopes) + 1, radius)


# --- the inequality -------------------------------------------------------------------------------


class Hull(NamedTuple):
    """The convex hull of some corners of a frame."""

    frame: int
    corners: tuple[Vector, ...]


class Keep(NamedTuple):
    """Two hulls that stay at least `gap` apart (0: no overlap), or one above a plane of the base.

    near : its frame is that of `far`, or nearer the base; for a plane the origin of the base.
    gap : radii, clearance or offset, and the claim's margin; that of the normal form is without it.
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

    @property
    def needs_proof(self) -> bool:
        """Tell whether trees are wanted: a point and a point or a segment are at least 0 apart."""
        few = len(self.near.corners) + len(self.far.corners) <= 3
        return self.normal is not None or self.asked or not few


def is_kept(leaf: Leaf, keep: Keep, u: Vector) -> bool:
    """Prove that something is kept all over a leaf; u is a unit vector, seen from the near frame.

    With r of the far hull and p of the near one, their distance is at least u . (r - p), and over
    the leaf u . r is at least its linear part less the bend (and the radius, if joints are free).
    What is linear is least at a corner of the leaf, and least or largest over a hull at one of its
    corners.
    """
    Work.add(3 * len(keep.near.corners))
    matrix, at = leaf.frames[keep.near.frame]
    w, nearest = image(matrix, u), max(dot(u, p) for p in keep.near.corners)
    for corner in keep.far.corners:
        found = leaf.motion(keep.near.frame, keep.far.frame, corner)
        slopes = [0] * len(leaf.cell.middle)
        for k, slope in found.slopes.items():
            slopes[leaf.steps[k].joint] += leaf.steps[k].factor * dot(w, slope)
        low = dot(w, minus(found.place, at)) + leaf.cell.least(slopes) - found.bend - found.radius
        if low <= nearest + keep.gap + SLACK:
            return False
    return True


class Spots(NamedTuple):
    """A place of each hull, and the sum of the radii of discs about them that lie in the hulls."""

    near: Vector
    far: Vector
    radii: int


def is_violated(leaf: Leaf, keep: Keep, spots: Spots) -> bool:
    """Prove that something is not kept anywhere on a leaf, whatever the free joints.

    But for its bend, the way between the two places is linear in the offset from the middle, so its
    length is convex and largest at a corner of the leaf. Discs lie in planes that are parallel
    within `NEARLY` at joint values 0 and at one height within `NEARLY`; later their planes are
    tilted by less than 2^6 times that, and what the tilt takes from their radii is far below it.
    """
    found = leaf.motion(keep.near.frame, keep.far.frame, spots.far)
    start = minus(found.place, leaf.place(keep.near.frame, spots.near))
    spare = NEARLY if spots.radii else SLACK
    allowed = keep.gap + spots.radii - found.bend - found.radius - spare
    for offset in leaf.cell.offsets({leaf.steps[k].joint for k in found.slopes}):
        Work.add(10 + 3 * len(found.slopes))
        w = start
        for k, slope in found.slopes.items():
            w = plus(w, times(leaf.steps[k].factor * offset[leaf.steps[k].joint], slope))
        if keep.along is not None:
            axis = leaf.frames[keep.near.frame][0][keep.along]
            w = minus(w, times(dot(axis, w), axis))
        if (size(w) if keep.normal is None else dot(keep.normal, w)) >= allowed:
            return False
    return True


# --- the claims -----------------------------------------------------------------------------------

MAX_DEPTH = 120
"""Cuts on top of each other in a tree."""

LETTER = re.compile("([a-g]|(?:0|[1-9][0-9]{0,5})?[.])|.", re.DOTALL)


def tokens(tree: Any, where: str) -> Iterator[str]:
    """Yield the letters and leaves of a tree one after the other."""
    for found in LETTER.finditer(tree if type(tree) is str else ""):
        demand(found[1], f"{where}: no tree of letters and leaves")
        yield found[1]


def walk(cell: Cell, trees: dict[str, Any]) -> Iterator[tuple[Cell, int, dict[str, str]]]:
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


def prove_safe(arm: "Arm", claim: "Claim", proof: Any) -> str:
    """Verify the trees of all things to keep, cell by cell; say what is proved."""
    for q in itertools.chain(*claim.corners):
        for limit in arm.robot.beyond(q):
            raise Refused(f"claim: beyond the limit {shown(limit)}")
    make = Box if claim.kind == "box" else Cell
    cells = [make(tuple(map(arm.placed, corners))) for corners in claim.corners]
    trees = items(anything, len(arm.keeps), len(arm.keeps))
    found = table({"directions": items(direction, 0, MAX_CELLS), "trees": trees})(proof, "proof")
    rows = [*enumerate(zip(arm.keeps, found["trees"], strict=True))]
    for k, (keep, row) in rows:
        wanted = len(cells) if keep.needs_proof else 0
        items(anything, wanted, wanted)(row, f"proof.trees[{k}]")
    for c, cell in enumerate(cells):
        own = {f"proof.trees[{k}][{c}]": (keep, row[c]) for k, (keep, row) in rows if row}
        for part, _, leaves in walk(cell, {where: tree for where, (_, tree) in own.items()}):
            leaf = Leaf(arm.steps if leaves else (), part)
            for where, number in leaves.items():
                keep = own[where][0]
                u = named_direction(keep, number, found["directions"], where)
                fails = f"{where}: the bound of {shown(keep.name)} fails on a leaf"
                demand(is_kept(leaf, keep, u), fails)
    return "proved: at every configuration of the set all of the following is kept"


def direction(value: Any, where: str) -> Any:
    """Read three integers."""
    row = items(anything, 3, 3)(value, where)
    whole = {*map(type, row)} == {int} and any(row)
    demand(whole, f"{where}: three integers, not all 0, are wanted")
    return row


def named_direction(keep: Keep, number: str, rows: Sequence[Any], where: str) -> Vector:
    """Return the direction that a leaf names; that of a half-space is its normal."""
    if keep.normal is not None:
        demand(not number, f"{where}: a leaf of a half-space names a direction")
        return keep.normal
    known = number and int(number) < len(rows)
    demand(known, f"{where}: a leaf names no direction of the list")
    row = rows[int(number)]
    across = keep.along is None or row[keep.along] == 0
    demand(across, f"{where}: a direction between bodies has a 0 along the common axis")
    return unit(row)


def refute(arm: "Arm", claim: "Claim", value: Any) -> str:
    """Verify a witness, and say what is violated where."""
    robot, kind = arm.robot, "limit" if type(value) is dict and "limit" in value else "place"
    if claim.kind == "box":
        found = table({kind: anything, "at": configuration(robot)})(value, "witness")
        q, (low, high) = found["at"], claim.loops[0]
        inside = all(a <= x <= b for a, x, b in zip(low, q, high, strict=True))
        demand(inside, "witness.at: not in the box")
    else:
        spec = {"cell": index(len(claim.corners)), "weights": weights(len(claim.corners[0]))}
        found = table({kind: anything, **spec})(value, "witness")
        q = mean(found["weights"], claim.corners[found["cell"]])
    if kind == "limit":
        there = found["limit"] in robot.beyond(q)
        demand(there, "witness.limit: no limit of that name is violated")
        said = f"the limit {found['limit']!a}"
    else:
        demand(not robot.beyond(q), "witness.place: a limit is violated there: name that")
        keep, spots = read_spots(arm)(found["place"], "witness.place")
        leaf = Leaf(arm.steps, Box((arm.placed(q), arm.placed(q))))
        violated = is_violated(leaf, keep, spots) or _cross(leaf, keep)
        demand(violated, f"witness: {shown(keep.name)} is not violated there")
        said = f"{keep.name!a}"
    values = ", ".join(itertools.starmap(robot.valued, enumerate(q)))
    return f"refuted: {said} is violated at {values}\nthe claim was that the set keeps"


def _cross(leaf: Leaf, keep: Keep) -> bool:
    """Tell whether two segments that keep no distance cross, seen along the common axis."""
    hulls = keep.near, keep.far
    near, far = ([leaf.place(hull.frame, p) for p in hull.corners] for hull in hulls)
    if keep.asked or keep.along is None or (len(near), len(far)) != (2, 2):
        return False
    axis = leaf.frames[keep.near.frame][0][keep.along]
    for (p, q), ends in ((near, far), (far, near)):
        sides = [dot(axis, cross(minus(q, p), minus(r, p))) for r in ends]
        if min(sides) >= -SLACK or max(sides) <= SLACK:
            return False
    return True


def read_spots(arm: "Arm") -> Reader:
    """Return the reader of a place of each hull of a thing to keep, and the discs about them."""
    spec = {"keep": index(len(arm.keeps)), "near": anything, "far": anything}
    place = table(spec, {"inside": items(not_negative(decimal), 2, 2)})

    def read(value: Any, where: str) -> tuple[Keep, Spots]:
        found = place(value, where)
        keep, row = arm.keeps[found["keep"]], arm.rows[found["keep"]]
        radii = found["inside"] or (ZERO, ZERO)
        demand(not any(radii) or keep.along is not None, f"{where}.inside: of bodies only")
        ends = list[Vector]()
        for end, radius in zip(("near", "far"), radii, strict=True):
            hull = arm.hulls[row[end]] if end in row else NO_HULL
            corners = hull["corners"]
            at = mean(weights(len(corners))(found[end], f"{where}.{end}"), corners)
            within = not radius or _holds_disc(corners, arm.robot.flat[hull["frame"]], at, radius)
            demand(within, f"{where}.inside: the disc does not lie within the part")
            ends.append(arm.scaled(at or ORIGIN))
        near, far = ends
        return keep, Spots(near, far, in_units(sum(radii) / arm.largest))

    return read


def _holds_disc(corners: Sequence[Exact], flat: int, at: Exact, radius: Fraction) -> bool:
    """Tell whether a disc lies within a convex part: no edge is nearer to its middle than that."""
    Work.add(120 * len(corners))
    (x, y), *loop = (p[:flat] + p[flat + 1 :] for p in (at, *corners))
    sense = 1 if doubled_area(loop) > 0 else -1
    for (a, b), (c, d) in around(loop):
        inwards = sense * ((c - a) * (y - b) - (d - b) * (x - a))
        if inwards <= 0 or inwards**2 < radius**2 * ((c - a) ** 2 + (d - b) ** 2):
            return False
    return True


TOUCH = 1 << BITS - 100
"""Open leaves that are nearer than this touch: 8e-31 of a radian or of the largest length."""


@dataclass(eq=False, slots=True)
class Node:
    """A box of a tree: with its halves, or a leaf; what keeps all lies in open leaves."""

    box: Cell
    is_open: bool
    halves: "list[Node]" = field(default_factory=list)

    def touching(self, box: Cell, shifts: Sequence[Point]) -> "Iterator[Node]":
        """Yield the open leaves that touch a box, over the seams of joints too."""
        for shift in shifts:
            low = [x + s - TOUCH for x, s in zip(box.ends[0], shift, strict=True)]
            high = [x + s + TOUCH for x, s in zip(box.ends[1], shift, strict=True)]
            todo = [self]
            while todo:
                Work.add(5)
                node = todo.pop()
                start, end = node.box.ends
                if not (any(map(lt, end, low)) or any(map(lt, high, start))):
                    todo += node.halves
                    if node.is_open:
                        yield node


def prove_no_path(arm: "Arm", claim: "Claim", proof: Any) -> str:
    """Verify that no path gets past the leaves on which something is violated; say so.

    A path that keeps everything lies in open leaves. They are closed and finitely many, so a path
    stays within a group of leaves that touch.
    """
    places = items(read_spots(arm), 0, MAX_CELLS)
    found = table({"places": places, "tree": anything})(proof, "proof")
    [ends] = claim.loops
    for end, q in zip(("start", "goal"), ends, strict=True):
        demand(not arm.robot.beyond(q), f"claim.points: the {end} is beyond a limit")
    start, goal = map(arm.placed, ends)
    spans, turns, free = list[Point](), list[int](), dict[int, int]()
    for j, kind in enumerate(claim.joints):
        low, high = arm.whole_range(j)
        middle = low + high >> 1
        if kind == "any":
            free[j] = high - low + 3 >> 1
        spans.append({"moves": (low, high), "held": (start[j],) * 2, "any": (middle,) * 2}[kind])
        turns.append(TURN if kind == "moves" and arm.joints[j]["limits"] is None else 0)
    shifts = [*itertools.product(*({-t, 0, t} for t in turns))]
    low_end, high_end = zip(*spans, strict=True)
    above = list[Node]()
    for part, depth, leaves in walk(Box((low_end, high_end)), {"proof.tree": found["tree"]}):
        Work.add(90)  # a node takes half a kilobyte
        number = leaves.get("proof.tree")
        node = Node(part, number == "")
        del above[depth:]
        if above:
            above[-1].halves.append(node)
        above.append(node)
        if number:
            known = int(number) < len(found["places"])
            demand(known, "proof.tree: a leaf names no place of the list")
            keep, spots = found["places"][int(number)]
            violated = is_violated(Leaf(arm.steps, part, free), keep, spots)
            demand(violated, f"proof.tree: {shown(keep.name)} is not violated all over a leaf")
    groups = list[set[Node]]()
    for end_at in (start, goal):  # on the turn that the tree covers
        at = [(x + t // 2) % t - t // 2 if t else x for x, t in zip(end_at, turns, strict=True)]
        place = tuple(low_end[j] if j in free else x for j, x in enumerate(at))
        groups.append({*above[0].touching(Box((place, place)), shifts)})
        demand(groups[-1], "proof.tree: the start or the goal is on no open leaf")
    reached, goals = groups
    new = [*reached]
    while new:
        near = {*above[0].touching(new.pop().box, shifts)} - reached
        reached |= near
        new += near
    demand(not reached & goals, "proof.tree: open leaves lead from the start to the goal")
    one, other = map(_in_brackets, ends)
    return f"proved: no path from {one} to {other} keeps all of the following"


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
ORIGIN: Exact = (ZERO, ZERO, ZERO)


def shown(text: str) -> str:
    """Write a text for a message: short, in ASCII, on one line."""
    return ascii(text if len(text) <= 60 else f"{text[:57]}...")


def anything(value: Any, where: str) -> Any:
    """Return a value as it is: it is read later."""
    del where
    return value


def such(test: Callable[[Any], object], told: str, reader: Reader = anything) -> Reader:
    """Return the reader of a value that has to pass a test."""

    def read(value: Any, where: str) -> Any:
        found = reader(value, where)
        demand(test(found), f"{where}: {told}")
        return found

    return read


def table(readers: Mapping[str, Reader], others: Mapping[str, Reader] = {}) -> Reader:
    """Return the reader of a table with some keys; it gives None for others that are missing."""
    every = {**readers, **others}

    def read(value: Any, where: str) -> Table:
        demand(type(value) is dict, f"{where}: a table is wanted")
        for key in value:
            demand(key in every, f"{where}: unknown key {shown(key)}")
        for key in readers:
            demand(key in value, f"{where}: the key {key!r} is missing")
        found: Table = dict.fromkeys(others)
        return found | {key: every[key](value[key], f"{where}.{key}") for key in value}

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

    def fits(value: Any) -> bool:
        short = type(value) is str and 1 <= len(value) <= most
        return short and not re.search("[\ud800-\udfff]", value)

    return such(fits, f"a text of 1 to {most} characters is wanted")


def one_of(*choices: Any) -> Reader:
    """Return the reader of a value that is among some."""
    told = f"{' or '.join(map(str, choices))} is wanted"
    return such(lambda x: type(x) is type(choices[0]) and x in choices, told)


def index(count: int) -> Reader:
    """Return the reader of a number from 0 to `count` - 1."""
    return such(lambda x: type(x) is int and 0 <= x < count, f"0 to {count - 1} is wanted")


NUMBER = re.compile("[+-]?([0-9]+)(?:[.]([0-9]+))?(?:[eE][+-]?[0-9]{1,3})?")


def exact(written: str, where: str) -> Fraction:
    """Return the value of a decimal; its digits and its size are bounded."""
    found = NUMBER.fullmatch(written)
    if found is None:
        raise Refused(f"{where}: {shown(written)} is no decimal number")
    digits = sum(map(len, found.groups("")))
    demand(digits <= MAX_DIGITS, f"{where}: a number of more than {MAX_DIGITS} digits")
    value = Fraction(written)
    fits = not value or 1 / LARGEST <= abs(value) <= LARGEST
    demand(fits, f"{where}: a number that is not 0 has a size between 1e-100 and 1e100")
    return value


def decimal(value: Any, where: str) -> Fraction:
    """Read a decimal of a certificate: a string such as "-12.5"."""
    known = type(value) is str and value[:1] != "+"
    demand(known, f'{where}: a decimal number in quotes is wanted, such as "-12.5"')
    return exact(value, where)


def not_negative(reader: Reader) -> Reader:
    """Return the reader of a number of 0 or more."""
    return such(lambda x: x >= 0, "a number of 0 or more is wanted", reader)


def weights(count: int) -> Reader:
    """Return the reader of the weights of a mean of corners."""
    shares = items(not_negative(decimal), count, count)
    return such(lambda row: not row or sum(row) == 1, "weights whose sum is 1 are wanted", shares)


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
        raise Refused(f"the file is not JSON: {error}") from None


def _unique(pairs: list[tuple[str, Any]]) -> Table:
    found = dict(pairs)
    demand(len(found) == len(pairs), "the file has a key twice in one object")
    return found


def _integer(written: str) -> int:
    known = re.fullmatch("0|-?[1-9][0-9]{0,8}", written)
    demand(known, f"the file has the number {shown(written)}: decimals are written as strings")
    return int(written)


# --- reading: the robot's text --------------------------------------------------------------------

STRING = re.compile(r"""("(?:[^"\\\n]|\\[^\n]){0,300}"|'[^'\n]{0,300}')|[#][^\n]*""")
WORD = r"[^ \t\r\n=,\[\]{}]"
BARRED = {
    "[\"']": "a string that does not end, or of more than 300 characters",
    f"{WORD}{{101}}": "a word of more than 100 characters",
    rf"{WORD}[ \t\r]+{WORD}": "a word follows another word or string",
    rf"[.]{WORD}*[.]": "a word with two dots",
    rf"[.]{WORD}*[ \t\r]*=": "a key with a dot",
}
"""What robots do not need, and on some of which Python's reader of TOML works for long: dotted keys
cost it the square of their number of parts, tables in tables more."""

MAX_NESTED = 8


class Float(str):
    """A float as the robot's text writes it; so it is neither rounded nor taken for a string."""


def read_toml(written: str) -> Any:
    """Read TOML after a look at its marks; for that look strings are words and comments nothing."""
    plain = STRING.sub(lambda found: " _ " if found[1] else "", written)
    for pattern, barred in BARRED.items():
        if found := re.search(pattern, plain):
            k = plain.count("\n", 0, found.start())
            raise Refused(f"robot: line {k + 1}: {barred}: {shown(written.split(chr(10))[k])}")
    depths = itertools.accumulate((c in "[{") - (c in "]}") for c in plain)
    deep = max(depths, default=0) > MAX_NESTED
    demand(not deep, f"robot: more than {MAX_NESTED} brackets in each other")
    try:
        return tomllib.loads(written, parse_float=Float)
    except ValueError as error:  # also an integer of thousands of digits
        raise Refused(f"robot: no TOML: {error}") from None


def number(value: Any, where: str) -> Fraction:
    """Read an integer or a float of TOML."""
    demand(type(value) in (int, Float), f"{where}: a number is wanted")
    return exact(str(value).replace("_", ""), where)


def fields(spec: str) -> Reader:
    """Return the reader of a table from its keys, each with its kind; `key?` may be missing."""

    def read(value: Any, where: str) -> Any:
        wanted, others = dict[str, Reader](), dict[str, Reader]()
        for row in spec.split(", "):
            key, kind = row.split()
            reader = one_of(*kind.split("|")) if "|" in kind else KINDS[kind.removesuffix("[]")]
            reader = items(reader, 0, MAX_ROWS) if kind[-1] == "]" else reader
            (others if key[-1] == "?" else wanted)[key.rstrip("?")] = reader
        return table(wanted, others)(value, where)

    return read


def boundary(value: Any, where: str) -> Any:
    """Read a boundary by its type."""
    kind = one_of(*BOUNDARIES)(value.get("type") if type(value) is dict else None, f"{where}.type")
    return fields(f"name label, type anything, used? truth, {BOUNDARIES[kind]}")(value, where)


SHAPES = "polygon? outline, capsule? capsule, disc? disc"
BOUNDARIES = {
    "pair": "points two-labels, clearance? size",
    "bodies": "bodies two-labels, clearance? size",
    "half-space": "normal direction, offset number, point? label, body? label",
}
JOINT = """name label, type revolute|prismatic|parallelogram|continuous, parent label, \
frame label, origin vector, axis direction, rpy? vector, limits? limits, velocity? velocity, \
crank? vector, bar? label"""
ROBOT = """schema schema, name label, length_unit m|cm|mm, angle_unit deg|rad, home anything, \
tool label, joint joints, point point[], boundary? boundary[], body? body[], obstacle? obstacle[], \
collisions? every, clearance? size, allowed? two-labels[], left_out? label[]"""
KINDS: dict[str, Reader] = {
    "anything": anything,
    "schema": one_of(1),
    "truth": one_of(True, False),
    "every": one_of("all"),
    "label": text(200),
    "two-labels": items(text(200), 2, 2),
    "number": number,
    "size": not_negative(number),
    "vector": items(number, 3, 3),
    "direction": such(any, "a direction must not be 0", items(number, 3, 3)),
    "limits": such(lambda x: x[0] < x[1], "the first one must be less", items(number, 2, 2)),
    "velocity": such(lambda x: x > 0, "a number of more than 0 is wanted", number),
    "corner": items(number, 2, 3),
    "outline": items(items(number, 2, 3), 3, MAX_CORNERS),
    "capsule": fields("from corner, to corner, radius size"),
    "disc": fields("at corner, radius size"),
    "joints": items(fields(JOINT), 1, MAX_JOINTS),
    "point": fields("name label, frame label, at vector, radius? size"),
    "body": fields(f"name? label, frame label, {SHAPES}"),
    "obstacle": fields(f"name? label, {SHAPES}"),
    "boundary": boundary,
}
"""Kinds of values in a robot's text; `kind[]` is a list of at most `MAX_ROWS`."""

# --- reading: the robot ---------------------------------------------------------------------------


class Thing(NamedTuple):
    """A point, or a body: a core of one corner, of a segment, or of an outline, with a radius."""

    name: str
    kind: str
    frame: int
    corners: tuple[Exact, ...]
    radius: Fraction


Things = dict[str, Thing]


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
    form : the normal form, see the page, with exact numbers
    frames : names, the base first
    boundaries : those in use
    left_out : what is not to be kept, in words
    flat : of each frame with bodies, its coordinate along the common axis
    """

    form: Table
    frames: list[str]
    boundaries: list[Boundary]
    left_out: list[str]
    flat: dict[int, int]

    @property
    def joints(self) -> list[str]:
        """Return the names of joints."""
        return [joint["name"] for joint in self.form["joints"]]

    def unit_of(self, j: int) -> str:
        """Return the unit of a joint's values."""
        turns = self.form["joints"][j]["turns"]
        return str(self.form["angle_unit" if turns else "length_unit"])

    def valued(self, j: int, x: Fraction) -> str:
        """Write the value of a joint."""
        return f"{self.joints[j]!a} = {exactly(x)} {self.unit_of(j)}"

    def beyond(self, q: Exact) -> list[str]:
        """Return the names of the limits that a configuration is beyond: compared exactly."""
        found = []
        for joint, value in zip(self.form["joints"], q, strict=True):
            low, high = joint["limits"] or (value, value)
            found += [f"{joint['name']}.lower"] * (value < low)
            found += [f"{joint['name']}.upper"] * (value > high)
        return found


EXACTLY = Context(prec=2000, traps=[Inexact])


def exactly(x: Fraction) -> str:
    """Write a decimal with all its digits and without an exponent."""
    return f"{EXACTLY.divide(Decimal(x.numerator), Decimal(x.denominator)):f}"


def canonical(form: Any) -> str:
    """Return the text of a normal form, whose hash stands in a certificate."""
    return json.dumps(form, default=exactly, indent=1, sort_keys=True) + "\n"


def read_robot(written: str, parts: Any) -> Robot:
    """Read a robot's text and bring it to its normal form."""
    file = fields(ROBOT)(read_toml(written), "robot")
    joints, steps, frames = _joints(file)
    points = {row["name"]: _thing(row, frames) for row in file["point"]}
    distinct("point", (row["name"] for row in file["point"]))
    demand(not {*points} & {*frames}, "robot: a point has the name of a frame")
    demand(file["tool"] in points, "robot: the tool is no point")
    table({joint["name"]: number for joint in joints})(file["home"], "robot.home")
    bodies = {body.name: body for body in _bodies(file, frames)}
    boundaries, left_out = _boundaries(file, points, bodies)
    form = {key: file[key] for key in ("name", "length_unit", "angle_unit")}
    form |= {"joints": joints, "steps": steps}
    used = {t.frame for boundary in boundaries for t in boundary.things if t.kind != "point"}
    flat = _common_axis(form, used)
    form["hulls"], form["keep"] = _keeps(boundaries, flat, parts)
    left_out += _unchecked(points, boundaries)
    if file["left_out"]:
        form["left_out"] = [*file["left_out"]]
        left_out.append(f"links that the file does not describe: {form['left_out']!a}")
    return Robot(form, frames, boundaries, left_out, flat)


def distinct(what: str, names: Iterable[str]) -> set[str]:
    """Return names as a set; refuse one that stands for two."""
    found = set[str]()
    for named in names:
        demand(named not in found, f"robot: {what}: two are called {shown(named)}")
        found.add(named)
    return found


LARGEST_ANGLE = {"deg": Fraction(1800), "rad": Fraction(30)}


def _joints(file: Table) -> tuple[Rows, Rows, list[str]]:
    """Return joints, the steps that they make, and the names of frames, the base first."""
    joints, steps, frames = Rows(), Rows(), [file["joint"][0]["parent"]]
    largest = LARGEST_ANGLE[file["angle_unit"]]
    hundred = 100 * {"deg": Fraction(360), "rad": 2 * PI}[file["angle_unit"]]
    for j, row in enumerate(file["joint"]):
        kind, limits, rpy = row["type"], row["limits"], row["rpy"] or ORIGIN
        crank, bar, turns = row["crank"], row["bar"], kind != "prismatic"
        linked = (crank is not None) == (bar is not None) == (kind == "parallelogram")
        span = limits[1] - limits[0] if turns and limits else 0
        for fits, told in (
            (row["parent"] == frames[-1], ": its parent is not the frame before"),
            (linked, ": crank and bar belong to a parallelogram"),
            (turns or limits, ": a prismatic joint needs limits"),
            (kind != "continuous" or not limits, ": a continuous joint has no limits"),
            (max(map(abs, rpy)) <= largest, ".rpy: an angle of more than five turns"),
            (span <= hundred, ".limits: more than 100 turns apart"),
        ):
            demand(fits, f"robot.joint[{j}]{told}")
        joints.append({"name": row["name"], "turns": turns, "limits": limits})
        step = {"joint": j, "factor": Fraction(1), "offset": ZERO, "axis": row["axis"]}
        steps.append({**step, "origin": row["origin"], "rpy": rpy})
        if bar:
            frames.append(bar)
            steps.append({**step, "factor": Fraction(-1), "origin": crank, "rpy": ORIGIN})
        frames.append(row["frame"])
    distinct("joint", (joint["name"] for joint in joints))
    distinct("frame", frames)
    return joints, steps, frames


def _thing(row: Table, frames: Sequence[str]) -> Thing:
    """Return a point or a body; the corners of a body have two numbers or three."""
    demand(row["frame"] in frames, f"robot: no frame is called {shown(row['frame'])}")
    shapes = {kind: row[kind] for kind in ("polygon", "capsule", "disc") if row.get(kind)}
    one = "at" in row or len(shapes) == 1
    demand(one, "robot: a body has one shape: a polygon, a capsule or a disc")
    [(kind, shape)] = shapes.items() or [("point", row)]
    whole = kind == "polygon"
    corners: Any = shape if whole else [shape[end] for end in ("at", "from", "to") if end in shape]
    radius = ZERO if whole else shape["radius"] or ZERO
    return Thing(row["name"], kind, frames.index(row["frame"]), tuple(corners), radius)


def _bodies(file: Table, frames: Sequence[str]) -> list[Thing]:
    """Return bodies along the chain, obstacles last; one without a name is called by its frame."""
    bodies = [_thing(row, frames) for row in file["body"] or ()]
    bodies.sort(key=lambda body: body.frame)
    bodies += [_thing({**row, "frame": frames[0]}, frames) for row in file["obstacle"] or ()]
    demand(len(bodies) <= MAX_ROWS, f"robot: more than {MAX_ROWS} bodies")
    for k, body in enumerate(bodies):
        count = sum(other.frame == body.frame for other in bodies[: k + 1])
        usual = frames[body.frame] + f"/{count}" * (count > 1)
        bodies[k] = body._replace(name=body.name or usual)
    distinct("body", (body.name for body in bodies))
    return bodies


def _boundaries(file: Table, points: Things, bodies: Things) -> tuple[list[Boundary], list[str]]:
    """Return the boundaries in use, those that `collisions` makes last, and what is left out."""
    found, unused, apart = list[Boundary](), list[str](), set[frozenset[str]]()

    def things_of(names: Sequence[str], known: Things, where: str) -> tuple[Thing, ...]:
        for named in names:
            demand(named in known, f"{where}: nothing is called {shown(named)}")
        demand(len({*names}) == len(names), f"{where}: two different names are wanted")
        return tuple(known[named] for named in names)

    for names in file["allowed"] or ():
        things_of(names, bodies, "allowed")
        apart.add(frozenset(names))
    for i, row in enumerate(file["boundary"] or ()):
        where, plane = f"robot.boundary[{i}]", row["type"] == "half-space"
        ends = [key for key in ("points", "bodies", "point", "body") if row.get(key)]
        demand(len(ends) == 1, f"{where}: a point or a body is wanted")
        names = (row[ends[0]],) if plane else row[ends[0]]
        things = things_of(names, bodies if ends[0][0] == "b" else points, where)
        if row["type"] == "bodies":
            demand(things[0].frame != things[1].frame, f"{where}: two bodies of one frame")
            apart.add(frozenset(names))
        distance = row["offset"] if plane else row["clearance"] or ZERO
        found.append(Boundary(row["name"], things, row.get("normal"), distance))
        unused += [row["name"]] * (row["used"] is False)
    for one, other in itertools.combinations(bodies.values(), 2) if file["collisions"] else ():
        Work.add(2)
        if one.frame != other.frame and frozenset((one.name, other.name)) not in apart:
            demand(len(found) < 2 * MAX_ROWS, "robot: too many pairs of bodies")
            named, distance = f"{one.name}, {other.name}", file["clearance"] or ZERO
            found.append(Boundary(named, (one, other), None, distance))
    limits = {f"{joint['name']}.{side}" for joint in file["joint"] for side in ("lower", "upper")}
    names_of_all = distinct("boundary", (boundary.name for boundary in found))
    demand(not limits & names_of_all, "robot: a boundary has the name of a limit")
    without = {*unused}
    used = [boundary for boundary in found if boundary.name not in without]
    demand(len(used) <= MAX_BOUNDARIES, f"robot: more than {MAX_BOUNDARIES} boundaries in use")
    left_out = [f"{named!a} (used = false)" for named in unused]
    left_out += [f"{len(file['allowed'] or ())} allowed pairs"] * bool(file["allowed"])
    left_out += ["bodies of one frame" if file["collisions"] else "other bodies"] * bool(bodies)
    return used, left_out


def _unchecked(points: Things, boundaries: Sequence[Boundary]) -> list[str]:
    """Return what is not claimed of links that balls named LINK/k cover: pairs, and contacts."""
    links = dict[str, list[Thing]]()
    for point in points.values():
        if point.radius and (link := point.name.rpartition("/")[0]):
            links.setdefault(link, []).append(point)
    kept = {frozenset(thing.name for thing in boundary.things) for boundary in boundaries}
    found = list[str]()
    for one, other in itertools.combinations(links, 2):
        pairs = [*itertools.product(links[one], links[other])]
        Work.add(len(pairs))
        apart = (frozenset((a.name, b.name)) in kept for a, b in pairs if a.frame != b.frame)
        found += [] if all(apart) else [f"{one!a} and {other!a} apart"]
    return [*found, *["that links meet where the balls meet that cover them"] * bool(links)]


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


def _common_axis(form: Table, frames: set[int]) -> dict[int, int]:
    """Return for each frame with bodies its coordinate along the common axis of the joints."""
    every, axes = [AXES], list[tuple[bool, Vector]]()
    for step in form["steps"] if frames else ():
        every.append(product(every[-1], mount_of(step["rpy"], form["angle_unit"])))
        turns = form["joints"][step["joint"]]["turns"]
        axes.append((turns, image(every[-1], unit(step["axis"]))))

    def fits(e: Vector) -> bool:
        return all(_parallel(e, z) if turns else abs(dot(e, z)) <= NEARLY for turns, z in axes)

    tried = [z for turns, z in axes if turns][:1] or (AXES[1], AXES[2], AXES[0])
    common = next(filter(fits, tried), None)
    if common is None:
        raise Refused("robot: bodies keep apart in a plane only, and the arm leaves it")
    flat = dict[int, int]()
    for frame in frames:
        along = [k for k in range(3) if _parallel(common, every[frame][k])]
        demand(along, "robot: no axis of a frame with bodies is along the common axis")
        flat[frame] = along[0]
    return flat


def _parallel(u: Vector, v: Vector) -> bool:
    return size(cross(u, v)) <= NEARLY


def _keeps(boundaries: list[Boundary], flat: dict[int, int], parts: Any) -> tuple[Rows, Rows]:
    """Return the hulls and the things to keep of the normal form."""

    def lifted(thing: Thing) -> tuple[Exact, ...]:
        k = flat.get(thing.frame, 0)  # corners of two numbers have a 0 along the common axis
        return tuple(p if len(p) == 3 else (*p[:k], ZERO, *p[k:]) for p in thing.corners)

    loops = dict[str, Loop]()
    for thing in (t for bound in boundaries if not bound.normal for t in bound.things):
        if thing.kind == "polygon" and thing.name not in loops:
            i, k = (x for x in range(3) if x != flat[thing.frame])
            [loop] = in_plane([lifted(thing)], i, k)
            area = doubled_area(loop)
            demand(area, f"robot: the outline of {shown(thing.name)} has no area")
            loops[thing.name] = loop if area > 0 else [(-x, y) for x, y in loop]
    spec = {
        name: items(items(index(len(loop)), 3, MAX_CORNERS), 1, MAX_CORNERS)
        for name, loop in loops.items()
        if not is_convex(loop)
    }
    cut = table(spec)(parts, "parts")
    for name, rows in cut.items():
        pieces = [[loops[name][k] for k in row] for row in rows]
        demand_filled([loops[name]], pieces, f"parts.{name!a}")
    hulls, numbers, shapes = Rows(), dict[Any, int](), dict[str, int]()

    def hull(thing: Thing, part: Sequence[int] | None = None) -> int:
        key = thing.kind == "point", thing.name, part
        if key not in numbers:
            whole = lifted(thing)
            corners = whole if part is None else tuple(whole[k] for k in part)
            numbers[key] = shapes.setdefault(canonical((thing.frame, corners)), len(hulls))
            if numbers[key] == len(hulls):
                hulls.append({"frame": thing.frame, "corners": corners})
        return numbers[key]

    keeps = Rows()
    for name, things, normal, distance in boundaries:
        row = {"name": name, "gap": distance + sum(thing.radius for thing in things)}
        if normal is not None:
            keeps.append({**row, "far": hull(things[0]), "normal": normal})
            continue
        near, far = sorted(things, key=lambda thing: thing.frame)
        row["along"] = None if near.kind == "point" else flat[near.frame]
        both = (cut.get(t.name, [None]) if t.kind == "polygon" else [None] for t in (near, far))
        for one, other in itertools.product(*both):
            demand(len(keeps) < MAX_KEEPS, f"robot: more than {MAX_KEEPS} pairs of parts")
            keeps.append({**row, "near": hull(near, one), "far": hull(far, other)})
    return hulls, keeps


def in_plane(loops: Sequence[Sequence[Exact]], i: int, k: int) -> list[Loop]:
    """Return loops in two coordinates, each scaled to whole numbers: no side of a line changes."""
    m, n = (math.lcm(*(p[j].denominator for loop in loops for p in loop)) for j in (i, k))
    return [[(int(p[i] * m), int(p[k] * n)) for p in loop] for loop in loops]


def around(loop: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    """Return the pairs of neighbours around a loop."""
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def doubled_area(loop: Sequence[Any]) -> Any:
    """Return twice the area of a loop, more than 0 if it goes anticlockwise."""
    Work.add(2 * len(loop))
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in around(loop))


def is_convex(loop: Loop) -> bool:
    """Tell whether every corner is on the left of every edge or on its line, and one is not."""
    Work.add(5 * len(loop) ** 2)
    for (x, y), (u, v) in around(loop):
        sides = [(u - x) * (q - y) - (v - y) * (p - x) for p, q in loop]
        if min(sides) < 0 or not any(sides):
            return False
    return True


def demand_filled(loops: Sequence[Loop], pieces: Sequence[Loop], where: str) -> None:
    """Refuse pieces that do not fill loops: convex, inner edges in pairs, all others the loops.

    Then the edges of all pieces add up to the loops. So around any place the loops wind as often as
    pieces hold it, and a place that they wind around lies in a piece. Points are known by their
    text, because the hash of a number can be chosen and that of a text cannot.
    """
    for piece in pieces:
        demand(is_convex(piece), f"{where}: a piece is not convex, flat, or goes clockwise")
    numbers = dict[str, int]()

    def edges(loop: Loop) -> Iterator[tuple[int, int]]:
        return around([numbers.setdefault(f"{x} {y}", len(numbers)) for x, y in loop])

    outer = [edge for loop in loops for edge in edges(loop)]
    inner = [edge for piece in pieces for edge in edges(piece)]
    outline, sides = {*outer}, {*inner}
    demand(len(sides) == len(inner), f"{where}: two pieces lie on one side of an edge")
    demand(len(outline) == len(outer), f"{where}: an edge of the loops stands there twice")
    alone = {(a, b) for a, b in sides if (b, a) not in sides}
    told = "an edge of the loops is not the edge of one piece alone"
    demand(outline <= alone, f"{where}: {told}")
    demand(alone <= outline, f"{where}: an inner edge has a piece on one side alone")


# --- reading: the arm of the kernel ---------------------------------------------------------------

NO_HULL: Table = {"frame": 0, "corners": ()}


class Arm:
    """A robot in units, and what it has to keep: the claim's margin is added to every distance."""

    def __init__(self, robot: Robot, margin: Fraction) -> None:
        self.robot, form, angle_unit = robot, robot.form, robot.form["angle_unit"]
        self.joints, self.hulls, self.rows = form["joints"], form["hulls"], form["keep"]
        gaps = [row["gap"] + margin for row in self.rows]
        places = [p for hull in self.hulls for p in hull["corners"]]
        places += [step["origin"] for step in form["steps"]]
        places += [joint["limits"] for joint in self.joints if not joint["turns"]]
        lengths = itertools.chain(gaps, *places)
        self.largest = max(map(abs, lengths), default=ZERO) or Fraction(1)
        self.steps, self.keeps = list[Step](), list[Keep]()
        for row in form["steps"]:
            turns, mount = self.joints[row["joint"]]["turns"], mount_of(row["rpy"], angle_unit)
            vectors = self.scaled(row["origin"]), mount, unit(row["axis"])
            self.steps.append(Step(row["joint"], turns, int(row["factor"]), *vectors))
        hulls = [Hull(h["frame"], tuple(map(self.scaled, h["corners"]))) for h in self.hulls]
        for row, gap in zip(self.rows, gaps, strict=True):
            near = hulls[row["near"]] if "near" in row else Hull(0, ((0, 0, 0),))
            distance = in_units(gap / self.largest), gap != 0
            normal = unit(row["normal"]) if "normal" in row else None
            hull_pair = near, hulls[row["far"]]
            self.keeps.append(Keep(row["name"], *hull_pair, *distance, row.get("along"), normal))
        pairs = [keep for keep in self.keeps if keep.along is not None]
        if pairs:  # all corners of bodies have one height along the common axis
            still, frame = (0,) * len(self.joints), pairs[0].near.frame
            leaf = Leaf(self.steps, Box((still, still)))
            axis = leaf.frames[frame][0][robot.flat[frame]]
            bodies = {id(hull): hull for keep in pairs for hull in (keep.near, keep.far)}.values()
            heights = [
                dot(axis, leaf.place(hull.frame, p)) for hull in bodies for p in hull.corners
            ]
            level = max(heights) - min(heights) <= NEARLY
            demand(level, "robot: two bodies to keep apart are not at one height")

    def scaled(self, place: Sequence[Fraction]) -> Vector:
        """Return three lengths in units."""
        x, y, z = (in_units(x / self.largest) for x in place)
        return x, y, z

    def placed(self, q: Exact) -> Point:
        """Return a configuration in units."""
        return tuple(itertools.starmap(self.value, enumerate(q)))

    def value(self, j: int, x: Fraction) -> int:
        """Return a value of a joint in units."""
        turns = self.joints[j]["turns"]
        return in_radians(x, self.robot.unit_of(j)) if turns else in_units(x / self.largest)

    def whole_range(self, j: int) -> tuple[int, int]:
        """Return the limits of a joint; without limits a turn, in radians a little more."""
        half = {"deg": Fraction(180), "rad": Fraction("3.1416")}[self.robot.form["angle_unit"]]
        low, high = self.joints[j]["limits"] or (-half, half)
        return self.value(j, low), self.value(j, high)


# --- reading: the claim ---------------------------------------------------------------------------


class Claim(NamedTuple):
    """What a certificate claims: a set with the corners of its cells, or two configurations."""

    kind: str
    margin: Fraction
    loops: Sequence[Sequence[Exact]]
    corners: Sequence[Sequence[Exact]]
    joints: Sequence[str]


SETS = {
    "box": (1, 2, 2, ()),
    "path": (MAX_CELLS, 2, MAX_CELLS, ()),
    "polygon": (MAX_CELLS, 3, MAX_CELLS, ("triangles",)),
    "no path": (1, 2, 2, ("joints",)),
}
"""The most lists of configurations; how long a list is, at least and at most; and other keys."""


def configuration(robot: Robot) -> Reader:
    """Return the reader of one value for each joint; angles are not too large."""
    unit_name, turning = robot.form["angle_unit"], [j["turns"] for j in robot.form["joints"]]
    largest = LARGEST_ANGLE[unit_name]
    return such(
        lambda q: all(abs(x) <= largest for x in itertools.compress(q, turning)),
        f"an angle of more than {largest} {unit_name}",
        items(decimal, len(turning), len(turning)),
    )


def read_claim(value: Any, robot: Robot) -> Claim:
    """Read a claim and the cells of its set."""
    kind = one_of(*SETS)(value.get("set") if type(value) is dict else None, "claim.set")
    lists, least, most, others = SETS[kind]
    points = items(items(configuration(robot), least, most), 1, lists)
    spec = {"set": anything, "margin": not_negative(decimal), "points": points}
    found = table({**spec, **dict.fromkeys(others, anything)})(value, "claim")
    loops, joints = found["points"], list[str]()
    every = [*itertools.chain(*loops)]
    demand(len(every) <= MAX_CELLS, f"claim.points: more than {MAX_CELLS} configurations")
    corners: list[Sequence[Exact]] = [every]
    if kind == "box":
        rises = all(a <= b for a, b in zip(*every, strict=True))
        demand(rises, "claim.points: the first corner is the low one in every joint")
    elif kind == "path":
        corners = [pair for loop in loops for pair in itertools.pairwise(loop)]
    elif kind == "polygon":
        flat = _flat(loops)
        for loop in flat:
            once = len({f"{x} {y}" for x, y in loop}) == len(loop)
            demand(once, "claim.points: a loop passes a configuration twice")
        numbered = items(items(index(len(every)), 3, 3), 1, MAX_CELLS)
        triangles = numbered(found["triangles"], "claim.triangles")
        places = [*itertools.chain(*flat)]
        demand_filled(flat, [[places[k] for k in row] for row in triangles], "claim.triangles")
        corners = [[every[k] for k in row] for row in triangles]
    else:
        kinds = items(one_of("moves", "held", "any"), len(robot.joints), len(robot.joints))
        joints = kinds(found["joints"], "claim.joints")
        demand("moves" in joints, "claim.joints: at least one joint moves")
        held = [a == b for a, b, each in zip(*every, joints, strict=True) if each == "held"]
        demand(all(held), "claim.joints: start and goal differ in a joint that is held")
    return Claim(kind, found["margin"], loops, corners, joints)


def _flat(loops: Sequence[Sequence[Exact]]) -> list[Loop]:
    """Return the loops of a polygon in the two joints that vary."""
    columns = zip(*itertools.chain(*loops), strict=True)
    plane = [j for j, column in enumerate(columns) if min(column) != max(column)]
    demand(len(plane) == 2, f"claim.points: {len(plane)} joints of a polygon vary, not two")
    return in_plane(loops, *plane)


# --- the answer -----------------------------------------------------------------------------------


class Answer(NamedTuple):
    """What a certificate shows: that its claim is refuted, else that it is proved."""

    refuted: bool
    said: str


def digest(written: str) -> str:
    """Return the SHA-256 of a text."""
    return hashlib.sha256(written.encode()).hexdigest()


def normal_form(written: str, parts: Any) -> Table:
    """Return the normal form of a robot's text; for those who write certificates."""
    Work.done = 0
    form: Table = json.loads(canonical(read_robot(written, parts).form))
    return form


def read_statement(written: str, parts: Any, claim: Any) -> Claim:
    """Read a robot's text and a claim about it; for those who write certificates."""
    Work.done = 0
    return read_claim(claim, read_robot(written, parts))


def read(data: str | bytes) -> tuple[Table, Robot]:
    """Read a certificate and its robot, and compare the hash of the normal form."""
    Work.done = 0
    cos_sin.cache_clear()  # so that the work does not depend on what was checked before
    content = read_json(data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data)
    schema = content.get("schema") if type(content) is dict else None
    demand(schema == SCHEMA, f"schema: {SCHEMA} is wanted; older formats are not read any more")
    shows = "witness" if "witness" in content else "proof"
    keys = ("schema", "parts", "sha256", "claim", shows)
    spec = {"robot": text(MAX_ROBOT), **dict.fromkeys(keys, anything)}
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
    claim, refuted = read_claim(content["claim"], robot), "witness" in content
    arm = Arm(robot, claim.margin)
    if refuted:
        demand(claim.kind != "no path", "witness: a claim of no path has a proof")
        said = refute(arm, claim, content["witness"])
    else:
        prove = prove_no_path if claim.kind == "no path" else prove_safe
        said = prove(arm, claim, content["proof"])
    heading = f"robot {robot.form['name']!a}, sha256 of its normal form {content['sha256']}"
    lines = [f"{heading}, {compared}", said, *kept(robot, claim), *described(robot, claim)]
    return Answer(refuted, "\n".join(lines))


def kept(robot: Robot, claim: Claim) -> Iterator[str]:
    """Say what was to be kept, and what was not."""
    length = robot.form["length_unit"]
    yield f"all limits of joints, and with {exactly(claim.margin)} {length} to spare each of"
    for name, things, normal, distance in robot.boundaries:
        ends = []
        for thing in things:
            kind = "outline" if thing.kind == "polygon" else thing.kind
            radius = f", radius {exactly(thing.radius)} {length}" if thing.radius else ""
            ends.append(f"{kind} {thing.name!a} of frame {robot.frames[thing.frame]!a}{radius}")
        told = f"at least {exactly(distance)} {length}"
        if normal is not None:
            told += f" of height along {_in_brackets(normal)}, in all its places"
        else:
            told = f"{told} apart" if distance else "not overlapping"
            told += "" if things[0].kind == "point" else ", seen along the common axis"
        yield f"  {name!a}: {' and '.join(ends)}: {told}"
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
    points = [*itertools.chain(*claim.loops)]
    printed = [" ".join(map(_in_brackets, loop)) for loop in claim.loops]
    names = ", ".join(f"{name!a} / {robot.unit_of(j)}" for j, name in enumerate(robot.joints))
    told = [LOOPS.get(claim.kind, "")] * len(printed)
    if claim.kind == "polygon":
        told = ["outline" if doubled_area(loop) > 0 else "hole" for loop in _flat(claim.loops)]
    counts = [f", {told.count(kind)} {kind}(s)" for kind in ("outline", "hole") if kind in told]
    yield f"set: {claim.kind}{''.join(counts)}; {len(points)} configurations ({names})"
    few = len(points) <= MOST_SHOWN
    if few:
        yield from (f"  {kind}: {said}" for kind, said in zip(told, printed, strict=True))
    else:
        yield f"  their text is in the certificate; its sha256 is {digest(chr(10).join(printed))}"
        for loop in claim.loops if claim.kind == "path" else ():
            yield f"  path from {_in_brackets(loop[0])} to {_in_brackets(loop[-1])}"
    turn = 360 if robot.form["angle_unit"] == "deg" else 2 * PI + Fraction(1, 10**70)
    for j, (name, column) in enumerate(zip(robot.joints, zip(*points, strict=True), strict=True)):
        if claim.joints:
            yield f"  {name!a} {JOINTS[claim.joints[j]]}"
            continue
        if not few:
            ends = f"{exactly(min(column))} and {exactly(max(column))}"
            yield f"  {name!a} is between {ends} {robot.unit_of(j)} in the set"
        if robot.form["joints"][j]["turns"] and _longest(claim, j) >= turn:
            yield f"  {name!a} takes every angle"


def _longest(claim: Claim, j: int) -> Fraction:
    """Return the length of the longest range of a joint that the cells take without a gap."""
    Work.add(50 * len(claim.corners))
    ranges = sorted((min(q[j] for q in cell), max(q[j] for q in cell)) for cell in claim.corners)
    (start, end), longest = ranges[0], ZERO
    for low, high in ranges:
        start, end = (start, max(end, high)) if low <= end else (low, high)
        longest = max(longest, end - start)
    return longest


# --- the command ----------------------------------------------------------------------------------

PROVED, REFUTED, NO_ANSWER = 0, 3, 2
"""Exit statuses; not 1, which a Python that cannot run this file ends with."""

USAGE = "usage: python -I check.py FILE [--robot ARM.toml | --print robot]; or --version, --help"


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
    safe = re.sub(r"[^\n -~]", lambda found: ascii(found[0])[1:-1], said)
    try:
        sys.stdout.write(f"{safe}\n")  # `print` is silent where there is no output
        sys.stdout.flush()
    except (OSError, ValueError, AttributeError):
        return NO_ANSWER
    return status


def _answer(arguments: list[str]) -> tuple[int, str]:
    """Return the exit status and what is to be printed."""
    if arguments == ["--help"]:
        return PROVED, __doc__ or USAGE
    if arguments == ["--version"]:
        return PROVED, f"check.py of {SCHEMA}"
    demand(len(arguments) in (1, 3) and "" not in arguments, USAGE)
    file, option, value = (*arguments, "", "")[:3]
    known = option in ("", "--robot") or (option, value) == ("--print", "robot")
    demand(known and file[:2] != "--", USAGE)
    data, pin = _read_file(file), None
    if option == "--print":
        return PROVED, canonical(read(data)[1].form)[:-1]
    if option:
        try:  # as cspace reads a robot file: without a mark, with one sort of line end
            pin = _read_file(value).decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
        except UnicodeDecodeError:
            raise Refused(f"{shown(value)}: not UTF-8 text") from None
    answer = check(data, pin, value)
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


if __name__ == "__main__":
    os._exit(main(sys.argv[1:]))  # and nothing more is tried where an answer could not be printed
