"""The normal form of a robot, made with the library's own reader of robot files."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import product
from typing import Any, NamedTuple

from flint import fmpq

from qbound.model.boundaries import BodyPair, HalfSpace, Pair
from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot
from qbound.model.source import Source
from qbound.proofs.second.cells import around, check_filled
from qbound.proofs.second.reading import (
    LARGEST,
    LARGEST_ANGLE,
    Work,
    demand,
    index,
    items,
    refuse,
    shown,
    table_of,
    text_of,
)

MOST_CHARACTERS = 500_000
MOST_JOINTS = 7
MOST_ROWS = 2_000
MOST_OTHERS = 20_000
"""Boundaries that are written, pairs that are allowed, and things to keep."""

COSTLY = re.compile(
    r"""(?:[.][ \t]*(?:[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')[ \t]*){8}|[0-9A-Fa-f_]{101}"""
)
"""A key of many parts, or a number of many digits: to read one takes time that grows with their
square."""

Form = dict[str, Any]
Place = tuple[Any, ...]


def canonical(form: Form) -> str:
    """Return the text whose SHA-256 stands in a certificate."""
    return json.dumps(form, sort_keys=True, indent=1) + "\n"


def normal_form(text: Any, parts: Any, work: Work | None = None) -> Form:
    """Return the normal form of the text of a robot file, as the book's page defines it.

    Parameters
    ----------
    text : str
    parts : dict of str to list of list of int
        Corners of the convex parts of outlines, by the name of the body.
    work : Work, optional
        The work of the check so far.

    Raises
    ------
    ValueError
        If the text is not a robot, or the parts do not fill their outlines.
    """
    return _Robot(text_of(text, "robot", MOST_CHARACTERS)).form(parts, work or Work())


class _Thing(NamedTuple):
    """A point or a body: corners of a frame, and a radius."""

    name: str
    frame: int
    corners: list[Place]
    radius: Any
    along: int | None = None
    """Of a body: the axis of its frame along which bodies are seen."""


class _Robot:
    """A robot as the library reads it, with the tables of its file in exact numbers."""

    def __init__(self, text: str) -> None:
        demand(not COSTLY.search(text), "robot: a key of many parts or a number of many digits")
        try:
            source = Source.of_text(text)
            _check_counts(source.table)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.robot: Robot = parse_robot(source)
            self.table = source.exact
        except (ValueError, OverflowError, RecursionError) as error:
            refuse(f"robot: {shown(str(error))}")
        demand(len(self.robot.used) <= MOST_ROWS, f"robot: more than {MOST_ROWS} boundaries in use")
        labels = [self.robot.base, *(name for j in self.robot.joints for name in j.labels)]
        self.frames = {label: k for k, label in enumerate(labels)}
        self.hulls: dict[str, int] = {}
        self.body, self.point = cache(self._body), cache(self._point)
        self.hull = cache(self._hull)

    def form(self, parts: Any, work: Work) -> Form:
        """Return the normal form."""
        robot, rows = self.robot, self.table["joint"]
        limits = [texts(row["limits"]) if "limits" in row else None for row in rows]
        joints = [
            {"name": joint.name, "turns": joint.turns, "limits": ends}
            for joint, ends in zip(robot.joints, limits, strict=True)
        ]
        keep = self._keep(self._parts(parts, work))
        return {
            "name": robot.name,
            "length_unit": robot.length_unit,
            "angle_unit": robot.angle_unit,
            "joints": joints,
            "steps": [step for j, row in enumerate(rows) for step in self._steps(j, row)],
            "hulls": [json.loads(text) for text in self.hulls],
            "keep": keep,
        }

    def _steps(self, j: int, row: Any) -> list[Form]:
        """Return the one step of a joint, or the two of a parallelogram."""
        rpy, zero = row.get("rpy", [0, 0, 0]), ["0", "0", "0"]
        largest = LARGEST_ANGLE[self.robot.angle_unit]
        demand(all(abs(number(x)) <= largest for x in rpy), "robot: rpy: an angle is too large")
        common = {"joint": j, "offset": "0", "axis": texts(row["axis"])}
        steps = [{**common, "factor": "1", "origin": texts(row["origin"]), "rpy": texts(rpy)}]
        if "crank" in row:
            steps.append({**common, "factor": "-1", "origin": texts(row["crank"]), "rpy": zero})
        return steps

    def _body(self, name: str) -> _Thing:
        """Return a body; a corner with two numbers gets 0 as the third one, across the plane."""
        bodies = [*self.robot.bodies, *self.robot.obstacles]
        rows = [*self.table.get("body", ()), *self.table.get("obstacle", ())]
        k = next(k for k, body in enumerate(bodies) if body.name == name)
        row, frame = rows[k], bodies[k].frame
        shape = row.get("capsule", row.get("disc", {}))
        ends = [shape[end] for end in ("from", "to", "at") if end in shape]
        along = self.robot.plane.flat_coordinate(frame)
        if along is None:
            refuse(f"robot: the frame of {shown(name)} has no axis along that of the joints")
        full = [p if len(p) == 3 else [*p[:along], 0, *p[along:]] for p in ends or row["polygon"]]
        corners = [tuple(map(number, place)) for place in full]
        return _Thing(name, self.frames[frame], corners, number(shape.get("radius", 0)), along)

    def _point(self, name: str) -> _Thing:
        row = next(row for row in self.table["point"] if row["name"] == name)
        place = tuple(map(number, row["at"]))
        return _Thing(name, self.frames[row["frame"]], [place], number(row.get("radius", 0)))

    def _parts(self, given: Any, work: Work) -> dict[str, list[list[int]]]:
        """Verify the convex parts of all bodies that are kept from others."""
        pairs = [b.bodies for b in self.robot.used if isinstance(b, BodyPair)]
        found, rest = dict[str, list[list[int]]](), dict[str, list[Place]]()
        for name in dict.fromkeys(name for pair in pairs for name in pair):
            body = self.body(name)
            flat = [tuple(x for k, x in enumerate(p) if k != body.along) for p in body.corners]
            if len(flat) < 3 or is_convex(flat):
                found[name] = [list(range(len(flat)))]
            else:
                rest[name] = flat
        table_of(given, "parts", list(rest))
        for name, flat in rest.items():
            where, size = f"parts of {shown(name)}", len(flat)
            found[name] = items(given[name], where, 1, 2 * size)
            for part in found[name]:
                for k in items(part, where, 3, size):
                    index(k, where, size)
            work.add(3 * sum(len(part) ** 2 for part in found[name]))
            area = sum(a * d - b * c for (a, b), (c, d) in around(flat))
            demand(area, f"robot: the outline of {shown(name)} has no area")
            loop = flat if area > 0 else [(-x, y) for x, y in flat]
            check_filled([loop], [[loop[k] for k in part] for part in found[name]], where)
        return found

    def _hull(self, kind: type, name: str, part: tuple[int, ...]) -> int:
        """Return the index of the hull of a point or a body; append a new hull."""
        thing = self.body(name) if kind is BodyPair else self.point(name)
        corners = [texts(thing.corners[k]) for k in part or range(len(thing.corners))]
        text = json.dumps({"frame": thing.frame, "corners": corners})
        return self.hulls.setdefault(text, len(self.hulls))

    def _keep(self, parts: dict[str, list[list[int]]]) -> list[Form]:
        written = {row["name"]: row for row in self.table.get("boundary", ())}
        made = {"clearance": self.table.get("clearance", 0)}
        found: list[Form] = []
        for boundary in self.robot.used:
            row, named = written.get(boundary.name, made), {"name": boundary.name}
            if isinstance(boundary, HalfSpace):
                kind, name = (BodyPair, row["body"]) if "body" in row else (Pair, row["point"])
                radius = (self.body(name) if kind is BodyPair else self.point(name)).radius
                gap, far = text(number(row["offset"]) + radius), self.hull(kind, name, ())
                found.append({**named, "far": far, "gap": gap, "normal": texts(row["normal"])})
                continue
            if isinstance(boundary, BodyPair):
                ends = [(self.body(name), parts[name]) for name in boundary.bodies]
            else:
                ends = [(self.point(name), [[0]]) for name in row["points"]]
            gap = text(number(row.get("clearance", 0)) + sum(end.radius for end, _ in ends))
            (one, its), (other, others) = sorted(ends, key=lambda end: end[0].frame)
            count = len(found) + len(its) * len(others)
            demand(count <= MOST_OTHERS, f"robot: more than {MOST_OTHERS} things to keep")
            for a, b in product(its, others):
                near = self.hull(type(boundary), one.name, tuple(a))
                far = self.hull(type(boundary), other.name, tuple(b))
                found.append({**named, "near": near, "far": far, "gap": gap, "along": one.along})
        return found


# --- numbers --------------------------------------------------------------------------------------


def number(value: Any) -> Any:
    """Return a number of a robot file, rational or integer; refuse huge and tiny numbers."""
    exact = value if isinstance(value, fmpq) else fmpq(value)
    inside = exact == 0 or 1 / LARGEST <= abs(exact) <= LARGEST
    demand(inside, "robot: a number is larger than 1e100 or, though not 0, smaller than 1e-100")
    return exact


def texts(values: Sequence[Any]) -> list[str]:
    """Write the numbers of a place."""
    return [text(number(x)) for x in values]


def text(x: Any) -> str:
    """Write a decimal with all its digits and without an exponent."""
    places, rest = 0, int(x.q)
    for prime in (2, 5):
        power = 0
        while rest % prime == 0:
            rest, power = rest // prime, power + 1
        places = max(places, power)
    digits = str(abs(int(x * 10**places))).rjust(places + 1, "0")
    point, sign = len(digits) - places, "-" if x < 0 else ""
    return sign + digits[:point] + ("." + digits[point:] if places else "")


def is_convex(corners: Sequence[Place]) -> bool:
    """Tell whether an outline in a plane turns one way only, once round, and has an area."""
    edges = [(c - a, d - b) for (a, b), (c, d) in around(corners)]
    turns = [(x * v - y * u, x * u + y * v) for (x, y), (u, v) in around(edges)]
    if any(side == 0 and ahead <= 0 for side, ahead in turns):
        return False  # turns back, or goes nowhere
    sides = [side for side, _ in turns]
    if not any(sides) or min(sides) < 0 < max(sides):
        return False
    upwards = [bool(y > 0 or (y == 0 and x > 0)) for x, y in edges]
    return [b and not a for a, b in around(upwards)].count(True) == 1


def _check_counts(table: Mapping[str, Any]) -> None:
    """Bound the rows of a robot file before its reader compares them with each other."""
    kinds = ["joint", "point", "boundary", "body", "obstacle", "allowed"]
    rows = {kind: table.get(kind, []) for kind in kinds}
    for kind, most in zip(kinds, (MOST_JOINTS, MOST_ROWS, *[MOST_OTHERS] * 4), strict=True):
        demand(isinstance(rows[kind], list), f"{kind} is not a list of tables")
        demand(len(rows[kind]) <= most, f"more than {most} rows of {kind}")
    bodies = len(rows["body"]) + len(rows["obstacle"])
    demand(bodies <= MOST_ROWS, f"more than {MOST_ROWS} bodies")
    if "collisions" in table:
        frames = [row.get("frame") for row in rows["body"] if isinstance(row, dict)]
        base = [row.get("parent") for row in rows["joint"][:1] if isinstance(row, dict)]
        names = [x for x in [*frames, *base * len(rows["obstacle"])] if isinstance(x, str)]
        same = sum(names.count(name) ** 2 for name in sorted(set(names)))
        most = MOST_ROWS + len(rows["allowed"]) + len(rows["boundary"])
        demand((bodies**2 - same) // 2 <= most, "more pairs of bodies than may be kept")
