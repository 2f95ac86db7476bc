"""What can be referred to, by its address: a link to it shows it, and the search finds it by name.

Equations, figures, tables, theorems, words of the glossary, entries of the bibliography and of the
ledger are read from the written pages into one script, ``_static/cards.js``; the texts of the
pages, for excerpts, into ``_static/texts.js``. A page loads them when they are asked for: opened
from the file system it may load a script, but no other page.
"""

from __future__ import annotations

import json
import posixpath
from collections.abc import Iterator
from copy import copy
from pathlib import Path

from bs4 import BeautifulSoup, Tag
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

from cspace.files import write_whole

KINDS = {
    "div.math[id]": ("Equation ", ".eqno"),
    "figure[id]": ("", ".caption-number"),
    "table[id]": ("", ".caption-number"),
    "div.theorem[id]": ("", ".caption-number"),
    "dt[id^=term-]": ("", ""),
    "div.citation[id]": ("Reference ", ".label"),
    "tr[data-likeliest][id]": ("", "th"),
}
"""What has a card: what its name begins with, and where the rest of the name stands in it."""

LEFT_OUT = ".panels, details, .ledger-reading, .ledger-evidence"
"""Of what is shown: a card is a glance."""

MOST_ROWS = 4
"""A longer table is shown by its first rows."""

# Pages of the library's reference name functions, not things of the paper.
NO_CARDS = ("generated/", "api")

Card = dict[str, str]


def cards_of(page: str, article: Tag) -> Iterator[tuple[str, Card]]:
    """Yield every card of a page with the address of what it shows."""
    [heading] = article.select("h1")[:1] or [article]
    for selector, (kind, place) in KINDS.items():
        for found in article.select(selector):
            if named := found.select_one(place) if place else found:
                name = kind + named.get_text().strip("() \n")
                html = at_rest(copy(found), page)
                if found.name == "dt":  # what a word of the glossary means
                    html += f"<dd>{found.find_next_sibling('dd').get_text()}</dd>"
                card = {"name": name, "page": heading.get_text().strip(), "html": html}
                yield f"{page}#{found['id']}", card


def at_rest(shown: Tag, page: str) -> str:
    """Return HTML with links as text, without ids, and with addresses from the book's root."""
    more = shown.select("tbody tr")[MOST_ROWS:]
    for part in [*shown.select(LEFT_OUT), *more]:
        part.decompose()
    for tag in [shown, *shown.find_all(True)]:
        for name in ("id", "name", "title", "tabindex", "role", "style"):
            tag.attrs.pop(name, None)
        if tag.name == "img":
            tag["src"] = posixpath.normpath(posixpath.join(posixpath.dirname(page), tag["src"]))
        if tag.name == "a":
            tag.unwrap()
    end = f'<p class="card-more">and {len(more)} more rows</p>' if more else ""
    return (f"<table>{shown}</table>" if shown.name == "tr" else str(shown)) + end


def text_of(part: Tag) -> str:
    """Return the text of a page, for excerpts: by its sections, without tables and code.

    The page's elements are used up.
    """
    for left_out in part.select("table, pre, script, summary"):
        left_out.decompose()
    for tag in part.find_all(True):
        if tag.get("id") and not tag.is_empty_element:
            tag.name, tag.attrs = "section", {"id": tag["id"]}
        else:
            tag.unwrap()
    return " ".join(part.decode_contents().split())


def write_scripts(app: Sphinx, exception: Exception | None) -> None:
    """Read the pages and write both scripts."""
    if exception or app.builder.name != "html":
        return
    cards: dict[str, Card] = {}
    texts: dict[str, str] = {}
    for name in sorted(app.env.found_docs):
        page = f"{name}.html"
        html = Path(app.outdir, page).read_text(encoding="utf-8")
        article = BeautifulSoup(html, "html.parser").select_one("article")
        if article is not None:
            for link in article.select(".headerlink"):
                link.decompose()
            cards |= {} if name.startswith(NO_CARDS) else dict(cards_of(page, article))
            texts[page] = f"<div role=main>{text_of(article)}</div>"
    for file, content in {"cards": cards, "texts": texts}.items():
        text = json.dumps(content, ensure_ascii=False, separators=(",", ":"))
        script = f"var book{file.title()} = {text};\n"
        write_whole(Path(app.outdir, "_static", f"{file}.js"), script.encode())


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the cards with Sphinx."""
    app.connect("build-finished", write_scripts)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
