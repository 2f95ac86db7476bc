"""Wide pictures: in a box that scrolls, or, where panels stand side by side, stacked on a phone.

A panel is a view of the same file, so nothing is drawn or stored twice. Its column ends where the
leftmost letter of the axes to its right stands. The style sheet shows either the whole picture or
its panels.
"""

from __future__ import annotations

import posixpath
import re
from html import escape
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote
from xml.etree import ElementTree

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

WIDEST_PANEL = 6.3 * 72
"""A wider picture is too small to read on a phone, or has panels side by side; in points."""

LARGEST = 2  # pixels for a point: a narrow panel is not blown up to the width of a phone
AROUND = 4  # points above and below a panel, for marks on its frame and letters below their line
SVG = "{http://www.w3.org/2000/svg}"
CORNER = re.compile(r"[ML] ([-\d.]+) ([-\d.]+)")
TEXT = re.compile(r"translate\(([-\d.]+) ([-\d.]+)\)( rotate\(-90\))? scale\(([\d.]+)")
LETTER = 100  # the height of a letter, in the units of a text


class Panel(NamedTuple):
    """The part of a drawing that axes take, in points from its top left corner."""

    left: float
    top: float
    right: float
    bottom: float


class panel_image(nodes.image):
    """One panel of a picture: ``view`` says which part of the file it shows."""


class WidePictures(SphinxPostTransform):
    """Put every wide picture into a box, and its panels, if it has any, into another beside it."""

    default_priority = 900

    def run(self, **kwargs: Any) -> None:
        for image in list(self.document.findall(nodes.image)):
            file = Path(self.app.srcdir, image["uri"])
            if file.suffix != ".svg" or not file.is_file():
                continue
            drawing = ElementTree.parse(file).getroot()
            if float(drawing.get("width", "").removesuffix("pt") or 0) > WIDEST_PANEL:
                views, columns = panels_of(drawing)
                kind = "has-panels" if views else "one-column" if columns == 1 else "columns"
                boxes = [nodes.container("", image.deepcopy(), classes=["wide-figure", kind])]
                boxes += [nodes.container(classes=["panels"])] if views else []
                for number, view in enumerate(views, start=1):
                    alt = f"{image.get('alt', '')} (Panel {number} of {len(views)}.)"
                    boxes[1] += panel_image("", **image.attributes | {"alt": alt, "view": view})
                image.replace_self(boxes)


def panels_of(drawing: ElementTree.Element) -> tuple[list[Panel], int]:
    """Return the panels of a drawing in the order of its axes, and the number of its columns.

    There are none where all axes stand in one column, or something belongs to all of them.
    """
    parts = drawing.findall(f".//{SVG}g[@id='figure_1']/{SVG}g")
    axes = [drawn(part) for part in parts if part.get("id", "").startswith("axes_")]
    width = float(drawing.get("viewBox", "0 0 0 0").split()[2])
    ends = [min((o.left for o in axes if o.left >= one.right), default=width) for one in axes]
    columns = len(set(ends))
    if columns < 2 or any(part.get("id", "").startswith(("text_", "legend_")) for part in parts):
        return [], columns
    starts = [max((end for end in ends if end <= one.left), default=0.0) for one in axes]
    both = zip(axes, starts, ends, strict=True)
    return [one._replace(left=left, right=right) for one, left, right in both], columns


def drawn(axes: ElementTree.Element) -> Panel:
    """Return what axes take, with the letters around them; on the right the frame ends it."""
    path = axes.find(f"{SVG}g/{SVG}path")
    corners = CORNER.findall("M 0 0" if path is None else path.get("d", ""))  # axes without a frame
    xs, ys = [float(x) for x, _ in corners], [float(y) for _, y in corners]
    right = max(xs)
    for group in axes.iter(f"{SVG}g"):
        if text := TEXT.match(group.get("transform", "")):
            x, y, high = float(text[1]), float(text[2]), LETTER * float(text[4])
            xs.append(x - high if text[3] else x)  # a turned text stands left of its line
            ys += [y] if text[3] else [y - high, y]
    return Panel(min(xs), max(0.0, min(ys) - AROUND), right, max(ys) + AROUND)


def visit_panel_image(translator: Any, node: panel_image) -> None:
    """Write the picture's file with the view as the address's fragment."""
    builder, (left, top, right, bottom) = translator.builder, node["view"]
    file = posixpath.join(builder.imgpath, quote(builder.images[node["uri"]]))
    width, height = right - left, bottom - top
    widest = max(one["view"].right - one["view"].left for one in node.parent)  # one size of letters
    translator.body.append(
        f'<img src="{file}#svgView(viewBox({left:.1f},{top:.1f},{width:.1f},{height:.1f}))"'
        f' alt="{escape(node["alt"])}" style="aspect-ratio: {width:.1f} / {height:.1f};'
        f' width: {100 * width / widest:.0f}%; max-width: {width * LARGEST:.0f}px">\n'
    )
    raise nodes.SkipNode


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the transform and the panels with Sphinx."""
    app.add_node(panel_image, html=(visit_panel_image, None))
    app.add_post_transform(WidePictures)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
