"""Figures 7 to 11, the regions and the front page's arm, in a browser: hands, keys, words."""

from __future__ import annotations

import numpy as np
import pytest

from cspace import check
from engine_support.browser import drag, eventually, settle
from support.play import WIDTHS, assert_fits_and_is_accessible, open_play, region, told

__all__ = ["open_play"]

HOOKS = {
    "front": ("traversals", "paper", "data-small"),
    "traversals": ("traversals", "paper", 'data-start="right"'),
    "mirror": ("traversals", "paper", 'data-start="mirror"'),
    "postures": ("postures", "clearance", ""),
    "regions": ("regions", "clearance", ""),
    "goals": ("goals", "clearance", ""),
}


@pytest.fixture
def open_figure(open_play):
    """Open figures by the name of their hook."""

    def open_one(name, *where, **options):
        kind, rule, hook = HOOKS[name]
        return open_play(kind, rule, hook, *where, **{"reduced_motion": "reduce"} | options)

    return open_one


def words(page):
    return page.locator(".status").inner_text()


def frames(page, count):
    """Let the page draw so many frames: time enough for what moves to have moved."""
    page.evaluate(
        "async (n) => { while (n--) await new Promise((next) => requestAnimationFrame(next)); }",
        count,
    )


def pair(page):
    return page.evaluate("arm.pair()")


def region_of(page, rule="clearance"):
    found = region(rule).component_of(pair(page))
    return None if found is None else found + 1


def place(page, values, picture="joints"):
    """Where joint values, or a place of the plane, stand on the page."""
    return page.evaluate(
        """([name, values]) => {
          const { svg, at } = arm[name];
          const box = svg.getBoundingClientRect();
          const [x, y] = at(values);
          const scale = box.width / svg.viewBox.baseVal.width;
          return [box.left + x * scale, box.top + y * scale];
        }""",
        [picture, list(values)],
    )


# --- every figure ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", HOOKS)
@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
def test_a_figure_is_accessible_and_fits(open_figure, name, width):
    assert_fits_and_is_accessible(open_figure(name, width=width))


@pytest.mark.parametrize("name", HOOKS)
def test_a_step_of_a_drag_takes_less_than_a_frame(open_figure, name):
    page = open_figure(name)
    times = page.evaluate("""() => {
      const [a, b] = arm.pair();
      const step = (i) => {
        const begun = performance.now();
        arm.move([a + 0.3 * Math.sin(i / 5), b - 0.3 * Math.cos(i / 7)]);
        document.body.getBoundingClientRect(); // the layout, too
        return performance.now() - begun;
      };
      return Array.from({ length: 150 }, (_, i) => step(i)).sort((a, b) => a - b);
    }""")
    assert times[75] < 1000 / 60


@pytest.mark.parametrize("name", HOOKS)
def test_a_figure_drawn_anew_keeps_its_pose_and_its_words(open_figure, name):
    page = open_figure(name)
    before = pair(page), words(page)
    page.set_viewport_size({"width": 620, "height": 900})
    settle(page)
    settle(page)
    assert (pair(page), words(page)) == before


# --- the front page -------------------------------------------------------------------------------


def test_the_front_pages_arm_moves_by_itself_until_a_reader_presses_pause(open_figure):
    page = open_figure("front", reduced_motion="no-preference")
    start = pair(page)
    eventually(page, lambda: pair(page) != start)
    page.get_by_role("button", name="Pause").click()
    rest = pair(page)
    frames(page, 30)
    assert pair(page) == rest
    page.get_by_role("button", name="Play").click()
    eventually(page, lambda: pair(page) != rest)


def test_the_front_pages_arm_gives_way_to_a_hand(open_figure):
    page = open_figure("front", reduced_motion="no-preference")
    eventually(page, lambda: page.get_by_role("button", name="Pause").count() == 1)
    drag(page, place(page, pair(page)), place(page, [0, -0.5]))
    rest = pair(page)
    frames(page, 30)
    assert pair(page) == rest == pytest.approx([0, -0.5], abs=0.05)
    assert page.get_by_role("button", name="Play").count() == 1


def test_where_no_motion_is_wanted_the_front_pages_arm_rests(open_figure):
    page = open_figure("front")
    rest = pair(page)
    frames(page, 30)
    assert pair(page) == rest
    assert page.get_by_role("button", name="Play").count() == 1


# --- traversals -----------------------------------------------------------------------------------


def move_along(page, value):
    page.get_by_label("Along the path").fill(str(value))
    settle(page)


def test_a_traversal_is_gone_along_by_its_slider(open_figure):
    page = open_figure("traversals")
    assert words(page).startswith("From point 6 to point 1.")
    move_along(page, 1)
    assert words(page).startswith("At point 4, the end.")
    move_along(page, 0.5)
    done = page.evaluate("""() => [...document.querySelectorAll(".way.done.right")]
      .map((path) => path.getTotalLength())""")
    whole = page.evaluate("""() => [...document.querySelectorAll(".way.right:not(.done)")]
      .map((path) => path.getTotalLength())""")
    assert all(0.2 < a / b < 0.8 for a, b in zip(done, whole, strict=True))
    assert len(done) == 2


def test_both_traversals_stand_beside_each_other_and_the_mirrored_one_on_request(open_figure):
    page = open_figure("traversals")
    assert page.locator(".way.left").count() >= 2
    assert page.locator(".way.mirrored").count() == 0
    page.get_by_label("The right-hand path, mirrored").check()
    assert page.locator(".way.mirrored").count() == 1
    page.get_by_role("button", name="On the left").click()
    assert words(page).startswith("From point 3 to point 4.")
    page.get_by_role("button", name="All six points").click()
    assert page.locator(".way.left").count() == 0
    assert not page.get_by_label("The right-hand path, mirrored").is_visible()


def test_the_way_to_the_mirror_image_leads_through_the_stretched_pose(open_figure):
    page = open_figure("mirror")
    seen = []
    for value in np.linspace(0, 1, 41):
        move_along(page, round(float(value), 3))
        seen.append("det J = 0" in words(page))
    assert not seen[0]
    assert any(seen)
    assert not seen[-1]
    assert words(page).startswith("At its mirror image, the end.")


def test_where_no_motion_is_wanted_a_path_leaps_from_stop_to_stop(open_figure):
    page = open_figure("traversals")
    page.evaluate("""() => { window.seen = new Set([arm.pair().join()]);
      arm.root.addEventListener("qbound-pose", () => window.seen.add(arm.pair().join())); }""")
    page.get_by_role("button", name="Play").click()
    eventually(page, lambda: words(page).startswith("At point 4, the end."))
    assert page.evaluate("window.seen.size") == 5  # the start, and four stops after it


def test_a_hand_stops_the_path(open_figure):
    page = open_figure("traversals", reduced_motion="no-preference")
    page.get_by_role("button", name="Play").click()
    page.locator("svg[role=application]").first.focus()
    page.keyboard.press("ArrowUp")
    assert words(page).startswith("You moved the arm.")
    rest = pair(page)
    frames(page, 30)
    assert pair(page) == rest


# --- regions --------------------------------------------------------------------------------------


def test_the_arm_stops_at_the_wall_which_lights_up_and_is_named(open_figure):
    page = open_figure("regions")
    drag(page, place(page, pair(page)), place(page, [-0.5, 2.0]), steps=25)
    assert region_of(page) == 1
    assert words(page).startswith("B3 stops the arm: points")
    assert "lies region 2" in words(page)
    assert page.locator(".arc.lit[data-boundary=B3]").count() >= 1
    assert page.locator(".barred").get_attribute("d")
    drag(page, place(page, pair(page)), place(page, [-0.5, -1.0]))
    assert words(page).startswith("Region 1, that of the home pose.")
    assert page.locator(".arc.lit").count() == 0


def test_the_keyboard_meets_the_same_wall(open_figure):
    page = open_figure("regions")
    page.locator("svg[role=application]").first.focus()
    for _ in range(8):
        page.keyboard.press("Shift+ArrowUp")
    assert region_of(page) == 1
    assert words(page).startswith("B3 stops the arm")


@pytest.mark.parametrize("region", [1, 2, 3, 4, 5])
def test_the_arm_can_be_lifted_into_every_region(open_figure, region):
    page = open_figure("regions")
    page.get_by_role("button", name=str(region), exact=True).click()
    assert region_of(page) == region
    assert f"region {region}" in words(page)
    assert page.locator(".region.here").count() == 1


# --- postures -------------------------------------------------------------------------------------


def test_a_pressed_dot_shows_both_its_postures(open_figure):
    page = open_figure("postures")
    dots = page.evaluate("arm.state.sample.slice(0, 300).map(({ pair, tool }) => [pair, tool])")
    robot = region()
    inner = [(q, at) for q, at in dots if robot.component_of(q) == 0]
    wanted, at = inner[0]
    page.mouse.click(*place(page, at, "plane"))
    settle(page)
    assert pair(page) == pytest.approx(wanted, abs=1e-9)
    assert "allowed by the points, in region 1 with home" in words(page)
    assert "The pale one is" in words(page)
    assert (
        page.locator(".arm.second .body").count() == page.locator(".arm:not(.second) .body").count()
    )


@pytest.mark.parametrize(
    ("button", "allowed"),
    [("A dot with one allowed posture", 1), ("with two", 2), ("with none", 0)],
)
def test_a_dot_of_each_sort_can_be_asked_for(open_figure, button, allowed):
    page = open_figure("postures")
    page.get_by_role("button", name=button, exact=True).click()
    settle(page)
    assert words(page).count("allowed") - words(page).count("not allowed") == allowed


# --- the front page's rings -----------------------------------------------------------------------


def test_the_front_page_lets_one_fail_and_shows_why(open_figure):
    page = open_figure("goals")
    box = page.locator(".arm").locator("xpath=..").locator("[data-ring=B]").bounding_box()
    tool = page.evaluate("qboundEngine.toolAt(arm.slice.map, arm.pair())")
    wanted = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    drag(page, place(page, tool, "plane"), wanted, steps=30)
    assert "No path to ring B in the computed region." in words(page)
    assert " touches the " in words(page)
    table = region(robot="two-links-on-a-table")
    assert table.components[table.component_of(pair(page))].contains_home
    links = page.locator(".proof-line a")
    found = [links.nth(k).get_attribute("href") for k in range(links.count())]
    assert found == [f"_static/play/certificates/B-{k}.json" for k in (1, 2)]


def test_the_arm_goes_to_the_ring_that_can_be_reached(open_figure):
    page = open_figure("goals")
    page.get_by_role("button", name="Is there a path to A?").click()
    assert "Ring A can be reached" in words(page)
    assert page.locator(".proof-line a").count() == 0
    ring = told("goals").RINGS["A"][:2]
    there = lambda: page.evaluate("qboundEngine.toolAt(arm.slice.map, arm.pair())")  # noqa: E731
    eventually(page, lambda: there() == pytest.approx(ring, abs=1e-4))


def test_the_certificates_of_the_rings_are_checked():
    """A refuted one shows a pose that hits something; the others prove a path, or that none is."""
    module = told("goals")
    rings = module.data(region(robot="two-links-on-a-table"))["rings"]
    answers = {pose["file"]: pose["answer"] for ring in rings for pose in ring["poses"]}
    files = module.files()
    assert files.keys() == answers.keys()
    for name, text in files.items():
        assert check.check(text).refuted == (answers[name] == "infeasible")
    assert {answers[name] for name in files if "B-" in name} <= {"separated", "infeasible"}


def test_the_keyboard_fails_at_the_same_place(open_figure):
    page = open_figure("goals")
    page.locator("svg[role=application]").first.focus()
    for _ in range(30):
        page.keyboard.press("Shift+ArrowLeft")  # the shoulder, by ten degrees
    assert " touches the " in words(page)
    table = region(robot="two-links-on-a-table")
    assert table.components[table.component_of(pair(page))].contains_home
