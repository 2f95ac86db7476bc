"""A surface of three joints as one page that a reader can rotate, without a network."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from string import Template
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from qbound.arms.surfaces import Surface, colour_of
from qbound.explorer.page import embedded, engine_style, shorter_script, source_hash, web_text
from qbound.printable import printable
from qbound.units import counted, joint_text

LARGEST: Final = 2**16 - 1
"""Of the whole numbers that a place is written with: parts of a range."""

SCRIPTS: Final = ("vectors.js", "frame.js", "surface.js", "surface_start.js")


def surface_page(surface: Surface) -> str:
    """Return the page of a surface as one self-contained HTML file (not in the paper).

    Places are rounded to a 65536th part of their axes' ranges, which is invisible.

    Raises
    ------
    ValueError
        If the surface has no triangle.
    """
    if not len(surface.triangles):
        raise ValueError("no boundary is active within these ranges: there is no surface to show")
    name = printable(surface.robot.name)
    style = engine_style() + web_text("surface.css")
    own = "".join(map(web_text, SCRIPTS))
    script = shorter_script(f"(() => {{\n{own}}})();\n")
    axes = ", ".join(_names(surface))
    return Template(web_text("surface.html")).substitute(
        title=escape(f"{name}: where {axes} are safe"),
        label=escape(f"The surface in the space of {axes}; its parts are listed beside it."),
        policy=f"default-src 'none'; style-src {source_hash(style)};"
        f" script-src {source_hash(script)}",
        style=style,
        summary=_summary(surface),
        pairs="".join(_row(k, each) for k, each in enumerate(surface.pairs)),
        facts=_facts(surface),
        data=embedded(surface_data(surface)),
        script=script,
    )


def surface_data(surface: Surface) -> dict[str, Any]:
    """Return the data of the page, schema qbound/surface-page/1."""
    low = np.array([axis.ends[0] for axis in surface.axes])
    wide = np.array([axis.ends[1] for axis in surface.axes]) - low
    parts = np.clip((surface.vertices - low) / wide, 0, 1)
    order = np.argsort(surface.pair, kind="stable")
    ends = np.concatenate([[0], np.cumsum(np.bincount(surface.pair))]).tolist()
    return {
        "schema": "qbound/surface-page/1",
        "axes": [_axis(surface, k) for k in range(3)],
        "places": _packed(np.rint(parts * LARGEST).astype("<u2")),
        "triangles": _packed(surface.triangles[order].astype("<u4")),
        "pairs": [
            {"name": printable(each), "colour": colour_of(k), "triangles": [ends[k], ends[k + 1]]}
            for k, each in enumerate(surface.pairs)
        ],
    }


def _axis(surface: Surface, k: int) -> dict[str, Any]:
    axis = surface.axes[k]
    joint = surface.robot.joints[axis.joint]
    unit = "°" if joint.turns else surface.robot.length_unit
    ends = [end * joint.shown_scale for end in axis.ends]
    return {"name": printable(joint.name), "unit": unit, "ends": ends}


def _packed(numbers: NDArray[Any]) -> str:
    return b64encode(np.ascontiguousarray(numbers).tobytes()).decode()


def _names(surface: Surface) -> list[str]:
    return [printable(surface.robot.joints[axis.joint].name) for axis in surface.axes]


def _row(k: int, name: str) -> str:
    """Return one line of the list: a box to tick, a colour, a name."""
    square = f'<rect width="18" height="18" rx="3" fill="{colour_of(k)}"/>'
    key = f'<svg viewBox="0 0 18 18" aria-hidden="true">{square}</svg>'
    text = escape(printable(name))
    return f'<li><label><input type="checkbox" checked>{key}<span>{text}</span></label></li>'


def _summary(surface: Surface) -> str:
    """Return a sentence that describes the picture; escaped HTML."""
    count = len(surface.pairs)
    parts = "one pair" if count == 1 else f"{count} pairs"
    text = f"Where safe values of {', '.join(_names(surface))} end: the surface has a colour for"
    return escape(f"{text} each of the {parts} of links that touch on it.")


def _facts(surface: Surface) -> str:
    """Return the held values, the steps of the grid, and the open sides; escaped HTML."""
    robot = surface.robot
    held = joint_text(robot, list(surface.held.values()), surface.held)
    around = [name for name, axis in zip(_names(surface), surface.axes, strict=True) if axis.around]
    vertices = counted(len(surface.vertices), "vertex", "vertices")
    lines = [
        f"Held: {printable(held)}." if surface.held else "No joint is held.",
        f"A grid of {surface.resolution} steps a joint: what is smaller may be missing.",
        f"{vertices}, {int(surface.exact.sum())} of them on their boundary to 12 digits.",
    ]
    if around:
        lines.append(f"What ends at one end of {', '.join(around)} goes on at the other.")
    if not surface.capped and len(around) < len(surface.axes):
        lines.append("At joint limits the surface is open.")
    return escape(" ".join(lines))
