"""Measures over one or two numbers of a design: dots, or a map, for each of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qbound.figures import COLLIDING, INK, as_text
from qbound.figures.pictures import picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qbound.sweeps import Swept

MOST_LETTERS = 40
"""Of a label; what is longer loses its middle."""


def sweep_picture(found: Swept, kind: str = "svg") -> bytes:
    """Draw every measure of a sweep, one panel each, side by side; the largest value is marked.

    Parameters
    ----------
    found : Swept
        A sweep with one or two rows of `vary` that have more than one value.

    Raises
    ------
    ValueError
        If there are more such rows, or none.
    """
    moving = [k for k, axis in enumerate(found.axes) if len(axis) > 1]
    if len(moving) not in (1, 2):
        raise ValueError(f"a picture takes one or two varied numbers; {len(moving)} vary here")

    def draw(panels: Sequence[Axes]) -> None:
        for ax, (name, values) in zip(panels, found.values.items(), strict=True):
            shown = values.reshape([len(found.axes[k]) for k in moving])
            if len(moving) == 1:
                _draw_dots(ax, found.axes[moving[0]], shown)
                ax.set_ylabel(_label(name, found.measure_unit(name)))
            else:
                _draw_map(ax, [found.axes[k] for k in moving], shown)
                ax.set_title(_label(name, found.measure_unit(name)))
                ax.set_ylabel(_axis_label(found, moving[0]))
            ax.set_xlabel(_axis_label(found, moving[-1]))

    return picture(len(found.values), draw, kind)


def _draw_dots(ax: Axes, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    """Draw a measure over one number, a dot for each arm; a cross below marks a missing value.

    No line joins the dots, because a measure may jump between two arms.
    """
    ax.plot(x, y, ".", color=INK)
    if np.isfinite(y).any():
        ax.plot(x[np.nanargmax(y)], np.nanmax(y), "P", color=INK, ms=9, mec="white", zorder=7)
    gone = x[np.isnan(y)]
    across = ax.get_xaxis_transform()
    ax.plot(gone, np.full(len(gone), 0.02), "x", color=COLLIDING, transform=across)


def _draw_map(ax: Axes, axes: Sequence[NDArray[np.float64]], values: NDArray[np.float64]) -> None:
    """Draw a measure over two numbers, the first upwards; missing values are white."""
    drawn = ax.pcolormesh(axes[1], axes[0], values, cmap="viridis", shading="nearest")
    ax.grid(visible=False)
    if np.isfinite(values).any():
        ax.get_figure().colorbar(drawn, ax=ax)  # type: ignore[union-attr]
        i, j = np.unravel_index(np.nanargmax(values), values.shape)
        ax.plot(axes[1][j], axes[0][i], "P", color=INK, ms=9, mec="white", zorder=7)


def _axis_label(found: Swept, k: int) -> str:
    return _label(found.study.specification.vary[k].number, found.axis_unit(k))


def _label(name: str, unit: str) -> str:
    half = MOST_LETTERS // 2
    short = name if len(name) <= MOST_LETTERS else f"{name[:half]}...{name[-half:]}"
    return as_text(short if unit == "1" else f"{short} / {unit.replace('^2', '²')}")
