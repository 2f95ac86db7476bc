"""Figures that one can move: pages with a hook get the engine, their kinds' scripts, their data.

A hook is a paragraph of its own in a page's Markdown, and nothing where no script runs::

    <div class="play" data-figure="KIND" data-replaces="ID"></div>

``_static/play/play.js`` draws a figure of that kind there. The image in the figure ``ID``, if the
hook names one, gives place to it and comes back on paper. ``data-robot`` names a packaged robot,
and ``data-rule="paper"`` takes the region of Table 6 (`qbound.window_region`) in place of that of
`cspace.find_region`; whatever else begins with ``data-`` is an option of the kind.

In a page with a figure of `LIGHTABLE`, a boundary that the prose names, such as ``$B_7$`` or
``$\\beta_{2,1,2}$``, has the colour of its curve and lights it under a pointer.

What a kind is told beyond its robot is the JSON that ``play_data/KIND.py`` returns, if there is
such a module: ``def data(region: Region) -> object``. Files that it links, by their addresses below
``_static``, are what ``def files() -> dict[str, str]`` of that module returns.
"""

from __future__ import annotations

import importlib
import json
import re
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any

from docutils import nodes
from explorer_pages import paths_of
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.typing import ExtensionMetadata

from cspace import Region, find_region, load_robot
from cspace.explorer.data import explorer_data
from cspace.explorer.page import engine_script, engine_style, shorter_script
from cspace.files import write_whole
from cspace.region import solve, window_problem
from qbound import window_region

HERE = Path(__file__).resolve().parent
SCRIPTS = HERE.parent / "_static" / "play"

WITHOUT_PARTS = {"explorer"}
"""Kinds that draw without ``parts.js``: buttons, a line that says what holds."""

WITHOUT_ROBOT = {"live"}
"""Kinds that show no robot of the package."""

WITHOUT_EXPLORER = WITHOUT_ROBOT | {"bodies", "circle", "contact", "scale", "switches"}
"""Kinds that mount no explorer: a page with these alone does without its scripts."""

LIGHTABLE = {"contact", "explorer", "scale", "switches"}
"""Kinds with a curve for each boundary of the paper's robot."""

NAMED = re.compile(r"(?:B_|\\beta_\{)([1-7])(?:(?:,\d){1,2}\})?")
"""A formula that is nothing but the name of a boundary, of a component or a bound of it."""

SCRIPTS_BEFORE = {
    "contact": ("regions",),
    "goals": ("regions",),
    "live": ("live_space", "live_scene"),
}
"""What stands before a kind's own script, in order."""

PAPER = "minervabot-v2"
"""The robot of a hook that names none."""

LOGGER = logging.getLogger(__name__)

Options = dict[str, str]


class Hooks(HTMLParser):
    """Collect the options of every hook in a piece of HTML."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[Options] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if tag == "div" and given.get("class") == "play":
            self.found.append(
                {k.removeprefix("data-"): v for k, v in given.items() if k.startswith("data-")}
            )


def hooks(page: nodes.document | None) -> list[Options]:
    """Return the options of a page's hooks, in the page's order."""
    parser = Hooks()
    for raw in page.findall(nodes.raw) if page else ():
        if "html" in raw["format"].split():
            parser.feed(raw.astext())
    return parser.found


def robot_key(hook: Options) -> str:
    """Name a robot's region as the loader does: its file, and the rule unless it is the usual."""
    rule = hook.get("rule", "clearance")
    return hook.get("robot", PAPER) + ("" if rule == "clearance" else f"-{rule}")


@cache
def region_of(robot: str, rule: str) -> Region:
    """Return the region that a hook names."""
    arm = load_robot(robot)
    return find_region(arm) if rule == "clearance" else solve(window_problem(window_region(arm)))


def own_script(name: str) -> tuple[str, str]:
    """Return one of our scripts as pages load it: address below ``_static``, shortened text."""
    text = (SCRIPTS / f"{name}.js").read_text(encoding="utf-8")
    return f"play/short/{name}.js", shorter_script(text)


def scripts_of(hook: Options) -> Iterator[tuple[str, str]]:
    """Yield the scripts that a hook needs: address below ``_static``, text."""
    kind, key = hook.get("figure", ""), robot_key(hook)
    if kind != "explorer" and not (SCRIPTS / f"{kind}.js").is_file():
        LOGGER.warning("no figure kind %r: there is no book/_static/play/%s.js", kind, kind)
        return
    for before in SCRIPTS_BEFORE.get(kind, ()):
        yield own_script(before)
    if kind in WITHOUT_ROBOT:
        yield own_script(kind)
        return
    name = hook.get("robot", PAPER)
    region = region_of(name, hook.get("rule", "clearance"))
    told = explorer_data(region, paths_of(name))
    yield f"play/robots/{key}.js", table_entry("qboundRobots", key, told)
    if module := data_module(kind):
        data = module.data(region)
        yield f"play/data/{kind}-{key}.js", table_entry("qboundData", f"{kind}-{key}", data)
    if kind != "explorer":
        yield own_script(kind)


def data_module(kind: str) -> ModuleType | None:
    """Return the module that says what figures of a kind are told, if there is one."""
    there = (HERE / "play_data" / f"{kind}.py").is_file()
    return importlib.import_module(f"play_data.{kind}") if there else None


def table_entry(table: str, key: str, value: Any) -> str:
    """Return a classic script that puts a value into one of the loader's tables."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return f"window.{table} ??= {{}};\nwindow.{table}[{json.dumps(key)}] = {text};\n"


def add_scripts(
    app: Sphinx,
    pagename: str,
    templatename: str,
    context: dict[str, Any],
    doctree: nodes.document | None,
) -> None:
    """Give a page with hooks the engine, what each hook needs, and last the loader."""
    found = hooks(doctree)
    if not found:
        return
    kinds = {hook.get("figure") for hook in found}
    files = {"play/engine.js": engine_script()}
    if kinds <= WITHOUT_EXPLORER:
        files = {"play/parts_of_engine.js": engine_script(explorer=False)}
    if kinds - WITHOUT_PARTS:
        files |= [own_script("parts")]
    files |= [script for hook in found for script in scripts_of(hook)]
    files |= [own_script("play")]
    for address, text in files.items():
        write_static(app, address, text)
        app.add_js_file(address, loading_method="defer")
    for kind in kinds:
        module = data_module(kind or "")
        for address, text in getattr(module, "files", dict)().items():
            write_static(app, address, text)
    write_static(app, "play/engine.css", engine_style())
    for address in ("play/engine.css", "play/play.css"):
        app.add_css_file(address)


def write_static(app: Sphinx, address: str, text: str) -> None:
    """Write a file that pages load, unless it stands there."""
    file = Path(app.outdir, "_static", address)
    if not file.exists() or file.read_text(encoding="utf-8") != text:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_whole(file, text.encode())


def name_curves(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Make the boundaries that the prose of a page names words that light their curves."""
    kinds = {hook.get("figure") for hook in hooks(doctree) if robot_key(hook).startswith(PAPER)}
    if app.builder.format != "html" or not kinds & LIGHTABLE:
        return
    for formula in list(doctree.findall(nodes.math)):
        named = NAMED.fullmatch(formula.astext())
        if named and isinstance(formula.parent, nodes.paragraph | nodes.caption):
            word = nodes.inline(classes=["lights", f"b{named[1]}"])
            formula.replace_self(word)
            word += formula


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register with Sphinx; pages of other builders than HTML keep their pictures."""
    app.connect("html-page-context", add_scripts)
    app.connect("doctree-resolved", name_curves)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
