"""The explorer's page: one file in which a reader drags an arm.

The scripts, the style and the frame of the page are in ``web``. This module joins them with the
data of one region.
"""

from __future__ import annotations

import json
import re
from base64 import b64encode
from dataclasses import dataclass
from hashlib import sha256
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any, Final

from cspace.explorer.data import Data, Walks, explorer_data
from cspace.files import write_whole
from cspace.printable import printable
from cspace.region import Region, Slices

ARITHMETIC: Final = (
    "vectors.js",
    "roots.js",
    "arcs.js",
    "kinematics.js",
    "contacts.js",
    "postures.js",
    "fibres.js",
    "polygons.js",
)
"""What repeats the library's computations and knows no page."""

PICTURES: Final = ("drawing.js", "hands.js", "player.js", "joint_space.js", "arm.js", "parts.js")
ENGINE: Final = (*ARITHMETIC, *PICTURES, "engine.js")
"""What every figure of a page shares."""

EXPLORER: Final = ("state.js", "words.js", "show.js", "play.js", "frame.js", "controls.js")
"""What each explorer has for itself: its state, and what shows it."""

SCRIPTS: Final = (*ENGINE, *EXPLORER, "start.js")


@dataclass(frozen=True)
class Explorer:
    """The explorer of one region: shown in a notebook, or saved as a page of its own.

    Attributes
    ----------
    region : Region
        The region, drawn as a picture where a notebook runs no script.
    html : str
        The page.
    """

    region: Region
    html: str

    def __repr__(self) -> str:
        """Show the robot and the size of the page."""
        return f"Explorer({self.region.robot.name!r}, {len(self.html.encode()) // 1000} kB of HTML)"

    def _repr_html_(self) -> str:
        """Show the page in a frame that shares nothing with the notebook around it.

        A picture comes first and disappears when the frame is shown. If a notebook is not trusted,
        or a site shows it without running scripts, there is no frame and the picture stays.
        """
        name = escape(printable(self.region.robot.name))
        frame = Template(web_text("frame.html")).substitute(
            page=escape(self.html), title=f"Explorer of {name}: its joint space beside the arm"
        )
        picture, drawn = "", self.region._repr_svg_()
        if drawn is not None:
            content = b64encode(drawn.encode()).decode()
            picture = Template(web_text("picture.html")).substitute(content=content, name=name)
        return f"<div>\n{picture}{frame}</div>"

    def save(self, path: str | Path) -> None:
        """Write the page to a file, whole; any browser opens it without a network."""
        write_whole(path, self.html.encode())


def explore(region: Region, row: Slices | None = None) -> Explorer:
    """Return the explorer of a region.

    Parameters
    ----------
    region : Region
        Of a robot.
    row : Slices, optional
        Regions along one of the held joints, including this one; a slider shows them.

    Returns
    -------
    Explorer

    Raises
    ------
    ValueError
        If the region is not of a robot, or the row of slices does not belong to it.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> page = explore(find_region(load_robot("pp-portal")))
    >>> page.save("portal.html")  # doctest: +SKIP
    """
    return Explorer(region, explorer_page(region, row=row))


def explorer_page(region: Region, walks: Walks = (), row: Slices | None = None) -> str:
    """Return the explorer of a robot as one self-contained HTML page (not in the paper).

    The page opens from the file system and uses no network (a content policy forbids it). It runs
    only its own scripts, because names and numbers of the robot are passed as data.

    Parameters
    ----------
    region : Region
        Of a robot.
    walks : sequence of sequences of int, optional
        Further orders in which a traversal visits the vertices, by index.
    row : Slices, optional
        As in `explore`.

    Returns
    -------
    str
        UTF-8 HTML.

    Raises
    ------
    ValueError
        If the region is not of a robot, or the row of slices does not belong to it.
    """
    data = _shown(explorer_data(region, walks, row))
    name = escape(printable(region.robot.name))
    style, script = engine_style() + web_text("page.css"), engine_script() + web_text("start.js")
    return Template(web_text("explorer.html")).substitute(
        title=f"{name}: feasible poses",
        name=name,
        policy=f"default-src 'none'; style-src {source_hash(style)};"
        f" script-src {source_hash(script)}; img-src data:",
        style=style,
        data=embedded(data),
        script=script,
        summary=_summary(data),
    )


def engine_script(*, explorer: bool = True) -> str:
    """Return the engine: a classic script that defines `qboundEngine` and draws nothing by itself.

    Its function ``mount(root, robot, options)`` holds the scripts in `EXPLORER`, so that their
    names belong to one explorer, and a page may have several. A page that has only other kinds of
    figures needs no explorer: then `explorer` is false and ``mount`` is null.
    """
    shared = "".join(map(web_text, ENGINE))
    mount = "const mount = null;\n"
    if explorer:
        own, markup = "".join(map(web_text, EXPLORER)), embedded(web_text("parts.html"))
        mount = f"const MARKUP = {markup};\n"
        mount += f"function mount(root, robot, options = {{}}) {{\n{own}return explorer;\n}}\n"
    return shorter_script(f"(() => {{\n{mount}{shared}}})();\n")


def engine_style() -> str:
    """Return the style of an explorer: every rule stands below the class ``qbound``."""
    return web_text("explorer.css")


def shorter_script(script: str) -> str:
    """Remove comments and indentation from a script.

    Strings in such a script must not cross the end of a line or contain a space and two slashes.
    """
    code = re.sub(r"^\s*/\*.*?\*/", "", script, flags=re.DOTALL | re.MULTILINE)
    lines = (re.sub(r"(^|\s+)//\s.*", "", line).strip() for line in code.splitlines())
    return "".join(f"{line}\n" for line in lines if line)


def web_text(name: str) -> str:
    """Return a file of ``web``."""
    return (resources.files("cspace") / "explorer" / "web" / name).read_text(encoding="utf-8")


def _shown(data: Any) -> Any:
    """Make every text of the data printable: a bidirectional mark would reverse the page's text."""
    if isinstance(data, dict):
        return {key: _shown(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_shown(value) for value in data]
    return printable(data) if isinstance(data, str) else data


def embedded(data: Any) -> str:
    """Write JSON that no HTML parser can take for markup, whatever a name contains."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def source_hash(text: str) -> str:
    """Return the source expression of a content policy that allows only this style or script."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _summary(data: Data) -> str:
    """Return a description of the page in words, for a reader without scripts; escaped HTML."""
    count = len(data["components"])
    joints = " and ".join(data["joints"][j]["name"] for j in data["free"])
    pieces = "one piece" if count == 1 else f"{count} pieces"
    text = f"The values of {joints} that are feasible by {data['feasible_by']} form {pieces}."
    if data["polygon"] is not None:
        corners = len(data["polygon"]["vertices"])
        text += f" The one with the home pose has {corners} vertices; the largest feasible scale"
        text += f" of the polygon through them is {data['polygon']['largest']:.4f}."
    return escape(text)
