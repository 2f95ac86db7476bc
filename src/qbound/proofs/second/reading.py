"""A strict reader of certificates: all keys are known, counts bounded, numbers exact."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from flint import fmpq

SCHEMA = "qbound/certificate/6"
NO_PATH = "no path"

MOST_BYTES = 4_000_000
MOST_POINTS = 20_000
MOST_DIGITS = 40
LARGEST = fmpq(10) ** 100
"""Numbers are 0, or as large as this or its inverse, or between them."""

LARGEST_ANGLE = {"deg": 1800, "rad": 30}

MOST_WORK = 12_000_000
"""About the microseconds that a check may take; counted before they are spent."""

DECIMAL = re.compile(r"(-?)([0-9]+)(?:[.]([0-9]+))?(?:[eE]([+-]?[0-9]{1,3}))?")
INTEGER = re.compile(r"-?[0-9]{1,9}")

Point = tuple[Any, ...]
"""A configuration: one rational for each joint, in the units of the robot file."""


class Work:
    """The work of a check so far; the check stops when the work becomes too much."""

    def __init__(self) -> None:
        self.done = 0

    def add(self, count: int) -> None:
        """Count work that is about to be done."""
        self.done += count
        demand(self.done <= MOST_WORK, "the file asks for too much work")


# --- values ---------------------------------------------------------------------------------------


def refuse(why: str) -> NoReturn:
    """Raise a ValueError with a sentence why a file is refused."""
    raise ValueError(why)


def demand(condition: object, why: str) -> None:
    """Refuse a file unless a condition holds."""
    if not condition:
        refuse(why)


def shown(value: Any) -> str:
    """Write a value short and in ASCII."""
    return ascii(value[:60]) if isinstance(value, str) else f"a {type(value).__name__}"


def table_of(
    value: Any, where: str, wanted: Sequence[str], allowed: Sequence[str] = ()
) -> dict[str, Any]:
    """Return a table after checking that it has all required keys and no unknown ones."""
    if not isinstance(value, dict):
        refuse(f"{where}: {shown(value)} is not a table")
    for key in wanted:
        demand(key in value, f"{where}: the key {key!r} is missing")
    for key in value:
        demand(key in wanted or key in allowed, f"{where}: {shown(key)} is not a key of it")
    return value


def items(value: Any, where: str, fewest: int, most: int) -> list[Any]:
    """Return a list after checking that it has neither too few entries nor too many."""
    if not isinstance(value, list):
        refuse(f"{where}: {shown(value)} is not a list")
    demand(fewest <= len(value) <= most, f"{where}: a list of {len(value)} is too short or long")
    return value


def text_of(value: Any, where: str, most: int) -> str:
    """Return a text of bounded length, in whole characters."""
    if not isinstance(value, str):
        refuse(f"{where}: {shown(value)} is not a text")
    demand(len(value) <= most, f"{where}: more than {most} characters")
    demand(not re.search("[\ud800-\udfff]", value), f"{where}: half a character")
    return value


def index(value: Any, where: str, size: int) -> int:
    """Return an index of one of `size` things."""
    if type(value) is not int or not 0 <= value < size:
        refuse(f"{where}: not an index of one of {size}")
    return value


def decimal(value: Any, where: str) -> Any:
    """Return a decimal of the file, a string, as a rational."""
    found = DECIMAL.fullmatch(value) if isinstance(value, str) and len(value) <= 60 else None
    digits = len(found[2] + (found[3] or "")) if found else 0
    demand(0 < digits <= MOST_DIGITS, f"{where}: {shown(value)} is not a decimal")
    number = exact(value, where)
    demand(number == 0 or 1 / LARGEST <= abs(number) <= LARGEST, f"{where}: a number out of range")
    return number


def exact(text: str, where: str = "a number") -> Any:
    """Return a decimal of any size as a rational."""
    found = DECIMAL.fullmatch(text)
    if found is None:
        refuse(f"{where}: {shown(text)} is not a decimal")
    sign, whole, places, exponent = found.groups("")
    return fmpq(int(sign + whole + places)) * fmpq(10) ** (int(exponent or 0) - len(places))


# --- JSON -----------------------------------------------------------------------------------------


def read_json(text: str | bytes) -> Any:
    """Read JSON in which every key stands once and every number is a short integer."""
    try:
        whole = text.encode() if isinstance(text, str) else text
        plain = whole.decode() if len(whole) <= MOST_BYTES else ""
    except UnicodeError:
        refuse("the file is not UTF-8")
    demand(len(whole) <= MOST_BYTES, f"the file has more than {MOST_BYTES} bytes")
    try:
        return json.loads(
            plain,
            object_pairs_hook=_unique,
            parse_int=_integer,
            parse_float=_no_number,
            parse_constant=_no_number,
        )
    except json.JSONDecodeError as error:
        refuse(f"the file is not JSON: {error}")
    except RecursionError:
        refuse("the file is nested too deeply")


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    demand(len(found) == len(pairs), "a key stands twice")
    return found


def _integer(text: str) -> int:
    demand(INTEGER.fullmatch(text), f"{shown(text)} is too long for an integer of the file")
    return int(text)


def _no_number(text: str) -> NoReturn:
    refuse(f"{shown(text)}: numbers stand in quotes")


# --- the claim ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Claim:
    """A set of configurations, or the ends of a path, and the margin.

    Attributes
    ----------
    kind : str
        "box", "path", "polygon" or "no path".
    margin : fmpq
    lists : list of list of Point
        Low and high corner of a box; lists of a path; loops of a polygon; start and goal.
    triangles : list of list of int
    joints : list of str
        For claims of no path: "moves", "held" or "any" for each joint.
    """

    kind: str
    margin: Any
    lists: list[list[Point]]
    triangles: list[list[int]]
    joints: list[str]

    @property
    def points(self) -> list[Point]:
        """All configurations, one list after the other."""
        return [point for points in self.lists for point in points]


def read_claim(value: Any, form: dict[str, Any]) -> Claim:
    """Read a claim about a robot in its normal form."""
    kind = value.get("set") if isinstance(value, dict) else None
    others = {"box": [], "path": [], "polygon": ["triangles"], NO_PATH: ["joints"]}
    if not isinstance(kind, str) or kind not in others:
        refuse(f"claim: the set {shown(kind)} is not a box, a path, a polygon or {NO_PATH!r}")
    table = table_of(value, "claim", ("set", "margin", "points", *others[kind]))
    margin = decimal(table["margin"], "margin")
    demand(margin >= 0, "margin: it is negative")
    fewest, most = {"path": (2, MOST_POINTS), "polygon": (3, MOST_POINTS)}.get(kind, (2, 2))
    rows = items(table["points"], "points", 1, 1 if most == 2 else MOST_POINTS)
    count = sum(len(items(row, "points", fewest, most)) for row in rows)
    demand(count <= MOST_POINTS, f"points: more than {MOST_POINTS} configurations")
    lists = [[configuration(point, "points", form) for point in row] for row in rows]
    if kind == "box":
        low, high = lists[0]
        demand(all(a <= b for a, b in zip(low, high, strict=True)), "points: low is above high")
    triangles = items(table.get("triangles", []), "triangles", kind == "polygon", 20_000)
    for row in triangles:
        for k in items(row, "triangles", 3, 3):
            index(k, "triangles", count)
    joints = _joints(table["joints"], *lists[0]) if kind == NO_PATH else []
    return Claim(kind, margin, lists, triangles, joints)


def configuration(value: Any, where: str, form: dict[str, Any]) -> Point:
    """Return a configuration whose angles are not too large."""
    joints, largest = form["joints"], LARGEST_ANGLE[form["angle_unit"]]
    point = tuple(decimal(x, where) for x in items(value, where, len(joints), len(joints)))
    for joint, x in zip(joints, point, strict=True):
        demand(not joint["turns"] or abs(x) <= largest, f"{where}: an angle is too large")
    return point


def _joints(value: Any, start: Point, goal: Point) -> list[str]:
    """Read what each joint does on the paths of a claim of no path."""
    kinds = items(value, "joints", len(start), len(start))
    for kind, a, b in zip(kinds, start, goal, strict=True):
        demand(isinstance(kind, str) and kind in ("moves", "held", "any"), "joints: not a word")
        demand(kind != "held" or a == b, "joints: one that is held has two values")
    demand("moves" in kinds, "joints: not one of them moves")
    return kinds


def weights_of(value: Any, where: str, count: int) -> list[Any]:
    """Return the weights of a mean of `count` corners."""
    weights = [decimal(x, where) for x in items(value, where, count, count)]
    demand(all(w >= 0 for w in weights), f"{where}: a weight is negative")
    demand(not weights or sum(weights) == 1, f"{where}: the sum of the weights is not 1")
    return weights
