"""What does the text of a certificate say? Read strictly, for the checker in ball arithmetic.

The grammar is the book's page "The certificate", and this is written from that page: it shares no
line with `check`. Every key is known, every type, count and size is bounded, and all numbers are
exact rationals. What is returned was read whole; what is not listed there is refused.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NoReturn

from qbound.proofs.grammar_robot import (
    LARGEST_ANGLE,
    LARGEST_NUMBER,
    MOST_CORNERS,
    MOST_ROWS,
    Boundary,
    Robot,
    read_robot,
)
from qbound.proofs.grammar_values import items, keys, refuse, shown, text_of
from qbound.proofs.verdict import Verdict

MOST_BYTES = 2_000_000
MOST_POINTS = 20_000
MOST_TRIANGLES = 20_000
MOST_FREE = 3
GRAMMAR, GRAMMAR_OF_BODIES, GRAMMAR_OF_NO_PATH, GRAMMAR_OF_DISCONNECTED = 2, 3, 4, 5
"""What the producers write: of robots without pairs of bodies, of others; of no path by a range of
one joint, and by boxes of up to three."""

SCHEMAS = {f"qbound/certificate/{number}": number for number in (1, 2, 3, 4, 5)}

NO_PATH = "no path"
"""Stands for a set: of all paths from one configuration to another none keeps every boundary."""

DECIMAL = re.compile(r"-?[0-9]{1,40}([.][0-9]{1,40})?([eE][+-]?[0-9]{1,2})?")
INDEX = re.compile(r"0|[1-9][0-9]{0,8}")
TREE = re.compile(r"([a-z]|([0-9]|[1-9][0-9]{1,8})?[.])+")
HASH = re.compile(r"[0-9a-f]{64}")

Point = tuple[Fraction, ...]
"""One rational a joint, in the units of the robot file."""


@dataclass(frozen=True, eq=False)
class Statement:
    """A set of joint values, in the units of the robot file, and the margin beside boundaries.

    Attributes
    ----------
    kind : str
        "box", "path", "polygon", or `NO_PATH`.
    lists : tuple of tuple of Point
        Two corners of a box, the lists of a path, the loops of a polygon; both ends of no path.
    triangles : tuple of (int, int, int)
        Of a polygon: indices into all points, list after list.
    free : tuple of int
        Of no path in grammar 5: the joints that move.
    """

    kind: str
    margin: Fraction
    lists: tuple[tuple[Point, ...], ...]
    triangles: tuple[tuple[int, int, int], ...] = ()
    free: tuple[int, ...] = ()

    @property
    def points(self) -> list[Point]:
        """All points, list after list."""
        return [point for points in self.lists for point in points]


@dataclass(frozen=True, eq=False)
class Witness:
    """What is violated, and where: at a point, or at a mean of the corners of a cell."""

    boundary: str
    at: Point | None = None
    cell: int = 0
    weights: tuple[Fraction, ...] = ()
    places: tuple[tuple[int, tuple[Fraction, ...]], ...] = ()
    """Of a pair of bodies: a part of each, and the weights of its corners."""


@dataclass(frozen=True, eq=False)
class Blocked:
    """Values of a joint, ends included, at which a boundary is said to be violated."""

    boundary: Boundary
    low: Fraction
    high: Fraction
    tree: str


@dataclass(frozen=True, eq=False)
class Barrier:
    """What no path passes: one range of a joint with limits, two of a joint without."""

    joint: int
    blocked: tuple[Blocked, ...]


@dataclass(frozen=True, eq=False)
class Disconnected:
    """A tree over the values of some joints; a leaf's number names the boundary violated on it."""

    boundaries: tuple[Boundary, ...]
    tree: str


@dataclass(frozen=True, eq=False)
class Content:
    """A certificate that follows the grammar; nothing in it is proved yet.

    Attributes
    ----------
    grammar : int
        1, 2, 3, 4 or 5.
    proof : dict of str to tuple of str
        Trees by the name of the boundary; empty where it is refuted, and of no path.
    witness : Witness or None
    parts : dict of str to tuple of tuple of int
        Corners of the convex parts of outlines, by the name of the body.
    barrier : Barrier or None
        The proof that there is no path, in grammar 4.
    disconnected : Disconnected or None
        The proof of that in grammar 5.
    """

    grammar: int
    verdict: Verdict
    statement: Statement
    robot: Robot
    sha256: str
    proof: dict[str, tuple[str, ...]]
    witness: Witness | None
    parts: dict[str, tuple[tuple[int, ...], ...]]
    barrier: Barrier | None = None
    disconnected: Disconnected | None = None


def read_certificate(text: str | bytes) -> Content:
    """Read a certificate, and refuse whatever the grammar does not list.

    Raises
    ------
    ValueError
        A sentence that says where the text departs from the grammar.
    """
    data = _json(text)
    verdict = data.get("verdict") if isinstance(data, dict) else None
    if verdict not in ("proved", "refuted"):
        refuse(f"the verdict is {shown(verdict)}: wanted proved or refuted")
    statement = data.get("statement")
    kind = statement.get("set") if isinstance(statement, dict) else None
    schema = text_of(data.get("schema"), "schema")
    if schema not in SCHEMAS:
        refuse(f"schema: {shown(schema)} is none of {', '.join(SCHEMAS)}")
    grammar = SCHEMAS[schema]
    if (grammar >= GRAMMAR_OF_NO_PATH) != (kind == NO_PATH):
        refuse(f"set: {NO_PATH} has the grammars 4 and 5, and nothing else has them")
    if grammar >= GRAMMAR_OF_NO_PATH and verdict != "proved":
        refuse(f"the verdict is {shown(verdict)}: of {NO_PATH} only proved is written")
    others = ("places",) if (grammar, verdict) == (3, "refuted") else ()
    keys(data, "the file", _keys_of(grammar, verdict, kind), others)
    robot = read_robot(text_of(data["robot"], "robot"))
    if grammar < GRAMMAR_OF_BODIES and any(b.used and b.apart for b in robot.boundaries):
        refuse(f"schema: pairs of bodies need {GRAMMAR_OF_BODIES}")
    if grammar >= GRAMMAR_OF_NO_PATH:
        ends = read_statement(statement, robot, grammar)
        barrier = _barrier(data["proof"], robot) if grammar == GRAMMAR_OF_NO_PATH else None
        boxes = _disconnected(data["proof"], robot) if grammar == GRAMMAR_OF_DISCONNECTED else None
        sha256 = _sha256(data)
        return Content(grammar, Verdict.PROVED, ends, robot, sha256, {}, None, {}, barrier, boxes)
    return Content(
        grammar,
        Verdict(verdict),
        read_statement(statement, robot),
        robot,
        _sha256(data),
        _proof(data["proof"]) if verdict == "proved" else {},
        _witness(data, robot) if verdict == "refuted" else None,
        _parts(data["parts"], robot) if grammar == GRAMMAR_OF_BODIES else {},
    )


def _keys_of(grammar: int, verdict: str, kind: Any) -> tuple[str, ...]:
    """Return the keys that the file has, all of them."""
    common: tuple[str, ...] = ("schema", "verdict", "statement", "robot", "sha256")
    if grammar == GRAMMAR_OF_BODIES:
        common = (*common, "parts")
    if verdict == "proved":
        return (*common, "proof")
    if grammar > 1 and kind == "box":
        return (*common, "boundary", "at")
    return (*common, "boundary", "cell", "weights")


def _sha256(data: dict[str, Any]) -> str:
    sha256 = text_of(data["sha256"], "sha256")
    if not HASH.fullmatch(sha256):
        refuse(f"sha256: {shown(sha256)} is no hash")
    try:
        text = data["robot"].encode()
    except UnicodeError:
        refuse("robot: half a character is no text")
    if hashlib.sha256(text).hexdigest() != sha256:
        refuse("the hash is not of this robot")
    return sha256


# --- JSON -----------------------------------------------------------------------------------------


def _json(text: str | bytes) -> Any:
    """Read JSON in which every key stands once and every number is an index."""
    try:
        whole = text.encode() if isinstance(text, str) else text
        plain = whole.decode()
    except UnicodeError:
        refuse("it is not UTF-8")
    if len(whole) > MOST_BYTES:
        refuse(f"it has more than {MOST_BYTES} bytes")
    try:
        data = json.loads(
            plain,
            object_pairs_hook=_unique,
            parse_int=_index,
            parse_float=_no_number,
            parse_constant=_no_number,
        )
    except json.JSONDecodeError as error:
        refuse(f"it is no JSON: {error}")
    except RecursionError:
        refuse("it is nested too deeply")
    return data


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        refuse("a key stands twice")
    return found


def _index(text: str) -> int:
    if not INDEX.fullmatch(text):
        refuse(f"{shown(text)} is no index")
    return int(text)


def _no_number(text: str) -> NoReturn:
    refuse(f"{shown(text)}: numbers are written as decimals in quotes")


# --- numbers --------------------------------------------------------------------------------------


def decimal(value: Any, where: str) -> Fraction:
    """Return a decimal, a JSON string, as a rational."""
    found = DECIMAL.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        refuse(f"{where}: {shown(value)} is no decimal")
    number = Fraction(found.group())
    if abs(number) > LARGEST_NUMBER:
        refuse(f"{where}: {shown(value)} is too large")
    return number


def _point(value: Any, robot: Robot, where: str) -> Point:
    """Return a configuration, its angles no larger than allowed."""
    texts = items(value, where, len(robot.joints), len(robot.joints))
    point = tuple(decimal(text, where) for text in texts)
    for joint, x in zip(robot.joints, point, strict=True):
        if joint.turns and abs(x) > LARGEST_ANGLE[robot.degrees]:
            refuse(f"{where}: an angle of {shown(str(x))} is too large")
    return point


def index(value: Any, where: str, size: int) -> int:
    """Return an index of one of `size` things."""
    if type(value) is not int or value >= size:
        refuse(f"{where}: {shown(value)} is no index of one of {size}")
    return value


# --- statement, proof, witness --------------------------------------------------------------------


def read_statement(data: Any, robot: Robot, grammar: int = GRAMMAR) -> Statement:
    """Read a set of joint values of a robot, and a margin."""
    kind = data.get("set") if isinstance(data, dict) else None
    if kind not in ("box", "path", "polygon", NO_PATH):
        refuse(f"set: {shown(kind)} is no box, path or polygon, nor {NO_PATH}")
    triangles = ("triangles",) if kind == "polygon" else ()
    moving = ("free",) if grammar == GRAMMAR_OF_DISCONNECTED else ()
    keys(data, "statement", ("set", "margin", "points", *triangles, *moving))
    margin = decimal(data["margin"], "margin")
    if margin < 0:
        refuse("the margin is negative")
    lists = _lists(data["points"], kind, robot)
    count = sum(map(len, lists))
    if kind == "box" and any(low > high for low, high in zip(*lists[0], strict=True)):
        refuse("points: the low corner of the box is not below the high one")
    free = _free(data["free"], lists[0]) if moving else ()
    return Statement(kind, margin, lists, _triangles(data, count) if triangles else (), free)


def _free(value: Any, ends: Sequence[Point]) -> tuple[int, ...]:
    """Read which joints move; between the two ends no other one differs."""
    start, goal = ends
    rows = items(value, "free", 1, MOST_FREE)
    free = tuple(index(row, "free", len(start)) for row in rows)
    if list(free) != sorted(set(free)):
        refuse("free: the numbers of joints do not ascend")
    for j, pair in enumerate(zip(start, goal, strict=True)):
        if j not in free and pair[0] != pair[1]:
            refuse("free: a joint that is held has two values")
    return free


def _lists(data: Any, kind: str, robot: Robot) -> tuple[tuple[Point, ...], ...]:
    two, many = (2, 2), (2, MOST_POINTS)
    counts = {"box": two, NO_PATH: two, "path": many, "polygon": (3, MOST_POINTS)}
    fewest, most = counts[kind]
    rows = items(data, "points", 1, 1 if counts[kind] == two else MOST_POINTS)
    rows = [items(row, "points", fewest, most) for row in rows]
    if sum(map(len, rows)) > MOST_POINTS:
        refuse(f"points: more than {MOST_POINTS}")
    return tuple(tuple(_point(point, robot, "points") for point in row) for row in rows)


def _triangles(data: dict[str, Any], count: int) -> tuple[tuple[int, int, int], ...]:
    found = []
    for row in items(data["triangles"], "triangles", 1, MOST_TRIANGLES):
        a, b, c = (index(k, "triangles", count) for k in items(row, "triangles", 3, 3))
        found.append((a, b, c))
    return tuple(found)


def _proof(data: Any) -> dict[str, tuple[str, ...]]:
    if not isinstance(data, dict):
        refuse(f"proof: {shown(data)} is no object")
    return {name: _trees(name, rows) for name, rows in data.items()}


def _trees(name: str, rows: Any) -> tuple[str, ...]:
    where = f"proof of {shown(name)}"
    trees = items(rows, where, 1, MOST_BYTES)
    if not all(isinstance(tree, str) and TREE.fullmatch(tree) for tree in trees):
        refuse(f"{where}: a tree is written with the letters a to z, points and numbers")
    return tuple(trees)


def _barrier(data: Any, robot: Robot) -> Barrier:
    """Read the ranges of a joint that are said to be blocked."""
    keys(data, "proof", ("joint", "blocked"))
    names = [joint.name for joint in robot.joints]
    name = text_of(data["joint"], "joint")
    if name not in names:
        refuse(f"joint: {shown(name)} is no joint of the robot")
    j = names.index(name)
    count = 2 if robot.joints[j].limits is None else 1
    rows = items(data["blocked"], "blocked", count, count)
    return Barrier(j, tuple(_blocked(row, robot, j) for row in rows))


def _disconnected(data: Any, robot: Robot) -> Disconnected:
    """Read a tree whose leaves may name boundaries."""
    keys(data, "proof", ("boundaries", "tree"))
    names = items(data["boundaries"], "boundaries", 1, MOST_ROWS)
    (tree,) = _trees("boundaries", [data["tree"]])
    return Disconnected(tuple(_of_points(name, robot) for name in names), tree)


def _of_points(value: Any, robot: Robot) -> Boundary:
    """Return a boundary in use that is about points."""
    name = text_of(value, "boundary")
    used = {b.name: b for b in robot.boundaries if b.used and not b.bodies}
    if name not in used:
        refuse(f"boundary: {shown(name)} is no boundary of points in use")
    return used[name]


def _blocked(row: Any, robot: Robot, j: int) -> Blocked:
    keys(row, "blocked", ("boundary", "from", "to", "tree"))
    boundary = _of_points(row["boundary"], robot)
    low, high = decimal(row["from"], "from"), decimal(row["to"], "to")
    if not low < high:
        refuse("from is not less than to")
    if robot.joints[j].turns and max(-low, high) > LARGEST_ANGLE[robot.degrees]:
        refuse("blocked: an angle is too large")
    (tree,) = _trees(boundary.name, [row["tree"]])
    return Blocked(boundary, low, high, tree)


def _witness(data: dict[str, Any], robot: Robot) -> Witness:
    name = text_of(data["boundary"], "boundary")
    boundary = next((b for b in robot.boundaries if b.name == name and b.used), None)
    if (boundary is not None and boundary.apart) != ("places" in data):
        refuse("places: a pair of bodies has them, and nothing else")
    places = _named_places(data["places"]) if "places" in data else ()
    if "at" in data:
        return Witness(name, _point(data["at"], robot, "at"), places=places)
    cell = index(data["cell"], "cell", 10**9)
    return Witness(name, None, cell, _weights(data["weights"], "weights"), places)


def _weights(value: Any, where: str) -> tuple[Fraction, ...]:
    return tuple(decimal(w, where) for w in items(value, where, 1, MOST_CORNERS))


def _named_places(value: Any) -> tuple[tuple[int, tuple[Fraction, ...]], ...]:
    rows = items(value, "places", 2, 2)
    for row in rows:
        keys(row, "places", ("part", "weights"))
    return tuple(
        (index(row["part"], "part of places", MOST_CORNERS), _weights(row["weights"], "places"))
        for row in rows
    )


def _parts(value: Any, robot: Robot) -> dict[str, tuple[tuple[int, ...], ...]]:
    """Read the parts of each outline that a boundary in use keeps from another body."""
    bodies = [body for b in robot.boundaries if b.used and b.apart for body in b.bodies]
    outlines = {body.name: len(body.places) for body in bodies if len(body.places) > 2}
    keys(value, "parts", list(outlines))
    return {name: _part_list(value[name], count) for name, count in outlines.items()}


def _part_list(value: Any, count: int) -> tuple[tuple[int, ...], ...]:
    rows = [items(row, "parts", 3, count) for row in items(value, "parts", 1, count)]
    return tuple(tuple(index(k, "parts", count) for k in row) for row in rows)
