"""What a page says around its text: a description, a preview for chats, its notebook, the PDF.

The template ``notebook.html`` shows the last two, and links to the repository if there is one.
"""

from __future__ import annotations

import re
from base64 import b64encode
from html import escape
from pathlib import Path
from textwrap import shorten
from typing import Any

import nbformat
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
    """Give a page its description, its preview, its notebook and the printed book."""
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
    context["printed"] = printed_book(app, context)
    if context.get("page_source_suffix") == ".ipynb":
        context["notebook_data"] = notebook(Path(app.env.doc2path(pagename)))


def description(doctree: nodes.document) -> str:
    """Return the first paragraph of a page as plain text, cut at a sentence or a word."""
    for paragraph in doctree.findall(nodes.paragraph):
        text = " ".join(paragraph.astext().split())
        left_out = any(isinstance(node, LEFT_OUT) for node in paragraph.findall())
        if len(text) > LONGEST // 4 and not left_out:
            sentences = text[: text.rfind(". ", 0, LONGEST) + 1]
            fits = len(text) > LONGEST and len(sentences) > LONGEST // 2
            return sentences if fits else shorten(text, LONGEST, placeholder=" …")
    return ""


def notebook(file: Path) -> str:
    """Return a chapter's notebook, without outputs, for a link that holds it.

    A link to the file would do on a server; on a page opened from the file system it shows the
    file's text instead.
    """
    content = nbformat.read(file, as_version=4)
    for cell in content.cells:
        cell.metadata.pop("execution", None)  # the times of the run
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    return b64encode(nbformat.writes(content).encode()).decode()


def printed_book(app: Sphinx, context: dict[str, Any]) -> str:
    """Return the address of the printed book for a page, if it has been printed."""
    printed = Path(app.srcdir, PRINTED)
    if not printed.is_file():
        return ""
    write_whole(Path(app.outdir, "_static", printed.name), printed.read_bytes())
    return str(context["pathto"](f"_static/{printed.name}", 1))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx."""
    app.connect("html-page-context", describe)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
