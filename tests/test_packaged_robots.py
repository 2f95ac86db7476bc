"""The packaged robots: they load, their regions are what grids and a collision library see."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from importlib import resources

import fcl
import numpy as np
import pytest
from skimage.measure import label

from qbound import find_region, load_robot, packaged_robots
from qbound.model.robot import HalfSpace, Pair, Robot
from qbound.region import margins, violated
from support.oracles import frame_matrix, row_of
from support.regions import check_arcs, check_grid, check_roles
from support.robots import OF_POINTS

KINDS = {
    "two-joint-arm-with-walls": ("revolute", "revolute"),
    "rp-telescopic-boom": ("revolute", "prismatic"),
    "pr-gantry-arm": ("prismatic", "revolute"),
    "pp-portal": ("prismatic", "prismatic"),
}
PACKAGED = [name for name in packaged_robots() if len(load_robot(name).joints) == 2]
WHOLE_BODIES = [name for name in PACKAGED if name not in OF_POINTS]
robots = pytest.mark.parametrize("name", PACKAGED)


def table_of(name: str) -> dict:
    file = resources.files("qbound") / "robots" / f"{name}.toml"
    return tomllib.loads(file.read_text(encoding="utf-8"))


def thick(robot: Robot) -> Robot:
    """The same robot with clearances that a grid can see."""
    wide = [
        replace(b, clearance=2.0) if isinstance(b, Pair) and robot.name == "MinervaBotV2" else b
        for b in robot.boundaries
    ]
    return replace(robot, boundaries=tuple(wide))


def grid(robot: Robot, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Middles of the cells of a grid over both ranges, shape (n, n, 2), and their sides."""
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    step = (ends[:, 1] - ends[:, 0]) / n
    axes = [low + (np.arange(n) + 0.5) * h for low, h in zip(ends[:, 0], step, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1), step


def clearances_by_kinematics(robot: Robot, q: np.ndarray) -> np.ndarray:
    """Least margin of all boundaries over configurations, by forward kinematics, a length."""
    frames = robot.frames(q)
    least = np.full(q.shape[:-1], np.inf)
    for b in (b for b in robot.boundaries if b.used):
        names = b.points if isinstance(b, Pair) else (b.point,)
        places = [frames.position(robot.base, p, robot.base) for p in names]
        radii = sum(robot.point(p).radius for p in names)
        if isinstance(b, HalfSpace):
            margin = places[0] @ b.normal - b.offset - radii
        else:
            margin = np.linalg.norm(places[1] - places[0], axis=-1) - radii - b.clearance
        least = np.minimum(least, margin)
    return least


@pytest.mark.parametrize("name", KINDS)
def test_the_four_kinds_of_arm_are_there(name):
    robot = load_robot(name)
    assert robot.kinds == KINDS[name]
    assert all(joint.velocity for joint in robot.joints)
    assert {type(b) for b in robot.boundaries} == {Pair, HalfSpace}
    assert robot.bodies


@robots
def test_home_is_safe_and_in_the_first_component(name):
    robot = load_robot(name)
    region = find_region(robot)
    assert violated(robot, robot.home) == []
    assert region.components[0].contains_home
    assert region.component_of(robot.home) == 0


@pytest.mark.parametrize("name", [name for name in PACKAGED if name in OF_POINTS])
def test_arcs_grid_and_roles_of_the_joints(name):
    region = find_region(load_robot(name))
    check_arcs(region)
    check_grid(region)
    check_roles(region)


@pytest.mark.parametrize("name", [*KINDS, "minervabot-v2"])
def test_the_area_is_that_of_forward_kinematics_on_a_grid(name):
    robot = thick(load_robot(name))
    q, step = grid(robot, 700)
    counted = (clearances_by_kinematics(robot, q) > 0).sum() * step.prod()
    assert find_region(robot).area == pytest.approx(counted, rel=3e-3)


@pytest.mark.parametrize("name", [*KINDS, "minervabot-v2"])
def test_components_are_the_flood_fill_of_scikit_image(name):
    """One patch of pixels a component, glued where a joint turns all the way round."""
    robot = thick(load_robot(name))
    region = find_region(robot)
    q, step = grid(robot, 240)
    free = clearances_by_kinematics(robot, q) > 0
    patches = flood(free, [joint.limits is None for joint in robot.joints])
    rng = np.random.default_rng(0)
    components: dict[int, set[int | None]] = {}
    for patch in np.unique(patches[free]):
        pixels = q[free & (patches == patch)]
        if len(pixels) > 200:
            chosen = rng.choice(len(pixels), 8, replace=False)
            components[int(patch)] = {region.component_of(pixels[i]) for i in chosen}
    large = [i for i, c in enumerate(region.components) if c.area > 300 * step.prod()]
    assert sorted(components.values(), key=str) == sorted(({i} for i in large), key=str)


@pytest.mark.parametrize("name", WHOLE_BODIES)
def test_regions_of_whole_bodies_are_what_distances_on_a_grid_say(name):
    """`margins` measures distances of bodies and knows no region."""
    robot = load_robot(name)
    region = find_region(robot)
    q, step = grid(robot, 300)
    free = (region.margins(q) >= 0).all(axis=-1)
    assert region.area == pytest.approx(free.sum() * step.prod(), rel=3e-3)
    assert 0.1 < free.mean() < 0.9


def flood(free: np.ndarray, rounds: list[bool]) -> np.ndarray:
    """Label patches by scikit-image, then merge labels that meet across the cut of a joint."""
    patches = label(free, connectivity=1)
    for axis in (0, 1):
        if rounds[axis]:
            first, last = np.moveaxis(patches, axis, 0)[[0, -1]]
            for k in np.flatnonzero((first > 0) & (last > 0)):
                one, other = np.moveaxis(patches, axis, 0)[[0, -1], k]
                patches[patches == other] = one
    return patches


@pytest.mark.parametrize("name", KINDS)
def test_margins_of_pairs_are_the_distances_of_a_collision_library(name):
    """Spheres placed by SciPy's rotations, measured by fcl; deep overlap is only a collision."""
    table, robot = table_of(name), load_robot(name)
    rng = np.random.default_rng(1)
    apart = 0
    for _ in range(40):
        q = [rng.uniform(*(joint.limits or (-np.pi, np.pi))) for joint in robot.joints]
        found = dict(margins(robot, q))
        for pair in (b for b in robot.boundaries if isinstance(b, Pair)):
            distance = sphere_distance(table, pair.points, q)
            if distance > 0:
                apart += 1
                assert found[pair.name] == pytest.approx(distance - pair.clearance, abs=1e-6)
            else:
                assert found[pair.name] <= -pair.clearance
    assert apart > 40


def sphere_distance(table: dict, names: tuple[str, str], q: list[float]) -> float:
    solids = []
    for name in names:
        row = row_of(table, "point", name)
        frame = frame_matrix(table, row["frame"], q)
        centre = (frame @ np.array([*row["at"], 1.0]))[:3]
        transform = fcl.Transform(frame[:3, :3], centre)
        solids.append(fcl.CollisionObject(fcl.Sphere(row["radius"]), transform))
    if fcl.collide(*solids, fcl.CollisionRequest(), fcl.CollisionResult()):
        return -1.0
    return fcl.distance(*solids, fcl.DistanceRequest(), fcl.DistanceResult())
