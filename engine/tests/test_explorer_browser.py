"""The explorer in a browser, opened from the file system, without a network: what a reader does."""

from __future__ import annotations

import re

import numpy as np
import pytest

from cspace import find_region, find_slices, load_robot
from cspace.explorer.page import explore, explorer_page
from engine_support.arms import ROBOTS, SPATIAL, three_joints
from engine_support.browser import broken_rules, drag, eventually, middle, settle

WIDTHS = {"wide screen": 1280, "phone": 390}
KINDS = {**ROBOTS, **SPATIAL, "portal": lambda: (load_robot("pp-portal"), {})}
KINDS["long names"] = lambda: (
    load_robot("ur5"),
    {j: load_robot("ur5").home[j] for j in range(2, 6)},
)
POSE = "document.querySelector('live-figure').state.q"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The pages of all kinds of robots, by name."""
    folder = tmp_path_factory.mktemp("explorers")
    paths = {}
    for k, (name, made) in enumerate(KINDS.items()):
        paths[name] = folder / f"{k}.html"
        explore(find_region(*made())).save(paths[name])
    return paths


@pytest.fixture
def open_explorer(open_quietly, files):
    def open_one(name="paper", fragment="", **options):
        options = {"viewport": {"width": 1280, "height": 900}} | options
        return open_quietly(files[name].as_uri() + fragment, **options)

    return open_one


def dot(page):
    return page.get_by_label("both joints", exact=True)


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_of_robot_opens_and_is_moved(open_explorer, name):
    page = open_explorer(name)
    before = page.evaluate(POSE)
    x, y = middle(dot(page))
    drag(page, (x, y), (x - 15, y + 10))
    assert page.evaluate(POSE) != before
    tool = page.get_by_label("the tool", exact=True)
    dragged = page.evaluate(POSE)
    tool.focus()
    for key in ("ArrowLeft", "ArrowUp", "ArrowRight", "ArrowDown"):
        page.keyboard.press(f"Shift+{key}")
    settle(page)
    assert page.evaluate(POSE) != dragged
    page.get_by_role("button", name="Home").click()
    eventually(page, lambda: np.allclose(page.evaluate(POSE), before))


WORDS = """[...document.querySelectorAll('svg text.name')].map((text) => {
  const [own, all] = [text, text.ownerSVGElement].map((each) => each.getBoundingClientRect());
  return [text.textContent, own.left >= all.left - 1 && own.right <= all.right + 1];
})"""


@pytest.mark.parametrize("width", WIDTHS.values(), ids=WIDTHS)
@pytest.mark.parametrize("name", KINDS)
def test_names_stay_in_their_pictures_and_the_page_in_its_width(open_explorer, name, width):
    """Names of joints and links of a real arm are long: they ran over each other and out."""
    page = open_explorer(name, viewport={"width": width, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    words = page.evaluate(WORDS)
    assert words
    assert [word for word, is_inside in words if not is_inside] == []


def test_a_link_restores_the_pose_and_a_broken_one_opens_home(open_explorer):
    page = open_explorer(fragment="#q=0.2,-0.5")
    assert page.evaluate(POSE) == [0.2, -0.5]
    dot(page).focus()
    page.keyboard.press("ArrowRight")
    settle(page)
    moved = page.evaluate(POSE)
    assert moved != [0.2, -0.5]
    eventually(page, lambda: f"{moved[0]:.5f}" in page.evaluate("location.hash"))
    again = open_explorer(fragment=page.evaluate("location.hash"))
    assert np.allclose(again.evaluate(POSE), page.evaluate(POSE), atol=1e-5)
    for broken in ("#q=1", "#q=a,b", "#q=1,NaN", "#what"):
        assert open_explorer(fragment=broken).evaluate(POSE) == [0, 0]


def test_the_violated_boundary_is_named_and_lit(open_explorer):
    page = open_explorer(fragment="#q=1.4,0.2")
    status = page.locator(".status").inner_text()
    assert re.match(r"Not allowed by the points: B7, \d+\.\d\d cm too close\.", status)
    assert page.locator("tr.lit th").first.inner_text() == "B7"
    assert page.locator("svg .wall.lit").count() == 1


def test_the_slider_of_a_held_joint_goes_from_slice_to_slice(open_quietly, tmp_path):
    robot = three_joints()
    row = find_slices(robot, "q3", [-1.2, -0.2, 0.8])
    explore(row.regions[1], row).save(tmp_path / "row.html")
    page = open_quietly((tmp_path / "row.html").as_uri())
    home = page.locator(".region.home")
    before, field = home.get_attribute("d"), page.get_by_label("q₃, as a number")
    assert float(field.input_value()) == pytest.approx(np.degrees(-0.2), abs=0.01)
    field.fill("40")  # the nearest slice
    page.keyboard.press("Enter")
    eventually(page, lambda: home.get_attribute("d") != before)
    assert float(field.input_value()) == pytest.approx(np.degrees(0.8), abs=0.01)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_accessibility_rules_find_nothing(open_explorer, theme):
    assert broken_rules(open_explorer(color_scheme=theme)) == []


def test_without_scripts_the_page_says_what_it_would_show(tabs, files):
    with tabs.lent(java_script_enabled=False) as tab:
        tab.page.goto(files["paper"].as_uri())
        words = tab.page.inner_text("noscript")
    assert "needs JavaScript" in words
    assert "5 pieces" in words


def test_in_a_notebook_the_frame_works_and_takes_the_place_of_the_picture(open_quietly, tmp_path):
    file = tmp_path / "notebook.html"
    output = explore(find_region(load_robot("pp-portal")))._repr_html_()
    file.write_text(f"<!doctype html>{output}", encoding="utf-8")
    page = open_quietly(file.as_uri())
    inside = page.frame_locator("iframe").get_by_label("both joints", exact=True)
    before = inside.get_attribute("transform")
    inside.focus()
    page.keyboard.press("Shift+ArrowLeft")
    eventually(page, lambda: inside.get_attribute("transform") != before)
    assert page.locator("img").count() == 0
    left = re.sub(r"<iframe.*</iframe>", "", output, flags=re.DOTALL)  # what a sanitizer leaves
    file.write_text(f"<!doctype html>{left}", encoding="utf-8")
    page = open_quietly(file.as_uri())
    assert page.evaluate("document.querySelector('img').naturalWidth") > 200


def test_a_page_tells_the_frame_around_it_its_height_and_follows_its_theme(open_quietly, tmp_path):
    file = tmp_path / "around.html"
    page = explorer_page(find_region(load_robot("pp-portal"))).replace('"', "&quot;")
    listen = "addEventListener('message', ({ data }) => (window.told = data.explorerHeight))"
    frame = f'<iframe sandbox="allow-scripts" srcdoc="{page}"></iframe>'
    file.write_text(f"<!doctype html><script>{listen}</script>{frame}", encoding="utf-8")
    shown = open_quietly(file.as_uri())
    eventually(shown, lambda: shown.evaluate("window.told > 300"))
    root = shown.frame_locator("iframe").locator("html")
    ground = "(page) => getComputedStyle(page).backgroundColor"
    before = root.evaluate(ground)
    shown.evaluate("frames[0].postMessage({ theme: 'dark' }, '*')")
    eventually(shown, lambda: root.evaluate(ground) != before)
