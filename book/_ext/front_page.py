"""The role ``{pdf}``: the book as one PDF, offered where it has been printed.

``run.py pdf`` prints it from the built pages, so it can be there only when pages are built again
after it. Where it is missing the role names the command instead: no link leads to nothing.
"""

from __future__ import annotations

from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxRole
from sphinx.util.typing import ExtensionMetadata

PRINTED = "_build/qbound.pdf"
PRINTS = "python3 run.py pdf"


class PdfRole(SphinxRole):
    """Offer the printed book: {pdf}`The whole book as a PDF`."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        if self.env.app.builder.name == "singlehtml":  # this page is what the PDF is printed from
            return [], []
        if not Path(self.env.srcdir, PRINTED).is_file():
            command = nodes.literal(PRINTS, PRINTS)
            return [command, nodes.Text(" prints the book as a PDF.")], []
        link = addnodes.download_reference(self.rawtext, refdoc=self.env.docname)
        link["reftarget"] = f"/{PRINTED}"
        link += nodes.Text(self.text)
        return [link, nodes.Text(".")], []


def read_again(
    app: Sphinx, env: BuildEnvironment, added: set[str], changed: set[str], removed: set[str]
) -> list[str]:
    """Read the front page anew at every build: the PDF may have come or gone."""
    return [app.config.root_doc] if app.config.root_doc in env.found_docs else []


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the role with Sphinx."""
    app.add_role("pdf", PdfRole())
    app.connect("env-get-outdated", read_again)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
