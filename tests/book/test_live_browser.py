"""The page "Configuration space, live" in a browser: hands, keys, undoing, links, files."""

from __future__ import annotations

import numpy as np
import pytest

from cspace import load_robot
from cspace.explorer.page import engine_script, engine_style, shorter_script
from engine_support.browser import drag, eventually, settle
from support.play import LIVE, PLAY, assert_fits_and_is_accessible

WIDTHS = {"wide screen": 1100, "phone": 360}
PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Live</title>
<meta name="viewport" content="width=device-width">
<style>:root {{ color-scheme: light }}
body {{ background: light-dark(#fff, #12181b); margin: 8px }}
{style}</style><main><h1>Live</h1><div class="play" data-figure="live"></div></main>
<script>{script}</script>"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """The page, its scripts as short as the book has them."""
    style = engine_style() + (PLAY / "play.css").read_text("utf-8")
    own = [shorter_script((PLAY / f"{name}.js").read_text("utf-8")) for name in LIVE]
    script = engine_script(explorer=False) + "".join(own)
    written = tmp_path_factory.mktemp("live") / "live.html"
    written.write_text(PAGE.format(style=style, script=script), encoding="utf-8")
    return written


@pytest.fixture
def open_page(open_quietly, file):
    def open_one(width=1100, text=""):
        return open_quietly(file.as_uri() + text, viewport={"width": width, "height": 900})

    return open_one


def totals(page):
    settle(page)
    return page.locator(".totals").inner_text()


def words(page):
    settle(page)
    return page.locator(".status > span").first.inner_text()


def value(page, name):
    return float(page.get_by_label(name, exact=True).input_value())


def middle(page, selector):
    box = page.locator(selector).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
def test_it_fits_and_breaks_no_rule_of_accessibility(open_page, width):
    page = open_page(width=width)
    page.get_by_label("Obstacle", exact=True).select_option("wedge")
    settle(page)
    assert_fits_and_is_accessible(page)


def test_the_region_follows_an_obstacle_that_is_dragged_and_undoing_takes_it_back(open_page):
    page = open_page()
    before, drawn = totals(page), page.locator(".piece.home.edge").get_attribute("d")
    start = middle(page, "[data-body='0']")
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(start[0] - 30, start[1] + 20)
    half = totals(page)
    assert half != before  # while the button is down
    page.mouse.move(start[0] - 60, start[1] + 40)
    page.mouse.up()
    assert totals(page) not in (before, half)
    assert page.get_by_label("Obstacle", exact=True).locator(":checked").inner_text() == "pillar"
    page.get_by_role("button", name="Undo").click()  # one step for the whole drag
    assert totals(page) == before
    assert page.locator(".piece.home.edge").get_attribute("d") == drawn
    assert page.get_by_role("button", name="Undo").is_disabled()


def test_an_obstacle_is_turned_and_sized_by_its_handles(open_page):
    page = open_page()
    page.mouse.click(*middle(page, "[data-body='1']"))
    settle(page)
    turned, width = (
        value(page, "turned by, in degrees, as a number"),
        "width in metres, as a number",
    )
    x, y = middle(page, "[data-hand='turn']")
    drag(page, (x, y), (x, y - 40))
    assert value(page, "turned by, in degrees, as a number") > turned + 10
    wide = value(page, width)
    x, y = middle(page, "[data-hand='size']")
    drag(page, (x, y), (x + 30, y - 30))
    assert value(page, width) > wide
    page.get_by_label("Obstacle", exact=True).select_option("wedge")
    settle(page)
    x, y = middle(page, "[data-hand='corner 1']")
    before = page.locator("[data-body='2']").get_attribute("d")
    drag(page, (x, y), (x + 25, y))
    assert page.locator("[data-body='2']").get_attribute("d") != before


def test_the_arm_is_dragged_by_dot_elbow_and_tool(open_page):
    page = open_page()
    names = [f"q{k} in degrees, as a number" for k in (1, 2)]
    square = page.locator(".picture svg").first.bounding_box()
    page.mouse.click(square["x"] + square["width"] / 2, square["y"] + square["height"] / 3)
    settle(page)
    first = [value(page, name) for name in names]
    drag(page, middle(page, "svg:nth-of-type(1) >> nth=1 >> .handle-group >> nth=0"), (900, 300))
    second = [value(page, name) for name in names]
    assert second[0] != first[0]
    assert second[1] == pytest.approx(first[1], abs=0.01)  # the elbow turns the first joint alone


def test_everything_can_be_done_with_keys(open_page):
    page = open_page()
    before = totals(page)
    square, plane = (page.get_by_role("application").nth(k) for k in (0, 1))
    square.focus()
    page.keyboard.press("Shift+ArrowRight")
    settle(page)
    assert value(page, "q1 in degrees, as a number") == pytest.approx(160)
    page.keyboard.press("h")
    settle(page)
    assert value(page, "q1 in degrees, as a number") == pytest.approx(150)
    plane.focus()
    for key in ("o", "o", "Shift+ArrowLeft", "r", "+"):
        page.keyboard.press(key)
    settle(page)
    assert page.get_by_label("Obstacle", exact=True).locator(":checked").inner_text() == "crate"
    assert value(page, "x in metres, as a number") == pytest.approx(0.6)
    assert value(page, "turned by, in degrees, as a number") == pytest.approx(22.2)
    assert value(page, "width in metres, as a number") == pytest.approx(0.525)
    page.keyboard.press("Delete")
    settle(page)
    assert page.locator("[data-body]").count() == 2
    for _ in range(4):
        page.keyboard.press("Control+z")
    assert totals(page) == before
    page.get_by_role("button", name="Add a polygon").press("Enter")
    settle(page)
    page.get_by_label("x in metres, as a number", exact=True).fill("0.9")
    page.get_by_label("Name", exact=True).fill("shelf")
    page.get_by_label("Name", exact=True).press("Tab")
    settle(page)
    assert page.get_by_label("Obstacle", exact=True).locator(":checked").inner_text() == "shelf"
    page.get_by_label("Name", exact=True).press_sequentially("!")
    page.get_by_label("x in metres, as a number", exact=True).evaluate(
        "field => { field.value = 0.8; field.dispatchEvent(new Event('input')) }"
    )
    settle(page)  # the scene was drawn anew while a name was being typed
    assert page.get_by_label("Name", exact=True).input_value() in ("shelf!", "!shelf")
    page.get_by_role("button", name="Delete this polygon").press("Enter")
    settle(page)
    assert page.locator("[data-body]").count() == 3
    page.get_by_role("button", name="Reset").press("Enter")
    assert totals(page) == before


def test_it_says_what_touches_and_tells_it_to_a_screen_reader(open_page):
    page = open_page()
    assert words(page).startswith("Safe. ")
    page.get_by_label("q1 in degrees, as a number", exact=True).fill("-20")
    page.get_by_label("q2 in degrees, as a number", exact=True).fill("0")
    assert words(page).startswith("Not safe: ")
    assert "forearm, pillar" in words(page)
    spoken = page.locator("p.unseen[role=status]")
    eventually(page, lambda: spoken.text_content() == words(page))


def test_a_link_and_a_robot_file_keep_the_scene(open_page, tmp_path):
    page = open_page()
    page.get_by_role("button", name="Add a box").click()
    page.get_by_label("upper arm, length, in metres, as a number").fill("0.9")
    settle(page)
    eventually(page, lambda: "box" in page.url and "arm=0.9" in page.url)
    other = open_page(text=page.url[page.url.index("#") :])
    assert totals(other) == totals(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save as a robot file").click()
    file = tmp_path / download.value.suggested_filename
    download.value.save_as(file)
    robot = load_robot(file)
    assert [body.name for body in robot.obstacles] == ["pillar", "crate", "wedge", "box"]
    assert np.allclose(robot.body("upper arm").parts[0].corners[1], [0.9, 0, 0])
