"""The ledger in the built book: complete without a script, filtered with one, linked both ways."""

from __future__ import annotations

import re
from collections.abc import Iterator
from copy import copy
from functools import cache
from typing import Any

import pytest

from engine_support.browser import chapter_page, open_page
from engine_support.pages import HTML, read
from lizarraga2025 import recorded
from lizarraga2025.ledger import cite
from lizarraga2025.ledger.claims import SEVERITIES, from_content
from lizarraga2025.ledger.errata import change, errata
from lizarraga2025.verdicts import VERDICTS

LEDGER = [from_content(content) for content in recorded.claims()]
PAGE, ERRATA = cite.PAGE, chapter_page("errata")


@cache
def by_id(page: str) -> dict[str, Any]:
    return {tag["id"]: tag for tag in read(page).find_all(id=True)}


def flat(text: str) -> str:
    """Text as the page shows it: letters with subscripts for β_{1,1} and q_1, minus signs."""
    text = re.sub(r"(?<=[\s(\[])-(?=[\s\w(])", "\N{MINUS SIGN}", text)
    return re.sub(r"(?<=\w)_(?:\{([^}]*)\}|([A-Za-z0-9]+))", r"\1\2", text)


# --- as a file ------------------------------------------------------------------------------------


def without_commit(entry: str) -> str:
    """A citation names the commit at which the page was built; the checkout may be later."""
    return re.sub(r", commit [0-9a-f]{12}( with changes)?", "", entry)


@pytest.mark.parametrize("one", LEDGER, ids=lambda one: one.id)
def test_an_entry_has_its_row_with_all_that_the_ledger_says(one) -> None:
    row = by_id(PAGE)[one.anchor]
    assert row.name == "tr"
    data = [row[f"data-{name}"] for name in ("kind", "likeliest", "favourable", "severity")]
    severity = "" if one.stands else one.severity
    assert data == [one.kind, one.likeliest, one.most_favourable, severity]
    assert not row.has_attr("hidden")
    text = row.get_text()
    assert all(
        flat(part) in text
        for part in (one.id, one.where, one.says, one.reading, one.corrected, severity)
    )
    shown = [badge.get_text() for badge in row.select(".verdict")]
    assert shown == [one.likeliest, one.most_favourable]
    told = row.select_one("details .bibtex").get_text()
    assert without_commit(told) == without_commit(cite.entry(one))
    assert_evidence_leads_back(one, row)
    carrier = row.parent.tr
    assert carrier["id"] == next(other.anchor for other in LEDGER if other.id == one.finding)
    links = row.select(".ledger-finding a")
    assert [link["href"] for link in links] == [f"#{carrier['id']}"] * (row is not carrier)
    told = text if flat(one.computed) in text else carrier.get_text()
    assert flat(one.computed) in told


def assert_evidence_leads_back(one, row) -> None:
    """The evidence of an entry is in the book, and the chapter links the entry."""
    chapter, _, anchor = one.evidence.chapter.partition("#")
    page = chapter_page(chapter)
    (link,) = row.select(".ledger-evidence a")
    assert link["href"] == f"{page}#{anchor}"
    place = by_id(page).get(anchor)
    assert place is not None, f"no {anchor} in {chapter}"
    back = f"../{PAGE}#{one.anchor}"
    assert place.find_parent("article").select(f'.claims-box .in-ledger a[href="{back}"]')


def test_a_box_of_verdicts_ends_what_is_set_against_the_print_or_the_chapter() -> None:
    boxes = [box for file in (HTML / "chapters").glob("*.html") for box in boxes_of(file.name)]
    assert len(boxes) > 10
    for box in boxes:
        article = box.find_parent("article")
        assert box.find_parent("section") == (
            article.select_one("#against-the-print") or article.section
        )
        assert box.find_next_siblings() == []


def boxes_of(name: str) -> list[Any]:
    return read(f"chapters/{name}").select(".claims-box")


def test_an_id_in_the_text_is_a_link() -> None:
    for page in sorted((HTML / "chapters").glob("*.html")):
        for paragraph in map(copy, read(f"chapters/{page.name}").select("article p")):
            for link in paragraph.select("a"):
                link.extract()
            for code in paragraph.select("code"):
                code.extract()
            assert re.findall(r"\bE-\d+\b", paragraph.get_text()) == [], page.name


def test_findings_come_by_severity_and_the_arctangent_first() -> None:
    """What changes the region stands above what changes a word; what stands comes last."""
    bodies = read(PAGE).select("table.ledger-table tbody")
    of_body = [{row["data-severity"] for row in body.select("tr")} for body in bodies]
    order = [min(map([*SEVERITIES, ""].index, kinds)) for kinds in of_body]
    assert order == sorted(order)
    assert set(order) == {0, 1, 2, 3}
    assert bodies[0].tr["id"] == "e-34"
    fall = [body.tr["id"] for body, kinds in zip(bodies, of_body, strict=True) if kinds != {""}]
    assert fall.index("t-1-4") > fall.index("e-37") > fall.index("t-4-2")


def test_the_errata_are_what_the_ledger_would_change() -> None:
    parts = errata(LEDGER)
    shown = read(ERRATA).select("dl.erratum")
    found = {part.code.get_text().split()[2]: part for part in shown}
    assert sorted(found) == sorted(parts)
    for leader, part in found.items():
        links = [link for link in part.select("a") if f"../{PAGE}#" in link["href"]]
        assert [link.get_text() for link in links] == [one.id for one in parts[leader]]
        (one,) = (one for one in parts[leader] if one.id == leader)
        text = part.get_text()
        assert flat(one.where) in text
        assert flat(one.computed) in text
        if change(leader) is None:
            assert flat(one.says) in text
            assert flat(one.corrected) in text


# --- in a browser ---------------------------------------------------------------------------------


@pytest.fixture
def page(tabs) -> Iterator[Any]:
    with tabs.lent() as tab:
        open_page(tab.page, PAGE)
        yield tab.page


def shown(page: Any) -> list[str]:
    script = "[...document.querySelectorAll('.ledger tbody tr')].filter(r => r.checkVisibility())"
    return page.evaluate(f"{script}.map(r => r.querySelector('th').textContent)")


def test_the_reader_filters_and_shows_all_again(page) -> None:
    for verdict in VERDICTS:
        page.get_by_label("Likeliest reading").select_option(verdict)
        wanted = [one.id for one in LEDGER if one.likeliest == verdict]
        assert sorted(shown(page)) == sorted(wanted)
        count = page.locator(".ledger-count").text_content()
        assert count == f"{len(wanted)} of {len(LEDGER)} entries"
    page.get_by_label("Likeliest reading").select_option("")
    page.get_by_label("Kind").select_option("table")
    page.get_by_role("searchbox", name="Search").fill("TABLE 4 unit")
    assert "T-4.1" in shown(page)
    assert len(shown(page)) < 10
    page.get_by_role("button", name="Show all").press("Enter")
    page.wait_for_function("document.querySelectorAll('.ledger tr[hidden]').length === 0")
    first = shown(page)
    assert len(first) == len(LEDGER)
    page.get_by_label("Order").select_option("place in the paper")
    assert shown(page)[0] == "E-1"
    page.get_by_label("Order").select_option("severity")
    assert shown(page) == first


def test_a_link_to_an_entry_shows_it_whatever_the_filter_says(page) -> None:
    page.get_by_label("Likeliest reading").select_option("misprint")
    assert "E-34" not in shown(page)
    page.evaluate("location.hash = '#e-34'")
    page.wait_for_function("document.getElementById('e-34').checkVisibility()")
    page.emulate_media(media="print")  # on paper the whole table is there
    assert sorted(shown(page)) == sorted(one.id for one in LEDGER)


def test_without_a_script_the_whole_table_is_shown(tabs) -> None:
    with tabs.lent(java_script_enabled=False) as tab:
        tab.page.goto((HTML / PAGE).as_uri())
        assert tab.page.locator(".ledger tbody tr:visible").count() == len(LEDGER)
        assert not tab.page.locator(".ledger-controls").is_visible()
