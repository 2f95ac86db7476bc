"""How the explorer's page is put together: one file in which a reader drags an arm.

The scripts, the style and the frame of the page stand in ``web``; here they are joined with the
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

from qbound.explorer.data import Data, Walks, explorer_data
from qbound.files import write_whole
from qbound.printable import printable
from qbound.region import Region, Slices

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
        Drawn where a notebook runs no script.
    html : str
        The page.
    """

    region: Region
    html: str

    def __repr__(self) -> str:
        """Say whose page it is, and how large."""
        return f"Explorer({self.region.robot.name!r}, {len(self.html.encode()) // 1000} kB of HTML)"

    def _repr_html_(self) -> str:
        """Show the page in a frame that shares nothing with the notebook around it.

        Before the frame stands the picture, which goes when the frame comes. Where a notebook is
        not trusted, or a site shows it without running anything, there is no frame: the picture
        stays.
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
        Regions along one of the held joints, this one among them: its slider shows them.

    Returns
    -------
    Explorer

    Raises
    ------
    ValueError
        If the region is of forms, not of a robot, or the row of slices is none of its own.

    Examples
    --------
    >>> from qbound import find_region, load_robot
    >>> page = explore(find_region(load_robot("pp-portal")))
    >>> page.save("portal.html")  # doctest: +SKIP
    """
    return Explorer(region, explorer_page(region, row=row))


def explorer_page(region: Region, walks: Walks = (), row: Slices | None = None) -> str:
    """Return the explorer of a robot as one self-contained HTML page (not in the paper).

    It opens from the file system, asks nothing of a network (a content policy forbids it), and runs
    no script but its own: names and numbers of the robot reach it as data.

    Parameters
    ----------
    region : Region
        Of a robot.
    walks : sequence of sequences of int, optional
        Orders in which a traversal visits the vertices, by index, besides once round.
    row : Slices, optional
        As in `explore`.

    Returns
    -------
    str
        UTF-8 HTML.

    Raises
    ------
    ValueError
        If the region is of forms, not of a robot, or the row of slices is none of its own.
    """
    data = _shown(explorer_data(region, walks, row))
    name = escape(printable(region.robot.name))
    style, script = engine_style() + web_text("page.css"), engine_script() + web_text("start.js")
    return Template(web_text("explorer.html")).substitute(
        title=f"{name}: safe poses",
        name=name,
        policy=f"default-src 'none'; style-src {source_hash(style)};"
        f" script-src {source_hash(script)}; img-src data:",
        style=style,
        data=embedded(data),
        script=script,
        summary=_summary(data),
    )


def engine_script(*, explorer: bool = True) -> str:
    """Return the engine: one classic script that defines `qboundEngine` and draws nothing yet.

    Its function ``mount(root, robot, options)`` holds the scripts in `EXPLORER`, so that their
    names belong to one explorer, and a page may have several. A page whose figures are of other
    kinds may do without: then `explorer` is false, and ``mount`` is null.
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
    """Leave out comments and indentation.

    No string of such a script may go over a line's end, or hold two slashes after a space.
    """
    code = re.sub(r"^\s*/\*.*?\*/", "", script, flags=re.DOTALL | re.MULTILINE)
    lines = (re.sub(r"(^|\s+)//\s.*", "", line).strip() for line in code.splitlines())
    return "".join(f"{line}\n" for line in lines if line)


def web_text(name: str) -> str:
    """Return a file of ``web``."""
    return (resources.files("qbound") / "explorer" / "web" / name).read_text(encoding="utf-8")


def _shown(data: Any) -> Any:
    """Make every text of the data printable: a bidirectional mark would turn the page's words."""
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
    """Return the source expression that lets just this style or script through."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _summary(data: Data) -> str:
    """Say in words what the page draws, for a reader without scripts; escaped HTML."""
    count = len(data["components"])
    joints = " and ".join(data["joints"][j]["name"] for j in data["free"])
    pieces = "one piece" if count == 1 else f"{count} pieces"
    text = f"The safe values of {joints} form {pieces}."
    if data["polygon"] is not None:
        corners = len(data["polygon"]["vertices"])
        text += f" The one with the home pose has {corners} vertices; the largest safe scale"
        text += f" of the polygon through them is {data['polygon']['largest']:.4f}."
    return escape(text)
