"""Figures of the exact workspace and of pavings."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import cycle
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.figures import as_text, boundary_colour
from cspace.proofs.exact.bounds import BoxBounds, Cells
from cspace.workspace.areas import SINGULAR, Workspace
from qbound.figures import INK

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

ONCE: Final = "#CDE3F0"
TWICE: Final = "#7FB8D8"
"""Tints of FEASIBLE for places reached in one posture, and in two."""

SIDES: Final = {1: "#CDE3F0", -1: "#F1ECBB"}
"""Tints for the two signs of det J: of FEASIBLE, and a yellow."""

DASHES: Final = ("-", (0, (6, 1.5)), (0, (4, 1.5, 1, 1.5)), (0, (2, 1)), (0, (9, 2, 2, 2)))
"""Taken in turn for the boundaries: no two of the first thirty look alike."""


def draw_aspects(ax: Axes, workspace: Workspace, scale: ArrayLike = 1.0) -> list[Artist]:
    """Fill the aspects in joint space, tinted by the sign of det J, with their boundaries.

    Parameters
    ----------
    scale : array_like, shape (2,)
        Factor of each joint, such as degrees per radian.
    """
    artists: list[Artist] = []
    factor = np.asarray(scale, dtype=float)
    for aspect in workspace.aspects:
        loops = aspect.region.loops
        rings: list[Floats] = [np.vstack([arc.points for arc in loop]) * factor for loop in loops]
        label = f"det J {'>' if aspect.side > 0 else '<'} 0"
        artists.append(_fill(ax, rings, SIDES[aspect.side], label))
    return artists + _draw_arcs(ax, workspace, lambda points: points * factor)


def draw_patches(ax: Axes, workspace: Workspace) -> list[Artist]:
    """Fill the workspace: light where one posture is feasible, darker where both are."""
    artists: list[Artist] = []
    for postures, outline in sorted(workspace.patches(), key=lambda patch: patch[0]):
        colour, label = ((ONCE, "one feasible posture"), (TWICE, "two feasible postures"))[
            postures - 1
        ]
        artists.append(_fill(ax, [outline], colour, label))
    return artists


def draw_images(ax: Axes, workspace: Workspace) -> list[Artist]:
    """Draw where the tool goes as the joints path round every aspect, named by boundary."""
    return _draw_arcs(ax, workspace, workspace.arm.tool)


def legend(ax: Axes, columns: int = 4) -> None:
    """Put a legend with one entry for each name under the figure."""
    # Not get_legend_handles_labels: it leaves out every name that begins with an underscore,
    # and not only the names that matplotlib gives to what has none.
    drawn = {str(artist.get_label()): artist for artist in (*ax.patches, *ax.lines)}
    unnamed = re.compile(r"_child\d+")
    named = {name: artist for name, artist in drawn.items() if not unnamed.fullmatch(name)}
    ax.figure.legend(list(named.values()), list(named), loc="outside lower center", ncols=columns)


def _draw_arcs(ax: Axes, workspace: Workspace, place: Any) -> list[Artist]:
    artists: list[Artist] = []
    loops = (loop for aspect in workspace.aspects for loop in aspect.region.loops)
    arcs = [arc for loop in loops for arc in loop]
    arcs.sort(key=lambda arc: (arc.boundary != SINGULAR, arc.boundary))  # the curve first
    names = sorted({arc.boundary for arc in arcs} - {SINGULAR})
    robot = workspace.region.robot
    looks: dict[str, tuple[str, Any]] = {
        name: (boundary_colour(robot, name), dash)
        for name, dash in zip(names, cycle(DASHES), strict=False)
    }
    looks[SINGULAR] = (INK, (0, (1, 1)))
    for arc in arcs:
        colour, dash = looks[arc.boundary]
        path = place(arc.at(np.linspace(0, 1, 1 + 48 * len(arc.pieces)))).T
        width = 2.6 if arc.boundary == SINGULAR else 1.7
        artists += ax.plot(*path, color=colour, ls=dash, lw=width, label=as_text(arc.boundary))
    return artists


def _fill(ax: Axes, rings: list[Floats], colour: str, label: str) -> Artist:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    path = Path.make_compound_path(*(Path(ring, closed=False) for ring in rings))
    # An edge of the same colour closes the hairlines between neighbours.
    return ax.add_patch(PathPatch(path, fc=colour, ec=colour, lw=0.6, label=label))


# --- pavings --------------------------------------------------------------------------------------


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
