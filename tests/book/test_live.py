"""The page "Configuration space, live": its intervals, gaps, pieces, links and robot files."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely

from cspace import find_region
from cspace.boundary.evaluator import evaluator
from cspace.explorer.page import ENGINE, engine_script, shorter_script, web_text
from cspace.model.robotfile import parse_robot
from engine_support.javascript import Script
from support.play import NO_PAGE

ROOT = Path(__file__).resolve().parents[2]
PLAY = ROOT / "book" / "_static" / "play"
OWN = ("live_space", "live_scene", "live")
MOST_BYTES = 60_000  # of the page's own script
NEAR = 1e-9  # m: nearer to contact, rounding decides


@cache
def context():
    return Script(
        NO_PAGE,
        *map(web_text, ENGINE),
        *((PLAY / f"{name}.js").read_text("utf-8") for name in OWN),
        "const space = qboundLiveSpace, made = qboundLiveScene, figure = qboundFigures.live;",
    )


def js(expression, **values):
    return context()(expression, **values)


def obstacle(rng, i):
    """Draw one, near the arm or in its way; polygons are stars about their place, seldom convex."""
    far, way = rng.uniform(0.5, 2), rng.uniform(-np.pi, np.pi)
    found = {"name": f"{i}", "x": far * np.cos(way), "y": far * np.sin(way), "angle": 0}
    kind = ("disc", "box", "polygon")[i % 3]
    found |= {"kind": kind, "sizes": [], "corners": []}
    if kind == "disc":
        return found | {"sizes": [rng.uniform(0.02, 0.4)]}
    found["angle"] = rng.uniform(-3, 3)
    if kind == "box":
        return found | {"sizes": [rng.uniform(0.05, 0.8), 0.3]}
    at = 2 * np.pi * (np.arange(7) + rng.uniform(0, 0.8, 7)) / 7
    corners = rng.uniform(0.05, 0.4, (7, 1)) * np.column_stack([np.cos(at), np.sin(at)])
    return found | {"corners": corners.tolist()}


def scene(seed):
    rng = np.random.default_rng([13, seed])
    arm = {
        "lengths": rng.uniform(0.2, 1, 2).tolist(),
        "radii": rng.uniform(0.01, 0.15, 2).tolist(),
    }
    obstacles = [obstacle(rng, i) for i in range(rng.integers(1, 10))]
    shapes = js("obstacles.map(space.placed)", obstacles=obstacles)
    return arm, obstacles, shapes, rng.uniform(-np.pi, np.pi, (300, 2))


def gaps(arm, shapes, q):
    """Return the library that judges: (poses, links, shapes), by shapely; 0 and less: overlap."""
    cores = [
        shapely.Polygon(s["points"]) if len(s["points"]) > 1 else shapely.Point(s["points"][0])
        for s in shapes
    ]
    angles = np.cumsum(q, axis=-1)
    steps = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    places = np.cumsum(np.array(arm["lengths"])[:, None] * steps, axis=-2)
    places = np.concatenate([np.zeros((len(q), 1, 2)), places], axis=-2)
    links = shapely.linestrings(np.stack([places[:, :-1], places[:, 1:]], axis=-2))
    apart = shapely.distance(links[..., None], np.array(cores))
    radii = np.array([s["radius"] for s in shapes])
    return apart - radii - np.array(arm["radii"])[:, None]


def holds(intervals, value):
    return any(a < value < b for a, b in zip(intervals[::2], intervals[1::2], strict=True))


@pytest.mark.parametrize("seed", range(30))
def test_forbidden_angles_are_those_at_which_a_link_overlaps_an_obstacle(seed):
    arm, _, shapes, q = scene(seed)
    windows = js("shapes.map((s) => space.upperArm(arm, s))", arm=arm, shapes=shapes)
    fibres = js(
        "q.map(([first]) => shapes.map((s) => space.forearm(arm, s, first)))",
        arm=arm,
        shapes=shapes,
        q=q.tolist(),
    )
    expected = gaps(arm, shapes, q)
    found = np.array(
        [
            [
                [holds(window, first) for window in windows],
                [holds(fibre, second) for fibre in column],
            ]
            for (first, second), column in zip(q, fibres, strict=True)
        ]
    )
    clear = np.abs(expected) > NEAR
    assert np.array_equal(found[clear], expected[clear] < 0)


@pytest.mark.parametrize("seed", range(10))
def test_gaps_are_shapelys_and_the_nearest_places_lie_so_far_apart(seed):
    arm, _, shapes, q = scene(seed)
    q = q[:60]
    found = js(
        "q.map((pair) => space.encounters(arm, shapes, pair))",
        arm=arm,
        shapes=shapes,
        q=q.tolist(),
    )
    expected = gaps(arm, shapes, q).reshape(len(q), -1)
    assert np.allclose([[one["gap"] for one in row] for row in found], expected, atol=1e-12)
    one = min((e for row in found for e in row if e["gap"] > 0), key=lambda e: e["gap"])
    radii = arm["radii"][one["link"]] + shapes[one["obstacle"]]["radius"]
    assert np.hypot(*np.subtract(*one["places"])) - radii == pytest.approx(one["gap"])


@pytest.mark.parametrize("seed", range(10))
def test_a_pose_that_collides_leaves_through_the_contact_that_is_named(seed):
    arm, _, shapes, q = scene(seed)
    hits = np.argwhere(gaps(arm, shapes, q) < -NEAR)[:50]
    cases = [[int(link), int(i), q[k].tolist()] for k, link, i in hits]
    exits = js(
        "all.map(([k, i, pair]) => figure.exitContact(arm, shapes[i], k, pair))",
        arm=arm,
        shapes=shapes,
        all=cases,
    )
    assert len(exits) == len(hits)
    assert all(abs(one["gap"]) < 1e-7 for one in exits if one)
    assert any(exits) == (seed != 1)  # there the arm is too short for its one obstacle


def pieces(arm, obstacles, home=(0, 0), columns=360):
    return js(
        "(({ areas, home }) => ({ areas, home }))(space.regions(space.freeSpace(columns)"
        ".columnsOf(arm, obstacles.map(space.placed)), home))",
        arm=arm,
        obstacles=obstacles,
        home=home,
        columns=columns,
    )


@pytest.mark.parametrize("seed", range(4))
def test_the_free_share_is_that_of_a_sample(seed):
    """Judged by shapely; four standard deviations of 20,000 poses are 1.4 percent at most."""
    arm, obstacles, shapes, _ = scene(seed)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (20_000, 2))
    expected = np.all(gaps(arm, shapes, q) >= 0, axis=(1, 2)).mean()
    assert sum(pieces(arm, obstacles)["areas"]) / (4 * np.pi**2) == pytest.approx(
        expected, abs=0.014
    )


@pytest.mark.parametrize("seed", range(6))
def test_pieces_and_areas_do_not_depend_on_the_columns(seed):
    arm, obstacles, _, _ = scene(seed)
    coarse, fine = (pieces(arm, obstacles, columns=n)["areas"] for n in (400, 1500))
    shown = [[area for area in areas if area > 1e-3] for areas in (coarse, fine)]
    assert len(shown[0]) == len(shown[1])
    assert np.allclose(sorted(shown[0]), sorted(shown[1]), atol=5e-3)


@pytest.mark.parametrize("seed", [None, *range(5)])
def test_pieces_are_the_components_of_the_librarys_exact_region(seed):
    """From the file that the page saves; `None` is the scene with which the page opens."""
    given = js("made.START")
    if seed is not None:
        arm, obstacles, _, _ = scene(seed)
        named = [one | {"name": f"o{i}"} for i, one in enumerate(obstacles)]
        given |= {"lengths": arm["lengths"], "thicknesses": [2 * r for r in arm["radii"]]}
        given |= {"obstacles": named}
    given = js("made.sceneOf(made.textOf(scene))", scene=given)
    region = find_region(parse_robot(tomllib.loads(js("made.robotFile(scene)", scene=given))))
    arm = js("made.armOf(scene)", scene=given)
    found = pieces(arm, given["obstacles"], given["home"], columns=1000)
    assert found["home"] == (region.home_component is not None)
    assert found["areas"] == pytest.approx([one.area for one in region.components], abs=1e-3)


def test_nothing_in_the_way_is_one_piece_and_a_buried_base_none():
    arm = {"lengths": [1, 0.8], "radii": [0.05, 0.05]}
    disc = {"kind": "disc", "x": 0, "y": 0, "angle": 0, "sizes": [0.1]}
    assert pieces(arm, [])["areas"] == pytest.approx([4 * np.pi**2])
    assert pieces(arm, [disc]) == {"areas": [], "home": False}
    assert len(pieces(arm, [disc | {"x": 3}])["areas"]) == 1


def test_walls_of_the_upper_arm_cut_the_square_and_home_comes_first():
    """Two discs that only the upper arm meets, on either side: two pieces of known areas."""
    arm = {"lengths": [1, 0.2], "radii": [0.05, 0.05]}
    disc = {"kind": "disc", "y": 0, "angle": 0, "sizes": [0.15]}
    both = [disc | {"x": 0.5}, disc | {"x": 0, "y": 0.5}]
    half = np.arcsin(0.2 / 0.5)
    small, large = ((np.pi / 2 - 2 * half), (3 * np.pi / 2 - 2 * half))
    for home, expected in ((np.pi / 4, (small, large)), (np.pi, (large, small))):
        found = pieces(arm, both, [home, 0])
        assert found["home"]
        assert found["areas"] == pytest.approx(np.multiply(expected, 2 * np.pi), abs=1e-6)


def test_outlines_have_the_area_of_their_pieces():
    arm, obstacles, _, _ = scene(2)
    outlines, areas = js(
        "((found) => [space.outlines(found.columns, found.of, found.areas.length,"
        " { x0: 300, dx: 90, y0: 300, dy: -90 }), found.areas])"
        "(space.regions(space.freeSpace(700).columnsOf(arm, obstacles.map(space.placed)),"
        " [0, 0]))",
        arm=arm,
        obstacles=obstacles,
    )
    for outline, area in zip(outlines, areas, strict=True):
        rings = [
            [tuple(map(float, point.split())) for point in ring.split("L")]
            for ring in outline["fill"].replace("Z", "").split("M")[1:]
        ]
        drawn = sum(shapely.Polygon(ring).area for ring in rings if len(ring) > 2)
        assert drawn / 90**2 == pytest.approx(area, rel=5e-3, abs=5e-3)


# --- scenes ---------------------------------------------------------------------------------------

NAMES = ("crate", "Käfig 2", "a.b-c_d")


def told(seed, names=NAMES):
    _, obstacles, _, _ = scene(seed)
    named = [
        one | {"name": name} for one, name in zip(obstacles[: len(names)], names, strict=False)
    ]
    start = js("made.START")
    return start | {"lengths": [0.9, 0.55], "thicknesses": [0.1, 0.08], "obstacles": named}


@pytest.mark.parametrize("seed", range(5))
def test_a_link_restores_the_scene(seed):
    first = js("made.sceneOf(made.textOf(scene))", scene=told(seed))
    assert js("made.sceneOf(made.textOf(scene))", scene=first) == first
    assert [one["name"] for one in first["obstacles"]] == list(NAMES[: len(first["obstacles"])])
    given = js("obstacles.map(space.placed)", obstacles=told(seed)["obstacles"])
    found = js("obstacles.map(space.placed)", obstacles=first["obstacles"])
    for one, other in zip(given, found, strict=True):
        assert np.allclose(one["points"], other["points"], atol=3e-4)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", None),
        ("three-things-to-try", None),
        ("arm=1,1,1&home=0,0", None),
        ("arm=1,1,0.1,nan&home=0,0", None),
        ("arm=1,1,0.1,0.1&home=0,Infinity", None),
        ("arm=9,1,0.1,0&home=0,720", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=disc 1,1,0,-5 x&o=disc 1,1,0 x&o=ball 1,1,0,1 x", 1),
        ("arm=1,1,0.1,0.1&home=0,0&o=constructor 1,1,0,1 x&o=toString 1,1,0 x", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=polygon 0,0,0,-1,-1,1,1,1,-1,-1,1 x", 0),
        ("arm=1,1,0.1,0.1&home=0,0&o=polygon 0,0,0,-1,-1,1,1 x&o=box 1,1,0,,1 x&o= x", 0),
    ],
)
def test_a_link_that_says_no_scene_or_no_obstacle_is_not_taken(text, expected):
    found = js("made.sceneOf(text)", text=text)
    assert (found is None) if expected is None else len(found["obstacles"]) == expected
    if found:
        assert max(found["lengths"]) <= 1
        assert min(found["thicknesses"]) >= 0.02


def test_names_are_unique_and_plain():
    names = ["forearm", "crate", "crate", '"]\nx = 1 # <b>', "\u202e", "x" * 90]
    given = told(0)["obstacles"][0]
    named = [given | {"name": name} for name in names]
    found = js("made.sceneOf(made.textOf(scene))", scene=told(0) | {"obstacles": named})
    assert [one["name"] for one in found["obstacles"]] == [
        "forearm 2",
        "crate",
        "crate 2",
        "x  1  b",
        "obstacle",
        "x" * 40,
    ]


@pytest.mark.parametrize("seed", range(5))
def test_the_robot_file_is_the_scene(seed):
    given = js("made.sceneOf(made.textOf(scene))", scene=told(seed))
    robot = parse_robot(tomllib.loads(js("made.robotFile(scene)", scene=given)))
    assert np.allclose(robot.home, given["home"])
    assert robot.collisions
    assert [body.name for body in robot.obstacles] == [one["name"] for one in given["obstacles"]]
    for k, name in enumerate(("upper arm", "forearm")):
        (part,) = robot.body(name).parts
        assert np.allclose(part.corners, [[0, 0, 0], [given["lengths"][k], 0, 0]])
        assert part.radius == given["thicknesses"][k] / 2
    shapes = js("obstacles.map(space.placed)", obstacles=given["obstacles"])
    for shape, body in zip(shapes, robot.obstacles, strict=True):
        if len(shape["points"]) == 1:
            (part,) = body.parts
            assert np.allclose(part.corners[:, :2], shape["points"], atol=1e-6)
            assert part.radius == shape["radius"]
        else:
            parts = [shapely.Polygon(part.corners[:, :2]) for part in body.parts]
            whole = shapely.Polygon(shape["points"])
            assert sum(part.area for part in parts) == pytest.approx(whole.area, abs=1e-5)
            assert all(part.difference(whole).area < 1e-5 for part in parts)


@pytest.mark.parametrize("seed", range(5))
def test_poses_of_the_page_have_the_librarys_margins(seed):
    """From the file that the page saves: gaps where apart, and collisions, of 1000 poses each."""
    given = js("made.sceneOf(made.textOf(scene))", scene=told(seed))
    robot = parse_robot(tomllib.loads(js("made.robotFile(scene)", scene=given)))
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (1000, 2))
    found = js(
        "q.map((pair) => space.encounters(made.armOf(scene),"
        " scene.obstacles.map(space.placed), pair).map((one) => one.gap))",
        scene=given,
        q=q.tolist(),
    )
    names = [
        f"{link}, {one['name']}" for link in ("upper arm", "forearm") for one in given["obstacles"]
    ]
    assert [pair.name for pair in robot.used] == names
    expected, gaps_found = evaluator(robot).margins(q), np.array(found)
    apart = expected > 0
    assert np.allclose(gaps_found[apart], expected[apart], atol=1e-5)  # a file has six decimals
    clear = np.abs(expected) > 1e-5
    assert np.array_equal(gaps_found[clear] < 0, expected[clear] < 0)


def test_the_tool_reaches_where_it_is_dragged_bent_as_before():
    arm = {"lengths": [1, 0.8], "radii": [0.1, 0.1]}
    rng = np.random.default_rng(2)
    for pair, far, way in zip(
        rng.uniform(-3, 3, (50, 2)), rng.uniform(0, 3, 50), rng.uniform(-3, 3, 50), strict=True
    ):
        place = far * np.array([np.cos(way), np.sin(way)])
        found = js(
            "space.poseAt(arm, pair, place)", arm=arm, pair=pair.tolist(), place=place.tolist()
        )
        tip = js("space.jointPlaces(arm, q)[2]", arm=arm, q=found)
        assert np.hypot(*tip) == pytest.approx(np.clip(far, 0.2, 1.8))
        assert np.cross([*tip, 0], [*place, 0])[2] == pytest.approx(0, abs=1e-9)
        assert np.sign(np.sin(found[1])) in (0, np.sign(np.sin(pair[1])))


def test_the_page_has_at_most_60_kilobytes_of_its_own_script():
    own = [shorter_script((PLAY / f"{name}.js").read_text("utf-8")) for name in OWN]
    assert sum(len(text.encode()) for text in own) <= MOST_BYTES


def test_an_engine_without_explorers_has_everything_else():
    script = Script("globalThis.window = globalThis;", engine_script(explorer=False))
    names = set(script("Object.keys(qboundEngine)"))
    assert {"picture", "draggable", "onKeys", "framesOf"} <= names
    assert script("qboundEngine.mount === null")
    assert len(engine_script(explorer=False)) < 0.7 * len(engine_script())
