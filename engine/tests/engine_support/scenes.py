"""Planar arms of two joints among obstacles, at random or in whole numbers, and shapely's answer.

The answer shares nothing with the library: frames are complex numbers here, and what is not convex
stays whole. All scenes lie in the plane of x and z.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np
import shapely
from numpy.typing import NDArray

from cspace.boundary.separation import BodyMargins
from cspace.model.robot import (
    JOINT_TYPES,
    Body,
    BodyPair,
    Boundary,
    Capsule,
    Disc,
    HalfSpace,
    Joint,
    Point,
    Polygon,
    Robot,
    Shape,
)  # fmt: skip
from cspace.region import Region
from engine_support.arms import in_metres
from engine_support.forms import PP, PR, RP, RR

Floats = NDArray[np.float64]
KINDS = (RR, RP, PR, PP)
WIDER = np.array([-0.3, 0.3])


# --- scenes ---------------------------------------------------------------------------------------


def random_scene(seed: int, obstacles: int | None = None) -> Robot:
    """Links that are capsules, polygons or discs, and 1 to 30 obstacles, a few not convex."""
    rng = np.random.default_rng([13, seed])
    kinds = KINDS[seed % 4]
    count = int(rng.integers(1, 31)) if obstacles is None else obstacles
    joints = tuple(random_joint(rng, j, kind) for j, kind in enumerate(kinds))
    bodies = [Body(f"link {j + 1}", str(j + 1), random_link(rng, kinds, j)) for j in range(2)]
    if rng.random() < 0.3:
        bodies.insert(0, Body("foot", "0", random_shape(rng, np.array([0.0, -0.6]), 0.3)))
    if rng.random() < 0.3:
        bodies.append(Body("hand", "2", random_shape(rng, np.array([0.9, 0.0]), 0.25)))
    size = rng.uniform(0.1, 0.4) if count > 10 else rng.uniform(0.2, 0.8)
    places = [around(rng, 0.7, 2.4) for _ in range(count)]
    blocks = [
        Body(f"obstacle {i}", "0", random_shape(rng, place, size)) for i, place in enumerate(places)
    ]
    return arm(rng, f"random {seed}", joints, bodies, blocks, rng.choice([0.0, 0.03]))


def drawn_scene(seed: int) -> Robot:
    """The same in small whole numbers: squares on squares, edges in line, touching corners."""
    rng = np.random.default_rng([31, seed])
    kinds = KINDS[seed % 4]
    joints = tuple(drawn_joint(rng, j, kind) for j, kind in enumerate(kinds))
    bodies = [Body(f"link {j + 1}", str(j + 1), drawn_link(rng)) for j in range(2)]
    blocks = [
        Body(f"obstacle {i}", "0", drawn_shape(rng, rng.integers(-4, 5, 2).astype(float)))
        for i in range(rng.integers(1, 9))
    ]
    if rng.random() < 0.3:
        blocks.append(replace(blocks[0], name="the same again"))
    return arm(rng, f"drawn {seed}", joints, bodies, blocks, float(rng.integers(0, 2)))


def arm(
    rng: np.random.Generator,
    name: str,
    joints: tuple[Joint, ...],
    bodies: list[Body],
    obstacles: list[Body],
    clearance: float,
) -> Robot:
    """The robot: neighbours may touch, a pair has a clearance of its own, one wall may stand."""
    boundaries: list[BodyPair | HalfSpace] = []
    if rng.random() < 0.4:
        names = ("link 2", obstacles[0].name)
        boundaries.append(BodyPair("a pair of its own", names, clearance + 1 / 8))
    if rng.random() < 0.4:
        normal = np.array([[0, 0, 1.0], [1.0, 0, 0], [0.6, 0, 0.8]][rng.integers(0, 3)])
        boundaries.append(HalfSpace("wall", "", normal, -1.5, body="link 2"))
    near = [body.name for body in bodies if body.frame in {"0", "1"}]
    allowed = [frozenset(("link 1", other)) for other in [*near, "link 2", "hand"]]
    home = [0.0 if j.limits is None else sum(j.limits) / 2 for j in joints]
    tool = Point("tool", "2", np.array([1.0, 0, 0]))
    return in_metres(
        name, joints, [tool], boundaries, home, "tool",
        bodies=tuple(bodies), obstacles=tuple(obstacles), collisions=True,
        clearance=float(clearance), allowed=tuple(pair for pair in allowed if len(pair) == 2),
    )  # fmt: skip


def random_joint(rng: np.random.Generator, j: int, kind: str) -> Joint:
    """A joint a link's length from the one before, turning either way or sliding anywhere."""
    origin = np.array([0.0, 0, 0] if j == 0 else [1.0, 0, 0])
    place = f"q{j + 1}", str(j), str(j + 1), origin
    if kind == "revolute":
        limits = None if rng.random() < 0.6 else tuple(np.sort(rng.uniform(-4, 4, 2)) + WIDER)
        return JOINT_TYPES[kind](*place, np.array([0.0, rng.choice([-1.0, 1.0]), 0]), limits=limits)
    angle = rng.uniform(0, 2 * pi)
    slide = np.array([np.cos(angle), 0, np.sin(angle)])
    return JOINT_TYPES[kind](*place, slide, limits=(-rng.uniform(0.5, 2.0), rng.uniform(0.5, 2.0)))


def drawn_joint(rng: np.random.Generator, j: int, kind: str) -> Joint:
    """A joint two units from the one before, sliding along an axis."""
    origin = np.array([0.0, 0, 0] if j == 0 else [2.0, 0, 0])
    place = f"q{j + 1}", str(j), str(j + 1), origin
    if kind == "revolute":
        limits = None if rng.random() < 0.6 else (-pi / 2, pi)
        return JOINT_TYPES[kind](*place, np.array([0.0, 1, 0]), limits=limits)
    slide = np.array([[1.0, 0, 0], [0, 0, 1.0]][rng.integers(0, 2)])
    return JOINT_TYPES[kind](*place, slide, limits=(-3.0, 3.0))


def random_link(rng: np.random.Generator, kinds: tuple[str, ...], j: int) -> Shape:
    """A capsule along the link, a polygon about it, or a disc at its end."""
    which, wide = rng.integers(0, 4), rng.uniform(0.03, 0.15)
    end = np.array([1.0, 0, 0])
    if which == 0:
        return Capsule(np.zeros(3), end, wide if rng.random() < 0.8 else 0.0)
    if which == 1:
        return Disc(end, rng.uniform(0.05, 0.4))
    if which == 2:
        return polygon([(0, -wide), (1, -wide / 2), (1.1, 0), (1, wide / 2), (0, wide)])
    return polygon([(0, -wide), (1, -wide), (1, 0.3), (1 - wide, 0.3), (1 - wide, wide), (0, wide)])


def drawn_link(rng: np.random.Generator) -> Shape:
    """A link two units long in whole or half numbers, thin ones too."""
    which, wide = rng.integers(0, 5), rng.choice([0.5, 1.0])
    end = np.array([2.0, 0, 0])
    if which == 0:
        return Capsule(np.zeros(3), end, 0.0)
    if which == 1:
        return Capsule(np.zeros(3), end, wide)
    if which == 2:
        return Disc(end, rng.choice([0.0, 1.0]))
    if which == 3:
        return polygon([(0, -wide), (2, -wide), (2, wide), (0, wide)])
    return polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])


def random_shape(rng: np.random.Generator, place: Floats, size: float) -> Shape:
    """A disc, a capsule, a convex polygon or a star somewhere."""
    which = rng.integers(0, 5)
    if which == 0:
        return Disc(lifted(place), size * rng.uniform(0.2, 0.8))
    if which == 1:
        return Capsule(lifted(place), lifted(place + around(rng, 0.2, 1.0) * size), size / 6)
    shifts = rng.uniform(0, 0.8, rng.integers(3, 8))
    angles = 2 * pi * (np.arange(len(shifts)) + shifts) / len(shifts)
    reach = rng.uniform(0.3, 1.0, len(angles)) if which == 2 else 1.0
    ring = place + size * (reach * np.array([np.cos(angles), 0.6 * np.sin(angles)])).T
    if not shapely.Polygon(ring).is_valid:
        ring = np.array(shapely.MultiPoint(ring).convex_hull.exterior.coords)[:-1]
    return polygon(ring[:: rng.choice([-1, 1])])


def drawn_shape(rng: np.random.Generator, place: Floats) -> Shape:
    """A square, a triangle, an L, a disc or a rod with corners in whole numbers."""
    x, z = place
    which = rng.integers(0, 5)
    if which == 0:
        return Disc(lifted(place), float(rng.integers(0, 3)))
    if which == 1:
        return Capsule(lifted(place), lifted(place + np.array([rng.integers(1, 3), 0])), 0.5)
    corners = {
        2: [(0, 0), (2, 0), (2, 2), (0, 2)],
        3: [(0, 0), (2, 0), (0, 2)],
        4: [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)],
    }[int(which)]
    return polygon([(x + u, z + v) for u, v in corners])


def polygon(corners: Floats | list[tuple[float, float]]) -> Polygon:
    """A polygon of the plane of x and z."""
    return Polygon(np.insert(np.asarray(corners, dtype=float), 1, 0.0, axis=1))


def lifted(place: Floats) -> Floats:
    """A place of the plane of x and z in space."""
    return np.array([place[0], 0.0, place[1]])


def around(rng: np.random.Generator, low: float, high: float) -> Floats:
    """A place between two distances from the base."""
    angle, far = rng.uniform(0, 2 * pi), rng.uniform(low, high)
    return np.array([far * np.cos(angle), far * np.sin(angle)])


# --- configurations -------------------------------------------------------------------------------


def configurations(robot: Robot, count: int, seed: int = 0) -> Floats:
    """Uniform within the limits, or over a turn; shape (count, 2)."""
    ends = np.array([joint.limits or (-pi, pi) for joint in robot.joints])
    return np.random.default_rng(seed).uniform(*ends.T, (count, 2))


def near_the_boundary(robot: Robot, q: Floats, halvings: int = 25) -> Floats:
    """Both ends of short segments that a boundary crosses, from pairs of neighbours in `q`.

    Every halving asks shapely; ends are apart by their distance in `q` over 2 to the halvings.
    """
    free = ~hits(robot, q)
    change = np.flatnonzero(free[1:] != free[:-1])
    if not len(change):
        return q[:0]
    good = np.where(free[change, None], q[change], q[change + 1])
    bad = np.where(free[change, None], q[change + 1], q[change])
    for _ in range(halvings):
        middle = (good + bad) / 2
        inside = ~hits(robot, middle)[:, None]
        good, bad = np.where(inside, middle, good), np.where(inside, bad, middle)
    return np.concatenate([good, bad])


# --- shapely's answer -----------------------------------------------------------------------------


def margins(
    robot: Robot, q: Floats, boundaries: Sequence[Boundary] | None = None
) -> dict[str, Floats]:
    """What shapely says of each boundary at q, shape (n, 2): distance less radii and clearance.

    Where cores overlap it is minus radii and clearance, whatever the depth: exact where positive,
    and never less than the margin. Limits are left out.
    """
    placed = {body.name: _placed(robot, body, q) for body in (*robot.bodies, *robot.obstacles)}
    found: dict[str, Floats] = {}
    for boundary in robot.used if boundaries is None else boundaries:
        if isinstance(boundary, BodyPair):
            (one, p), (other, r) = (placed[name] for name in boundary.bodies)
            found[boundary.name] = shapely.distance(one, other) - p - r - boundary.clearance
        elif isinstance(boundary, HalfSpace):
            geometry, radius = placed[boundary.body]
            count = shapely.get_num_coordinates(geometry)
            heights = shapely.get_coordinates(geometry) @ boundary.normal[[0, 2]]
            least = np.minimum.reduceat(heights, np.cumsum([0, *count[:-1]]))
            found[boundary.name] = least - radius - boundary.offset
    return found


def hits(robot: Robot, q: Floats) -> NDArray[np.bool_]:
    """Tell where a boundary is violated or, without radius and clearance, cores meet; shape (n,).

    Every pair is asked of shapely only where boxes round both bodies come that near. What stands
    still is placed once.
    """
    if not len(q):
        return np.zeros(0, dtype=np.bool_)
    placed = {
        body.name: _placed(robot, body, q[:1] if body.frame == robot.base else q)
        for body in (*robot.bodies, *robot.obstacles)
    }
    boxes = {name: shapely.bounds(geometry) for name, (geometry, _) in placed.items()}
    found = np.zeros(len(q), dtype=np.bool_)
    for boundary in robot.used:
        if isinstance(boundary, BodyPair):
            (one, p), (other, r) = (placed[name] for name in boundary.bodies)
            a, b = (boxes[name] for name in boundary.bodies)
            kept = p + r + boundary.clearance
            far = np.maximum(a[:, :2] - b[:, 2:], b[:, :2] - a[:, 2:]).max(axis=1) > kept
            at = np.flatnonzero(~found & ~far)
            distance = shapely.distance(*(x[at] if len(x) > 1 else x[0] for x in (one, other)))
            found[at] = (distance < kept) | (distance == 0)
        else:
            found |= margins(robot, q, [boundary])[boundary.name] < 0
    return found


def in_cells(region: Region, q: Floats) -> NDArray[np.bool_]:
    """Tell which configurations within the limits lie in a cell of a region; shape (n,)."""
    cells = region.cells
    place = np.stack([q[:, region.base], q[:, 1 - region.base]], axis=1)
    for j in np.flatnonzero(cells.round):
        place[:, j] = cells.range[j, 0] + (place[:, j] - cells.range[j, 0]) % (2 * pi)
    base, lift = place.T
    found = np.zeros(len(q), dtype=np.bool_)
    for k, (start, end) in enumerate(cells.lines[cells.span].tolist()):
        at = np.flatnonzero((start <= base) & (base <= end))
        if len(at):
            low, high = cells.interval([k], base[None, at])[:, 0]
            found[at] |= (low <= lift[at]) & (lift[at] <= high)
    return found


def wrongly_told(
    robot: Robot,
    region: Region,
    q: Floats,
    least: float = 1e-9,
    hit: NDArray[np.bool_] | None = None,
) -> Floats:
    """Return the configurations that lie in a cell and in a body, or in neither.

    Those within `least`, a length, of contact are left out: there rounding decides. `hit` is what
    `hits` says, if it is known already.
    """
    wrong = q[in_cells(region, q) == (hits(robot, q) if hit is None else hit)]
    margin = BodyMargins(robot).margins(wrong).min(axis=-1)
    return wrong[np.abs(margin) > least]


def touching_in_cells(robot: Robot, region: Region, q: Floats) -> NDArray[np.bool_]:
    """Tell which configurations lie in a cell although bodies touch there; shape (n,).

    At random configurations they touch only where contact goes on while a joint moves, as of a
    slide along an edge: such places belong to no cell, which is open.
    """
    margin = BodyMargins(robot).margins(q).min(axis=-1)
    return in_cells(region, q) & (np.abs(margin) < 1e-12)


def with_clearance(robot: Robot, more: float) -> Robot:
    """The robot with more asked of every pair of bodies that `collisions` makes."""
    return replace(robot, clearance=robot.clearance + more)


def is_free(robot: Robot, q: Floats) -> NDArray[np.bool_]:
    """Tell whether no boundary is violated, by shapely; limits are left out."""
    return np.all([margin >= 0 for margin in margins(robot, q).values()], axis=0)


def _placed(robot: Robot, body: Body, q: Floats) -> tuple[NDArray[np.object_], float]:
    """The core of a body at each configuration, as shapely has it, and its radius."""
    turn, origin = poses(robot, q)[body.frame]
    shape = body.shape

    def moved(corners: Floats) -> Floats:
        places = origin[:, None] + turn[:, None] * (corners[:, 0] + 1j * corners[:, 2])
        return np.stack([places.real, places.imag], axis=-1)

    if isinstance(shape, Polygon):
        return shapely.polygons(moved(shape.corners)), 0.0
    if isinstance(shape, Capsule):
        return shapely.linestrings(moved(np.array([shape.start, shape.end]))), shape.radius
    assert isinstance(shape, Disc)
    return shapely.points(moved(shape.at[None])[:, 0]), shape.radius


def poses(robot: Robot, q: Floats) -> dict[str, tuple[NDArray[np.complex128], ...]]:
    """Turn and origin of each frame as complex numbers x + iz, shape (n,) each."""
    turn, origin = np.ones(len(q), dtype=complex), np.zeros(len(q), dtype=complex)
    found = {robot.base: (turn, origin)}
    for joint, value in zip(robot.joints, q.T, strict=True):
        offset = joint.origin + np.multiply.outer(value * (joint.kind == "prismatic"), joint.axis)
        origin = origin + turn * (offset[..., 0] + 1j * offset[..., 2])
        if joint.kind == "revolute":
            turn = turn * np.exp(-1j * joint.axis[1] * value)  # about y: from z to x
        found[joint.frame] = (turn, origin)
    return found
