"""An independent decision of certificates, which the tests compare with `check.py`.

It reads the file by the published JSON schema and the robot by the library, and it computes in
balls of Arb. Where `check.py` bounds how far a place bends away from its tangent, this takes the
mean value theorem: over a cell the derivatives are balls, and cells are halved until these are
small enough. It shares no code with `check.py`, nor with what writes certificates. It need not be
fast, nor safe from hostile files.
"""

from __future__ import annotations

import hashlib
import json
import re
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache, partial
from importlib import resources
from itertools import chain, combinations, count, pairwise, product
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx, fmpq
from jsonschema import Draft202012Validator
from scipy.sparse.csgraph import connected_components

from cspace.model.boundaries import BodyPair
from cspace.model.robotfile import parse_robot
from cspace.model.source import Source

Json = Any
Point = tuple[Any, ...]
"""Rationals: a configuration in the units of the file, or a place."""

Slopes = dict[int, Any]
"""Derivatives by their joints: matrices of balls."""

DEEPEST, MOST_CELLS = 30, 30_000
"""Cuts of a leaf on top of each other, and parts of one leaf: with more it is refused."""

TOUCHING = 1e-9
"""Leaves nearer than this, in radians or parts of the largest length, count as touching."""

DECIMAL = re.compile(r"-?[0-9]+([.][0-9]+)?([eE][+-]?[0-9]{1,3})?")
TOKEN = re.compile(r"([a-g])|(0|[1-9][0-9]{0,8})?[.]")
HALF_TURN = {"deg": fmpq(180), "rad": fmpq(31416, 10**4)}
LARGEST_ANGLE = {"deg": 1800, "rad": 30}
UNIT = [[int(i == k) for k in range(3)] for i in range(3)]
ZERO = [[0] * 3] * 3


def verify(text: str | bytes) -> str:
    """Return "proved" or "refuted"; a ValueError refuses the file, whatever is wrong with it."""
    try:
        data = read(text)
        with ctx.workprec(640 if "witness" in data else 192):
            form = normal_form(data["robot"], data["parts"])
            written = json.dumps(form, sort_keys=True, indent=1) + "\n"
            demand(hashlib.sha256(written.encode()).hexdigest() == data["sha256"], "another hash")
            scene = Scene(form, data["claim"])
            if "witness" in data:
                check_witness(scene, data["witness"])
                return "refuted"
            demand(not any(map(scene.beyond, scene.configurations)), "beyond a limit")
            (check_no_path if scene.kind == "no path" else check_set)(scene, data["proof"])
            return "proved"
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        RecursionError,
        TypeError,
        ValueError,
    ) as why:
        raise ValueError(f"refused: {why.args[:1]!a}") from why


def demand(condition: object, why: str) -> None:
    if not condition:
        raise ValueError(why)


# --- reading --------------------------------------------------------------------------------------


@cache
def schema() -> Draft202012Validator:
    file = resources.files("cspace") / "schemas" / "certificate.schema.json"
    return Draft202012Validator(json.loads(file.read_text(encoding="utf-8")))


def read(text: str | bytes) -> Json:
    """Read JSON that follows the schema; how it may be written `check.py` alone knows."""
    data = json.loads(text if isinstance(text, str) else text.decode())
    demand(schema().is_valid(data), "the file does not follow the schema")
    return data


def decimal(text: str) -> Any:
    """Return a decimal as a rational."""
    demand(DECIMAL.fullmatch(text), "not a decimal")
    demand(len(re.sub("[eE].*|[-.]", "", text)) <= 40, "a long number")
    return sized(rational(text))


def rational(text: str) -> Any:
    return fmpq(*Fraction(text).as_integer_ratio())


def sized(x: Any) -> Any:
    """Return a number as a rational, if it is neither too large nor too small."""
    demand(x == 0 or fmpq(1, 10**100) <= abs(fmpq(x)) <= 10**100, "a number out of range")
    return fmpq(x)


def full(x: Any) -> str:
    """Write a number with all its digits and without an exponent."""
    x = sized(x)
    places = next(n for n in count() if 10**n % int(x.q) == 0)
    digits = str(abs(int(x * 10**places))).rjust(places + 1, "0")
    point = len(digits) - places
    return "-" * bool(x < 0) + digits[:point] + ("." + digits[point:]) * bool(places)


def dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    return sum((x * y for x, y in zip(u, v, strict=True)), fmpq(0))


def minus(p: Sequence[Any], q: Sequence[Any]) -> Point:
    return tuple(x - y for x, y in zip(p, q, strict=True))


def mean(written: Sequence[str], places: Sequence[Point]) -> Point:
    """Return the mean of places by weights; of no places the base's origin."""
    weights = [*map(decimal, written)]
    demand(len(weights) == len(places) and all(w >= 0 for w in weights), "other weights")
    demand(not places or sum(weights) == 1, "a sum of weights that is not 1")
    return tuple(dot(weights, column) for column in zip(*places, strict=True)) or (0, 0, 0)


# --- loops in a plane -----------------------------------------------------------------------------


def around(loop: Sequence[Any]) -> list[tuple[Any, Any]]:
    return list(zip(loop, [*loop[1:], *loop[:1]], strict=True))


def side(line: Sequence[Any], p: Sequence[Any]) -> Any:
    """Return more than 0 for a place left of a line."""
    (a, b), (c, d) = line
    return (c - a) * (p[1] - b) - (d - b) * (p[0] - a)


def is_convex(loop: Sequence[Point]) -> bool:
    """Tell whether an outline is convex and anticlockwise: no corner is right of an edge."""
    sides = [[side(edge, p) for p in loop] for edge in around(loop)]
    return len({*loop}) == len(loop) and all(min(row) >= 0 and any(row) for row in sides)


def demand_filled(loops: Sequence[Sequence[Point]], pieces: Sequence[Sequence[Point]]) -> None:
    """Refuse pieces that are not convex and anticlockwise, or do not fill loops exactly."""
    demand(all(map(is_convex, pieces)), "a piece is flat, clockwise or not convex")
    outline, sides = (Counter(e for loop in x for e in around(loop)) for x in (loops, pieces))
    demand({*outline.values(), *sides.values()} == {1}, "an edge stands twice")
    demand({*outline} == {(a, b) for a, b in sides if (b, a) not in sides}, "not filled")


# --- the normal form ------------------------------------------------------------------------------


def normal_form(text: str, parts: Json) -> Json:
    """Return the normal form of a robot, as the book's page defines it, by the library's reader."""
    demand(not re.search("[0-9A-Fa-f_]{101}", text), "a long number in the robot")
    source = Source.of_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = parse_robot(source)
    demand(len(robot.joints) <= 7 and len(robot.used) <= 2000, "a large robot")
    table, hulls, keep = source.exact, dict[str, int](), list[Json]()
    frames = [robot.base, *(name for joint in robot.joints for name in joint.labels)]
    points = {row["name"]: row for row in table.get("point", ())}
    rows = [*table.get("body", ()), *table.get("obstacle", ())]
    own = {body.name: body.frame for body in (*robot.bodies, *robot.obstacles)}
    bodies = {name: row | {"frame": own[name]} for name, row in zip(own, rows, strict=True)}

    def thing(name: str, is_body: bool) -> tuple[int, list[Point], Any, int | None]:
        """Return frame, corners and radius, and of a body the axis of its frame to see along."""
        row = (bodies if is_body else points)[name]
        along = robot.plane.flat_coordinate(row["frame"]) if is_body else None
        demand(not is_body or along is not None, "bodies without a common axis")
        shape = row.get("capsule", row.get("disc", row))
        ends = [shape[key] for key in ("from", "to", "at") if key in shape] or shape["polygon"]
        ends = [p if len(p) == 3 else [*p[:along], 0, *p[along:]] for p in ends]
        corners = [tuple(map(sized, p)) for p in ends]
        return frames.index(row["frame"]), corners, sized(shape.get("radius", 0)), along

    def hull(frame: int, corners: Sequence[Point]) -> int:
        places = [[*map(full, p)] for p in corners]
        return hulls.setdefault(json.dumps({"frame": frame, "corners": places}), len(hulls))

    of_pairs = {name for b in robot.used if isinstance(b, BodyPair) for name in b.bodies}
    cut = {name: convex_parts(thing(name, True), parts.get(name)) for name in of_pairs}
    demand({*parts} <= of_pairs, "parts of other bodies")
    written = {row["name"]: row for row in table.get("boundary", ())}
    for boundary in robot.used:
        row = written.get(boundary.name, {"clearance": table.get("clearance", 0)})
        if "normal" in row:
            frame, corners, radius, _ = thing(row.get("body", row.get("point")), "body" in row)
            wall = {"normal": [*map(full, row["normal"])], "far": hull(frame, corners)}
            keep.append({"name": boundary.name, "gap": full(sized(row["offset"]) + radius), **wall})
            continue
        is_body = isinstance(boundary, BodyPair)
        names = boundary.bodies if is_body else row["points"]
        one, other = sorted(names, key=lambda name: thing(name, is_body)[0])
        (near, p, r, along), (far, q, s, _) = thing(one, is_body), thing(other, is_body)
        gap = full(sized(row.get("clearance", 0)) + r + s)
        for a, b in product(cut[one], cut[other]) if is_body else [(p, q)]:
            ends = {"near": hull(near, a), "far": hull(far, b), "along": along}
            keep.append({"name": boundary.name, "gap": gap, **ends})
    limits = [[*map(full, row.get("limits", []))] or None for row in table["joint"]]
    names = [{"name": joint.name, "turns": joint.turns} for joint in robot.joints]
    joints = [joint | {"limits": ends} for joint, ends in zip(names, limits, strict=True)]
    steps = [step for j, row in enumerate(table["joint"]) for step in steps_of(j, row)]
    angles = [abs(rational(x)) for step in steps for x in step["rpy"]]
    demand(max(angles) <= LARGEST_ANGLE[robot.angle_unit], "a large angle of a mount")
    head = {key: getattr(robot, key) for key in ("name", "length_unit", "angle_unit")}
    places = [*map(json.loads, hulls)]
    head |= {"left_out": [*robot.left_out]} if robot.left_out else {}
    return head | {"joints": joints, "steps": steps, "hulls": places, "keep": keep}


def convex_parts(thing: tuple[int, list[Point], Any, Any], given: Json) -> list[list[Point]]:
    """Return the corners of the convex parts of a body; only of a hollow one some are given."""
    _, corners, _, along = thing
    flat = [tuple(x for k, x in enumerate(p) if k != along) for p in corners]
    mirrored = [(-x, y) for x, y in flat]
    if len(flat) < 3 or is_convex(flat) or is_convex(mirrored):
        demand(given is None, "parts of a convex body")
        return [corners]
    area = sum(a * d - b * c for (a, b), (c, d) in around(flat))
    demand(area and given, "an outline without an area, or without parts")
    loop = flat if area > 0 else mirrored
    demand_filled([loop], [[loop[k] for k in part] for part in given])
    return [[corners[k] for k in part] for part in given]


def steps_of(j: int, row: Json) -> Iterator[Json]:
    """Yield the one step of a joint, or the two of a parallelogram."""
    common = {"joint": j, "offset": "0", "axis": [*map(full, row["axis"])]}
    origin, rpy = [*map(full, row["origin"])], [*map(full, row.get("rpy", [0] * 3))]
    yield common | {"factor": "1", "origin": origin, "rpy": rpy}
    if "crank" in row:
        crank = [*map(full, row["crank"])]
        yield common | {"factor": "-1", "origin": crank, "rpy": ["0"] * 3}


# --- cells ----------------------------------------------------------------------------------------


class Cell(NamedTuple):
    """A segment or a triangle by its corners, or a box by its low and its high corner."""

    corners: tuple[Point, ...]
    is_box: bool = False

    @property
    def middle(self) -> Point:
        return tuple(sum(x) / len(self.corners) for x in zip(*self.corners, strict=True))

    def steps(self, joints: Sequence[int]) -> set[Point]:
        """Return the steps from the middle to all corners, in some of the joints."""
        steps = [minus(q, self.middle) for q in self.corners]
        chosen = [tuple(step[j] for j in joints) for step in steps]
        return {*product(*map(set, zip(*chosen, strict=True)))} if self.is_box else {*chosen}

    def edges(self) -> list[Point]:
        """Return what the letters a, b, ... cut: the joints of a box, else the edges."""
        edges = [minus(b, a) for a, b in combinations(self.corners, 2)]
        if not self.is_box:
            return edges
        return [tuple(x * (i == j) for i in range(len(edges[0]))) for j, x in enumerate(edges[0])]

    def halves(self, letter: int) -> tuple[Cell, Cell]:
        """Cut at a middle; the first half keeps the low corner, or the first one of the edge."""
        demand(any(self.edges()[letter]) or not self.is_box, "a tree cuts a joint without a range")
        one, other, middle = [*self.corners], [*self.corners], self.middle
        if self.is_box:
            (low, high), j = self.corners, letter
            one[1], other[0] = ((*q[:j], middle[j], *q[j + 1 :]) for q in (high, low))
        else:
            i, k = [*combinations(range(len(one)), 2)][letter]
            one[k] = other[i] = Cell((one[i], one[k])).middle
        return Cell(tuple(one), self.is_box), Cell(tuple(other), self.is_box)


def box_of(ends: Sequence[tuple[Any, Any]]) -> Cell:
    return Cell(tuple(zip(*ends, strict=True)), is_box=True)


def leaves(cell: Cell, tree: str) -> Iterator[tuple[Cell, str]]:
    """Yield the leaves of a tree, each with its number or an empty text."""
    todo, at = [(cell, 0)], 0
    while todo:
        token, (top, depth) = TOKEN.match(tree, at), todo.pop()
        demand(token and depth <= 120, "a tree that is too deep, not well written, or ends early")
        at = token.end()
        if token[1]:
            one, other = top.halves(ord(token[1]) - ord("a"))
            todo += [(other, depth + 1), (one, depth + 1)]
        else:
            yield top, token[2] or ""
    demand(at == len(tree), "a tree goes on after its last leaf")


def everywhere(cell: Cell, attempt: Callable[[Cell], Sequence[float]]) -> None:
    """Refuse unless something holds all over a cell, which is halved as often as needed.

    `attempt` returns nothing where it holds, and else for each joint how much the bound suffers
    from its range; where it does not hold at the middle, it refuses itself.
    """
    todo, parts = [(cell, 0)], 0
    while todo:
        (top, depth), parts = todo.pop(), parts + 1
        if weights := attempt(top):
            costs = [
                sum(abs(w * float(x)) for w, x in zip(weights, e, strict=True)) for e in top.edges()
            ]
            demand(max(costs) > 0 and depth < DEEPEST and parts < MOST_CELLS, "not proved")
            todo += [(half, depth + 1) for half in top.halves(costs.index(max(costs)))]


# --- the arm in balls -----------------------------------------------------------------------------


class Link(NamedTuple):
    """The motion A + B cos q + C sin q of a joint, or A + B q of a slide."""

    joint: int
    turns: bool
    parts: tuple[Any, Any, Any]

    def at(self, q: Any) -> tuple[Any, Any]:
        """Return the motion and its derivative; without a value what no turn changes."""
        a, b, c = self.parts
        if q is None or not self.turns:
            return (a, None) if q is None else (a + b * q, b)
        return a + b * q.cos() + c * q.sin(), c * q.cos() - b * q.sin()


def affine(turn: Any, shift: Sequence[Any] = (0, 0, 0), last: int = 0) -> Any:
    """Return a matrix of four rows: nine entries, a shift, and the last one."""
    return arb_mat([*([*row, x] for row, x in zip(turn, shift, strict=True)), [0, 0, 0, last]])


def columns(places: Sequence[Point]) -> Any:
    return arb_mat([[*p, 1] for p in places]).transpose()


def norm(values: Sequence[Any]) -> Any:
    """Return an upper bound of the length of a vector of balls."""
    return sum((arb(x.abs_upper()) ** 2 for x in values), arb(0)).sqrt()


class Scene:
    """A claim, and the robot of a normal form in balls."""

    def __init__(self, form: Json, claim: Json) -> None:
        self.form, self.joints, self.unit = form, form["joints"], form["angle_unit"]
        self.kind, self.claim, self.margin = claim["set"], claim, decimal(claim["margin"])
        self.turns = [joint["turns"] for joint in self.joints]
        self.limits = [x["limits"] and [*map(rational, x["limits"])] for x in self.joints]
        degree = arb.pi() / 180 if self.unit == "deg" else arb(1)
        self.units = [degree if turns else arb(1) for turns in self.turns]
        self.points = [[self.configuration(q) for q in row] for row in claim["points"]]
        self.configurations = [*chain(*self.points)]
        demand(self.margin >= 0 and len(self.configurations) <= 20_000, "an unfit claim")
        self.hulls = [
            (x["frame"], [tuple(map(rational, p)) for p in x["corners"]]) for x in form["hulls"]
        ]
        self.steps = [self.link(step) for step in form["steps"]]
        lengths = [x for _, corners in self.hulls for p in corners for x in p]
        lengths += [rational(x) for step in form["steps"] for x in step["origin"]]
        slides = [x for x, turns in zip(self.limits, self.turns, strict=True) if not turns]
        lengths += [*chain(*slides), *map(self.gap, form["keep"])]
        self.largest_length = max(map(abs, lengths))

    def configuration(self, written: Sequence[str]) -> Point:
        q = tuple(map(decimal, written))
        angles = [abs(x) for x, turns in zip(q, self.turns, strict=True) if turns]
        demand(max(angles, default=0) <= LARGEST_ANGLE[self.unit], "a large angle")
        return q

    def beyond(self, q: Point) -> list[str]:
        """Return the names of the limits that a configuration violates."""
        found = list[str]()
        for joint, ends, x in zip(self.joints, self.limits, q, strict=True):
            found += [f"{joint['name']}.lower"] * bool(ends and x < ends[0])
            found += [f"{joint['name']}.upper"] * bool(ends and x > ends[1])
        return found

    def gap(self, row: Json) -> Any:
        return rational(row["gap"]) + self.margin

    def ends(self, row: Json) -> tuple[list[Point], list[Point], list[Link]]:
        """Return the corners of both hulls of a thing to keep, and the motions between them."""
        far, corners = self.hulls[row["far"]]
        near, places = self.hulls[row["near"]] if "near" in row else (0, [])
        return places, corners, self.links(near, far)

    def link(self, step: Json) -> Link:
        """Return the motion of a step: to its origin, by yaw, pitch and roll, then by its joint."""
        axis, mount = (
            [*map(rational, step["axis"])],
            affine(UNIT, [*map(rational, step["origin"])], 1),
        )
        for k in (2, 1, 0):
            angle, turn, i, j = rational(step["rpy"][k]), [[*row] for row in UNIT], k - 2, k - 1
            s, c = arb.sin_cos_pi_fmpq(angle / 180) if self.unit == "deg" else arb(angle).sin_cos()
            turn[i][i] = turn[j][j] = c
            turn[i][j], turn[j][i] = -s, s
            mount *= affine(turn, last=1)
        x, y, z = axis = [x / arb(dot(axis, axis)).sqrt() for x in axis]
        if not self.turns[step["joint"]]:
            return Link(step["joint"], False, (mount, mount * affine(ZERO, axis), affine(ZERO)))
        still = affine([[a * b for b in axis] for a in axis], last=1)
        spin = affine([[0, -z, y], [z, 0, -x], [-y, x, 0]]) * int(step["factor"])
        parts = mount * still, mount * (affine(UNIT, last=1) - still), mount * spin
        return Link(step["joint"], True, parts)

    def links(self, near: int, far: int) -> list[Link]:
        """Return the motions between two frames; both turns of a parallelogram are one shift."""
        found = list[Link]()
        for each, step in zip(self.steps[near:far], self.form["steps"][near:far], strict=True):
            link = each
            if found and found[-1].joint == link.joint:
                first, crank = found.pop().parts, columns([[*map(rational, step["origin"])]])
                shifts = [
                    affine(ZERO, (part * crank - part * columns([(0, 0, 0)])).entries()[:3])
                    for part in first
                ]
                link = Link(link.joint, True, (first[0] + first[1] + shifts[0], *shifts[1:]))
            found.append(link)
        return found

    def image(
        self, left: Any, links: Sequence[Link], right: Any, cell: Cell, free: Sequence[int] = ()
    ) -> tuple[Any, Slopes]:
        """Return left * motions * right at the middle of a cell, and its slopes all over the cell.

        `free` joints may turn anyhow: what they turn is left out.
        """

        def motions(values: Sequence[Any]) -> list[tuple[Any, Any]]:
            balls = [unit * x for unit, x in zip(self.units, values, strict=True)]
            q = [None if j in free and self.turns[j] else x for j, x in enumerate(balls)]
            return [link.at(q[link.joint]) for link in links]

        middle, before, after, slopes = left, left, [right], Slopes()
        for motion, _ in motions(cell.middle):
            middle = middle * motion
        ends = [(min(x), max(x)) for x in zip(*cell.corners, strict=True)]
        over = motions([arb(low).union(arb(high)) for low, high in ends])
        for motion, _ in over[::-1]:
            after.append(motion * after[-1])
        for k, (link, (motion, slope)) in enumerate(zip(links, over, strict=True)):
            if slope is not None and ends[link.joint][0] != ends[link.joint][1]:
                new = before * slope * after[len(links) - 1 - k]
                slopes[link.joint] = slopes[link.joint] + new if link.joint in slopes else new
            before = before * motion
        return middle * right, slopes

    def spread(self, middle: Any, slopes: Slopes, cell: Cell) -> list[list[Any]]:
        """Return, for each corner of a cell, balls that hold the entries.

        By the mean value theorem an entry at a place of the cell is that at the middle plus slopes
        times the step to the place, for some slopes of the cell. For given slopes this is linear in
        the step, and a length is convex in it: so each is extreme at a corner.
        """
        entries, joints = middle.entries(), [*slopes]
        if not joints:
            return [entries]
        units = [self.units[j] for j in joints]
        steps = [[u * x for u, x in zip(units, d, strict=True)] for d in cell.steps(joints)]
        rows = arb_mat(steps) * arb_mat([slopes[j].entries() for j in joints])
        return [[x + y for x, y in zip(entries, row, strict=True)] for row in rows.tolist()]

    def weights(self, all_slopes: Sequence[Slopes]) -> list[float]:
        """Return the largest slope along each joint, for a unit of the file."""
        found = [0.0] * len(self.joints)
        for j, slope in ((j, slope) for slopes in all_slopes for j, slope in slopes.items()):
            most = max(float(x.abs_upper()) for x in slope.entries())
            found[j] = max(found[j], most * float(self.units[j]))
        return found


# --- a set ----------------------------------------------------------------------------------------


def cells_of(scene: Scene) -> list[Cell]:
    """Return the cells of a set, in their order."""
    points = scene.configurations
    if scene.kind == "box":
        demand(all(x >= 0 for x in minus(points[1], points[0])), "a box upside down")
        return [Cell(tuple(points), is_box=True)]
    if scene.kind == "path":
        return [Cell(ends) for row in scene.points for ends in pairwise(row)]
    i, k = (j for j, x in enumerate(zip(*points, strict=True)) if min(x) != max(x))
    loops = [[(q[i], q[k]) for q in row] for row in scene.points]
    demand(all(len({*loop}) == len(loop) for loop in loops), "a loop passes a configuration twice")
    cells = [Cell(tuple(points[k] for k in row)) for row in scene.claim["triangles"]]
    demand_filled(loops, [[(q[i], q[k]) for q in cell.corners] for cell in cells])
    return cells


def check_set(scene: Scene, proof: Json) -> None:
    """Refuse unless on every leaf the direction that it names separates by the gap."""
    directions, cells = proof["directions"], cells_of(scene)
    demand(all(map(any, directions)), "a direction of length 0")
    for row, own in zip(scene.form["keep"], proof["trees"], strict=True):
        places, corners, links = scene.ends(row)
        is_kept = bool(places) and len(places) + len(corners) <= 3 and scene.gap(row) == 0
        for cell, tree in zip([] if is_kept else cells, own, strict=True):
            for leaf, number in leaves(cell, tree):
                demand(bool(number) == bool(places), "a leaf with a number, or without one")
                u = directions[int(number)] if number else [*map(rational, row["normal"])]
                demand(row.get("along") is None or not u[row["along"]], "a direction off the plane")
                need = scene.gap(row) * arb(dot(u, u)).sqrt()
                need += max((dot(u, p) for p in places), default=0)

                attempt = partial(above, scene, arb_mat([[*u, 0]]), links, columns(corners), need)
                everywhere(leaf, attempt)


def above(scene: Scene, left: Any, links: Any, right: Any, need: Any, cell: Cell) -> list[float]:
    """Return nothing if all entries exceed a number all over a cell; see `everywhere`."""
    middle, slopes = scene.image(left, links, right, cell)
    demand(all(x > need for x in middle.entries()), "not kept")
    rows = scene.spread(middle, slopes, cell)
    return [] if all(x > need for row in rows for x in row) else scene.weights([slopes])


# --- a place of two hulls -------------------------------------------------------------------------


class Place:
    """A place in each hull of a thing to keep; they come too near, whatever `free` joints do."""

    def __init__(self, scene: Scene, value: Json, free: Sequence[int] = ()) -> None:
        self.scene, self.row, self.free = scene, scene.form["keep"][value["keep"]], free
        self.near, self.far, self.links = scene.ends(self.row)
        p, r = mean(value["near"], self.near), mean(value["far"], self.far)
        self.right, self.need = columns([r]), scene.gap(self.row)
        self.axes = [k for k in range(3) if k != self.row.get("along")]
        normal = [*map(rational, self.row.get("normal", []))]
        heights = [[*(x / arb(dot(normal, normal)).sqrt() for x in normal), 0]] if normal else []
        self.left = arb_mat(heights or [[*UNIT[k], -p[k]] for k in self.axes])
        if "inside" in value:
            demand(self.row.get("along") is not None, "discs about points")
            radii = [*map(decimal, value["inside"])]
            for radius, place, part in zip(radii, (p, r), (self.near, self.far), strict=True):
                demand_inside(radius, place, part)
            self.need += sum(radii) - scene.largest_length * any(radii) / 2**40

    def attempt(self, cell: Cell) -> list[float]:
        """Return nothing if the distance is too small all over a cell; see `everywhere`."""
        image, spread = self.scene.image, self.scene.spread
        found = [image(self.left, self.links, self.right, cell, self.free)]
        for k, link in enumerate(self.links):
            if link.joint in self.free and link.turns:  # what it turns may point anywhere
                rest = self.links[k + 1 :]
                found.append(image(link.parts[1], rest, self.right, cell, self.free))
        sizes = [norm] * len(found)
        if "normal" in self.row:
            sizes[0] = lambda entries: entries[0]  # the height
        least = sum(size(m.entries()) for size, (m, _) in zip(sizes, found, strict=True))
        demand(least < self.need, "not violated")
        most = sum(
            max(arb(size(x).upper()) for x in spread(*each, cell))
            for size, each in zip(sizes, found, strict=True)
        )
        return [] if most < self.need else self.scene.weights([slopes for _, slopes in found])

    def crosses(self, q: Point) -> bool:
        """Tell whether two segments that keep no distance cross."""
        sizes = [len(self.near), len(self.far), len(self.axes)]
        if sizes != [2, 2, 2] or self.need != 0:
            return False
        seen = affine(UNIT, last=1)
        image, _ = self.scene.image(seen, self.links, columns(self.far), Cell((q,)))
        near, far = (
            [[p[k] for k in self.axes] for p in x] for x in (self.near, image.transpose().tolist())
        )
        return all(side(a, b[0]) * side(a, b[1]) < 0 for a, b in ((near, far), (far, near)))


def demand_inside(radius: Any, place: Point, part: Sequence[Point]) -> None:
    """Refuse a disc about a place of a part that does not lie within the part."""
    demand(radius == 0 or (radius > 0 and len(part) > 2), "a disc in what has no area")
    for a, b in around(part):
        e, d = minus(b, a), minus(place, b)
        cross = [e[i] * d[i - 2] - e[i - 2] * d[i] for i in range(3)]
        demand(dot(cross, cross) >= radius**2 * dot(e, e), "a disc beyond an edge")


def check_witness(scene: Scene, witness: Json) -> None:
    """Refuse unless something is violated at a configuration of the set."""
    demand(scene.kind != "no path", "a witness of no path")
    cells = cells_of(scene)
    demand(len(witness) == (2 if cells[0].is_box else 3), "a witness with other keys")
    if cells[0].is_box:
        q, (low, high) = scene.configuration(witness["at"]), cells[0].corners
        demand(all(x >= 0 for x in (*minus(q, low), *minus(high, q))), "beside the box")
    else:
        q = mean(witness["weights"], cells[witness["cell"]].corners)
    beyond = scene.beyond(q)
    if "limit" in witness:
        demand(witness["limit"] in beyond, "a limit that is kept")
    else:
        demand(not beyond, "beyond a limit")
        place = Place(scene, witness["place"])
        if not place.crosses(q):
            everywhere(Cell((q,)), place.attempt)


# --- no path --------------------------------------------------------------------------------------


def check_no_path(scene: Scene, proof: Json) -> None:
    """Refuse unless open leaves that hold the start lead to none that holds the goal."""
    [[start, goal]], words = scene.points, scene.claim["joints"]
    demand(len(words) == len(start) and "moves" in words, "other joints")
    moving, free = ([j for j, x in enumerate(words) if x == y] for y in ("moves", "any"))
    fixed = zip(words, start, goal, strict=True)
    demand(all(a == b for word, a, b in fixed if word == "held"), "a held joint has two values")
    half = HALF_TURN[scene.unit]
    ranges = [tuple(limits or (-half, half)) for limits in scene.limits]
    tree_of = [
        x if word == "moves" else (a, a) for word, x, a in zip(words, ranges, start, strict=True)
    ]
    places, opened = [Place(scene, row, free) for row in proof["places"]], list[Cell]()
    for leaf, number in leaves(box_of(tree_of), proof["tree"]):
        if number:
            ends = [*zip(*leaf.corners, strict=True)]
            for j in free:  # a slide that takes any value has its range
                ends[j] = ends[j] if scene.turns[j] else ranges[j]
            everywhere(box_of(ends), places[int(number)].attempt)
        else:
            opened.append(leaf)
    demand(opened, "no open leaf")
    touch = touching(scene, moving, [*(leaf.corners for leaf in opened), (start,) * 2, (goal,) * 2])
    _, island = connected_components(touch[:-2, :-2])
    one, other = ({*island[row[:-2]].tolist()} for row in touch[-2:])
    demand(one and other, "the start or the goal is on no open leaf")
    demand(not one & other, "open leaves lead from the start to the goal")


def touching(scene: Scene, moving: Sequence[int], boxes: Sequence[tuple[Point, ...]]) -> Any:
    """Tell which boxes touch each other, over seams too; shape (boxes, boxes)."""
    found = np.ones((len(boxes),) * 2, dtype=bool)
    for j in moving:
        near = TOUCHING * (1 if scene.turns[j] else float(scene.largest_length))
        unit = float(scene.units[j])
        low, high = np.array([[unit * float(q[j]) for q in box] for box in boxes]).T
        shifts = [0.0] if scene.limits[j] else [-2 * np.pi, 0.0, 2 * np.pi]
        for ends in (low, high) if len(shifts) > 1 else ():
            ends[-2:] -= 2 * np.pi * np.round(ends[-2:] / (2 * np.pi))
        found &= np.any(
            [(low[:, None] <= high + x + near) & (low + x <= high[:, None] + near) for x in shifts],
            axis=0,
        )
    return found
