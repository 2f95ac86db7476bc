"""What a page says of itself to others: a description, a preview for chats, and doors out of it.

The doors are the repository, a report of an error on this page, and the printed book. Each is there
where `pyproject.toml` states what it needs, and absent elsewhere: no link leads to nothing.
"""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

from cspace.files import write_whole

LONGEST = 200
"""Letters of a description: search engines and chats cut longer ones."""

PRINTED = "_build/qbound.pdf"
"""`run.py pdf` prints it from the built pages, and then builds them again."""

LEFT_OUT = (nodes.math, nodes.raw, nodes.citation_reference)


def describe(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Give a page its description, its preview and its doors."""
    words = description(doctree) if doctree else ""
    told = {
        "og:title": re.sub(r"<[^>]+>", "", context.get("title", "")),
        "og:site_name": app.config.html_title,
        "og:type": "website" if pagename == app.config.root_doc else "article",
    }
    if words:
        told["og:description"] = words
    if app.config.html_baseurl:
        told["og:url"] = app.config.html_baseurl.rstrip("/") + f"/{pagename}.html"
    tags = [f'<meta property="{name}" content="{escape(text)}" />' for name, text in told.items()]
    if words:
        tags.append(f'<meta name="description" content="{escape(words)}" />')
    context["metatags"] = context.get("metatags", "") + "\n    ".join(tags)
    context["doors"] = list(doors(app, pagename, context)) if doctree else []


def description(doctree: nodes.document) -> str:
    """Return the first paragraph of a page as plain text, cut at a sentence or a word."""
    for paragraph in doctree.findall(nodes.paragraph):
        text = " ".join(paragraph.astext().split())
        if len(text) > LONGEST // 4 and not any(
            isinstance(n, LEFT_OUT) for n in paragraph.findall()
        ):
            if len(text) <= LONGEST:
                return text
            cut = text[:LONGEST]
            sentence = cut.rfind(". ") + 1
            return cut[:sentence] if sentence > LONGEST // 2 else cut[: cut.rfind(" ")] + " …"
    return ""


def doors(app: Sphinx, pagename: str, context: dict[str, Any]) -> list[dict[str, str]]:
    """Return the links out of a page."""
    repository = app.config.html_theme_options.get("repository_url", "")
    found = []
    if repository:
        report = f"{repository}/issues/new?title={quote(f'On the page {pagename}')}"
        found = [
            {"url": repository, "text": "The repository"},
            {"url": report, "text": "report an error on this page"},
        ]
    printed = Path(app.srcdir, PRINTED)
    if printed.is_file():
        write_whole(Path(app.outdir, "_static", printed.name), printed.read_bytes())
        url = context["pathto"](f"_static/{printed.name}", 1)
        found.append({"url": url, "text": "the book as a PDF"})
    return found


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx."""
    app.connect("html-page-context", describe)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
