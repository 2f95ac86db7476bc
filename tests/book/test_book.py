"""The built pages, read as text: complete, self-contained, and well formed."""

import json
import os
import re
from collections import Counter
from copy import copy
from functools import cache
from pathlib import Path
from unittest import mock
from xml.etree import ElementTree

import pytest
from bs4 import BeautifulSoup

from cspace.cli import command_parsers
from engine_support.pages import HTML, ids, read
from engine_support.scripts import importable
from lizarraga2025.commands import command_parsers as companions
from support.trial_book import BOOK, ROOT, TRIAL_INDEX, build_trial

# What the extensions call will leave Sphinx one day: their matter, not this book's.
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*Sphinx:DeprecationWarning", "ignore:.*Sphinx:PendingDeprecationWarning"
)

PAGES = sorted(str(file.relative_to(HTML)) for file in HTML.rglob("*.html"))
PAGES = [page for page in PAGES if not page.startswith("_static")] or ["index.html"]
API_PAGES = [page for page in PAGES if page.startswith("generated/")] or ["index.html"]
NOTEBOOKS = sorted(path.stem for path in (ROOT / "notebooks").glob("*.ipynb"))


def faults_of(name: str) -> dict[str, list[str]]:
    """Return what is wrong with a page, by the claim that does not hold."""
    page = read(name)
    uses = Counter(tag["id"] for tag in page.find_all(id=True))
    links = page.select("article a[href]")
    inside = [link["href"].partition("#") for link in links if "internal" in link.get("class", ())]
    named = {f"{resolved(name, file)}#{a}" for file, _, a in inside if NAMED.match(a)}
    drawn = [image["src"] for image in page.select("article img")]
    complaints = page.select(".output.traceback, .output.stderr")
    # the print version repeats the heading
    [heading, *more] = {h.get_text().rstrip("#").strip() for h in page.select("main h1")}
    return {
        "it has one heading": more,
        "the title has the heading's first word": [
            word for word in [heading.split()[0]] if word not in page.title.get_text()
        ],
        "every figure is drawn in lines": [
            src for src in drawn if not src.partition("#")[0].endswith(".svg")
        ],
        "an id is used once": [each for each, times in uses.items() if times > 1],
        "a link inside the book leads somewhere": [
            link["href"] for link in links if is_lost(link["href"], name)
        ],
        "no cell failed or complained": [e.get_text()[:200] for e in complaints],
        "whatever has a name has a card": sorted(named - cards().keys()),
    }


def is_lost(address: str, page: str) -> bool:
    """Tell whether a link of a page leads to nothing in the book."""
    target, _, anchor = address.partition("#")
    if re.match(r"^\w+:", address) or target.startswith("//"):
        return False
    led_to = resolved(page, target)
    if not (HTML / led_to).is_file():
        return True
    return bool(anchor) and anchor not in ids(led_to)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_whole_and_leads_somewhere(page):
    assert {claim: found for claim, found in faults_of(page).items() if found} == {}


CHAPTERS = [page for page in PAGES if page.startswith("chapters/")] or ["index.html"]


@pytest.mark.parametrize("page", CHAPTERS)
def test_a_section_has_one_box_of_code_and_exercises_say_where_they_run(page):
    boxes = [box.find_parent("section")["id"] for box in read(page).select("details.above-input")]
    assert [name for name, times in Counter(boxes).items() if times > 1] == []
    for box in read(page).select("details.above-input"):  # in its section's own text
        assert box.parent.find_previous_siblings("section") == []
    assert "Not filled in yet" not in read(page).select_one("article").get_text()
    for section in read(page).select("section#exercises"):
        assert not section.select("details") or "notebook" in section.p.get_text()
    [told] = read(page).select("meta[name=description]")
    assert 40 < len(told["content"]) < 230


def test_every_notebook_is_a_chapter():
    chapters = [Path(page).stem for page in PAGES if page.startswith("chapters/")]
    assert read("index.html")
    assert chapters == NOTEBOOKS


FIELDS = {"Parameters", "Attributes", "Returns", "Raises", "Warns"}  # not "Type", "Variables"


@pytest.mark.parametrize("page", API_PAGES)
def test_a_page_of_the_api_reads_as_its_docstrings_do(page):
    """Links are no words of types, fields are called as there, and no formula is left as TeX."""
    links = [link.get_text() for link in read(page).select("article dl a.reference.internal")]
    assert "shape" not in links
    fields = {field.get_text() for field in read(page).select("dl.field-list > dt")}
    assert {name.rstrip(":") for name in fields} <= FIELDS
    article = copy(read(page).select_one("article"))
    for known in article.select("code, pre, .math, .sig, script"):  # examples are code
        known.decompose()
    assert re.findall(r"\S*(?:\w_\{|\w\^)\S*", article.get_text()) == []


def test_a_wide_picture_has_a_box_in_which_it_scrolls():
    pages = [read(page) for page in PAGES if page.startswith("chapters/")]
    boxed = {image["src"] for page in pages for image in page.select(".wide-figure > img")}
    everywhere = {image["src"] for page in pages for image in page.select("article img")}
    wide = {src for src in everywhere if "#" not in src and inches(HTML / "chapters" / src) > 6.3}
    assert wide == boxed != set()


VIEW = re.compile(r"(.+)#svgView\(viewBox\(([\d.]+),([\d.]+),([\d.]+),([\d.]+)\)\)")
LETTER = re.compile(r'transform="translate\(([\d.]+) ([\d.]+)\)[^"]*scale')


def test_the_panels_of_a_phone_are_views_of_the_picture_and_leave_out_none_of_its_texts():
    pages = [read(page) for page in PAGES if page.startswith("chapters/")]
    boxes = [box for page in pages for box in page.select(".panels")]
    assert boxes
    for box in boxes:
        [whole] = box.find_previous_sibling(class_="has-panels").find_all("img")
        views = [VIEW.fullmatch(image["src"]) for image in box.find_all("img")]
        assert {view[1] for view in views} == {whole["src"]}
        parts = [tuple(map(float, view.groups()[1:])) for view in views]
        texts = LETTER.findall((HTML / "chapters" / whole["src"]).read_text("utf-8"))
        assert texts
        for x, y in (map(float, place) for place in texts):
            assert any(a - 0.1 <= x <= a + w and b <= y <= b + h for a, b, w, h in parts)


def inches(svg: Path) -> float:
    """Return the width of a picture as the SVG's root states it."""
    root = ElementTree.parse(svg).getroot()
    return float(root.get("width", "0").removesuffix("pt")) / 72


# --- cards ----------------------------------------------------------------------------------------

NAMED = re.compile(r"(equation|fig|tab|term)-|thm|(e|b|t|f|s|th)-[0-9]")


@cache
def cards() -> dict[str, dict[str, str]]:
    text = (HTML / "_static" / "cards.js").read_text(encoding="utf-8")
    return json.loads(text.removeprefix("var bookCards = ").removesuffix(";\n"))


def resolved(page: str, file: str) -> str:
    """Return the page that a link on another leads to."""
    return os.path.normpath(Path(page).parent / file).replace(os.sep, "/") if file else page


def test_a_card_says_what_its_kind_should():
    by_name = {card["name"]: card["html"] for card in cards().values()}
    shown = BeautifulSoup(by_name["E-34"], "html.parser")
    assert shown.select_one(".verdict").get_text() == "needs correction"
    assert "atan2" in shown.get_text()
    assert not shown.select("details, .ledger-evidence")
    assert r"\beta_{7,3}" in by_name["Equation 29"]
    assert "<img" in by_name["Figure 7"]
    assert "<td" in by_name["Table 6"]
    assert "nowhere singular" in by_name["Aspect"]
    assert "Lizarraga" in by_name["Reference [1]"]
    assert "satisfy" in by_name["Theorem 2"]


def test_a_card_is_content_only_and_its_pictures_are_there():
    for address, card in cards().items():
        shown = BeautifulSoup(card["html"], "html.parser")
        assert shown.get_text().strip() or shown.img, address
        assert shown.select("a, script, [id], [tabindex]") == [], address
        assert [i["src"] for i in shown.find_all("img") if not (HTML / i["src"]).exists()] == []


@pytest.fixture(scope="module")
def published(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Return the links of a chapter whose repository is known."""
    html = build_trial(tmp_path_factory.mktemp("published"), "https://github.com/someone/qbound")
    page = BeautifulSoup((html / "chapters" / "01_trial.html").read_text("utf-8"), "html.parser")
    return [link["href"] for link in page.select("a[href]")]


SOMEONE = "someone/qbound"
TRIAL = "notebooks/01_trial"


@pytest.mark.parametrize(
    "address",
    [
        f"https://mybinder.org/v2/gh/{SOMEONE}/main?urlpath=lab/tree/{TRIAL}.ipynb",
        f"https://colab.research.google.com/github/{SOMEONE}/blob/main/{TRIAL}.ipynb",
        f"https://github.com/{SOMEONE}/edit/main/{TRIAL}.md",
        f"https://github.com/{SOMEONE}",
    ],
)
def test_with_an_address_a_chapter_leads_to_its_repository(published, address):
    assert address in published


NUMBERS = """
It is {result}`region:vertex.1[0] | .1f`. It is {result}`region:largest_scale | .3f`.
"""


def write_results(folder: Path) -> None:
    recorded = {"id": "vertex.1", "value": [-94.0734, 3.0], "unit": "deg"}
    pure = {"id": "largest_scale", "value": 0.96403, "unit": "1"}
    (folder / "results").mkdir()
    content = json.dumps({"results": [recorded, pure]})
    (folder / "results" / "region.json").write_text(content, encoding="utf-8")


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> dict[str, BeautifulSoup]:
    """Front page and chapter of a book without an address."""
    folder = tmp_path_factory.mktemp("trial")
    write_results(folder)
    index = f"{TRIAL_INDEX}{NUMBERS}\n```{{commands}}\n```\n"
    html = build_trial(folder, "", index)
    places = {"index": html / "index.html", "chapter": html / "chapters" / "01_trial.html"}
    return {
        name: BeautifulSoup(file.read_text("utf-8"), "html.parser") for name, file in places.items()
    }


def test_without_an_address_no_link_needs_one(trial):
    text = str(trial["chapter"])
    assert re.findall(r"mybinder|colab\.research|github\.com|/edit/|issues/new", text) == []


def test_the_page_of_the_command_is_its_own_help(trial):
    """Each command has a section whose text is what ``--help`` prints, to the letter."""
    page = trial["index"]
    blocks = [block.get_text() for block in page.select("section pre")]
    with importable(BOOK / "_ext"):
        from book_pages import HELP_WIDTH
    with mock.patch.dict(os.environ, COLUMNS=HELP_WIDTH, NO_COLOR="1"):
        names = {}
        for name, parser in (command_parsers() | companions()).items():
            names.setdefault(parser, name)  # a second name has the same help
        expected = [parser.format_help() for parser in names]
    assert [block.strip() for block in blocks] == [text.strip() for text in expected]
    titles = [title.next_element for title in page.select("section section h2")]
    assert titles == [*names.values()]


def test_a_page_writes_a_recorded_number_rounded_and_with_its_unit_if_it_has_one(trial):
    assert "It is −94.1°. It is 0.964." in trial["index"].get_text()


@pytest.mark.parametrize(
    ("index", "complaint"),
    [
        (TRIAL_INDEX.replace("misprint", "plausible"), "unknown verdict 'plausible'"),
        (f"{TRIAL_INDEX}\n{{result}}`region:no_scale`\n", "region.json has no no_scale"),
    ],
)
def test_a_verdict_outside_the_ledger_or_a_number_that_is_not_recorded_stops_the_build(
    tmp_path, index, complaint
):
    write_results(tmp_path)
    with pytest.raises(AssertionError, match=complaint):
        build_trial(tmp_path, "", index)


# --- numbers on pages that are no chapters --------------------------------------------------------


@pytest.mark.parametrize(
    ("wanted", "complaint"),
    [
        ("region:smallest_scale | .3f", "region.json has no smallest_scale"),
        ("regions:largest_scale | .3f", "No such file"),
        ("largest_scale", "write FILE:ID"),
        ("region:vertex.1 | .3f", "unsupported format"),
        ("region:vertex.1[2] | .3f", "index out of range"),
    ],
)
def test_a_number_that_is_not_recorded_is_refused(tmp_path, wanted, complaint):
    write_results(tmp_path)
    with importable(BOOK / "_ext"):
        from recorded_numbers import recorded
    with pytest.raises((ValueError, LookupError, OSError, TypeError), match=complaint):
        recorded(wanted, tmp_path / "results")


def test_a_number_is_written_with_the_digits_that_the_printed_ones_allow():
    folder = BOOK.parent / "results"
    entries = json.loads((folder / "region.json").read_text(encoding="utf-8"))["results"]
    [area] = [entry for entry in entries if entry["id"] == "paper.area"]
    with importable(BOOK / "_ext"):
        from recorded_numbers import recorded
    text = recorded("region:paper.area | ±", folder)
    start = f"{area['value']:.2f} ± {area['input_uncertainty']:.2f}\u00a0rad²; with the other digit"
    assert text.startswith(start)
    with pytest.raises(ValueError, match="no printed digit"):
        recorded("region:scale | ±", folder)


@pytest.mark.parametrize("page", ["index.md"])
def test_the_front_page_types_no_number_by_hand(page):
    """What it states of the paper is a recorded result; what is left names versions and objects."""
    text = (BOOK / page).read_text(encoding="utf-8")
    text = re.sub(
        r"(?s)```\{toctree\}.*?```|```.*?```|`[^`]*`|\]\([^)]*\)|^:.*$|(?m:^:.*$)", " ", text
    )
    text = re.sub(r"\b(?:Theorem|Tables?|Python)\s+[\d.]+|\bN\d", " ", text)
    assert re.findall(r"\d+(?:\.\d+)?", text) == []
