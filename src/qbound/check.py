"""Check a certificate of qbound with nothing but Python's own integers.

    python -I check.py CERTIFICATE [ROBOT_FILE | --sha256 HASH]

A certificate says of a robot that every configuration of a set keeps every boundary (proved), or
that one of them does not (refuted); or that no path leads from one configuration to another. This
file is for a stranger who wants to trust that answer: it imports nothing but the standard library,
uses no floating point, and can be copied and run alone.
The grammar of certificates is a page of the book, "The certificate"; what it does not list is
refused here. Read from top to bottom:

    reading       the file, the robot's text, the set: every key, type, count and size is known
    cells         the set is cut into simplices or is one box; trees cut them further
    balls         complex numbers with their error, made of whole numbers
    waves         each boundary as a sum of waves, from the robot's joints and points
    bodies        outlines in the plane of motion, and what separates two of them
    the bound     on each leaf of a tree, why the boundary is positive there
    no path       values of one joint that nothing passes, whatever the other joints
    disconnected  boxes of up to three joints, the others held, that lie in every path
    the answer    a statement that is written from what was verified, and an exit status

Exit status: 0 proved, 3 refuted by a witness that was verified, 2 anything else, 130 interrupted.
1 is no answer, because Python itself ends with 1 where a program cannot run.
The second argument pins the robot: its file, or the SHA-256 of that file's text.
Python's option -I keeps the folders of other people's modules away.
"""

import sys  # part of Python itself: no file stands for it, as one could for `__future__`

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
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

MAX_FILE = 2_000_000
"""Bytes of a certificate, and of a robot file that pins it."""

MAX_ROBOT = 500_000
"""Characters of the robot's text."""

MAX_JOINTS, MAX_ROWS, MAX_CORNERS = 6, 2_000, 1_000
"""Joints; points, boundaries or bodies; corners of the outline of a body."""

MAX_FREE = 3
"""Joints that move where the others are held."""

MAX_CONFIGURATIONS, MAX_TRIANGLES = 20_000, 20_000

MAX_DEPTH = 120
"""Cuts on top of each other in a tree."""

MAX_WORK = 4_000_000
"""Multiplications of balls; each cell that a tree visits counts as `CELL_WORK` of them."""

CELL_WORK = 50

LARGEST, LARGEST_DIRECTION = Fraction(10**100), Fraction(10**308)
"""Sizes of numbers."""

LARGEST_ANGLE = {"deg": Fraction(1800), "rad": Fraction(30)}
"""Sizes of angles whose cosine is needed."""

Table = dict[str, Any]
Point = tuple[Fraction, ...]
"""One exact value for each joint, or three coordinates."""


class Refused(ValueError):
    """Why a file proves nothing, in a sentence that names what and where."""


def demand(condition: object, text: str) -> None:
    """Refuse the file unless a condition holds."""
    if not condition:
        raise Refused(text)


# --- reading: JSON --------------------------------------------------------------------------------


def read_json(data: bytes) -> Any:
    """Read JSON of which no key stands twice, and whose only numbers are indices."""
    demand(len(data) <= MAX_FILE, f"the file has more than {MAX_FILE} bytes")
    try:
        return json.loads(
            data.decode("utf-8"),
            object_pairs_hook=_unique,
            parse_int=_index,
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


def _index(text: str) -> int:
    known = re.fullmatch("0|[1-9][0-9]{0,8}", text)
    demand(known, f"the file has the number {shown(text)}: bare numbers are indices of 0 or more")
    return int(text)


def _no_number(text: str) -> Any:
    raise Refused(f"the file has the number {shown(text)}: decimals are written as strings")


# --- reading: types -------------------------------------------------------------------------------
# Each of these returns a value of its type, or refuses the file and names the place. `True` is an
# integer to `isinstance`, so types are compared by `type(...) is`.


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


def number(value: Any, where: str = "number") -> Fraction:
    """Return the exact value of a decimal of a certificate: a string such as "-12.5"."""
    form = "-?[0-9]{1,40}([.][0-9]{1,40})?([eE][+-]?[0-9]{1,2})?"
    known = type(value) is str and re.fullmatch(form, value)
    demand(known, f'{where}: {shown(value)} is no decimal number in quotes, such as "-12.5"')
    return _bounded(Fraction(value), where, LARGEST)


def _bounded(value: Fraction, where: str, largest: Fraction) -> Fraction:
    demand(abs(value) <= largest, f"{where}: the number is too large")
    return value


def shown(value: Any) -> str:
    """Write a value for a message: short, in ASCII, on one line."""
    if type(value) is str:
        return ascii(value if len(value) <= 60 else f"{value[:57]}...")
    names = {dict: "a table", list: "a list", int: "a number", bool: "a truth value"}
    return names.get(type(value), "a value of another type")


# --- reading: the robot's text as TOML ------------------------------------------------------------


@dataclass(frozen=True, slots=True)
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


def scan(text: str) -> None:
    """Refuse a text on which the reader of TOML would work for long, before it sees it.

    Dotted keys cost it the square of their number of parts, tables in tables more than that. No
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
            demand(found != "=" or not any(map(_is_dotted, between)), f"{where}: a key with a dot")
            depth += (found in "[{") - (found in "]}")
            demand(depth <= MAX_NESTED, f"{where}: more than {MAX_NESTED} brackets in each other")
            line += found == "\n"
            between.clear()


def _is_dotted(key: str) -> bool:
    return "." in key and key[0] not in "\"'"


def read_toml(text: str) -> Any:
    """Read TOML after a `scan`."""
    scan(text)
    try:
        return tomllib.loads(text, parse_float=TomlFloat)
    except ValueError as error:  # also an integer of thousands of digits
        raise Refused(f"robot: no TOML: {error}") from None


def toml_number(value: Any, where: str, largest: Fraction = LARGEST) -> Fraction:
    """Return the exact value of an integer or a float."""
    if type(value) is int:
        return _bounded(Fraction(value), where, largest)
    text = value.text.replace("_", "") if isinstance(value, TomlFloat) else ""
    form = "[+-]?[0-9]{1,100}([.][0-9]{1,100})?([eE][+-]?[0-9]{1,3})?"
    demand(re.fullmatch(form, text), f"{where}: a finite number is wanted")
    return _bounded(Fraction(text), where, largest)


def vector_of(value: Any, where: str, largest: Fraction = LARGEST) -> Point:
    """Return three numbers."""
    return tuple(toml_number(x, where, largest) for x in list_of(value, where, 3, 3))


def direction_of(value: Any, where: str) -> Point:
    """Return three numbers that are not all 0."""
    vector = vector_of(value, where, LARGEST_DIRECTION)
    demand(any(vector), f"{where}: a direction must not be 0")
    return vector


def size_of(value: Any, where: str) -> Fraction:
    """Return a number of 0 or more."""
    size = toml_number(value, where)
    demand(size >= 0, f"{where}: a number of 0 or more is wanted")
    return size


# --- reading: the robot ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Joint:
    """A joint; all numbers as the robot file writes them, in its units."""

    name: str
    turns: bool
    origin: Point
    rpy: Point
    axis: Point
    limits: tuple[Fraction, Fraction] | None


@dataclass(frozen=True)
class Place:
    """A point with a radius, in the frame of this number: frame j + 1 is moved by joint j."""

    frame: int
    at: Point
    radius: Fraction


@dataclass(frozen=True)
class Body:
    """All places no farther than the radius from a core: a corner, a segment, or an outline.

    An outline is three corners or more, in order round it. A corner is written as three numbers, or
    as the two across the common axis of the joints.
    """

    name: str
    frame: int
    corners: tuple[Point, ...]
    radius: Fraction

    @property
    def is_outline(self) -> bool:
        """Tell whether the core has an inside."""
        return len(self.corners) > 2


@dataclass(frozen=True)
class Boundary:
    """Two places or bodies keep `distance` plus both radii apart; with a normal, one keeps a side.

    A side of a plane: normal . place is at least `distance` plus the radius.
    """

    name: str
    ends: tuple[Place, ...] | tuple[Body, ...]
    normal: Point | None
    distance: Fraction

    @property
    def bodies(self) -> tuple[Body, ...]:
        """Return the two bodies that it keeps apart, or none."""
        found = tuple(end for end in self.ends if isinstance(end, Body))
        return found if self.normal is None else ()

    def gap(self, margin: Fraction) -> Fraction:
        """Return the distance that is asked for: with radii and margin."""
        return self.distance + sum(end.radius for end in self.ends) + margin

    def needs_proof(self, margin: Fraction) -> bool:
        """Tell whether anything can violate it: what has no inside is always at least 0 apart.

        (But for two segments, which can cross.)
        """
        corners = sum(len(body.corners) for body in self.bodies)
        return self.normal is not None or corners > 3 or self.gap(margin) != 0


@dataclass(frozen=True)
class Robot:
    """What a robot's text says, as far as it bears on statements."""

    name: str
    length_unit: str
    angle_unit: str
    joints: tuple[Joint, ...]
    boundaries: tuple[Boundary, ...]

    @property
    def outlines(self) -> dict[str, Body]:
        """Return the bodies with an inside that a boundary keeps from others, by name."""
        bodies = [body for boundary in self.boundaries for body in boundary.bodies]
        return {body.name: body for body in bodies if body.is_outline}

    def unit(self, j: int) -> str:
        """Return the unit of a joint's values."""
        return self.angle_unit if self.joints[j].turns else self.length_unit

    def beyond(self, q: Point) -> list[str]:
        """Return the names of the limits that a configuration is beyond."""
        found = []
        for joint, value in zip(self.joints, q, strict=True):
            low, high = joint.limits or (value, value)
            found += [f"{joint.name}.lower"] * (value < low) + [f"{joint.name}.upper"] * (
                value > high
            )
        return found


def read_robot(text: str) -> Robot:
    """Read the robot's text: every table, key, type and bound is known."""
    required = ("schema", "name", "length_unit", "angle_unit", "home", "tool", "joint", "point")
    optional = ("boundary", "body", "obstacle", "collisions", "clearance", "allowed")
    file = table_of(read_toml(text), "robot", required, optional)
    demand(type(file["schema"]) is int and file["schema"] == 1, "robot: schema: 1 is wanted")
    angle_unit = one_of(file["angle_unit"], "robot: angle_unit", ("deg", "rad"))
    rows = list_of(file["joint"], "robot: joint", 1, MAX_JOINTS)
    joints = tuple(_joint(row, f"robot: joint[{j}]", angle_unit) for j, row in enumerate(rows))
    frames = _chain(rows)
    places = _places(file["point"], frames)
    _read_home(file["home"], joints)
    _known(file["tool"], "robot: tool", places)
    bodies = _bodies(file.get("body", []), file.get("obstacle", []), frames)
    _different("joint", [joint.name for joint in joints])
    return Robot(
        name=_label(file["name"], "robot: name"),
        length_unit=one_of(file["length_unit"], "robot: length_unit", ("m", "cm", "mm")),
        angle_unit=angle_unit,
        joints=joints,
        boundaries=_boundaries(file, places, bodies, joints),
    )


def _label(value: Any, where: str) -> str:
    return text_of(value, where, 200)


def _known(value: Any, where: str, names: Iterable[str]) -> str:
    """Return a label that is one of some names."""
    name = _label(value, where)
    demand(name in names, f"{where}: nothing is called {shown(name)}")
    return name


def _different(what: str, names: Sequence[str]) -> None:
    demand(len({*names}) == len(names), f"robot: {what}: a name is used twice")


def _joint(value: Any, where: str, angle_unit: str) -> Joint:
    required = ("name", "type", "parent", "frame", "origin", "axis")
    row = table_of(value, where, required, ("rpy", "limits", "velocity"))
    turns = one_of(row["type"], f"{where}.type", ("revolute", "prismatic")) == "revolute"
    demand(turns or "limits" in row, f"{where}: a prismatic joint needs limits")
    rpy = vector_of(row.get("rpy", [0, 0, 0]), f"{where}.rpy")
    within = all(abs(angle) <= LARGEST_ANGLE[angle_unit] for angle in rpy)
    demand(within, f"{where}.rpy: an angle of more than five turns")
    speed = toml_number(row.get("velocity", 1), f"{where}.velocity")
    demand(speed > 0, f"{where}.velocity: a number of more than 0 is wanted")
    return Joint(
        name=_label(row["name"], f"{where}.name"),
        turns=turns,
        origin=vector_of(row["origin"], f"{where}.origin"),
        rpy=rpy,
        axis=direction_of(row["axis"], f"{where}.axis"),
        limits=_limits(row["limits"], f"{where}.limits", turns, angle_unit)
        if "limits" in row
        else None,
    )


def _limits(value: Any, where: str, turns: bool, angle_unit: str) -> tuple[Fraction, Fraction]:
    low, high = (toml_number(x, where) for x in list_of(value, where, 2, 2))
    demand(low < high, f"{where}: the first one must be less")
    widest = 100 * (Fraction(360) if angle_unit == "deg" else 2 * PI)
    demand(not turns or high - low <= widest, f"{where}: more than 100 turns apart")
    return low, high


def _chain(rows: Sequence[Table]) -> list[str]:
    """Return the frames of the joints, the base first, which hang on each other one by one."""
    parents = [_label(row["parent"], "robot: joint: parent") for row in rows]
    frames = parents[:1] + [_label(row["frame"], "robot: joint: frame") for row in rows]
    demand(parents == frames[:-1], "robot: joint: each parent is the frame of the joint before")
    _different("frames", frames)
    return frames


def _places(value: Any, frames: Sequence[str]) -> dict[str, Place]:
    places, rows = dict[str, Place](), list_of(value, "robot: point", 1, MAX_ROWS)
    for i, item in enumerate(rows):
        where = f"robot: point[{i}]"
        row = table_of(item, where, ("name", "frame", "at"), ("radius",))
        name = _label(row["name"], f"{where}.name")
        demand(name not in places, f"{where}: the name {shown(name)} is used twice")
        demand(name not in frames, f"{where}: {shown(name)} is the name of a frame")
        places[name] = Place(
            frame=frames.index(_known(row["frame"], f"{where}.frame", frames)),
            at=vector_of(row["at"], f"{where}.at"),
            radius=size_of(row.get("radius", 0), f"{where}.radius"),
        )
    return places


def _boundaries(
    file: Table, places: dict[str, Place], bodies: dict[str, Body], joints: Sequence[Joint]
) -> tuple[Boundary, ...]:
    """Read all boundaries, add the pairs that `collisions` makes, and return those in use."""
    rows = [
        _boundary(row, f"robot: boundary[{i}]", places, bodies)
        for i, row in enumerate(list_of(file.get("boundary", []), "robot: boundary", 0, MAX_ROWS))
    ]
    named = [frozenset(body.name for body in boundary.bodies) for boundary, _ in rows]
    rows += [(pair, True) for pair in _collisions(file, bodies, {*named})]
    limits = [f"{joint.name}.{side}" for joint in joints for side in ("lower", "upper")]
    names = [boundary.name for boundary, _ in rows]
    _different("boundary", names)
    demand(not {*names} & {*limits}, "robot: boundary: the name of a joint limit")
    return tuple(boundary for boundary, used in rows if used)


def _collisions(
    file: Table, bodies: dict[str, Body], named: set[frozenset[str]]
) -> Iterable[Boundary]:
    """Return the pairs that `collisions` makes: of two frames, neither allowed nor named already.

    `bodies` are in their order along the chain, obstacles last.
    """
    clearance = size_of(file.get("clearance", 0), "robot: clearance")
    rows = list_of(file.get("allowed", []), "robot: allowed", 0, MAX_ROWS)
    apart = named | {_two_names(row, "robot: allowed", bodies) for row in rows}
    if "collisions" not in file:
        return
    one_of(file["collisions"], "robot: collisions", ("all",))
    pairs = itertools.combinations(bodies.values(), 2)
    for count, (one, other) in enumerate(p for p in pairs if p[0].frame != p[1].frame):
        demand(count < MAX_ROWS, f"robot: collisions: more than {MAX_ROWS} pairs of bodies")
        if frozenset((one.name, other.name)) not in apart:
            yield Boundary(f"{one.name}, {other.name}", (one, other), None, clearance)


def _two_names(value: Any, where: str, known: Iterable[str]) -> frozenset[str]:
    names = frozenset(_known(name, where, known) for name in list_of(value, where, 2, 2))
    demand(len(names) == 2, f"{where}: two different names are wanted")
    return names


KEYS_OF = {
    "pair": (("points",), ("clearance",)),
    "bodies": (("bodies",), ("clearance",)),
    "half-space": (("normal", "offset"), ("point", "body")),
}
"""Of each type of boundary: the keys that it needs, and those that it may have."""


def _boundary(
    value: Any, where: str, places: dict[str, Place], bodies: dict[str, Body]
) -> tuple[Boundary, bool]:
    """Return a boundary, and whether it is in use."""
    sort = value.get("type") if type(value) is dict else None
    sort = one_of(sort, f"{where}: type", [*KEYS_OF])
    required, optional = KEYS_OF[sort]
    row = table_of(value, where, ("name", "type", *required), ("used", *optional))
    used = row.get("used", True)
    demand(type(used) is bool, f"{where}.used: true or false is wanted")
    ends: tuple[Place, ...] | tuple[Body, ...]
    if sort == "half-space":
        demand(("point" in row) != ("body" in row), f"{where}: a point or a body is wanted")
        key = "point" if "point" in row else "body"
        names = [_known(row[key], f"{where}.{key}", places if key == "point" else bodies)]
    else:
        key = "points" if sort == "pair" else "bodies"
        known = places if sort == "pair" else bodies
        names = list_of(row[key], f"{where}.{key}", 2, 2)
        _two_names(names, f"{where}.{key}", known)
    if key in ("point", "points"):
        ends = tuple(places[name] for name in names)
    else:
        ends = tuple(bodies[name] for name in names)
    boundary = Boundary(
        name=_label(row["name"], f"{where}.name"),
        ends=ends,
        normal=direction_of(row["normal"], f"{where}.normal") if "normal" in row else None,
        distance=toml_number(row["offset"], f"{where}.offset")
        if "offset" in row
        else size_of(row.get("clearance", 0), f"{where}.clearance"),
    )
    frames = {end.frame for end in ends}
    demand(sort != "bodies" or len(frames) == 2, f"{where}.bodies: both are of one frame")
    return boundary, used


def _read_home(value: Any, joints: Sequence[Joint]) -> None:
    """Verify the home pose, which bears on no statement."""
    for name, angle in table_of(value, "robot: home", [joint.name for joint in joints]).items():
        toml_number(angle, f"robot: home: {shown(name)}")


def _bodies(links: Any, obstacles: Any, frames: Sequence[str]) -> dict[str, Body]:
    """Return all bodies by name, in their order along the chain, obstacles last."""
    rows = [
        (item, f"robot: {kind}[{i}]")
        for kind, items in (("body", links), ("obstacle", obstacles))
        for i, item in enumerate(list_of(items, f"robot: {kind}", 0, MAX_ROWS))
    ]
    count, bodies = len(links), list[Body]()
    for item, where in rows[:count]:
        bodies.append(_body(item, where, frames, bodies))
    bodies.sort(key=lambda body: body.frame)
    for item, where in rows[count:]:
        table_of(item, where, (), ("name", *SHAPES))
        bodies.append(_body({**item, "frame": frames[0]}, where, frames, bodies))
    _different("body", [body.name for body in bodies])
    return {body.name: body for body in bodies}


SHAPES = ("polygon", "capsule", "disc")


def _body(item: Any, where: str, frames: Sequence[str], before: Sequence[Body]) -> Body:
    """Return a body; one without a name is called by its frame: 1, 1/2, 1/3, ..."""
    row = table_of(item, where, ("frame",), ("name", *SHAPES))
    frame = frames.index(_known(row["frame"], f"{where}.frame", frames))
    number = 1 + sum(body.frame == frame for body in before)
    usual = frames[frame] if number == 1 else f"{frames[frame]}/{number}"
    shapes = [shape for shape in SHAPES if shape in row]
    demand(len(shapes) == 1, f"{where}: {' or '.join(SHAPES)} is wanted, one of them")
    where, value, radius = f"{where}.{shapes[0]}", row[shapes[0]], Fraction(0)
    if shapes == ["polygon"]:
        corners = list_of(value, where, 3, MAX_CORNERS)
    else:
        ends = ("from", "to") if shapes == ["capsule"] else ("at",)
        table = table_of(value, where, (*ends, "radius"))
        corners, radius = [table[end] for end in ends], size_of(table["radius"], where)
    return Body(
        name=_label(row["name"], f"{where}.name") if "name" in row else usual,
        frame=frame,
        corners=tuple(_corner(corner, where) for corner in corners),
        radius=radius,
    )


def _corner(value: Any, where: str) -> Point:
    """Return two or three numbers."""
    return tuple(toml_number(x, where) for x in list_of(value, where, 2, 3))


# --- cells ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Simplex:
    """A point, segment, triangle, ... with its corners."""

    corners: tuple[Point, ...]

    @cached_property
    def centre(self) -> Point:
        """Return the mean of its corners."""
        return tuple(sum(column) / len(self.corners) for column in zip(*self.corners, strict=True))

    @cached_property
    def steps(self) -> list[Point]:
        """Return the steps from its centre to its corners."""
        return [tuple(x - m for x, m in zip(q, self.centre, strict=True)) for q in self.corners]

    @cached_property
    def signs(self) -> list[tuple[int, ...]]:
        """Return the signs by which each step leads to corners: as it is."""
        return [(1,) * len(self.centre)]

    def largest(self, w: Sequence[int]) -> Fraction:
        """Return the largest abs(w . d) over the steps d to its corners."""
        return max(abs(_dot(w, step)) for step in self.steps)

    def halves(self, letter: str) -> "tuple[Simplex, Simplex]":
        """Cut it across an edge: the half with the first end, and the half with the second."""
        edges = [*itertools.combinations(range(len(self.corners)), 2)]
        number = ord(letter) - ord("a")
        demand(
            0 <= number < len(edges), f"proof: the letter {shown(letter)} names no edge of a cell"
        )
        i, j = edges[number]
        ends = zip(self.corners[i], self.corners[j], strict=True)
        middle = tuple((x + y) / 2 for x, y in ends)
        return self._with(j, middle), self._with(i, middle)

    def _with(self, i: int, corner: Point) -> "Simplex":
        return Simplex((*self.corners[:i], corner, *self.corners[i + 1 :]))


@dataclass(frozen=True)
class Box:
    """All configurations between a low and a high corner; where they agree a joint is held."""

    low: Point
    high: Point

    @property
    def corners(self) -> tuple[Point, Point]:
        """Return the two corners: every coordinate of every corner is in one of them."""
        return self.low, self.high

    @cached_property
    def centre(self) -> Point:
        """Return its middle."""
        return tuple((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))

    @cached_property
    def steps(self) -> list[Point]:
        """Return the step to its high corner; `signs` turns it to the others."""
        return [tuple(b - m for m, b in zip(self.centre, self.high, strict=True))]

    @cached_property
    def signs(self) -> list[tuple[int, ...]]:
        """Return the signs of the steps to all corners; those of held joints do not matter."""
        ends = [(1, -1) if a != b else (1,) for a, b in zip(self.low, self.high, strict=True)]
        return [*itertools.product(*ends)]

    def largest(self, w: Sequence[int]) -> Fraction:
        """Return the largest abs(w . d) over the steps d to its corners: all terms of one sign."""
        return _dot([abs(x) for x in w], self.steps[0])

    def halves(self, letter: str) -> "tuple[Box, Box]":
        """Cut it at the middle of a joint: the lower half and the upper one."""
        j = ord(letter) - ord("a")
        wide = 0 <= j < len(self.low) and self.low[j] != self.high[j]
        demand(wide, f"proof: the letter {shown(letter)} names no joint that a box may be cut in")
        below = (*self.high[:j], self.centre[j], *self.high[j + 1 :])
        above = (*self.low[:j], self.centre[j], *self.low[j + 1 :])
        return Box(self.low, below), Box(above, self.high)


Cell = Simplex | Box


def _dot(u: Iterable[int | Fraction], v: Iterable[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(u, v, strict=True)), Fraction(0))


# --- reading: the set -----------------------------------------------------------------------------


NO_PATH = "no path"
"""In the place of a set: of all paths between two configurations none keeps every boundary."""


@dataclass(frozen=True)
class Statement:
    """A set, as the decimals that were read, and the cells that make it up; of no path none."""

    kind: str
    margin: Fraction
    loops: tuple[tuple[Point, ...], ...]
    cells: tuple[Cell, ...]
    free: tuple[int, ...] = ()
    """Of no path in grammar 5: the joints that move, by their numbers; all others are held."""

    @property
    def held(self) -> "Held":
        """Return the values of the joints that a path of grammar 5 leaves where they are."""
        return {j: x for j, x in enumerate(self.loops[0][0]) if self.free and j not in self.free}


def read_statement(value: Any, grammar: int, joints: int) -> Statement:
    """Read a statement about a robot of so many joints."""
    sort = value.get("set") if type(value) is dict else None
    sets = ("box", "path", "polygon") if grammar < 4 else (NO_PATH,)
    kind = one_of(sort, "statement: set", sets)
    more = ("triangles",) if kind == "polygon" else ("free",) if grammar == 5 else ()
    table = table_of(value, "statement", ("set", "margin", "points", *more))
    margin = number(table["margin"], "statement: margin")
    demand(margin >= 0, "statement: margin: a length of 0 or more is wanted")
    most = 1 if kind in ("box", NO_PATH) else MAX_CONFIGURATIONS
    loops = _read_loops(table["points"], most, joints)
    cells: tuple[Cell, ...] = ()
    free: tuple[int, ...] = ()
    if kind == NO_PATH:
        demand(len(loops[0]) == 2, "statement: points[0]: two configurations are wanted")
        free = _read_free(table["free"], *loops[0]) if grammar == 5 else ()
    elif kind == "box":
        cells = _box_cells(loops[0], grammar)
    elif kind == "path":
        cells = _segments(loops)
    else:
        cells = _triangles(loops, table["triangles"])
    return Statement(kind, margin, loops, cells, free)


def _read_free(value: Any, start: Point, goal: Point) -> tuple[int, ...]:
    """Read the joints that move: in all others start and goal agree."""
    where, n = "statement: free", len(start)
    free = [index_of(j, where, n) for j in list_of(value, where, 1, MAX_FREE)]
    rises = all(a < b for a, b in itertools.pairwise(free))
    demand(rises, f"{where}: joints are named by their numbers, each once, in order")
    agree = all(start[j] == goal[j] for j in range(n) if j not in free)
    demand(agree, f"{where}: start and goal differ in a joint that is held")
    return tuple(free)


def _read_loops(value: Any, most: int, joints: int) -> tuple[tuple[Point, ...], ...]:
    loops, left = list[tuple[Point, ...]](), MAX_CONFIGURATIONS
    for i, item in enumerate(list_of(value, "statement: points", 1, most)):
        where = f"statement: points[{i}]"
        loop = list_of(item, where, 2, MAX_CONFIGURATIONS)
        left -= len(loop)
        demand(left >= 0, f"{where}: more than {MAX_CONFIGURATIONS} configurations in all")
        loops.append(tuple(configuration(q, f"{where}[{k}]", joints) for k, q in enumerate(loop)))
    return tuple(loops)


def configuration(value: Any, where: str, joints: int) -> Point:
    """Return one value for each joint."""
    return tuple(number(x, where) for x in list_of(value, where, joints, joints))


def _box_cells(corners: Sequence[Point], grammar: int) -> tuple[Cell, ...]:
    demand(
        len(corners) == 2, "statement: points[0]: a box has two corners, the low and the high one"
    )
    low, high = corners
    rises = all(a <= b for a, b in zip(low, high, strict=True))
    demand(rises, "statement: points[0]: the first corner of a box is the low one in every joint")
    return (Box(low, high),) if grammar > 1 else tuple(_orders(low, high))


def _orders(low: Point, high: Point) -> Iterable[Simplex]:
    """Cut a box of grammar 1: a simplex for each order in which its joints may rise."""
    wide = [j for j, (a, b) in enumerate(zip(low, high, strict=True)) if a != b]
    for order in itertools.permutations(wide):
        corners = [low]
        for j in order:
            corners.append((*corners[-1][:j], high[j], *corners[-1][j + 1 :]))
        yield Simplex(tuple(corners))


def _segments(paths: Iterable[Sequence[Point]]) -> tuple[Cell, ...]:
    return tuple(Simplex(ends) for path in paths for ends in itertools.pairwise(path))


def _triangles(loops: Sequence[Sequence[Point]], value: Any) -> tuple[Cell, ...]:
    """Verify that triangles fill loops: anticlockwise, inner edges in pairs, all others the loops.

    Then the edges of all triangles add up to the loops. So around any place the loops wind as often
    as triangles hold it, and a place that they wind around lies in a triangle.
    """
    demand(min(map(len, loops)) > 2, "statement: points: a loop has three configurations or more")
    points = [q for loop in loops for q in loop]
    plane = [j for j, column in enumerate(zip(*points, strict=True)) if len({*column}) > 1]
    demand(len(plane) == 2, f"statement: points: {len(plane)} joints of a polygon vary, not two")
    numbers = {q: k for k, q in enumerate(points)}  # equal points have one number
    cells, inner = list[Cell](), set[tuple[int, int]]()
    for i, item in enumerate(list_of(value, "statement: triangles", 1, MAX_TRIANGLES)):
        where = f"statement: triangles[{i}]"
        corners = [points[index_of(k, where, len(points))] for k in list_of(item, where, 3, 3)]
        demand(_anticlockwise(corners, plane), f"{where}: not anticlockwise")
        for edge in _edges([numbers[q] for q in corners]):
            demand(edge not in inner, f"{where}: another triangle lies on this side of an edge")
            inner.add(edge)
        cells.append(Simplex(tuple(corners)))
    for i, loop in enumerate(loops):
        for k, (a, b) in enumerate(_edges([numbers[q] for q in loop])):
            where = f"statement: points[{i}][{k}]: the edge that begins here"
            demand((a, b) in inner, f"{where} is of no triangle, or occurs twice")
            demand((b, a) not in inner, f"{where} has a triangle on either side")
            inner.remove((a, b))
    for a, b in inner:
        demand((b, a) in inner, "statement: triangles: an edge of one triangle is in no loop")
    return tuple(cells)


def _edges(loop: Sequence[int]) -> Iterable[tuple[int, int]]:
    """Return the pairs of neighbours around a loop."""
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def _anticlockwise(corners: Sequence[Point], plane: Sequence[int]) -> bool:
    a, b, c = corners
    (x, y), (u, v) = ([q[j] - a[j] for j in plane] for q in (b, c))
    return x * v - y * u > 0


def read_cells(statement: Any, grammar: int = 1) -> list[tuple[Point, ...]]:
    """Return the corners of the cells of a statement; for those who write certificates."""
    where = "statement: points"
    first = list_of(statement["points"], where, 1, MAX_CONFIGURATIONS)[0]
    joints = len(list_of(list_of(first, where, 2, MAX_CONFIGURATIONS)[0], where, 1, MAX_JOINTS))
    return [cell.corners for cell in read_statement(statement, grammar, joints).cells]


# --- balls ----------------------------------------------------------------------------------------

BITS = 192
"""A number x is written as the whole number nearest below x times 2^BITS: a count of units."""

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
"""Eighty digits: the error is far below a unit, and `real` adds one."""


class Ball:
    """All complex numbers no farther than r from x + iy; x, y and r are whole numbers of units."""

    __slots__ = ("r", "x", "y")
    work = 0
    """Multiplications since the check began."""

    def __init__(self, x: int, y: int = 0, r: int = 0) -> None:
        self.x, self.y, self.r = x, y, r

    def __add__(self, other: "Ball") -> "Ball":
        """Add centres and errors."""
        return Ball(self.x + other.x, self.y + other.y, self.r + other.r)

    def __sub__(self, other: "Ball") -> "Ball":
        """Subtract centres; errors add."""
        return Ball(self.x - other.x, self.y - other.y, self.r + other.r)

    def __mul__(self, other: "Ball") -> "Ball":
        """Multiply: for |a' - a| <= r and |b' - b| <= s, |a'b' - ab| <= |a| s + r (|b| + s).

        abs(x) + abs(y) is at least the absolute value of a centre. The product is in units of
        2^-2 BITS. It is rounded down to units, in x and in y by less than 1: by less than 2.
        """
        spend(1)
        x = self.x * other.x - self.y * other.y
        y = self.x * other.y + self.y * other.x
        a, b = abs(self.x) + abs(self.y), abs(other.x) + abs(other.y)
        error = a * other.r + self.r * (b + other.r)
        rounding = 2 if (x | y) & UNITS_MASK else 0
        return Ball(x >> BITS, y >> BITS, -(-error >> BITS) + rounding)

    def over(self, n: int) -> "Ball":
        """Divide by a whole number of 1 or more."""
        return Ball(self.x // n, self.y // n, self.r // n + 3)

    @property
    def re(self) -> "Ball":
        """Return the real part."""
        return Ball(self.x, 0, self.r)

    @property
    def im(self) -> "Ball":
        """Return the imaginary part."""
        return Ball(self.y, 0, self.r)

    @property
    def conjugate(self) -> "Ball":
        """Return the mirror image."""
        return Ball(self.x, -self.y, self.r)

    @property
    def size(self) -> "Ball":
        """Return a number that no absolute value in the ball exceeds."""
        return Ball(math.isqrt(self.x**2 + self.y**2) + 1 + self.r if self else 0)

    def __bool__(self) -> bool:
        """Tell whether the ball is more than the number 0."""
        return bool(self.x or self.y or self.r)


UNITS_MASK = (1 << BITS) - 1
ZERO, HALF, ONE, TWO = Ball(0), Ball(1 << (BITS - 1)), Ball(1 << BITS), Ball(2 << BITS)
IMAGINARY = Ball(0, 1 << BITS)


def spend(work: int) -> None:
    """Count work, and stop where it is too much."""
    Ball.work += work
    demand(Ball.work <= MAX_WORK, "the proof asks for too much work")


def real(x: Fraction | int) -> Ball:
    """Enclose an exact number."""
    whole, rest = divmod(x.numerator << BITS, x.denominator)
    return Ball(whole, 0, 1 if rest else 0)


RADIAN = {"deg": real(PI / 180) + Ball(0, 0, 1), "rad": ONE}
"""Radians in a unit of angle."""

HALVINGS, TERMS = 6, 40


def exp_i(angle: Ball) -> Ball:
    """Enclose exp(i t) for a real t of at most 32: Taylor's series at t / 2^6, then six squares.

    There t is at most 1/2, and what follows the 40th term is less than
    2 (1/2)^41 / 41!, which is less than a unit.
    """
    demand(abs(angle.x) + angle.r <= 32 << BITS, "an angle of more than five turns")
    small = IMAGINARY * angle.over(1 << HALVINGS)
    term = total = ONE
    for k in range(1, TERMS + 1):
        term = (term * small).over(k)
        total = total + term
    total = total + Ball(0, 0, 1)
    for _ in range(HALVINGS):
        total = total * total
    return total


@lru_cache(maxsize=10_000)
def phase_of(angle: Fraction, unit: str) -> Ball:
    """Enclose exp(i t) of an angle in its unit."""
    return exp_i(real(angle) * RADIAN[unit])


# --- kinematics -----------------------------------------------------------------------------------

Vector = tuple[Ball, Ball, Ball]
Matrix = tuple[Vector, Vector, Vector]


def vector(values: Point) -> Vector:
    """Enclose three exact numbers."""
    x, y, z = map(real, values)
    return x, y, z


def unit_vector(values: Point) -> Vector:
    """Enclose a vector scaled to length 1: the root of each exact share of the squared length."""
    square = _dot(values, values)
    x, y, z = (_signed_root(value, value**2 / square) for value in values)
    return x, y, z


def _signed_root(sign: Fraction, square: Fraction) -> Ball:
    whole = math.isqrt((square.numerator << 2 * BITS) // square.denominator)
    return Ball(whole if sign > 0 else -whole, 0, 1 if sign else 0)


def dot(u: Vector, v: Vector) -> Ball:
    """Return the sum of products (of complex numbers, without a conjugate)."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def plus(u: Vector, v: Vector) -> Vector:
    """Add vectors."""
    return u[0] + v[0], u[1] + v[1], u[2] + v[2]


def scaled(factor: Ball, u: Vector) -> Vector:
    """Multiply a vector by a number."""
    return factor * u[0], factor * u[1], factor * u[2]


def image(matrix: Matrix, u: Vector) -> Vector:
    """Multiply a matrix with a vector."""
    return dot(matrix[0], u), dot(matrix[1], u), dot(matrix[2], u)


def product(a: Matrix, b: Matrix) -> Matrix:
    """Multiply matrices."""
    x, y, z = (image(a, column) for column in zip(*b, strict=True))
    rows = tuple(zip(x, y, z, strict=True))
    return rows[0], rows[1], rows[2]


def combined(*parts: tuple[Ball, Matrix]) -> Matrix:
    """Add multiples of matrices."""
    rows = [[sum((f * m[i][j] for f, m in parts), ZERO) for j in range(3)] for i in range(3)]
    x, y, z = ((row[0], row[1], row[2]) for row in rows)
    return x, y, z


IDENTITY: Matrix = (ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE)


def rotation_waves(axis: Vector) -> tuple[Matrix, Matrix, Matrix]:
    """Return the matrices A, B, C of the turn A + B exp(it) + C exp(-it) by t about a unit axis.

    Rodrigues: the turn is P + cos t (1 - P) + sin t K, where P = axis axis^T keeps the part along
    the axis and K is the cross product with it; cos and sin are means of exp(it) and exp(-it).
    """
    x, y, z = axis
    along: Matrix = scaled(x, axis), scaled(y, axis), scaled(z, axis)
    cross: Matrix = (ZERO, ZERO - z, y), (z, ZERO, ZERO - x), (ZERO - y, x, ZERO)
    across = combined((HALF, IDENTITY), (ZERO - HALF, along))
    turning = IMAGINARY * HALF
    forwards = combined((ONE, across), (ZERO - turning, cross))
    backwards = combined((ONE, across), (turning, cross))
    return along, forwards, backwards


def turned(axis: Vector, phase: Ball) -> Matrix:
    """Return the turn about a unit axis by the angle of a phase."""
    still, forwards, backwards = rotation_waves(axis)
    return combined((ONE, still), (phase, forwards), (phase.conjugate, backwards))


def mount(joint: Joint, angle_unit: str) -> Matrix:
    """Return Rz(yaw) Ry(pitch) Rx(roll), the fixed rotation that a joint is mounted with."""
    total = IDENTITY
    for row, angle in zip(reversed(IDENTITY), reversed(joint.rpy), strict=True):
        if angle:
            total = product(total, turned(row, phase_of(angle, angle_unit)))
    return total


# --- boundary functions as sums of waves ----------------------------------------------------------

Key = tuple[int, ...]
"""For each joint k of its factor: exp(i k q) if it turns, k = -1, 0, 1; else q^k, k = 0, 1, 2."""

Form = dict[Key, Ball]
"""A sum of amplitudes, each times the factors of its key."""

VectorForm = dict[Key, Vector]


@dataclass(frozen=True)
class Motion:
    """What a joint does to a vector that is fixed beyond it, seen from its parent.

    Mounts and turns keep lengths. So the squared length of the vector changes by sliding and by the
    origin alone, and it, too, has only one factor for each joint.
    """

    j: int
    origin: Vector
    axis: Vector
    waves: Sequence[tuple[int, Matrix]]
    """For each k the matrix of exp(i k q)."""
    slides: bool

    def carry(self, u: VectorForm, square: Form) -> tuple[VectorForm, Form]:
        """Return origin + mount (turn of u), or origin + mount (u + q axis), and its square."""
        square = {**square}
        still = (0,) * len(next(iter(u)))
        if self.slides:
            u, u_before = {**u}, u
            for key, v in u_before.items():  # (u + q axis)^2 = u^2 + 2 q axis . u + q^2
                add_to(square, self._with(key, 1), TWO * dot(self.axis, v))
            add_to(square, self._with(still, 2), ONE)
            slid = self._with(still, 1)
            u[slid] = plus(u.get(slid, NOWHERE), self.axis)
        u = {
            self._with(key, k) if k else key: image(m, v)
            for key, v in u.items()
            for k, m in self.waves
        }
        for key, v in u.items():  # (origin + u)^2 = u^2 + 2 origin . u + origin^2
            add_to(square, key, TWO * dot(self.origin, v))
        add_to(square, still, dot(self.origin, self.origin))
        u[still] = plus(u[still], self.origin)
        return u, square

    def _with(self, key: Key, k: int) -> Key:
        return (*key[: self.j], k, *key[self.j + 1 :])


NOWHERE: Vector = ZERO, ZERO, ZERO


def add_to(form: Form, key: Key, value: Ball) -> None:
    """Add to the amplitude of a key."""
    form[key] = form.get(key, ZERO) + value


Held = dict[int, Fraction]
"""Values of joints that stay where they are."""


def motions(robot: Robot, held: Held) -> list[Motion]:
    """Return what each joint does; one that is held is no more than a part of its mount."""
    found = []
    for j, joint in enumerate(robot.joints):
        fixed, axis = mount(joint, robot.angle_unit), unit_vector(joint.axis)
        origin, waves = vector(joint.origin), [(0, fixed)]
        if joint.turns and j in held:
            waves = [(0, product(fixed, turned(axis, phase_of(held[j], robot.angle_unit))))]
        elif joint.turns:
            turning = zip((0, 1, -1), rotation_waves(axis), strict=True)
            waves = [(k, product(fixed, matrix)) for k, matrix in turning]
        elif j in held:
            origin = plus(origin, scaled(real(held[j]), image(fixed, axis)))
        slides = not joint.turns and j not in held
        found.append(Motion(j, origin, axis, waves, slides))
    return found


MAX_KNOWN = 200
"""Views that are kept: with six joints each has 729 vectors, about half a megabyte."""


class Kinematics:
    """Where the points of a robot are; what two boundaries need is found once."""

    def __init__(self, robot: Robot, held: Held | None = None) -> None:
        self.moves = motions(robot, held or {})
        self.known: dict[tuple[int, Place], tuple[VectorForm, Form]] = {}

    def seen(self, frame: int, place: Place) -> tuple[VectorForm, Form]:
        """Return a place as it is seen from a frame before it, and its squared distance."""
        if (frame, place) not in self.known:
            if len(self.known) >= MAX_KNOWN:
                self.known.clear()
            if frame == place.frame:
                still, at = (0,) * len(self.moves), vector(place.at)
                found: tuple[VectorForm, Form] = {still: at}, {still: dot(at, at)}
            else:
                found = self.moves[frame].carry(*self.seen(frame + 1, place))
            self.known[frame, place] = found
        return self.known[frame, place]


def boundary_form(kinematics: Kinematics, boundary: Boundary, gap: Fraction) -> Form:
    """Return the boundary function: |r|^2 - gap^2 of a pair, normal . r - gap of a half-space."""
    still = (0,) * len(kinematics.moves)
    ends = [end for end in boundary.ends if isinstance(end, Place)]
    *near, far = sorted(ends, key=lambda place: place.frame)
    u, square = kinematics.seen(near[0].frame if near else 0, far)
    if boundary.normal is not None:
        normal = unit_vector(boundary.normal)
        form = {key: dot(normal, v) for key, v in u.items()}
        add_to(form, still, ZERO - real(gap))
        return form
    square = {**square}  # (u - base)^2 = u^2 - 2 base . u + base^2
    base = vector(near[0].at)
    for key, v in u.items():
        add_to(square, key, ZERO - TWO * dot(base, v))
    add_to(square, still, dot(base, base) - real(gap**2))
    return square


@dataclass(frozen=True)
class Wave:
    """The real part of amplitude exp(i turns . q), times each q_j to its power."""

    amplitude: Ball
    turns: Key
    powers: Key

    @property
    def bends_upwards(self) -> bool:
        """Tell whether it is a square with a positive factor and nothing else."""
        lone = not any(self.turns) and sum(self.powers) == max(self.powers) == 2
        return lone and self.amplitude.x > self.amplitude.r


@dataclass(frozen=True)
class Function:
    """A boundary function: its waves, those that slide apart, and the matrix M of the others."""

    robot: Robot
    waves: tuple[Wave, ...]
    sliding: tuple[Wave, ...]
    bend: tuple[tuple[Ball, ...], ...]
    """The sum of size(A_k) w_k w_k^T."""

    def value_and_slopes(self, q: Point) -> tuple[Ball, list[Ball]]:
        """Return the value, and the derivative along each joint (by radians and lengths)."""
        joints = self.robot.joints
        phases = [
            phase_of(x, self.robot.angle_unit) if joint.turns else ONE
            for joint, x in zip(joints, q, strict=True)
        ]
        products: dict[Key, Ball] = {(): ONE}
        value, slopes = ZERO, [ZERO] * len(q)
        for wave in self.waves:
            z = wave.amplitude * phase_product(wave.turns, phases, products)
            value += z.re
            for j, w in enumerate(wave.turns):
                if w:
                    slopes[j] = slopes[j] - z.im if w > 0 else slopes[j] + z.im
        for wave in self.sliding:
            z = wave.amplitude * phase_product(wave.turns, phases, products)
            factor = monomial(wave.powers, q)
            value += z.re * factor
            for j, (w, p) in enumerate(zip(wave.turns, wave.powers, strict=True)):
                if w:
                    slopes[j] -= z.im * factor * Ball(w << BITS)
                if p:
                    lower = (*wave.powers[:j], p - 1, *wave.powers[j + 1 :])
                    slopes[j] += z.re * monomial(lower, q) * Ball(p << BITS)
        return value, slopes

    def sliding_bend(self, cell: Cell) -> Ball:
        """Bound the second derivative of the sliding waves along any step within a cell: C.

        With u = max |w . d|, Q = max |q_j| and D = max |d_j|, size y, slope dy and second
        derivative ddy of exp(i w . q) are at most 1, u, u^2; each factor q_j changes them by the
        product rule, (fq)'' = f'' q + 2 f' q'.
        """
        total = ZERO
        for wave in self.sliding:
            if not wave.bends_upwards:
                u = real(cell.largest(wave.turns)) * RADIAN[self.robot.angle_unit]
                y, dy, ddy = ONE, u, u * u
                for j in factors(wave.powers):
                    far = real(max(abs(q[j]) for q in cell.corners))
                    step = real(max(abs(d[j]) for d in cell.steps))
                    y, dy, ddy = y * far, dy * far + y * step, ddy * far + TWO * dy * step
                total += wave.amplitude.size * ddy
        return total


def function_of(robot: Robot, form: Form) -> Function:
    """Sort the terms of a form into waves; of a term and its mirror image one stands for both."""
    waves = []
    for key, amplitude in form.items():
        turns = tuple(k if joint.turns else 0 for k, joint in zip(key, robot.joints, strict=True))
        powers = tuple(0 if joint.turns else k for k, joint in zip(key, robot.joints, strict=True))
        if amplitude and turns >= (0,) * len(key):
            both = TWO * amplitude if any(turns) else amplitude.re
            waves.append(Wave(both, turns, powers))
    turning = tuple(wave for wave in waves if not any(wave.powers))
    sliding = tuple(wave for wave in waves if any(wave.powers))
    return Function(robot, turning, sliding, bend_matrix(turning, len(robot.joints)))


def bend_matrix(waves: Iterable[Wave], joints: int) -> tuple[tuple[Ball, ...], ...]:
    """Return M, the sum of size(A) w w^T: sizes are above |A|, so that M bends no less."""
    bend = [[ZERO] * joints for _ in range(joints)]
    for wave in waves:
        size, turning = wave.amplitude.size, [j for j, w in enumerate(wave.turns) if w]
        for i, j in itertools.product(turning, repeat=2):
            same = wave.turns[i] == wave.turns[j]
            bend[i][j] = bend[i][j] + size if same else bend[i][j] - size
    return tuple(map(tuple, bend))


def phase_product(turns: Key, phases: Sequence[Ball], products: dict[Key, Ball]) -> Ball:
    """Return exp(i turns . q) as a product of phases; those of the first joints are kept."""
    if turns not in products:
        before = phase_product(turns[:-1], phases, products)
        phase = phases[len(turns) - 1]
        k = turns[-1]
        products[turns] = before * (phase if k > 0 else phase.conjugate) if k else before
    return products[turns]


def factors(powers: Key) -> list[int]:
    """Return the joints whose values are factors, twice for a square."""
    return [j for j, power in enumerate(powers) for _ in range(power)]


def monomial(powers: Key, q: Point) -> Ball:
    """Return the product of joint values to their powers."""
    return real(math.prod((q[j] for j in factors(powers)), start=Fraction(1)))


# --- bodies in the plane of motion ----------------------------------------------------------------
# The axes of an arm that moves in a plane are parallel to one axis of the base; slides are at right
# angles to it. Bodies are seen along it: places are complex numbers, x + iz along y, x + iy along
# z, y + iz along x, and a turn by q multiplies what it carries by exp(iq) or exp(-iq).

ACROSS = ((1, 2), (0, 2), (0, 1))
"""The two coordinates across x, y and z, in the order in which places are written."""

ANTICLOCKWISE = (1, -1, 1)
"""How a turn about x, y and z turns the plane of the two."""

NEARLY_ZERO = Fraction(1, 10**9)
"""What rounded mounts may leave of a coordinate that is 0."""


def is_nearly_zero(x: Ball) -> bool:
    """Tell whether a number is certainly 0 but for what a rounded angle makes of it."""
    return x.size.x <= real(NEARLY_ZERO).x


class Plane:
    """An arm in its plane of motion.

    At joint values 0 each frame stands in the base as all mounts before it turn it. These are
    `stands`; from there on all turns are about the common axis.
    """

    def __init__(self, robot: Robot) -> None:
        stands = [IDENTITY]
        for joint in robot.joints:
            stands.append(product(stands[-1], mount(joint, robot.angle_unit)))
        pairs = zip(robot.joints, stands[1:], strict=True)
        axes = [image(stand, unit_vector(joint.axis)) for joint, stand in pairs]
        common = [k for k in (1, 2, 0) if all(map(_fits, robot.joints, axes, [k] * len(axes)))]
        demand(common, "robot: bodies, and joints that do not move in a plane across x, y or z")
        self.turning = tuple(joint.turns for joint in robot.joints)
        self.still = (0,) * len(robot.joints)
        self.stands, self.common = stands, common[0]
        self.moves = [
            (
                self._seen(image(stand, vector(joint.origin))),
                ANTICLOCKWISE[self.common] * (1 if axis[self.common].x > 0 else -1),
                self._seen(axis),
            )
            for joint, stand, axis in zip(robot.joints, stands[:-1], axes, strict=True)
        ]
        """Of each joint: its origin, the sense of its turn, the direction of its slide."""

    def _seen(self, u: Vector) -> Ball:
        a, b = ACROSS[self.common]
        return u[a] + IMAGINARY * u[b]

    def own(self, frame: int) -> int:
        """Return the axis of a frame, 0 to 2, that is parallel to the common one."""
        a, b = ACROSS[self.common]
        stand = self.stands[frame]
        found = [k for k in range(3) if is_nearly_zero(stand[a][k]) and is_nearly_zero(stand[b][k])]
        demand(found, "robot: a body in a frame of which no axis is that of the joints")
        return found[0]

    def corner(self, frame: int, corner: Point) -> Point:
        """Return a corner as three numbers of its frame."""
        own = self.own(frame)
        return corner if len(corner) == 3 else (*corner[:own], Fraction(0), *corner[own:])

    def place(self, frame: int, corner: Point) -> Ball:
        """Return a corner from its frame's origin, at joint values 0."""
        return self._seen(image(self.stands[frame], vector(self.corner(frame, corner))))

    def is_mirrored(self, frame: int) -> bool:
        """Tell whether a frame's two coordinates are seen the other way round."""
        units = (Fraction(1), Fraction(0)), (Fraction(0), Fraction(1))
        one, other = (self.place(frame, unit) for unit in units)
        return (one.conjugate * other).y < 0

    def carried(self, near: int, frame: int, place: Ball, *, direction: bool = False) -> Form:
        """Return a place of a frame, or a direction, as it is seen from a frame before it."""
        form = {self.still: place}
        for j in reversed(range(near, frame)):
            origin, sense, slide = self.moves[j]
            if self.turning[j]:
                form = {(*key[:j], sense, *key[j + 1 :]): z for key, z in form.items()}
            elif not direction:
                form[(*self.still[:j], 1, *self.still[j + 1 :])] = slide
            if not direction:
                add_to(form, self.still, origin)
        return form

    def dot(self, u: Form, v: Form) -> Form:
        """Return the dot product of two vectors, the real part of conjugate(u) v."""
        form: Form = {}
        for (one, x), (other, y) in itertools.product(u.items(), v.items()):
            z = HALF * x.conjugate * y
            minus = tuple(-k if turns else k for k, turns in zip(one, self.turning, strict=True))
            key = tuple(a + b for a, b in zip(minus, other, strict=True))
            mirrored = tuple(-k if turns else k for k, turns in zip(key, self.turning, strict=True))
            add_to(form, key, z)
            add_to(form, mirrored, z.conjugate)
        return form


def _fits(joint: Joint, axis: Vector, k: int) -> bool:
    """Tell whether a joint turns about an axis of the base, or slides across it."""
    a, b = ACROSS[k]
    return all(map(is_nearly_zero, (axis[a], axis[b]) if joint.turns else (axis[k],)))


def less(u: Form, v: Form) -> Form:
    """Subtract."""
    form = {**u}
    for key, z in v.items():
        add_to(form, key, ZERO - z)
    return form


@dataclass(frozen=True)
class Core:
    """A convex core: corners in order, and the outward normal of each edge, as long as the edge.

    Edge i goes from corner i to the next one. A segment has two edges, there and back; a lone
    corner has none.
    """

    frame: int
    corners: tuple[Ball, ...]
    normals: tuple[Ball, ...]

    def around(self, i: int) -> list[Ball]:
        """Return the steps from a corner to its neighbours."""
        count = len(self.corners)
        others = {(i + 1) % count, (i - 1) % count} - {i}
        return [self.corners[k] - self.corners[i] for k in sorted(others)]


def cores_of(plane: Plane, body: Body, parts: Iterable[Sequence[int]]) -> list[Core]:
    """Return the cores of some parts of a body, by the numbers of their corners."""
    places = [plane.place(body.frame, corner) for corner in body.corners]
    outward = ZERO - IMAGINARY  # a quarter turn to the right of an edge that goes anticlockwise
    if body.is_outline and (_sense_of(plane, body) < 0) != plane.is_mirrored(body.frame):
        outward = IMAGINARY
    cores = []
    for part in parts:
        corners = tuple(places[k] for k in part)
        steps = [b - a for a, b in zip(corners, (*corners[1:], corners[0]), strict=True)]
        normals = tuple(outward * step for step in steps) if len(corners) > 1 else ()
        cores.append(Core(body.frame, corners, normals))
    return cores


def _written_corners(plane: Plane, body: Body) -> list[tuple[int, ...]]:
    """Return the two coordinates of each corner, times a number that makes them whole.

    A third one, along the axis, is the same for all.
    """
    own = plane.own(body.frame)
    places = [plane.corner(body.frame, corner) for corner in body.corners]
    where = f"robot: {shown(body.name)}"
    demand(len({place[own] for place in places}) == 1, f"{where}: corners not in one plane")
    rows = [place[:own] + place[own + 1 :] for place in places]
    whole = math.lcm(*(x.denominator for row in rows for x in row))
    return [tuple(int(x * whole) for x in row) for row in rows]


def _cross(a: Sequence[int], b: Sequence[int], c: Sequence[int]) -> int:
    """Return a number that is positive if c lies on the left of the line from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _sense_of(plane: Plane, body: Body) -> int:
    """Return 1 for an outline that is written anticlockwise, else -1."""
    corners = _written_corners(plane, body)
    area = sum(_cross(corners[0], a, b) for a, b in itertools.pairwise(corners))
    demand(area, f"robot: {shown(body.name)}: an outline without an area")
    return 1 if area > 0 else -1


def read_parts(plane: Plane, body: Body, value: Any) -> list[list[int]]:
    """Verify that an outline is made of convex parts, and return the corners of each.

    As with the triangles of a polygon: each part goes round in the sense of the outline, inner
    edges occur in pairs, one there and one back, all others are the outline. Then the edges of all
    parts add up to it, and it winds around a place as often as parts hold that place: a place that
    it winds around lies in a part, and a part in the body.
    """
    where = f"parts: {shown(body.name)}"
    corners, sense = _written_corners(plane, body), _sense_of(plane, body)
    numbers = {place: k for k, place in enumerate(corners)}
    parts, inner = list[list[int]](), set[tuple[int, int]]()
    for item in list_of(value, where, 1, len(corners)):
        part = [index_of(k, where, len(corners)) for k in list_of(item, where, 3, len(corners))]
        spend(len(part) ** 2 // 4)
        for a, b in _edges([numbers[corners[k]] for k in part]):
            sides = [sense * _cross(corners[a], corners[b], corners[k]) for k in part]
            demand(min(sides) >= 0 < max(sides), f"{where}: a part is not convex, or inside out")
            demand((a, b) not in inner, f"{where}: another part lies on this side of an edge")
            inner.add((a, b))
        parts.append(part)
    for a, b in _edges([numbers[place] for place in corners]):
        demand(
            (a, b) in inner and (b, a) not in inner, f"{where}: an edge is of no part, or of two"
        )
        inner.remove((a, b))
    for a, b in inner:
        demand((b, a) in inner, f"{where}: an edge of one part alone is not of the outline")
    return parts


MAX_FUNCTIONS = 2_000
"""Functions of two cores that are kept: each has some kilobytes."""


class Separation:
    """The features of two cores, numbered: edges of one, edges of the other, pairs of corners.

    A feature separates the cores by more than a gap where each of its functions is positive.
    """

    def __init__(self, robot: Robot, plane: Plane, cores: Sequence[Core], gap: Fraction) -> None:
        self.robot, self.plane, self.cores, self.gap = robot, plane, cores, gap
        self.near = min(core.frame for core in cores)
        self.known: dict[int, list[Function]] = {}

    def functions(self, number: int | None, where: str) -> list[Function]:
        """Return the functions of a feature."""
        one, other = self.cores
        edges = len(one.normals), len(other.normals)
        pairs = len(one.corners) * len(other.corners)
        named = number is not None and number < sum(edges) + pairs
        demand(named, f"{where}: a leaf has the number of a feature of its two parts")
        if number not in self.known:
            if sum(map(len, self.known.values())) > MAX_FUNCTIONS:
                self.known.clear()
            k = int(number or 0)
            if k < edges[0]:
                forms = self._edge(one, k, other)
            elif k < sum(edges):
                forms = self._edge(other, k - edges[0], one)
            else:
                forms = self._corners(*divmod(k - sum(edges), len(other.corners)))
            self.known[k] = [function_of(self.robot, form) for form in forms]
        return self.known[int(number or 0)]

    def _edge(self, core: Core, i: int, other: Core) -> list[Form]:
        """Each corner p of the other core is beyond the edge: normal . (p - a) > gap |normal|."""
        normal = self._direction(core, core.normals[i])
        least = {self.plane.still: real(self.gap) * core.normals[i].size}
        a = self._place(core, core.corners[i])
        return [
            less(self.plane.dot(normal, less(self._place(other, p), a)), least)
            for p in other.corners
        ]

    def _corners(self, i: int, j: int) -> list[Form]:
        """Two corners p and r are nearest to each other, and |r - p| > gap.

        The step r - p goes away from all neighbours of p, and those of r go away along it. So the
        cores lie on either side of the strip between p and r at right angles to the step.
        """
        one, other = self.cores
        step = less(self._place(other, other.corners[j]), self._place(one, one.corners[i]))
        square = less(self.plane.dot(step, step), {self.plane.still: real(self.gap**2)})
        behind = [less({}, self.plane.dot(self._direction(one, e), step)) for e in one.around(i)]
        beyond = [self.plane.dot(self._direction(other, f), step) for f in other.around(j)]
        return [square, *behind, *beyond]

    def _place(self, core: Core, place: Ball) -> Form:
        return self.plane.carried(self.near, core.frame, place)

    def _direction(self, core: Core, step: Ball) -> Form:
        return self.plane.carried(self.near, core.frame, step, direction=True)

    def overlap(self, weights: Sequence[Sequence[Fraction]], q: Point) -> bool:
        """Verify that the cores are nearer than the gap at a configuration, by a place of each.

        Each place is a mean of corners. It will do that they are nearer than the gap, or that one
        is strictly inside the other core. Of two segments it will do that they cross.
        """
        places = [
            sum((real(w) * p for w, p in zip(row, core.corners, strict=True)), ZERO)
            for row, core in zip(weights, self.cores, strict=True)
        ]
        one, other = (self._place(*pair) for pair in zip(self.cores, places, strict=True))
        step = less(one, other)
        square = less(self.plane.dot(step, step), {self.plane.still: real(self.gap**2)})
        inside = (self._inside(self.cores[1], one, q), self._inside(self.cores[0], other, q))
        return self._is_negative(square, q) or any(inside) or self._cross(q)

    def _cross(self, q: Point) -> bool:
        """Tell whether two segments certainly cross: the line of each parts the other's ends."""
        one, other = self.cores
        if not len(one.corners) == len(other.corners) == 2:
            return False
        return self._parts_ends(one, other, q) and self._parts_ends(other, one, q)

    def _parts_ends(self, core: Core, other: Core, q: Point) -> bool:
        """Tell whether the ends of a segment are certainly on two sides of another one's line."""
        normal, start = self._direction(core, core.normals[0]), self._place(core, core.corners[0])
        ends = [self._place(other, end) for end in other.corners]
        below = [self._is_negative(self.plane.dot(normal, less(end, start)), q) for end in ends]
        above = [self._is_negative(self.plane.dot(normal, less(start, end)), q) for end in ends]
        return (below[0] and above[1]) or (above[0] and below[1])

    def _inside(self, core: Core, place: Form, q: Point) -> bool:
        """Tell whether a place is certainly on the inner side of every edge of an outline."""
        edges = zip(core.corners, core.normals, strict=True) if len(core.corners) > 2 else ()
        sides = [
            self.plane.dot(self._direction(core, n), less(place, self._place(core, a)))
            for a, n in edges
        ]
        return bool(sides) and all(self._is_negative(side, q) for side in sides)

    def _is_negative(self, form: Form, q: Point) -> bool:
        value, _ = function_of(self.robot, form).value_and_slopes(q)
        return value.x + value.r < 0


# --- the bound ------------------------------------------------------------------------------------


def is_positive(function: Function, cell: Cell) -> bool:
    """Prove that a boundary function is positive all over a cell; False means: not proved.

    With the centre m, slopes g, and M and C as above, for every step d within the cell

        beta(m + d) >= beta(m) + g . d - 1/2 d^T M d - 1/2 C

    since along d the second derivative of a wave A is at most |A| (w . d)^2. The right side is
    concave in d (M is a sum of squares with positive factors): it is least at a corner.
    """
    robot = function.robot
    value, slopes = function.value_and_slopes(cell.centre)
    constant = value + value - function.sliding_bend(cell)
    units = [RADIAN[robot.angle_unit] if joint.turns else ONE for joint in robot.joints]
    signs = cell.signs
    for exact in cell.steps:
        step = [real(x) * unit for x, unit in zip(exact, units, strict=True)]
        if least_of_twice(constant, slopes, function.bend, step, signs) <= 0:
            return False
    return True


def least_of_twice(
    constant: Ball,
    slopes: Sequence[Ball],
    bend: Sequence[Sequence[Ball]],
    step: Sequence[Ball],
    signs: Sequence[tuple[int, ...]],
) -> int:
    """Bound constant + 2 g . d - d^T M d from below over all d_j = s_j step_j, in units.

    The error of a sum is the sum of the errors, whatever the signs: it is subtracted once.
    """
    moving = [j for j, d in enumerate(step) if d]
    linear = [(j, slopes[j] * step[j]) for j in moving]
    square = [(j, bend[j][j] * step[j] * step[j]) for j in moving]
    mixed = [
        (i, j, bend[i][j] * step[i] * step[j])
        for i, j in itertools.combinations(moving, 2)
        if bend[i][j]
    ]
    spend(len(signs) * (len(linear) + len(mixed)) // 10)  # sums are that much faster
    doubled = [term.r for _, term in linear] + [term.r for _, _, term in mixed]
    fixed = constant.x - sum(term.x for _, term in square)
    error = constant.r + sum(term.r for _, term in square) + 2 * sum(doubled)
    slope = [(j, 2 * term.x) for j, term in linear]
    cross = [(i, j, 2 * term.x) for i, j, term in mixed]
    least = min(
        sum(s[j] * x for j, x in slope) - sum(s[i] * s[j] * x for i, j, x in cross) for s in signs
    )
    return fixed + least - error


TREE = re.compile(r"(?P<number>0|[1-9][0-9]{0,8})?[.]|.", re.DOTALL)


def walk(cell: Cell, tree: str, where: str) -> Iterator[tuple[Cell, bool, int | None]]:
    """Visit the cells of a tree in its order: each, whether it is a leaf, and the leaf's number.

    A letter cuts the next cell in two; a dot, after a number or not, makes it a leaf.
    """
    demand(type(tree) is str and tree, f"{where}: a tree is a text")
    todo = [(cell, 0)]
    for token in TREE.finditer(tree):
        spend(CELL_WORK)
        demand(todo, f"{where}: the tree goes on after its last leaf")
        cell, depth = todo.pop()
        letter, number = token.group(), token["number"]
        is_leaf = letter.endswith(".")
        if not is_leaf:
            demand(depth < MAX_DEPTH, f"{where}: more than {MAX_DEPTH} cuts on top of each other")
            first, second = cell.halves(letter)
            todo += [(second, depth + 1), (first, depth + 1)]
        yield cell, is_leaf, None if number is None else int(number)
    demand(not todo, f"{where}: the tree ends before its last leaf")


def prove(asked: "Asked", cell: Cell, tree: str, where: str) -> None:
    """Verify that on each leaf of a tree all is positive."""
    for leaf, is_leaf, number in walk(cell, tree, where):
        for function in asked(number, where) if is_leaf else ():
            positive = is_positive(function, leaf)
            demand(positive, f"{where}: the bound is not positive on a leaf")


# --- proofs and witnesses -------------------------------------------------------------------------

Parts = dict[str, list[list[int]]]
"""The convex parts of outlines, each by its corners."""

Asked = Callable[[int | None, str], list[Function]]
"""What is positive on a leaf, by the number that the leaf has."""


class Proving:
    """What has to be positive for a boundary: for bodies, by the features of their parts."""

    def __init__(self, robot: Robot, parts: Any, margin: Fraction) -> None:
        self.robot, self.margin = robot, margin
        self.kinematics = Kinematics(robot)
        table = table_of(parts, "parts", robot.outlines)
        self.parts = {
            name: read_parts(self.plane, body, table[name]) for name, body in robot.outlines.items()
        }

    @cached_property
    def plane(self) -> Plane:
        """Return the arm in its plane of motion, if it has one."""
        return Plane(self.robot)

    def count(self, boundary: Boundary) -> int:
        """Return how many proofs a boundary asks for: one for each pair of parts."""
        return math.prod(len(self.parts.get(body.name, [[0]])) for body in boundary.bodies)

    def asked(self, boundary: Boundary) -> Iterator[Asked]:
        """Return what each of them asks for."""
        if boundary.bodies:
            for one, other in itertools.product(*map(self.cores, boundary.bodies)):
                yield self.separation(boundary, one, other).functions
            return
        forms = [self.form(single) for single in self.singles(boundary)]
        functions = [function_of(self.robot, form) for form in forms]

        def plain(number: int | None, where: str) -> list[Function]:
            demand(number is None, f"{where}: a leaf has a number, but there are no features")
            return functions

        yield plain

    def singles(self, boundary: Boundary) -> list[Boundary]:
        """Return a boundary; of a half-space for a body, that of each of its corners."""
        bodies = [end for end in boundary.ends if isinstance(end, Body)]
        if not bodies:
            return [boundary]
        [body] = bodies
        corners = [self.plane.corner(body.frame, corner) for corner in body.corners]
        places = [Place(body.frame, corner, body.radius) for corner in corners]
        return [replace(boundary, ends=(place,)) for place in places]

    def form(self, boundary: Boundary) -> Form:
        """Return the form of a boundary of points."""
        return boundary_form(self.kinematics, boundary, boundary.gap(self.margin))

    def cores(self, body: Body) -> list[Core]:
        """Return the cores of the parts of a body."""
        every = [*range(len(body.corners))]
        return cores_of(self.plane, body, self.parts.get(body.name, [every]))

    def separation(self, boundary: Boundary, one: Core, other: Core) -> Separation:
        """Return the features of two cores."""
        return Separation(self.robot, self.plane, (one, other), boundary.gap(self.margin))

    def is_violated(self, boundary: Boundary, q: Point, places: Any) -> bool:
        """Tell whether a configuration certainly violates a boundary."""
        if boundary.bodies:
            pair, weights = self._read_places(boundary, places)
            return pair.overlap(weights, q)
        values = [
            function_of(self.robot, self.form(single)).value_and_slopes(q)[0]
            for single in self.singles(boundary)
        ]
        return any(value.x + value.r < 0 for value in values)

    def _read_places(
        self, boundary: Boundary, value: Any
    ) -> tuple[Separation, list[list[Fraction]]]:
        """Read a place of a part of either body, as a mean of its corners."""
        cores, weights = list[Core](), list[list[Fraction]]()
        for item, body in zip(list_of(value, "places", 2, 2), boundary.bodies, strict=True):
            row, known = table_of(item, "places", ("part", "weights")), self.cores(body)
            cores.append(known[index_of(row["part"], "places: part", len(known))])
            weights.append(mean_of(row["weights"], "places: weights", len(cores[-1].corners)))
        return self.separation(boundary, *cores), weights


def mean_of(value: Any, where: str, count: int) -> list[Fraction]:
    """Return the weights of a mean of some corners."""
    weights = [number(x, where) for x in list_of(value, where, count, count)]
    mean = min(weights) >= 0 and sum(weights) == 1
    demand(mean, f"{where}: numbers of 0 or more whose sum is 1 are wanted")
    return weights


def demand_within_limits(robot: Robot, points: Iterable[Point]) -> None:
    """Refuse a configuration that is beyond a limit."""
    for q in points:
        beyond = robot.beyond(q)
        demand(not beyond, f"statement: beyond the limit {shown(next(iter(beyond), ''))}")


def verify_proof(proving: Proving, statement: Statement, value: Any) -> None:
    """Verify that the whole set keeps all limits and all boundaries in use."""
    robot = proving.robot
    for cell in statement.cells:  # cells are convex: their corners stand for them
        demand_within_limits(robot, cell.corners)
    needed = [b for b in robot.boundaries if b.needs_proof(statement.margin)]
    proof = table_of(value, "proof", [boundary.name for boundary in needed])
    for boundary in needed:
        where = f"proof: {shown(boundary.name)}"
        count = proving.count(boundary) * len(statement.cells)
        trees = list_of(proof[boundary.name], where, count, count)
        pairs = ((asked, cell) for asked in proving.asked(boundary) for cell in statement.cells)
        for i, ((asked, cell), tree) in enumerate(zip(pairs, trees, strict=True)):
            prove(asked, cell, tree, f"{where}[{i}]")


def verify_witness(proving: Proving, name: str, q: Point, places: Any) -> None:
    """Verify that a configuration violates a boundary or a limit."""
    boundary = next((b for b in proving.robot.boundaries if b.name == name), None)
    apart = boundary is not None and bool(boundary.bodies)
    demand(apart == (places is not None), "places: wanted for a pair of bodies, and for no other")
    if name in proving.robot.beyond(q):
        return
    if boundary is None:
        raise Refused(
            f"boundary: {shown(name)} is no boundary in use and no limit that is violated"
        )
    violated = proving.is_violated(boundary, q, places)
    demand(violated, f"boundary: the witness does not violate {shown(name)}")


def read_witness(content: Table, statement: Statement, joints: int) -> Point:
    """Return the configuration of a witness, which belongs to the set."""
    if "at" in content:
        q, [box] = configuration(content["at"], "at", joints), statement.cells
        low, high = box.corners
        inside = all(a <= x <= b for a, x, b in zip(low, q, high, strict=True))
        demand(inside, "at: the witness is not in the box")
        return q
    cell = statement.cells[index_of(content["cell"], "cell", len(statement.cells))]
    weights = mean_of(content["weights"], "weights", len(cell.corners))
    return tuple(_dot(weights, column) for column in zip(*cell.corners, strict=True))


# --- no path --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Blocked:
    """Values of a joint, both ends included, at which a boundary is violated throughout.

    Whatever the other joints are: a path that takes the joint from one side of them to the other
    has a configuration that violates the boundary.
    """

    joint: int
    boundary: Boundary
    low: Fraction
    high: Fraction


def verify_no_path(robot: Robot, statement: Statement, value: Any) -> list[Blocked]:
    """Verify that no path within the limits keeps every boundary from one end to the other."""
    proof, [[start, goal]] = table_of(value, "proof", ("joint", "blocked")), statement.loops
    demand_within_limits(robot, (start, goal))
    names = [joint.name for joint in robot.joints]
    j = names.index(one_of(proof["joint"], "proof: joint", names))
    count = 1 if robot.joints[j].limits else 2  # without limits there are two ways round
    rows = list_of(proof["blocked"], "proof: blocked", count, count)
    kinematics = Kinematics(robot)
    blocked = [
        _read_blocked(kinematics, robot, statement, j, row, f"proof: blocked[{i}]")
        for i, row in enumerate(rows)
    ]
    if len(blocked) == 1:
        low, high = sorted((start[j], goal[j]))
        between = low < blocked[0].low and blocked[0].high < high
    else:
        one, other = blocked
        between = is_parted(start[j], goal[j], one, other, robot.angle_unit)
    demand(between, "proof: blocked: both configurations are on one side of it")
    return blocked


def is_parted(start: Fraction, goal: Fraction, one: Blocked, other: Blocked, unit: str) -> bool:
    """Tell whether a joint without limits passes one of two ranges on any way to a goal.

    Upwards from the start lie, within a turn, the first range, the goal (a number of turns on) and
    the second range; so downwards from the start lies the second one, a turn back, before the goal.
    In radians a turn is known to more digits than a unit has.
    """
    turn = Fraction(360) if unit == "deg" else 2 * PI
    error = Fraction(0) if unit == "deg" else Fraction(1, 10**70)
    within = start < one.low and other.high < start + turn - error
    most = 2 * int(LARGEST_ANGLE[unit] // turn) + 2
    return within and any(
        one.high < goal + k * turn - most * error and goal + k * turn + most * error < other.low
        for k in range(-most, most + 1)
    )


def _read_blocked(
    kinematics: Kinematics, robot: Robot, statement: Statement, j: int, value: Any, where: str
) -> Blocked:
    """Read a range of joint j and prove that a boundary is violated all over it."""
    row = table_of(value, where, ("boundary", "from", "to", "tree"))
    boundary = boundary_of_points(robot, row["boundary"], f"{where}: boundary")
    frames = [0] * (boundary.normal is not None) + sorted(end.frame for end in boundary.ends)
    demand(frames[0] <= j < frames[-1], f"{where}: boundary: it does not depend on the joint")
    low, high = (number(row[key], f"{where}: {key}") for key in ("from", "to"))
    demand(low < high, f"{where}: from is not less than to")
    largest = LARGEST_ANGLE[robot.angle_unit]
    small = not robot.joints[j].turns or max(abs(low), abs(high)) <= largest
    demand(small, f"{where}: an angle of more than {largest} {robot.angle_unit}")
    form = boundary_form(kinematics, boundary, boundary.gap(statement.margin))
    reach = tuple(
        max(map(abs, (low, high) if i == j else joint.limits or (Fraction(1),)))
        for i, joint in enumerate(robot.joints)
    )
    function = function_of(robot, least_violation(robot, form, j, reach))
    [[start, _]], tree = statement.loops, row["tree"]
    ends = [(*start[:j], end, *start[j + 1 :]) for end in (low, high)]

    def asked(feature: int | None, where: str) -> list[Function]:
        demand(feature is None, f"{where}: a leaf has a number, but there are no features")
        return [function]

    prove(asked, Box(*ends), tree, where)
    return Blocked(j, boundary, low, high)


def boundary_of_points(robot: Robot, name: Any, where: str) -> Boundary:
    """Return the boundary of this name, which is in use, and about points."""
    known = {b.name: b for b in robot.boundaries if all(isinstance(e, Place) for e in b.ends)}
    named = type(name) is str and name in known
    demand(named, f"{where}: {shown(name)} is no boundary of points in use")
    return known[name]


def least_violation(robot: Robot, form: Form, j: int, reach: Point) -> Form:
    """Return a form of joint j alone that is nowhere more than minus a form.

    A term with factors of other joints may have either sign: its largest size is taken off.
    """
    found: Form = {(0,) * len(robot.joints): ZERO}
    for key, amplitude in form.items():
        if any(k for i, k in enumerate(key) if i != j):
            powers = tuple(
                0 if joint.turns else k for k, joint in zip(key, robot.joints, strict=True)
            )
            add_to(found, (0,) * len(key), ZERO - amplitude.size * monomial(powers, reach))
        else:
            add_to(found, key, ZERO - amplitude)
    return found


# --- disconnected ---------------------------------------------------------------------------------
# The box of all values of the joints that move is cut into leaves. On one with a number a boundary
# is violated throughout. So a path that violates none stays in the others, closed as they are, and
# gets from one to another only where they touch, be it in a corner.

WHOLE_TURN = {
    "deg": (Fraction(-180), Fraction(180)),
    "rad": (Fraction("-3.1416"), Fraction("3.1416")),
}
"""Values of a joint without limits: a turn, or a little more, whose ends are glued."""

UNITS = 2**MAX_DEPTH
"""Of a side of the box: ends of cells are whole counts, however often it was halved."""

TURN_ERROR = 10
"""Units that it may take to count a turn in whole units, in radians, up to five turns away."""

VISITS = 2
"""Cells that are compared with a span in the time of a multiplication."""

Span = tuple[tuple[Fraction | int, Fraction | int], ...]
"""A low and a high end for each joint that moves, in units from the low end of the box."""


class Disconnected(NamedTuple):
    """Leaves on each of which one of some boundaries is violated throughout."""

    boundaries: list[Boundary]
    leaves: int


def verify_disconnected(robot: Robot, statement: Statement, value: Any) -> Disconnected:
    """Verify that no path of the joints that move leads from start to goal; the others are held."""
    proof, [[start, goal]] = table_of(value, "proof", ("boundaries", "tree")), statement.loops
    demand_within_limits(robot, (start, goal))
    where = "proof: boundaries"
    names = list_of(proof["boundaries"], where, 1, MAX_ROWS)
    boundaries = [boundary_of_points(robot, name, where) for name in names]
    kinematics = Kinematics(robot, statement.held)
    violations = [
        function_of(robot, less({}, boundary_form(kinematics, b, b.gap(statement.margin))))
        for b in boundaries
    ]
    box = free_box(robot, statement)
    leaves = Leaves(robot, box, statement.free)
    for cell, is_leaf, number in walk(box, proof["tree"], "proof: tree"):
        leaves.add(cell, is_leaf=is_leaf, is_open=is_leaf and number is None)
        if is_leaf and number is not None:
            demand(number < len(violations), f"proof: tree: no boundary has the number {number}")
            violated = is_positive(violations[number], cell)
            demand(violated, f"proof: tree: {boundaries[number].name!a} may be kept on a leaf")
    first, last = leaves.holding(start), leaves.holding(goal)
    demand(first, "proof: tree: the start is in no leaf without a number")
    demand(last, "proof: tree: the goal is in no leaf without a number")
    joined = last & leaves.reached(first)
    demand(not joined, "proof: tree: leaves without a number lead from the start to the goal")
    return Disconnected(boundaries, sum(leaves.is_leaf) - sum(leaves.is_open))


def free_box(robot: Robot, statement: Statement) -> Box:
    """Return all values of the joints that move, and the one value of each that is held."""
    held, largest = statement.held, LARGEST_ANGLE[robot.angle_unit]
    ends = list[tuple[Fraction, Fraction]]()
    for j, joint in enumerate(robot.joints):
        if j in held:
            ends.append((held[j], held[j]))
        else:
            ends.append(joint.limits or WHOLE_TURN[robot.angle_unit])
            small = not joint.turns or max(map(abs, ends[-1])) <= largest
            demand(small, f"statement: free: limits of more than {largest} {robot.angle_unit}")
    low, high = zip(*ends, strict=True)
    return Box(low, high)


class Leaves:
    """The cells of a tree in its order, by their spans, to tell which of its leaves touch.

    A joint without limits is glued: its values a turn apart are the same.
    """

    def __init__(self, robot: Robot, box: Box, free: Sequence[int]) -> None:
        self.free, self.low = free, box.low
        self.scale = [
            UNITS / (b - a) if a != b else 0 for a, b in zip(box.low, box.high, strict=True)
        ]
        in_degrees = robot.angle_unit == "deg"
        turn = Fraction(360) if in_degrees else 2 * PI
        glued = [robot.joints[j].limits is None for j in free]
        self.turns = [int(turn * self.scale[j]) * g for j, g in zip(free, glued, strict=True)]
        """Units of a turn, and 0 of a joint with limits."""
        self.errors = [0 if in_degrees else TURN_ERROR * g for g in glued]
        self.spans, self.is_leaf, self.is_open = list[Span](), list[bool](), list[bool]()

    def add(self, cell: Cell, *, is_leaf: bool, is_open: bool) -> None:
        """Add the next cell; open is a leaf without a number."""
        low, high = cell.corners
        self.spans.append(
            tuple((int(self.units(low, j)), int(self.units(high, j))) for j in self.free)
        )
        self.is_leaf.append(is_leaf)
        self.is_open.append(is_open)

    def units(self, q: Point, j: int) -> Fraction:
        """Return where a joint value lies, from the low end of the box."""
        return (q[j] - self.low[j]) * self.scale[j]

    @cached_property
    def after(self) -> list[int]:
        """Return of each cell the number of the next one that is no part of it."""
        after = [k + 1 for k in range(len(self.spans))]
        for k in reversed(range(len(after))):
            if not self.is_leaf[k]:  # it ends where its second half does
                after[k] = after[after[k + 1]]
        return after

    def holding(self, q: Point) -> set[int]:
        """Return all open leaves that hold a configuration."""
        places = [self.units(q, j) for j in self.free]
        placed = [x % turn if turn else x for x, turn in zip(places, self.turns, strict=True)]
        return {*self.touching(tuple((x, x) for x in placed))}

    def touching(self, span: Span) -> Iterator[int]:
        """Yield the open leaves that share a place with a span, over the seams as well."""
        seams = [(0, -turn, turn) if turn else (0,) for turn in self.turns]
        for shifts in itertools.product(*seams):
            moved = [
                (low + shift - error, high + shift + error)
                for (low, high), shift, error in zip(span, shifts, self.errors, strict=True)
            ]
            k, count = 0, 0
            while k < len(self.spans):
                count += 1
                pairs = zip(self.spans[k], moved, strict=True)
                apart = any(b < low or high < a for (a, b), (low, high) in pairs)
                if self.is_open[k] and not apart:
                    yield k
                k = self.after[k] if apart else k + 1
            spend(count // VISITS)

    def reached(self, first: Iterable[int]) -> set[int]:
        """Return all open leaves that a chain of touching ones leads to."""
        found, todo = {*first}, [*first]
        while todo:
            near = {*self.touching(self.spans[todo.pop()])} - found
            found |= near
            todo += near
        return found


# --- the answer -----------------------------------------------------------------------------------


class Answer(NamedTuple):
    """What a certificate shows: that its statement is refuted, else that it is proved."""

    refuted: bool
    said: str


def digest(text: str) -> str:
    """Return the hash of a robot file's text."""
    return hashlib.sha256(text.encode()).hexdigest()


def check(text: str | bytes, pin: str | None = None) -> Answer:
    """Return what a certificate shows, and what is to be said of it.

    Parameters
    ----------
    text : str or bytes
        The certificate.
    pin : str, optional
        The SHA-256 of the robot file that it must be about.

    Raises
    ------
    Refused
        If it shows nothing: a `ValueError` that names what is wrong and where.
    """
    Ball.work = 0
    phase_of.cache_clear()  # so that the work does not depend on what was checked before
    demand(
        pin is None or re.fullmatch("[0-9a-f]{64}", pin), "the pin is no hash of 64 digits 0-9a-f"
    )
    content = read_json(text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text)
    grammar, refuted = _read_heading(content)
    robot_text = text_of(content["robot"], "robot", MAX_ROBOT)
    demand(not re.search("[\ud800-\udfff]", robot_text), "robot: half a character")
    sha256 = digest(robot_text)
    demand(content["sha256"] == sha256, f"sha256: the hash of the robot is {sha256}")
    demand(pin in (None, sha256), f"it is about another robot: its sha256 is {sha256}")
    robot = read_robot(robot_text)
    bodies = any(boundary.bodies for boundary in robot.boundaries)
    demand(grammar >= 3 or not bodies, "schema: of a robot with pairs of bodies 3 is wanted")
    statement = read_statement(content["statement"], grammar, len(robot.joints))
    _check_angles(robot, statement)
    if grammar == 4:
        blocked = verify_no_path(robot, statement, content["proof"])
        found = no_path_of(robot, statement, blocked)
    elif grammar == 5:
        found = disconnected_of(
            robot, statement, verify_disconnected(robot, statement, content["proof"])
        )
    else:
        found = _verified(robot, statement, content, refuted=refuted)
    pinned = "the robot that was asked for" if pin else "compared with no robot file"
    heading = f"robot {robot.name!a}, sha256 {sha256}, {pinned}"
    lines = [heading, found, *described(robot, statement)]
    return Answer(refuted, "\n".join(lines))


def _verified(robot: Robot, statement: Statement, content: Table, *, refuted: bool) -> str:
    """Verify the proof or the witness of a set, and say what it shows."""
    proving = Proving(robot, content.get("parts", {}), statement.margin)
    if refuted:
        name = text_of(content["boundary"], "boundary", 1_000)
        q = read_witness(content, statement, len(robot.joints))
        verify_witness(proving, name, q, content.get("places"))
        return refutation(robot, statement, name, q)
    verify_proof(proving, statement, content["proof"])
    return proof_of(robot, statement)


def _read_heading(content: Any) -> tuple[int, bool]:
    """Return the number of the grammar, and whether the file refutes; verify its keys."""
    demand(type(content) is dict, "the file is no JSON object")
    schema = text_of(content.get("schema"), "schema", 100)
    known = re.fullmatch("qbound/certificate/([1-5])", schema, re.ASCII)
    demand(known, "schema: qbound/certificate/1, 2, 3, 4 or 5 is wanted")
    grammar = int(schema[-1])
    verdicts = ("proved", "refuted") if grammar < 4 else ("proved",)
    refuted = one_of(content.get("verdict"), "verdict", verdicts) == "refuted"
    statement = content.get("statement")
    box = type(statement) is dict and statement.get("set") == "box"
    witness = ("at",) if grammar > 1 and box else ("cell", "weights")
    evidence = ("boundary", *witness) if refuted else ("proof",)
    evidence += ("parts",) if grammar == 3 else ()
    optional = ("places",) if grammar == 3 and refuted else ()
    keys = ("schema", "verdict", "statement", "robot", "sha256", *evidence)
    table_of(content, "the file", keys, optional)
    return grammar, refuted


def _check_angles(robot: Robot, statement: Statement) -> None:
    largest = LARGEST_ANGLE[robot.angle_unit]
    turning = [j for j, joint in enumerate(robot.joints) if joint.turns]
    within = all(abs(q[j]) <= largest for loop in statement.loops for q in loop for j in turning)
    demand(within, f"statement: an angle of more than {largest} {robot.angle_unit}")


def proof_of(robot: Robot, statement: Statement) -> str:
    """Say what was proved of the set."""
    names = ", ".join(ascii(boundary.name) for boundary in robot.boundaries)
    limited = ", ".join(ascii(joint.name) for joint in robot.joints if joint.limits)
    margin = f"{written(statement.margin)} {robot.length_unit}"
    kept = [f"{names}, each with a margin of {margin}"] if names else []
    kept += [f"the limits of {limited}"] if limited else []
    if not kept:
        return "proved: nothing was to be kept; the robot has no boundary in use and no limit"
    return f"proved: every configuration of the set keeps {', and '.join(kept)}"


def no_path_of(robot: Robot, statement: Statement, blocked: Sequence[Blocked]) -> str:
    """Say between which configurations there is no path, and which joint cannot pass what."""
    j = blocked[0].joint
    unit = robot.unit(j)
    ranges = " nor ".join(
        f"from {written(b.low)} {unit} to {written(b.high)} {unit}, where {b.boundary.name!a} is"
        " violated whatever the other joints are within their limits"
        for b in blocked
    )
    said = _no_path_keeps(robot, statement)
    return f"{said}: {robot.joints[j].name!a} cannot pass {ranges}"


def disconnected_of(robot: Robot, statement: Statement, proof: Disconnected) -> str:
    """Say between which configurations there is no path, and what is violated between them."""
    names = " or ".join(sorted({ascii(boundary.name) for boundary in proof.boundaries}))
    boxes = f"one of the boxes ({proof.leaves}) all over which {names} is violated"
    return f"{_no_path_keeps(robot, statement)}: each meets {boxes}"


def _no_path_keeps(robot: Robot, statement: Statement) -> str:
    [[start, goal]] = statement.loops
    ends, margin = f"from {_point(start)} to {_point(goal)}", written(statement.margin)
    values = statement.held.items()
    held = [f"{robot.joints[j].name!a} = {written(x)} {robot.unit(j)}" for j, x in values]
    still = f" along which {', '.join(held)}" if held else ""
    keeps = f"keeps every boundary with a margin of {margin} {robot.length_unit} and all limits"
    return f"proved: no path {ends}{still} {keeps}"


def refutation(robot: Robot, statement: Statement, name: str, q: Point) -> str:
    """Say where the set was refuted."""
    margin = f" with a margin of {written(statement.margin)} {robot.length_unit}"
    asked = "" if name in robot.beyond(q) else margin
    return f"refuted: {name!a}{asked} is violated at {_values(robot, q)}, which is in the set"


MOST_SHOWN = 50
"""Configurations that are printed; of larger sets their hash is, and what else names them."""


def described(robot: Robot, statement: Statement) -> list[str]:
    """Describe the set by the numbers that were verified."""
    names = ", ".join(f"{joint.name!a} in {robot.unit(j)}" for j, joint in enumerate(robot.joints))
    if not statement.cells:
        return [f"configurations: ({names})"]
    lines = [f"set: {statement.kind} in ({names})"]
    printed = [" ".join(map(_point, loop)) for loop in statement.loops]
    if sum(map(len, statement.loops)) <= MOST_SHOWN:
        sorts = _sorts(statement)
        lines += [f"{sort}: {said}" for sort, said in zip(sorts, printed, strict=True)]
    else:
        lines += _summary(robot, statement, printed)
    around = [robot.joints[j].name for j in goes_round(robot, statement)]
    return lines + [f"takes every angle of {name!a}" for name in around]


def _sorts(statement: Statement) -> list[str]:
    """Return what each list of configurations is: a hole of a polygon goes round clockwise."""
    if statement.kind != "polygon":
        return [{"box": "corners", "path": "path"}[statement.kind]] * len(statement.loops)
    points = [q for loop in statement.loops for q in loop]
    x, y = (j for j, column in enumerate(zip(*points, strict=True)) if len({*column}) > 1)
    turns = [
        sum(p[x] * q[y] - q[x] * p[y] for p, q in zip(loop, [*loop[1:], loop[0]], strict=True))
        for loop in statement.loops
    ]
    return ["outline" if turn > 0 else "hole" for turn in turns]


def _summary(robot: Robot, statement: Statement, printed: Sequence[str]) -> Iterator[str]:
    """Describe a set that is too long to print: ranges, which are not the set, and its hash."""
    points = [q for loop in statement.loops for q in loop]
    for j, (joint, column) in enumerate(zip(robot.joints, zip(*points, strict=True), strict=True)):
        low, high = written(min(column)), written(max(column))
        yield f"{joint.name!a} is between {low} and {high} {robot.unit(j)} in the set"
    if statement.kind == "path":
        for loop in statement.loops:
            yield f"path from {_point(loop[0])} to {_point(loop[-1])}"
    yield (
        f"its {len(points)} configurations, in {len(statement.loops)} list(s), are in the"
        f" certificate; sha256 of their text {digest(chr(10).join(printed))}"
    )


def _point(q: Point) -> str:
    return f"({', '.join(map(written, q))})"


def _values(robot: Robot, q: Point) -> str:
    values = enumerate(zip(robot.joints, q, strict=True))
    return ", ".join(f"{joint.name!a} = {written(x)} {robot.unit(j)}" for j, (joint, x) in values)


def goes_round(robot: Robot, statement: Statement) -> list[int]:
    """Return the joints of which the set takes all values of a turn or more."""
    turn = Fraction(360) if robot.angle_unit == "deg" else 2 * PI + Fraction(1, 10**70)
    return [
        j
        for j, joint in enumerate(robot.joints)
        if joint.turns and _longest(statement.cells, j) >= turn
    ]


def _longest(cells: Iterable[Cell], j: int) -> Fraction:
    """Return the length of the longest range of a joint that the cells take without a gap."""
    ranges = sorted(
        (min(q[j] for q in cell.corners), max(q[j] for q in cell.corners)) for cell in cells
    )
    (start, end), longest = ranges[0], Fraction(0)
    for low, high in ranges:
        start, end = (start, max(end, high)) if low <= end else (low, high)
        longest = max(longest, end - start)
    return longest


def written(x: Fraction) -> str:
    """Write a decimal with all its digits."""
    digits = 0
    while x.denominator != 1:
        x, digits = x * 10, digits + 1
    whole = str(abs(int(x))).rjust(digits + 1, "0")
    point = len(whole) - digits
    return "-" * (x < 0) + whole[:point] + ("." + whole[point:] if digits else "")


# --- the command ----------------------------------------------------------------------------------


PROVED, REFUTED, NO_ANSWER = 0, 3, 2
"""Exit statuses; not 1, which a Python that cannot run this file ends with."""


def main(arguments: Sequence[str]) -> int:
    """Check a file, print the answer, and return the exit status."""
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
        pin = _pin(arguments)
        answer = check(_read_file(arguments[0]), pin)
        return (REFUTED if answer.refuted else PROVED), answer.said
    except Refused as error:
        reason = str(error)
    except MemoryError:
        reason = "the file needs more memory than there is"
    except Exception:  # whatever a hostile file sets off
        pass
    return NO_ANSWER, f"not proved: {reason}"


USAGE = "usage: python -I check.py CERTIFICATE [ROBOT_FILE | --sha256 HASH]"


def _pin(arguments: Sequence[str]) -> str | None:
    """Return the hash that the robot must have, or None where any robot will do."""
    demand(arguments and "" not in arguments, f"an empty or missing argument; {USAGE}")
    if len(arguments) == 1:
        demand(not arguments[0].startswith("--"), USAGE)
        return None
    if arguments[1] == "--sha256":
        demand(len(arguments) > 2, f"a pin without a value; {USAGE}")
        demand(len(arguments) == 3, USAGE)
        return arguments[2]
    demand(len(arguments) == 2 and not arguments[1].startswith("--"), USAGE)
    text = _decoded(arguments[1])
    return digest(text)


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
        _silence()
        return False
    return True


def _silence() -> None:
    """Leave nothing for Python to complain about when it closes a broken output."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (OSError, ValueError, AttributeError):
        sys.stdout = None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
