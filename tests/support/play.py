"""A figure that a reader moves: a page with it alone, and its arithmetic in Node."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from cspace import Region, find_region, load_robot
from cspace.explorer.data import explorer_data
from cspace.explorer.page import ENGINE, engine_script, engine_style, web_text
from cspace.region import solve, window_problem
from engine_support.browser import broken_rules, rules_in, settle
from engine_support.javascript import Script
from engine_support.scripts import load_script
from lizarraga2025.evidence.tool_paths import LEFT, RIGHT
from qbound import window_region

ROOT = Path(__file__).resolve().parents[2]
PLAY = ROOT / "book" / "_static" / "play"
PAPER = "minervabot-v2"
ROBOTS = {"goals": "two-links-on-a-table"}
"""Of kinds that show another robot than the paper's."""

WIDTHS = {"wide screen": 900, "phone": 340}

LIVE = ("parts", "live_space", "live_scene", "live", "play")
"""Scripts of the page "Configuration space, live", which mounts no explorer."""

SCRIPTS_BEFORE = {"contact": ("regions",), "goals": ("regions",)}
"""As the book's extension has them."""

PAGE = """<!doctype html><html lang="en" data-theme="{theme}"><meta charset="utf-8">
<meta name="viewport" content="width=device-width"><title>A figure</title>
<style>:root {{ color-scheme: {theme} }}
body {{ background: light-dark(#fff, #12181b); margin: 8px }}
{style}</style><main><h1>A figure</h1>
<p>Here <span class="lights b3">B3</span> is named.</p>
<div class="play" data-figure="{kind}" data-rule="{rule}" {options}></div></main>
<script>{script}</script>"""
KEEP = (
    "const mount = qboundEngine.mount; qboundEngine.mount = (...a) => (window.arm = mount(...a));"
)
NO_PAGE = "const window = globalThis, mount = null;"


@cache
def region(rule: str = "clearance", robot: str = PAPER) -> Region:
    arm = load_robot(robot)
    return find_region(arm) if rule == "clearance" else solve(window_problem(window_region(arm)))


@cache
def told(kind: str) -> ModuleType:
    """The module of the book's extension that says what figures of a kind are told."""
    return load_script(f"book/_ext/play_data/{kind}.py")


@cache
def own_data(kind: str) -> str:
    return json.dumps(told(kind).data(region(robot=ROBOTS[kind])))


@cache
def data(rule: str = "clearance", robot: str = PAPER) -> str:
    """What the figures of a robot are told, as JSON."""
    walks = (RIGHT, LEFT) if robot.startswith(PAPER) else ()
    return json.dumps(explorer_data(region(rule, robot), walks))


# --- in a page ------------------------------------------------------------------------------------


def page_of(kind: str, rule: str, theme: str, options: str = "") -> str:
    """Return the page that the book's extension makes of one hook, in one file.

    Its script knows the mounted arm, if it has one, as `arm`.
    """
    style = engine_style() + (PLAY / "play.css").read_text(encoding="utf-8")
    if kind == "live":
        script = engine_script(explorer=False) + scripts(*LIVE)
        return PAGE.format(
            kind=kind, rule=rule, options=options, theme=theme, style=style, script=script
        )
    robot = ROBOTS.get(kind, PAPER)
    key = robot + ("" if rule == "clearance" else f"-{rule}")
    script = (
        engine_script() + f"window.qboundRobots = {{ {json.dumps(key)}: {data(rule, robot)} }};\n"
    )
    if robot != PAPER:
        options += f' data-robot="{robot}"'
        script += f"window.qboundData = {{ {json.dumps(f'{kind}-{key}')}: {own_data(kind)} }};\n"
    script += KEEP + "\n"
    own = [] if kind == "explorer" else [*SCRIPTS_BEFORE.get(kind, ()), kind]
    script += scripts("parts", *own, "play")
    return PAGE.format(
        kind=kind, rule=rule, options=options, theme=theme, style=style, script=script
    )


def scripts(*names: str) -> str:
    return "".join((PLAY / f"{name}.js").read_text(encoding="utf-8") for name in names)


def opened(open_one: Callable[..., Any], folder: Path) -> Callable[..., Any]:
    """Return what opens figures, each alone on its page, given what opens addresses."""

    def open_figure(
        kind: str, rule: str, hook: str = "", theme: str = "light", width: int = 900, **options: Any
    ) -> Any:
        file = folder / f"{kind}-{theme}.html"
        file.write_text(page_of(kind, rule, theme, hook), encoding="utf-8")
        return open_one(file.as_uri(), viewport={"width": width, "height": 1000}, **options)

    return open_figure


@pytest.fixture
def open_play(open_quietly: Callable[..., Any], tmp_path: Path) -> Callable[..., Any]:
    """Open figures, each alone on its page."""
    return opened(open_quietly, tmp_path)


LOST = """() => [...document.querySelectorAll(".play *:not(svg *)")]
  .filter((part) => part.getBoundingClientRect().right > innerWidth + 1)
  .map((part) => part.outerHTML)"""
WEAR_THEME = """(theme) => {
  const { dataset, style } = document.documentElement;
  dataset.theme = style.colorScheme = theme;
}"""


def assert_fits_and_is_accessible(page: Any) -> None:
    """Nothing leaves the page, and in the light and in the dark no rule is broken."""
    for theme in ("light", "dark"):
        page.evaluate(WEAR_THEME, theme)
        settle(page)
        assert page.evaluate(LOST) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        assert broken_rules(page, **rules_in(theme)) == [], theme


# --- in Node --------------------------------------------------------------------------------------


class Kind(Script):
    """The arithmetic of one kind of figure, and the robot that it shows."""

    def __init__(self, name: str, rule: str = "clearance", robot: str = PAPER) -> None:
        super().__init__(
            NO_PAGE,
            *map(web_text, ENGINE),
            *((PLAY / f"{script}.js").read_text("utf-8") for script in ("parts", name)),
            f"const robot = {data(rule, robot)}, kind = qboundFigures.{name};",
        )
        self.region = region(rule, robot)


kind = cache(Kind)
