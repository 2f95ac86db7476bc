"""Scenes that are mirrored, turned, measured otherwise or moved: what their regions have to do."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cspace.model.robot import Body, Capsule, Disc, HalfSpace, Robot, Shape
from cspace.region import Region, clearance_problem, find_region, solve
from engine_support import scenes

Place = Callable[[np.ndarray], np.ndarray]


def changed(robot: Robot, place: Place, lengths: float = 1.0, sense: float = 1.0) -> Robot:
    """The robot with every place and direction of the plane changed alike, turns by their sense."""

    def shape(one: Shape) -> Shape:
        if isinstance(one, Disc):
            return Disc(lengths * place(one.at), lengths * one.radius)
        if isinstance(one, Capsule):
            ends = (lengths * place(end) for end in (one.start, one.end))
            return Capsule(*ends, lengths * one.radius)
        return scenes.polygon(np.delete([lengths * place(c) for c in one.corners], 1, axis=1))

    joints = tuple(
        replace(
            joint,
            origin=lengths * place(joint.origin),
            axis=sense * joint.axis if joint.turns else place(joint.axis),
            limits=joint.limits if joint.turns else tuple(lengths * np.array(joint.limits)),
        )
        for joint in robot.joints
    )
    boundaries = tuple(
        replace(b, normal=place(b.normal), offset=lengths * b.offset)
        if isinstance(b, HalfSpace)
        else replace(b, clearance=lengths * b.clearance)
        for b in robot.boundaries
    )
    bodies, obstacles = (
        tuple(Body(b.name, b.frame, shape(b.shape)) for b in own)
        for own in (robot.bodies, robot.obstacles)
    )
    factors = [1.0 if joint.turns else lengths for joint in robot.joints]
    return replace(
        robot,
        joints=joints,
        boundaries=boundaries,
        bodies=bodies,
        obstacles=obstacles,
        clearance=lengths * robot.clearance,
        home=robot.home * factors,
    )


def alike(one: Region, other: Region, factors: np.ndarray) -> None:
    """Both have the same components, and say the same of the same configurations."""
    assert len(one.components) == len(other.components)
    areas = [[c.area for c in region.components] for region in (one, other)]
    assert np.allclose(areas[0], np.array(areas[1]) / np.prod(factors), atol=1e-9)
    q = scenes.configurations(one.robot, 500)
    clear = np.abs(one.margins(q).min(axis=-1)) > 1e-9
    assert np.array_equal(one.contains(q)[clear], other.contains(q * factors)[clear])


@pytest.mark.parametrize("seed", range(4))
def test_a_scene_in_the_mirror_has_the_same_region(seed):
    robot = scenes.random_scene(seed, 6)
    mirrored = changed(robot, lambda p: p * [1.0, 1.0, -1.0], sense=-1.0)
    alike(find_region(robot), find_region(mirrored), np.ones(2))


@pytest.mark.parametrize("seed", range(4))
def test_a_scene_that_is_turned_has_the_same_region(seed):
    """All frames turn with it, each by the same angle."""
    robot = scenes.random_scene(seed, 6)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    alike(find_region(robot), find_region(changed(robot, lambda p: turn @ p)), np.ones(2))


@pytest.mark.parametrize("lengths", [100.0, 1000.0])
@pytest.mark.parametrize("seed", range(4))
def test_a_scene_in_cm_or_mm_has_the_region_that_it_has_in_m(seed, lengths):
    robot = scenes.random_scene(seed, 6)
    factors = np.array([1.0 if joint.turns else lengths for joint in robot.joints])
    alike(find_region(robot), find_region(changed(robot, lambda p: p, lengths)), factors)


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_the_area_is_that_of_columns_whose_ends_shapely_bisects(seed):
    robot = scenes.random_scene(seed, 6)
    region = find_region(robot)
    assert region.area == pytest.approx(by_columns(robot), abs=4e-3 * whole(robot))


def whole(robot: Robot) -> float:
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    return float(np.prod(np.diff(ends)))


def by_columns(robot: Robot, columns: int = 160, rows: int = 240) -> float:
    """Free lengths of columns at midpoints: between rows that differ the change is bisected."""
    (left, right), (low, high) = (joint.limits or (-np.pi, np.pi) for joint in robot.joints)
    t = left + (right - left) * (np.arange(columns) + 0.5) / columns
    v = np.linspace(low, high, rows + 1)
    free = ~scenes.hits(robot, np.stack(np.meshgrid(t, v, indexing="ij"), axis=-1).reshape(-1, 2))
    free = free.reshape(columns, rows + 1)
    i, k = np.nonzero(free[:, 1:] != free[:, :-1])
    start = free[i, k]
    a, b = v[k], v[k + 1]
    for _ in range(20):
        middle = (a + b) / 2
        same = ~scenes.hits(robot, np.stack([t[i], middle], axis=1)) == start
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    lengths = (free[:, 1:] & free[:, :-1]).sum() * (high - low) / rows
    lengths += np.where(start, a - v[k], v[k + 1] - a).sum()
    return float(lengths * (right - left) / columns)


def test_an_obstacle_that_moves_through_another_changes_the_area_without_a_jump():
    robot = scenes.random_scene(8, 1)
    still = Body("still", "0", Disc(np.array([1.2, 0, 0.4]), 0.25))
    found = []
    for x in np.linspace(0.9, 1.5, 13):
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.2 + [x, 0.4]
        moving = Body("moving", "0", scenes.polygon(square))
        scene = replace(robot, boundaries=(), obstacles=(still, moving))
        areas = [solve(clearance_problem(scene), base=base).area for base in (0, 1)]
        assert areas[0] == pytest.approx(areas[1], abs=1e-9)
        found.append(areas[0])
        if len(found) in (3, 7):
            assert areas[0] == pytest.approx(by_columns(scene), abs=4e-3 * whole(scene))
    steps = np.abs(np.diff(found))
    assert np.ptp(found) > 0.1
    assert steps.max() < 4 * np.median(steps) + 0.05


@pytest.mark.parametrize("seed", [7, 48, 95, 117])
def test_either_joint_may_be_the_base_where_bodies_rest_on_one_another(seed):
    """Slides along edges, corners on edges at the ends of a range: once wrong, one way or other."""
    robot = scenes.drawn_scene(seed)
    regions = [solve(clearance_problem(robot), base=base) for base in (0, 1)]
    q = scenes.configurations(robot, 300, seed)
    for region in regions:
        assert len(scenes.wrongly_told(robot, region, q)) == 0
        assert not scenes.touching_in_cells(robot, region, q).any()
    assert len(regions[0].components) == len(regions[1].components)
    assert regions[0].area == pytest.approx(regions[1].area, abs=1e-6)
