"""The figures that a reader moves in the chapters, in a browser: what hands, keys and words do."""

from __future__ import annotations

import re

import numpy as np
import pytest

from cspace import clearance, find_region, load_robot
from cspace.geometry import polygon
from cspace.measures import bodies, scaling
from cspace.sampling import keeps_clear
from engine_support.browser import drag, in_every_family, settle
from qbound import window_region
from qbound.circle import circle_roots
from support.play import LOST, WIDTHS, assert_fits_and_is_accessible, open_play

__all__ = ["open_play"]

RULES = {"circle": "clearance", "switches": "paper", "scale": "paper"}
RULES |= {"bodies": "clearance", "contact": "clearance"}
ROBOT = load_robot("minervabot-v2")


@pytest.fixture
def open_figure(open_play):
    """Open figures by their kind."""
    return lambda kind, *where, **options: open_play(kind, RULES[kind], "", *where, **options)


def words(page, selector=".status"):
    return page.locator(selector).inner_text()


def numbers(text):
    return [float(n.replace("−", "-")) for n in re.findall(r"−?\d+(?:\.\d+)?", text)]


def middle(page, selector, n=0):
    box = page.locator(selector).nth(n).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def fill(page, label, value):
    page.get_by_label(label, exact=True).fill(str(value))
    settle(page)


# --- every figure ---------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", RULES)
@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
def test_a_figure_is_accessible_and_fits(open_figure, kind, width):
    page = open_figure(kind, width=width)
    assert page.locator(".play svg[role=img]").count() >= 1
    assert page.locator("[role=status]").count() == 1
    for family in in_every_family(page):
        assert page.evaluate(LOST) == [], family
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), family
    assert_fits_and_is_accessible(page)


@pytest.mark.parametrize("kind", ["circle", "scale", "bodies", "contact"])
def test_a_step_of_a_drag_takes_less_than_a_frame(open_figure, kind):
    page = open_figure(kind)
    times = page.evaluate("""() => {
      const range = document.querySelector(".play input[type=range]");
      const [low, high] = [Number(range.min), Number(range.max)];
      const step = (i) => {
        const begun = performance.now();
        range.value = String(low + ((high - low) * (i % 50)) / 50);
        range.dispatchEvent(new Event("input"));
        document.body.getBoundingClientRect(); // the layout, too
        return performance.now() - begun;
      };
      return Array.from({ length: 150 }, (_, i) => step(i)).sort((a, b) => a - b);
    }""")
    assert times[75] < 1000 / 60


@pytest.mark.parametrize("kind", ["circle", "scale", "bodies", "contact"])
@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
def test_nothing_moves_under_a_hand_that_drags(open_figure, kind, width):
    page = open_figure(kind, width=width)
    moved = page.evaluate("""() => {
      const top = () => document.querySelector(".play svg").getBoundingClientRect().top;
      const found = new Set();
      for (const range of document.querySelectorAll(".play input[type=range]"))
        for (let i = 0; i <= 20; i += 1) {
          range.value = String(Number(range.min) + ((range.max - range.min) * i) / 20);
          range.dispatchEvent(new Event("input"));
          found.add(top());
        }
      return found.size;
    }""")
    assert moved == 1


# --- Theorem 2 ------------------------------------------------------------------------------------


def rows_of(page):
    return [numbers(text) for text in page.locator("tbody tr").all_inner_texts()]


def test_the_circle_opens_with_a_component_and_shows_that_the_theorem_bounds_nothing(open_figure):
    page = open_figure("circle")
    roots = np.degrees(circle_roots(-1.5, 12.41, -7.5).q)
    assert numbers(words(page))[:2] == pytest.approx(roots, abs=0.006)
    length = roots[1] - roots[0]
    own, _, printed = (row[-3:] for row in rows_of(page))
    assert own == pytest.approx([*roots, length], abs=0.006)
    assert printed[2] == pytest.approx(length + 360, abs=0.006)
    assert "excludes no angle" in words(page)
    assert "not even roots" in words(page)


def test_read_as_atan2_and_shortened_the_theorem_is_the_arc(open_figure):
    page = open_figure("circle")
    page.get_by_label("Leave out −2π in the second line").check()
    assert "wrong side" in words(page)
    page.get_by_label("Read the arctangent of b/a as atan2(b, a)").check()
    assert "the arc itself" in words(page)
    own, _, printed = (row[-3:] for row in rows_of(page))
    assert own == printed


def test_the_cases_of_the_theorem_are_named(open_figure):
    page = open_figure("circle")
    fill(page, "a in cm, as a number", 3)
    fill(page, "b in cm, as a number", 4)
    for c, text in ((6, "at no angle"), (-6, "at every angle"), (2, "Two roots")):
        fill(page, "c in cm, as a number", c)
        assert text in words(page)
    for button, angle in (("c = d", 53.13), ("c = −d", 233.13)):
        page.get_by_role("button", name=button, exact=True).click()
        assert "double root" in words(page)
        assert numbers(words(page))[0] == pytest.approx(angle, abs=0.006)
    fill(page, "a in cm, as a number", 0)
    fill(page, "c in cm, as a number", 1)
    assert "does not exist" in words(page)
    fill(page, "b in cm, as a number", 0)
    fill(page, "c in cm, as a number", 0)
    assert "every angle is a root" in words(page)


def test_arrow_line_and_point_can_be_dragged(open_figure):
    page = open_figure("circle")
    x, y = middle(page, ".picture svg")
    size = page.locator(".picture svg").bounding_box()["width"]
    unit = (size - 8) / 3.6
    drag(page, middle(page, ".reach-me", 0), (x + 0.5 * unit, y))  # the arrow to (8, 0)
    values = [float(page.get_by_label(f"{n} in cm, as a number").input_value()) for n in "abc"]
    assert values[:2] == pytest.approx([8, 0], abs=0.4)
    drag(page, middle(page, ".reach-me", 1), (x + 0.5 * unit, y + 3))
    assert float(page.get_by_label("c in cm, as a number").input_value()) == pytest.approx(
        4, abs=0.3
    )
    drag(page, middle(page, ".reach-me", 1), (x + 1.01 * unit, y))  # as good as tangent: it snaps
    assert "double root" in words(page)
    drag(page, middle(page, ".reach-me", 2), (x, y - unit))
    q = float(page.get_by_label("q in degrees, as a number").input_value())
    assert q == pytest.approx(90, abs=1)


# --- Figure 4 -------------------------------------------------------------------------------------


def colours_inside(page):
    """Ask on a grid which places of the square lie in the fill that is left."""
    return page.evaluate("""() => {
      const svg = document.querySelector(".picture svg");
      const fill = svg.querySelector(".region .home");
      const matrix = svg.getScreenCTM();
      const [left, top, right, bottom] = [62, 12, 18, 38];
      const size = svg.viewBox.baseVal.width;
      const [w, h] = [size - left - right, svg.viewBox.baseVal.height - top - bottom];
      const side = Math.min(w, h);
      const found = [];
      for (let i = 0; i < 24; i += 1)
        for (let k = 0; k < 24; k += 1) {
          const [s, t] = [(i + 0.41) / 24, (k + 0.37) / 24];
          const x = left + (w - side) / 2 + s * side;
          const y = top + (h - side) / 2 + (1 - t) * side;
          const at = new DOMPoint(x, y).matrixTransform(matrix);
          found.push([(2 * s - 1) * Math.PI, (2 * t - 1) * Math.PI,
            document.elementsFromPoint(at.x, at.y).includes(fill)]);
        }
      return found;
    }""")


def test_the_fill_is_the_region_of_the_papers_rule(open_figure):
    page = open_figure("switches")
    assert "Home is inside" in words(page)
    found = np.array(colours_inside(page))
    feasible = window_region(ROBOT).contains(found[:, :2])
    assert np.array_equal(found[:, 2].astype(bool), feasible)
    page.get_by_label(re.compile("β₅,₁,₁")).check()
    page.get_by_label(re.compile("β₅,₁,₂")).check()
    found = np.array(colours_inside(page))
    wall = clearance(ROBOT, ROBOT.boundary("B5"))(found[:, :2]) >= 0
    assert np.array_equal(found[:, 2].astype(bool), feasible & wall)


def test_switching_a_side_off_moves_it_to_the_next_bound(open_figure):
    page = open_figure("switches")
    assert numbers(words(page))[-2:] == pytest.approx([-162.30, 44.38], abs=0.006)
    page.get_by_label(re.compile("β₃,₃,₁")).uncheck()
    assert numbers(words(page))[-1] == pytest.approx(44.41, abs=0.006)
    page.get_by_role("button", name="None").click()
    assert words(page).count("edge of the square") == 4
    page.get_by_role("button", name="Only the six of the region").click()
    assert numbers(words(page))[-2:] == pytest.approx([-162.30, 44.38], abs=0.006)


def test_readings_of_the_arctangent_move_the_box(open_figure):
    page = open_figure("switches")
    page.get_by_label("arctan(b/a)", exact=True).check()
    assert "−135.62°" in words(page)
    assert "Home is inside" in words(page)
    page.get_by_label("arctan(b/a) + π where a < 0").check()
    assert "Home is cut off by β₃,₃,₂" in words(page)
    page.get_by_role("button", name="As it opens").click()
    assert "Home is inside" in words(page)
    assert page.get_by_label("atan2(b, a)").is_checked()


# --- Figure 6 -------------------------------------------------------------------------------------


def test_depth_and_edges_at_a_scale_are_the_librarys(open_figure):
    page = open_figure("scale")
    corners = window_region(ROBOT).polygon
    centre = polygon.centroid(corners)
    floor = clearance(ROBOT, ROBOT.boundary("B7"))
    for scale in (0.95, 1, 0.97, 0.8):
        fill(page, "Scale of the polygon, as a number", scale)
        scaled = polygon.scaled(corners, scale, centre)
        edges = np.stack([scaled, np.roll(scaled, -1, axis=0)], axis=1)
        values = np.array([scaling.least_along_edges(floor, edge)[0] for edge in edges])
        assert numbers(words(page))[1] == pytest.approx(abs(values.min()), abs=6e-4)
        assert ("below its limit" in words(page)) == (values.min() < 0)
        lit = page.evaluate("""() => [...document.querySelectorAll(".polygons .arc")].map((edge) =>
          edge.classList.contains("lit"))""")
        assert lit == (values < -1e-9).tolist()  # two corners lie on the limit
    page.get_by_role("button", name=re.compile("largest allowed")).click()
    assert numbers(words(page))[1] == pytest.approx(0, abs=6e-4)
    assert "0.964038" in page.get_by_role("button", name=re.compile("largest allowed")).inner_text()


def test_the_scale_has_keys(open_figure):
    page = open_figure("scale")
    page.get_by_label("Scale of the polygon", exact=True).focus()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    assert "Scale 0.955" in words(page)


# --- bodies ---------------------------------------------------------------------------------------


def test_each_region_but_home_says_allowed_by_points_and_overlap_by_bodies(open_figure):
    page = open_figure("bodies")
    for i, component in enumerate(find_region(ROBOT).components, start=1):
        page.get_by_role("button", name=f"Region {i}").click()
        gaps = bodies.gaps(ROBOT, component.centroid)
        worst = min(map(float, gaps.values()))
        points, whole = page.locator(".verdicts tr").all_inner_texts()
        assert keeps_clear(ROBOT, np.array([component.centroid]))[0]
        assert "allowed" in points
        assert ("overlap" in whole) == (worst < 0) == (i > 1)
        if worst < 0:
            assert numbers(whole)[-1] == pytest.approx(-worst, abs=0.006)
        red = page.locator("polygon.overlap:not([hidden])")
        assert red.count() == sum(float(gap) < 0 for gap in gaps.values())


def test_dragging_the_dot_the_tool_and_the_elbow_moves_the_arm(open_figure):
    page = open_figure("bodies")
    fill(page, "q1 in degrees, as a number", 0)
    fill(page, "q2 in degrees, as a number", 0)

    def pose():
        return [
            float(page.get_by_label(f"q{k} in degrees, as a number").input_value()) for k in (1, 2)
        ]

    tool, elbow = middle(page, ".reach-me", 2), middle(page, ".reach-me", 1)
    drag(page, tool, (elbow[0], elbow[1] + tool[0] - elbow[0]))  # from ahead to straight down
    assert pose() == pytest.approx([0, 90], abs=1.5)
    x, y = middle(page, ".axle")
    drag(page, middle(page, ".reach-me", 1), (x + 60, y))
    assert pose()[0] == pytest.approx(60, abs=1.5)  # link 1 lay 30 degrees off the vertical
    x, y = middle(page, ".reach-me", 0)
    drag(page, (x, y), (x - 40, y))
    assert pose()[0] < 40
    assert pose()[1] == pytest.approx(90, abs=2)


# --- contact --------------------------------------------------------------------------------------


def test_the_arm_stops_where_a_boundary_function_vanishes(open_figure):
    page = open_figure("contact")
    assert "No function vanishes" in words(page)
    fill(page, "q2 in degrees, as a number", 60)
    assert words(page).startswith("B3 vanishes: points 10 and 11")
    stopped = float(page.get_by_label("q2 in degrees", exact=True).input_value())
    q = np.radians([0, stopped])
    # |B|^2 - d_min^2, cm^2; the slider has tenths of a degree
    assert abs(clearance(ROBOT, ROBOT.boundary("B3"))(q)) < 0.2
    assert find_region(ROBOT).contains(np.radians([0, stopped - 0.1]))
    assert page.locator("tr.lit[data-boundary=B3], .arc.lit[data-boundary=B3]").count() == 2
    page.get_by_role("button", name="Home").click()
    assert "No function vanishes" in words(page)


def test_the_arm_of_chapter_1_passes_its_limit_and_the_value_changes_its_sign(open_play):
    page = open_play("contact", "clearance", 'data-only="B7" data-passes')
    height = clearance(ROBOT, ROBOT.boundary("B7"))
    for q1, q2, sign in ((0, 0, "positive"), (60, -90, "positive"), (60, 0, "negative")):
        fill(page, "q1 in degrees, as a number", q1)
        fill(page, "q2 in degrees, as a number", q2)
        assert f"B7 is {sign}" in words(page)
        assert numbers(words(page))[1] == pytest.approx(height(np.radians([q1, q2])), abs=0.006)
    assert page.locator(".status.violated").count() == 1
    page.get_by_role("button", name="Home").click()
    x, y = middle(page, ".reach-me", 1)
    drag(page, (x, y), (x, y + 150), steps=20)
    assert "B7 is negative" in words(page)


def test_a_pose_whose_links_overlap_is_not_shown_as_good(open_play):
    page = open_play("contact", "clearance", 'data-only="B7" data-passes')
    fill(page, "q2 in degrees, as a number", 160)
    assert "B7 is positive" in words(page)
    assert "Overlap: link 1 and link 2" in words(page)
    assert page.locator(".status.violated").count() == 1


def test_a_number_that_the_arm_cannot_follow_gives_way_to_where_the_arm_stands(open_figure):
    page = open_figure("contact")
    box = page.get_by_label("q2 in degrees, as a number")
    box.fill("120")
    box.press("Enter")
    slider = page.get_by_label("q2 in degrees", exact=True)
    stands = float(slider.input_value())
    assert float(box.input_value()) == pytest.approx(stands, abs=0.06)
    assert stands < 50


@pytest.mark.parametrize(("q1", "q2", "names"), [(0, 60, "10 11"), (0, -170, "12 13")])
def test_the_names_of_two_points_in_contact_stand_on_their_own_links(open_figure, q1, q2, names):
    page = open_figure("contact")
    fill(page, "q1 in degrees, as a number", q1)
    fill(page, "q2 in degrees, as a number", q2)
    shown = page.locator(".point-name:not([hidden])")
    assert shown.all_text_contents() == names.split()
    links = page.evaluate("""() => [...document.querySelectorAll(".point-name:not([hidden])")]
      .map((name) => {
        const { x, y, width, height } = name.getBoundingClientRect();
        const from = ([u, v]) => Math.hypot(x + width / 2 - u, y + height / 2 - v);
        return [...document.querySelectorAll("polygon.body:not(.fixed)")].map((body) => {
          const box = body.getBoundingClientRect();
          return from([box.x + box.width / 2, box.y + box.height / 2]);
        });
      })""")
    first, second = links  # distances of each name from the middles of link 1 and link 2
    assert first[0] < second[0]
    assert second[1] < first[1]


def test_dragging_the_elbow_brings_the_arm_to_contact(open_figure):
    page = open_figure("contact")
    x, y = middle(page, ".axle")
    drag(page, middle(page, ".reach-me", 0), (x + 40, y + 60), steps=40)
    assert words(page).startswith("B7 vanishes: point 3 (the tool)")
    values = [numbers(text)[-1] for text in page.locator(".functions tr").all_inner_texts()]
    assert min(values) == pytest.approx(0, abs=0.06)
    assert values[-1] == min(values)


@pytest.mark.parametrize("kind", ["contact", "explorer", "switches"])
def test_a_word_that_names_a_boundary_lights_its_curve(open_play, kind):
    page = open_play(kind, "paper" if kind == "switches" else "clearance")
    lit = page.locator(":is(.arc, .bound).lit")
    assert lit.count() == 0
    page.locator(".lights").hover()
    assert set(lit.evaluate_all("all => all.map((arc) => arc.dataset.boundary)")) == {"B3"}
    assert page.locator(".arc.violated").count() == 0
    page.mouse.move(1, 1)
    assert lit.count() == 0


def test_under_a_finger_the_light_stays_until_it_touches_something_else(open_figure):
    page = open_figure("contact", has_touch=True)
    page.locator(".lights").tap()
    assert page.locator(".arc.lit[data-boundary=B3]").count() == 1
    page.locator(".status").tap()
    assert page.locator(".arc.lit").count() == 0
