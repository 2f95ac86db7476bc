"""Wide pictures: in a box that scrolls, or, where panels stand side by side, stacked on a phone.

A panel is a view of the same file, so nothing is drawn or stored twice. The style sheet shows
either the whole picture or its panels.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote
from xml.etree import ElementTree

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

# A picture wider than this has panels side by side, too small to read on a phone; in points.
WIDEST_PANEL = 6.5 * 72

SVG = "{http://www.w3.org/2000/svg}"
PLACED = re.compile(r"translate\(([-\d.]+) ([-\d.]+)\)( rotate\(-90\))?(?: scale\(([\d.]+))?")
NUMBER = re.compile(r"[ML] ([-\d.]+) [-\d.]+")

# Beyond the last glyph's start its own width, in the units of a font of 100; about the widest.
GLYPH = 80
AROUND = 1  # points kept free beside a panel's letters


class Span(NamedTuple):
    """What a part of a drawing takes from left to right, in points."""

    left: float
    right: float


class View(NamedTuple):
    """A part of a picture: its left edge, width and height, in points."""

    left: float
    width: float
    height: float


class panel_image(nodes.image):
    """One panel of a picture: ``view`` says which part of the file it shows."""


class WidePictures(SphinxPostTransform):
    """Put every wide picture into a box, and its panels, if it has any, into another beside it."""

    default_priority = 900

    def run(self, **kwargs: Any) -> None:
        for image in list(self.document.findall(nodes.image)):
            file = Path(self.app.srcdir, image["uri"])
            if width_in_points(file) > WIDEST_PANEL:
                shown = image.parent if isinstance(image.parent, nodes.reference) else image
                shown.replace_self(boxes(image, shown, panels_of(file)))


def boxes(image: nodes.image, shown: nodes.Element, views: list[View]) -> list[nodes.Element]:
    """Return the box of the whole picture and, with several views, the box of its panels."""
    whole = nodes.container(classes=["wide-figure"])
    whole += shown.deepcopy()
    if not views:
        return [whole]
    whole["classes"].append("has-panels")
    stacked = nodes.container(classes=["panels"])
    for number, view in enumerate(views, start=1):
        alt = f"{image.get('alt', '')} (Panel {number} of {len(views)}.)"
        panel = panel_image("", **image.attributes | {"alt": alt, "view": view})
        stacked += panel if shown is image else shown.copy()
        if shown is not image:  # the picture is a link, and so are its panels
            stacked[-1] += panel
    return [whole, stacked]


def width_in_points(file: Path) -> float:
    """Return the width that an SVG file states in points, else 0."""
    stated = root_of(file).get("width", "") if file.suffix == ".svg" and file.is_file() else ""
    return float(stated.removesuffix("pt")) if stated.endswith("pt") else 0.0


def root_of(file: Path) -> ElementTree.Element:
    return ElementTree.parse(file).getroot()


def panels_of(file: Path) -> list[View]:
    """Return the views that cut a drawing between its columns of axes; none where nothing cuts."""
    root = root_of(file)
    _, _, width, height = map(float, root.get("viewBox", "0 0 0 0").split())
    drawn = root.findall(f".//{SVG}g[@id='figure_1']/{SVG}g")
    axes = [span_of_axes(g) for g in drawn if g.get("id", "").startswith("axes_")]
    loose = [span(texts_in(g)) for g in drawn if g.get("id", "").startswith(("text_", "legend_"))]
    columns = merged(axes)
    if len(columns) < 2:
        return []
    between = [(one.right + two.left) / 2 for one, two in pairwise(columns)]
    if any(part.left < cut < part.right for part in [*columns, *loose] for cut in between):
        return []
    return [View(a, b - a, height) for a, b in pairwise([0.0, *between, width])]


def span_of_axes(group: ElementTree.Element) -> Span:
    """Return what axes take: their frame, and the letters around it."""
    frame = group.find(f"{SVG}g/{SVG}path")
    edges = [float(x) for x in NUMBER.findall(frame.get("d", ""))] if frame is not None else []
    return span([*edges, *texts_in(group)])


def texts_in(group: ElementTree.Element) -> Iterator[float]:
    """Yield the left and the right end of each text of a drawing."""
    for text in group.iter(f"{SVG}g"):
        placed = PLACED.match(text.get("transform", ""))
        if placed is None or placed[4] is None:
            continue
        x, scale = float(placed[1]), float(placed[4])
        starts = [PLACED.match(use.get("transform", "")) for use in text.iter(f"{SVG}use")]
        length = max((float(start[1]) for start in starts if start), default=0.0) + GLYPH
        upright = placed[3] is not None
        yield x - (scale * GLYPH if upright else 0) - AROUND
        yield x + (0 if upright else scale * length) + AROUND


def span(edges: Iterator[float] | list[float]) -> Span:
    found = list(edges) or [0.0]
    return Span(min(found), max(found))


def merged(spans: list[Span]) -> list[Span]:
    """Return the columns: spans that overlap stand above one another."""
    columns: list[Span] = []
    for one in sorted(spans):
        if columns and one.left < columns[-1].right:
            columns[-1] = Span(columns[-1].left, max(columns[-1].right, one.right))
        else:
            columns.append(one)
    return columns


def visit_panel_image(translator: Any, node: panel_image) -> None:
    """Write the picture's file with the view as the address's fragment."""
    builder, view = translator.builder, node["view"]
    file = posixpath.join(builder.imgpath, quote(builder.images[node["uri"]]))
    part = f"{view.left:.1f},0,{view.width:.1f},{view.height:.1f}"
    translator.body.append(
        f'<img src="{file}#svgView(viewBox({part}))" alt="{escape(node["alt"])}"'
        f' style="aspect-ratio: {view.width:.1f} / {view.height:.1f}">\n'
    )
    raise nodes.SkipNode


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the transform and the panels with Sphinx."""
    app.add_node(panel_image, html=(visit_panel_image, None))
    app.add_post_transform(WidePictures)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
