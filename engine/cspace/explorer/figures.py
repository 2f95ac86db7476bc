"""The scripts and the style of live figures, which pages of the book and the explorer share.

The files in ``figure`` are classic scripts that see each other's names. A page loads them as one:
it then runs from a file, without a network, and keeps its own names.
"""

from __future__ import annotations

import re
from importlib import resources
from typing import Final

ARITHMETIC: Final = ("geometry.js", "space.js")
"""Scripts that know no page."""

KINDS: Final = ("arm", "circle", "functions", "scale", "bounds", "walk", "angle", "live")
"""Kinds of figures; each has a script of its name."""

SCRIPTS: Final = (
    "html.js",
    *ARITHMETIC,
    "draw.js",
    "figure.js",
    *(f"{kind}.js" for kind in KINDS),
    "start.js",
)


def figures_script(*kinds: str) -> str:
    """Return one script that draws figures of some kinds, of all if none is named."""
    left_out = {f"{kind}.js" for kind in KINDS if kinds and kind not in {"arm", *kinds}}
    own = "".join(figure_text(name) for name in SCRIPTS if name not in left_out)
    return shorter_script(f'(() => {{\n"use strict";\n{own}}})();\n')


def figures_style() -> str:
    """Return the style of all figures."""
    return figure_text("figure.css")


def figure_text(name: str) -> str:
    """Return a file of ``figure``."""
    return (resources.files("cspace") / "explorer" / "figure" / name).read_text(encoding="utf-8")


def shorter_script(script: str) -> str:
    """Remove comments and indentation from a script.

    Texts in such a script must not cross the end of a line or contain a space and two slashes.
    """
    code = re.sub(r"^\s*/\*.*?\*/", "", script, flags=re.DOTALL | re.MULTILINE)
    lines = (re.sub(r"(^|\s+)//\s.*", "", line).strip() for line in code.splitlines())
    return "".join(f"{line}\n" for line in lines if line)
