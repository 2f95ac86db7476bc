"""A surface of three joints as a still picture."""

from __future__ import annotations

import math
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from qbound.arms.surfaces import COLOURS, OTHERS, Surface, colour_of
from qbound.arrays import Floats
from qbound.extras import require
from qbound.figures import INK, STYLE, as_text, symbol
from qbound.units import counted

if TYPE_CHECKING:
    from matplotlib.artist import Artist


VIEW: Final = (22.0, -55.0)
"""Elevation and azimuth of the eye, degrees."""

LIGHT: Final = np.array([0.4, -0.6, 0.8])
"""Where the light comes from."""

DARKEST: Final = 0.6
"""Part of its colour that a triangle keeps where no light falls on it."""


def draw_surface(ax: Any, surface: Surface) -> list[Artist]:
    """Draw a surface on 3D axes, in degrees or lengths, each pair of links in its colour."""
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    scales = np.array([surface.robot.joints[axis.joint].shown_scale for axis in surface.axes])
    corners = (surface.vertices * scales)[surface.triangles]
    colours = np.array([to_rgb(colour_of(k)) for k in range(len(COLOURS) + 1)])
    shades = colours[np.minimum(surface.pair, len(COLOURS))] * _light(surface)[:, None]
    drawn = Poly3DCollection(corners, facecolors=shades, edgecolors=shades, linewidths=0.2)
    drawn.set_rasterized(True)
    ax.add_collection3d(drawn)
    for axis, scale, letter in zip(surface.axes, scales, "xyz", strict=True):
        joint = surface.robot.joints[axis.joint]
        unit = "°" if joint.turns else surface.robot.length_unit
        low, high = (end * scale for end in axis.ends)
        ax.set(**{f"{letter}lim": (low, high), f"{letter}label": f"{symbol(joint.name)} / {unit}"})
        if joint.turns:
            ax.set(**{f"{letter}ticks": _ticks(low, high)})
        else:
            ax.locator_params(axis=letter, nbins=4)
    ax.set_box_aspect((1, 1, 1))
    return [drawn]


def surface_picture(surface: Surface, kind: str = "svg") -> bytes:
    """Return the picture of a surface with a legend of contacts; the same bytes on every run.

    Parameters
    ----------
    kind : {"svg", "png"}

    Raises
    ------
    ModuleNotFoundError
        If matplotlib is missing.
    """
    require("matplotlib", "a picture")
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(7.6, 5.2))
        ax = figure.add_subplot(projection="3d", computed_zorder=False)
        ax.view_init(*VIEW)
        draw_surface(ax, surface)
        figure.legend(handles=_legend(surface), loc="outside right upper", labelcolor=INK)
        buffer = BytesIO()
        metadata = {"Date": None, "Creator": None} if kind == "svg" else {"Software": None}
        figure.savefig(buffer, format=kind, dpi=200, metadata=metadata)
    return buffer.getvalue()


def _light(surface: Surface) -> Floats:
    """Return the brightness of each triangle; light falls on both of its sides."""
    wide = np.array([axis.ends[1] - axis.ends[0] for axis in surface.axes])
    a, b, c = np.moveaxis((surface.vertices / wide)[surface.triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    size = np.linalg.norm(normals, axis=1)
    cosine = np.abs(normals @ LIGHT) / np.where(size > 0, size, 1) / np.linalg.norm(LIGHT)
    return np.asarray(DARKEST + (1 - DARKEST) * cosine)


def _ticks(low: float, high: float) -> list[int]:
    """Return ticks a quarter of a turn, or an eighth, apart."""
    step = 90 if high - low > 180 else 45 if high - low > 90 else 15
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [step * k for k in range(first, last + 1)]


def _legend(surface: Surface) -> list[Any]:
    """Return a patch for each colour, the largest area first; further pairs are "others"."""
    from matplotlib.patches import Patch

    names = surface.pairs[: len(COLOURS)]
    patches = [Patch(color=colour_of(k), label=as_text(name)) for k, name in enumerate(names)]
    more = len(surface.pairs) - len(names)
    return [*patches, *([Patch(color=OTHERS, label=counted(more, "other"))] if more else [])]
