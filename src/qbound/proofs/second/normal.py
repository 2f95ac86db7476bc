"""The normal form of a robot, made with the library's own reader of robot files."""

from __future__ import annotations

import json
import re
import tomllib
import warnings
from collections.abc import Sequence
from itertools import product
from typing import Any

from flint import fmpq

from qbound.model.boundaries import BodyPair, HalfSpace
from qbound.model.exact import read_exactly
from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot
from qbound.proofs.parts import check_parts
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
        What the check has cost so far.

    Raises
    ------
    ValueError
        If the text is not a robot, or the parts do not fill their outlines.
    """
    return _Maker(text_of(text, "robot", MOST_CHARACTERS), work or Work()).form(parts)


class _Maker:
    """A robot twice: as the library reads it, and the tables of its file with exact numbers."""

    def __init__(self, text: str, work: Work) -> None:
        self.work = work
        demand(not COSTLY.search(text), "robot: a key of many parts or a number of many digits")
        try:
            plain = tomllib.loads(text)
            _check_counts(plain)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.robot: Robot = parse_robot(plain)
            self.table = read_exactly(text)
        except (ValueError, OverflowError, RecursionError) as error:
            refuse(f"robot: {shown(str(error))}")
        demand(len(self.robot.used) <= MOST_ROWS, f"robot: more than {MOST_ROWS} boundaries in use")
        labels = [self.robot.base, *(name for j in self.robot.joints for name in j.labels)]
        self.frames = {label: k for k, label in enumerate(labels)}
        self.hulls: dict[str, int] = {}
        rows = [*self.table.get("body", ()), *self.table.get("obstacle", ())]
        bodies = [*self.robot.bodies, *self.robot.obstacles]
        self.bodies = {
            body.name: (body.frame, *self._core(row, body.frame))
            for body, row in zip(bodies, rows, strict=True)
        }
        self.points = {
            row["name"]: (row["frame"], [vector(row["at"])], number(row.get("radius", 0)))
            for row in self.table["point"]
        }

    def form(self, parts: Any) -> Form:
        """Return the normal form."""
        robot = self.robot
        steps = [step for j, row in enumerate(self.table["joint"]) for step in self._steps(j, row)]
        joints = [
            {
                "name": joint.name,
                "turns": joint.turns,
                "limits": None if joint.limits is None else texts(row["limits"]),
            }
            for joint, row in zip(robot.joints, self.table["joint"], strict=True)
        ]
        keep = self._keep(self._parts(parts))
        return {
            "name": robot.name,
            "length_unit": robot.length_unit,
            "angle_unit": robot.angle_unit,
            "joints": joints,
            "steps": steps,
            "hulls": [json.loads(text) for text in self.hulls],
            "keep": keep,
        }

    def _steps(self, j: int, row: Any) -> list[Form]:
        """Return the one step of a joint, or the two of a parallelogram."""
        rpy = row.get("rpy", [0, 0, 0])
        largest = LARGEST_ANGLE[self.robot.angle_unit]
        demand(all(abs(number(x)) <= largest for x in rpy), "robot: rpy: an angle is too large")
        zero = ["0", "0", "0"]
        common = {"joint": j, "offset": "0", "axis": texts(row["axis"])}
        first = {**common, "factor": "1", "origin": texts(row["origin"]), "rpy": texts(rpy)}
        if "crank" not in row:
            return [first]
        return [first, {**common, "factor": "-1", "origin": texts(row["crank"]), "rpy": zero}]

    # --- bodies -----------------------------------------------------------------------------------

    def _core(self, row: Any, frame: str) -> tuple[list[Place], Any]:
        """Return the corners of a body, and its radius."""
        if "polygon" in row:
            places, radius = row["polygon"], 0
        elif "capsule" in row:
            places = [row["capsule"]["from"], row["capsule"]["to"]]
            radius = row["capsule"]["radius"]
        else:
            places, radius = [row["disc"]["at"]], row["disc"]["radius"]
        found = [vector(place) for place in places]
        if any(len(place) == 2 for place in found):
            flat = self._along(frame)
            k = 1 if flat is None else flat
            found = [p if len(p) == 3 else (*p[:k], fmpq(0), *p[k:]) for p in found]
        return found, number(radius)

    def _along(self, frame: str) -> int | None:
        """Return which axis of a frame is along the common axis of the joints; None if none is."""
        try:
            return self.robot.plane.flat_coordinate(frame)
        except ValueError:
            return None

    def _flat(self, name: str) -> list[Place]:
        """Return the corners of a body as they are seen along the common axis."""
        frame, corners, _ = self.bodies[name]
        along = self._along(frame)
        if along is None:
            refuse(f"robot: the frame of {shown(name)} has no axis along that of the joints")
        return [place[:along] + place[along + 1 :] for place in corners]

    def _parts(self, given: Any) -> dict[str, list[list[int]]]:
        """Verify the convex parts of all bodies that are kept from others."""
        pairs = [b for b in self.robot.used if isinstance(b, BodyPair)]
        names = list(dict.fromkeys(name for pair in pairs for name in pair.bodies))
        flat = {name: self._flat(name) for name in names}
        whole = {name for name in names if len(flat[name]) < 3 or is_convex(flat[name])}
        table_of(given, "parts", [name for name in names if name not in whole])
        found = {}
        for name in names:
            size = len(flat[name])
            if name in whole:
                found[name] = [list(range(size))]
                continue
            where = f"parts of {shown(name)}"
            found[name] = items(given[name], where, 1, 2 * size)
            for part in found[name]:
                for k in items(part, where, 3, size):
                    index(k, where, size)
            self.work.add(3 * sum(len(part) ** 2 for part in found[name]))
            check_parts(flat[name], found[name], name)
        return found

    # --- what is kept -----------------------------------------------------------------------------

    def _hull(self, frame: str, corners: Sequence[Place]) -> int:
        """Return the index of a hull; a new one comes last."""
        hull = {"frame": self.frames[frame], "corners": [texts(place) for place in corners]}
        return self.hulls.setdefault(json.dumps(hull), len(self.hulls))

    def _keep(self, parts: dict[str, list[list[int]]]) -> list[Form]:
        written = {row["name"]: row for row in self.table.get("boundary", ())}
        made = {"clearance": self.table.get("clearance", 0)}
        found: list[Form] = []
        for boundary in self.robot.used:
            name, row = boundary.name, written.get(boundary.name, made)
            if isinstance(boundary, HalfSpace):
                known, its = (self.bodies, "body") if "body" in row else (self.points, "point")
                frame, corners, radius = known[row[its]]
                gap = text(number(row["offset"]) + radius)
                far = self._hull(frame, corners)
                found.append({"name": name, "far": far, "gap": gap, "normal": texts(row["normal"])})
                continue
            if isinstance(boundary, BodyPair):
                ends = [(name, *self.bodies[name], parts[name]) for name in boundary.bodies]
            else:
                ends = [(name, *self.points[name], [[0]]) for name in row["points"]]
            gap = text(number(row.get("clearance", 0)) + sum(end[3] for end in ends))
            one, other = sorted(ends, key=lambda end: self.frames[end[1]])
            along = self._along(one[1]) if isinstance(boundary, BodyPair) else None
            demand(
                len(found) + len(one[4]) * len(other[4]) <= MOST_OTHERS,
                f"robot: more than {MOST_OTHERS} things to keep",
            )
            for parts_of_both in product(one[4], other[4]):
                near, far = (
                    self._hull(end[1], [end[2][k] for k in part])
                    for end, part in zip((one, other), parts_of_both, strict=True)
                )
                pair = {"name": name, "near": near, "far": far, "gap": gap}
                found.append({**pair, "along": along})
        return found


# --- numbers --------------------------------------------------------------------------------------


def number(value: Any) -> Any:
    """Return a number of a robot file, a rational or an integer, if it is neither huge nor tiny."""
    exact = value if isinstance(value, fmpq) else fmpq(value)
    inside = exact == 0 or 1 / LARGEST <= abs(exact) <= LARGEST
    demand(inside, "robot: a number is larger than 1e100 or, though not 0, smaller than 1e-100")
    return exact


def vector(values: Sequence[Any]) -> Place:
    """Return the numbers of a place."""
    return tuple(map(number, values))


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
    edges = [(c - a, d - b) for (a, b), (c, d) in _around(corners)]
    turns = [(x * v - y * u, x * u + y * v) for (x, y), (u, v) in _around(edges)]
    if any(side == 0 and ahead <= 0 for side, ahead in turns):
        return False  # it turns back, or stands still
    sides = [side for side, _ in turns]
    if not any(sides) or min(sides) < 0 < max(sides):
        return False
    upwards = [bool(y > 0 or (y == 0 and x > 0)) for x, y in edges]
    return [b and not a for a, b in _around(upwards)].count(True) == 1


def _around(loop: Sequence[Any]) -> list[tuple[Any, Any]]:
    return list(zip(loop, [*loop[1:], *loop[:1]], strict=True))


def _check_counts(table: dict[str, Any]) -> None:
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
