"""The page of a surface in a browser, opened from the file system: turned, tapped, on a phone."""

import re
from io import BytesIO

import numpy as np
import pytest
from matplotlib.image import imread

from qbound.arms.surfaces import find_surface
from qbound.explorer.surface_page import surface_page
from support.browser import (
    broken_rules,
    drag,
    eventually,
    in_every_family,
    opening,
    settle,
    wait_until,
)
from support.portals import NAMES, dice

VIEW = "surface.view"


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    written = tmp_path_factory.mktemp("surface") / "dice.html"
    written.write_text(surface_page(find_surface(dice(), NAMES, resolution=6)), encoding="utf-8")
    return written


@pytest.fixture
def open_page(tabs):
    """Open pages as `open_quietly`, but for what drivers say of their own speed."""
    with opening(tabs, "GL Driver Message") as open_one:
        yield open_one


def told(page, x=0.5, y=0.5) -> str:
    box = page.locator("canvas").bounding_box()
    page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
    return page.inner_text(".readout")


def test_a_phone_in_the_dark_shows_it_in_every_family(open_page, file) -> None:
    page = open_page(file.as_uri(), viewport={"width": 390, "height": 844}, color_scheme="dark")
    for family in in_every_family(page):
        assert page.evaluate("document.documentElement.scrollWidth") <= 390, family
    assert broken_rules(page) == []
    drawn = imread(BytesIO(page.locator("canvas").screenshot()), format="png")[..., :3]
    assert len(np.unique((drawn.reshape(-1, 3) * 255).astype(int), axis=0)) > 20


def test_a_tap_names_the_side_that_is_there(open_page, file) -> None:
    robot, page = dice(), open_page(file.as_uri(), viewport={"width": 1280, "height": 844})
    sides = set()
    for x, y in ((0.5, 0.5), (0.46, 0.62), (0.56, 0.58), (0.5, 0.38)):
        numbers, name = told(page, x, y).rsplit(": ", 1)
        place = [float(v.replace("−", "-")) for v in re.findall(r"q\d (\S+) m", numbers)]
        side = robot.boundary(name)
        assert side.normal @ place == pytest.approx(side.offset, abs=0.02)
        sides.add(name)
    assert len(sides) > 1
    assert told(page, 0.02, 0.02) == "No surface is there."
    name = told(page).rsplit(": ", 1)[1]
    page.get_by_label(name).uncheck()
    assert told(page).rsplit(": ", 1)[1] != name


def test_hands_and_keys_turn_it(open_page, file) -> None:
    page = open_page(file.as_uri(), viewport={"width": 1280, "height": 844})
    first = page.evaluate(VIEW)
    box = page.locator("canvas").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    readout = page.inner_text(".readout")
    drag(page, middle, (middle[0] + 120, middle[1] - 60))
    turned = page.evaluate(VIEW)
    assert turned["yaw"] < first["yaw"]
    assert turned["pitch"] < first["pitch"]
    assert page.inner_text(".readout") == readout  # a drag is no tap
    page.mouse.wheel(0, -200)
    wait_until(page, f"surface.view.distance < {first['distance']}")
    page.locator("canvas").press("0")
    assert page.evaluate(VIEW) == first
    for key, name in {"ArrowLeft": "yaw", "ArrowUp": "pitch", "+": "distance"}.items():
        before = page.evaluate(VIEW)[name]
        page.locator("canvas").press(key)
        assert page.evaluate(VIEW)[name] != before
    page.get_by_role("button", name="First view").click()
    settle(page)
    assert page.evaluate(VIEW) == first
    page.get_by_role("button", name="Closer").click()
    assert page.evaluate(VIEW)["distance"] < first["distance"]


def test_without_webgl_it_says_so(browser, file) -> None:
    page = browser.new_page()
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(file.as_uri())
    assert page.get_by_text("needs WebGL 2").is_visible()
    assert page.locator(".pairs li").count() == 6
    page.close()


AROUND = """<!doctype html><title>Around</title><h1>Before</h1>
<iframe src="dice.html" title="Surface" height="100" style="border: 0; width: 100%"></iframe>
<p style="height: 3000px">After</p>
<script>
const frame = document.querySelector("iframe");
addEventListener("message", ({ data }) => { frame.height = data.explorerHeight; });
</script>"""


@pytest.mark.parametrize("width", [1280, 390])
def test_in_a_frame_it_has_its_height_a_theme_and_leaves_the_wheel_alone(open_page, file, width):
    around = file.with_name("around.html")
    around.write_text(AROUND, encoding="utf-8")
    page = open_page(around.as_uri(), viewport={"width": width, "height": 800})
    inside = page.frames[1]
    overflow = "() => document.documentElement.scrollHeight - innerHeight"
    eventually(page, lambda: page.locator("iframe").bounding_box()["height"] > 400)
    eventually(page, lambda: inside.evaluate(overflow) <= 0)
    assert page.locator("iframe").bounding_box()["height"] < 1400
    ground = "() => getComputedStyle(document.documentElement).backgroundColor"
    light = inside.evaluate(ground)
    page.evaluate("() => frame.contentWindow.postMessage({ theme: 'dark' }, '*')")
    eventually(page, lambda: inside.evaluate(ground) != light)
    canvas, view = (
        page.frame_locator("iframe").locator("canvas"),
        "() => window.surface.view.distance",
    )
    before = inside.evaluate(view)
    canvas.hover()
    page.mouse.wheel(0, 100)
    eventually(page, lambda: page.evaluate("() => scrollY") > 0)
    assert inside.evaluate(view) == before
    canvas.scroll_into_view_if_needed()
    canvas.focus()
    canvas.hover()
    page.mouse.wheel(0, 100)
    eventually(page, lambda: inside.evaluate(view) != before)
