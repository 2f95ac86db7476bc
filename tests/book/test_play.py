"""Figures in a page of the book: hooks, several explorers on a page, paper, keys, no scripts."""

from __future__ import annotations

import importlib
import re

import numpy as np
import pytest
from bs4 import BeautifulSoup
from numpy.testing import assert_allclose

from cspace.explorer.page import engine_script
from engine_support.browser import broken_rules, drag, settle, wait_until
from engine_support.javascript import Script
from engine_support.scripts import importable
from support.trial_book import BOOK, build_book

PICTURES = ".play svg[role=application]"
WEB = BOOK.parent / "engine" / "cspace" / "explorer" / "web"
MOST_BYTES = 150_000  # of our own script on a page
ONLY_LIVE = re.compile(
    r"rerun-(?!files|page)|rerun\.js"
)  # loaded where Python lies beside the book

# What the extensions call will leave Sphinx one day: their matter, not this book's.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*Sphinx:DeprecationWarning", "ignore:.*Sphinx:PendingDeprecationWarning"
)

CONF = f"""
extensions = ["myst_parser", "play"]
html_theme = "basic"
html_static_path = [{str(BOOK / "_static")!r}]
"""

PAGES = {
    "index": """
# Figures

```{figure} still.svg
:alt: A still picture
:name: fig-6

The caption.
```

<div class="play" data-figure="explorer" data-replaces="fig-6" data-q="20 −30"></div>

<div class="play" data-figure="explorer" data-robot="pp-portal"
data-controls="legend pose margins"></div>

<div class="play" data-figure="explorer" data-rule="paper" data-lit="B3" data-show=""
data-controls="task"></div>
""",
    "full": """
# Two kinds

<div class="play" data-figure="switches" data-rule="paper"></div>

<div class="play" data-figure="scale" data-rule="paper"></div>
""",
    "mounted": """
# A kind that mounts an explorer

<div class="play" data-figure="traversals" data-rule="paper"></div>
""",
    "live": '# Configuration space\n\n<div class="play" data-figure="live"></div>\n',
    "plain": "# Without a figure\n",
    "unknown": '# A kind that is not there\n\n<div class="play" data-figure="nothing"></div>\n',
}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Build a small book with hooks; return its folder and what Sphinx complained of."""
    folder = tmp_path_factory.mktemp("site")
    folder.joinpath("conf.py").write_text(CONF, encoding="utf-8")
    folder.joinpath("still.svg").write_bytes((BOOK / "_static" / "logo.svg").read_bytes())
    for name, text in PAGES.items():
        folder.joinpath(f"{name}.md").write_text(text, encoding="utf-8")
    return build_book(folder, BOOK / "_ext")


@pytest.fixture
def open_site(open_quietly, site):
    """Open pages of the small book."""

    def open_one(name="index", **options):
        options = {"viewport": {"width": 1000, "height": 900}} | options
        return open_quietly((site[0] / f"{name}.html").as_uri(), **options)

    return open_one


def own_scripts(folder, name):
    """Return the scripts of ours that a page loads, in order."""
    html = BeautifulSoup((folder / f"{name}.html").read_text(encoding="utf-8"), "html.parser")
    found = [str(tag["src"]).partition("?")[0] for tag in html.find_all("script", src=True)]
    return [address.removeprefix("_static/") for address in found if "play/" in address]


def test_a_page_with_hooks_loads_the_engine_once_then_the_data_then_the_loader(site):
    folder, _ = site
    assert own_scripts(folder, "index") == [
        "play/engine.js",
        "play/robots/minervabot-v2.js",
        "play/robots/pp-portal.js",
        "play/robots/minervabot-v2-paper.js",
        "play/short/play.js",
    ]
    assert own_scripts(folder, "plain") == []


def test_a_page_without_explorers_loads_what_its_figure_needs(site, open_site):
    assert own_scripts(site[0], "live") == [
        "play/parts_of_engine.js",
        "play/short/parts.js",
        "play/short/live_space.js",
        "play/short/live_scene.js",
        "play/short/live.js",
        "play/short/play.js",
    ]
    page = open_site("live")
    assert "in 3 pieces" in page.locator(".totals").inner_text()


@pytest.mark.parametrize("page", ["full", "mounted"])
def test_a_page_has_at_most_150_kilobytes_of_our_scripts(site, page):
    """The pages with the most of them, beside what every page of the book has."""
    static = site[0] / "_static"
    names = own_scripts(site[0], page)
    assert ("play/parts_of_engine.js" in names) == (page == "full")  # it mounts no explorer
    sizes = {name: (static / name).stat().st_size for name in names}
    everywhere = [
        file for file in (BOOK / "_static").glob("*.js") if not ONLY_LIVE.match(file.name)
    ]
    sizes |= {file.name: file.stat().st_size for file in everywhere}
    assert sum(sizes.values()) <= MOST_BYTES, sizes


def test_no_string_goes_over_the_end_of_a_line_or_looks_like_a_comment():
    """So comments can be left out line by line."""
    files = {*(BOOK / "_static" / "play").glob("*.js"), *WEB.glob("*.js")}
    for file in files:
        text = re.sub(r"/\*.*?\*/", "", file.read_text(encoding="utf-8"), flags=re.DOTALL)
        for line in text.splitlines():
            code = re.split(r"(?:^|\s)//\s", line)[0]
            assert [code.count(quote) % 2 for quote in '"`'] == [0, 0], (file.name, line)


def test_a_kind_that_is_not_there_is_complained_of(site):
    assert "no figure kind 'nothing'" in site[1]


def test_a_kind_may_be_told_more_by_python(monkeypatch, tmp_path):
    (tmp_path / "play_data").mkdir()
    (tmp_path / "play_data" / "areas.py").write_text(
        "def data(region):\n    return {'pieces': len(region.components)}\n", encoding="utf-8"
    )
    (tmp_path / "areas.js").write_text("// a kind\n", encoding="utf-8")
    with importable(BOOK / "_ext"), importable(tmp_path):
        play = importlib.import_module("play")
        monkeypatch.setattr(play, "HERE", tmp_path)
        monkeypatch.setattr(play, "SCRIPTS", tmp_path)
        made = dict(play.scripts_of({"figure": "areas"}))
    assert list(made) == [
        "play/robots/minervabot-v2.js",
        "play/data/areas-minervabot-v2.js",
        "play/short/areas.js",
    ]
    assert made["play/data/areas-minervabot-v2.js"].endswith('= {"pieces":5};\n')


def test_the_engine_is_a_script_of_one_name():
    script = Script("globalThis.window = { matchMedia: () => ({}) };")
    before = script("Object.keys(globalThis)")
    script.read(engine_script())
    assert script("Object.keys(globalThis)") == before
    names = script("Object.keys(window)")
    assert sorted(names) == ["matchMedia", "qboundEngine", "qboundFigures"]


# --- several on a page ---------------------------------------------------------------------------


def test_no_id_stands_twice_and_every_reference_has_its_part(open_site):
    page = open_site()
    assert page.locator(PICTURES).count() == 6
    ids = page.evaluate("[...document.querySelectorAll('[id]')].map((e) => e.id)")
    assert len(ids) == len(set(ids)) > 30
    missing = page.evaluate(
        """() => ["for", "aria-labelledby", "aria-describedby", "clip-path"].flatMap((name) =>
            [...document.querySelectorAll(`.play [${name}]`)]
              .map((e) => e.getAttribute(name).replace(/^url\\(#|\\)$/g, ""))
              .filter((id) => !document.getElementById(id)))"""
    )
    assert missing == []


def test_each_explorer_moves_alone_and_leaves_the_address(open_site):
    page = open_site()
    marks = page.locator(".play .handle-group")
    before = [marks.nth(i).get_attribute("transform") for i in range(6)]
    page.locator(PICTURES).first.focus()
    for _ in range(3):
        page.keyboard.press("Shift+ArrowDown")
    after = [marks.nth(i).get_attribute("transform") for i in range(6)]
    assert [a != b for a, b in zip(after, before, strict=True)] == [True] * 2 + [False] * 4
    wait_until(
        page, "document.querySelector('.play [aria-live]').textContent.includes('q2 −60.0°')"
    )
    assert "#" not in page.url


def test_a_figure_opens_as_its_hook_says(open_site):
    page = open_site()
    first, portal, paper = (page.locator(".play").nth(i) for i in range(3))
    wait_until(page, "document.querySelector('.play [aria-live]').textContent.includes('q1 20.0°')")
    assert first.locator("section").count() == 0
    assert first.locator(".legend").count() == 2
    assert portal.locator("table").count() == 1
    assert portal.locator("input[type=range]").count() == 2
    assert paper.locator(".legend").count() == 0
    assert paper.locator(".task").is_visible()
    assert paper.locator(".wall.lit, .arc.lit").count() > 0
    assert paper.locator(".workspace, .polygon").count() == 0


def test_dragging_moves_what_stands_and_makes_nothing_anew(open_site):
    page = open_site()
    svg = page.locator(PICTURES).first
    box = svg.bounding_box()
    page.evaluate(
        """() => { window.made = 0; window.moves = 0;
        const svgs = document.querySelectorAll(".play svg[role=application]");
        const note = (all) => { made += all.length; };
        for (const svg of svgs)
          new MutationObserver(note).observe(svg, { childList: true, subtree: true });
        svgs[0].addEventListener("pointermove", () => { moves += 1; }); }"""
    )
    place = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    drag(page, place, (place[0] + 60, place[1] + 90), 20)
    assert page.evaluate("window.moves") >= 10
    assert page.evaluate("window.made") == 0


# --- paper, phones, other readers ----------------------------------------------------------------


def test_the_figure_stands_for_its_picture_and_the_picture_is_printed(open_site):
    page = open_site()
    picture, figure = page.locator("#fig-6 img"), page.locator("#fig-6 .play")
    assert (picture.is_visible(), figure.is_visible()) == (False, True)
    assert page.locator("#fig-6 figcaption").last.is_visible()
    page.emulate_media(media="print")
    assert (picture.is_visible(), figure.is_visible()) == (True, False)
    assert page.locator(".play").nth(1).is_visible()  # it replaces no picture


def test_without_scripts_the_picture_stays(tabs, site):
    with tabs.lent(java_script_enabled=False) as tab:
        tab.page.goto((site[0] / "index.html").as_uri())
        assert tab.page.locator("#fig-6 img").is_visible()
        assert tab.page.locator(".play *").count() == 0


def test_a_figure_that_fails_leaves_the_picture(browser, site):
    page = browser.new_page()
    page.add_init_script(
        "Object.defineProperty(window, 'qboundRobots', { get: () => ({}), set: () => {} });"
    )
    page.goto((site[0] / "index.html").as_uri())
    settle(page)
    assert page.locator("#fig-6 img").is_visible()
    assert page.locator(".play").count() == 0
    page.close()


def test_with_reduced_motion_a_way_is_shown_in_steps(open_site):
    page = open_site(reduced_motion="reduce")
    figure = page.locator(".play").nth(2)
    page.evaluate(
        """() => { window.seen = new Set();
        const root = document.querySelectorAll(".play")[2];
        const mark = root.querySelector(".handle-group");
        root.addEventListener("qbound-pose", () => seen.add(mark.getAttribute("transform"))); }"""
    )
    figure.get_by_role("button", name="Show me a way").click()
    wait_until(
        page, "[...document.querySelectorAll('.task p')].at(0).textContent.startsWith('There')"
    )
    assert page.evaluate("window.seen.size") == 1


def test_on_a_phone_the_arm_is_in_sight_while_the_dot_is_dragged(open_site):
    page = open_site(viewport={"width": 390, "height": 664}, has_touch=True, is_mobile=True)
    page.locator(".play .status").first.evaluate("(e) => e.scrollIntoView({ block: 'start' })")
    settle(page)
    arm = page.locator(PICTURES).nth(1).bounding_box()
    assert arm["y"] + arm["height"] <= 664
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    words = page.inner_text("body").lower()
    assert re.findall(r"\b(left|right|arrow keys?)\b", words) == []


def test_the_accessibility_rules_find_nothing_in_figures(open_site):
    page = open_site()
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        settle(page)
        assert broken_rules(page, ".play") == [], theme


def test_a_pose_is_kept_when_the_width_changes(open_site):
    page = open_site()
    page.locator(PICTURES).first.focus()
    page.keyboard.press("ArrowRight")
    words = page.locator(".play .status").first.inner_text()
    page.set_viewport_size({"width": 420, "height": 800})
    settle(page)
    boxes = [page.locator(PICTURES).nth(i).bounding_box() for i in (0, 1)]
    assert boxes[1]["y"] > boxes[0]["y"] + boxes[0]["height"] - 1
    assert_allclose(np.diff([b["width"] for b in boxes]), 0, atol=1)
    assert page.locator(".play .status").first.inner_text() == words
