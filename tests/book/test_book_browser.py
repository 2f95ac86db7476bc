"""What a browser makes of the built book, opened from the file system, without a network."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest

from engine_support.browser import (
    BUT_COLOURS,
    COLOURS,
    Tab,
    broken_rules,
    chapter_page,
    eventually,
    in_every_family,
    in_its_own_family,
    open_page,
    settle,
)
from engine_support.pages import HTML

PAGES = sorted(str(file.relative_to(HTML)) for file in HTML.rglob("*.html"))
PAGES = [page for page in PAGES if not page.startswith("_static")] or ["index.html"]
API = [page for page in PAGES if page.startswith("generated/")]
# Pages of the API are all made in one way, of docstrings: the longest have whatever one can have.
LONGEST = sorted(API, key=lambda page: (HTML / page).stat().st_size)[-6:]
SAMPLE = [  # one page of each kind, and the longest: axe looks at these
    "index.html",
    "explore.html",
    chapter_page("vector_labelling"),
    chapter_page("theorem_2"),
    "claims.html",
    "notation.html",
    "traceability.html",
    "commands.html",
    "generated/cspace.forms.harmonic.html",
]
# These first: pytest tells a page by its place in the list, and opens those of one place once.
OTHERS = [page for page in PAGES if page not in API or page in LONGEST]
PAGES = SAMPLE + [page for page in OTHERS if page not in SAMPLE]
WIDTHS = {"wide screen": 1280, "phone": 390}
# A layout is the dearest question: each width has the widest letters, and one of the two others.
WORN = {"wide screen": ("narrow", "wide"), "phone": ("DejaVu Sans", "wide")}
THEMES = ["light", "dark"]

LAYOUT = {
    "lostToTheRight": "nothing leaves the page",
    "wideBoxesWithoutHint": "what scrolls shows that it does, and the keyboard reaches it",
    "tornPunctuation": "a line begins with no stop and ends with no open bracket",
    "cutFormulas": "a wide screen cuts no formula of a line",
    "brokenNames": "an id, a numbered name, and a number with its unit stay on one line",
    "smallPanels": "panels side by side are large enough to read",
}
QUESTIONS = (
    f"(0, eval)({json.dumps(Path(__file__).with_suffix('.js').read_text(encoding='utf-8'))})"
)
"""Makes the questions known to a page, whose policy refuses a script that is added to it."""


# What the extensions call will leave Sphinx one day: their matter, not this book's.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*Sphinx:DeprecationWarning", "ignore:.*Sphinx:PendingDeprecationWarning"
)


@pytest.fixture(scope="module")
def tab(tabs: Any) -> Iterator[Tab]:
    with tabs.lent(reduced_motion="reduce") as tab:
        yield tab


Faults = dict[str, list[Any]]
"""What was found wrong on a page, by the claim that does not hold."""


@pytest.fixture(scope="module", params=PAGES)
def faults(tab: Tab, request: pytest.FixtureRequest) -> Faults:
    """Open one page once; look at it at both widths, in all families, and in both themes."""
    tab.requests.clear()
    tab.complaints.clear()
    page = tab.page
    look(page, "light", "wide screen")
    open_page(page, request.param)
    page.evaluate(QUESTIONS)
    page.evaluate("openEverything()")
    faults: Faults = {
        "every formula is typeset without error": page.evaluate("unshownFormulas()"),
        "every image loads and has words": page.evaluate("badImages()"),
    }
    page.evaluate("emptyFormulas()")
    for width in WIDTHS:
        look(page, "light", width)
        for family in in_every_family(page, WORN[width]):
            for question, claim in LAYOUT.items():
                if question != "cutFormulas" or width == "wide screen":
                    faults[f"{claim} ({width}, {family})"] = page.evaluate(f"{question}()")
    for theme in THEMES:
        found = page.evaluate("faintText", theme)
        faults[f"text stands out from its ground ({theme})"] = found
    if request.param in SAMPLE:
        faults |= ask_axe(page)
    faults["it asks nothing of the network"] = [*tab.requests]
    faults["the console shows no error"] = tab.said("error")
    return faults


def look(page: Any, theme: str, width: str) -> None:
    page.emulate_media(color_scheme=theme)
    page.set_viewport_size({"width": WIDTHS[width], "height": 900})


# axe takes a table's head for empty when its words are a formula: it does not read MathML.
FORMULA_HEADS = {"exclude": [["th:has(mjx-container)"]]}

LOOKS: dict[str, tuple[str, str, dict[str, Any]]] = {
    "wide screen": ("light", "wide screen", BUT_COLOURS),
    "phone": ("light", "phone", BUT_COLOURS),
    # Each colour is looked at once in each theme; those of a phone are, on every page above.
    "colours": ("light", "wide screen", {"runOnly": COLOURS}),
    "colours in the dark": ("dark", "wide screen", {"runOnly": COLOURS}),
}


def ask_axe(page: Any) -> Faults:
    """Ask axe about a page that has been asked all else: parts of it are taken away."""
    in_its_own_family(page)
    page.evaluate("document.documentElement.dataset.theme = 'light'")
    page.evaluate("keepOneOfEachRow()")
    found = {}
    for name, (theme, width, rules) in LOOKS.items():
        if name == "colours":
            page.evaluate("keepThreeOfEachKind()")
        look(page, theme, width)
        settle(page)
        assert page.evaluate("document.documentElement.dataset.theme") == theme
        found[f"no rule of accessibility is broken ({name})"] = broken_rules(
            page, FORMULA_HEADS, **rules
        )
    return found


def test_a_page_is_whole_and_quiet_and_reads_well_on_both_screens_in_both_themes(faults):
    assert {claim: found for claim, found in faults.items() if found} == {}


@pytest.fixture
def page(tabs: Any) -> Iterator[Any]:
    with tabs.lent(color_scheme="dark") as tab:
        yield tab.page


def test_a_search_from_any_page_finds_the_word(page):
    open_page(page, "index.html")
    page.keyboard.press("Control+k")
    page.keyboard.type("boundary")
    page.keyboard.press("Enter")
    page.wait_for_url("**/search.html?q=boundary*")
    results = page.locator("#search-results li a")
    results.first.wait_for()
    assert any("oundary" in title for title in results.all_inner_texts())
    results.first.click()  # the words are marked there, and on no other page
    eventually(page, lambda: page.locator("span.highlighted").count() > 0)
    page.goto(f"{(HTML / 'search.html').as_uri()}?q=boundary")
    results.first.wait_for()
    open_page(page, "notation.html")
    assert page.locator("span.highlighted").count() == 0


def test_a_chapter_downloads_its_notebook(page):
    chapter = sorted(HTML.glob("chapters/*.html"))[0]
    open_page(page, f"chapters/{chapter.name}")
    with page.expect_download() as download:
        page.click(".notebook-line a[download]")
    assert download.value.suggested_filename == f"{chapter.stem}.ipynb"
    assert '"cells"' in download.value.path().read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("index.html", "The paper"),
        (chapter_page("region"), "The paper"),
        (chapter_page("proof"), "Beyond the paper"),
        ("robot_file.html", "For the record"),
    ],
)
def test_the_contents_show_the_pages_of_one_part_and_no_more_than_twenty(page, name, part):
    open_page(page, name)
    links = page.locator(".bd-sidebar-primary nav.bd-links a")
    shown = [link.inner_text() for link in links.all() if link.is_visible()]
    parts = ["The paper", "Beyond the paper", "For the record"]
    assert [text for text in shown if text in parts] == parts
    assert 8 < len(shown) <= 20
    assert shown[shown.index(part) + 1] not in parts
    assert shown[-1] == parts[-1] or part == parts[-1]
    assert page.locator(".bd-sidebar-primary [href*='_here.html']").count() == 0  # needs Python


@pytest.mark.parametrize("name", ["try_here", "check_here"])
def test_a_desk_in_a_frame_tells_its_height_and_follows_the_theme(page, name):
    open_page(page, f"{name}.html")
    frame, inside = page.locator("iframe"), page.frame_locator("iframe").locator("html")
    body = page.frame_locator("iframe").locator("body")
    eventually(
        page, lambda: 0 <= frame.bounding_box()["height"] - body.bounding_box()["height"] < 40
    )
    for theme in ("dark", "light"):
        page.evaluate("(theme) => { document.documentElement.dataset.theme = theme; }", theme)
        eventually(page, lambda theme=theme: inside.get_attribute("class") == theme)


@pytest.mark.parametrize(
    ("chapter", "word"),
    [("boundary_functions", ".lights.b4"), ("theorem_2", ".lights[data-light=proof]")],
)
def test_words_of_a_chapter_light_the_curve_that_they_name(page, chapter, word):
    page.set_viewport_size({"width": 1280, "height": 900})
    open_page(page, chapter_page(chapter))
    lit = page.locator("live-figure svg .lit")
    assert lit.count() == 0
    page.locator(f".bd-article {word}").first.hover()
    eventually(page, lambda: lit.count() > 0)
    page.mouse.move(1, 1)
    eventually(page, lambda: lit.count() == 0)


# --- cards ----------------------------------------------------------------------------------------

# A page that links to one of its formulas.
LINKING = chapter_page("boundary_functions")
TO_EQUATION = "article p > a[href*='#equation-eq-29']"
CARD = "#hover-card"


def typeset(page: Any) -> bool:
    """Tell whether every formula of the card is set and has a width."""
    return page.evaluate(
        "() => [...document.querySelectorAll('#hover-card .math')]"
        ".every((f) => f.querySelector('svg')?.getBoundingClientRect().width > 0)"
    )


def is_in_window(page: Any) -> bool:
    return page.evaluate(
        "() => { const { left, right } = document.querySelector('#hover-card')"
        ".getBoundingClientRect(); return left >= 0 && right <= innerWidth; }"
    )


def test_a_pointer_on_a_reference_shows_the_formula_and_may_move_into_it(page):
    open_page(page, LINKING)
    page.locator(TO_EQUATION).first.hover()
    page.locator(CARD).wait_for()
    eventually(page, lambda: typeset(page))
    assert is_in_window(page)
    page.locator(CARD).hover()
    assert page.evaluate("waiting") is None  # nothing will take it away
    page.emulate_media(media="print")
    assert not page.locator(CARD).is_visible()
    page.emulate_media(media="screen")
    page.mouse.move(1, 1)
    page.locator(CARD).wait_for(state="hidden")


def test_the_keyboard_shows_a_card_and_escape_takes_it_away(page):
    open_page(page, LINKING)
    page.keyboard.press("Tab")
    link, card = page.locator(TO_EQUATION).first, page.locator(CARD)
    link.focus()
    card.wait_for()
    assert link.get_attribute("aria-describedby") == "hover-card"
    page.keyboard.press("Escape")
    card.wait_for(state="hidden")
    assert link.get_attribute("aria-describedby") is None
    page.keyboard.press("Enter")
    page.wait_for_url("**#equation-eq-29")


@pytest.mark.parametrize("theme", THEMES)
def test_a_card_breaks_no_rule_of_accessibility_and_sets_its_formulas_itself(page, theme):
    """The page of the commands has no formula, and loads MathJax for that of a card only."""
    page.emulate_media(color_scheme=theme)
    open_page(page, "commands.html")
    assert page.evaluate("window.MathJax") is None
    link = f"<p><a href='{chapter_page('theorem_2')}#equation-eq-31'>(31)</a></p>"
    page.evaluate(
        "(link) => document.querySelector('article h1').insertAdjacentHTML('afterend', link)", link
    )
    page.get_by_text("(31)").hover()
    page.locator(f"{CARD} svg").first.wait_for()
    eventually(page, lambda: typeset(page))
    assert broken_rules(page, {"include": [[CARD], ["p:has([aria-describedby])"]]}) == []


@pytest.fixture
def phone(tabs: Any) -> Iterator[Any]:
    size = {"width": WIDTHS["phone"], "height": 800}
    with tabs.lent(viewport=size, has_touch=True, is_mobile=True) as tab:
        yield tab.page


def test_a_finger_shows_the_card_first_and_a_second_tap_follows_the_link(phone):
    open_page(phone, LINKING)
    for goes_on in (phone.get_by_text("Go to Equation 29"), phone.locator(TO_EQUATION).first):
        phone.locator(TO_EQUATION).first.tap()
        phone.locator(CARD).wait_for()
        eventually(phone, lambda: typeset(phone))
        assert is_in_window(phone)
        assert "#" not in phone.url
        phone.locator("article h1").tap()
        phone.locator(CARD).wait_for(state="hidden")
        phone.locator(TO_EQUATION).first.tap()
        phone.locator(CARD).wait_for()
        goes_on.tap()
        phone.wait_for_url("**#equation-eq-29")
        open_page(phone, LINKING)
    phone.locator("article a[href='#exercises']").first.evaluate("(a) => a.classList.value = ''")
    phone.locator("article a[href='#exercises']").first.tap()  # it has no card
    phone.wait_for_url("**#exercises")


@pytest.mark.parametrize(
    ("words", "name", "address"),
    [
        ("Table 6", "Table 6", "#tab-6"),
        ("S-20.1", "S-20.1", "#s-20-1"),
        ("Eq. (29)", "Equation 29", "#equation-eq-29"),
        ("Theorem 2", "Theorem 2", "#thm:2"),
        ("aspects", "Aspect", "#term-Aspect"),
        ("revolute joint", "Prismatic joint", "#term-Prismatic-joint-revolute-joint"),
        ("find_region", "", "generated/"),
    ],
)
def test_a_search_for_a_name_leads_to_its_bearer_first(page, words, name, address):
    page.goto(f"{(HTML / 'search.html').as_uri()}?q={quote(words)}")
    first = page.locator("#search-results li a").first
    first.wait_for()
    assert first.inner_text().startswith(name)
    assert address in first.get_attribute("href")


@pytest.mark.parametrize("words", ["singular", "workspace area", "certificate"])
def test_a_search_for_words_leads_to_chapters_before_the_api_and_shows_excerpts(page, words):
    page.goto(f"{(HTML / 'search.html').as_uri()}?q={quote(words)}")
    links = page.locator("#search-results li a")
    eventually(page, lambda: "finished" in page.locator("#search-results").inner_text())
    found = [links.nth(k).get_attribute("href") for k in range(links.count())]
    is_api = ["generated/" in address for address in found]
    chapters = [k for k, address in enumerate(found) if address.startswith("chapters/")]
    assert chapters
    assert max(chapters) < is_api.index(True)
    excerpts = page.locator("#search-results li p.context").all_inner_texts()
    assert any(words.split()[0] in excerpt.lower() for excerpt in excerpts)


@pytest.mark.parametrize(
    ("words", "formula"), [("wave", "a cos q2"), ("amplitude", "√(x1,2² + z1,2²)")]
)
def test_an_excerpt_has_its_formulas_in_letters(page, words, formula):
    page.goto(f"{(HTML / 'search.html').as_uri()}?q={quote(words)}")
    eventually(page, lambda: "finished" in page.locator("#search-results").inner_text())
    excerpts = page.locator("#search-results li p.context").all_inner_texts()
    assert any(formula in excerpt for excerpt in excerpts)
    assert [excerpt for excerpt in excerpts if "\\" in excerpt or "frac" in excerpt] == []


def test_an_address_of_a_result_unfolds_its_table(page):
    page.goto((HTML / "results.html").as_uri())
    row = page.locator(".results-table tbody tr").last
    name = row.get_attribute("id")
    page.goto(f"{(HTML / 'results.html').as_uri()}#{name}")
    page.locator(f"[id='{name}']").wait_for()
    assert page.locator(f"[id='{name}']").is_visible()
