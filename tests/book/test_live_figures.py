"""Figures that a reader moves: the directive; each kind by mouse, finger and keys."""

from __future__ import annotations

import re

import numpy as np
import pytest
from bs4 import BeautifulSoup

from cspace import clearance, find_region, load_robot
from cspace.explorer.page import KINDS
from cspace.measures.bodies import gaps, overlap_pairs
from engine_support.browser import (
    FINGERS,
    broken_rules,
    drag,
    eventually,
    middle,
    opening,
    rules_in,
    settle,
    touch_drag,
    wait_until,
)
from qbound import window_region
from qbound.scaling import least_on_edges
from support.trial_book import BOOK, build_book

# What the extensions call will leave Sphinx one day: their matter, not this book's.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*Sphinx:DeprecationWarning", "ignore:.*Sphinx:PendingDeprecationWarning"
)

CONF = """
extensions = ["myst_parser", "live_figures"]
myst_enable_extensions = ["attrs_inline", "dollarmath"]
html_theme = "basic"
html_static_path = ["static"]
mathjax_path = "nothing.js"
"""
FIGURES = {
    "angle": ("angle",),
    "bounds": ("bounds", "rule: windows"),
    "circle": ("circle",),
    "bodies": ("arm", "bodies:", "start: 2"),
    "dots": ("arm", "dots:", "start: -30,30"),
    "explorer": ("arm", "robot: rp-telescopic-boom", "explorer:"),
    "functions": ("functions",),
    "live": ("live",),
    "passes": ("functions", "only: B7", "passes:"),
    "picture": ("arm", "robot: minervabot-v2-bodies", "picture: still.svg", "alt: A still picture"),
    "rings": ("arm", "robot: two-links-on-a-table", "stop:", "first: arm"),
    "scale": ("scale", "rule: windows"),
    "stop": ("arm", "stop:"),
    "walk": ("walk", "rule: windows"),
}
"""Every kind, with every option that changes what is drawn."""

HANDLES = {
    "angle": ["the tool", "the elbow"],
    "circle": ["q", "the vector (a, b)", "c"],
    "bodies": ["both joints", "the tool", "the elbow"],
    "dots": ["both joints", "the tool", "the elbow"],
    "explorer": ["both joints", "the tool"],
    "functions": ["the tool", "the elbow", "q₂"],
    "live": ["both joints", "the tool", "the elbow", "pillar", "crate", "wedge"],
    "passes": ["the tool", "the elbow", "q₂"],
    "rings": ["both joints", "the tool", "the elbow"],
    "stop": ["both joints", "the tool", "the elbow"],
    "walk": ["both joints", "the tool", "the elbow"],
}
WAYS = [(40, 0), (-40, 0), (0, -40), (0, 40)]
KEYS = ["ArrowRight", "ArrowLeft", "ArrowUp", "ArrowDown"]


def directive(kind: str, *options: str) -> str:
    lines = "".join(f":{option}\n" for option in options)
    return f"```{{live}} {kind}\n{lines}A caption with $B_3$.\n```\n"


def begin(folder):
    """Write the settings of a small book; formulas stay as they are written."""
    folder.joinpath("conf.py").write_text(CONF, encoding="utf-8")
    folder.joinpath("static").mkdir()
    folder.joinpath("static", "nothing.js").write_text("", encoding="utf-8")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Build a small book with a page for each figure, and one page with all of them."""
    folder = tmp_path_factory.mktemp("site")
    begin(folder)
    folder.joinpath("still.svg").write_bytes((BOOK / "_static" / "logo.svg").read_bytes())
    texts = {name: directive(*figure) for name, figure in FIGURES.items()}
    texts["index"] = "\n".join(texts.values()) + "\n```{toctree}\n:glob:\n*\n```\n"
    texts["plain"] = "No figure, and $B_3$."
    for name, text in texts.items():
        folder.joinpath(f"{name}.md").write_text(f"# {name}\n\n{text}", encoding="utf-8")
    outdir, warnings = build_book(folder, BOOK / "_ext")
    assert warnings == ""
    return outdir


@pytest.fixture
def open_figure(open_quietly, site):
    def open_one(name, **options):
        options = {"viewport": {"width": 1000, "height": 900}} | options
        return open_quietly((site / f"{name}.html").as_uri(), **options)

    return open_one


@pytest.fixture(scope="module")
def phone(tabs, site):
    """The figures on a phone, each in a page that a finger can scroll; a test after the other."""
    with opening(tabs) as open_one:

        def open_figure(name):
            page = open_one(
                (site / f"{name}.html").as_uri(),
                viewport={"width": 390, "height": 844},
                reduced_motion="reduce",
                **FINGERS,
            )
            page.evaluate("document.body.style.padding = '900px 8px'")
            settle(page)
            return page

        yield open_figure


def scripts_of(folder, name):
    html = BeautifulSoup((folder / f"{name}.html").read_text(encoding="utf-8"), "html.parser")
    found = [str(tag["src"]).partition("?")[0] for tag in html.find_all("script", src=True)]
    return [address.removeprefix("_static/live/") for address in found if "live/" in address]


def handle(page, name):
    return page.locator(f'.handle[aria-label="{name}"]').first


def place(page, name):
    return handle(page, name).get_attribute("transform")


def status(page):
    return page.locator("live-figure .status").inner_text()


# --- the directive --------------------------------------------------------------------------------


def test_every_kind_is_tried_here():
    assert {kind for kind, *_ in FIGURES.values()} == set(KINDS)


def test_a_page_loads_one_script_and_each_robot_once(site):
    assert scripts_of(site, "stop") == ["minervabot-v2.js", "figures.js"]
    assert scripts_of(site, "circle") == ["figures.js"]
    assert scripts_of(site, "plain") == []
    assert len(scripts_of(site, "index")) == len(set(scripts_of(site, "index"))) == 6


@pytest.mark.parametrize(
    ("figure", "said"),
    [
        (("arms",), "no live figure 'arms'"),
        (("circle", "robot: minervabot-v2"), "circle has no option robot"),
        (("arm", "passes:"), "arm has no option passes"),
        (("arm", "rule: mine"), "rule.*mine.*choose from"),
        (("arm", "colour: red"), "Unknown option.*colour"),
    ],
)
def test_a_wrong_option_is_an_error(tmp_path, figure, said):
    begin(tmp_path)
    (tmp_path / "index.md").write_text(f"# Wrong\n\n{directive(*figure)}", encoding="utf-8")
    _, warnings = build_book(tmp_path, BOOK / "_ext")
    assert re.search(rf"(?i)(error|warning): .*{said}", warnings)


@pytest.mark.parametrize("name", ["picture", "stop"])
def test_on_paper_and_without_scripts_the_picture_stands_there_or_nothing(site, tabs, name):
    address = (site / f"{name}.html").as_uri()
    figure, picture = ".live", ".live-picture img"
    with tabs.lent(java_script_enabled=False) as tab:
        tab.page.goto(address)
        assert tab.page.is_visible(figure) == (name == "picture")
        assert tab.page.locator(picture).count() == (name == "picture")
    with tabs.lent() as tab:
        tab.page.goto(address)
        assert tab.page.is_visible("live-figure")
        assert not tab.page.is_visible(picture)
        assert tab.page.inner_text(".live-label") == "Try it"
        assert "Your browser draws this figure" in tab.page.inner_text(".live-caption")
        tab.page.emulate_media(media="print")
        assert not tab.page.is_visible("live-figure")
        assert tab.page.is_visible(picture) == (name == "picture")


# --- by mouse, finger and keys --------------------------------------------------------------------


@pytest.mark.parametrize("name", HANDLES)
def test_every_handle_follows_mouse_and_keys_and_the_figure_keeps_its_height(open_figure, name):
    page = open_figure(name)
    figure = page.locator("live-figure")
    found = [one.get_attribute("aria-label") for one in page.locator(".handle").all()]
    assert found[: len(HANDLES[name])] == HANDLES[name] or set(HANDLES[name]) <= set(found)
    pictures = figure.locator(".pictures")
    height = pictures.bounding_box()["height"]
    for one in HANDLES[name]:
        start = place(page, one)
        for dx, dy in WAYS:
            handle(page, one).scroll_into_view_if_needed()
            x, y = middle(handle(page, one))
            drag(page, (x, y), (x + dx, y + dy), steps=4)
            if place(page, one) != start:
                break
        dragged = place(page, one)
        assert dragged != start, one
        handle(page, one).focus()
        for key in KEYS:
            page.keyboard.press(f"Shift+{key}")
            settle(page)
            if place(page, one) != dragged:
                break
        assert place(page, one) != dragged, one
        assert handle(page, one).get_attribute("aria-valuetext") != "", one
    assert pictures.bounding_box()["height"] == height


@pytest.mark.parametrize("name", HANDLES)
def test_every_handle_follows_a_finger_and_the_page_rests(phone, name):
    page = phone(name)
    for one in HANDLES[name]:
        places = {place(page, one)}
        for dx, dy in WAYS:
            handle(page, one).evaluate("(one) => one.scrollIntoView({ block: 'center' })")
            settle(page)
            scrolled = page.evaluate("scrollY")
            x, y = middle(handle(page, one))
            touch_drag(page, (x, y), (x + dx, y + dy), steps=5)
            assert page.evaluate("scrollY") == scrolled, one
            places.add(place(page, one))
        assert len(places) > 1, one


@pytest.mark.parametrize("name", ["stop", "scale", "bounds"])
def test_a_finger_beside_the_handles_scrolls_the_page(phone, name):
    page = phone(name)
    page.evaluate("document.querySelector('.picture svg').scrollIntoView({ block: 'center' })")
    settle(page)
    before, box = page.evaluate("scrollY"), page.locator(".picture svg").first.bounding_box()
    x, y = box["x"] + 0.9 * box["width"], box["y"] + 0.85 * box["height"]
    touch_drag(page, (x, y), (x, y - 80))
    assert page.evaluate("scrollY") > before


def test_values_can_be_typed_and_what_is_typed_stays_until_it_counts(open_figure):
    page = open_figure("stop")
    field = page.get_by_label("q₁, as a number")
    field.focus()
    page.keyboard.press("ControlOrMeta+a")
    page.keyboard.type("20")
    page.evaluate("document.querySelector('live-figure').set({})")
    settle(page)
    assert field.input_value() == "20"
    page.keyboard.press("Enter")
    eventually(page, lambda: "20.0°" in handle(page, "both joints").get_attribute("aria-valuetext"))


def test_a_screen_reader_hears_the_status_once_the_figure_rests(open_figure):
    page = open_figure("stop")
    handle(page, "both joints").focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    assert page.locator("[role=status]").text_content() != status(page)
    eventually(page, lambda: page.locator("[role=status]").text_content() == status(page))


# --- kind by kind ---------------------------------------------------------------------------------

STEPS = {
    "passes": [
        ("look", "", r"^B7 is positive: point 3 and its limit, 37\.16 cm"),
        ("fill q₁", "60", ""),
        ("fill q₂", "60", r"^B7 is negative"),
    ],
    "circle": [
        ("look", "", r"Eq\. \(31\) is the arc itself\."),
        ("tick", "Read arctan(b/a) as printed", "on the wrong side"),
        ("tick", "Keep the printed −2π", "it excludes nothing"),
    ],
    "bounds": [
        ("look", "", "q₁ from −136.24° to 76.22°, q₂ from −162.30° to 44.38°"),
        ("tick", "Pairs of points", "q₁ from −180.00° to 180.00°"),
        ("press", "As it opens", "−136.24° to 76.22°"),
        (
            "tick",
            "Read arctan(b/a) as printed",
            r"q₁ from −209\.98° to 43\.76°.*The square shows one turn only",
        ),
    ],
}
"""What a reader does in a figure, and what its status says then."""


@pytest.mark.parametrize("name", STEPS)
def test_the_status_says_what_the_reader_has_done(open_figure, name):
    page = open_figure(name, reduced_motion="reduce")
    for step, what, said in STEPS[name]:
        if step.startswith("fill"):
            page.get_by_label(f"{step[5:]}, as a number").fill(what)
            page.keyboard.press("Enter")
        elif step == "press":
            page.get_by_role("button", name=what, exact=True).click()
        elif step == "tick":
            page.get_by_label(what).click()
        eventually(page, lambda said=said: re.search(said, status(page)) is not None)


def test_the_arm_stops_where_the_library_says(open_figure):
    page = open_figure("stop")
    page.get_by_label("q₂, as a number").fill("60")
    page.keyboard.press("Enter")
    eventually(page, lambda: "The arm stops: points 10 and 11 meet (B3)" in status(page))
    assert "Behind it lies region 2; no way leads there." in status(page)
    q2 = np.radians(float(page.get_by_label("q₂, as a number").input_value()))
    region = find_region(load_robot("minervabot-v2"))
    assert region.contains([[0, q2 - 0.001], [0, q2 + 0.006]]).tolist() == [True, False]


def test_no_path_to_b_is_written_on_the_map_with_its_proofs(open_figure, site):
    page = open_figure("rings", reduced_motion="reduce")
    for button, said in (
        ("Path to A?", "There: "),
        ("Start again", "Clear of "),
        ("Path to B?", "No path to B"),
    ):
        page.get_by_role("button", name=button).click()
        eventually(page, lambda said=said: status(page).startswith(said))
    assert page.locator("svg .verdict").text_content() == "No path to B"
    proofs = [
        proof.get_attribute("href") for proof in page.get_by_role("link", name="Certificate").all()
    ]
    assert len(proofs) == 2
    assert all((site / proof).is_file() for proof in proofs)


def test_the_largest_scale_is_where_the_tool_comes_up_to_its_limit(open_figure):
    page = open_figure("scale")
    page.get_by_role("button", name="1, the six points").click()
    robot = load_robot("minervabot-v2")
    corners = window_region(robot).polygon
    least = least_on_edges(clearance(robot, "B7"), corners).value
    eventually(page, lambda: f"{-least:.3f} cm below its limit" in status(page))
    page.get_by_role("button", name="the largest").click()
    eventually(page, lambda: "stays 0.000 cm or more above its limit" in status(page))


def test_a_walk_plays_pauses_and_goes_from_point_to_point_where_motion_is_reduced(open_figure):
    page = open_figure("walk")
    page.get_by_role("button", name="Play").click()
    progress = "document.querySelector('live-figure').state.done"
    wait_until(page, f"{progress} > 0.01")
    page.get_by_role("button", name="Pause").click()
    stopped = page.evaluate(progress)
    settle(page)
    assert page.evaluate(progress) == stopped < 1
    calm = open_figure("walk", reduced_motion="reduce")
    calm.get_by_role("button", name="Play").click()
    wait_until(calm, f"{progress} > 0")
    stops = calm.evaluate("document.querySelector('live-figure').state.way.at")
    assert calm.evaluate(progress) in stops


def test_the_angle_that_the_first_joint_leaves_alone_is_q2(open_figure):
    page = open_figure("angle")
    values = page.locator("live-figure td").all_inner_texts
    before = values()
    page.get_by_label("q₁, as a number").fill("-20")
    page.keyboard.press("Enter")
    eventually(page, lambda: values() != before)
    assert values()[0] == before[0] == "−55.0°"
    assert values()[1] != before[1]


# --- safe means safe ------------------------------------------------------------------------------

ASK = """(poses) => {
  const figure = document.querySelector("live-figure");
  return poses.map((q) => {
    Object.assign(figure.state, { q, by: null, ring: null, answered: false });
    return figure.view(figure.state).status[0];
  });
}"""


@pytest.mark.parametrize(
    ("name", "robot"),
    [
        ("bodies", "minervabot-v2"),
        ("dots", "minervabot-v2"),
        ("picture", "minervabot-v2-bodies"),
        ("rings", "two-links-on-a-table"),
        ("stop", "minervabot-v2"),
        ("walk", "minervabot-v2"),
    ],
)
def test_a_pose_is_called_safe_or_clear_only_where_no_two_bodies_overlap(open_figure, name, robot):
    arm, page = load_robot(robot), open_figure(name)
    q = np.random.default_rng(9).uniform(-np.pi, np.pi, (600, 2))
    told = page.evaluate(ASK, q.tolist())
    apart = overlap_pairs(arm)
    depth = np.min([gaps(arm, q)[pair] for pair in apart], axis=0)
    good = re.compile(r"(?m)^(Safe|Clear)|: apart|^There")
    overlapping = [text for text, gap in zip(told, depth, strict=True) if gap < -1e-6]
    assert overlapping
    assert [text for text in overlapping if good.search(text)] == []
    assert [text for text in overlapping if "overlap" not in text and "Not " not in text] == []
    if name in {"picture", "rings", "bodies"}:
        assert any(good.search(text) for text in told)


# --- for everybody --------------------------------------------------------------------------------


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [1000, 390])
def test_the_accessibility_rules_find_nothing_in_any_figure(open_figure, theme, width):
    page = open_figure("index", viewport={"width": width, "height": 900}, color_scheme=theme)
    page.evaluate("document.documentElement.style.colorScheme = 'light dark'")
    page.evaluate("document.body.style.background = 'light-dark(#fff, #12181b)'")
    settle(page)
    assert broken_rules(page, "live-figure", **rules_in(theme)) == []
