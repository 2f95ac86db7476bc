"""A judge of regions of bodies that shares nothing with the library: it says what is wrong.

It reads the file itself. Frames are complex numbers, distances are shapely's. Components are judged
by a flood fill of cells that are surely free: every place of the cell, by how fast bodies move.
Lengths are in a power of ten near the robot's size, so that tolerances are parts of that size.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property, lru_cache
from itertools import combinations
from math import pi, radians
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from engine_support.body_scenes import plane_of, read
from engine_support.regions import flood

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]
Bools = NDArray[np.bool_]

ON = 1e-9
"""An arc lies on its boundary where the margin, beside the robot's size, is no larger."""

MEET = 1e-7
"""Ends of arcs this close are one place: of a double root no more is known."""

ASIDE = 1e-5
"""How far beside an arc one side is free and the other is not (rad, or parts of the size)."""

ROUNDED = 1e-12
"""A margin this small, beside the robot's size, may be rounding."""

SAME_AREA = 1e-9
"""Areas of the same region differ by no larger part of their sum."""

COARSE = 32


# --- a scene --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Thing:
    """A body or a sphere: its core, a point, a segment or a polygon, in its frame's plane."""

    depth: int
    core: Complex
    radius: float
    height: float = 0.0

    @property
    def solid(self) -> bool:
        return len(self.core) > 2

    @cached_property
    def disc(self) -> tuple[complex, float]:
        """Middle and radius of a disc about the core."""
        middle = (self.core.real.min() + self.core.real.max()) / 2 + 1j * (
            self.core.imag.min() + self.core.imag.max()
        ) / 2
        return middle, float(np.abs(self.core - middle).max())


@dataclass(frozen=True)
class Gap:
    """Two things that keep apart, the one nearer to the base first."""

    name: str
    one: Thing
    other: Thing
    kept: float


@dataclass(frozen=True)
class Wall:
    """A half-space that keeps a thing."""

    name: str
    thing: Thing
    normal: complex
    level: float


@dataclass(frozen=True)
class Step:
    """A joint: from its parent to its frame."""

    origin: complex
    mount: complex
    sense: int
    slide: complex
    limits: tuple[float, float] | None
    names: tuple[str, str]

    @property
    def turns(self) -> bool:
        return self.sense != 0


class Scene:
    """What a robot file says, read anew.

    Attributes
    ----------
    scale : ndarray, shape (2,)
        Multiplies the library's joint values: 1 for an angle, for a slide the unit of length.
    """

    def __init__(self, text: str) -> None:
        table = read(text)
        self.plane = plane_of(table)
        self.across = 3 - sum(self.plane)
        self.right = -1 if self.plane == (0, 2) else 1  # from z to x turns about y
        angle = radians(1) if table["angle_unit"] == "deg" else 1.0
        self.places = -_power(table)
        self.frames = {table["joint"][0]["parent"]: 0}
        self.steps = []
        for j, row in enumerate(table["joint"]):
            self.frames[row["frame"]] = j + 1
            self.steps.append(self._step(row, angle))
        self.rounds = tuple(step.limits is None for step in self.steps)
        self.ends = np.array([step.limits or (-pi, pi) for step in self.steps])
        self.scale = np.array([1.0 if s.turns else float(10.0**self.places) for s in self.steps])
        self.checks: list[Gap | Wall] = list(self._checks(table))
        self.by_name = {check.name: check for check in self.checks}
        self.size = max(
            [1.0, *(abs(s.origin) for s in self.steps), *map(self._far, self._things(table))]
        )

    # --- reading ----------------------------------------------------------------------------------

    def _length(self, x: Decimal) -> float:
        return float(x.scaleb(self.places))

    def _flat(self, p: Sequence[Decimal], length: bool = True) -> complex:
        """A place, or a direction, of two or three numbers in the plane."""
        u, v = p if len(p) == 2 else (p[k] for k in self.plane)
        return complex(self._length(u), self._length(v)) if length else complex(u, v)

    def _step(self, row: dict[str, Any], angle: float) -> Step:
        turns = row["type"] == "revolute"
        about = row.get("rpy", [0, 0, 0])[self.across]
        mount = np.exp(1j * self.right * float(about) * angle)
        limits = row.get("limits")
        if limits is not None:
            low, high = (float(x) * angle if turns else self._length(x) for x in limits)
            limits = (low, high)
        sense, slide = 0, 0j
        if turns:
            sense = self.right * (1 if row["axis"][self.across] > 0 else -1)
        else:
            slide = self._flat(row["axis"], length=False)
            slide /= abs(slide)
        names = (f"{row['name']}.lower", f"{row['name']}.upper")
        return Step(self._flat(row["origin"]), complex(mount), sense, slide, limits, names)

    def _thing(self, row: dict[str, Any]) -> Thing:
        depth = self.frames[row["frame"]] if "frame" in row else 0
        if "at" in row:
            height = self._length(row["at"][self.across])
            core, radius = [self._flat(row["at"])], row.get("radius", Decimal(0))
            return Thing(depth, np.array(core), self._length(radius), height)
        if "polygon" in row:
            return Thing(depth, np.array([self._flat(p) for p in row["polygon"]]), 0.0)
        shape = row.get("disc") or row["capsule"]
        core = [self._flat(shape[key]) for key in ("at", "from", "to") if key in shape]
        return Thing(depth, np.array(core), self._length(shape["radius"]))

    def _things(self, table: dict[str, Any]) -> list[Thing]:
        return [self._thing(row) for row in (*table.get("body", []), *table.get("obstacle", []))]

    def _checks(self, table: dict[str, Any]) -> Iterator[Gap | Wall]:
        """Boundaries of the file, then pairs of bodies that may not meet."""
        points = {row["name"]: self._thing(row) for row in table["point"]}
        rows = [*table.get("body", []), *table.get("obstacle", [])]
        bodies = dict(zip(_names(table), map(self._thing, rows), strict=True))
        settled = {frozenset(pair) for pair in table.get("allowed", [])}
        for row in (row for row in table.get("boundary", []) if row.get("used", True)):
            clearance = self._length(row.get("clearance", Decimal(0)))
            if row["type"] == "half-space":
                thing = bodies[row["body"]] if "body" in row else points[row["point"]]
                normal = self._flat(row["normal"], length=False)
                level = self._length(row["offset"]) + thing.radius
                yield Wall(row["name"], thing, normal / abs(normal), level)
                continue
            if row["type"] == "bodies":
                settled.add(frozenset(row["bodies"]))
                two = [bodies[name] for name in row["bodies"]]
            else:
                two = [points[name] for name in row["points"]]
            yield _gap(row["name"], *two, clearance)
        if table.get("collisions") != "all":
            return
        clearance = self._length(table.get("clearance", Decimal(0)))
        count = len(table.get("body", []))
        order = sorted(list(bodies)[:count], key=lambda name: bodies[name].depth)
        for a, b in combinations([*order, *list(bodies)[count:]], 2):
            if bodies[a].depth != bodies[b].depth and frozenset((a, b)) not in settled:
                yield _gap(f"{a}, {b}", bodies[a], bodies[b], clearance)

    def _far(self, thing: Thing) -> float:
        return float(np.abs(thing.core).max())

    # --- geometry ---------------------------------------------------------------------------------

    def pose(self, first: int, last: int, q: Floats) -> tuple[Complex, Complex]:
        """Turn and origin of one frame seen from another nearer to the base; (n,) each."""
        turn, origin = np.ones(len(q), dtype=complex), np.zeros(len(q), dtype=complex)
        for step, value in list(zip(self.steps, q.T, strict=True))[first:last]:
            origin = origin + turn * (step.origin + step.mount * step.slide * value)
            turn = turn * step.mount * np.exp(1j * step.sense * value)
        return turn, origin

    def placed(self, first: int, thing: Thing, q: Floats, core: Complex | None = None) -> Complex:
        """Corners of a thing seen from a frame, shape (n, m)."""
        turn, origin = self.pose(first, thing.depth, q)
        return origin[:, None] + turn[:, None] * (thing.core if core is None else core)

    def speeds(self, check: Gap | Wall) -> Floats:
        """How fast the margin changes at most with each joint."""
        first = check.one.depth if isinstance(check, Gap) else 0
        thing = check.other if isinstance(check, Gap) else check.thing
        far, found = float(np.abs(thing.core).max()), np.zeros(2)
        for j in reversed(range(first, thing.depth)):
            step = self.steps[j]
            found[j] = far if step.turns else 1.0
            slide = max(map(abs, step.limits)) if step.limits and not step.turns else 0.0
            far += abs(step.origin) + slide
        return found

    def margins(self, check: Gap | Wall, q: Floats) -> Floats:
        """Signed margins, shape (n,): where cores overlap, less than what is kept by their depth.

        The depth is that of the deepest corner: right where it is small.
        """
        if isinstance(check, Wall):
            heights = (self.placed(0, check.thing, q) * np.conj(check.normal)).real
            return heights.min(axis=1) - check.level
        core = self.placed(check.one.depth, check.other, q)
        height = check.one.height - check.other.height
        if height:
            return np.hypot(np.abs(core[:, 0] - check.one.core[0]), height) - check.kept
        still, moving = geometry(check.one.core[None])[0], geometry(core)
        distance = shapely.distance(still, moving)
        at = np.flatnonzero(distance == 0)
        if len(at):
            distance[at] = -_depths(check, still, moving[at], core[at])
        return distance - check.kept

    def near(self, check: Gap | Wall, q: Floats, more: Floats | float) -> Bools:
        """Tell where discs round both cores may be nearer than asked, shape (n,)."""
        if isinstance(check, Wall):
            return np.ones(len(q), dtype=np.bool_)
        (a, r), (b, s) = check.one.disc, check.other.disc
        turn, origin = self.pose(check.one.depth, check.other.depth, q)
        return np.asarray(np.abs(origin + turn * b - a) <= r + s + check.kept + more)

    def worst(self, q: Floats, enough: float) -> Floats:
        """The least margin of all checks, where it is below `enough`; else `enough`; shape (n,)."""
        found = np.full(len(q), enough)
        for check in self.checks:
            at = np.flatnonzero(self.near(check, q, enough))
            if len(at):
                found[at] = np.minimum(found[at], self.margins(check, q[at]))
        return found

    def limit_margin(self, name: str, q: Floats) -> Floats | None:
        """The margin to a joint's limit of that name; None if there is none."""
        for j, step in enumerate(self.steps):
            if step.limits is not None and name in step.names:
                side = step.names.index(name)
                return (q[:, j] - step.limits[0]) if side == 0 else (step.limits[1] - q[:, j])
        return None

    def margin_of(self, name: str, q: Floats) -> Floats | None:
        """The margin to the boundary or limit of that name; None: there is none."""
        if name in self.by_name:
            return self.margins(self.by_name[name], q)
        return self.limit_margin(name, q)


@lru_cache(maxsize=4)
def read_scene(text: str) -> Scene:
    """Read a file; regions of one scene are judged one after the other."""
    return Scene(text)


def geometry(corners: Complex) -> NDArray[np.object_]:
    """Points, segments or polygons of corners, shape (n, m), as shapely has them."""
    places = np.stack([corners.real, corners.imag], axis=-1)
    if corners.shape[1] == 1:
        return np.asarray(shapely.points(places[:, 0]))
    make = shapely.linestrings if corners.shape[1] == 2 else shapely.polygons
    return np.asarray(make(places))


def _depths(check: Gap, still: Any, moving: NDArray[np.object_], core: Complex) -> Floats:
    """How deep cores that meet are in each other, shape (n,): right where it is small.

    That is the deepest corner; but two bars that cross have none in each other. What they share is
    as thick as its area by its outline, or as deep as the middle of a segment in a polygon.
    """
    corners = geometry(core.reshape(-1, 1)).reshape(core.shape)
    own = geometry(check.one.core[:, None])
    if not check.one.solid and not check.other.solid:  # lines that cross, by the nearest end
        ends = [shapely.distance(still, corners).min(axis=1)]
        ends += [shapely.distance(moving, corner) for corner in own]
        return np.minimum.reduce(ends)
    found = np.zeros(len(moving))
    common = shapely.intersection(still, moving)
    if check.one.solid and check.other.solid:
        found = shapely.area(common) / np.maximum(shapely.length(common), 1e-300)
    if check.one.solid:
        rim = shapely.boundary(still)
        deep = shapely.distance(rim, corners) * shapely.contains(still, corners)
        found = np.maximum(found, deep.max(axis=1))
    if check.other.solid:
        rims = shapely.boundary(moving)
        for corner in own:
            deep = shapely.distance(rims, corner) * shapely.contains(moving, corner)
            found = np.maximum(found, deep)
    if check.one.solid != check.other.solid:
        rims = np.broadcast_to(shapely.boundary(still), len(moving)) if check.one.solid else rims
        pieces, of = shapely.get_parts(common, return_index=True)
        lines = shapely.get_type_id(pieces) == 1
        middles = shapely.line_interpolate_point(pieces[lines], 0.5, normalized=True)
        inside = np.nan_to_num(shapely.distance(rims[of[lines]], middles))  # nan: it has no length
        np.maximum.at(found, of[lines], inside)
    return found


def _gap(name: str, one: Thing, other: Thing, clearance: float) -> Gap:
    if one.depth > other.depth:
        one, other = other, one
    return Gap(name, one, other, one.radius + other.radius + clearance)


def _power(table: dict[str, Any]) -> int:
    """The power of ten that is next to the largest number of a body or an origin."""
    numbers = [abs(x) for joint in table["joint"] for x in joint["origin"]]
    for row in (*table.get("body", []), *table.get("obstacle", [])):
        places = row.get("polygon") or [
            x for key in ("disc", "capsule") for x in row.get(key, {}).values()
        ]
        numbers += [abs(x) for p in places for x in (p if isinstance(p, list) else [p])]
    largest = max(numbers)
    return largest.adjusted() if largest else 0


def _names(table: dict[str, Any]) -> list[str]:
    """The names of bodies and obstacles: a frame's own, and with a number from the second on."""
    base, count, found = table["joint"][0]["parent"], Counter[str](), []
    for row in (*table.get("body", []), *table.get("obstacle", [])):
        frame = row.get("frame", base)
        count[frame] += 1
        default = frame if count[frame] == 1 else f"{frame}/{count[frame]}"
        found.append(row.get("name", default))
    return found


# --- arcs -----------------------------------------------------------------------------------------


def faults(
    text: str, region: Any, *, flooded: bool = True, finest: int = 1024, placed: bool = False
) -> list[str]:
    """What is wrong with a region of a file: short texts, each with its kind before a colon.

    Parameters
    ----------
    flooded : bool
        Whether components are judged too, on cells down to 1 / `finest` of each range.
    placed : bool
        Whether configurations are judged too, at random and on both sides of the boundary.
    """
    if len(getattr(region, "unresolved", ())):
        return ["unresolved: the region says so itself"]
    scene = read_scene(text)
    found = list(_loop_faults(scene, region))
    found += _vertex_faults(scene, region)
    found += _arc_faults(scene, region)
    if flooded:
        found += _flood_faults(scene, region, raster(scene, finest))
    if placed:
        q = np.random.default_rng(0).uniform(*scene.ends.T, (600, 2))
        found += misplaced(scene, region, np.concatenate([q, _beside_the_boundary(scene, q[:60])]))
        meet = np.abs(scene.worst(q, 1.0)) < ROUNDED * scene.size  # while some joint moves, too
        touched = meet & (region.component_of(q / scene.scale) >= 0)
        found += [f"touch: bodies touch at {_shown(each)}, inside" for each in q[touched]]
    return found


def kinds(found: Sequence[str]) -> list[str]:
    """The kinds of some faults, each once."""
    return sorted({text.partition(":")[0] for text in found})


def _loop_faults(scene: Scene, region: Any) -> Iterator[str]:
    """Yield where loops are not closed: modulo full turns of joints that turn all the way round."""
    for k, component in enumerate(region.components):
        for loop in component.loops:
            for before, arc in zip((loop[-1], *loop[:-1]), loop, strict=True):
                step = (arc.start - before.end) * scene.scale
                whole = np.round(step / (2 * pi)) * 2 * pi * np.array(scene.rounds)
                off = np.abs(step - whole).max()
                if not off <= MEET:
                    yield f"open: component {k}, {off:.2g} before {arc.boundary}"


def _vertex_faults(scene: Scene, region: Any) -> list[str]:
    """Vertices that do not lie on both their boundaries."""
    found = []
    for component in region.components:
        for vertex in component.vertices:
            q = (vertex.q * scene.scale)[None]
            for name in set(vertex.boundaries):
                margin = scene.margin_of(name, q)
                if margin is None:
                    found.append(f"label: no boundary {name}")
                elif not abs(margin[0]) <= ON * scene.size:
                    found.append(f"vertex: {margin[0]:.2g} off {name} at {_shown(vertex.q)}")
    return found


def _arc_faults(scene: Scene, region: Any) -> list[str]:
    """Arcs off their boundary, through bodies, or with the region on their right."""
    arcs = [arc for c in region.components for loop in c.loops for arc in loop]
    if not arcs:
        return []
    found, least = [], ON * scene.size
    lines = np.stack([_along(arc) * scene.scale for arc in arcs])
    names = np.array([arc.boundary for arc in arcs])
    turns = [step.turns for step in scene.steps]
    for name in dict.fromkeys(names.tolist()):
        own = lines[names == name]
        jumps = np.abs(np.abs(np.diff(own, axis=1)) - 2 * pi)[..., turns] <= MEET
        found += [
            f"jump: an arc of {name} by a whole turn, {_shown(line[0])}"
            for line in own[jumps.any(axis=(1, 2))]
        ]
        margin = scene.margin_of(name, own.reshape(-1, 2))
        if margin is None:
            found.append(f"label: no boundary {name}")
            continue
        margin = margin.reshape(own.shape[:2])
        on = (np.abs(margin) <= least).all(axis=1)
        for line, values in zip(own[~on], margin[~on], strict=True):
            k = int(np.abs(values).argmax())
            found.append(f"arc: {values[k]:.2g} off {name} at {_shown(line[k])}")
        found += _wrong_sides(scene, name, own[on])
    every = np.concatenate(lines)
    worst = scene.worst(every, 1.0)
    for (low, high), step in zip(scene.ends, scene.steps, strict=True):
        if step.limits is not None:
            j = scene.steps.index(step)
            worst = np.minimum(worst, np.minimum(every[:, j] - low, high - every[:, j]))
    k = int(worst.argmin())
    if not worst[k] >= -least:
        found.append(f"infeasible: an arc by {worst[k]:.2g} at {_shown(every[k])}")
    return found


def _wrong_sides(scene: Scene, name: str, lines: Floats) -> Iterator[str]:
    """Yield where the margin to arcs' boundary falls to the left, or rises to the right alone.

    It rises on both sides of a curve where two bodies touch and no more: that is a wall too. More
    than half of the arc's length decides: near its ends the neighbours' side may be what is seen,
    and most places lie there where a short piece, which has as many, is part of the arc.
    """
    chords = lines[:, 2:] - lines[:, :-2]
    lengths = np.hypot(chords[..., 0], chords[..., 1])
    across = ASIDE * chords[..., ::-1] * [-1.0, 1.0] / np.maximum(lengths, 1e-300)[..., None]
    sides = np.stack([lines[:, 1:-1] + across, lines[:, 1:-1] - across])
    margins = scene.margin_of(name, sides.reshape(-1, 2))
    assert margins is not None
    least = ON * scene.size
    for left, right, length, (place, other) in zip(
        *margins.reshape(sides.shape[:3]), lengths, sides.swapaxes(0, 1), strict=True
    ):
        if length.max() < 100 * ASIDE:
            continue
        if length[left < -least].sum() > length.sum() / 2:
            yield f"left: margin {left.min():.2g} to {name}, at {_shown(place[left.argmin()])}"
        elif length[(right > least) & (left <= ROUNDED * scene.size)].sum() > length.sum() / 2:
            yield f"right: margin {right.max():.2g} to {name}, at {_shown(other[right.argmax()])}"


def _along(arc: Any, most: int = 33) -> Floats:
    """Places along an arc, its ends among them: inside its straight pieces too."""
    return np.asarray(arc.at(np.linspace(0, 1, most)))


def _shown(q: Floats) -> str:
    return f"({q[0]:.9g}, {q[1]:.9g})"


# --- configurations -------------------------------------------------------------------------------


def misplaced(scene: Scene, region: Any, q: Floats) -> list[str]:
    """Configurations that are in the region and in a body, or in neither; shape (n, 2).

    Those that rounding decides are left out.
    """
    worst, inside = scene.worst(q, 1.0), region.component_of(q / scene.scale) >= 0
    wrong = (inside != (worst > 0)) & (np.abs(worst) > ON * scene.size)
    rows = zip(q[wrong], worst[wrong], strict=True)
    return [f"place: margin {margin:.2g} at {_shown(place)}" for place, margin in rows]


def _beside_the_boundary(scene: Scene, q: Floats, halvings: int = 25) -> Floats:
    """Both ends of short segments that a boundary crosses, from pairs of neighbours in `q`."""
    free = scene.worst(q, 1.0) > 0
    change = np.flatnonzero(free[1:] != free[:-1])
    good, bad = (np.where((free == side)[change, None], q[change], q[change + 1])
                 for side in (True, False))  # fmt: skip
    for _ in range(halvings):
        middle = (good + bad) / 2
        inside = (scene.worst(middle, 1.0) > 0)[:, None]
        good, bad = np.where(inside, middle, good), np.where(inside, bad, middle)
    return np.concatenate([good, bad])


# --- components -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Raster:
    """Cells of the joints' ranges: 1 where surely free, 0 where surely not, -1 undecided."""

    state: NDArray[np.int8]
    corner: Floats
    step: Floats

    def middles(self, cells: NDArray[np.intp]) -> Floats:
        """Configurations in the middle of cells, shape (n, 2)."""
        return self.corner + (cells + 0.5) * self.step


@lru_cache(maxsize=4)
def raster(scene: Scene, finest: int) -> Raster:
    """Cells that are free, or not, at every place; those that are neither are halved."""
    n = COARSE
    low, wide = scene.ends[:, 0], np.ptp(scene.ends, axis=1)
    cells = np.argwhere(np.ones((n, n), dtype=np.bool_))
    state = np.full((n, n), -1, dtype=np.int8)
    open_checks = np.ones((len(scene.checks), len(cells)), dtype=np.bool_)
    speeds = [scene.speeds(check) for check in scene.checks]
    while True:
        q = low + (cells + 0.5) * wide / n
        blocked = np.zeros(len(cells), dtype=np.bool_)
        for k, check in enumerate(scene.checks):
            at = np.flatnonzero(open_checks[k] & ~blocked)
            reach = float(speeds[k] @ (wide / n) / 2) * (1 + 1e-9)
            near = scene.near(check, q[at], reach)
            open_checks[k, at[~near]] = False
            at = at[near]
            if len(at):
                free, hit = _sure(scene, check, q[at], reach)
                open_checks[k, at[free]] = False
                blocked[at[hit]] = True
        unknown = open_checks.any(axis=0) & ~blocked
        state[tuple(cells.T)] = np.where(blocked, 0, np.where(unknown, -1, 1))
        if n >= finest or not unknown.any():
            return Raster(state, low, wide / n)
        n *= 2
        state = state.repeat(2, axis=0).repeat(2, axis=1)
        quarters = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        cells = (2 * cells[unknown][:, None] + quarters).reshape(-1, 2)
        open_checks = open_checks[:, unknown].repeat(4, axis=1)


def _sure(scene: Scene, check: Gap | Wall, q: Floats, reach: float) -> tuple[Bools, Bools]:
    """Tell where a check holds, and where it fails, for all that is no farther than `reach`."""
    if isinstance(check, Wall) or check.one.height != check.other.height:
        margin = scene.margins(check, q)
        return margin > reach, margin < -reach
    core = scene.placed(check.one.depth, check.other, q)
    still, moving = geometry(check.one.core[None])[0], geometry(core)
    distance = shapely.distance(still, moving)
    hit = np.asarray(distance < check.kept - reach)
    at = np.flatnonzero(distance == 0)
    if not check.one.solid and not check.other.solid and len(at):
        hit[at] |= _depths(check, still, moving[at], core[at]) > reach
    deep = (reach - check.kept) * 1.01  # a body that is thinner by so much is hit all the same
    if deep >= 0:
        at = np.flatnonzero(distance == 0)
        if check.one.solid and len(at) and (inner := _thinner(check.one.core, deep)) is not None:
            inner_core = geometry(inner[None])[0]
            hit[at] |= shapely.intersects(inner_core, moving[at])
        if check.other.solid and len(at):
            inner = _thinner(check.other.core, deep)
            if inner is not None:
                placed = geometry(scene.placed(check.one.depth, check.other, q[at], inner))
                hit[at] |= shapely.intersects(still, placed)
    return np.asarray(distance > check.kept + reach), hit


def _thinner(core: Complex, deep: float) -> Complex | None:
    """The largest piece of a polygon that is farther than that from its rim; None: nothing."""
    left = shapely.buffer(geometry(core[None])[0], -deep, quad_segs=16)
    pieces = [piece for piece in shapely.get_parts(left) if not piece.is_empty]
    if not pieces:
        return None
    ring = np.asarray(max(pieces, key=lambda piece: piece.area).exterior.coords)[:-1]
    return ring[:, 0] + 1j * ring[:, 1]


def _flood_faults(scene: Scene, region: Any, cells: Raster) -> list[str]:
    """Components that the cells prove to be split, merged or lost; areas that they exclude."""
    free, possible = cells.state == 1, cells.state != 0
    found = []
    unit = float(cells.step.prod())
    area = region.area * scene.scale.prod()
    low, high = free.sum() * unit, possible.sum() * unit
    if not low - 1e-9 <= area <= high + 1e-9:
        found.append(f"area: {area:.9g} is not between {low:.9g} and {high:.9g}")
    lots = flood(free, scene.rounds, corners=False)
    lumps = flood(possible, scene.rounds, corners=True)
    holds: dict[int, set[int | None]] = {}
    place: dict[int, NDArray[np.intp]] = {}
    for cell in _samples(scene, region, cells, lots):
        q = (cells.middles(cell) / scene.scale)[None]
        lot = int(lots[tuple(cell)])
        holds.setdefault(lot, set()).add(region.component_of(q[0]))
        place.setdefault(lot, cell)
    for lot, own in holds.items():
        where = _shown(cells.middles(place[lot]) / scene.scale)
        if None in own:
            found.append(f"lost: {where} or what is joined to it is free, and in no component")
        if len(own - {None}) > 1:
            found.append(f"split: {sorted(own - {None})} are joined, near {where}")
    of_lump = {lot: int(lumps[tuple(cell)]) for lot, cell in place.items()}
    for one, other in combinations(holds, 2):
        common = (holds[one] & holds[other]) - {None}
        if of_lump[one] != of_lump[other] and common:
            found.append(f"merged: component {min(common)} is at least two, with no way between")
    return found


def _samples(
    scene: Scene, region: Any, cells: Raster, lots: NDArray[np.intp]
) -> list[NDArray[np.intp]]:
    """Cells that are surely free: some of each lot, and on the left of every component's arcs."""
    chosen = []
    labels, counts = np.unique(lots[cells.state == 1], return_counts=True)
    for lot in labels[np.argsort(-counts)][:40]:
        inside = np.argwhere(lots == lot)
        chosen.append(inside[np.unique(np.linspace(0, len(inside) - 1, 8).astype(int))])
    low, wide, n = scene.ends[:, 0], np.ptp(scene.ends, axis=1), len(cells.state)
    for component in region.components:
        beside = []
        for arc in [arc for loop in component.loops for arc in loop][:40]:
            line = _along(arc) * scene.scale
            chord = np.diff(line, axis=0)
            across = chord[:, ::-1] * [-1.0, 1.0] / np.maximum(np.hypot(*chord.T), 1e-12)[:, None]
            middle = (line[1:] + line[:-1]) / 2
            beside += [middle + far * across * cells.step for far in (2.0, 8.0, 32.0)]
        if beside:
            q = np.concatenate(beside)
            whole = np.where(scene.rounds, np.floor((q - low) / wide), 0)
            at = np.floor((q - whole * wide - low) / wide * n).astype(np.intp)
            at = at[((at >= 0) & (at < n)).all(axis=1)]
            at = np.unique(at[cells.state[tuple(at.T)] == 1], axis=0)
            if len(at):
                chosen.append(at[np.unique(np.linspace(0, len(at) - 1, 12).astype(int))])
    return [cell for block in chosen for cell in block]


# --- one region, found twice ----------------------------------------------------------------------


@dataclass(frozen=True)
class Outline:
    """What is the same of one scene's regions, however they are found: counts, areas, wraps."""

    components: int
    loops: int
    vertices: int
    areas: list[float]
    wraps: list[list[bool]]
    unresolved: bool = False

    @classmethod
    def of(cls, region: Any) -> Outline:
        if len(getattr(region, "unresolved", ())):
            return cls(0, 0, 0, [], [], unresolved=True)
        every = region.components
        return cls(
            len(every),
            sum(len(component.loops) for component in every),
            sum(len(component.vertices) for component in every),
            sorted((float(component.area) for component in every), reverse=True),
            sorted([bool(one), bool(other)] for one, other in (c.wraps for c in every)),
        )


def agreement(outlines: Sequence[Outline], factors: Sequence[float] | None = None) -> list[str]:
    """What differs between regions of one scene, or of exact copies of it, as `faults` are.

    Parameters
    ----------
    factors : sequence of float, optional
        By how much areas of each are larger than those of the first; default 1.
    """
    if any(outline.unresolved for outline in outlines):
        return ["unresolved: a region says so itself"]
    found = []
    for what in ("components", "loops", "vertices"):
        counts = [getattr(outline, what) for outline in outlines]
        if len(set(counts)) > 1:
            found.append(f"{what}: {counts}")
    if (off := area_difference(outlines, factors)) > SAME_AREA:
        found.append(f"areas: {off:.2g} of their sum apart")
    rounds = [outline.wraps for outline in outlines]
    if any(len(each) == len(rounds[0]) and each != rounds[0] for each in rounds):
        found.append("wraps: components go round other joints")
    return found


def area_difference(outlines: Sequence[Outline], factors: Sequence[float] | None = None) -> float:
    """The largest difference of areas, component by component, beside the sum of all."""
    factors = [1.0] * len(outlines) if factors is None else factors
    longest = max(outline.components for outline in outlines)
    table = np.zeros((len(outlines), longest))
    for row, outline, factor in zip(table, outlines, factors, strict=True):
        row[: outline.components] = np.array(outline.areas) / factor
    off = float(np.ptp(table, axis=0).max(initial=0.0))
    return off / float(table.sum(axis=1).max()) if off else 0.0
