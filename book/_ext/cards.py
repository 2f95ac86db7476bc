"""A card for each thing that a page can refer to: it is shown where a link to it is pointed at.

Equations, figures, tables, theorems, words of the glossary, entries of the bibliography and of the
ledger are read from the written pages into one script, ``_static/cards.js``. Pages load it when a
card is first asked for: a page opened from the file system may load a script, but no other page.
The search page finds the same things by their names.
"""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Callable, Iterator
from copy import copy
from pathlib import Path
from typing import Any

from bs4 import BeautifulSoup, Tag
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

from cspace.files import write_whole

FILE = "_static/cards.js"

# A longer table is shown by its first rows: a card is a glance.
MOST_ROWS = 4

# Pages of the library's reference name functions, not things of the paper.
NO_CARDS = ("_static/", "generated/", "api.html", "search.html")

Card = dict[str, str]


def equation(found: Tag) -> Card:
    """Return the card of a numbered formula."""
    number = found.select_one(".eqno")
    if number is None:
        return {}
    name = number.get_text().strip("()# ")
    number.extract()
    return {
        "name": f"Equation {name}",
        "html": f'<div class="math">{found.decode_contents()}</div>',
    }


def picture(found: Tag) -> Card:
    """Return the card of a figure, or of a table that a cell printed: caption and content."""
    caption = found.find("figcaption")
    number = caption.select_one(".caption-number") if caption else None
    if number is None:
        return {}
    words = "".join(str(part) for part in caption.select(".caption-text"))
    table, image = found.find("table"), found.find("img")
    content = shortened(table) if table else str(image or "")
    return {"name": number.get_text().strip(), "html": f"<p>{inner(words)}</p>{content}"}


def table(found: Tag) -> Card:
    """Return the card of a table that stands in the text."""
    number, words = found.select_one("caption .caption-number"), found.select_one(".caption-text")
    if number is None:
        return {}
    text = words.decode_contents() if words else ""
    return {"name": number.get_text().strip(), "html": f"<p>{text}</p>{shortened(found)}"}


def shortened(found: Tag) -> str:
    """Return a table without its caption and without what lies beyond the first rows."""
    rows = found.select("tbody tr")
    for row in rows[MOST_ROWS:]:
        row.decompose()
    if found.caption:
        found.caption.decompose()
    left = len(rows) - MOST_ROWS
    more = f'<p class="card-more">and {left} more rows</p>' if left > 0 else ""
    return f"<table>{found.decode_contents()}</table>{more}"


def theorem(found: Tag) -> Card:
    """Return the card of a theorem: its statement."""
    title = found.select_one(".admonition-title")
    body = found.find("section")
    if title is None or body is None:
        return {}
    number = title.select_one(".caption-number")
    name = (number or title).get_text().strip()
    said = title.get_text().strip().removeprefix(name).strip().strip("()")
    return {"name": name, "html": f"<p>{said}</p>{body.decode_contents()}"}


def term(found: Tag) -> Card:
    """Return the card of a word of the glossary; its meaning stands beside it."""
    meaning = found.find_next_sibling("dd")
    if meaning is None:
        return {}
    return {"name": found.get_text().strip().rstrip("#"), "html": meaning.decode_contents()}


def citation(found: Tag) -> Card:
    """Return the card of an entry of the bibliography."""
    label = found.select_one(".label")
    if label is None:
        return {}
    words = "".join(str(part) for part in found.find_all("p"))
    return {"name": f"Reference {label.get_text()}", "html": words}


def entry(found: Tag) -> Card:
    """Return the card of an entry of the ledger: its two verdicts, what is said, what was found."""
    name, says, likeliest, favourable, finding = found.find_all(["th", "td"], recursive=False)[:5]
    where = says.select_one(".ledger-where")
    badges = [cell.select_one(".verdict") for cell in (likeliest, favourable)]
    if where is None or None in badges:
        return {}
    heard = where.extract().get_text()
    for later in [*says.select(".ledger-reading"), *finding.select(".ledger-evidence, details")]:
        later.decompose()
    said = f"<div><b>The paper, {heard}:</b> {says.decode_contents().strip()}</div>"
    parts = f"<p>{badges[0]} {badges[1]}</p>{said}"
    parts += f"<div><b>Found:</b> {finding.decode_contents()}</div>"
    return {"name": name.get_text(), "html": parts}


KINDS: dict[str, Callable[[Tag], Card]] = {
    "div.math[id]": equation,
    "figure[id]": picture,
    "table[id]": table,
    "div.theorem[id]": theorem,
    "dt[id^=term-]": term,
    "div.citation[id]": citation,
    "tr[data-likeliest][id]": entry,
}


def cards_of(page: str, html: str) -> Iterator[tuple[str, Card]]:
    """Yield every card of a page with the address of what it shows."""
    soup = BeautifulSoup(html, "html.parser")
    article, title = soup.select_one("article"), soup.select_one("h1")
    if article is None or title is None:
        return
    heading = title.get_text().rstrip("#").strip()
    for link in article.select(".headerlink"):
        link.decompose()
    for selector, read in KINDS.items():
        for found in article.select(selector):
            address = f"{page}#{found['id']}"
            if card := read(found if found.name == "dt" else copy(found)):
                yield address, {**card, "page": heading, "html": at_rest(card["html"], page)}


def inner(html: str) -> str:
    """Return HTML without the element that holds it all."""
    return re.sub(r"^<(\w+)[^>]*>(.*)</\1>$", r"\2", html, flags=re.DOTALL)


def at_rest(html: str, page: str) -> str:
    """Return HTML with links as text, without ids, and with addresses from the book's root."""
    soup = BeautifulSoup(html, "html.parser")
    for tag in soup.find_all(True):
        for name in ("id", "name", "title", "tabindex", "role", "style"):
            tag.attrs.pop(name, None)
        if tag.name == "img":
            tag["src"] = posixpath.normpath(posixpath.join(posixpath.dirname(page), tag["src"]))
    for tag in soup.find_all("a"):
        tag.unwrap()
    return re.sub(r"\s*\n\s*", " ", str(soup)).strip()


def write_cards(app: Sphinx, exception: Exception | None) -> None:
    """Read the pages and write the script."""
    if exception or app.builder.name != "html":
        return
    root = Path(app.outdir)
    pages = {file.relative_to(root).as_posix(): file for file in sorted(root.rglob("*.html"))}
    cards: dict[str, Card] = {}
    for page, file in pages.items():
        if not page.startswith(NO_CARDS) and file.stem in written(app):
            cards.update(cards_of(page, file.read_text(encoding="utf-8")))
    text = json.dumps(cards, ensure_ascii=False, separators=(",", ":"))
    write_whole(root / FILE, f"var bookCards = {text};\n".encode())


def written(app: Sphinx) -> set[str]:
    """Return the names of the files of today's pages: a folder may hold those of yesterday."""
    return {posixpath.basename(name) for name in app.env.found_docs}


def find_by_name(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Let the search page put what bears the very name that is asked for first."""
    if pagename == "search":
        app.add_js_file("find_by_name.js", loading_method="defer")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the cards with Sphinx."""
    app.connect("build-finished", write_cards)
    app.connect("html-page-context", find_by_name)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
