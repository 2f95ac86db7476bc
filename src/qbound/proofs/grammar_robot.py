"""What does the robot inside a certificate say? Read strictly, for the checker in ball arithmetic.

The grammar is the book's page "The certificate". The text is looked at mark by mark before TOML is
read, so that no key or nesting can cost much; then every table is compared with what is allowed.
Numbers are exact rationals.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from qbound.proofs.grammar_values import items, keys, refuse, shown, text_of

MOST_CHARACTERS = 500_000
MOST_JOINTS = 6
MOST_ROWS = 2_000
MOST_CORNERS = 1_000
MOST_TURNS = 100
LONGEST_STRING = 300
LONGEST_WORD = 100
LONGEST_LABEL = 200
DEEPEST = 8

PLACES_OF_PI = (
    "14159265358979323846264338327950288419716939937510582097494459230781640628620899"
    "86280348253421170679821480865132823066470938446095505822317253594081284811174502"
    "84102701938521105559644622948954930381964428810975665933446128475648233786783165"
)
"""More than two limits have, of words of 100 characters: so it parts them as pi itself does."""

LARGEST_NUMBER = 10**100
LARGEST_DIRECTION = 10**308
PI = Fraction(f"3.{PLACES_OF_PI}")
TURN = {True: Fraction(360), False: 2 * PI}
LARGEST_ANGLE = {True: 1800, False: 30}
"""By whether angles are in degrees."""

TOKEN = re.compile(
    r"""(?P<blank>[ \t\r]+|\#[^\n]*)"""
    r"""|(?P<string>"(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""
    r"""|(?P<mark>[=,\[\]{}\n])"""
    r"""|(?P<word>[^ \t\r\n"'\#=,\[\]{}]+)"""
)
FLOAT = re.compile(r"[+-]?[0-9]+([.][0-9]+)?([eE][+-]?[0-9]{1,3})?")

Vector = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint: what it stands on, where, and what it does; numbers in the file's units."""

    name: str
    turns: bool
    origin: Vector
    rpy: Vector
    axis: Vector
    limits: tuple[Fraction, Fraction] | None


@dataclass(frozen=True, eq=False)
class Place:
    """A point fixed in a frame; frame 0 is the base, frame j is moved by joint j - 1."""

    name: str
    frame: int
    at: Vector
    radius: Fraction


@dataclass(frozen=True, eq=False)
class Body:
    """A core in a frame, by places of two or three numbers, with a radius.

    One place is a disc, two are a capsule, three or more an outline in order.
    """

    name: str
    frame: int
    places: tuple[tuple[Fraction, ...], ...]
    radius: Fraction


@dataclass(frozen=True, eq=False)
class Boundary:
    """A pair of points or bodies (no normal), or a half-space of one point or body.

    `least` is what is asked for, radii included, without the margin.
    """

    name: str
    used: bool
    places: tuple[Place, ...]
    normal: Vector | None
    least: Fraction
    bodies: tuple[Body, ...] = ()

    @property
    def apart(self) -> bool:
        """Tell whether it keeps two bodies apart."""
        return len(self.bodies) == 2


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot file as far as a certificate is about it."""

    name: str
    degrees: bool
    joints: tuple[Joint, ...]
    boundaries: tuple[Boundary, ...]


def read_robot(text: str) -> Robot:
    """Read the text of a robot file, and refuse whatever the grammar does not list."""
    if len(text) > MOST_CHARACTERS:
        refuse(f"robot: more than {MOST_CHARACTERS} characters")
    _check_marks(text)
    try:
        table = tomllib.loads(text, parse_float=_float)
    except tomllib.TOMLDecodeError as error:
        refuse(f"robot: no TOML: {shown(str(error))}")
    wanted = ("schema", "name", "tool", "length_unit", "angle_unit", "home", "joint", "point")
    others = ("boundary", "body", "obstacle", "collisions", "clearance", "allowed")
    keys(table, "robot", wanted, others)
    if type(table["schema"]) is not int or table["schema"] != 1:
        refuse("robot: the schema is not 1")
    _one_of(table["length_unit"], "length_unit", ("m", "cm", "mm"))
    degrees = _one_of(table["angle_unit"], "angle_unit", ("deg", "rad")) == "deg"
    frames, joints = _joints(table["joint"], degrees)
    places = _places(table["point"], frames)
    bodies = _bodies(table, frames)
    boundaries = _boundaries(table.get("boundary", []), places, bodies)
    boundaries += _between_bodies(table, bodies, boundaries)
    _check_names(table, frames, joints, places, boundaries)
    return Robot(_label(table["name"], "name"), degrees, joints, boundaries)


# --- marks ----------------------------------------------------------------------------------------


def _check_marks(text: str) -> None:
    """Refuse what may cost a reader of TOML much: long and dotted keys, deep nesting."""
    depth, end, before = 0, 0, [""]
    for token in TOKEN.finditer(text):
        if token.start() != end:
            break
        end, kind, found = token.end(), token.lastgroup, token.group()
        if kind == "mark":
            depth += (found in "[{") - (found in "]}")
            if found == "=" and before[-1][:1] not in ('"', "'") and "." in before[-1]:
                refuse(f"robot: the key {shown(before[-1])} has a dot")
            before = [""]
        elif kind != "blank":
            before.append(found)
            _check_item(found, kind == "string")
        if not 0 <= depth <= DEEPEST or len(before) > 2:
            line = text.count("\n", 0, token.start()) + 1
            refuse(f"robot: line {line} has more than the grammar allows")
    if end != len(text):
        line = text.count("\n", 0, end) + 1
        refuse(f"robot: a string in line {line} does not end there")


def _check_item(found: str, string: bool) -> None:
    """Refuse a string or a word that is too long, or a word of several dots."""
    if string and len(found) > LONGEST_STRING + 2:
        refuse(f"robot: a string of more than {LONGEST_STRING} characters")
    if not string and (len(found) > LONGEST_WORD or found.count(".") > 1):
        refuse(f"robot: {shown(found)} is too long, or has several dots")


# --- values ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Float:
    """A float as a rational, which no string can pretend to be."""

    value: Fraction


def _float(text: str) -> _Float:
    """Read a float of TOML exactly."""
    plain = text.replace("_", "")
    if not FLOAT.fullmatch(plain):
        refuse(f"robot: {shown(text)} is no number with an exponent of three digits at most")
    return _Float(Fraction(plain))


def _number(value: Any, where: str, largest: int = LARGEST_NUMBER) -> Fraction:
    if type(value) is not int and not isinstance(value, _Float):
        refuse(f"robot: {where}: {shown(value)} is no number")
    number = Fraction(value) if isinstance(value, int) else value.value
    if abs(number) > largest:
        refuse(f"robot: {where}: a number is too large")
    return number


def _label(value: Any, where: str) -> str:
    label = text_of(value, f"robot: {where}")
    if not 1 <= len(label) <= LONGEST_LABEL:
        refuse(f"robot: {where}: a name of 1 to {LONGEST_LABEL} characters is wanted")
    return label


def _one_of(value: Any, where: str, allowed: Sequence[str]) -> str:
    if not isinstance(value, str) or value not in allowed:
        refuse(f"robot: {where}: {shown(value)} is none of {', '.join(allowed)}")
    return value


def _vector(value: Any, where: str, largest: int = LARGEST_NUMBER) -> Vector:
    x, y, z = (_number(entry, where, largest) for entry in items(value, f"robot: {where}", 3, 3))
    return x, y, z


def _direction(value: Any, where: str) -> Vector:
    vector = _vector(value, where, LARGEST_DIRECTION)
    if not any(vector):
        refuse(f"robot: {where}: a direction of three zeros")
    return vector


def _not_negative(value: Any, where: str) -> Fraction:
    number = _number(value, where)
    if number < 0:
        refuse(f"robot: {where} is negative")
    return number


# --- tables ---------------------------------------------------------------------------------------


def _joints(rows: Any, degrees: bool) -> tuple[list[str], tuple[Joint, ...]]:
    """Return the frames, base first, and the joints between them."""
    rows = items(rows, "robot: joint", 1, MOST_JOINTS)
    joints = tuple(_joint(row, degrees) for row in rows)
    parents, frames = ([_label(row[key], key) for row in rows] for key in ("parent", "frame"))
    frames = [parents[0], *frames]
    if parents != frames[:-1]:
        refuse("robot: the joints are no chain")
    return frames, joints


def _joint(row: Any, degrees: bool) -> Joint:
    wanted = ("name", "type", "parent", "frame", "origin", "axis")
    if isinstance(row, dict) and row.get("type") == "parallelogram":
        refuse("robot: a joint is a parallelogram; certificates know revolute and prismatic ones")
    keys(row, "robot: joint", wanted, ("rpy", "limits", "velocity"))
    name = _label(row["name"], "joint name")
    turns = _one_of(row["type"], f"type of {shown(name)}", ("revolute", "prismatic")) == "revolute"
    rpy = _vector(row.get("rpy", [0, 0, 0]), "rpy")
    if any(abs(angle) > LARGEST_ANGLE[degrees] for angle in rpy):
        refuse("robot: rpy: an angle is too large")
    if "velocity" in row and not _number(row["velocity"], "velocity") > 0:
        refuse("robot: a velocity is not positive")
    limits = _limits(row["limits"], turns, degrees) if "limits" in row else None
    if limits is None and not turns:
        refuse(f"robot: {shown(name)} slides without limits")
    origin, axis = _vector(row["origin"], "origin"), _direction(row["axis"], "axis")
    return Joint(name, turns, origin, rpy, axis, limits)


def _limits(value: Any, turns: bool, degrees: bool) -> tuple[Fraction, Fraction]:
    low, high = (_number(end, "limits") for end in items(value, "robot: limits", 2, 2))
    if not low < high:
        refuse("robot: limits: the first is not less than the second")
    if turns and high - low > MOST_TURNS * TURN[degrees]:
        refuse("robot: limits: too many turns apart")
    return low, high


def _places(rows: Any, frames: Sequence[str]) -> tuple[Place, ...]:
    found = []
    for row in items(rows, "robot: point", 1, MOST_ROWS):
        keys(row, "robot: point", ("name", "frame", "at"), ("radius",))
        found.append(
            Place(
                _label(row["name"], "point name"),
                _frame(row["frame"], frames),
                _vector(row["at"], "at"),
                _not_negative(row.get("radius", 0), "radius"),
            )
        )
    return tuple(found)


def _frame(value: Any, frames: Sequence[str]) -> int:
    name = _label(value, "frame")
    if name not in frames:
        refuse(f"robot: there is no frame {shown(name)}")
    return frames.index(name)


def _boundaries(rows: Any, places: Sequence[Place], bodies: Sequence[Body]) -> tuple[Boundary, ...]:
    points = {place.name: place for place in places}
    named = {body.name: body for body in bodies}
    rows = items(rows, "robot: boundary", 0, MOST_ROWS)
    return tuple(_boundary(row, points, named) for row in rows)


def _boundary(row: Any, points: dict[str, Place], bodies: dict[str, Body]) -> Boundary:
    kind = row.get("type") if isinstance(row, dict) else None
    kind = _one_of(kind, "type of a boundary", ("pair", "half-space", "bodies"))
    if kind == "half-space":
        which = "body" if "body" in row else "point"
        keys(row, "robot: boundary", ("name", "type", which, "normal", "offset"), ("used",))
        labels = [row[which]]
    else:
        which = "points" if kind == "pair" else "bodies"
        keys(row, "robot: boundary", ("name", "type", which), ("used", "clearance"))
        labels = items(row[which], f"robot: {which}", 2, 2)
    name, used = _label(row["name"], "boundary name"), row.get("used", True)
    if not isinstance(used, bool):
        refuse(f"robot: {shown(name)}: used is neither true nor false")
    labels = [_label(label, which) for label in labels]
    known: dict[str, Any] = points if which in ("point", "points") else bodies
    if len(set(labels)) != len(labels) or not set(labels) <= set(known):
        refuse(f"robot: {shown(name)} is not about different {which} of the robot")
    ends = tuple(known[label] for label in labels)
    if kind == "bodies" and ends[0].frame == ends[1].frame:
        refuse(f"robot: {shown(name)}: two bodies of one frame")
    normal = _direction(row["normal"], "normal") if kind == "half-space" else None
    own = (
        _number(row["offset"], "offset")
        if kind == "half-space"
        else _not_negative(row.get("clearance", 0), "clearance")
    )
    least = sum((end.radius for end in ends), own)
    if known is points:
        return Boundary(name, used, ends, normal, least)
    return Boundary(name, used, (), normal, least, ends)


# --- bodies ---------------------------------------------------------------------------------------


def _bodies(table: dict[str, Any], frames: Sequence[str]) -> tuple[Body, ...]:
    """Return the bodies of links, inner ones first, and then the obstacles."""
    found: list[tuple[bool, Body]] = []
    for kind, own in (("body", ("frame",)), ("obstacle", ())):
        for row in items(table.get(kind, []), f"robot: {kind}", 0, MOST_ROWS):
            keys(row, f"robot: {kind}", own, ("name", "polygon", "capsule", "disc"))
            frame = _frame(row["frame"], frames) if own else 0
            number = 1 + sum(body.frame == frame for _, body in found)
            usual = f"{frames[frame]}/{number}" if number > 1 else frames[frame]
            name = _label(row["name"], "body name") if "name" in row else usual
            found.append((not own, Body(name, frame, *_shape(row, name))))
    found.sort(key=lambda row: (row[0], row[1].frame))
    bodies = tuple(body for _, body in found)
    if len({body.name for body in bodies}) != len(bodies):
        refuse("robot: a name is given to two bodies")
    return bodies


def _shape(row: dict[str, Any], name: str) -> tuple[tuple[tuple[Fraction, ...], ...], Fraction]:
    """Return the places of a core, and the radius."""
    kinds = [kind for kind in ("polygon", "capsule", "disc") if kind in row]
    if len(kinds) != 1:
        refuse(f"robot: {shown(name)} has {len(kinds)} shapes, wanted one")
    value = row[kinds[0]]
    if kinds == ["polygon"]:
        corners = items(value, "robot: polygon", 3, MOST_CORNERS)
        return tuple(_corner(corner) for corner in corners), Fraction(0)
    ends = ("from", "to") if kinds == ["capsule"] else ("at",)
    keys(value, f"robot: {kinds[0]}", (*ends, "radius"))
    places = tuple(_corner(value[end]) for end in ends)
    return places, _not_negative(value["radius"], "radius")


def _corner(value: Any) -> tuple[Fraction, ...]:
    numbers = items(value, "robot: a place of a body", 2, 3)
    return tuple(_number(x, "a place of a body") for x in numbers)


def _between_bodies(
    table: dict[str, Any], bodies: Sequence[Body], boundaries: Sequence[Boundary]
) -> tuple[Boundary, ...]:
    """Return the pairs that `collisions` asks for, the body nearer to the base first."""
    clearance = _not_negative(table.get("clearance", 0), "clearance")
    names = {body.name for body in bodies}
    settled = [{body.name for body in b.bodies} for b in boundaries if b.apart]
    for row in items(table.get("allowed", []), "robot: allowed", 0, MOST_ROWS):
        pair = {_label(name, "allowed") for name in items(row, "robot: allowed", 2, 2)}
        if len(pair) != 2 or not pair <= names:
            refuse("robot: allowed: two different bodies are wanted")
        settled.append(pair)
    if "collisions" not in table:
        return ()
    _one_of(table["collisions"], "collisions", ("all",))
    done, found, count = {frozenset(pair) for pair in settled}, [], 0
    for k, one in enumerate(bodies):
        for other in bodies[k + 1 :]:
            count += one.frame != other.frame
            if count > MOST_ROWS:
                refuse(f"robot: more than {MOST_ROWS} pairs of bodies")
            if one.frame != other.frame and frozenset((one.name, other.name)) not in done:
                least = clearance + one.radius + other.radius
                name = f"{one.name}, {other.name}"
                found.append(Boundary(name, True, (), None, least, (one, other)))
    return tuple(found)


def _check_names(
    table: dict[str, Any],
    frames: Sequence[str],
    joints: Sequence[Joint],
    places: Sequence[Place],
    boundaries: Sequence[Boundary],
) -> None:
    """Refuse names that stand for two things, a home without a joint, a tool that is no point."""
    for rows in (joints, places, boundaries):
        names = [row.name for row in rows]
        if len(set(names)) != len(names):
            refuse("robot: a name is given twice")
    points = {place.name for place in places}
    ends = {f"{joint.name}.{side}" for joint in joints for side in ("lower", "upper")}
    if len(set(frames)) != len(frames) or points & set(frames):
        refuse("robot: two frames, or a point and a frame, have one name")
    if ends & {boundary.name for boundary in boundaries}:
        refuse("robot: a boundary has the name of a limit")
    if _label(table["tool"], "tool") not in points:
        refuse("robot: the tool is no point")
    home = table["home"]
    keys(home, "robot: home", [joint.name for joint in joints])
    for value in home.values():
        _number(value, "home")
