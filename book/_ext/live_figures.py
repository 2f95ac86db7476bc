"""The directive ``{live} KIND``: a figure that a reader moves.

::

    ```{live} arm
    :robot: minervabot-v2
    :stop:
    :picture: ../_static/regions.svg
    :alt: Five regions of joint space.
    The arm stops where a boundary begins.
    ```

It stands under the label *Try it* and says that the browser draws it: the figures of the paper are
those that the cells of the chapters compute. On paper, and where no script runs, there is its
picture, or nothing. An option that its kind does not have stops the build.

A page loads one script for all figures, and the data of the robots that it shows. In a page with a
figure of the paper's robot, a boundary that the prose names, such as ``$B_7$`` or
``$\\beta_{2,1,2}$``, has the colour of its curve and lights it.
"""

from __future__ import annotations

import re
from functools import cache
from html import escape
from pathlib import Path
from typing import Any, Final

import numpy as np
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import ExtensionMetadata

from cspace import Region, find_region, load_robot
from cspace.arms.why import why
from cspace.explorer.data import figure_data
from cspace.explorer.page import figure_script, figures_script, figures_style
from cspace.files import write_whole
from cspace.region import solve, window_problem
from cspace.workspace.planar import planar_postures
from lizarraga2025.choices import LEFT, RIGHT
from qbound import window_region

COMMON: Final = {"picture", "alt", "label"}
ABOUT: Final = {"robot", "rule"}
OPTIONS: Final[dict[str, set[str]]] = {
    "angle": ABOUT,
    "arm": ABOUT | {"stop", "bodies", "dots", "explorer", "start", "first"},
    "bounds": ABOUT,
    "circle": set(),
    "functions": ABOUT | {"only", "passes"},
    "live": set(),
    "scale": ABOUT | {"scale"},
    "walk": ABOUT | {"scale", "start"},
}
"""Options of a kind; each also has those of `COMMON`."""

PAPER: Final = "minervabot-v2"
RULES: Final = ("clearance", "windows")

ON_A_TABLE: Final = "two-links-on-a-table"
RINGS: Final = {"A": (0.62, 0.0, 0.0), "B": (-0.1, -0.5, 0.0)}
"""Places to which a reader of the front page brings the tool, m: past the post, and behind the
triangle and the box."""

NAMED: Final = re.compile(r"(?:B_|\\beta_\{)([1-7])(?:(?:,\d){1,2}\})?")
"""A formula that is nothing but the name of a boundary, of a component or a bound of it."""

BROWSER: Final = "Your browser draws this figure, from formulas that the library computed."


class live_figure(nodes.General, nodes.Element):
    """The element that the scripts draw in."""


class Live(SphinxDirective):
    """A figure to move, its picture, its caption."""

    required_arguments = 1
    has_content = True
    option_spec = dict.fromkeys(COMMON.union(*OPTIONS.values()), directives.unchanged) | {
        "rule": lambda given: directives.choice(given, RULES)
    }

    def run(self) -> list[nodes.Node]:
        kind, given = self.arguments[0], self.options
        if kind not in OPTIONS:
            raise self.error(f"no live figure {kind!r}: there are {', '.join(OPTIONS)}")
        own, about = OPTIONS[kind], None
        if wrong := given.keys() - COMMON - own:
            raise self.error(f"{kind} has no option {', '.join(sorted(wrong))}")
        told = {name: given[name] or "" for name in sorted(own - ABOUT) if name in given}
        told |= {"kind": kind, "id": str(self.env.new_serialno("live"))}
        if own:
            about = (given.get("robot", PAPER), given.get("rule", RULES[0]))
            told["robot"] = key_of(*about)
        figure = nodes.container(classes=["live"])
        figure += nodes.paragraph("", given.get("label", "Try it"), classes=["live-label"])
        figure += live_figure("", told=told, about=about)
        if "picture" in given:
            figure += nodes.container(classes=["live-picture"])
            figure[-1] += nodes.image(uri=given["picture"], alt=given.get("alt", ""))
        text = " ".join([*self.content, BROWSER])
        caption, _ = self.parse_inline(text, lineno=self.lineno)
        figure += nodes.paragraph("", "", *caption, classes=["live-caption"])
        self.set_source_info(figure)
        return [figure]


def key_of(robot: str, rule: str) -> str:
    """Name a robot's region as pages do: its file, and the rule unless it is the usual one."""
    return robot if rule == RULES[0] else f"{robot}-{rule}"


@cache
def region_of(robot: str, rule: str) -> Region:
    """Return the region of a figure, by the library's rule or by the windows of Table 6."""
    arm = load_robot(robot)
    return find_region(arm) if rule == RULES[0] else solve(window_problem(window_region(arm)))


@cache
def data_script(robot: str, rule: str) -> str:
    """Return the data of a robot's region as a page loads it."""
    walks = (RIGHT, LEFT) if robot.startswith("minervabot") else ()
    data = figure_data(region_of(robot, rule), walks)
    if robot == ON_A_TABLE:
        data["rings"] = rings()[0]
    return figure_script(key_of(robot, rule), data)


@cache
def rings() -> tuple[list[dict[str, Any]], dict[str, str]]:
    """Ask `cspace why` of each pose, to 0.001 degrees, that puts the tool on a ring.

    Returns the rings with these poses and the shortest of the paths, and the certificates, for
    readers to check, by their addresses below ``_static``.
    """
    robot, told, certificates = load_robot(ON_A_TABLE), [], {}
    for name, place in RINGS.items():
        ring: dict[str, Any] = {"name": name, "at": list(place[:2]), "poses": [], "path": None}
        for k, exact in enumerate(planar_postures(robot, place), start=1):
            q = np.radians(np.round(np.degrees(exact), 3))
            found, file = why(ON_A_TABLE, robot.home, q), f"live/certificates/{name}-{k}.json"
            if found.certificate is not None:
                certificates[file] = found.certificate.text
            address = f"_static/{file}" if file in certificates else None
            ring["poses"].append({"q": q.tolist(), "answer": found.answer, "file": address})
            shortest = ring["path"]
            if found.path is not None and (shortest is None or len(found.path) < len(shortest)):
                ring["path"] = found.path.tolist()
        told.append(ring)
    return told, certificates


def add_scripts(
    app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any
) -> None:
    """Give a page with figures their script, the data of their robots, and their style."""
    found = list(doctree.findall(live_figure)) if doctree else []
    if not found:
        return
    about = {node["about"]: None for node in found if node["about"]}
    files = {f"live/{key_of(*each)}.js": data_script(*each) for each in about}
    files["live/figures.js"] = figures_script()
    for address in files:
        app.add_js_file(address, loading_method="defer")
    files["live/figures.css"] = figures_style()
    app.add_css_file("live/figures.css")
    if any(robot == ON_A_TABLE for robot, _ in about):
        files |= rings()[1]
    for address, text in files.items():
        file = Path(app.outdir, "_static", address)
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, text.encode())


def name_curves(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Make the boundaries that the prose of a page names words that light their curves."""
    shown = [node["about"] for node in doctree.findall(live_figure) if node["about"]]
    if app.builder.format != "html" or not any(robot.startswith(PAPER) for robot, _ in shown):
        return
    for formula in list(doctree.findall(nodes.math)):
        named = NAMED.fullmatch(formula.astext())
        if named and isinstance(formula.parent, nodes.paragraph | nodes.caption):
            word = nodes.inline(classes=["lights", f"b{named[1]}"])
            formula.replace_self(word)
            word += formula


def visit(translator: Any, node: live_figure) -> None:
    """Open and close the element; everything of it is drawn by its script."""
    data = "".join(f' data-{name}="{escape(value)}"' for name, value in node["told"].items())
    translator.body.append(f"<live-figure{data}></live-figure>\n")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx."""
    app.add_node(live_figure, html=(visit, lambda *_: None))
    app.add_directive("live", Live)
    app.connect("html-page-context", add_scripts)
    app.connect("doctree-resolved", name_curves)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
