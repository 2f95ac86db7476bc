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
class Boundary:
    """A pair of points (no normal) or a half-space of one point; `least` is without the margin."""

    name: str
    used: bool
    places: tuple[Place, ...]
    normal: Vector | None
    least: Fraction


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
    keys(table, "robot", wanted, ("boundary", "body"))
    if type(table["schema"]) is not int or table["schema"] != 1:
        refuse("robot: the schema is not 1")
    _one_of(table["length_unit"], "length_unit", ("m", "cm", "mm"))
    degrees = _one_of(table["angle_unit"], "angle_unit", ("deg", "rad")) == "deg"
    frames, joints = _joints(table["joint"], degrees)
    places = _places(table["point"], frames)
    boundaries = _boundaries(table.get("boundary", []), places)
    _check_names(table, frames, joints, places, boundaries)
    for row in items(table.get("body", []), "body", 0, MOST_ROWS):
        _check_body(row, frames)
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


def _boundaries(rows: Any, places: Sequence[Place]) -> tuple[Boundary, ...]:
    known = {place.name: place for place in places}
    return tuple(_boundary(row, known) for row in items(rows, "robot: boundary", 0, MOST_ROWS))


def _boundary(row: Any, known: dict[str, Place]) -> Boundary:
    kind = row.get("type") if isinstance(row, dict) else None
    pair = _one_of(kind, "type of a boundary", ("pair", "half-space")) == "pair"
    own = (("points",), ("clearance",)) if pair else (("point", "normal", "offset"), ())
    keys(row, "robot: boundary", ("name", "type", *own[0]), ("used", *own[1]))
    name, used = _label(row["name"], "boundary name"), row.get("used", True)
    if not isinstance(used, bool):
        refuse(f"robot: {shown(name)}: used is neither true nor false")
    names = items(row["points"], "robot: points", 2, 2) if pair else [row["point"]]
    labels = [_label(label, "point") for label in names]
    if len(set(labels)) != len(labels) or not set(labels) <= set(known):
        refuse(f"robot: {shown(name)} is not between points of the robot")
    ends = tuple(known[label] for label in labels)
    normal = None if pair else _direction(row["normal"], "normal")
    own_least = (
        _not_negative(row.get("clearance", 0), "clearance")
        if pair
        else _number(row["offset"], "offset")
    )
    return Boundary(name, used, ends, normal, sum((end.radius for end in ends), own_least))


def _check_body(row: Any, frames: Sequence[str]) -> None:
    keys(row, "robot: body", ("frame", "polygon"))
    _frame(row["frame"], frames)
    for corner in items(row["polygon"], "robot: polygon", 3, MOST_CORNERS):
        for x in items(corner, "robot: polygon", 2, 2):
            _number(x, "polygon")


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
