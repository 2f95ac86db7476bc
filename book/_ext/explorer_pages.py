"""``{explorer} ROBOT`` and ``{surface} ROBOT JOINTS``: the library's own pages, shown in frames."""

from __future__ import annotations

import os
from html import escape
from pathlib import Path
from string import Template

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from lizarraga2025 import closed_form
from qbound import find_region, load_robot
from qbound.arms.surfaces import find_surface
from qbound.explorer.page import explorer_page
from qbound.explorer.surface_page import surface_page

FOLDER = "_static/explorer"

# Before the frame has told its height: enough for both pictures, so that little moves.
FIRST_HEIGHT = 760


# Steps of a surface's grid: its page stays below 300 kB.
RESOLUTION = 24


def paths_of(robot: str) -> tuple[tuple[int, ...], ...]:
    """Return the paths of Figures 8 and 9, for the robot of the paper in any of its versions."""
    return closed_form.PATHS if robot.startswith("minervabot") else ()


class Framed(SphinxDirective):
    """Write a page beside the book and show it."""

    def framed(self, kind: str, name: str, page: str, title: str) -> list[nodes.Node]:
        """Return the frame, of a class, of a page that is written under a name."""
        file = Path(self.env.app.outdir, FOLDER, f"{name}.html")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(page, encoding="utf-8")
        here = Path(self.env.app.outdir, self.env.docname).parent
        address = Path(os.path.relpath(file, here)).as_posix()
        frame = Path(self.env.app.confdir, "_templates", "explorer.html")
        html = Template(frame.read_text(encoding="utf-8")).substitute(
            kind=kind, file=escape(address), title=escape(title), height=FIRST_HEIGHT
        )
        return [nodes.raw("", html, format="html")]


class Explorer(Framed):
    """The explorer of a packaged robot."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        robot = load_robot(name)
        page = explorer_page(find_region(robot), paths_of(name))
        title = f"Explorer of {robot.name}: its joint space beside the arm"
        return self.framed("explorer", name, page, title)


class Surface(Framed):
    """The surface of three joints of a packaged robot, the others at home."""

    required_arguments = 4

    def run(self) -> list[nodes.Node]:
        name, *joints = self.arguments
        surface = find_surface(load_robot(name), joints, resolution=RESOLUTION)
        title = f"Surface of {surface.robot.name}: where three joints are safe"
        return self.framed("surface-frame", f"{name}-surface", surface_page(surface), title)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the directive with Sphinx."""
    app.add_directive("explorer", Explorer)
    app.add_directive("surface", Surface)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
