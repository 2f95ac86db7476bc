"""What pages need beyond the theme: commands, notebooks, descriptions, sound ids, a calm API."""

from __future__ import annotations

import os
import re
from base64 import b64encode
from html import escape
from pathlib import Path
from typing import Any
from unittest import mock

import nbformat
from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.ext.napoleon import NumpyDocstring
from sphinx.transforms import SphinxTransform
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from cspace.cli import command_parsers
from lizarraga2025.commands import command_parsers as companions

# As long as a number or a name; a table is read in the chapters.
LONGEST_VALUE = 40

# Help is folded here, in characters; argparse itself leaves two of them free.
HELP_WIDTH = "82"

# Chapters are built from executed copies; readers run and edit the notebooks themselves.
COPIES, NOTEBOOKS = "book/chapters/", "notebooks/"

# A link between notebooks, as it works beside them: [Theorem 1](04_theorem_1.md).
LINK_TO_TWIN = re.compile(r"(\]\(\d\d_\w+)\.md\b")

# Letters of a description: search engines cut longer ones.
LONGEST_DESCRIPTION = 200
NO_WORDS = (nodes.math, nodes.raw, nodes.citation_reference)

# The theme drops empty parts of the page at 500 and fills its buttons in at 501.
BEFORE_THEME, AFTER_THEME = 400, 600


class CommandHelp(SphinxDirective):
    """Show the help of every command, asked for now: nothing of it is written down in the book."""

    def run(self) -> list[nodes.Node]:
        sections: list[nodes.Node] = []
        names: dict[Any, str] = {}
        for name, parser in (command_parsers() | companions()).items():
            names.setdefault(parser, name)  # a second name has the same help
        with mock.patch.dict(os.environ, COLUMNS=HELP_WIDTH, NO_COLOR="1"):
            for parser, name in names.items():
                text, anchor = parser.format_help(), nodes.make_id(f"command {name}")
                block = nodes.literal_block(text, text, language="none")
                sections.append(nodes.section("", nodes.title(name, name), block, ids=[anchor]))
        return sections


class UniqueProofIds(SphinxTransform):
    """Number the ids of theorem bodies and proofs: sphinx-proof repeats them on a page."""

    default_priority = 200

    def apply(self, **kwargs: Any) -> None:
        repeated = (["proof-content"], ["proof"])
        found = [n for n in self.document.findall(nodes.Element) if n.get("ids") in repeated]
        for count, node in enumerate(found, start=1):
            node["ids"] = [f"{node['ids'][0]}-{count}"]


class ShortValuesOnly(SphinxTransform):
    """Leave the value of a constant out of the API where it is a whole table."""

    default_priority = 200

    def apply(self, **kwargs: Any) -> None:
        for value in list(self.document.findall(addnodes.desc_annotation)):
            if value.astext().startswith(" = ") and len(value.astext()) > LONGEST_VALUE:
                value.parent.remove(value)


def link_to_chapters(app: Sphinx, docname: str, source: list[str]) -> None:
    """Lead a chapter's links to the executed copies: they have no text twins beside them."""
    if docname.startswith("chapters/"):
        source[0] = LINK_TO_TWIN.sub(r"\1.ipynb", source[0])


def link_to_notebooks(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Lead launch buttons to the notebook, the edit button to its text twin."""
    groups = (button.get("buttons", [button]) for button in context["header_buttons"])
    buttons = [button for group in groups for button in group]
    for button in buttons:
        if COPIES in button.get("url", ""):
            button["url"] = button["url"].replace(COPIES, NOTEBOOKS)
            if button.get("label") == "source-edit-button":
                button["url"] = button["url"].removesuffix(".ipynb") + ".md"
    context["launches"] = [one for one in buttons if one.get("text") in ("Binder", "Colab")]


def carry_notebook(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Let the page of a chapter carry its notebook, without outputs, as a download.

    A link to the file would do on a server; on a page opened from the file system it shows the
    file's text instead.
    """
    if context.get("page_source_suffix") != ".ipynb":
        return
    file = Path(app.env.doc2path(pagename))
    notebook = nbformat.read(file, as_version=4)
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # the times of the run
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    context["notebook_name"] = file.name
    context["notebook_data"] = b64encode(nbformat.writes(notebook).encode()).decode()


def describe(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Describe a page by its first paragraph in plain words, cut at a word."""
    for paragraph in doctree.findall(nodes.paragraph) if doctree else ():
        text = " ".join(paragraph.astext().split())
        plain = not any(isinstance(part, NO_WORDS) for part in paragraph.findall())
        if plain and len(text) > LONGEST_DESCRIPTION // 4:
            if len(text) > LONGEST_DESCRIPTION:
                text = text[:LONGEST_DESCRIPTION].rpartition(" ")[0] + " …"
            tag = f'<meta name="description" content="{escape(text)}" />'
            context["metatags"] = context.get("metatags", "") + tag
            return


def whole_docstring(docstring: Any) -> list[str]:
    """Return the docstring of a constant as it is: it may hold a colon, and states no type."""
    return list(docstring._dedent(docstring._consume_to_end()))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register directive, transforms and links with Sphinx."""
    # Napoleon reads the words before a first colon as a type, and has no setting against it.
    NumpyDocstring._parse_attribute_docstring = whole_docstring
    app.add_directive("commands", CommandHelp)
    app.add_transform(UniqueProofIds)
    app.add_transform(ShortValuesOnly)
    app.connect("source-read", link_to_chapters)
    app.connect("html-page-context", describe)
    app.connect("html-page-context", carry_notebook, priority=BEFORE_THEME)
    app.connect("html-page-context", link_to_notebooks, priority=AFTER_THEME)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
