"""Statements of certificates: sets of configurations in exact decimals, as they are written.

A statement is the part of a certificate that describes the set: lists of points. Every joint value
is a decimal in the robot file's own unit. A polygon has its inside on the left of its loops.
"""

import csv
import io
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats
from cspace.export import outlines
from cspace.files import read_bytes
from cspace.forms.bending import second_order
from cspace.geometry import polygon
from cspace.geometry.convex import in_whole_numbers
from cspace.geometry.triangulation import triangulated
from cspace.model.robot import Robot
from cspace.model.rows import LARGEST, SMALLEST
from cspace.region import Component, find_region, margins
from cspace.region.arcs import Arc, behind
from cspace.region.problem import Problem, clearance_problem
from cspace.units import MILLIMETRES, file_units, parse_joint_value, split_length

Statement = dict[str, Any]
Point = list[str]

DIGITS = 12
"""Decimals that are written: a hundred times finer than a double resolves a turn in degrees."""

MOST_POINTS = 20_000
"""Configurations of a certificate."""

ON_CHORD = 7
"""Points of a chord at which bodies are looked at."""

ON_LIMIT = 1e-9
"""What is this near to a joint's limit, rad or length, lies on it."""

SMALL = 1e-9
"""Area of a piece of a polygon, in the file's units, that is rounding where it was cut."""

SAME_AREA = 0.02
"""Part by which polygons through a few points of each arc may differ from the area they show."""


class CrossesItself(ValueError):
    """Error: loops cross themselves or each other, or do not have the inside on their left."""


def units(robot: Robot) -> Floats:
    """Return the library's units (rad, length) in one unit of the file, for each joint."""
    angle = np.radians(1.0) if robot.angle_unit == "deg" else 1.0
    return np.array([joint.scale(angle) for joint in robot.joints])


def decimal(value: float) -> str:
    """Write a number as a decimal without exponent, with at most `DIGITS` places."""
    text = f"{value:.{DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def points_of(robot: Robot, q: ArrayLike) -> list[Point]:
    """Round configurations, shape (m, n), rad or length, to decimals in the file's units."""
    values = np.asarray(q, dtype=float)
    if values.ndim != 2 or values.shape[1] != len(robot.joints) or not np.isfinite(values).all():
        raise ValueError(f"wanted: finite values of {len(robot.joints)} joints a point")
    return [[decimal(x) for x in row] for row in values / units(robot)]


def box(low: Sequence[str], high: Sequence[str], margin: str = "0") -> Statement:
    """State that a box is feasible: each joint between two values.

    Parameters
    ----------
    low, high : sequence of str
        Decimals in the file's units; a joint with equal ends is held.
    margin : str
        Length that every boundary keeps beyond its required distance.
    """
    if any(Fraction(a) > Fraction(b) for a, b in zip(low, high, strict=True)):
        raise ValueError("a box needs its low end first")
    return {"set": "box", "margin": margin, "points": [[list(low), list(high)]]}


def path(points: Sequence[Sequence[str]], margin: str = "0") -> Statement:
    """State that a path of straight segments through points is feasible."""
    if len(points) < 2:
        raise ValueError(f"a path needs two points or more; found {len(points)}")
    return {"set": "path", "margin": margin, "points": [[list(point) for point in points]]}


def filled(loops: Sequence[Sequence[Sequence[str]]], margin: str = "0") -> Statement:
    """State that a polygon of two joints is feasible; it is cut into triangles exactly.

    Parameters
    ----------
    loops : sequence of sequence of point
        Corners with values of all joints, equal for held joints; the inside is on the left.

    Raises
    ------
    ValueError
        If not exactly two joints change, a corner is repeated, or the polygon crosses itself.
    """
    rows = [[tuple(map(Fraction, point)) for point in loop] for loop in loops]
    columns = list(zip(*(point for loop in rows for point in loop), strict=True))
    free = [j for j, column in enumerate(columns) if len(set(column)) > 1]
    if len(free) != 2:
        raise ValueError(f"a polygon lies in the plane of two joints; here {len(free)} change")
    for row, loop in zip(rows, loops, strict=True):
        twice = next((k for k, point in enumerate(row) if point in row[:k]), None)
        if twice is not None:
            raise ValueError(f"corner {twice + 1} of a loop stands there twice: {loop[twice]}")
    i, j = free
    places = [[(p[i], p[j]) for p in loop] for loop in rows]
    points = [[list(point) for point in loop] for loop in loops]
    if min(map(len, places)) < 3:
        raise ValueError("a loop of a polygon has 3 corners or more")
    whole = iter(in_whole_numbers([place for loop in places for place in loop]))
    try:
        triangles = list(map(list, triangulated([[next(whole) for _ in p] for p in places])))
    except ValueError as error:
        why = "the polygon crosses itself, or its inside is not on the left"
        raise CrossesItself(f"{why}: {error}") from None
    return {"set": "polygon", "margin": margin, "points": points, "triangles": triangles}


def corners_of(statement: Statement) -> list[list[Point]]:
    """Return the corners of a statement's cells as they are written; for a box its two ends."""
    points = [point for loop in statement["points"] for point in loop]
    if statement["set"] == "polygon":
        return [[points[k] for k in triangle] for triangle in statement["triangles"]]
    if statement["set"] == "path":
        return [[a, b] for loop in statement["points"] for a, b in pairwise(loop)]
    return [points]


def opened(points: Sequence[Sequence[str]]) -> list[list[str]]:
    """Leave out a last corner that repeats the first one, as in tables of closed rings."""
    loop = [list(point) for point in points]
    closed = len(loop) > 1 and list(map(Fraction, loop[0])) == list(map(Fraction, loop[-1]))
    return loop[:-1] if closed else loop


def anticlockwise(points: Sequence[Sequence[str]]) -> list[list[str]]:
    """Turn a loop of two changing joints so that its inside lies on the left."""
    q = np.array(points, dtype=float)
    free = np.ptp(q, axis=0) > 0 if len(q) else np.zeros(0)
    turn = free.sum() == 2 and polygon.area(q[:, free]) < 0
    return [list(point) for point in (points[::-1] if turn else points)]


def usual_inset(robot: Robot) -> float:
    """Return a hundredth of the robot's reach, the sum of all its offsets: length."""
    offsets = [np.linalg.norm(step.origin) for step in robot.steps]  # with cranks
    return float(sum(offsets) + np.linalg.norm(robot.point(robot.tool).at)) / 100


def home_polygon(
    robot: Robot, scale: float = 1, margin: str = "0", held: Mapping[int, float] | None = None
) -> Statement:
    """State that the polygon of the home component's vertices, scaled, is feasible.

    Parameters
    ----------
    scale : float
        Scale about the centroid of the polygon's area.
    held : mapping of int to float, optional
        Joints that are held, all but two; rad or length.

    Raises
    ------
    ValueError
        If the home pose is in no component, or its component has no polygon of vertices.
    """
    return scaled_polygon(robot, home_vertices(robot, held), scale, margin, held)


def home_vertices(robot: Robot, held: Mapping[int, float] | None = None) -> Floats:
    """Return the vertices of the home component's outline, shape (m, 2)."""
    component = _home(robot, held)
    if any(component.wraps):
        raise ValueError(
            "the home component goes all the way round a joint: it has no polygon to scale;"
            " ask for the region but for an inset, or for a box"
        )
    starts = {tuple(vertex.q.tolist()) for vertex in component.vertices}
    loops = [
        np.array([arc.start for arc in loop if tuple(arc.start.tolist()) in starts]).reshape(-1, 2)
        for loop in component.loops
    ]
    corners = max(loops, key=lambda loop: polygon.area(loop) if len(loop) > 2 else 0)
    if len(corners) < 3:
        raise ValueError(f"the home component has {len(corners)} vertices, which make no polygon")
    return corners


def scaled_polygon(
    robot: Robot,
    corners: Floats,
    scale: float,
    margin: str = "0",
    held: Mapping[int, float] | None = None,
) -> Statement:
    """State that a polygon of two joints, scaled about the centroid of its area, is feasible."""
    if not scale > 0:
        raise ValueError(f"a scale of {scale}: wanted a number of more than 0")
    scaled = polygon.scaled(corners, scale, polygon.centroid(corners))
    return filled([points_of(robot, robot.with_held(scaled, held or {}))], margin)


def inner_polygon(
    robot: Robot,
    inset: float,
    per_arc: int = 12,
    margin: str = "0",
    held: Mapping[int, float] | None = None,
) -> Statement:
    """State that the home component, except for a strip along its arcs, is feasible.

    The required distance of every boundary grows by the margin and `inset`. The component of home
    that is left is bounded by arcs again, and a polygon is drawn through points of these arcs.

    Parameters
    ----------
    inset : float
        Length, more than 0.
    per_arc : int
        Least number of points on each arc; see the notes.

    Raises
    ------
    ValueError
        If the home pose is in no component, or the polygon needs too many corners.

    Notes
    -----
    Where an arc bends into the component its chords leave the component. They are halved until a
    lower bound shows that each keeps every boundary with half of the inset.

    A component that goes all the way round a joint is cut open half a turn away from home; its
    polygon reaches from one side of the cut to the other side, one full turn later.
    """
    if not inset > 0:
        raise ValueError(f"an inset of {inset}: wanted a length of more than 0")
    asked = with_extra_clearance(robot, float(Fraction(margin)))
    _check_inset(asked, inset, held)
    component = _home(with_extra_clearance(asked, inset), held)
    halfway = clearance_problem(with_extra_clearance(asked, inset / 2), held)
    loops = [_traced(loop, per_arc, halfway) for loop in component.loops]
    corners = sum(map(len, loops))
    if corners > MOST_POINTS:
        raise ValueError(f"an inset of {inset:g} takes {corners} corners: ask for a larger one")
    polygons = [loops] if not any(component.wraps) else _cut_open(robot, component, loops, held)
    return _united(
        filled([_decimals(robot, loop, held) for loop in polygon], margin) for polygon in polygons
    )


def _decimals(robot: Robot, loop: Floats, held: Mapping[int, float] | None) -> list[Point]:
    """Write the corners of a loop of two joints in decimals, with the joints that are held."""
    return _distinct(within_limits(robot, robot.with_held(loop, held or {})))


def _cut_open(
    robot: Robot, component: Component, loops: Sequence[Floats], held: Mapping[int, float] | None
) -> list[list[Floats]]:
    """Cut a component that goes round a joint half a turn away from home: polygons, rad.

    Joint values of a certificate are numbers, not angles modulo a turn. So the polygons reach from
    one value of such a joint to the same value a turn later: in the file's units 360 degrees
    exactly, or a decimal just above 2 pi.
    """
    free = robot.free(held or {})
    scale = units(robot)[free]
    turn = 360.0 if robot.angle_unit == "deg" else math.ceil(2e12 * math.pi) / 1e12
    rings = []
    for points, arcs in zip(loops, component.loops, strict=True):
        winding = np.round((arcs[-1].points[-1] - arcs[0].points[0]) / (2 * np.pi))
        rings.append(np.vstack([points / scale, points[0] / scale + turn * winding]))
    cut = np.round(np.round(robot.home[free] / scale, 6) - turn / 2, DIGITS)
    pieces = outlines.assembled(rings, component.wraps, np.stack([cut, cut + turn], axis=1))
    area = outlines.area(pieces) * float(scale.prod())
    if abs(area - component.area) > SAME_AREA * component.area:
        raise ValueError("the home component goes round a joint in a way that no polygon shows")
    polygons = [[piece.outer, *piece.holes] for piece in pieces]
    return [[ring * scale for ring in each] for each in polygons if polygon.area(each[0]) > SMALL]


def _united(parts: Iterable[Statement]) -> Statement:
    """State several polygons as one: their points one after the other."""
    first, *others = parts
    whole = {**first, "points": [*first["points"]], "triangles": [*first["triangles"]]}
    for other in others:
        before = sum(map(len, whole["points"]))
        whole["triangles"] += [[k + before for k in triangle] for triangle in other["triangles"]]
        whole["points"] += other["points"]
    return whole


def with_extra_clearance(robot: Robot, length: float) -> Robot:
    """Return a robot whose boundaries have larger required distances."""
    boundaries = tuple(boundary.with_extra_clearance(length) for boundary in robot.boundaries)
    return replace(robot, boundaries=boundaries, clearance=robot.clearance + length)


def wider(robot: Robot, statement: Statement) -> Robot:
    """Return a robot whose required distances include the margin of a statement."""
    return with_extra_clearance(robot, float(Fraction(statement["margin"])))


def _home(robot: Robot, held: Mapping[int, float] | None) -> Component:
    region = find_region(robot, held)
    if not region.has_home:
        raise ValueError("the home pose is in no component: there is no region to certify")
    return region.home_component


def _check_inset(robot: Robot, inset: float, held: Mapping[int, float] | None) -> None:
    """Refuse an inset at which the home pose, feasible without it, would be infeasible."""
    q = robot.with_held(robot.home[robot.free(held or {})], held or {})
    used = {boundary.name for boundary in robot.used}
    lengths = {name: margin for name, margin in margins(robot, q) if name in used}
    name = min(lengths, key=lambda name: lengths[name], default="")
    if name and 0 <= lengths[name] < inset:
        unit = robot.length_unit
        raise ValueError(
            f"an inset of {inset:g} {unit} is larger than home's margin to {name},"
            f" {lengths[name]:.6g} {unit}"
        )


def _traced(loop: Sequence[Arc], per_arc: int, halfway: Problem) -> Floats:
    """Return points of a loop whose chords keep all forms; the first is not repeated."""
    return np.concatenate([_points_of(arc, per_arc, halfway)[:-1] for arc in loop])


def _points_of(arc: Arc, per_arc: int, halfway: Problem) -> Floats:
    """Choose points of an arc, its ends included, and halve each chord that may leave the forms."""
    straight = arc.pieces.row < 0
    s, parts = _first_points(straight, per_arc), len(straight)
    while True:
        q = arc.at(s)
        chords = np.stack([q[:-1], q[1:]], axis=1)
        curved = ~straight[((s[:-1] + s[1:]) / 2 * parts).astype(int)]
        bad = np.flatnonzero(curved & _may_leave(halfway, chords))
        if not len(bad) or len(s) > MOST_POINTS:
            return q
        s = np.insert(s, bad + 1, (s[bad] + s[bad + 1]) / 2)


def _may_leave(halfway: Problem, chords: Floats) -> NDArray[np.bool_]:
    """Tell which chords may leave the region: by bounds of forms, for bodies by some points."""
    left = (second_order(halfway.forms, chords) <= 0).any(axis=1)
    if halfway.evaluator.bodies is not None:
        weights = np.linspace(0, 1, ON_CHORD + 2)[1:-1, None, None]
        places = (1 - weights) * chords[:, 0] + weights * chords[:, 1]
        left |= (halfway.evaluator.bodies.margins(places) < 0).any(axis=(0, 2))
    return np.asarray(left)


def _first_points(straight: NDArray[np.bool_], per_arc: int) -> Floats:
    """Return parameters of `per_arc` points of an arc; for straight pieces only of the ends."""
    count = max(1, math.ceil((per_arc - 1) / len(straight)))
    parts = [
        k + np.linspace(0, 1, 1 if line else count, endpoint=False)
        for k, line in enumerate(straight)
    ]
    return np.concatenate([*parts, [len(straight)]]) / len(straight)


def within_limits(robot: Robot, q: Floats) -> list[Point]:
    """Round configurations, shape (m, n), to decimals of the file's units.

    A value that rounding moves beyond a limit is put back onto the limit.
    """
    ends = [joint.limits for joint in robot.joints]
    return [
        [_clamped(x, end, unit) for x, end, unit in zip(row, ends, units(robot), strict=True)]
        for row in q
    ]


def _clamped(x: float, limits: tuple[float, float] | None, unit: float) -> str:
    for end, side in zip(limits or (), (1, -1), strict=False):
        if side * (x - end) <= ON_LIMIT:
            return _limit(end / unit, side)
    return decimal(x / unit)


def _limit(end: float, side: int) -> str:
    """Write a limit as in its file if that is a short decimal, else rounded inwards."""
    text, rounding = decimal(float(f"{end:.14g}")), 4 * Fraction(math.ulp(end))
    if side * (Fraction(text) - Fraction(end)) >= -rounding:
        return text
    steps = side * math.ceil(side * (Fraction(end) + side * rounding) * 10**DIGITS)
    return f"{Decimal(steps).scaleb(-DIGITS):f}"


def _distinct(points: Sequence[Point]) -> list[Point]:
    """Leave out each point that rounding made equal to the point before it."""
    return [p for p, before in zip(points, behind(points), strict=True) if p != before]


# --- decimals as people write them ----------------------------------------------------------------

DECIMAL = re.compile(r"-?[0-9]+([.][0-9]+)?([eE][+-]?[0-9]{1,3})?")
"""How a certificate writes a number."""

MOST_DIGITS = 40
"""Digits of such a number."""


def read_points(robot: Robot, file: str) -> list[Point]:
    """Read points, one line of joint values each, with units or in the robot file's units.

    A first line may name the columns. Then only columns of joints, such as q1 or q1_rad, are read.

    Raises
    ------
    ValueError
        If the file is not UTF-8, or a line does not have one number for each joint.
    """
    try:
        lines = io.StringIO(read_bytes(file).decode("utf-8-sig"), newline="")
        rows = [(i, row) for i, row in enumerate(csv.reader(lines), 1) if any(row)]
    except UnicodeDecodeError:
        raise ValueError(f"{file}: not UTF-8 text") from None
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
    except csv.Error as error:  # such as a cell of more than 128 kB
        raise ValueError(f"{file}: no table of joint values: {error}") from None
    columns = [(j, "") for j in range(len(robot.joints))]
    names = [joint.name for joint in robot.joints]
    first = [cell.strip() for cell in rows[0][1]] if rows else []
    if first and (first == names or all(cell[:1].isalpha() for cell in first)):
        columns = _columns(robot, first, f"{file}, line {rows.pop(0)[0]}")
    elif first and len(first) != len(columns):
        raise ValueError(f"{file}, line {rows[0][0]}: {len(first)} values for {', '.join(names)}")
    return [_point(robot, columns, row, len(first), f"{file}, line {i}") for i, row in rows]


def _columns(robot: Robot, header: list[str], where: str) -> list[tuple[int, str]]:
    """Return the column of each joint, and its unit: q1, or q1_rad as other commands write it."""
    found = []
    for joint in robot.joints:
        units = ("", "deg", "rad") if joint.turns else ("", *MILLIMETRES)
        named = {f"{joint.name}_{unit}" if unit else joint.name: unit for unit in units}
        columns = [(k, named[cell]) for k, cell in enumerate(header) if cell in named]
        if len(columns) != 1:
            wanted = " or ".join(named)
            raise ValueError(
                f"{where}: {len(columns)} columns of {joint.name}; wanted one, {wanted}"
            )
        found += columns
    return found


def _point(
    robot: Robot, columns: list[tuple[int, str]], row: list[str], width: int, where: str
) -> Point:
    if len(row) != width:
        raise ValueError(f"{where}: {len(row)} values, and {width} in the lines above")
    point = []
    for j, (k, unit) in enumerate(columns):
        cell = row[k].strip()
        if not unit and DECIMAL.fullmatch(cell.removeprefix("+")):
            point.append(as_decimal(where, cell))
            continue
        try:
            point.append(joint_decimal(robot, j, cell + unit))
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
    return point


def as_decimal(where: str, text: str) -> str:
    """Check and return a decimal as it is written; `where` begins the sentence of an error."""
    plain = text.strip().removeprefix("+")
    if not DECIMAL.fullmatch(plain) or sum(map(str.isdigit, plain)) > MOST_DIGITS:
        shown = plain if len(plain) <= MOST_DIGITS else f"{plain[:MOST_DIGITS]}..."
        raise ValueError(f"{where}: {shown!r} is no decimal number of at most {MOST_DIGITS} digits")
    size = abs(Decimal(plain))
    if size and not SMALLEST <= size <= LARGEST:
        raise ValueError(f"{where}: {plain}: sizes are 0, or from {SMALLEST:g} to {LARGEST:g}")
    return plain


def length_decimal(robot: Robot, where: str, text: str) -> str:
    """Return a length, such as ``30cm``, as a decimal of the robot file's unit, exactly."""
    number, own = split_length(text, robot.length_unit)
    plain = as_decimal(where, number)
    if own == robot.length_unit:
        return plain
    tens = {"mm": -3, "cm": -2, "m": 0}
    return as_decimal(where, f"{Decimal(plain).scaleb(tens[own] - tens[robot.length_unit]):f}")


def joint_decimal(robot: Robot, j: int, text: str) -> str:
    """Return a joint value, such as ``20deg``, as a decimal of the robot file's unit.

    A value in that unit is returned as it is written; another one is converted and rounded.
    """
    value = parse_joint_value(robot, j, text)
    plain = text.strip().removeprefix("+").removesuffix(file_units(robot)[j])
    return plain if DECIMAL.fullmatch(plain) else decimal(value / units(robot)[j])


def limits_as_decimals(robot: Robot, j: int) -> tuple[str, str] | None:
    """Return the limits of a joint as decimals of the robot file's unit; None without limits."""
    limits = robot.joints[j].limits
    if limits is None:
        return None
    low, high = (decimal(end / units(robot)[j]) for end in limits)
    return low, high
