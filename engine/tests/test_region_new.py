"""The new region engine beside the old one: the same components, areas, loops and vertices."""

import pickle
from pathlib import Path

import numpy as np
import pytest

from cspace import load_robot
from cspace.model.robotfile import parse_robot
from cspace.region import Problem, clearance_problem
from cspace.region import solve as solve_before
from cspace.region_new import Region, solve
from cspace.region_new.region import faults
from engine_support import body_scenes, scenes
from engine_support.robots import drawn_robot, random_robot

ONCE_WRONG = sorted(Path(__file__).with_name("once_wrong").glob("*.toml"))
PACKAGED = (
    "minervabot-v2",
    "minervabot-v2-bodies",
    "minervabot-v2-corrected",
    "minervabot-v2-symmetric",
    "pp-portal",
    "pr-gantry-arm",
    "rp-telescopic-boom",
    "two-joint-arm-with-walls",
    "two-links-on-a-table",
)
BESIDE = {18: "base 1 has an arc of 1e-13 beside an edge that is tilted by 1e-16"}
"""Scenes of `body_scenes` with another count of vertices, and why."""


def compared(problem: Problem, *, vertices: bool = True) -> list[str]:
    """What the new engine finds otherwise than the old one over either joint, or its check."""
    before, found = solve_before(problem), []
    for base in (0, 1):
        region = solve(problem, base=base)
        if region.base != base or region.unresolved:
            found.append(f"base {base}: {region.unresolved or 'found over the other joint'}")
            continue
        found += [f"base {base}: {each}" for each in differences(before, region, vertices=vertices)]
    return found


def differences(before: object, region: Region, *, vertices: bool) -> list[str]:
    """Compare counts exactly, and areas and vertices within their errors."""
    one, other = (sorted(r.components, key=lambda c: -c.area) for r in (before, region))  # type: ignore[attr-defined]
    if len(one) != len(other):
        return [f"{len(other)} components, not {len(one)}"]
    total, found = sum(c.area for c in one) or 1.0, []
    for a, b in zip(one, other, strict=True):
        if abs(a.area - b.area) > 1e-9 * total:
            found.append(f"an area of {b.area}, not {a.area}")
    for what in ("loops", "vertices") if vertices else ("loops",):
        counts = [
            sorted((round(c.area / total, 8), len(getattr(c, what))) for c in r)
            for r in (one, other)
        ]
        if counts[0] != counts[1]:
            found.append(f"{what}: {counts[1]}, not {counts[0]}")
    own = sorted((round(c.area / total, 8), c.wraps, c.contains_home) for c in other)
    if own != sorted((round(c.area / total, 8), c.wraps, c.contains_home) for c in one):
        found.append("other windings, or home elsewhere")
    return found


@pytest.mark.parametrize("name", PACKAGED)
def test_packaged_robots_have_the_same_region_with_the_same_outlines(name):
    problem = clearance_problem(load_robot(name))
    assert not compared(problem)
    before, region = solve_before(problem), solve(problem)
    for a, b in zip(before.components, region.components, strict=True):
        assert (a.centroid is None) == (b.centroid is None)
        assert a.centroid is None or np.allclose(a.centroid, b.centroid, atol=1e-9)
        old, new = ({v.boundaries: v.q for v in c.vertices} for c in (a, b))
        assert old.keys() == new.keys()
        if not any(a.wraps):
            for v, w in zip(a.vertices, b.vertices, strict=True):
                assert v.boundaries == w.boundaries
                assert np.abs(v.q - w.q).max() <= 1e3 * (v.error + w.error) * (1 + abs(v.q).max())


@pytest.mark.parametrize("path", ONCE_WRONG, ids=lambda path: path.stem)
def test_robots_that_were_once_wrong_have_the_same_region(path):
    assert not compared(clearance_problem(load_robot(path)))


@pytest.mark.parametrize("block", range(3))
def test_random_scenes_have_the_same_region(block):
    for seed in range(5 * block, 5 * block + 5):
        for make in (scenes.random_scene, scenes.drawn_scene, drawn_robot, random_robot):
            assert not compared(clearance_problem(make(seed))), (make.__name__, seed)
        problem = clearance_problem(parse_robot(body_scenes.scene(seed)))
        assert not compared(problem, vertices=seed not in BESIDE), seed


@pytest.mark.parametrize("values", [(0.0, -1.2, 0.4, 0.0), (0.0, -np.pi / 2, 0.0, -np.pi / 2)])
def test_slices_have_the_same_region(values):
    """Held angles are rational rotations here, and balls there."""
    robot = load_robot("ur5")
    assert not compared(clearance_problem(robot, dict(zip((0, 3, 4, 5), values, strict=True))))


def test_a_region_is_data():
    """It goes through pickle, and answers the same after it."""
    region = solve(clearance_problem(load_robot("two-links-on-a-table")))
    again = pickle.loads(pickle.dumps(region))
    q = region.sample(100, seed=1)
    assert again == region
    assert again.component_of(q).tolist() == region.component_of(q).tolist()
    assert not faults(again)
    assert again.components[0].loops[0][0].at(0.5).tolist() == pytest.approx(
        region.components[0].loops[0][0].at(0.5).tolist()
    )


def test_the_check_sees_a_region_of_other_numbers():
    """Its outlines lie off the boundaries of a robot with another clearance."""
    from dataclasses import replace

    robot = load_robot("two-links-on-a-table")
    other = clearance_problem(replace(robot, clearance=robot.clearance + 0.01))
    assert faults(replace(solve(clearance_problem(robot)), problem=other))
