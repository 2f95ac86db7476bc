"""Certificates made with the checker's own inequality, without any prover; and changes of them."""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import Any

import shapely

from cspace import check
from cspace.geometry.convex import exact_parts
from engine_support import second_checker

Json = Any
Change = Callable[[Json], None]


class NotFound(ValueError):
    """This search found neither a proof nor a witness; which says nothing."""


# --- robots in bodies -----------------------------------------------------------------------------


def parts_of(robot: str) -> Json:
    """Cut the outlines of a robot that are not convex into convex parts."""
    table = tomllib.loads(robot, parse_float=Fraction)
    rows = [row for row in [*table.get("body", []), *table.get("obstacle", [])] if "polygon" in row]
    cut = {row["name"]: exact_parts(row["polygon"]) for row in rows if "name" in row}
    return {name: parts for name, parts in cut.items() if len(parts) > 1}


# --- the file -------------------------------------------------------------------------------------


class Draft:
    """A claim about a robot, read by the checker's own reader."""

    def __init__(self, robot: str, claim: Json, parts: Json = None) -> None:
        check.Work.done = 0
        self.text, self.parts = robot, parts_of(robot) if parts is None else parts
        self.written = {"margin": "0"} | claim
        self.robot = check.read_robot(robot, self.parts)
        self.claim = check.read_claim(self.written, self.robot)
        self.arm = check.Arm(self.robot, self.claim.margin)
        self.steps = self.arm.steps

    @property
    def cells(self) -> list[check.Cell]:
        make = check.Box if self.claim.kind == "box" else check.Cell
        return [make(tuple(map(self.arm.placed, corners))) for corners in self.claim.corners]

    def file(self, **evidence: Json) -> Json:
        """Return the certificate around some evidence."""
        digest = check.digest(check.canonical(self.robot.form))
        head = {"schema": check.SCHEMA, "robot": self.text, "parts": self.parts}
        return head | {"sha256": digest, "claim": self.written} | evidence


def longest(cell: check.Cell, joints: Sequence[int]) -> int:
    """Return the number of the longest edge, or of the widest joint."""
    if isinstance(cell, check.Box):
        return max(joints, key=lambda j: cell.ends[1][j] - cell.ends[0][j])
    edges = [*itertools.combinations(cell.ends, 2)]
    return max(range(len(edges)), key=lambda k: math.dist(*edges[k]))


# --- what is kept ---------------------------------------------------------------------------------


def proved(robot: str, claim: Json, parts: Json = None, depth: int = 14) -> Json:
    """Prove that all is kept on a set: halve cells until a direction holds."""
    draft, known = Draft(robot, claim, parts), dict[tuple[int, ...], int]()
    joints, cells = range(len(draft.arm.joints)), draft.cells

    def tree(keep: check.Keep, cell: check.Cell, left: int) -> str:
        leaf = check.Leaf(draft.steps, cell)
        for row in directions(keep, leaf):
            u = check.unit(row) if keep.normal is None else keep.normal
            if check.is_kept(leaf, keep, u):
                return f"{known.setdefault(row, len(known))}." if row else "."
        if not left:
            raise NotFound(f"{keep.name} is not proved")
        letter = longest(cell, joints)
        return chr(97 + letter) + "".join(tree(keep, h, left - 1) for h in cell.halves(letter))

    trees = [
        [] if check.claims_nothing(keep) else [tree(keep, cell, depth) for cell in cells]
        for keep in draft.arm.keeps
    ]
    return draft.file(proof={"directions": [*map(list, known)], "trees": trees})


def directions(keep: check.Keep, leaf: check.Leaf) -> Iterator[tuple[int, ...]]:
    """Yield what may separate two hulls: steps between corners, and normals of edges."""
    if keep.normal is not None:
        yield ()
        return
    first = keep.near.frame
    near = [seen(leaf, first, first, p) for p in keep.near.corners]
    far = [seen(leaf, first, keep.far.frame, p) for p in keep.far.corners]
    steps = [[y - x for x, y in zip(p, r, strict=True)] for p in near for r in far]
    if keep.along is not None:
        i, k = (x for x in range(3) if x != keep.along)
        for hull in (near, far):
            for p, r in zip(hull, [*hull[1:], hull[0]], strict=True):
                for sign in (1, -1):
                    normal = [0.0, 0.0, 0.0]
                    normal[i], normal[k] = sign * (r[k] - p[k]), -sign * (r[i] - p[i])
                    steps.append(normal)
    for step in steps:
        row = [0.0 if k == keep.along else x for k, x in enumerate(step)]
        if (length := math.hypot(*row)) > 1e-12:
            yield tuple(round(x / length * 10**5) for x in row)


def seen(leaf: check.Leaf, near: int, frame: int, corner: check.Vector) -> list[float]:
    turned, at = leaf.frames[near]
    step = check.minus(leaf.place(frame, corner), at)
    return [check.dot(column, step) / check.ONE for column in turned]


# --- what is not kept -----------------------------------------------------------------------------


def places(draft: Draft) -> list[Json]:
    """Return places of each pair of hulls: corners and middles, with discs as large as may be."""
    found = []
    for number, row in enumerate(draft.arm.rows):
        choices = []
        for end in ("near", "far"):
            if end not in row:
                choices.append([([], Fraction(0))])
                continue
            frame, corners = (draft.arm.hulls[row[end]][key] for key in ("frame", "corners"))
            flat = [k for k in range(3) if k != draft.robot.flat.get(frame)]
            shares = [[int(k == j) for j in range(len(corners))] for k in range(len(corners))]
            shares += [[1, 1], [1, 3], [3, 1]] if len(corners) == 2 else []
            shares += [[1] * len(corners)] if len(corners) > 2 else []
            choices.append([(w, disc(w, corners, flat)) for w in map(weights, shares)])
        for near, far in itertools.product(*choices):
            place = {"keep": number, "near": near[0], "far": far[0]}
            if row.get("along") is not None:
                place["inside"] = [written(near[1]), written(far[1])]
            found.append(place)
    return found


def weights(shares: Sequence[int]) -> list[str]:
    """Write shares as decimals whose sum is 1."""
    found = [Fraction(round(Fraction(x, sum(shares)) * 1000), 1000) for x in shares]
    found[0] += 1 - sum(found)
    return [*map(check.exactly, found)]


def written(x: Fraction) -> str:
    return check.exactly(Fraction(math.floor(x * 10**9), 10**9))


def disc(shares: Sequence[str], corners: Sequence[check.Exact], seen: Sequence[int]) -> Fraction:
    """Return nearly the largest radius of a disc about a place of a hull that lies within."""
    if len(corners) < 3:
        return Fraction(0)
    at = check.mean([*map(Fraction, shares)], corners)
    flat = [[float(p[k]) for k in seen] for p in (at, *corners)]
    place, *loop = map(shapely.Point, flat)
    depth = shapely.LinearRing(loop).distance(place)
    return Fraction(max(0, depth - 1e-9))


def refuted(robot: str, claim: Json, parts: Json = None, **where: Json) -> Json:
    """Refute a claim at a place: `at` of a box, else `cell` and `weights`."""
    draft = Draft(robot, claim, parts)
    for limit in beyond(draft, where):
        return draft.file(witness={**where, "limit": limit})
    for place in places(draft):
        witness = {**where, "place": place}
        try:
            check.refute(draft.arm, draft.claim, witness)
        except check.Refused:
            continue
        return draft.file(witness=witness)
    raise NotFound("nothing is violated there")


def beyond(draft: Draft, where: Json) -> list[str]:
    q = tuple(map(Fraction, where["at"])) if "at" in where else None
    shares = [*map(Fraction, where.get("weights", []))]
    return draft.robot.beyond(q or check.mean(shares, draft.claim.corners[where["cell"]]))


def no_path(robot: str, claim: Json, parts: Json = None, depth: int = 9) -> Json:
    """Cover with leaves on which something is violated; leave the smallest ones open."""
    draft = Draft(robot, {"set": "no path"} | claim, parts)
    read, arm, kinds = check.read_spots(draft.arm), draft.arm, draft.claim.joints
    start = arm.placed(draft.claim.loops[0][0])
    ends = [arm.whole_range(j) if k != "held" else (start[j],) * 2 for j, k in enumerate(kinds)]
    free = {j: (ends[j][1] - ends[j][0] + 3) >> 1 for j, kind in enumerate(kinds) if kind == "any"}
    ends = [((a + b) >> 1,) * 2 if j in free else (a, b) for j, (a, b) in enumerate(ends)]
    known = [(place, *read(place, "")) for place in places(draft)]
    used = list[Json]()
    moving = [j for j, kind in enumerate(kinds) if kind == "moves"]

    def tree(cell: check.Box, left: int) -> str:
        leaf = check.Leaf(draft.steps, cell, free)
        for place, keep, read_one in known:
            if check.is_violated(leaf, keep, read_one):
                used.extend([place] if place not in used else [])
                return f"{used.index(place)}."
        if not left:
            return "."
        letter = longest(cell, moving)
        first, second = (tree(half, left - 1) for half in cell.halves(letter))
        return "." if first == second == "." else chr(97 + letter) + first + second

    found = tree(check.Box(tuple(zip(*ends, strict=True))), depth)
    return draft.file(proof={"places": used, "tree": found})


# --- changes --------------------------------------------------------------------------------------


def put(*path: Any) -> Change:
    """Return what puts a value, or a function of the old one, at a place of a certificate."""
    *steps, last, value = path

    def change(data: Json) -> None:
        for step in steps:
            data = data[step]
        data[last] = value(data[last]) if callable(value) else value

    return change


def drop(*path: Any) -> Change:
    """Return what takes a key or an item out."""
    *steps, last = path

    def change(data: Json) -> None:
        for step in steps:
            data = data[step]
        del data[last]

    return change


def in_robot(old: str, new: str) -> Change:
    """Return what changes the robot's text, and the hash if the text is still that of a robot."""

    def change(data: Json) -> None:
        assert old in data["robot"]
        data["robot"] = data["robot"].replace(old, new, 1)
        rehash(data)

    return change


def rehash(data: Json) -> None:
    """Make the hash fit the robot, if a checker reads it."""
    for form_of in (check.normal_form, second_checker.normal_form):
        try:
            form = form_of(data.get("robot", ""), data.get("parts"))
        except (AttributeError, LookupError, TypeError, ValueError):
            continue
        data["sha256"] = check.digest(check.canonical(form))
        return
