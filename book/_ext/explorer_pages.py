"""``{explorer} ROBOT``: the library's own page, shown in a frame."""

from __future__ import annotations

import os
from html import escape
from pathlib import Path
from string import Template

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from cspace import find_region, load_robot
from cspace.explorer.page import explorer_page
from lizarraga2025.evidence.tool_paths import LEFT, RIGHT

FOLDER = "_static/explorer"

# Before the frame has told its height: enough for both pictures, so that little moves.
FIRST_HEIGHT = 760


def paths_of(robot: str) -> tuple[tuple[int, ...], ...]:
    """Return the paths of Figures 8 and 9, for the robot of the paper in any of its versions."""
    return (RIGHT, LEFT) if robot.startswith("minervabot") else ()


class Explorer(SphinxDirective):
    """Write the explorer of a packaged robot beside the book and show it."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        robot = load_robot(name)
        file = Path(self.env.app.outdir, FOLDER, f"{name}.html")
        file.parent.mkdir(parents=True, exist_ok=True)
        page = explorer_page(find_region(robot), paths_of(name))
        file.write_text(page, encoding="utf-8")
        here = Path(self.env.app.outdir, self.env.docname).parent
        address = Path(os.path.relpath(file, here)).as_posix()
        frame = Path(self.env.app.confdir, "_templates", "explorer.html")
        html = Template(frame.read_text(encoding="utf-8")).substitute(
            file=escape(address),
            title=escape(f"Explorer of {robot.name}: its joint space beside the arm"),
            height=FIRST_HEIGHT,
        )
        return [nodes.raw("", html, format="html")]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the directive with Sphinx."""
    app.add_directive("explorer", Explorer)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
