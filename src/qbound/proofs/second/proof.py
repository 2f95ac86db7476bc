"""Proofs and witnesses of a certificate, checked against the forms of its robot."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from itertools import product
from operator import mul
from typing import Any, NamedTuple

from flint import acb, acb_mat, arb, ctx, fmpq

from qbound.proofs import Verdict
from qbound.proofs.second.cells import HOLDS, Box, Cell, Node, cells_of, holds, nodes
from qbound.proofs.second.normal import Form as NormalForm
from qbound.proofs.second.normal import canonical, normal_form
from qbound.proofs.second.reading import (
    MOST_BYTES,
    MOST_POINTS,
    NO_PATH,
    SCHEMA,
    Claim,
    Point,
    Work,
    configuration,
    decimal,
    demand,
    exact,
    index,
    items,
    read_claim,
    read_json,
    shown,
    table_of,
    text_of,
    weights_of,
)
from qbound.proofs.second.waves import (
    Chain,
    Form,
    Key,
    Terms,
    halved,
    held,
    highest,
    largest,
    norm,
    swing,
)

BITS = 192
WITNESS_BITS = 640
"""Bits at a witness, which may violate something in the fortieth digit only."""

MOST_DIRECTIONS = 20_000

DEEPEST_HERE = 14
"""Cuts of a leaf on top of each other, where the bound of this checker is the weaker one."""

MOST_NUMBERS = 500_000
"""Balls in the forms that are remembered, some 100 bytes each."""

LETTER_WORK, NODE_WORK, CORNER_WORK = 100, 3, 15
"""Microseconds for each node that is kept, for each one that is compared, and for each corner of a
place."""

TOUCHING = fmpq(1, 2**100)
"""Leaves nearer than this, in radians or parts of the largest length, count as touching."""

TILT = fmpq(1, 10**9)
"""Parts of the largest length that discs need to spare: planes of frames may differ that much."""


def verified(text: str | bytes) -> Verdict:
    """Return what a certificate proves; see `qbound.proofs.second.verify`."""
    with ctx.workprec(BITS):
        try:
            return _verified(text)
        except (ValueError, MemoryError):
            raise
        except Exception as error:  # a bug of this checker is not an answer
            raise ValueError("the check of this file failed") from error


def _verified(text: str | bytes) -> Verdict:
    data, work = read_json(text), Work()
    shows = "witness" if isinstance(data, dict) and "witness" in data else "proof"
    table_of(data, "the file", ("schema", "robot", "parts", "sha256", "claim", shows))
    demand(data["schema"] == SCHEMA, f"the schema is not {SCHEMA}")
    form = normal_form(data["robot"], data["parts"], work)
    sha256 = hashlib.sha256(canonical(form).encode()).hexdigest()
    demand(data["sha256"] == sha256, "the hash is not that of the robot's normal form")
    claim = read_claim(data["claim"], form)
    if shows == "witness":
        with ctx.workprec(WITNESS_BITS):
            _check_witness(Scene(form, claim, work), data["witness"])
        return Verdict.REFUTED
    scene = Scene(form, claim, work)
    for point in claim.points:
        demand(not scene.beyond(point), "a configuration of the claim is beyond a limit")
    (_check_no_path if claim.kind == NO_PATH else _check_set)(scene, data["proof"])
    return Verdict.PROVED


class Hull(NamedTuple):
    """Corners of a frame, exact."""

    frame: int
    corners: list[list[Any]]


class Keep(NamedTuple):
    """A thing to keep: two hulls, or a half-space and a hull, and the distance with the margin."""

    name: str
    near: Hull
    far: Hull
    gap: Any
    along: int | None
    normal: list[Any]

    @property
    def axes(self) -> list[int]:
        """The coordinates that count: all, or only those across the common axis."""
        return [k for k in range(3) if k != self.along]


class _Memory:
    """A cache of forms that several leaves use; it is emptied when it gets too large."""

    def __init__(self) -> None:
        self.known: dict[int | str, tuple[list[Form], Any]] = {}
        self.size = 0

    def get(
        self, key: int | str, make: Callable[[], tuple[list[Form], Any]]
    ) -> tuple[list[Form], Any]:
        """Return forms with their number from the cache, or make them."""
        if key not in self.known:
            found = make()
            size = sum(form.size for form in found[0])
            if self.size + size > MOST_NUMBERS:
                self.known, self.size = {}, 0
            self.known[key], self.size = found, self.size + size
        return self.known[key]


class Scene:
    """A robot in balls, what it keeps, and a claim about it."""

    def __init__(self, form: NormalForm, claim: Claim, work: Work) -> None:
        self.form, self.claim, self.work = form, claim, work
        self.chain, self.memory = Chain(form, work), _Memory()
        hulls = [Hull(h["frame"], [[*map(exact, p)] for p in h["corners"]]) for h in form["hulls"]]
        self.keep = [
            Keep(
                row["name"],
                hulls[row["near"]] if "near" in row else Hull(0, []),
                hulls[row["far"]],
                exact(row["gap"]) + claim.margin,
                row.get("along"),
                [*map(exact, row.get("normal", []))],
            )
            for row in form["keep"]
        ]
        self.limits: list[Any] = [
            None if joint["limits"] is None else [*map(exact, joint["limits"])]
            for joint in form["joints"]
        ]

    @cached_property
    def reach(self) -> list[Any]:
        """The largest value of each joint in the claim and its limits; radians or lengths."""
        columns = zip(*self.claim.points, strict=True)
        ends = [largest([*c, *(x or ())]) for c, x in zip(columns, self.limits, strict=True)]
        return self.chain.scaled(range(len(ends)), ends)

    @cached_property
    def largest_length(self) -> Any:
        """The largest length of the robot and the claim."""
        places = [place for hull in self.form["hulls"] for place in hull["corners"]]
        places += [step["origin"] for step in self.form["steps"]]
        places += [joint["limits"] for joint in self.form["joints"] if not joint["turns"]]
        lengths = [exact(x) for place in places for x in place]
        return max(map(abs, [*lengths, *(keep.gap for keep in self.keep)]))

    def beyond(self, point: Point) -> list[str]:
        """Return the names of all limits that a configuration violates."""
        found = []
        for joint, limits, x in zip(self.form["joints"], self.limits, point, strict=True):
            if limits is not None:
                found += [f"{joint['name']}.lower"] * (x < limits[0])
                found += [f"{joint['name']}.upper"] * (x > limits[1])
        return found

    def between(self, keep: Keep) -> list[int]:
        """Return the joints between the frames of both hulls."""
        steps = self.form["steps"][keep.near.frame : keep.far.frame]
        return sorted({step["joint"] for step in steps})

    def seen(self, keep: Keep, corners: Sequence[Sequence[Any]]) -> Terms:
        """Return the waves of places of the far frame, as columns, seen from the near one."""
        places = acb_mat([[*place, 1] for place in corners]).transpose()
        terms = self.chain.terms(keep.near.frame, keep.far.frame)
        self.work.add(len(terms) * (4 + len(corners)))
        return {key: pose * places for key, pose in terms.items()}


def _dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    return sum(map(mul, u, v))


# --- a set ----------------------------------------------------------------------------------------


def _check_set(scene: Scene, proof: Any) -> None:
    """Refuse unless the first inequality holds on all leaves of all trees."""
    table = table_of(proof, "proof", ("directions", "trees"))
    directions = items(table["directions"], "directions", 0, MOST_DIRECTIONS)
    for row in directions:
        whole = all(type(x) is int for x in items(row, "directions", 3, 3))
        demand(whole and any(row), "directions: not three integers, or all of them 0")
    cells = cells_of(scene.claim)
    trees = items(table["trees"], "trees", len(scene.keep), len(scene.keep))
    for keep, rows in zip(scene.keep, trees, strict=True):
        few = not keep.normal and len(keep.near.corners) + len(keep.far.corners) <= 3
        needed = [] if few and keep.gap == 0 else cells
        kept = _Kept(scene, keep, directions)
        own = items(rows, f"trees of {shown(keep.name)}", len(needed), len(needed))
        for cell, tree in zip(needed, own, strict=True):
            for node in nodes(cell, tree, scene.work):
                if node.number is not None:
                    kept.check(node.cell, node.number)


class _Kept:
    """The first inequality for one thing to keep."""

    def __init__(self, scene: Scene, keep: Keep, directions: Sequence[Sequence[int]]) -> None:
        self.scene, self.keep, self.directions = scene, keep, directions
        self.memory = _Memory()

    def check(self, cell: Cell, number: str) -> None:
        """Refuse unless the far hull is far enough along a direction, all over a cell."""
        [form], need = self.memory.get(number, partial(self.form, number))
        why = f"{shown(self.keep.name)} is not proved on every leaf"
        holds(cell, partial(is_above, form, need), DEEPEST_HERE, why)

    def form(self, number: str) -> tuple[list[Form], Any]:
        """Return direction . place for all far corners, and the number that each has to exceed."""
        keep, u = self.keep, self.keep.normal
        if u:
            demand(not number, "a leaf of a half-space names a direction")
        else:
            demand(number and int(number) < len(self.directions), "a leaf names no direction")
            u = [fmpq(x) for x in self.directions[int(number)]]
            flat = keep.along is None or u[keep.along] == 0
            demand(flat, "a direction leaves the plane in which bodies are compared")
        rows = {key: acb_mat([u]) * value for key, value in self._seen.items()}
        self.scene.work.add(len(rows) * (15 + 8 * len(keep.far.corners)))
        form = Form(self.scene.chain, self._joints, rows, self.scene.reach)
        nearest = max((_dot(u, p) for p in keep.near.corners), default=fmpq(0))
        return [form], nearest + keep.gap * arb(_dot(u, u)).sqrt()

    @cached_property
    def _joints(self) -> list[int]:
        return self.scene.between(self.keep)

    @cached_property
    def _seen(self) -> Terms:
        return halved(self.scene.seen(self.keep, self.keep.far.corners), ())


def is_above(form: Form, need: Any, cell: Cell) -> int | None:
    """Tell whether all functions exceed a number all over a cell; else return the best cut."""
    linear, errors = form.over(cell)
    for values, bounds in zip(linear.tolist(), errors.tolist(), strict=True):
        for value, error in zip(values, bounds, strict=False):  # the values' real parts
            if not value - error > need:
                return form.best_cut(cell)
    return HOLDS


# --- places, and how near they are ----------------------------------------------------------------


class Place:
    """A place in each hull, and the upper bound of their distance over the joints that move.

    Joints in `moving` move. Joints in `values` have a fixed value, rad or length. All other joints
    take any value within their limits.
    """

    def __init__(
        self, scene: Scene, value: Any, moving: Sequence[int], values: Mapping[int, Any]
    ) -> None:
        others = ["inside"] if isinstance(value, dict) and "inside" in value else []
        table = table_of(value, "place", ("keep", "near", "far", *others))
        self.scene, self.moving, self.values = scene, moving, values
        self.keep = scene.keep[index(table["keep"], "place", len(scene.keep))]
        parts = self.keep.near.corners, self.keep.far.corners
        scene.work.add(CORNER_WORK * sum(map(len, parts)))
        self.near, self.far = (
            _mean(weights_of(table[end], end, len(part)), part)
            for end, part in zip(("near", "far"), parts, strict=True)
        )
        self.need = self.keep.gap
        if others:
            demand(self.keep.along is not None, "inside: of pairs of bodies only")
            radii = [decimal(x, "inside") for x in items(table["inside"], "inside", 2, 2)]
            for radius, place, part in zip(radii, (self.near, self.far), parts, strict=True):
                _check_inside(radius, place, part)
                self.need += radius
            self.need -= TILT * scene.largest_length * (max(radii) > 0)

    def _prepared(self) -> tuple[list[Form], Any]:
        """Return vectors and a number; their lengths plus the number bound the distance.

        Waves are grouped by their turns in the joints that take any value. The group with turns 0
        comes first, and its vector is known. The joints may swing the vectors of the other groups
        in any direction.
        """
        scene, keep, chain = self.scene, self.keep, self.scene.chain
        joints = scene.between(keep)
        own = [j for j in joints if j in self.moving]
        free = [j for j in joints if j not in self.moving and j not in self.values]
        start: Key = (tuple(0 for _ in chain.turns), None)
        terms = scene.seen(keep, [self.far])
        if keep.normal:
            seen = acb_mat([[x / arb(_dot(keep.normal, keep.normal)).sqrt() for x in keep.normal]])
        else:
            terms[start] = terms.get(start, acb_mat(3, 1)) - acb_mat([[x] for x in self.near])
            seen = acb_mat([[int(i == k) for i in range(3)] for k in keep.axes])
        terms = {key: seen * value for key, value in terms.items()}
        slides = {j: scene.limits[j] for j in free if not chain.turns[j]}
        rest = arb(0)
        for (_, slide), value in terms.items():
            if slide in slides:
                low, high = slides[slide]
                rest += swing(value.entries()) * (high - low) / 2
        middles = {j: arb((low + high) / 2) for j, (low, high) in slides.items()}
        terms = halved(held(terms, {**self.values, **middles}), free)
        groups: dict[tuple[int, ...], Terms] = {tuple(0 for _ in free): {}}
        for (turns, slide), value in terms.items():
            groups.setdefault(tuple(turns[j] for j in free), {})[turns, slide] = value
        zero: Terms = {start: acb_mat(seen.nrows(), 1)}
        parts = [group or zero for group in groups.values()]
        return [Form(chain, own, part, scene.reach, together=True) for part in parts], rest

    def is_violated(self, cell: Cell) -> int | None:
        """Tell whether the distance is too small all over a cell; else return the best cut."""
        distance, worst = self.distance(cell)
        return HOLDS if distance < self.need else worst.best_cut(cell)

    def distance(self, cell: Cell) -> tuple[Any, Form]:
        """Return a bound of the distance or height all over a cell, and the least exact form."""
        forms, total = self.scene.memory.get(id(self), self._prepared)
        worst = (-1.0, forms[0])
        for form in forms:
            linear, errors = form.over(cell)
            rows = zip(linear.tolist(), errors.tolist(), strict=True)
            total += highest(
                [self._length(row, form.count, form is forms[0]) + e for row, [e] in rows]
            )
            error = max(float(row[0]) for row in errors.tolist())
            worst = max(worst, (error, form), key=lambda pair: pair[0])
        return total, worst[1]

    def _length(self, values: Sequence[Any], count: int, known: bool) -> Any:
        """Return a bound of the length of a vector or its swing; for a half-space the height."""
        if known:
            return values[0] if self.keep.normal else norm(values[:count])
        return swing([acb(x, y) for x, y in zip(values[:count], values[count:], strict=True)])

    def crosses(self) -> bool:
        """Tell whether two segments without a distance cross, all joints at their values."""
        keep, scene = self.keep, self.scene
        sizes = [len(hull.corners) for hull in (keep.near, keep.far)]
        if sizes != [2, 2] or keep.gap != 0 or keep.along is None:
            return False
        [found] = held(scene.seen(keep, keep.far.corners), self.values).values()
        columns = zip(*found.tolist(), strict=True)
        far = [[column[k].real for k in keep.axes] for column in columns]
        near = [[arb(corner[k]) for k in keep.axes] for corner in keep.near.corners]
        return all(
            _side(line, ends[0]) * _side(line, ends[1]) < 0
            for line, ends in ((near, far), (far, near))
        )


def _side(line: Sequence[Any], p: Sequence[Any]) -> Any:
    a, b = line
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def _mean(weights: Sequence[Any], places: Sequence[Sequence[Any]]) -> list[Any]:
    return [_dot(weights, column) for column in zip(*places, strict=True)]


def _check_inside(radius: Any, place: Sequence[Any], part: Sequence[Sequence[Any]]) -> None:
    """Refuse a disc about a place of a part unless the disc lies within the part."""
    demand(radius >= 0, "inside: a radius is negative")
    demand(radius == 0 or len(part) > 2, "inside: a disc about a place of a part without an area")
    for k, b in enumerate(part):
        e = [x - y for x, y in zip(b, part[k - 1], strict=True)]
        d = [x - y for x, y in zip(place, b, strict=True)]
        cross = [e[i] * d[i - 2] - e[i - 2] * d[i] for i in range(3)]
        far = _dot(cross, cross) >= radius**2 * _dot(e, e)
        demand(far, "inside: a disc reaches beyond an edge of its part")


# --- no path --------------------------------------------------------------------------------------


def _check_no_path(scene: Scene, proof: Any) -> None:
    """Refuse unless open leaves that hold the start lead to none that holds the goal."""
    table = table_of(proof, "proof", ("places", "tree"))
    kinds, [start, goal] = scene.claim.joints, scene.claim.points
    moving = [j for j, kind in enumerate(kinds) if kind == "moves"]
    fixed = [j for j, kind in enumerate(kinds) if kind == "held"]
    values = dict(zip(fixed, scene.chain.scaled(fixed, [start[j] for j in fixed]), strict=True))
    rows = items(table["places"], "places", 0, MOST_POINTS)
    places = [Place(scene, row, moving, values) for row in rows]
    tree = text_of(table["tree"], "tree", MOST_BYTES)
    scene.work.add(LETTER_WORK * len(tree))
    found = list(nodes(whole_box(scene, moving), tree, scene.work))
    for node in found:
        if node.number:
            demand(int(node.number) < len(places), "a leaf names a place that is not there")
            place = places[int(node.number)]
            why = f"{shown(place.keep.name)} is not violated all over a leaf"
            holds(node.cell, place.is_violated, DEEPEST_HERE, why)
    leaves = _Leaves(scene, moving, found)
    reached, ends = leaves.reached(start), leaves.at(goal)
    demand(reached and ends, "the start or the goal is on no open leaf")
    demand(not reached & ends, "open leaves lead from the start to the goal")


def whole_box(scene: Scene, moving: Sequence[int]) -> Box:
    """Return the box of all values of moving joints; the others are 0 and do not matter."""
    half = fmpq(180) if scene.form["angle_unit"] == "deg" else fmpq(31416, 10**4)
    ends = [
        (limits or (-half, half)) if j in moving else (fmpq(0), fmpq(0))
        for j, limits in enumerate(scene.limits)
    ]
    return Box(tuple(zip(*ends, strict=True)))


class _Leaves:
    """The leaves of a tree in preorder, and which open ones touch; joints without limits close."""

    def __init__(self, scene: Scene, moving: Sequence[int], found: Sequence[Node]) -> None:
        self.work, self.moving, self.chain = scene.work, moving, scene.chain
        self.is_open = [node.number == "" for node in found]
        self.boxes = [[*map(self._scaled, node.cell.corners)] for node in found]
        self.after = [0] * len(found)  # the node after all nodes within this one
        for k in reversed(range(len(found))):
            leaf = found[k].number is not None
            self.after[k] = k + 1 if leaf else self.after[self.after[k + 1]]
        sizes = [1 if turns else scene.largest_length for turns in scene.chain.turns]
        self.near = [TOUCHING * sizes[j] for j in moving]
        self.seams = [scene.limits[j] is None for j in moving]

    def _scaled(self, point: Point) -> list[Any]:
        return self.chain.scaled(self.moving, [point[j] for j in self.moving])

    def at(self, point: Point) -> set[int]:
        """Return the open leaves that may hold a configuration."""
        turn, place = 2 * arb.pi(), list[Any]()
        for x, seam in zip(self._scaled(point), self.seams, strict=True):
            place.append(x - turn * math.floor(float(x / turn) + 0.5) if seam else x)
        return self._touching(place, place)

    def reached(self, start: Point) -> set[int]:
        """Return the open leaves that chains of touching ones join to the start."""
        found = self.at(start)
        todo = list(found)
        while todo:
            new = self._touching(*self.boxes[todo.pop()]) - found
            found |= new
            todo += new
        return found

    def _touching(self, low: Sequence[Any], high: Sequence[Any]) -> set[int]:
        """Return the open leaves that touch a box, or the box shifted by a turn."""
        found = set[int]()
        for turns in product(*((-1, 0, 1) if seam else (0,) for seam in self.seams)):
            shift = [2 * k * arb.pi() for k in turns]
            a = [x + s - e for x, s, e in zip(low, shift, self.near, strict=True)]
            b = [x + s + e for x, s, e in zip(high, shift, self.near, strict=True)]
            k, count = 0, 0
            while k < len(self.boxes):
                count += 1
                ends = zip(*self.boxes[k], a, b, strict=True)
                if any(upper < c or d < lower for lower, upper, c, d in ends):
                    k = self.after[k]
                    continue
                if self.is_open[k]:
                    found.add(k)
                k += 1
            self.work.add(NODE_WORK * (count + len(turns)))
        return found


# --- a witness ------------------------------------------------------------------------------------


def _check_witness(scene: Scene, value: Any) -> None:
    """Refuse unless something is violated at the configuration that a witness names."""
    demand(scene.claim.kind != NO_PATH, f"a witness does not refute a claim of {NO_PATH}")
    cells = cells_of(scene.claim)
    box = cells[0] if isinstance(cells[0], Box) else None
    where = ("cell", "weights") if box is None else ("at",)
    what = "limit" if isinstance(value, dict) and "limit" in value else "place"
    table = table_of(value, "witness", (*where, what))
    if box is None:
        corners = cells[index(table["cell"], "cell", len(cells))].corners
        point = tuple(_mean(weights_of(table["weights"], "weights", len(corners)), corners))
    else:
        point = configuration(table["at"], "at", scene.form)
        ends = zip(*box.corners, point, strict=True)
        demand(all(a <= x <= b for a, b, x in ends), "the witness is not in the box of the claim")
    if what == "limit":
        limit = table["limit"]
        demand(isinstance(limit, str) and limit in scene.beyond(point), "the limit is not violated")
        return
    demand(not scene.beyond(point), "the witness is beyond a limit, and names a place")
    joints = range(len(point))
    values = dict(zip(joints, scene.chain.scaled(joints, point), strict=True))
    place = Place(scene, table["place"], [], values)
    violated = place.is_violated(Box((point, point))) == HOLDS or place.crosses()
    demand(violated, f"{shown(place.keep.name)} is not violated at the witness")
