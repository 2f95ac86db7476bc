"""A chapter's cells on its page: folded code, quiet exercises, and what they need to run there.

A chapter folds the cells that a reader can do without (the tag ``hide-input``). On a page all
folded code of a section stands in one box at the section's end, in the order in which it runs; what
the cells show stays in its place. A page cannot run a cell, so an exercise's "Not filled in yet" is
left out there, and the section says where its cells run.

`python3 run.py live` puts Python itself beside the built pages; the scripts find a cell's code and
output by the cell's number in its notebook. Without Python, a script adds only a line at the foot
of the page that says so. A content policy keeps what a cell shows from becoming a script, and the
page from loading anything from elsewhere.
"""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025.exercises import UNFILLED

WHERE = (
    "Predict first, then open the solution. The cells of these exercises run in this chapter's "
    "notebook, which the foot of the page offers: there a cell says whether your value is right."
)

SCRIPTS = ("rerun-files.js", "rerun-page.js")

POLICY = (
    "default-src 'self'; object-src 'none'; script-src 'self' blob: 'wasm-unsafe-eval' {hashes};"
    " worker-src blob:; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:;"
    " font-src 'self' data:; base-uri 'none'; form-action 'self'"
)
"""Python is started from blobs; the theme has scripts in its pages, each allowed by its hash."""
FIRST = '<meta charset="utf-8" />'
INLINE = re.compile(r"<script(?![^>]*\ssrc=)[^>]*>(.*?)</script>", re.DOTALL)


class Cells(SphinxPostTransform):
    """Number the cells, tidy the exercises, and gather the folded code of each section."""

    default_priority = 198  # myst-nb folds at 199
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        for section in list(self.document.findall(nodes.section)):
            cells = [part for part in section if is_part(part, "cell_code")]
            for cell in cells:
                number(cell)
            if cells and "exercises" in section["ids"]:
                for cell in cells:
                    leave_out_unfilled(cell)
                section.insert(1, nodes.paragraph("", WHERE, classes=["exercises-where"]))
            folded = [cell for cell in cells if cell.get("hide_mode") == "input"]
            if folded := [cell for cell in folded if is_part(cell[0], "cell_code_source")]:
                whole = box(folded)  # first: it takes emptied cells out of the section
                below = (k for k, part in enumerate(section) if isinstance(part, nodes.section))
                section.insert(next(below, len(section)), whole)


def is_part(node: nodes.Node, kind: str) -> bool:
    """Tell whether a node is a cell, its source or its output."""
    return isinstance(node, nodes.container) and node.get("nb_element") == kind


def number(cell: nodes.Element) -> None:
    """Give a cell's code and output classes with the cell's number."""
    for part in cell:
        if is_part(part, "cell_code_output"):
            part["classes"].append(f"rerun-output-{cell['cell_index']}")
        elif is_part(part, "cell_code_source"):
            for block in part.findall(nodes.literal_block):
                block["classes"].append(f"rerun-code-{cell['cell_index']}")


def leave_out_unfilled(cell: nodes.Element) -> None:
    """Remove what a cell says of an exercise that nobody has filled in."""
    for output in [part for part in cell if UNFILLED in part.astext()]:
        for said in list(output.findall(nodes.literal_block)):
            if UNFILLED in said.astext():
                other = said.astext().replace(UNFILLED, "").strip()
                said.parent.replace(said, [nodes.literal_block(other, other)] if other else [])
        if not output.astext():
            cell.remove(output)


def box(cells: list[nodes.Element]) -> nodes.container:
    """Take the code of cells out of them and return it as one folded cell."""
    whole, source = cells[0].copy(), cells[0][0].copy()
    for cell in cells:
        source += cell[0].children
        del cell[0]
        cell["classes"] = [name for name in cell["classes"] if not name.startswith("tag_")]
        if not cell.children:
            cell.parent.remove(cell)
    whole += source
    return whole


def add_scripts(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Give chapters the list of what lies beside the book, and the script that reads it."""
    if doctree is None or not pagename.startswith("chapters/"):
        return
    for name in SCRIPTS:
        app.add_js_file(name, loading_method="defer")
    app.add_css_file("rerun.css")


def add_policies(app: Sphinx, error: Exception | None) -> None:
    """Let each built chapter run its own scripts alone, files beside it and inline ones."""
    if error is not None or app.builder.format != "html":
        return
    for page in Path(app.outdir, "chapters").glob("*.html"):
        text = page.read_text(encoding="utf-8")
        if "Content-Security-Policy" in text:  # an older build wrote this page
            continue
        inline = {hashlib.sha256(script.encode()).digest() for script in INLINE.findall(text)}
        hashes = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in sorted(inline))
        policy = POLICY.format(hashes=hashes)
        meta = f'<meta http-equiv="Content-Security-Policy" content="{policy}" />'
        text = text.replace(FIRST, f"{FIRST}\n    {meta}", 1)
        page.write_text(text, encoding="utf-8", newline="\n")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx."""
    app.add_post_transform(Cells)
    app.connect("html-page-context", add_scripts)
    app.connect("build-finished", add_policies)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
