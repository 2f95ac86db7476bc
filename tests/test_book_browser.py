"""What a browser makes of the built book, opened from the file system, without a network."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe

from support.browser import (
    FAMILIES,
    HTML,
    chapter_page,
    eventually,
    in_every_family,
    open_page,
    refuse_remote,
    settle,
)

PAGES = sorted(str(file.relative_to(HTML)) for file in HTML.rglob("*.html"))
PAGES = [page for page in PAGES if not page.startswith("_static")] or ["index.html"]
WIDTHS = {"wide screen": 1280, "phone": 390}
THEMES = ["light", "dark"]

LAYOUT = [
    "lostToTheRight",
    "wideBoxesWithoutHint",
    "tornPunctuation",
    "cutFormulas",
    "brokenWords",
    "smallPanels",
]
QUESTIONS = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")


@dataclass
class Seen:
    """What was found wrong on one page; everything empty is a good page."""

    requests: list[str] = field(default_factory=list)
    console: list[str] = field(default_factory=list)
    formulas: list[str] = field(default_factory=list)
    images: list[str] = field(default_factory=list)
    layout: dict[tuple[str, str], list[str]] = field(default_factory=dict)
    faint: dict[str, list[str]] = field(default_factory=dict)


@dataclass
class Tab:
    """A page that goes from one to the next: a new one for each would take longer than they do."""

    page: Any
    requests: list[str] = field(default_factory=list)
    console: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def tab(browser: Any) -> Iterator[Tab]:
    tab = Tab(browser.new_page(reduced_motion="reduce"))
    refuse_remote(tab.page, tab.requests)
    tab.page.on("pageerror", lambda error: tab.console.append(str(error)))
    tab.page.on("console", lambda m: m.type == "error" and tab.console.append(m.text))
    yield tab
    tab.page.close()


@pytest.fixture(scope="module", params=PAGES)
def seen(tab: Tab, request: pytest.FixtureRequest) -> Seen:
    """Open one page once; look at it at both widths, in every family, and in both themes."""
    tab.requests.clear()
    tab.console.clear()
    seen, page = Seen(), tab.page
    page.set_viewport_size({"width": WIDTHS["wide screen"], "height": 900})
    open_page(page, request.param)
    page.add_script_tag(content=QUESTIONS)
    page.evaluate("openEverything()")
    for name, width in WIDTHS.items():
        page.set_viewport_size({"width": width, "height": 900})
        for family in in_every_family(page):
            for question in LAYOUT:
                answers = page.evaluate(f"{question}()")
                found = seen.layout.setdefault((question, name), [])
                found += [f"{family}: {answer}" for answer in answers]
    seen.formulas = page.evaluate("unshownFormulas()")
    seen.images = page.evaluate("badImages()")
    for theme in THEMES:
        seen.faint[theme] = page.evaluate("faintText", theme)
    seen.requests, seen.console = [*tab.requests], [*tab.console]
    return seen


def test_a_page_asks_nothing_of_the_network(seen):
    assert seen.requests == []


def test_the_console_shows_no_error(seen):
    assert seen.console == []


def test_every_formula_is_typeset_without_error(seen):
    assert seen.formulas == []


def test_every_image_loads_and_has_words(seen):
    assert seen.images == []


@pytest.mark.parametrize("width", WIDTHS)
def test_nothing_leaves_the_page(seen, width):
    assert seen.layout["lostToTheRight", width] == []


@pytest.mark.parametrize("width", WIDTHS)
def test_what_scrolls_shows_that_it_does_and_the_keyboard_reaches_it(seen, width):
    assert seen.layout["wideBoxesWithoutHint", width] == []


@pytest.mark.parametrize("width", WIDTHS)
def test_a_line_begins_with_no_stop_and_ends_with_no_open_bracket(seen, width):
    assert seen.layout["tornPunctuation", width] == []


def test_a_wide_screen_cuts_no_formula_of_a_line(seen):
    assert seen.layout["cutFormulas", "wide screen"] == []


@pytest.mark.parametrize("width", WIDTHS)
def test_titles_of_the_neighbouring_pages_break_between_words(seen, width):
    assert seen.layout["brokenWords", width] == []


@pytest.mark.parametrize("width", WIDTHS)
def test_panels_side_by_side_are_large_enough_to_read(seen, width):
    assert seen.layout["smallPanels", width] == []


@pytest.mark.parametrize("theme", THEMES)
def test_text_stands_out_from_its_ground(seen, theme):
    assert seen.faint[theme] == []


def test_all_but_code_is_set_in_families_of_three_widths(tab):
    open_page(tab.page, "index.html")
    tab.page.add_script_tag(content=QUESTIONS)
    seen, heights = [], []
    for _ in in_every_family(tab.page):
        seen.append(tab.page.evaluate("familiesOfText()"))
        heights.append(tab.page.evaluate("document.querySelector('.bd-article').offsetHeight"))
    assert seen == [[f'"test {family}"'] for family in FAMILIES]
    assert heights[0] < heights[1] < heights[2]


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    page = browser.new_page(color_scheme="dark")
    yield page
    page.close()


def test_a_reader_who_prefers_the_dark_gets_it(page):
    open_page(page, "index.html")
    assert page.evaluate("() => document.documentElement.dataset.theme") == "dark"


def test_the_table_of_traces_fits_a_wide_screen(page):
    page.set_viewport_size({"width": WIDTHS["wide screen"], "height": 900})
    open_page(page, "traceability.html")
    boxes = page.locator(".pst-scrollable-table-container")
    assert boxes.count() == 4
    assert boxes.evaluate_all("all => all.filter((b) => b.scrollWidth > b.clientWidth)") == []


def test_a_search_from_any_page_finds_the_word(page):
    complaints: list[str] = []
    page.on("console", lambda m: m.type == "error" and complaints.append(m.text))
    open_page(page, "index.html")
    page.keyboard.press("Control+k")
    page.keyboard.type("boundary")
    page.keyboard.press("Enter")
    page.wait_for_url("**/search.html?q=boundary*")
    results = page.locator("#search-results li a")
    results.first.wait_for()
    found = results.all_inner_texts()
    assert any("oundary" in title for title in found)
    assert complaints == []


def test_a_chapter_downloads_its_notebook(page):
    chapter = sorted(HTML.glob("chapters/*.html"))[0]
    open_page(page, f"chapters/{chapter.name}")
    with page.expect_download() as download:
        page.click(".notebook-line a[download]")
    assert download.value.suggested_filename == f"{chapter.stem}.ipynb"
    assert '"cells"' in download.value.path().read_text(encoding="utf-8")


def bottom(part: Any) -> float:
    box = part.bounding_box()
    return box["y"] + box["height"]


def test_the_explorer_fits_its_frame_and_follows_the_theme(page):
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda m: m.type == "error" and complaints.append(m.text))
    frame, inside = page.locator("iframe.explorer"), page.frame_locator("iframe.explorer")
    last = inside.locator("#full-page")
    for width in WIDTHS.values():
        page.set_viewport_size({"width": width, "height": 900})
        open_page(page, "explore.html")
        inside.locator("#status").wait_for()
        eventually(page, lambda: 0 <= bottom(frame) - bottom(last) < 40)
    ground = "() => getComputedStyle(document.documentElement).backgroundColor"
    dark = inside.locator("#status").evaluate(ground)
    page.evaluate("() => { document.documentElement.dataset.theme = 'light'; }")
    eventually(page, lambda: inside.locator("#status").evaluate(ground) != dark)
    assert complaints == []


def test_a_reader_moves_the_arm_in_the_book(page):
    page.set_viewport_size({"width": 1280, "height": 900})
    open_page(page, "explore.html")
    inside = page.frame_locator("iframe.explorer")
    before = inside.locator("#plane .handle-group").get_attribute("transform")
    inside.locator("#joints").focus()
    for _ in range(5):
        page.keyboard.press("Shift+ArrowRight")
    after = inside.locator("#plane .handle-group").get_attribute("transform")
    assert after != before
    inside.locator("#task-go").click()
    inside.get_by_text("There. On the way you crossed").wait_for()


# axe takes a table's head for empty when its words are a formula: it does not read MathML.
FORMULA_HEADS = {"exclude": [["th:has(mjx-container)"]]}

SAMPLE = [  # one page of each kind, and the longest
    "index.html",
    "explore.html",
    chapter_page("vector_labelling"),
    chapter_page("theorem_2"),
    chapter_page("every_region"),
    chapter_page("what_holds"),
    "notation.html",
    "traceability.html",
    "commands.html",
    "cite.html",
    "generated/qbound.forms.circle.html",
]


COLOURS = {"runOnly": ["color-contrast", "link-in-text-block"]}
LOOKS = {  # a theme is nothing but colours, and those of a phone are asked for on every page above
    "wide screen": ("light", {}),
    "phone": ("light", {}),
    "wide screen in the dark": ("dark", COLOURS),
}


@pytest.fixture(scope="module", params=SAMPLE)
def broken_rules(tab: Tab, request: pytest.FixtureRequest) -> dict[str, list[Any]]:
    """Open one page once; ask axe at both widths and in the dark."""
    found, page = {}, tab.page
    page.set_viewport_size({"width": WIDTHS["wide screen"], "height": 900})
    open_page(page, request.param)
    for look, (theme, rules) in LOOKS.items():
        page.emulate_media(color_scheme=theme)
        page.set_viewport_size({"width": WIDTHS[look.split(" in ")[0]], "height": 900})
        settle(page)
        assert page.evaluate("document.documentElement.dataset.theme") == theme
        answer = Axe().run(page, context=FORMULA_HEADS, options=rules).response
        assert answer["passes"]
        found[look] = [
            (rule["id"], [node["html"][:120] for node in rule["nodes"]])
            for rule in answer["violations"]
        ]
    return found


@pytest.mark.parametrize("look", LOOKS)
def test_a_page_breaks_no_rule_of_accessibility(broken_rules, look):
    assert broken_rules[look] == []


def test_a_solution_is_folded_until_a_reader_asks(page):
    open_page(page, chapter_page("theorem_2"))
    solution = page.locator("#exercises .admonition.dropdown").first
    words = solution.locator("p:not(.admonition-title)").first
    assert not words.is_visible()
    solution.locator(".admonition-title").click()
    words.wait_for(state="visible")
