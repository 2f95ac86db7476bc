"""Figures of pavings: cells of two joints as filled boxes, drawn as one picture inside the SVG."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from qbound.proofs.exact.bounds import BoxBounds, Cells

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes


def draw_cells(ax: Axes, bounds: BoxBounds, cells: Iterable[Cells], **style: Any) -> list[Artist]:
    """Fill cells of two revolute joints, degrees; an empty list of cells draws nothing."""
    from matplotlib.collections import PolyCollection

    corners = [np.zeros((0, 4, 2))]
    for group in cells:
        low, high = (np.degrees(place) for place in bounds.places(group))
        (a, b), (c, d) = low.T, high.T
        corners.append(np.stack([[a, b], [c, b], [c, d], [a, d]], axis=0).transpose(2, 0, 1))
    look: dict[str, Any] = {"linewidths": 0.15, "rasterized": True} | style
    collection = PolyCollection(list(np.concatenate(corners)), **look)
    ax.add_collection(collection)
    return [collection]
