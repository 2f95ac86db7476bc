"""The live scene in a browser: what a reader does to obstacles, and how the scene is kept."""

from __future__ import annotations

import re

import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.explorer.page import figures_script, figures_style
from engine_support.browser import drag, eventually, middle, settle
from engine_support.live_scenes import TURN

PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Live</title>
<meta name="viewport" content="width=device-width"><meta name="color-scheme" content="light dark">
<style>{style}</style><main><h1>Live</h1>
<live-figure data-kind="live" data-id="1"></live-figure></main><script>{script}</script></html>"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "live.html"
    text = PAGE.format(style=figures_style(), script=figures_script("arm", "live"))
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def open_scene(open_quietly, file):
    def open_one(fragment="", **options):
        options = {"viewport": {"width": 1200, "height": 1000}} | options
        return open_quietly(file.as_uri() + fragment, **options)

    return open_one


def shares(page):
    """Shares of all poses, as the page says them."""
    settle(page)
    words = page.locator("live-figure .words").inner_text()
    return [float(value) / 100 for value in re.findall(r"([\d.]+) %", words)]


def handle(page, name):
    return page.get_by_label(name, exact=True)


def value(page, name):
    return float(page.get_by_label(f"{name}, as a number", exact=True).last.input_value())


def test_regions_follow_an_obstacle_that_is_dragged_and_one_undo_takes_it_back(open_scene):
    page = open_scene()
    before = shares(page)
    x, y = middle(handle(page, "pillar"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 30, y + 20)
    half = shares(page)
    assert half != before  # while the button is down
    page.mouse.move(x - 60, y + 40)
    page.mouse.up()
    assert shares(page) not in (before, half)
    page.get_by_role("button", name="Undo").click()
    assert shares(page) == before
    assert page.get_by_role("button", name="Undo").is_disabled()


def test_an_obstacle_is_turned_sized_named_and_removed(open_scene):
    page = open_scene()
    handle(page, "crate").focus()
    for key in ("Shift+ArrowLeft", "r", "+"):
        page.keyboard.press(key)
    settle(page)
    assert value(page, "x") < 0.65
    assert value(page, "turned") == pytest.approx(22.2)
    assert value(page, "width") == pytest.approx(0.525)
    x, y = middle(handle(page, "turn crate"))
    drag(page, (x, y), (x, y - 40))
    assert value(page, "turned") > 30
    x, y = middle(handle(page, "size"))
    drag(page, (x, y), (x + 30, y - 30))
    assert value(page, "width") > 0.53
    page.get_by_label("name", exact=True).fill("wedge!")
    page.keyboard.press("Tab")
    settle(page)
    assert page.get_by_label("name", exact=True).input_value() == "wedge 2"
    page.get_by_role("button", name="Delete wedge 2").click()
    settle(page)
    assert handle(page, "wedge 2").count() == 0


def test_corners_are_moved_added_and_removed_and_edges_never_cross(open_scene):
    page = open_scene()
    handle(page, "wedge").focus()
    settle(page)
    corners = page.get_by_label(re.compile("^corner "))
    for key, count in (("+", 4), ("Delete", 3), ("Delete", 3)):
        corners.nth(1).focus()
        page.keyboard.press(key)
        settle(page)
        assert corners.count() == count
    x, y = (corners.nth(1).bounding_box()[k] + 5 for k in "xy")
    before = shares(page)
    drag(page, (x, y), (x - 300, y - 20))  # past the other two corners
    assert shares(page) != before
    state = page.evaluate("document.querySelector('live-figure').state.scene.obstacles[2].corners")
    (a, b), (c, d), (e, f) = state
    assert abs((c - a) * (f - b) - (d - b) * (e - a)) > 1e-6


def test_a_link_and_a_robot_file_keep_the_scene(open_scene, tmp_path):
    page = open_scene()
    page.get_by_role("button", name="Add a box").click()
    page.get_by_role("button", name="Add a polygon").click()
    field = page.get_by_label("upper arm: length, as a number", exact=True)
    field.fill("0.9")
    field.press("Enter")
    eventually(page, lambda: "polygon+" in page.url and "arm=0.9" in page.url)
    found = shares(page)
    assert page.get_by_label("Link to this scene").input_value() == page.url
    assert shares(open_scene(page.url[page.url.index("#") :])) == found
    with page.expect_download() as download:
        page.get_by_role("button", name="Save as a robot file").click()
    saved = tmp_path / download.value.suggested_filename
    download.value.save_as(saved)
    robot = load_robot(saved)
    names = ["pillar", "crate", "wedge", "box", "polygon"]
    assert [body.name for body in robot.obstacles] == names
    assert np.allclose(robot.body("upper arm").parts[0].corners[1], [0.9, 0, 0])
    expected = [one.area / TURN**2 for one in find_region(robot).components]
    assert sorted(found) == pytest.approx(sorted(expected), abs=1e-3)


def test_another_link_opens_in_the_same_page(open_scene):
    page = open_scene()
    page.evaluate("location.hash = 'arm=1,0.8,0.1,0.1&home=10,20&q=30,40&o=disc 1,-1,0,0.2 ball'")
    eventually(page, lambda: handle(page, "ball").count() == 1)
    assert handle(page, "pillar").count() == 0
    assert handle(page, "both joints").get_attribute("aria-valuetext") == "30.0°, 40.0°"
