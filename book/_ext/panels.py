"""Wide pictures: in a box that scrolls, or, where panels stand side by side, stacked on a phone.

A panel is a view of the same file, so nothing is drawn or stored twice. The style sheet shows
either the whole picture or its panels.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterable, Iterator
from html import escape
from itertools import pairwise, product
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote
from xml.etree import ElementTree

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.typing import ExtensionMetadata

# A picture wider than this is too small to read on a phone, or has panels side by side; in points.
WIDEST_PANEL = 6.3 * 72

SVG = "{http://www.w3.org/2000/svg}"
PLACED = re.compile(r"translate\(([-\d.]+) ([-\d.]+)\)( rotate\(-90\))?(?: scale\(([\d.]+))?")
POINT = re.compile(r"[ML] ([-\d.]+) ([-\d.]+)")

# Of a glyph, in the units of a font of 100: about the widest, and how far one hangs below its line.
WIDE, DEEP = 80, 25
LARGEST = 2  # pixels for a point: a narrow panel is not blown up to the width of a phone
AROUND = 1  # points kept free between a panel's letters and the next panel's
ABOVE = 8  # points kept free above and below a panel, for marks that stand out of its frame


class Box(NamedTuple):
    """What a part of a drawing takes, in points, from the top left corner."""

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
            if file.suffix == ".svg" and file.is_file():
                drawing = ElementTree.parse(file).getroot()
                if width_in_points(drawing) > WIDEST_PANEL:
                    shown = image.parent if isinstance(image.parent, nodes.reference) else image
                    shown.replace_self(boxes(image, shown, drawing))


def boxes(
    image: nodes.image, shown: nodes.Element, drawing: ElementTree.Element
) -> list[nodes.Element]:
    """Return the box of the whole picture and, with several views, the box of its panels."""
    whole = nodes.container(classes=["wide-figure"])
    whole += shown.deepcopy()
    views = panels_of(drawing)
    if not views:
        whole["classes"] += ["one-column"] * (len(columns_of(axes_in(drawing))) < 2)
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


def width_in_points(drawing: ElementTree.Element) -> float:
    """Return the width that a drawing states in points, else 0."""
    stated = drawing.get("width", "")
    return float(stated.removesuffix("pt")) if stated.endswith("pt") else 0.0


def panels_of(drawing: ElementTree.Element) -> list[Box]:
    """Return the parts between cuts through a drawing, row by row; none where no cut is free.

    Only drawings with panels side by side are cut, and between rows only if all columns allow it.
    """
    _, _, width, height = map(float, drawing.get("viewBox", "0 0 0 0").split())
    loose = [box_of(texts_in(part)) for part in drawn_parts(drawing, "text_", "legend_")]
    axes = axes_in(drawing)
    columns, rows = columns_of(axes), rows_of(axes)
    across = [(one.right + two.left) / 2 for one, two in pairwise(columns)]
    if not across or any(
        part.left < cut < part.right for part in [*columns, *loose] for cut in across
    ):
        return []
    down = [(one.bottom + two.top) / 2 for one, two in pairwise(rows)]
    if any(part.top < cut < part.bottom for part in loose for cut in down):
        down = []
    cells = product(pairwise([0.0, *down, height]), pairwise([0.0, *across, width]))
    return [
        Box(left, max(top, content.top - ABOVE), right, min(bottom, content.bottom + ABOVE))
        for (top, bottom), (left, right) in cells
        if (inside := [one for one in axes if is_in(one, Box(left, top, right, bottom))])
        for content in [box_of(inside)]
    ]


def is_in(part: Box, cell: Box) -> bool:
    """Tell whether the middle of a part lies in a cell."""
    across, down = (part.left + part.right) / 2, (part.top + part.bottom) / 2
    return cell.left < across < cell.right and cell.top < down < cell.bottom


def drawn_parts(drawing: ElementTree.Element, *kinds: str) -> list[ElementTree.Element]:
    """Return the parts of a drawing whose ids begin in one of these ways."""
    drawn = drawing.findall(f".//{SVG}g[@id='figure_1']/{SVG}g")
    return [part for part in drawn if part.get("id", "").startswith(kinds)]


def axes_in(drawing: ElementTree.Element) -> list[Box]:
    """Return what each axes of a drawing takes, with the texts around it."""
    return [box_of(axes_of(part)) for part in drawn_parts(drawing, "axes_")]


def axes_of(group: ElementTree.Element) -> Iterator[Box]:
    """Yield the frame of axes and each text around it."""
    frame = group.find(f"{SVG}g/{SVG}path")
    corners = POINT.findall(frame.get("d", "")) if frame is not None else []
    for x, y in corners:
        yield Box(float(x), float(y), float(x), float(y))
    yield from texts_in(group)


def texts_in(group: ElementTree.Element) -> Iterator[Box]:
    """Yield what each text of a drawing takes."""
    for text in group.iter(f"{SVG}g"):
        placed = PLACED.match(text.get("transform", ""))
        if placed is None or placed[4] is None:
            continue
        x, y, scale = (float(placed[i]) for i in (1, 2, 4))
        starts = [PLACED.match(use.get("transform", "")) for use in text.iter(f"{SVG}use")]
        length = scale * (max((float(start[1]) for start in starts if start), default=0.0) + WIDE)
        high, deep = scale * WIDE, scale * DEEP
        if placed[3]:  # turned by a quarter: it runs upwards
            yield Box(x - high - AROUND, y - length, x + deep + AROUND, y)
        else:
            yield Box(x - AROUND, y - high, x + length + AROUND, y + deep)


def box_of(parts: Iterable[Box]) -> Box:
    """Return the box around all parts."""
    lefts, tops, rights, bottoms = zip(*(list(parts) or [Box(0, 0, 0, 0)]), strict=True)
    return Box(min(lefts), min(tops), max(rights), max(bottoms))


def columns_of(axes: Iterable[Box]) -> list[Box]:
    """Return the columns from left to right: axes that overlap stand above one another."""
    return merged(sorted(axes), lambda box: (box.left, box.right))


def rows_of(axes: Iterable[Box]) -> list[Box]:
    """Return the rows from top to bottom: axes that overlap stand side by side."""
    return merged(sorted(axes, key=lambda box: box.top), lambda box: (box.top, box.bottom))


def merged(parts: Iterable[Box], ends: Callable[[Box], tuple[float, float]]) -> list[Box]:
    """Return parts in order of their first ends, those that overlap as one."""
    found: list[Box] = []
    for one in parts:
        if found and ends(one)[0] < ends(found[-1])[1]:
            found[-1] = box_of([found[-1], one])
        else:
            found.append(one)
    return found


def visit_panel_image(translator: Any, node: panel_image) -> None:
    """Write the picture's file with the view as the address's fragment."""
    builder, box = translator.builder, node["view"]
    file = posixpath.join(builder.imgpath, quote(builder.images[node["uri"]]))
    width, height = box.right - box.left, box.bottom - box.top
    part = f"{box.left:.1f},{box.top:.1f},{width:.1f},{height:.1f}"
    translator.body.append(
        f'<img src="{file}#svgView(viewBox({part}))" alt="{escape(node["alt"])}"'
        f' style="aspect-ratio: {width:.1f} / {height:.1f}; max-width: {width * LARGEST:.0f}px">\n'
    )
    raise nodes.SkipNode


def setup(app: Sphinx) -> ExtensionMetadata:
    """Register the transform and the panels with Sphinx."""
    app.add_node(panel_image, html=(visit_panel_image, None))
    app.add_post_transform(WidePictures)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
