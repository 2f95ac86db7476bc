"""A section of a map of reach, coloured by how many directions the tool has at each place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from qbound.arms.reach import Reach
from qbound.figures import FEASIBLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_section(ax: Axes, found: Reach, axis: int, value: float) -> Any:
    """Draw the layer of voxels at a coordinate, each as a square.

    Parameters
    ----------
    axis : int
        0, 1, 2 for x, y, z: that of the coordinate.
    value : float
        Length.

    Raises
    ------
    ValueError
        If the map does not come to that value.
    """
    from matplotlib.colors import ListedColormap

    layer, unit = found.section(axis, value), found.robot.length_unit
    across, up = (each for each in range(3) if each != axis)
    grid = found.grid
    faces = (grid.origin[k] + grid.edge * np.arange(grid.shape[k] + 1) for k in (across, up))
    look: dict[str, Any] = {"cmap": ListedColormap([FEASIBLE]), "alpha": 0.75}
    if found.index is not None:
        look = {"cmap": "viridis", "vmin": 0.0}
    mesh = ax.pcolormesh(*faces, np.ma.masked_invalid(layer.T), **look)
    if found.index is not None:
        ax.figure.colorbar(mesh, ax=ax, label="directions reached / all")
    ax.set(aspect="equal", xlabel=f"${'xyz'[across]}$ / {unit}", ylabel=f"${'xyz'[up]}$ / {unit}")
    ax.set_title(f"reached at ${'xyz'[axis]}$ = {value:g} {unit}")
    _frame(ax, found, (across, up))
    return mesh


def _frame(ax: Axes, found: Reach, axes: tuple[int, int]) -> None:
    """Show what is reached anywhere, with a voxel to spare."""
    if (box := found.box) is not None:
        low, high = box - found.grid.edge * np.array([[1], [-1]])
        (x, y) = axes
        ax.set(xlim=(low[x], high[x]), ylim=(low[y], high[y]))
