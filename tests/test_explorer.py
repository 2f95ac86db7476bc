"""The explorer's page: its arithmetic is the library's, its data are whole, names do no harm."""

from __future__ import annotations

import json
import math
import re
from base64 import b64decode
from functools import cache
from html.parser import HTMLParser
from importlib import resources

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

from lizarraga2025 import closed_form
from qbound import find_region, load_robot, packaged_robots
from qbound.boundary.evaluator import evaluator
from qbound.boundary.functions import clearance, position
from qbound.cli import main
from qbound.explorer import surface_page
from qbound.explorer.data import explorer_data
from qbound.explorer.page import ARITHMETIC, SCRIPTS, explore, explorer_page
from qbound.measures.scaling import least_along_edges
from qbound.model.robotfile import parse_robot
from qbound.paths.traversal import traverse
from qbound.region import paper_rule, violated
from qbound.workspace.planar import planar_arm, postures
from support import scenes
from support.arms import ORIGINS, ROBOTS, SIDE, SPATIAL, joint, robot_table
from support.javascript import Script

TEMPLATES = resources.files("qbound") / "explorer" / "web"
POSES = 1000


class Arithmetic(Script):
    """The page's arithmetic, and a robot."""

    def __init__(self, data):
        super().__init__("".join((TEMPLATES / name).read_text("utf-8") for name in ARITHMETIC))
        self.data = data
        self.read(f"const robot = {json.dumps(data)};")
        self.read("const map = toolMap(robot, robot.q); const arm = armOf(map);")


@cache
def case(name):
    robot, held = (ROBOTS | SPATIAL)[name]()
    region = find_region(robot, held)
    return robot, held, region, Arithmetic(explorer_data(region))


def poses(data, n=POSES, seed=5):
    """Draw configurations: the free joints within the view, the held ones as they are."""
    low, high = (np.array([v[end] for v in data["views"]]) for end in ("low", "high"))
    q = np.tile(data["q"], (n, 1))
    q[:, data["free"]] = np.random.default_rng(seed).uniform(low, high, (n, 2))
    return q


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_margins_are_the_librarys(name):
    robot, _, _, script = case(name)
    q = poses(script.data)
    found = script("all.map((q) => margins(robot, q))", all=q.tolist())
    assert len(found) == POSES
    names = [b.name for b in robot.boundaries if b.used]
    for pose, rows in zip(q, found, strict=True):
        safe = {row["name"]: row["value"] for row in rows if row["used"]}
        told = dict(violated(robot, pose))
        below = {n: v for n, v in safe.items() if v < 0}
        assert below.keys() == told.keys()
        assert_allclose([below[n] for n in told], list(told.values()), atol=1e-12)
    for b in [robot.boundary(n) for n in names]:
        values = [next(r["value"] for r in rows if r["name"] == b.name) for rows in found]
        assert np.array_equal(np.array(values) > 0, clearance(robot, b)(q) > 0)


@cache
def among_obstacles(seed):
    """A scene of capsules, polygons and discs, every fourth of the same two kinds of joints."""
    robot = scenes.random_scene(seed, 3)
    region = find_region(robot)
    return robot, region, Arithmetic(explorer_data(region))


@pytest.mark.parametrize("seed", range(4))
def test_margins_of_bodies_are_the_librarys_and_the_nearest_places_show_them(seed):
    robot, _, script = among_obstacles(seed)
    q = poses(script.data, 60)
    compiled = evaluator(robot, limits=False)
    found = script("all.map((q) => margins(robot, q))", all=q.tolist())
    own = {row["name"]: [] for row in found[0]}
    for rows in found:
        for row in rows:
            own[row["name"]].append(row["value"])
    expected = dict(zip(compiled.names, compiled.margins(q).T, strict=True))
    for name, values in expected.items():
        assert_allclose(own[name], values, atol=1e-12)
    places = """all.map((q) => { const placed = placedParts(robot, framesOf(robot, q));
        return robot.boundaries.filter((wall) => wall.kind === "bodies")
            .map((wall) => [wall.name, bodiesEncounter(wall, placed).places]); })"""
    for k, row in enumerate(script(places, all=q.tolist())):
        for name, (one, other) in row:
            asked = robot.boundary(name).clearance
            gap = np.hypot(*np.subtract(one, other)) - asked
            if expected[name][k] + asked > 0:
                assert gap == pytest.approx(expected[name][k], abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_fibres_of_a_scene_are_free_where_the_library_says(seed):
    _, region, script = among_obstacles(seed)
    pairs = poses(script.data, 50)[:, script.data["free"]]
    script.read("const problem = sliceProblem(robot, robot.q);")
    found = script(
        """all.map(([first, second]) => fibre(problem, first)
            .some(({ low, high }) => low.at < second && second < high.at))""",
        all=pairs.tolist(),
    )
    margin = region.margins(pairs).min(axis=-1)
    clear = np.abs(margin) > 1e-9
    assert np.array_equal(np.array(found)[clear], (margin > 0)[clear])
    assert 2 < np.sum(found) < 48


def test_a_free_interval_ends_where_two_bodies_touch():
    robot, _, script = among_obstacles(0)
    script.read("const asked = sliceProblem(robot, robot.q);")
    compiled, count = evaluator(robot), 0
    for first in np.linspace(-3, 3, 9):
        for interval in script("fibre(asked, first)", first=first):
            for end in (interval["low"], interval["high"]):
                if end["by"] >= 0:
                    name = script("asked.names[by]", by=end["by"])
                    margin = compiled.margins([first, end["at"]])[compiled.names.index(name)]
                    assert abs(margin) < 1e-8
                    count += 1
    assert count > 4


def test_arcs_of_bodies_say_which_features_touch():
    _, region, script = among_obstacles(0)
    arcs = [arc for c in script.data["components"] for loop in c["loops"] for arc in loop]
    exact = [arc for c in region.components for loop in c.loops for arc in loop]
    assert [arc["feature"] for arc in arcs] == [arc.feature for arc in exact]
    assert any(" on " in arc["feature"] for arc in arcs)


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_places_of_points_are_the_librarys(name):
    robot, _, _, script = case(name)
    q = poses(script.data)
    found = np.array(script("all.map((q) => pointPlaces(robot, q))", all=q.tolist()))
    for i, point in enumerate(robot.points):
        assert_allclose(found[:, i], position(robot, point.name)(q), atol=1e-11)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_tool_and_its_determinant_are_those_of_the_forms(name):
    robot, _, _, script = case(name)
    q = poses(script.data)
    pairs = q[:, script.data["free"]].tolist()
    tool, axes = position(robot, robot.tool), np.array(script("viewAxes(robot, robot.q)"))
    assert script("map.planar && sweepsAnArea(arm, robot.reach)")
    at = np.array(script("all.map((p) => toolAt(map, p))", all=pairs))
    assert_allclose(at, tool(q) @ axes[:2].T, atol=1e-11)
    jacobian = axes[:2] @ tool.gradient(q)[..., script.data["free"]]
    det = script("all.map((p) => determinant(map, p))", all=pairs)
    assert_allclose(det, np.linalg.det(jacobian), atol=1e-9 * np.abs(det).max())


@pytest.mark.parametrize("name", ROBOTS)
def test_inverse_kinematics_finds_every_posture(name):
    _, _, _, script = case(name)
    data = script.data
    pairs = poses(data)[:, data["free"]]
    places = np.array(script("all.map((p) => toolAt(map, p))", all=pairs.tolist()))
    found = np.array(script("all.map((t) => postures(arm, t))", all=places.tolist()))
    back = np.array(script("all.map((s) => s.map((p) => toolAt(map, p)))", all=found.tolist()))
    assert_allclose(back, np.broadcast_to(places[:, None], back.shape), atol=1e-6)
    circles = np.array([v["wraps"] for v in data["views"]])
    gap = found - pairs[:, None]
    gap = np.where(circles, gap - math.tau * np.round(gap / math.tau), gap)
    assert np.abs(gap).max(axis=2).min(axis=1).max() < 1e-6  # the pose itself is among them
    if found.shape[1] == 2:  # and the other one is the other posture
        det = np.array(
            script("all.map((s) => s.map((p) => determinant(map, p)))", all=found.tolist())
        )
        assert (np.sign(det[:, 0]) == -np.sign(det[:, 1])).all()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_postures_of_a_place_are_the_librarys(name):
    robot, held, _, script = case(name)
    data = script.data
    low, high = (np.array([v[end] for v in data["views"]]) for end in ("low", "high"))
    circles = np.array([v["wraps"] for v in data["views"]])
    ranges = [None if c else (x, y) for c, x, y in zip(circles, low, high, strict=True)]
    pairs = poses(data, 100)[:, data["free"]]
    seen = script("all.map((p) => toolAt(map, p))", all=pairs.tolist())
    mine = script("all.map((t) => possible(robot, arm, t))", all=seen)
    arm = planar_arm(robot, held)
    for place, found in zip(arm.tool(pairs), mine, strict=True):
        theirs = np.array([p.q for p in postures(arm, place, ranges)])
        gap = np.array(found)[:, None] - theirs
        gap -= np.where(circles, math.tau * np.round(gap / math.tau), 0)
        same = np.abs(gap).max(axis=2) < 1e-6
        assert same.any(axis=0).all()
        assert same.any(axis=1).all()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_singular_curve_is_where_the_posture_changes(name):
    _, _, _, script = case(name)
    pairs = poses(script.data)[:, script.data["free"]]
    det = np.array(script("all.map((p) => determinant(map, p))", all=pairs.tolist()))
    lines = np.sort(script("singularValues(arm)"))
    if len(lines) == 0:
        assert len(set(np.sign(det))) == 1
        return
    band = np.searchsorted(lines, pairs[:, 1]) % 2 if len(lines) == 2 else pairs[:, 1] > lines[0]
    assert len(set(np.sign(det[band == 0]))) == 1
    assert (np.sign(det[band == 0])[0] != np.sign(det[band == 1])).all()


def test_a_place_out_of_reach_gives_the_stretched_pose():
    _, _, _, script = case("paper")
    far = script("postures(arm, [300, 22.5])")
    line = min(script("singularValues(arm)"), key=abs)
    assert_allclose([p[1] for p in far], line, atol=1e-7)
    assert_allclose(script("toolAt(map, p)", p=far[0]), [np.hypot(15, 25.98) + 25, 22.5])


def test_the_mirrored_pose_mirrors_joints_and_tool_and_has_the_other_posture():
    robot, _, _, script = case("paper")
    q = poses(script.data)
    other = np.array(script("all.map((p) => mirroredPose(arm, p))", all=q.tolist()))
    tool = position(robot, robot.tool)
    assert_allclose(tool(other), tool(q) * [-1, 1, 1], atol=1e-11)
    elbows = [robot.frames(p).position("0", "2", "0")[..., [0, 2]] for p in (q, other)]
    assert_allclose(elbows[1], elbows[0] * [-1, 1], atol=1e-11)
    det = np.array(
        script("all.map((p) => determinant(map, p))", all=[*q.tolist(), *other.tolist()])
    )
    assert_allclose(det[:POSES], -det[POSES:], atol=1e-9 * np.abs(det).max())


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_fibres_are_the_safe_values_of_the_second_joint(name):
    robot, held, _, script = case(name)
    q = poses(script.data, 400)
    first = script.data["free"][0]
    fibres = script(
        "(() => { const p = sliceProblem(robot, robot.q);"
        " return all.map((t) => fibre(p, t).map((i) => [i.low.at, i.high.at])); })()",
        all=q[:, first].tolist(),
    )
    dense = np.linspace(*(script.data["views"][1][end] for end in ("low", "high")), 400)[1:-1]
    used = [clearance(robot, b).restrict(held) for b in robot.boundaries if b.used]
    for t, intervals in zip(q[:, first], fibres, strict=True):
        pairs = np.stack([np.full(len(dense), t), dense], axis=-1)
        safe = np.all([form(pairs) > 0 for form in used], axis=0)
        edges = np.array(intervals).reshape(-1, 2)
        inside = ((dense[:, None] > edges[:, 0]) & (dense[:, None] < edges[:, 1])).any(axis=1)
        assert np.array_equal(inside, safe)


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_cells_of_a_slice_are_the_regions_components(name):
    _, _, region, script = case(name)
    cells = script("sliceCells(sliceProblem(robot, robot.q), 240)")
    pieces = {cell["piece"] for cell in cells}
    areas = {
        piece: sum(_area(cell["rows"]) for cell in cells if cell["piece"] == piece)
        for piece in pieces
    }
    assert len(pieces) == len(region.components)
    expected = sorted(component.area for component in region.components)
    assert_allclose(sorted(areas.values()), expected, rtol=2e-3)


def _area(rows):
    t, low, high = np.array(rows).T
    return float(np.trapezoid(high - low, t))


@pytest.mark.parametrize("value", [-0.8, 0.1, 1.5])
def test_a_slider_shows_the_slice_that_the_library_finds(value):
    robot, _, _, script = case("3R, second held")
    q = [*script.data["q"]]
    q[1] = value
    cells = script("sliceCells(sliceProblem(robot, q), 240)", q=q)
    expected = [component.area for component in find_region(robot, {1: value}).components]
    areas = [
        sum(_area(cell["rows"]) for cell in cells if cell["piece"] == piece)
        for piece in {cell["piece"] for cell in cells}
    ]
    assert_allclose(sorted(areas), sorted(expected), rtol=2e-3)


@pytest.mark.parametrize("name", ["paper", "RR", "RP", "PR", "PP", "3R, third held"])
def test_images_of_the_postures_have_the_area_that_the_determinant_gives(name):
    robot, _, region, script = case(name)
    images = script(
        "(() => { const p = sliceProblem(robot, robot.q); const cells = sliceCells(p, 240);"
        " const home = pieceAt(cells, robot.free.map((j) => robot.q[j]));"
        " return postureImages(map, arm, cells.filter((c) => c.piece === home), p.ranges[1]); })()"
    )
    q = poses(script.data, 60_000)
    at_home = np.all([clearance(robot, b)(q) > 0 for b in robot.boundaries if b.used], axis=0)
    q = q[:, script.data["free"]]
    if len(region.components) > 1:
        outline = np.concatenate([arc.points for arc in region.home.loops[0]])
        at_home &= shapely.contains_xy(shapely.Polygon(outline), *q.T)
    det = np.array(script("all.map((p) => determinant(map, p))", all=q.tolist()))
    size = np.prod([view["high"] - view["low"] for view in script.data["views"]])
    for sign, side in ((1, "positive"), (-1, "negative")):
        union = shapely.union_all([shapely.make_valid(shapely.Polygon(p)) for p in images[side]])
        expected = size * (np.maximum(sign * det, 0) * at_home).mean()
        assert union.area == pytest.approx(expected, rel=0.02, abs=1e-9)


def test_a_path_is_the_librarys_traversal():
    robot, _, _, script = case("paper")
    corners = np.array(script.data["polygon"]["vertices"])
    walk = traverse(robot, corners, closed=True)
    steps = np.abs(np.diff(walk.q, axis=0)).max(axis=1)
    fractions = np.concatenate([[0], np.cumsum(steps)]) / steps.sum()
    found = script(
        "all.map((f) => alongPath(robot, stops, f))",
        all=fractions.tolist(),
        stops=[*corners.tolist(), corners[0].tolist()],
    )
    assert_allclose(found, walk.q, atol=1e-9)


@pytest.mark.parametrize("factor", [0.5, 0.9, 0.9650494, 1.0])
def test_the_smallest_clearance_of_a_scaled_polygon_is_that_of_its_edges(factor):
    robot, _, _, script = case("paper")
    hexagon = script.data["polygon"]
    found = script(
        "smallestClearance(robot, robot.q, p.vertices, f, p.centroid)", p=hexagon, f=factor
    )
    g = np.array(hexagon["centroid"])
    edges = g + factor * (np.array(hexagon["vertices"]) - g)
    values = {}
    for b in robot.boundaries:
        if b.used:
            least, _ = least_along_edges(clearance(robot, b), edges)
            required = getattr(b, "clearance", None)
            values[b.name] = (
                least if required is None else math.sqrt(max(0, least + required**2)) - required
            )
    name = min(values, key=lambda n: values[n])
    assert found["name"] == name
    assert_allclose(found["value"], values[name], atol=0.02)
    assert (found["value"] >= 0) == (factor <= hexagon["largest"])


def test_other_orders_of_the_vertices_are_told_where_there_are_such_vertices():
    region = find_region(load_robot("minervabot-v2"))
    assert explorer_data(region)["polygon"]["walks"] == [[0, 1, 2, 3, 4, 5, 0]]
    told = explorer_data(region, [(5, 0, 1), (6, 0)])
    assert told["polygon"]["walks"] == [[0, 1, 2, 3, 4, 5, 0], [5, 0, 1]]


def test_the_papers_rule_gives_the_papers_polygon_and_scale():
    robot = load_robot("minervabot-v2")
    data = explorer_data(find_region(robot, rule="paper"))
    corners = [vertex.q for vertex in closed_form.vertices(robot)]
    assert_allclose(data["polygon"]["vertices"], corners, atol=1e-12)
    assert_allclose(data["polygon"]["largest"], 0.9640384935, atol=1e-9)
    script = Arithmetic(data)
    q = poses(data)
    safe = script("all.map((q) => isSafe(margins(robot, q)))", all=q.tolist())
    assert np.array_equal(safe, paper_rule.feasible(robot, q))
    turned = q + math.tau * np.array([1, -2])  # a window is one turn of a joint, whichever
    assert script("all.map((q) => isSafe(margins(robot, q)))", all=turned.tolist()) == safe


def test_the_arcs_that_are_drawn_lie_on_their_boundaries():
    robot, _, region, script = case("paper")
    arcs = [arc for c in script.data["components"] for loop in c["loops"] for arc in loop]
    assert len(arcs) == sum(len(loop) for c in region.components for loop in c.loops)
    for arc in arcs:
        b = robot.boundary(arc["boundary"])
        form = clearance(robot, b)
        size = np.abs(form.coefficients).max()
        assert_allclose(form(np.array(arc["points"])), 0, atol=2e-6 * size)


def test_a_tool_that_leaves_the_plane_is_told_apart():
    assert not case("out of the plane")[3]("map.planar")
    assert case("RR")[3]("map.planar")


# --- the page ------------------------------------------------------------------------------------


class Parts(HTMLParser):
    """The scripts, styles and addresses of a page, as a browser's parser finds them."""

    def __init__(self):
        super().__init__()
        self.open, self.scripts, self.addresses, self.handlers = "", {}, [], []

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.open = found.get("id", "code") if tag == "script" else ""
        self.addresses += [v for k, v in attributes if k in ("src", "href", "action", "data")]
        self.handlers += [k for k, _ in attributes if k.startswith("on") or k == "style"]

    def handle_endtag(self, tag):
        self.open = ""

    def handle_data(self, data):
        if self.open:
            self.scripts[self.open] = self.scripts.get(self.open, "") + data


def parts(page):
    parser = Parts()
    parser.feed(page)
    return parser


@pytest.mark.parametrize("name", packaged_robots())
def test_every_packaged_robot_has_a_page(name, capsys, tmp_path):
    file = tmp_path / "arm.html"
    assert main(["explore", name, "-o", str(file)]) in (0, 1)
    assert 10_000 < file.stat().st_size < 300_000


@pytest.mark.parametrize("name", ROBOTS)
def test_a_page_is_one_small_file_that_loads_nothing(name):
    _, _, region, _ = case(name)
    page = explorer_page(region)
    found = parts(page)
    assert len(page.encode()) < 300_000
    assert [a for a in found.addresses if not a.startswith(("#", "data:"))] == []
    assert found.handlers == []
    assert set(found.scripts) == {"robot-data", "code"}
    assert "default-src 'none'" in page


def test_a_robots_names_cannot_become_markup():
    nasty = "</script><script>alert(1)</script><!--<img src=x onerror=alert(1)> & \u2028 $name ${x}"
    rows = [joint("revolute", str(i), str(i + 1), ORIGINS[i], SIDE) for i in (0, 1)]
    table = robot_table(rows, {"q1": 0.3, "q2": 0.4}, "2", name=nasty)
    table["boundary"][0]["name"] = nasty
    robot = parse_robot(table)
    found = parts(explorer_page(find_region(robot)))
    assert set(found.scripts) == {"robot-data", "code"}
    assert json.loads(found.scripts["robot-data"])["name"] == nasty.replace("\u2028", r"\u2028")
    assert "alert(1)" not in found.scripts["code"]
    assert found.handlers == []


def test_the_script_writes_names_as_text_only():
    code = "".join((TEMPLATES / name).read_text("utf-8") for name in SCRIPTS)
    assert re.findall(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\(", code) == []
    assert re.findall(r"new Function|fetch\(|XMLHttpRequest|import\(", code) == []


def code_of(name):
    text = (TEMPLATES / name).read_text(encoding="utf-8")
    return re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)


def test_every_name_of_a_script_is_used():
    code = "".join(map(code_of, SCRIPTS))
    names = re.findall(r"^(?:function|const|let) (\w+)", code, re.MULTILINE)
    assert len(names) > 100
    assert [name for name in names if len(re.findall(rf"\b{name}\b", code)) < 2] == []


def test_every_script_stands_in_the_page():
    assert {p.name for p in TEMPLATES.iterdir() if p.name.endswith(".js")} == {
        *SCRIPTS,
        *surface_page.SCRIPTS,
    }


@pytest.mark.parametrize(
    ("interface", "pick"),
    [
        ("Robot", lambda data: data),
        ("Joint", lambda data: data["joints"][0]),
        ("Step", lambda data: data["steps"][0]),
        ("RobotPoint", lambda data: data["points"][0]),
        ("View", lambda data: data["views"][0]),
        ("Limit", lambda data: data["limits"][0]),
        ("Component", lambda data: data["components"][0]),
        ("VertexPolygon", lambda data: data["polygon"]),
    ],
)
def test_what_the_scripts_are_told_has_the_declared_fields(interface, pick):
    robot = load_robot("minervabot-v2")
    data = explorer_data(find_region(robot, rule="paper"))
    declared = (TEMPLATES / "explorer.d.ts").read_text(encoding="utf-8")
    [fields] = re.findall(rf"interface {interface} {{\n(.*?)\n}}", declared, re.DOTALL)
    assert re.findall(r"^  (\w+):", fields, re.MULTILINE) == list(pick(data))


# --- in a notebook -------------------------------------------------------------------------------


class Frame(HTMLParser):
    """The one frame of a notebook's output, with its attributes."""

    def __init__(self):
        super().__init__()
        self.tags, self.attributes = [], {}

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes |= dict(attributes)


def test_a_notebook_shows_the_picture_and_the_page_in_a_frame_of_its_own():
    _, _, region, _ = case("RR")
    shown = explore(region)
    frame = Frame()
    frame.feed(shown._repr_html_())
    assert frame.tags == ["div", "img", "iframe"]
    assert frame.attributes["srcdoc"] == shown.html == explorer_page(region)
    assert frame.attributes["sandbox"] == "allow-scripts"
    picture = b64decode(frame.attributes["src"].removeprefix("data:image/svg+xml;base64,"))
    assert b"<svg" in picture
    assert "joints" in frame.attributes["alt"]


def test_without_a_picture_the_frame_stands_alone(monkeypatch):
    _, _, region, _ = case("RR")
    monkeypatch.setattr(type(region), "_repr_svg_", lambda region: None)  # matplotlib is not here
    frame = Frame()
    frame.feed(explore(region)._repr_html_())
    assert frame.tags == ["div", "iframe"]


def test_an_explorer_is_named_in_one_short_line():
    _, _, region, _ = case("RR")
    assert re.fullmatch(r"Explorer\('arm', \d+ kB of HTML\)", repr(explore(region)))


def test_an_explorer_is_saved_as_the_page(tmp_path):
    _, _, region, _ = case("RR")
    shown = explore(region)
    shown.save(tmp_path / "arm.html")
    assert (tmp_path / "arm.html").read_bytes() == shown.html.encode()


# --- the command ---------------------------------------------------------------------------------


def test_explore_writes_the_page(capsys, tmp_path):
    file = tmp_path / "arm.html"
    assert main(["explore", "minervabot-v2", "-o", str(file)]) == 0
    assert capsys.readouterr().err == ""
    assert list(tmp_path.iterdir()) == [file]
    assert json.loads(parts(file.read_text(encoding="utf-8")).scripts["robot-data"])["rule"] == (
        "clearance"
    )


def test_explore_says_what_is_wrong_and_writes_nothing(capsys, tmp_path):
    file = tmp_path / "arm.html"
    assert main(["explore", "minervabot-v2", "-o", str(file), "--slice", "q1=1deg"]) == 2
    assert "two joints" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
