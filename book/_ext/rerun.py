"""What a page needs so that its cells can run in it: each cell's number, and the script.

`python3 run.py live` puts Python itself beside the built pages. Without it, the script adds only a
line at the foot of the page that says so.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

SCRIPTS = ("rerun-files.js", "rerun-page.js")


class NumberedCells(SphinxPostTransform):
    """Give the code and the output of each cell a class with the cell's number in its notebook."""

    default_priority = 197  # code is gathered at 198
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        for part in self.document.findall(nodes.container):
            if part.get("nb_element") != "cell_code":
                continue
            number = part["cell_index"]
            for each in part.children:
                if each.get("nb_element") == "cell_code_output":
                    each["classes"].append(f"rerun-output-{number}")
                elif each.get("nb_element") == "cell_code_source":
                    for block in each.findall(nodes.literal_block):
                        block["classes"].append(f"rerun-code-{number}")


def add_scripts(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Give chapters the list of what lies beside the book, and the script that reads it."""
    if doctree is None or not pagename.startswith("chapters/"):
        return
    for name in SCRIPTS:
        app.add_js_file(name, loading_method="defer")
    app.add_css_file("rerun.css")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx."""
    app.add_post_transform(NumberedCells)
    app.connect("html-page-context", add_scripts)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
