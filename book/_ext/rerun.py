"""What a page needs so that its cells can run in it: each cell's number, and the script.

`python3 run.py live` puts Python itself beside the built pages. Without it, the script adds only a
line at the foot of the page that says so. A content policy keeps what a cell shows from becoming a
script, and the page from loading anything from elsewhere.
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

SCRIPTS = ("rerun-files.js", "rerun-page.js")

POLICY = (
    "default-src 'self'; object-src 'none'; script-src 'self' blob: 'wasm-unsafe-eval' {hashes};"
    " worker-src blob:; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:;"
    " font-src 'self' data:; base-uri 'none'; form-action 'self'"
)
"""Python is started from blobs; the theme has scripts in its pages, each allowed by its hash."""
FIRST = '<meta charset="utf-8" />'
INLINE = re.compile(r"<script(?![^>]*\ssrc=)[^>]*>(.*?)</script>", re.DOTALL)


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


def add_policies(app: Sphinx, error: Exception | None) -> None:
    """Give each built chapter its policy."""
    if error is None and app.builder.format == "html":
        for page in Path(app.outdir, "chapters").glob("*.html"):
            text = page.read_text(encoding="utf-8")
            page.write_text(with_policy(text), encoding="utf-8", newline="\n")


def with_policy(text: str) -> str:
    """Return a page that allows its own scripts alone: files beside it, and inline ones by hash."""
    if "Content-Security-Policy" in text:  # an older build wrote this page
        return text
    inline = {hashlib.sha256(script.encode()).digest() for script in INLINE.findall(text)}
    hashes = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in sorted(inline))
    policy = POLICY.format(hashes=hashes)
    meta = f'<meta http-equiv="Content-Security-Policy" content="{policy}" />'
    return text.replace(FIRST, f"{FIRST}\n    {meta}", 1)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx."""
    app.add_post_transform(NumberedCells)
    app.connect("html-page-context", add_scripts)
    app.connect("build-finished", add_policies)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
