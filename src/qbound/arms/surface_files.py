"""A surface as a file for other programs: PLY and glTF, by trimesh."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from qbound.arms.surfaces import Surface
from qbound.extras import require
from qbound.printable import printable

COLOURS: Final = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442",
)  # fmt: skip
"""Of the pairs of links with the largest areas (Okabe and Ito, for colour-blind readers)."""

OTHERS: Final = "#8C8C8C"
"""Of all further pairs."""


def colour_of(pair: int) -> str:
    """Return the colour of a number of `Surface.pairs`."""
    return COLOURS[pair] if pair < len(COLOURS) else OTHERS


def ply_bytes(surface: Surface) -> bytes:
    """Return binary PLY: vertices in rad or length, a colour on every triangle.

    Raises
    ------
    ValueError
        If the surface has no triangle.
    ModuleNotFoundError
        If trimesh is missing.
    """
    trimesh = _trimesh(surface)
    mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    mesh.visual.face_colors = _rgba()[np.minimum(surface.pair, len(COLOURS))]
    return bytes(mesh.export(file_type="ply"))


def glb_bytes(surface: Surface) -> bytes:
    """Return binary glTF: a mesh for every pair of links, named and coloured as in the page.

    Errors as in `ply_bytes`.
    """
    trimesh = _trimesh(surface)
    scene = trimesh.Scene()
    for k, name in enumerate(surface.pairs):
        used, triangles = np.unique(surface.triangles[surface.pair == k], return_inverse=True)
        mesh = trimesh.Trimesh(surface.vertices[used], triangles.reshape(-1, 3), process=False)
        mesh.visual.face_colors = _rgba()[min(k, len(COLOURS))]
        scene.add_geometry(mesh, node_name=printable(name), geom_name=printable(name))
    return bytes(scene.export(file_type="glb"))


def _rgba() -> NDArray[np.uint8]:
    """Return the colours, the last of the others, shape (k, 4)."""
    rows = [bytes.fromhex(colour[1:]) for colour in (*COLOURS, OTHERS)]
    return np.array([[*row, 255] for row in rows], dtype=np.uint8)


def _trimesh(surface: Surface) -> Any:
    if not len(surface.triangles):
        raise ValueError("no boundary is active within these ranges: there is no surface to write")
    require("trimesh", "PLY or glTF")
    import trimesh

    return trimesh
