"""Live figures as pages load them: their script and their style, and the page of one region.

The files in ``figure`` are classic scripts that see each other's names. A page loads them as one:
it then runs from a file, without a network, and keeps its own names.
"""

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

from cspace.explorer.data import Data, Walks, figure_data
from cspace.files import write_whole
from cspace.printable import printable
from cspace.region import Region, Slices

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

FRAME: Final = (
    '<iframe srcdoc="$page" title="$title" sandbox="allow-scripts" width="100%" height="860"'
    ' style="border: 0"'
    " onload=\"this.parentElement.querySelector(':scope > img')?.remove()\"></iframe>"
)
PICTURE: Final = (
    '<img src="data:image/svg+xml;base64,$content"'
    ' alt="The feasible poses of $name: the region of its two joints">'
)


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
        frame = Template(FRAME).substitute(
            page=escape(self.html), title=f"Explorer of {name}: its joint space beside the arm"
        )
        picture, drawn = "", self.region._repr_svg_()
        if drawn is not None:
            content = b64encode(drawn.encode()).decode()
            picture = Template(PICTURE).substitute(content=content, name=name)
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
    only its own script, because names and numbers of the robot are passed as data.

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
    name = escape(printable(region.robot.name))
    style = figures_style() + figure_text("page.css")
    script = figure_text("page.js") + figures_script("arm")
    return Template(figure_text("page.html")).substitute(
        title=f"{name}: feasible poses",
        name=name,
        policy=f"default-src 'none'; style-src {source_hash(style)};"
        f" script-src {source_hash(script)}; img-src data:",
        style=style,
        data=embedded(figure_data(region, walks, row)),
        script=script,
        summary=_summary(region),
    )


def figures_script(*kinds: str) -> str:
    """Return one script that draws figures of some kinds, of all if none is named."""
    left_out = {f"{kind}.js" for kind in KINDS if kinds and kind not in kinds}
    own = "".join(figure_text(name) for name in SCRIPTS if name not in left_out)
    return shorter_script(f'(() => {{\n"use strict";\n{own}}})();\n')


def figures_style() -> str:
    """Return the style of all figures."""
    return figure_text("figure.css")


def figure_script(key: str, data: Data) -> str:
    """Return the classic script that a page loads: a page opened from disk may load no JSON."""
    return f"(window.cspaceData ??= {{}})[{embedded(key)}] = {embedded(data)};\n"


def shorter_script(script: str) -> str:
    """Remove comments and indentation from a script.

    Texts in such a script must not cross the end of a line or contain a space and two slashes.
    """
    code = re.sub(r"^\s*/\*.*?\*/", "", script, flags=re.DOTALL | re.MULTILINE)
    lines = (re.sub(r"(^|\s+)//\s.*", "", line).strip() for line in code.splitlines())
    return "".join(f"{line}\n" for line in lines if line)


def figure_text(name: str) -> str:
    """Return a file of ``figure``."""
    return (resources.files("cspace") / "explorer" / "figure" / name).read_text(encoding="utf-8")


def embedded(data: Any) -> str:
    """Write JSON that no HTML parser can take for markup, whatever a name contains."""
    text = json.dumps(_shown(data), allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _shown(data: Any) -> Any:
    """Make every text of the data printable: a bidirectional mark would reverse the page's text."""
    if isinstance(data, dict):
        return {key: _shown(value) for key, value in data.items()}
    if isinstance(data, list):
        return [_shown(value) for value in data]
    return printable(data) if isinstance(data, str) else data


def source_hash(text: str) -> str:
    """Return the source expression of a content policy that allows only this style or script."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _summary(region: Region) -> str:
    """Return a description of the page in words, for a reader without scripts; escaped HTML."""
    count, joints = len(region.components), " and ".join(region.problem.joint_names)
    pieces = "one piece" if count == 1 else f"{count} pieces"
    by = region.robot.feasible_by
    return escape(printable(f"The values of {joints} that are feasible by {by} form {pieces}."))
