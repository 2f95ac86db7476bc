"""Check a certificate of qbound with nothing but Python's own integers.

    python -I check.py FILE [--robot ARM.toml]
    python -I check.py FILE --print robot

A certificate claims that every configuration of a set keeps a robot clear of all that it has to
keep clear of, or that one configuration does not, or that no path leads from one configuration to
another. This file decides whether the proof holds. It imports nothing but the standard library,
uses no floating point, and can be copied and run alone. The page "The certificate" of the book
defines the format; what that page does not list is refused.

Read it from top to bottom. The first 200 lines of code are the kernel, on which all else stands:

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
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

SCHEMA = "qbound/certificate/6"


class Refused(ValueError):
    """The reason why a file proves nothing, in a sentence that names what and where."""


def demand(condition: object, text: str) -> None:
    """Refuse the file unless a condition holds."""
    if not condition:
        raise Refused(text)


class Work:
    """Multiplications since the check began; a file that asks for too many is refused."""

    MOST = 40_000_000
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
#   less than 2^32 units; so are its derivatives. In the inequality at most 14 derivatives occur,
#   each times a step of less than 2^5, and in the bend at most 14^2, each times two such steps:
#   this makes an error of less than 2^51 units.
#
# Each inequality has to hold with `SLACK` to spare, which is 2^13 times more than this.

BITS = 224
ONE = 1 << BITS
SLACK = 1 << 64

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
"""Eighty digits: the error is far below a unit."""

Vector = tuple[int, int, int]
Matrix = tuple[Vector, Vector, Vector]
"""Three columns."""


def in_units(x: Fraction) -> int:
    """Return a number in units, rounded down."""
    return (x.numerator << BITS) // x.denominator


@lru_cache(maxsize=1000)
def cos_sin(angle: int) -> tuple[int, int]:
    """Return the cosine and the sine of an angle in radians, at most 64 in size.

    Taylor's series at x = angle / 128, at most 1/2, and then cos 2x = cos^2 x - sin^2 x and
    sin 2x = 2 sin x cos x seven times. 48 terms leave out less than a unit and round by less than
    50; a doubling multiplies the error by at most 2 sqrt(2) and adds 2, seven of them make less
    than 2^17.
    """
    Work.add(150)
    x, term, sums = angle >> 7, ONE, [0, 0, 0, 0]
    for k in range(48):
        sums[k % 4] += term
        term = (term * x >> BITS) // (k + 1)
    c, s = sums[0] - sums[2], sums[1] - sums[3]
    for _ in range(7):
        c, s = (c * c - s * s) >> BITS, 2 * c * s >> BITS
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

    Its value is factor * (value of its joint) + offset. `reach` is at least the distance that it
    carries its frame from the one before, `sweep` at least the distance of a slide from the middle
    of its range, whatever the joint's value within its limits.
    """

    joint: int
    turns: bool
    factor: int
    offset: int
    origin: Vector
    mount: Matrix
    axis: Vector
    reach: int
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
            value = (step.factor * q[step.joint] >> BITS) + step.offset
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

    For every step d of the joints within the leaf the place is at most `bend` + `spread` away from
    `place` + the sum of d_k `slopes[k]`, over the steps k of the arm.
    """

    place: Vector
    slopes: dict[int, Vector]
    bend: int
    spread: int


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
    free : for each joint whether it takes any value.

    A step that turns by q moves a place r along axis x (r - pivot), one that slides along its axis.
    A joint that takes any value: what is across its axis may point anywhere. So it becomes a part
    of the spread, and what is along the axis goes on. Remainders stay as long as they are.

    The second derivative. For steps i <= j, i nearer to the base, the mixed derivative of the place
    by both is axis_i x (its derivative by j) if i turns, else 0. So it is at most rho_j if rho_j is
    at least the derivative by j all over the leaf, and along a step d within the leaf

        |r''| <= K = sum over i that turn of D_i (D_i rho_i + 2 sum over j > i of D_j rho_j).

    With what is linear taken away, half of K is left. The derivative by j is at most the length of
    the chain beyond j; it is also at most that at the middle plus what it can grow, which the mixed
    derivatives say.
    """
    Work.add(25 * (far - near + 1))
    r, slopes, spread, chain = pose.place(far, corner), dict[int, Vector](), 0, size(corner)
    length = dict[int, int]()
    for k in reversed(range(near, far)):
        step, (axis, pivot) = steps[k], pose.axes[k]
        length[k] = chain if step.turns else ONE
        chain += step.reach
        if not free[step.joint]:
            slopes[k] = cross(axis, minus(r, pivot)) if step.turns else axis
        elif step.turns:
            foot = plus(pivot, times(dot(axis, minus(r, pivot)), axis))
            spread += size(minus(r, foot))
            for i, slope in slopes.items():
                along = times(dot(axis, slope), axis)
                spread += (size(minus(slope, along)) * width_of(steps[i], widths) >> BITS) + 1
                slopes[i] = along
            r = foot
        else:
            spread += step.sweep
    moving = sorted(slopes)
    width = {k: width_of(steps[k], widths) for k in moving}
    products = dict[int, int]()
    for j in moving:
        grown = sum(
            width[k] * length[max(j, k)] for k in moving if steps[min(j, k)].turns and width[k]
        )
        rho = min(length[j], size(slopes[j]) + (grown >> BITS) + 1)
        products[j] = (width[j] * rho >> BITS) + 1
    bend, beyond = 0, 0
    for i in reversed(moving):
        if steps[i].turns and width[i]:
            bend += width[i] * (products[i] + 2 * beyond)
        beyond += products[i]
    return Motion(r, slopes, (bend >> BITS + 1) + 1, spread)


def width_of(step: Step, widths: Sequence[int]) -> int:
    """Return how far the own value of a step can be from the middle: |factor| * width."""
    return abs(step.factor * widths[step.joint] >> BITS) + (1 if widths[step.joint] else 0)


# --- the inequality -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Hull:
    """The convex hull of some corners of a frame."""

    frame: int
    corners: tuple[Vector, ...]


@dataclass(frozen=True)
class Keep:
    """Two hulls that stay more than `gap` apart, or one above a plane of the base.

    near : of the frame that is not beyond that of `far`; None for a plane.
    along : the coordinate of the near frame along which both are seen; None in space.
    normal : unit vector; normal . place is at least `gap`; None for two hulls.
    """

    name: str
    near: Hull | None
    far: Hull
    gap: int
    along: int | None
    normal: Vector | None

    @property
    def first(self) -> int:
        """Return the frame from which the far hull is seen."""
        return self.near.frame if self.near else 0


def is_kept(steps: Sequence[Step], pose: Pose, keep: Keep, u: Vector, cell: "Cell") -> bool:
    """Prove that something is kept all over a leaf; u is a unit vector, seen from the near frame.

    The distance of r and p is at least u . (r - p), and over the leaf u . r is at least its linear
    part less the bend. What is linear is least at a corner of the leaf, and least or largest over a
    hull at one of its corners.
    """
    turned, at = pose.frames[keep.first]
    w, held = image(turned, u), [False] * len(cell.widths)
    nearest = max(dot(u, p) for p in keep.near.corners) if keep.near else 0
    Work.add(3 * len(keep.near.corners) if keep.near else 0)
    for corner in keep.far.corners:
        found = motion(steps, pose, keep.first, keep.far.frame, corner, cell.widths, held)
        slopes = [0] * len(held)
        for k, slope in found.slopes.items():
            slopes[steps[k].joint] += steps[k].factor * dot(w, slope) >> BITS
        low = dot(w, minus(found.place, at)) + cell.least(slopes) - found.bend
        if low <= nearest + keep.gap + SLACK:
            return False
    return True


class Place(NamedTuple):
    """A place of each hull, and the radii of discs about them that lie within the hulls."""

    near: Vector
    far: Vector
    radii: int


def is_violated(
    steps: Sequence[Step],
    pose: Pose,
    keep: Keep,
    place: Place,
    cell: "Cell",
    free: Sequence[bool],
) -> bool:
    """Prove that something is not kept anywhere on a leaf, whatever the free joints.

    The distance of the two places is convex in the step, so it is largest at a corner of the leaf.
    """
    turned, at = pose.frames[keep.first]
    found = motion(steps, pose, keep.first, keep.far.frame, place.far, cell.widths, free)
    start = minus(found.place, plus(at, image(turned, place.near)) if keep.near else at)
    allowed = keep.gap + place.radii - found.bend - found.spread - SLACK
    for corner in cell.corners({steps[k].joint for k in found.slopes}):
        Work.add(10 + 3 * len(found.slopes))
        w = start
        for k, slope in found.slopes.items():
            w = plus(w, times(steps[k].factor * corner[steps[k].joint] >> BITS, slope))
        if keep.normal is not None:
            if dot(keep.normal, w) >= allowed:
                return False
            continue
        if keep.along is not None:
            w = minus(w, times(dot(turned[keep.along], w), turned[keep.along]))
        if size(w) >= allowed:
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
        """Return the least sum of slope * step over all corners, rounded down."""
        return -sum((abs(s) * d >> BITS) + 1 for s, d in zip(slopes, self.widths, strict=True))

    def corners(self, joints: set[int]) -> Iterator[Point]:
        """Yield the steps from the middle to the corners, as far as some joints tell them apart."""
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
        """Return the steps from the middle to the corners."""
        middle = self.middle
        return [tuple(x - m for x, m in zip(q, middle, strict=True)) for q in self.ends]

    @cached_property
    def widths(self) -> Point:
        """Return for each joint the largest distance of a corner from the middle."""
        return tuple(max(map(abs, column)) for column in zip(*self.steps, strict=True))

    def least(self, slopes: Sequence[int]) -> int:
        """Return the least sum of slope * step over all corners, rounded down."""
        rises = (sum(s * d for s, d in zip(slopes, step, strict=True)) for step in self.steps)
        return min(rises) >> BITS

    def corners(self, joints: set[int]) -> Iterator[Point]:
        """Yield the steps from the middle to the corners."""
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

MAX_DEPTH = 120
"""Cuts on top of each other in a tree."""


def tokens(tree: Any, where: str) -> Iterator[str]:
    """Return the letters and leaves of a tree one after the other."""
    known = type(tree) is str and re.fullmatch("(?:[a-g]|(?:0|[1-9][0-9]{0,5})?[.])+", tree)
    demand(known, f"{where}: no tree of letters and leaves")
    return (found.group() for found in re.finditer("[a-g]|[0-9]*[.]", tree))


def next_of(letters: Iterator[str], where: str) -> str:
    """Return the next letter or leaf of a tree."""
    token = next(letters, "")
    demand(token, f"{where}: a tree ends before its last leaf")
    return token


def ended(letters: Iterator[str], where: str) -> None:
    """Refuse a tree that goes on after its last leaf."""
    demand(not next(letters, ""), f"{where}: a tree goes on after its last leaf")


# --- the claims -----------------------------------------------------------------------------------


def prove_safe(arm: "Arm", cells: Sequence[Cell], proof: Any) -> None:
    """Verify the trees of all things to keep, cell by cell.

    All trees of a cell are walked together, so that a part of the cell which several trees have is
    placed once.
    """
    table = table_of(proof, "proof", ("directions", "trees"))
    rows = list_of(table["directions"], "proof: directions", 0, MAX_CELLS)
    directions = [_direction(row, f"proof: directions[{k}]") for k, row in enumerate(rows)]
    count = len(arm.keeps)
    trees = list_of(table["trees"], "proof: trees", count, count)
    for k, row in enumerate(trees):
        wanted = len(cells) if arm.needs_proof[k] else 0
        list_of(row, f"proof: trees[{k}]", wanted, wanted)
    for c, cell in enumerate(cells):
        walked = [
            (k, tokens(row[c], f"proof: trees[{k}][{c}]")) for k, row in enumerate(trees) if row
        ]
        todo = [(cell, walked, 0)]
        while todo:
            part, cursors, depth = todo.pop()
            Work.add(10 * len(cursors))
            cuts, pose = dict[str, list[tuple[int, Iterator[str]]]](), None
            for k, letters in cursors:
                where = f"proof: trees[{k}][{c}]"
                token = next_of(letters, where)
                if not token.endswith("."):
                    cuts.setdefault(token, []).append((k, letters))
                    continue
                pose = pose or Pose(arm.steps, part.middle)
                u = _direction_of(arm.keeps[k], token[:-1], directions, where)
                kept = is_kept(arm.steps, pose, arm.keeps[k], u, part)
                demand(kept, f"{where}: the bound of {shown(arm.keeps[k].name)} fails on a leaf")
            demand(not cuts or depth < MAX_DEPTH, f"proof: more than {MAX_DEPTH} cuts in a tree")
            for letter, group in cuts.items():
                first, second = part.halves(ord(letter) - ord("a"))
                todo += [(second, group, depth + 1), (first, group, depth + 1)]
        for k, letters in walked:
            ended(letters, f"proof: trees[{k}][{c}]")


def _direction(value: Any, where: str) -> tuple[Vector, list[int]]:
    """Return a direction as a unit vector, and as the three integers that are written."""
    row = list_of(value, where, 3, 3)
    known = all(type(x) is int and abs(x) < 10**9 for x in row) and any(row)
    demand(known, f"{where}: three integers of at most nine digits, not all 0, are wanted")
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
    at = ("at",) if claim.kind == "box" else ("cell", "weights")
    kind = "limit" if type(value) is dict and "limit" in value else "place"
    table = table_of(value, "witness", (*at, kind))
    if claim.kind == "box":
        q = configuration(table["at"], "witness: at", arm)
        ends = zip(*claim.loops[0], q, strict=True)
        demand(all(a <= x <= b for a, b, x in ends), "witness: at: not in the box")
    else:
        corners = claim.corners[index_of(table["cell"], "witness: cell", len(claim.corners))]
        weights = weights_of(table["weights"], "witness: weights", len(corners))
        q = mean(weights, corners)
    values = (
        f"{joint.name!a} = {exactly(q[j])} {arm.unit_of(j)}" for j, joint in enumerate(arm.joints)
    )
    said = ", ".join(values)
    if kind == "limit":
        name = table["limit"]
        beyond = type(name) is str and name in arm.beyond(q)
        demand(beyond, "witness: limit: no limit of that name is violated")
        return f"the limit {name!a} is violated at {said}"
    keep, place = read_place(arm, table["place"], "witness: place")
    point = Box(arm.placed(q), arm.placed(q))
    pose, held = Pose(arm.steps, point.low), [False] * len(q)
    violated = is_violated(arm.steps, pose, keep, place, point, held) or _cross(pose, keep)
    demand(violated, f"witness: {shown(keep.name)} is not violated there")
    return f"{keep.name!a} is violated at {said}"


def _cross(pose: Pose, keep: Keep) -> bool:
    """Tell whether two segments that keep no distance cross, seen along the common axis."""
    if keep.gap or keep.along is None or not keep.near:
        return False
    hulls = [[pose.place(hull.frame, p) for p in hull.corners] for hull in (keep.near, keep.far)]
    if [len(corners) for corners in hulls] != [2, 2]:
        return False
    normal, ((a, b), (c, d)) = pose.frames[keep.first][0][keep.along], hulls

    def side(p: Vector, q: Vector, r: Vector) -> int:
        return dot(normal, cross(minus(q, p), minus(r, p)))

    sides = [(side(a, b, c), side(a, b, d)), (side(c, d, a), side(c, d, b))]
    return all(min(pair) < -SLACK and max(pair) > SLACK for pair in sides)


def read_place(arm: "Arm", value: Any, where: str) -> tuple[Keep, Place]:
    """Read a place of each hull of a thing to keep, and the discs about them."""
    table = table_of(value, where, ("keep", "near", "far"), ("inside",))
    k = index_of(table["keep"], f"{where}: keep", len(arm.keeps))
    keep, row = arm.keeps[k], arm.robot.keeps[k]
    sides, radius = list[Exact](), Fraction(0)
    radii = list_of(table.get("inside", ["0", "0"]), f"{where}: inside", 2, 2)
    demand("inside" not in table or keep.along is not None, f"{where}: inside: of bodies only")
    for side, number, written in zip(("near", "far"), (row.near, row.far), radii, strict=True):
        if number is None:
            demand(table[side] == [], f"{where}: {side}: an empty list is wanted")
            sides.append((Fraction(0), Fraction(0), Fraction(0)))
            continue
        frame, corners = arm.robot.hulls[number]
        weights = weights_of(table[side], f"{where}: {side}", len(corners))
        sides.append(mean(weights, corners))
        own = decimal(written, f"{where}: inside")
        demand(own >= 0, f"{where}: inside: a radius of 0 or more is wanted")
        within = own == 0 or _holds_disc(corners, arm.across(frame), sides[-1], own)
        demand(within, f"{where}: inside: the disc does not lie within the part")
        radius += own
    near, far = (arm.scaled(side) for side in sides)
    return keep, Place(near, far, in_units(radius / arm.largest))


def _holds_disc(corners: Sequence[Any], seen: tuple[int, int], at: Any, radius: Fraction) -> bool:
    """Tell whether a disc lies within a convex part: every edge is that far from its middle."""
    if len(corners) < 3:
        return False
    i, k = seen
    flat = [(p[i], p[k]) for p in corners]
    sense = 1 if doubled_area(flat) > 0 else -1
    for a, b in around(flat):
        (x, y), (u, v) = (b[0] - a[0], b[1] - a[1]), (at[i] - a[0], at[k] - a[1])
        inwards = sense * (x * v - y * u)
        if inwards < 0 or inwards**2 < radius**2 * (x * x + y * y):
            return False
    return True


TOUCH = 1 << BITS - 100
"""Open leaves that are nearer than this touch: 8e-31 of a radian or of the largest length."""


class Leaves:
    """The boxes of a tree in preorder; each knows where the boxes that it contains end."""

    def __init__(self, turn: Sequence[int | None]) -> None:
        self.spans: list[Box] = []
        self.is_open: list[bool] = []
        self.after: list[int] = []
        shifts = [(0,) if t is None else (-t, 0, t) for t in turn]
        self.shifts = [*itertools.product(*shifts)]

    def touching(self, box: Box) -> Iterator[int]:
        """Yield the open leaves that touch a box, over the seams of joints too."""
        for shift in self.shifts:
            low = [x + s - TOUCH for x, s in zip(box.low, shift, strict=True)]
            high = [x + s + TOUCH for x, s in zip(box.high, shift, strict=True)]
            k = 0
            while k < len(self.spans):
                Work.add(2)
                span = self.spans[k]
                apart = any(b < x for b, x in zip(span.high, low, strict=True)) or any(
                    a > x for a, x in zip(span.low, high, strict=True)
                )
                if self.is_open[k] and not apart:
                    yield k
                k = self.after[k] if apart else k + 1


def prove_no_path(arm: "Arm", claim: "Claim", proof: Any) -> None:
    """Verify that the leaves on which something is violated lie in every path.

    A path that keeps everything lies in open leaves. They are closed and finitely many, so a path
    stays within a group of leaves that touch.
    """
    table = table_of(proof, "proof", ("places", "tree"))
    rows = list_of(table["places"], "proof: places", 0, MAX_CELLS)
    places = [read_place(arm, row, f"proof: places[{k}]") for k, row in enumerate(rows)]
    [[start, goal]] = claim.loops
    for q in (start, goal):
        demand(not arm.beyond(q), "claim: points: start and goal are within all limits")
    free, moves = (
        [kind == "any" for kind in claim.joints],
        [kind == "moves" for kind in claim.joints],
    )
    at = arm.placed(start)
    ranges = [arm.whole_range(j) if moves[j] or free[j] else (at[j], at[j]) for j in range(len(at))]
    middle = [(a + b >> 1,) * 2 if free[j] else (a, b) for j, (a, b) in enumerate(ranges)]
    low, high = zip(*middle, strict=True)
    turns = [
        arm.turn if m and joint.limits is None else None
        for m, joint in zip(moves, arm.joints, strict=True)
    ]
    found, letters = Leaves(turns), tokens(table["tree"], "proof: tree")
    inside: list[int] = []
    todo = [(Box(low, high), 0)]
    while todo:
        cell, depth = todo.pop()
        Work.add(20)
        token = next_of(letters, "proof: tree")
        while len(inside) > depth:
            found.after[inside.pop()] = len(found.spans)
        inside.append(len(found.spans))
        found.spans.append(cell)
        found.is_open.append(token == ".")
        found.after.append(0)
        if not token.endswith("."):
            demand(depth < MAX_DEPTH, f"proof: more than {MAX_DEPTH} cuts in a tree")
            first, second = cell.halves(ord(token) - ord("a"))
            todo += [(second, depth + 1), (first, depth + 1)]
        elif token != ".":
            demand(int(token[:-1]) < len(places), "proof: tree: a leaf names no place of the list")
            keep, place = places[int(token[:-1])]
            pose = Pose(arm.steps, cell.middle)
            violated = is_violated(arm.steps, pose, keep, place, cell, free)
            demand(violated, f"proof: tree: {shown(keep.name)} is not violated all over a leaf")
    ended(letters, "proof: tree")
    for k in inside:
        found.after[k] = len(found.spans)
    ends = []
    for q in (start, goal):
        at = tuple(low[j] if free[j] else x for j, x in enumerate(arm.placed(q, turns)))
        ends.append({*found.touching(Box(at, at))})
        demand(ends[-1], "proof: tree: the start or the goal is on no open leaf")
    reached, todo_next = {*ends[0]}, [*ends[0]]
    while todo_next:
        new = {*found.touching(found.spans[todo_next.pop()])} - reached
        reached |= new
        todo_next += new
    demand(not reached & ends[1], "proof: tree: open leaves lead from the start to the goal")


# --- reading: values ------------------------------------------------------------------------------
# Each of these returns a value of its type, or refuses the file and names the place. `True` is an
# integer to `isinstance`, so types are compared by `type(...) is`.

MAX_FILE, MAX_ROBOT = 4_000_000, 500_000
"""Bytes of a certificate; characters of the robot's text."""

MAX_JOINTS, MAX_BOUNDARIES, MAX_ROWS, MAX_CORNERS = 7, 2_000, 2_000, 1_000
"""Joints; boundaries in use; points, bodies or rows of another kind; corners of an outline."""

MAX_CELLS, MAX_KEEPS = 20_000, 20_000
"""Configurations, triangles, directions or places; pairs of parts to keep apart."""

MAX_DIGITS, LARGEST = 40, Fraction(10**100)
"""Digits of a number, and its size; one that is not 0 is at least 1 / LARGEST."""

LARGEST_ANGLE = {"deg": Fraction(1800), "rad": Fraction(30)}

Table = dict[str, Any]
Exact = tuple[Fraction, ...]
"""A configuration in the units of the robot file, or three coordinates."""


def shown(value: Any) -> str:
    """Write a value for a message: short, in ASCII, on one line."""
    if type(value) is str:
        return ascii(value if len(value) <= 60 else f"{value[:57]}...")
    names = {dict: "a table", list: "a list", int: "a number", bool: "a truth value"}
    return names.get(type(value), "a value of another type")


def table_of(
    value: Any, where: str, required: Iterable[str], optional: Iterable[str] = ()
) -> Table:
    """Return a table that has all required keys, and no others but the optional ones."""
    demand(type(value) is dict, f"{where}: a table is wanted")
    needed, allowed = {*required}, {*required, *optional}
    unknown = [key for key in value if key not in allowed]
    demand(not unknown, f"{where}: unknown key {shown(next(iter(unknown), ''))}")
    missing = sorted(needed - {*value})
    demand(not missing, f"{where}: the key {shown(next(iter(missing), ''))} is missing")
    return {**value}


def list_of(value: Any, where: str, least: int, most: int) -> list[Any]:
    """Return a list of `least` to `most` items."""
    wanted = str(least) if least == most else f"{least} to {most}"
    fits = type(value) is list and least <= len(value) <= most
    demand(fits, f"{where}: a list of {wanted} is wanted")
    return [*value]


def text_of(value: Any, where: str, most: int) -> str:
    """Return a text of 1 to `most` characters."""
    fits = type(value) is str and 1 <= len(value) <= most
    demand(fits, f"{where}: a text of 1 to {most} characters is wanted")
    return str(value)


def one_of(value: Any, where: str, choices: Sequence[str]) -> str:
    """Return a text that is among some."""
    fits = type(value) is str and value in choices
    demand(fits, f"{where}: {' or '.join(choices)} is wanted")
    return str(value)


def index_of(value: Any, where: str, count: int) -> int:
    """Return a number from 0 to `count` - 1."""
    demand(type(value) is int and 0 <= value < count, f"{where}: 0 to {count - 1} is wanted")
    return int(value)


NUMBER = re.compile("([+-]?)([0-9]+)(?:[.]([0-9]+))?(?:[eE][+-]?[0-9]{1,3})?")


def exact(text: str, where: str) -> Fraction:
    """Return the value of a decimal whose digits and size are bounded."""
    found = NUMBER.fullmatch(text)
    demand(found, f"{where}: {shown(text)} is no decimal number")
    digits = len(found[2]) + len(found[3] or "") if found else 0
    demand(digits <= MAX_DIGITS, f"{where}: a number of more than {MAX_DIGITS} digits")
    value = Fraction(text)
    fits = not value or 1 / LARGEST <= abs(value) <= LARGEST
    demand(fits, f"{where}: a number that is not 0 has a size between 1e-100 and 1e100")
    return value


def decimal(value: Any, where: str) -> Fraction:
    """Return the exact value of a decimal of a certificate: a string such as "-12.5"."""
    known = type(value) is str and len(value) <= 60 and value[:1] != "+" and value.isascii()
    demand(known, f'{where}: a decimal number in quotes is wanted, such as "-12.5"')
    return exact(value, where)


def exactly(x: Fraction) -> str:
    """Write a decimal with all its digits and without an exponent."""
    digits, scale = 0, x.denominator
    while scale % 10 == 0:
        scale, digits = scale // 10, digits + 1
    while scale != 1:  # powers of 2 or of 5 are left
        scale, digits = (scale // 2 if scale % 2 == 0 else scale // 5), digits + 1
    whole = str(abs(x.numerator) * 10**digits // x.denominator).rjust(digits + 1, "0")
    point = len(whole) - digits
    return "-" * (x < 0) + whole[:point] + ("." + whole[point:] if digits else "")


def weights_of(value: Any, where: str, count: int) -> list[Fraction]:
    """Return the weights of a mean of some corners."""
    weights = [decimal(x, where) for x in list_of(value, where, count, count)]
    is_mean = min(weights) >= 0 and sum(weights) == 1
    demand(is_mean, f"{where}: numbers of 0 or more whose sum is 1 are wanted")
    return weights


def mean(weights: Sequence[Fraction], corners: Sequence[Exact]) -> Exact:
    """Return a mean of corners."""
    Work.add(len(weights))
    pairs = [zip(weights, column, strict=True) for column in zip(*corners, strict=True)]
    return tuple(sum((w * x for w, x in pair), Fraction(0)) for pair in pairs)


def read_json(data: bytes) -> Any:
    """Read JSON of which no key stands twice, and whose only numbers are short integers."""
    demand(len(data) <= MAX_FILE, f"the file has more than {MAX_FILE} bytes")
    try:
        return json.loads(
            data.decode("utf-8"),
            object_pairs_hook=_unique,
            parse_int=_integer,
            parse_float=_no_number,
            parse_constant=_no_number,
        )
    except UnicodeDecodeError:
        raise Refused("the file is not UTF-8 text") from None
    except RecursionError:
        raise Refused("the file is nested too deeply") from None
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise Refused(f"the file is not JSON: {where}: {error.msg}") from None


def _unique(pairs: list[tuple[str, Any]]) -> Table:
    table = dict(pairs)
    demand(len(table) == len(pairs), "the file has a key twice in one object")
    return table


def _integer(text: str) -> int:
    known = re.fullmatch("0|-?[1-9][0-9]{0,8}", text)
    demand(known, f"the file has the number {shown(text)}: integers have at most nine digits")
    return int(text)


def _no_number(text: str) -> Any:
    raise Refused(f"the file has the number {shown(text)}: decimals are written as strings")


# --- reading: the robot's text as TOML ------------------------------------------------------------


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


def read_toml(text: str) -> Any:
    """Read TOML after a look at its marks, on which the reader of TOML could work for long.

    Dotted keys cost that reader the square of their number of parts, tables in tables more. No
    robot needs either: between two marks there is at most one string or word.
    """
    line, depth, between = 1, 0, list[str]()
    for token in TOKEN.finditer(text):
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
        return tomllib.loads(text, parse_float=TomlFloat)
    except ValueError as error:  # also an integer of thousands of digits
        raise Refused(f"robot: no TOML: {error}") from None


def number(value: Any, where: str) -> Fraction:
    """Return the exact value of an integer or a float of TOML."""
    if type(value) is int:
        demand(abs(value) < 10**MAX_DIGITS, f"{where}: a number of more than {MAX_DIGITS} digits")
        return Fraction(value)
    demand(isinstance(value, TomlFloat), f"{where}: a number is wanted")
    return exact(value.text.replace("_", ""), where)


def vector_of(value: Any, where: str) -> Exact:
    """Return three numbers."""
    return tuple(number(x, where) for x in list_of(value, where, 3, 3))


def direction_of(value: Any, where: str) -> Exact:
    """Return three numbers that are not all 0."""
    vector = vector_of(value, where)
    demand(any(vector), f"{where}: a direction must not be 0")
    return vector


def size_of(value: Any, where: str) -> Fraction:
    """Return a number of 0 or more."""
    found = number(value, where)
    demand(found >= 0, f"{where}: a number of 0 or more is wanted")
    return found


def label_of(value: Any, where: str) -> str:
    """Return a name."""
    return text_of(value, where, 200)


def known_of(value: Any, where: str, names: Iterable[str]) -> str:
    """Return a name that is one of some."""
    name = label_of(value, where)
    demand(name in names, f"{where}: nothing is called {shown(name)}")
    return name


def different(what: str, names: Sequence[str]) -> None:
    """Refuse a name that stands for two things."""
    demand(len({*names}) == len(names), f"robot: {what}: a name is used twice")


# --- reading: the robot ---------------------------------------------------------------------------


@dataclass(frozen=True)
class JointRow:
    """A joint: its name, whether it turns, and its limits in the units of the file."""

    name: str
    turns: bool
    limits: tuple[Fraction, Fraction] | None


@dataclass(frozen=True)
class StepRow:
    """A step of the normal form."""

    joint: int
    factor: int
    origin: Exact
    rpy: Exact
    axis: Exact


@dataclass(frozen=True)
class Thing:
    """A point, or a body: a core of one corner, of a segment, or of an outline, with a radius."""

    name: str
    kind: str
    frame: int
    corners: tuple[Exact, ...]
    radius: Fraction


@dataclass(frozen=True)
class Boundary:
    """Two things that keep `distance` plus their radii apart; with a normal, one above a plane."""

    name: str
    things: tuple[Thing, ...]
    normal: Exact | None
    distance: Fraction

    @property
    def gap(self) -> Fraction:
        """Return the distance between cores, or of a core from the plane through the origin."""
        return self.distance + sum(thing.radius for thing in self.things)


@dataclass(frozen=True)
class KeepRow:
    """A thing to keep of the normal form: hulls by their numbers."""

    name: str
    near: int | None
    far: int
    gap: Fraction
    along: int | None
    normal: Exact | None


@dataclass(frozen=True)
class Robot:
    """What a robot's text says, as far as it bears on claims: the normal form before it is written.

    Attributes
    ----------
    hulls : tuple of (frame, corners)
    flat : of frames with bodies, the coordinate along the common axis
    left_out : what is not to be kept, in words
    """

    name: str
    length_unit: str
    angle_unit: str
    joints: tuple[JointRow, ...]
    steps: tuple[StepRow, ...]
    frames: tuple[str, ...]
    boundaries: tuple[Boundary, ...]
    hulls: tuple[tuple[int, tuple[Exact, ...]], ...]
    keeps: tuple[KeepRow, ...]
    flat: dict[int, int]
    left_out: tuple[str, ...]

    @property
    def form(self) -> Table:
        """Return the normal form."""
        return {
            "name": self.name,
            "length_unit": self.length_unit,
            "angle_unit": self.angle_unit,
            "joints": [
                {"name": j.name, "turns": j.turns, "limits": j.limits and [*map(exactly, j.limits)]}
                for j in self.joints
            ],
            "steps": [
                {
                    "joint": s.joint,
                    "factor": str(s.factor),
                    "offset": "0",
                    **{key: [*map(exactly, getattr(s, key))] for key in ("origin", "rpy", "axis")},
                }
                for s in self.steps
            ],
            "hulls": [
                {"frame": frame, "corners": [[*map(exactly, p)] for p in corners]}
                for frame, corners in self.hulls
            ],
            "keep": [
                {"name": k.name, "far": k.far, "gap": exactly(k.gap)}
                | (
                    {"near": k.near, "along": k.along}
                    if k.normal is None
                    else {"normal": [*map(exactly, k.normal)]}
                )
                for k in self.keeps
            ],
        }


def read_robot(text: str, parts: Any) -> Robot:
    """Read a robot's text and bring it to its normal form: every table, key and type is known."""
    required = ("schema", "name", "length_unit", "angle_unit", "home", "tool", "joint", "point")
    optional = ("boundary", "body", "obstacle", "collisions", "clearance", "allowed")
    file = table_of(read_toml(text), "robot", required, optional)
    demand(type(file["schema"]) is int and file["schema"] == 1, "robot: schema: 1 is wanted")
    unit_name = one_of(file["angle_unit"], "robot: angle_unit", ("deg", "rad"))
    length_unit = one_of(file["length_unit"], "robot: length_unit", ("m", "cm", "mm"))
    joints, steps, frames = _read_joints(file["joint"], unit_name)
    points = _read_points(file["point"], frames)
    known_of(file["tool"], "robot: tool", points)
    for name, value in table_of(file["home"], "robot: home", [j.name for j in joints]).items():
        number(value, f"robot: home: {shown(name)}")
    bodies = _read_bodies(file.get("body", []), file.get("obstacle", []), frames)
    boundaries, left_out = _read_boundaries(file, points, bodies, joints)
    used = [t for boundary in boundaries for t in boundary.things if t.kind != "point"]
    flat = _common_axis(steps, joints, unit_name, sorted({thing.frame for thing in used}))
    lifted = {t.name: tuple(_lifted(p, flat[t.frame]) for p in t.corners) for t in used}
    hulls, keeps = _normalised(boundaries, lifted, flat, parts)
    name = label_of(file["name"], "robot: name")
    args = (joints, steps, frames, boundaries, hulls, keeps, flat, left_out)
    return Robot(name, length_unit, unit_name, *args)


def _read_joints(
    value: Any, unit_name: str
) -> tuple[tuple[JointRow, ...], tuple[StepRow, ...], tuple[str, ...]]:
    joints, steps, frames = list[JointRow](), list[StepRow](), list[str]()
    for j, item in enumerate(list_of(value, "robot: joint", 1, MAX_JOINTS)):
        where = f"robot: joint[{j}]"
        required = ("name", "type", "parent", "frame", "origin", "axis")
        kinds = ("revolute", "prismatic", "parallelogram")
        kind = one_of(item.get("type") if type(item) is dict else None, f"{where}: type", kinds)
        more = ("crank", "bar") if kind == "parallelogram" else ()
        row = table_of(item, where, (*required, *more), ("rpy", "limits", "velocity"))
        turns = kind != "prismatic"
        demand(turns or "limits" in row, f"{where}: a prismatic joint needs limits")
        rpy = vector_of(row.get("rpy", [0, 0, 0]), f"{where}.rpy")
        fits = all(abs(angle) <= LARGEST_ANGLE[unit_name] for angle in rpy)
        demand(fits, f"{where}.rpy: an angle of more than five turns")
        speed = number(row.get("velocity", 1), f"{where}.velocity")
        demand(speed > 0, f"{where}.velocity: a number of more than 0 is wanted")
        limits = (
            _limits(row["limits"], f"{where}.limits", turns, unit_name) if "limits" in row else None
        )
        joints.append(JointRow(label_of(row["name"], f"{where}.name"), turns, limits))
        axis, parent = (
            direction_of(row["axis"], f"{where}.axis"),
            label_of(row["parent"], f"{where}.parent"),
        )
        demand(
            not frames or parent == frames[-1],
            "robot: joint: each parent is the frame of the joint before",
        )
        frames += [] if frames else [parent]
        steps.append(StepRow(j, 1, vector_of(row["origin"], f"{where}.origin"), rpy, axis))
        if more:
            frames.append(label_of(row["bar"], f"{where}.bar"))
            crank = vector_of(row["crank"], f"{where}.crank")
            steps.append(StepRow(j, -1, crank, (Fraction(0),) * 3, axis))
        frames.append(label_of(row["frame"], f"{where}.frame"))
    different("joint", [joint.name for joint in joints])
    different("frames", frames)
    return tuple(joints), tuple(steps), tuple(frames)


def _limits(value: Any, where: str, turns: bool, unit_name: str) -> tuple[Fraction, Fraction]:
    low, high = (number(x, where) for x in list_of(value, where, 2, 2))
    demand(low < high, f"{where}: the first one must be less")
    widest = 100 * (Fraction(360) if unit_name == "deg" else 2 * PI)
    demand(not turns or high - low <= widest, f"{where}: more than 100 turns apart")
    return low, high


def _read_points(value: Any, frames: Sequence[str]) -> dict[str, Thing]:
    points = dict[str, Thing]()
    for i, item in enumerate(list_of(value, "robot: point", 1, MAX_ROWS)):
        where = f"robot: point[{i}]"
        row = table_of(item, where, ("name", "frame", "at"), ("radius",))
        name = label_of(row["name"], f"{where}.name")
        demand(name not in points, f"{where}: the name {shown(name)} is used twice")
        demand(name not in frames, f"{where}: {shown(name)} is the name of a frame")
        frame = frames.index(known_of(row["frame"], f"{where}.frame", frames))
        radius = size_of(row.get("radius", 0), f"{where}.radius")
        points[name] = Thing(name, "point", frame, (vector_of(row["at"], f"{where}.at"),), radius)
    return points


SHAPES = ("polygon", "capsule", "disc")


def _read_bodies(links: Any, obstacles: Any, frames: Sequence[str]) -> dict[str, Thing]:
    """Return all bodies by name, in their order along the chain, obstacles last.

    One without a name is called by its frame: 1, 1/2, 1/3 and so on. A corner is written with two
    numbers or with three.
    """
    kinds = (("body", links), ("obstacle", obstacles))
    found = list[Thing]()
    for kind, items in kinds:
        for i, item in enumerate(list_of(items, f"robot: {kind}", 0, MAX_ROWS)):
            where = f"robot: {kind}[{i}]"
            own = ("frame",) if kind == "body" else ()
            row = table_of(item, where, own, ("name", *SHAPES))
            label = known_of(row["frame"], f"{where}.frame", frames) if own else frames[0]
            frame = frames.index(label)
            count = 1 + sum(body.frame == frame for body in found)
            usual = label if count == 1 else f"{label}/{count}"
            name = label_of(row["name"], f"{where}.name") if "name" in row else usual
            found.append(Thing(name, *_read_shape(row, where, frame)))
        if kind == "body":
            found.sort(key=lambda body: body.frame)
    different("body", [body.name for body in found])
    return {body.name: body for body in found}


def _read_shape(row: Table, where: str, frame: int) -> tuple[str, int, tuple[Exact, ...], Fraction]:
    shapes = [shape for shape in SHAPES if shape in row]
    demand(len(shapes) == 1, f"{where}: {' or '.join(SHAPES)} is wanted, one of them")
    shape, where, radius = shapes[0], f"{where}.{shapes[0]}", Fraction(0)
    if shape == "polygon":
        written = list_of(row[shape], where, 3, MAX_CORNERS)
    else:
        ends = ("from", "to") if shape == "capsule" else ("at",)
        table = table_of(row[shape], where, (*ends, "radius"))
        written, radius = [table[end] for end in ends], size_of(table["radius"], where)
    corners = [tuple(number(x, where) for x in list_of(p, where, 2, 3)) for p in written]
    return shape, frame, tuple(corners), radius


KEYS_OF = {
    "pair": (("points",), ("clearance",)),
    "bodies": (("bodies",), ("clearance",)),
    "half-space": (("normal", "offset"), ("point", "body")),
}
"""For each type of boundary: the keys that it needs, and those that it may have."""


def _read_boundaries(
    file: Table, points: dict[str, Thing], bodies: dict[str, Thing], joints: Sequence[JointRow]
) -> tuple[tuple[Boundary, ...], tuple[str, ...]]:
    """Read all boundaries, add the pairs that `collisions` makes; return those in use."""
    rows = [
        _read_boundary(item, f"robot: boundary[{i}]", points, bodies)
        for i, item in enumerate(list_of(file.get("boundary", []), "robot: boundary", 0, MAX_ROWS))
    ]
    named = {frozenset(t.name for t in b.things) for b, _ in rows if b.things[0].kind != "point"}
    clearance = size_of(file.get("clearance", 0), "robot: clearance")
    allowed = list_of(file.get("allowed", []), "robot: allowed", 0, MAX_ROWS)
    apart = {_two_names(row, "robot: allowed", bodies) for row in allowed}
    if "collisions" in file:
        one_of(file["collisions"], "robot: collisions", ("all",))
        pairs = itertools.combinations(bodies.values(), 2)
        for one, other in ((a, b) for a, b in pairs if a.frame != b.frame):
            demand(len(rows) <= 2 * MAX_BOUNDARIES, "robot: collisions: too many pairs of bodies")
            if frozenset((one.name, other.name)) not in apart | named:
                name = f"{one.name}, {other.name}"
                rows.append((Boundary(name, (one, other), None, clearance), True))
    limits = [f"{joint.name}.{side}" for joint in joints for side in ("lower", "upper")]
    names = [boundary.name for boundary, _ in rows]
    different("boundary", names)
    demand(not {*names} & {*limits}, "robot: boundary: the name of a joint limit")
    used = tuple(boundary for boundary, is_used in rows if is_used)
    demand(len(used) <= MAX_BOUNDARIES, f"robot: more than {MAX_BOUNDARIES} boundaries in use")
    unused = [f"{boundary.name!a} (used = false)" for boundary, is_used in rows if not is_used]
    left_out = [*unused, *[f"{len(apart)} allowed pairs"] * bool(apart)]
    if bodies:
        left_out.append("bodies of one frame" if "collisions" in file else "other pairs of bodies")
    return used, tuple(left_out)


def _two_names(value: Any, where: str, known: Iterable[str]) -> frozenset[str]:
    names = frozenset(known_of(name, where, known) for name in list_of(value, where, 2, 2))
    demand(len(names) == 2, f"{where}: two different names are wanted")
    return names


def _read_boundary(
    value: Any, where: str, points: dict[str, Thing], bodies: dict[str, Thing]
) -> tuple[Boundary, bool]:
    """Return a boundary, and whether it is in use."""
    kind = one_of(value.get("type") if type(value) is dict else None, f"{where}: type", [*KEYS_OF])
    required, optional = KEYS_OF[kind]
    row = table_of(value, where, ("name", "type", *required), ("used", *optional))
    used = row.get("used", True)
    demand(type(used) is bool, f"{where}.used: true or false is wanted")
    normal, distance = None, size_of(row.get("clearance", 0), f"{where}.clearance")
    if kind == "half-space":
        demand(("point" in row) != ("body" in row), f"{where}: a point or a body is wanted")
        key = "point" if "point" in row else "body"
        names, known = [row[key]], points if key == "point" else bodies
        normal = direction_of(row["normal"], f"{where}.normal")
        distance = number(row["offset"], f"{where}.offset")
    else:
        key, known = required[0], points if kind == "pair" else bodies
        names = list_of(row[key], f"{where}.{key}", 2, 2)
        _two_names(names, f"{where}.{key}", known)
    things = tuple(known[known_of(name, f"{where}.{key}", known)] for name in names)
    frames = {thing.frame for thing in things}
    demand(kind != "bodies" or len(frames) == 2, f"{where}.bodies: both are of one frame")
    return Boundary(label_of(row["name"], f"{where}.name"), things, normal, distance), used


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


NEARLY = 1 << BITS - 30
"""About 1e-9: what angles in a file that were rounded may leave of what should be 0."""


def _common_axis(
    steps: Sequence[StepRow], joints: Sequence[JointRow], unit_name: str, frames: Sequence[int]
) -> dict[int, int]:
    """Return for each frame with bodies its coordinate along the common axis of the joints."""
    if not frames:
        return {}
    turned, every, axes = AXES, [AXES], list[tuple[bool, Vector]]()
    for step in steps:
        turned = product(turned, mount_of(step.rpy, unit_name))
        axes.append((joints[step.joint].turns, image(turned, unit(step.axis))))
        every.append(turned)
    found = next((axis for turns, axis in axes if turns), None)
    for axis in (AXES[1], AXES[2], AXES[0]):
        across = all(abs(dot(axis, slide)) <= NEARLY for _, slide in axes)
        found = axis if found is None and across else found
    if found is None:
        raise Refused("robot: the joints slide across no axis of the base: bodies have no plane")
    for turns, axis in axes:
        off = size(cross(found, axis)) if turns else abs(dot(found, axis))
        demand(off <= NEARLY, "robot: bodies keep apart in a plane only, and the arm leaves it")
    flat = dict[int, int]()
    for frame in frames:
        along = [k for k in range(3) if size(cross(found, every[frame][k])) <= NEARLY]
        demand(along, "robot: no axis of a frame with bodies is along the common axis")
        flat[frame] = along[0]
    return flat


def _lifted(corner: Exact, flat: int) -> Exact:
    """Return a corner of three numbers; one of two has a 0 along the common axis."""
    return corner if len(corner) == 3 else (*corner[:flat], Fraction(0), *corner[flat:])


def _normalised(
    boundaries: Sequence[Boundary],
    lifted: dict[str, tuple[Exact, ...]],
    flat: dict[int, int],
    parts: Any,
) -> tuple[tuple[tuple[int, tuple[Exact, ...]], ...], tuple[KeepRow, ...]]:
    """Return the hulls and the things to keep of the normal form."""
    outlines = {
        thing.name: thing
        for boundary in boundaries
        if boundary.normal is None
        for thing in boundary.things
        if thing.kind == "polygon"
    }
    cut = {name: _convex(lifted[name], flat[thing.frame], name) for name, thing in outlines.items()}
    table = table_of(parts, "parts", [name for name, convex in cut.items() if not convex])
    loops = {}
    for name, value in table.items():
        where = f"parts: {shown(name)}"
        rows = [
            list_of(row, where, 3, MAX_CORNERS) for row in list_of(value, where, 1, MAX_CORNERS)
        ]
        count = len(lifted[name])
        loops[name] = [tuple(index_of(k, where, count) for k in row) for row in rows]
        outline = _seen(lifted[name], flat[outlines[name].frame])
        demand_filled([outline], [[outline[k] for k in loop] for loop in loops[name]], where)
    hulls, numbers = (
        list[tuple[int, tuple[Exact, ...]]](),
        dict[tuple[str, str, tuple[int, ...]], int](),
    )

    def hull(thing: Thing, loop: Sequence[int]) -> int:
        corners = lifted.get(thing.name, thing.corners) if thing.kind != "point" else thing.corners
        key = "point" if thing.kind == "point" else "body", thing.name, tuple(loop)
        if key not in numbers:
            numbers[key] = len(hulls)
            hulls.append((thing.frame, tuple(corners[k] for k in loop)))
        return numbers[key]

    keeps = list[KeepRow]()
    for boundary in boundaries:
        near, far = boundary.things[0], boundary.things[-1]
        if boundary.normal is not None:
            whole = hull(far, range(len(far.corners)))
            keeps.append(KeepRow(boundary.name, None, whole, boundary.gap, None, boundary.normal))
            continue
        if far.frame < near.frame:
            near, far = far, near
        along = None if near.kind == "point" else flat[near.frame]
        every = [
            [tuple(range(len(t.corners)))]
            if t.name not in loops or t.kind == "point"
            else loops[t.name]
            for t in (near, far)
        ]
        for one, other in itertools.product(*every):
            demand(len(keeps) < MAX_KEEPS, f"robot: more than {MAX_KEEPS} pairs of parts")
            numbered = hull(near, one), hull(far, other)
            keeps.append(KeepRow(boundary.name, *numbered, boundary.gap, along, None))
    return tuple(hulls), tuple(keeps)


def _seen(corners: Sequence[Exact], flat: int) -> list[tuple[int, int]]:
    """Return an outline along the common axis, anticlockwise, in whole numbers."""
    pairs = [tuple(x for k, x in enumerate(p) if k != flat) for p in corners]
    whole = math.lcm(*(x.denominator for pair in pairs for x in pair))
    found = [(int(x * whole), int(y * whole)) for x, y in pairs]
    return found if doubled_area(found) > 0 else [(-x, y) for x, y in found]


def _convex(corners: Sequence[Exact], flat: int, name: str) -> bool:
    """Tell whether an outline is convex; refuse one without an area."""
    outline = _seen(corners, flat)
    demand(doubled_area(outline), f"robot: the outline of {shown(name)} has no area")
    return is_convex(outline) and len({*map(str, outline)}) == len(outline)


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
    pieces hold it, and a place that they wind around lies in a piece. Points are numbered by
    sorting, because the hash of a number can be chosen and that of a text cannot.
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
    """A robot in units: lengths as parts of the largest one, with the margin of a claim."""

    def __init__(self, robot: Robot, margin: Fraction) -> None:
        self.robot, self.joints = robot, robot.joints
        self.corners = [corners for _, corners in robot.hulls]
        slides = [x for joint in robot.joints if not joint.turns for x in joint.limits or ()]
        places = [x for corners in self.corners for p in corners for x in p]
        origins = [x for step in robot.steps for x in step.origin]
        gaps = [keep.gap + margin for keep in robot.keeps]
        self.largest = max(
            map(abs, [*slides, *places, *origins, *gaps]), default=Fraction(0)
        ) or Fraction(1)
        self.turn = 2 * in_units(PI)
        self.steps = [self._step(row) for row in robot.steps]
        hulls = [Hull(frame, tuple(map(self.scaled, corners))) for frame, corners in robot.hulls]
        self.keeps = [
            Keep(
                row.name,
                None if row.near is None else hulls[row.near],
                hulls[row.far],
                in_units(gap / self.largest) + 1,
                row.along,
                None if row.normal is None else unit(row.normal),
            )
            for row, gap in zip(robot.keeps, gaps, strict=True)
        ]
        self.needs_proof = [
            keep.near is None or gap != 0 or len(keep.near.corners) + len(keep.far.corners) > 3
            for keep, gap in zip(self.keeps, gaps, strict=True)
        ]

    def _step(self, row: StepRow) -> Step:
        joint, origin = self.joints[row.joint], self.scaled(row.origin)
        low, high = (0, 0) if joint.turns else self.whole_range(row.joint)
        sweep = (high - low + 1 >> 1) + 1
        reach = size(origin) + max(abs(low), abs(high))
        mount = mount_of(row.rpy, self.robot.angle_unit)
        return Step(
            row.joint,
            joint.turns,
            row.factor << BITS,
            0,
            origin,
            mount,
            unit(row.axis),
            reach,
            sweep,
        )

    def scaled(self, place: Sequence[Fraction]) -> Vector:
        """Return three lengths in units."""
        x, y, z = (in_units(x / self.largest) for x in place)
        return x, y, z

    def value(self, j: int, x: Fraction) -> int:
        """Return a value of a joint in units."""
        return (
            in_radians(x, self.robot.angle_unit)
            if self.joints[j].turns
            else in_units(x / self.largest)
        )

    def placed(self, q: Exact, turns: Sequence[int | None] | None = None) -> Point:
        """Return a configuration in units; where a turn is given, within half of it about 0."""
        found = [self.value(j, x) for j, x in enumerate(q)]
        for j, turn in enumerate(turns or ()):
            if turn is not None:
                found[j] -= (found[j] + turn // 2) // turn * turn
        return tuple(found)

    def whole_range(self, j: int) -> tuple[int, int]:
        """Return the limits of a joint; without limits a turn, in radians a little more."""
        ends = {"deg": Fraction(180), "rad": Fraction("3.1416")}[self.robot.angle_unit]
        low, high = self.joints[j].limits or (-ends, ends)
        return self.value(j, low), self.value(j, high)

    def across(self, frame: int) -> tuple[int, int]:
        """Return the two coordinates of a frame in which its bodies are seen."""
        i, k = (k for k in range(3) if k != self.robot.flat[frame])
        return i, k

    def unit_of(self, j: int) -> str:
        """Return the unit of a joint's values."""
        return self.robot.angle_unit if self.joints[j].turns else self.robot.length_unit

    def beyond(self, q: Exact) -> list[str]:
        """Return the names of the limits that a configuration is beyond: compared exactly."""
        found = []
        for joint, value in zip(self.joints, q, strict=True):
            low, high = joint.limits or (value, value)
            found += [f"{joint.name}.lower"] * (value < low)
            found += [f"{joint.name}.upper"] * (value > high)
        return found


@dataclass(frozen=True)
class Claim:
    """What a certificate claims: a set with the corners of its cells, or two configurations."""

    kind: str
    margin: Fraction
    loops: tuple[tuple[Exact, ...], ...]
    corners: tuple[tuple[Exact, ...], ...]
    joints: tuple[str, ...]


def configuration(value: Any, where: str, arm: "Robot | Arm") -> Exact:
    """Return one value for each joint; angles are no larger than the page says."""
    robot = arm if isinstance(arm, Robot) else arm.robot
    row = list_of(value, where, len(robot.joints), len(robot.joints))
    q = tuple(decimal(x, where) for x in row)
    largest = LARGEST_ANGLE[robot.angle_unit]
    fits = all(abs(x) <= largest for x, j in zip(q, robot.joints, strict=True) if j.turns)
    demand(fits, f"{where}: an angle of more than {largest} {robot.angle_unit}")
    return q


def read_claim(value: Any, robot: Robot) -> Claim:
    """Read a claim and the cells of its set."""
    sets = ("box", "path", "polygon", "no path")
    kind = one_of(value.get("set") if type(value) is dict else None, "claim: set", sets)
    more = {"polygon": ("triangles",), "no path": ("joints",)}.get(kind, ())
    table = table_of(value, "claim", ("set", "margin", "points", *more))
    margin = decimal(table["margin"], "claim: margin")
    demand(margin >= 0, "claim: margin: a length of 0 or more is wanted")
    most, count = 1 if kind in ("box", "no path") else MAX_CELLS, 0
    loops = list[tuple[Exact, ...]]()
    for i, item in enumerate(list_of(table["points"], "claim: points", 1, most)):
        where = f"claim: points[{i}]"
        row = list_of(item, where, 3 if kind == "polygon" else 2, 2 if most == 1 else MAX_CELLS)
        count += len(row)
        demand(count <= MAX_CELLS, f"{where}: more than {MAX_CELLS} configurations in all")
        loops.append(tuple(configuration(q, f"{where}[{k}]", robot) for k, q in enumerate(row)))
    joints, corners = tuple[str, ...](), list[tuple[Exact, ...]]()
    if kind == "box":
        low, high = loops[0]
        rises = all(a <= b for a, b in zip(low, high, strict=True))
        demand(rises, "claim: points[0]: the first corner is the low one in every joint")
        corners = [loops[0]]
    elif kind == "path":
        corners = [pair for loop in loops for pair in itertools.pairwise(loop)]
    elif kind == "polygon":
        corners = _triangles(loops, table["triangles"])
    else:
        joints = _read_moving(table["joints"], *loops[0])
    return Claim(kind, margin, tuple(loops), tuple(corners), joints)


def _read_moving(value: Any, start: Exact, goal: Exact) -> tuple[str, ...]:
    where, kinds = "claim: joints", ("moves", "held", "any")
    joints = tuple(one_of(x, where, kinds) for x in list_of(value, where, len(start), len(start)))
    demand("moves" in joints, f"{where}: at least one joint moves")
    agree = all(a == b for a, b, kind in zip(start, goal, joints, strict=True) if kind == "held")
    demand(agree, f"{where}: start and goal differ in a joint that is held")
    return joints


def _triangles(loops: Sequence[Sequence[Exact]], value: Any) -> list[tuple[Exact, ...]]:
    """Return the triangles of a polygon after a look at how they fill its loops."""
    points = [q for loop in loops for q in loop]
    columns = [*zip(*points, strict=True)]
    plane = [j for j, column in enumerate(columns) if min(column) != max(column)]
    demand(len(plane) == 2, f"claim: points: {len(plane)} joints of a polygon vary, not two")
    scales = [math.lcm(*(x.denominator for x in columns[j])) for j in plane]
    i, k = plane
    places = [(int(q[i] * scales[0]), int(q[k] * scales[1])) for q in points]
    rows = list_of(value, "claim: triangles", 1, MAX_CELLS)
    numbers = [
        [
            index_of(k, f"claim: triangles[{i}]", len(points))
            for k in list_of(row, f"claim: triangles[{i}]", 3, 3)
        ]
        for i, row in enumerate(rows)
    ]
    flat, first = list[Any](), 0
    for loop in loops:
        flat.append(places[first : first + len(loop)])
        first += len(loop)
    demand_filled(flat, [[places[k] for k in row] for row in numbers], "claim: triangles")
    return [tuple(points[k] for k in row) for row in numbers]


# --- the answer -----------------------------------------------------------------------------------


class Answer(NamedTuple):
    """What a certificate shows: that its claim is refuted, else that it is proved."""

    refuted: bool
    said: str


def normal_form(text: str, parts: Any) -> Table:
    """Return the normal form of a robot's text; for those who write certificates."""
    Work.done = 0
    return read_robot(text, parts).form


def canonical(form: Table) -> str:
    """Return the text whose hash stands in a certificate."""
    return json.dumps(form, indent=1, sort_keys=True) + "\n"


def digest(text: str) -> str:
    """Return the SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def check(data: str | bytes, robot: str | None = None, file: str = "the file given") -> Answer:
    """Return what a certificate shows, and what is to be said of it.

    data : the certificate.
    robot : the text of a robot file that the certificate must be about; `file` is its name.

    Raises `Refused`, a `ValueError` that names what is wrong and where, if it shows nothing.
    """
    content, found = read(data)
    pinned = "not compared with any robot file"
    if robot is not None:
        other = robot == content["robot"] or read_robot(robot, content["parts"]) == found
        demand(other, f"the robot is not that of {shown(file)}")
        pinned = f"compared with {shown(file)}: the same"
    claim = read_claim(content["claim"], found)
    arm = Arm(found, claim.margin)
    heading = f"robot {found.name!a}, sha256 of its normal form {content['sha256']}, {pinned}"
    if "witness" in content:
        demand(claim.kind != "no path", "witness: of a claim of no path there is none")
        refuted = refute(arm, claim, content["witness"])
        return Answer(True, "\n".join([heading, f"refuted: {refuted}", *described(arm, claim)]))
    if claim.kind == "no path":
        prove_no_path(arm, claim, content["proof"])
    else:
        for q in (q for cell in claim.corners for q in cell):
            beyond = arm.beyond(q)
            demand(not beyond, f"claim: beyond the limit {shown(next(iter(beyond), ''))}")
        shape = Box if claim.kind == "box" else lambda *ends: Simplex(ends)
        cells = [shape(*map(arm.placed, cell)) for cell in claim.corners]
        prove_safe(arm, cells, content["proof"])
    return Answer(False, "\n".join([heading, *proved(arm, claim), *described(arm, claim)]))


def read(data: str | bytes) -> tuple[Table, Robot]:
    """Read a certificate and its robot, and compare the hash of the normal form."""
    Work.done = 0
    cos_sin.cache_clear()  # so that the work does not depend on what was checked before
    content = read_json(data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data)
    demand(type(content) is dict, "the file is no JSON object")
    schema = content.get("schema")
    demand(schema == SCHEMA, f"schema: {SCHEMA} is wanted; older formats are not read any more")
    shows = "witness" if "witness" in content else "proof"
    table = table_of(content, "the file", ("schema", "robot", "parts", "sha256", "claim", shows))
    text = text_of(table["robot"], "robot", MAX_ROBOT)
    demand(not re.search("[\ud800-\udfff]", text), "robot: half a character")
    found = read_robot(text, table["parts"])
    sha256 = digest(canonical(found.form))
    demand(table["sha256"] == sha256, f"sha256: the hash of the normal form is {sha256}")
    return table, found


def proved(arm: Arm, claim: Claim) -> Iterator[str]:
    """Say what was proved, and what was not claimed."""
    robot, spare = arm.robot, f"{exactly(claim.margin)} {arm.robot.length_unit}"
    limited = ", ".join(ascii(joint.name) for joint in robot.joints if joint.limits)
    if claim.kind == "no path":
        [[start, goal]] = claim.loops
        yield f"proved: no path from {_point(start)} to {_point(goal)} keeps all of the following"
        for j, (joint, kind) in enumerate(zip(robot.joints, claim.joints, strict=True)):
            told = {
                "held": f"is held at {exactly(start[j])} {arm.unit_of(j)}",
                "any": "takes any value, even jumps",
            }
            if kind in told:
                yield f"  {joint.name!a} {told[kind]}"
    elif not arm.keeps and not limited:
        yield "proved: nothing was to be kept; the robot has no boundary in use and no limit"
    else:
        yield "proved: at every configuration of the set all of this is kept"
    if arm.keeps:
        yield f"with {spare} to spare:"
    for boundary in robot.boundaries:
        yield f"  {boundary.name!a}: {_in_words(robot, boundary)}"
    if limited:
        yield f"  the limits of {limited}"
    if robot.left_out:
        yield f"not claimed: {', '.join(robot.left_out)}"


def _in_words(robot: Robot, boundary: Boundary) -> str:
    """Say what a boundary asks for."""
    unit_name, kinds = (
        robot.length_unit,
        {"polygon": "outline", "capsule": "capsule", "disc": "disc"},
    )
    names = []
    for thing in boundary.things:
        kind = kinds.get(thing.kind, "point")
        radius = f" with radius {exactly(thing.radius)} {unit_name}" if thing.radius else ""
        names.append(f"{kind} {thing.name!a} of frame {robot.frames[thing.frame]!a}{radius}")
    if boundary.normal is not None:
        normal, least = ", ".join(map(exactly, boundary.normal)), exactly(boundary.distance)
        whole = "" if boundary.things[0].kind == "point" else "all of "
        place = f"{whole}{names[0]} has normal . place >= {least} {unit_name}"
        return f"{place} for the normal ({normal}) scaled to length 1"
    both = " and ".join(names)
    seen = "" if boundary.things[0].kind == "point" else ", seen along the joints' common axis"
    if boundary.distance:
        return f"{both} are at least {exactly(boundary.distance)} {unit_name} apart{seen}"
    return f"{both} do not overlap{seen}"


MOST_SHOWN = 50
"""Configurations that are printed; of larger sets their hash is, and what else names them."""


def described(arm: Arm, claim: Claim) -> Iterator[str]:
    """Describe the set by the numbers that were verified."""
    if claim.kind == "no path":
        return
    names = ", ".join(f"{joint.name!a} in {arm.unit_of(j)}" for j, joint in enumerate(arm.joints))
    points = [q for loop in claim.loops for q in loop]
    kinds = _kinds(claim)
    counted = f"{len(points)} configurations"
    if claim.kind == "polygon":
        counted += f", {kinds.count('outline')} outline(s), {kinds.count('hole')} hole(s)"
    yield f"set: {claim.kind} of {counted}, in ({names})"
    printed = [" ".join(map(_point, loop)) for loop in claim.loops]
    if len(points) <= MOST_SHOWN:
        yield from (f"  {kind}: {said}" for kind, said in zip(kinds, printed, strict=True))
    else:
        for j, (joint, column) in enumerate(
            zip(arm.joints, zip(*points, strict=True), strict=True)
        ):
            low, high = exactly(min(column)), exactly(max(column))
            yield f"  {joint.name!a} is between {low} and {high} {arm.unit_of(j)} in the set"
        for loop in claim.loops if claim.kind == "path" else ():
            yield f"  path from {_point(loop[0])} to {_point(loop[-1])}"
        yield f"  sha256 of the text of all configurations: {digest(chr(10).join(printed))}"
    for joint, j in ((joint, j) for j, joint in enumerate(arm.joints) if joint.turns):
        if _longest(claim, j) >= (
            360 if arm.robot.angle_unit == "deg" else 2 * PI + Fraction(1, 10**70)
        ):
            yield f"  {joint.name!a} takes every angle"


def _kinds(claim: Claim) -> list[str]:
    """Return what each list of configurations is: a hole of a polygon goes round clockwise."""
    if claim.kind != "polygon":
        return [{"box": "corners", "path": "path"}[claim.kind]] * len(claim.loops)
    points = [q for loop in claim.loops for q in loop]
    x, y = (j for j, column in enumerate(zip(*points, strict=True)) if min(column) != max(column))
    areas = [doubled_area([(q[x], q[y]) for q in loop]) for loop in claim.loops]
    return ["outline" if area > 0 else "hole" for area in areas]


def _longest(claim: Claim, j: int) -> Fraction:
    """Return the length of the longest range of a joint that the cells take without a gap."""
    ranges = sorted((min(q[j] for q in cell), max(q[j] for q in cell)) for cell in claim.corners)
    (start, end), longest = ranges[0], Fraction(0)
    for low, high in ranges:
        start, end = (start, max(end, high)) if low <= end else (low, high)
        longest = max(longest, end - start)
    return longest


def _point(q: Exact) -> str:
    return f"({', '.join(map(exactly, q))})"


# --- the command ----------------------------------------------------------------------------------

PROVED, REFUTED, NO_ANSWER = 0, 3, 2
"""Exit statuses; not 1, which a Python that cannot run this file ends with."""

USAGE = """usage: python -I check.py FILE [--robot ARM.toml] [--print robot]

Check a certificate of qbound: 0 proved, 3 refuted, 2 anything else.

  --robot ARM.toml  the robot file that the certificate must be about
  --print robot     print the normal form of the certificate's robot; its SHA-256 is in the file
  --version         print the format that this file checks
  --help            print this text"""


def main(arguments: Sequence[str]) -> int:
    """Do what the arguments ask for, print the answer, and return the exit status."""
    try:
        status, said = _answer(arguments)
        return status if _printed(said) else NO_ANSWER
    except KeyboardInterrupt:
        _printed("not proved: interrupted")
        return 130


def _answer(arguments: Sequence[str]) -> tuple[int, str]:
    """Return the exit status and what is to be printed, whatever a file sets off."""
    reason = "a fault of the checker itself"
    try:
        return _asked([*arguments])
    except Refused as error:
        reason = str(error)
    except MemoryError:
        reason = "the file needs more memory than there is"
    except Exception:  # whatever a hostile file sets off
        pass
    return NO_ANSWER, f"not proved: {reason}"


def _asked(arguments: list[str]) -> tuple[int, str]:
    told = {"--help": USAGE, "--version": f"check.py of {SCHEMA}"}
    if len(arguments) == 1 and arguments[0] in told:
        return PROVED, told[arguments[0]]
    options = dict[str, str]()
    for name in ("--robot", "--print"):
        if name in arguments[:-1]:
            at = arguments.index(name)
            options[name], arguments[at : at + 2] = arguments[at + 1], []
    demand(len(arguments) == 1 and arguments[0] and arguments[0][:2] != "--", USAGE)
    demand("" not in options.values(), f"an empty argument; {USAGE}")
    data = _read_file(arguments[0])
    if "--print" in options:
        demand(options == {"--print": "robot"}, USAGE)
        return PROVED, canonical(read(data)[1].form)[:-1]
    robot = _decoded(options["--robot"]) if "--robot" in options else None
    answer = check(data, robot, options.get("--robot", ""))
    return (REFUTED if answer.refuted else PROVED), answer.said


def _decoded(file: str) -> str:
    """Return the text of a robot file as qbound reads it: no mark, one sort of line end."""
    try:
        text = _read_file(file).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise Refused(f"{shown(file)}: not UTF-8 text") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


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
    safe = "".join(c if c == "\n" or " " <= c <= "~" else ascii(c)[1:-1] for c in said)
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
