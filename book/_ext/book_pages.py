"""What pages need beyond the theme: the help of commands, sound ids, links, a calm API."""

from __future__ import annotations

import os
import re
from typing import Any
from unittest import mock

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

# A link between notebooks, as it works beside them: [Theorem 1](04_theorem_1.md).
LINK_TO_TWIN = re.compile(r"(\]\(\d\d_\w+)\.md\b")


class CommandHelp(SphinxDirective):
    """Show the help of every command, asked for now: nothing of it is written down in the book."""

    def run(self) -> list[nodes.Node]:
        sections = []
        with mock.patch.dict(os.environ, COLUMNS=HELP_WIDTH, NO_COLOR="1"):
            for name, parser in (command_parsers() | companions()).items():
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


def whole_docstring(docstring: Any) -> list[str]:
    """Return the docstring of a constant as it is: it may hold a colon, and states no type."""
    return list(docstring._dedent(docstring._consume_to_end()))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the directive, transforms and links with Sphinx."""
    # Napoleon reads the words before a first colon as a type, and has no setting against it.
    NumpyDocstring._parse_attribute_docstring = whole_docstring
    app.add_directive("commands", CommandHelp)
    app.add_transform(UniqueProofIds)
    app.add_transform(ShortValuesOnly)
    app.connect("source-read", link_to_chapters)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
