"""A scene that a reader makes: its link, its robot for the page, its robot file for the library."""

from __future__ import annotations

import tomllib
from functools import cache

import numpy as np
import pytest
import shapely

from cspace.boundary.evaluator import evaluator
from cspace.model.robotfile import parse_robot
from cspace.region import find_region
from engine_support.javascript import Script
from engine_support.live_scenes import TURN, figure_script

LINK = (
    "arm=0.9,0.55,0.1,0.08&home=10,20&q=-30,45.5&o=disc+1,0,0,0.2+K%C3%A4fig+2"
    "&o=polygon+0.5,-1,30,0.3,0,0,0.3,-0.2,-0.1+a.b-c_d&o=box+0.7,0.8,17.19,0.5,0.35+crate"
)
"""A link of the first edition."""

LINKS = ("upper arm", "forearm")


@cache
def context():
    scripts = (figure_script(f"{name}.js") for name in ("geometry", "space", "live"))
    return Script("const KINDS = {};", *scripts)


def js(expression, **values):
    return context()(expression, **values)


def scene_of(text):
    return js("sceneOf(text)", text=text)


def text_of(scene):
    return js("sceneText(scene, scene.q)", scene=scene)


def random_scene(seed):
    """A scene of discs, boxes and stars, seldom convex, near the arm or in its way."""
    rng = np.random.default_rng([13, seed])
    arm = [*rng.uniform(0.2, 1, 2), *rng.uniform(0.02, 0.3, 2)]
    words = [f"arm={','.join(map(str, arm))}&home=10,20"]
    for i in range(rng.integers(1, 7)):
        far, way, angle = rng.uniform(0.5, 2), *rng.uniform(-180, 180, 2)
        place = far * np.cos(np.radians(way)), far * np.sin(np.radians(way))
        at = TURN * (np.arange(7) + rng.uniform(0, 0.8, 7)) / 7
        star = rng.uniform(0.05, 0.4, (7, 1)) * np.column_stack([np.cos(at), np.sin(at)])
        kind, numbers = (
            ("disc", [rng.uniform(0.02, 0.4)]),
            ("box", [rng.uniform(0.05, 0.8), 0.3]),
            ("polygon", star.ravel()),
        )[i % 3]
        words.append(f"o={kind} {','.join(map(str, [*place, angle, *numbers]))} {kind} {i}")
    return scene_of(text_of(scene_of("&".join(words))))


def robot_of(scene):
    return parse_robot(tomllib.loads(js("robotFile(scene)", scene=scene)))


def test_a_link_of_the_first_edition_opens():
    scene = scene_of(LINK)
    assert [link["length"] for link in scene["links"]] == [0.9, 0.55]
    assert [link["radius"] for link in scene["links"]] == [0.05, 0.04]
    assert np.degrees(scene["home"]) == pytest.approx([10, 20])
    assert np.degrees(scene["q"]) == pytest.approx([-30, 45.5])
    disc, polygon, box = scene["obstacles"]
    assert [one["name"] for one in scene["obstacles"]] == ["Käfig 2", "a.b-c_d", "crate"]
    assert disc["parts"] == [{"corners": [[1, 0]], "radius": 0.2}]
    turn = np.array([[np.cos(np.pi / 6), -0.5], [0.5, np.cos(np.pi / 6)]])
    corners = np.array([[0.3, 0], [0, 0.3], [-0.2, -0.1]]) @ turn.T + [0.5, -1]
    assert np.allclose(polygon["corners"], corners)
    assert shapely.Polygon(box["corners"]).area == pytest.approx(0.5 * 0.35)


@pytest.mark.parametrize("seed", range(5))
def test_a_link_restores_the_scene(seed):
    scene = random_scene(seed)
    again = scene_of(text_of(scene))
    assert text_of(again) == text_of(scene)
    for one, other in zip(again["obstacles"], scene["obstacles"], strict=True):
        assert np.allclose(one["corners"], other["corners"], atol=1e-4)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", None),
        ("arm=1,1,1&home=0,0", None),
        ("arm=1,1,0.1,nan&home=0,0", None),
        ("arm=9,1,0.1,0&home=0,720", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=disc 1,1,0,-5 x&o=disc 1,1,0 x&o=ball 1,1,0,1 x", 1),
        ("arm=1,1,0.1,0.1&home=0,0&o=constructor 1,1,0,1 x&o=toString 1,1,0 x", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=polygon 0,0,0,-1,-1,1,1,1,-1,-1,1 x", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=polygon 0,0,0,0,0,1,0,0,1,0,0 x", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=polygon 0,0,0,0,0,1,0,0.5,0 x", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=polygon 0,0,0,-1,-1,1,1 x&o=box 1,1,0,,1 x&o= x", 0),
    ],
)
def test_a_link_that_says_no_scene_or_no_obstacle_is_not_taken(text, expected):
    found = scene_of(text)
    assert (found is None) if expected is None else len(found["obstacles"]) == expected
    if found:
        assert max(link["length"] for link in found["links"]) <= 1
        assert min(link["radius"] for link in found["links"]) >= 0.01


def test_names_are_unique_and_plain():
    names = ["forearm", "crate", "crate", '"]\nx = 1 # <b>', "\u202e", "x" * 90]
    found = js(
        "names.reduce((all, name) => [...all, { name: freeName(all, name) }], [])", names=names
    )
    expected = ["forearm 2", "crate", "crate 2", "x  1  b", "obstacle", "x" * 40]
    assert [one["name"] for one in found] == expected


@pytest.mark.parametrize("seed", range(5))
def test_the_robot_file_is_the_scene(seed):
    scene = random_scene(seed)
    robot = robot_of(scene)
    assert np.allclose(robot.home, scene["home"])
    assert [body.name for body in robot.obstacles] == [one["name"] for one in scene["obstacles"]]
    for link, name in zip(scene["links"], LINKS, strict=True):
        (part,) = robot.body(name).parts
        assert np.allclose(part.corners, [[0, 0, 0], [link["length"], 0, 0]])
        assert part.radius == pytest.approx(link["radius"])
    for one, body in zip(scene["obstacles"], robot.obstacles, strict=True):
        if one["kind"] == "disc":
            assert np.allclose(body.parts[0].corners, [[*one["corners"][0], 0]], atol=1e-6)
            assert body.parts[0].radius == one["numbers"][0]
        else:
            parts = [shapely.Polygon(part.corners[:, :2]) for part in body.parts]
            apart = shapely.union_all(parts) ^ shapely.Polygon(one["corners"])
            assert apart.area < 1e-5


@pytest.mark.parametrize("seed", [None, *range(8)])
def test_regions_of_the_page_are_those_of_its_robot_file(seed):
    """`None` is the scene with which the page opens."""
    scene = random_scene(seed) if seed is not None else js("sceneOf(FIRST_SCENE)")
    robot = robot_of(scene)
    region = find_region(robot)
    found = js("robotOf(scene, {}).regions.map(({ home, area }) => [home, area])", scene=scene)
    assert any(home for home, _ in found) == bool(evaluator(robot).margins([robot.home]).min() >= 0)
    assert sorted(area for _, area in found) == pytest.approx(
        sorted(one.area for one in region.components), abs=1e-3 * TURN**2
    )


@pytest.mark.parametrize("seed", range(5))
def test_each_region_holds_its_own_centre_and_no_other(seed):
    found = js(
        "((robot) => robot.regions.map(({ centre }) => [regionAt(robot, centre),"
        " judge(robot, centre).allowed]))(robotOf(scene, {}))",
        scene=random_scene(seed),
    )
    assert found == [[i, True] for i in range(len(found))]


def test_nothing_in_the_way_is_one_region_and_a_buried_base_none():
    start = "arm=1,0.8,0.1,0.1&home=0,0"
    for text, expected in (("", [TURN**2]), ("&o=disc 0,0,0,0.1 x", [])):
        scene = scene_of(start + text)
        areas = js("robotOf(scene, {}).regions.map(({ area }) => area)", scene=scene)
        assert areas == pytest.approx(expected)


def test_walls_of_the_upper_arm_cut_the_square_and_home_comes_first():
    """Two discs that only the upper arm meets, on either side: two regions of known areas."""
    half = np.arcsin(0.2 / 0.5)
    small, large = (np.pi / 2 - 2 * half), (3 * np.pi / 2 - 2 * half)
    for home, expected in ((45, (small, large)), (180, (large, small))):
        text = f"arm=1,0.2,0.1,0.1&home={home},0&o=disc 0.5,0,0,0.15 a&o=disc 0,0.5,0,0.15 b"
        regions = js("robotOf(sceneOf(text), {}).regions", text=text)
        assert [one["home"] for one in regions] == [True, False]
        areas = [one["area"] for one in regions]
        assert areas == pytest.approx(np.multiply(expected, TURN), abs=1e-6)


@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9])
def test_a_slit_is_a_way_however_narrow_it_is_and_no_way_where_it_is_closed(width):
    """Two discs leave the upper arm a slit of so many rad, another one closes the far way round."""
    half = np.arcsin(0.2 / 0.5)

    def regions(slit):
        way = 2 * half + slit
        discs = [[0.5, 0], [0.5 * np.cos(way), 0.5 * np.sin(way)], [-0.5, 0]]
        parts = [[{"corners": [place], "radius": 0.15}] for place in discs]
        return js(
            "regionsOf([{ length: 1, radius: 0.05 }, { length: 0.2, radius: 0.05 }],"
            " parts.map((all) => ({ name: 'disc', parts: all })), [0, 0])"
            ".map(({ area }) => area)",
            parts=parts,
        )

    open_slit, closed = regions(width), regions(-width)
    assert len(open_slit) == len(closed) + 1 == 3
    assert min(open_slit) == pytest.approx(width * TURN, rel=1e-2)
