"""Scenes in whole numbers, where bodies touch along edges, at corners and without room."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely

from cspace.model.robot import Body, Disc
from cspace.model.robotfile import parse_robot
from cspace.region import Problem, clearance_problem, solve
from engine_support import body_scenes
from engine_support.arms import in_xz, joint, robot_table

KINDS = ("rr", "rp", "pr", "pp")
JOINT = {"r": "revolute", "p": "prismatic"}
LINKS: dict[str, dict[str, Any]] = {
    "capsules": {
        "1": {"capsule": {"from": [0, 0, 0], "to": [0.5, 0, 0], "radius": 0.05}},
        "2": {"capsule": {"from": [0, 0, 0], "to": [0.4, 0, 0], "radius": 0.05}},
    },
    "bars": {
        "1": {"polygon": [[0, -0.05], [0.5, -0.05], [0.5, 0.05], [0, 0.05]]},
        "2": {"polygon": [[0, -0.05], [0.4, -0.05], [0.4, 0.05], [0, 0.05]]},
    },
    "outer bar": {"2": {"polygon": [[0, -0.05], [0.5, -0.05], [0.5, 0.05], [0, 0.05]]}},
    "tip": {"2": {"disc": {"at": [0.5, 0, 0], "radius": 0.1}}},
}


def square(x: float, y: float, side: float) -> dict[str, Any]:
    """Corners are the doubles of short decimals: what touches in decimals touches exactly."""
    far, top = round(x + side, 9), round(y + side, 9)
    return {"polygon": [[x, y], [far, y], [far, top], [x, top]]}


BENT = [[0.4, 0.2], [0.8, 0.2], [0.8, 0.6], [0.7, 0.6], [0.7, 0.3], [0.4, 0.3]]
SCENES = {
    "square on square": [square(0.5, 0.3, 0.2), square(0.5, 0.5, 0.2)],
    "one square twice": [square(0.5, 0.3, 0.2), square(0.5, 0.3, 0.2)],
    "corner on corner": [square(0.5, 0.3, 0.2), square(0.7, 0.5, 0.2)],
    "discs that touch": [{"disc": {"at": [x, 0.5, 0], "radius": 0.1}} for x in (0.5, 0.7)],
    "a corridor as wide as the link": [square(0.3, 0.05, 0.5), square(0.3, -0.55, 0.5)],
    "the base inside": [square(-0.1, -0.1, 0.2)],
    "overlapping": [square(0.5, 0.3, 0.3), square(0.6, 0.4, 0.3)],
    "four round the base": [
        square(x, y, 0.2) for x, y in ((0.5, -0.1), (-0.7, -0.1), (-0.1, 0.5), (-0.1, -0.7))
    ],
    "not convex": [{"polygon": BENT}],
}


def problem(kinds: str, links: str, scene: str, turned: float = 0.0) -> Problem:
    """State the problem of an arm in the plane of x and y; the whole may be turned."""
    axes = {
        "r": [[0, 0, 1], [0, 0, 1]],
        "p": [[1, 0, 0], [0, 1, 0] if kinds[0] == "p" else [1, 0, 0]],
    }
    joints = [
        joint(JOINT[kind], str(j), str(j + 1), [0.5 * j, 0, 0], axes[kind][j])
        | ({"limits": [-0.6, 0.6]} if kind == "p" else {})
        | ({"rpy": [0, 0, turned]} if j == 0 else {})
        for j, kind in enumerate(kinds)
    ]
    c, s = np.cos(turned), np.sin(turned)
    turn = np.array([[c, s], [-s, c]])
    table = robot_table(
        joints,
        {"q1": 0.1, "q2": 0.1},
        "2",
        boundary=[],
        body=[{"name": f"link {f}", "frame": f, **shape} for f, shape in LINKS[links].items()],
        obstacle=[{"name": f"block {i}", **_turned(b, turn)} for i, b in enumerate(SCENES[scene])],
        collisions="all",
        allowed=[["link 1", "link 2"]] if len(LINKS[links]) > 1 else [],
    )
    return clearance_problem(parse_robot(table))


def _turned(block: dict[str, Any], turn: np.ndarray) -> dict[str, Any]:
    if "disc" in block:
        at = (np.array(block["disc"]["at"][:2]) @ turn).tolist()
        return {"disc": {"at": [*at, 0], "radius": block["disc"]["radius"]}}
    return {"polygon": (np.array(block["polygon"]) @ turn).tolist()}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("links", LINKS)
@pytest.mark.parametrize("kinds", KINDS)
def test_both_bases_find_the_same_components(kinds: str, links: str, scene: str) -> None:
    one, other = (solve(problem(kinds, links, scene), base=base) for base in (0, 1))
    assert len(one.components) == len(other.components)
    areas = [[component.area for component in region.components] for region in (one, other)]
    np.testing.assert_allclose(*areas, rtol=0, atol=1e-9)


@pytest.mark.parametrize("scene", ["square on square", "four round the base", "not convex"])
def test_a_scene_that_is_turned_with_the_arm_has_the_same_region(scene: str) -> None:
    straight, turned = (solve(problem("rr", "bars", scene, angle)) for angle in (0.0, 0.7))
    # Corners that are turned in doubles do not touch exactly: what opens there is that narrow.
    areas = [[c.area for c in region.components if c.area > 1e-12] for region in (straight, turned)]
    np.testing.assert_allclose(*areas, rtol=0, atol=1e-9)


def test_an_end_that_slides_along_an_edge_passes_it_at_one_pose_only() -> None:
    """The elbow touches each square at one angle of the first joint: nothing goes through there."""
    region = solve(problem("rr", "outer bar", "four round the base"))
    assert len(region.components) == 4


def test_arcs_name_the_features_in_contact_and_follow_them() -> None:
    """On every arc the two features that it names are as far apart as the pair has to be."""
    region = solve(problem("rr", "capsules", "not convex"))
    found = 0
    for component in region.components:
        for arc in (arc for loop in component.loops for arc in loop):
            assert " on " in arc.feature
            q = arc.nodes(8)[0].reshape(-1, 2)
            margin = region.margins(q)[:, region.boundaries.index(arc.boundary)]
            np.testing.assert_allclose(margin, 0, atol=1e-9)
            found += 1
    assert found > 10
    assert {"edge", "corner"} <= {
        word for arc in component.loops[0] for word in arc.feature.split()
    }


def test_a_body_that_always_touches_what_it_may_not_leaves_nothing() -> None:
    region = solve(problem("rr", "bars", "the base inside"))
    assert region.components == ()
    assert region.empty_because == ("link 1, block 0",)


def test_the_area_is_that_of_fine_polygons() -> None:
    """Slides alone: what an obstacle forbids is the sum of polygons, which shapely can draw."""
    region = solve(problem("pp", "outer bar", "square on square"))
    bar = np.array(LINKS["outer bar"]["2"]["polygon"])
    free = shapely.box(-0.6, -0.6, 0.6, 0.6)
    for block in SCENES["square on square"]:
        sums = (np.array(block["polygon"])[:, None] - bar - [0.5, 0.0]).reshape(-1, 2)
        free -= shapely.convex_hull(shapely.MultiPoint(sums))
    assert region.area == pytest.approx(free.area, abs=1e-12)


def test_an_obstacle_that_moves_through_another_changes_the_area_without_a_jump() -> None:
    robot = body_scenes.robot(body_scenes.ordinary(8, obstacles=1))
    still = Body("still", robot.base, Disc(np.array([1.2, 0, 0.4]), 0.25))
    found = []
    for x in np.linspace(0.9, 1.5, 13):
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.2 + [x, 0.4]
        moving = Body("moving", robot.base, in_xz(square))
        scene = replace(robot, boundaries=(), obstacles=(still, moving))
        areas = [solve(clearance_problem(scene), base=base).area for base in (0, 1)]
        assert areas[0] == pytest.approx(areas[1], abs=1e-9)
        found.append(areas[0])
    steps = np.abs(np.diff(found))
    assert np.ptp(found) > 0.1
    assert steps.max() < 4 * np.median(steps) + 0.05
