"""Balls that cover a link, each shape by its own kind of cover, and balls that lie inside it.

Mesh files are read only from below the folder of their URDF or package.

A name such as ``package://NAME/meshes/arm.stl`` means a file below the folder of that package. A
package has the name that is given for it, that of its folder, or that in its ``package.xml``. Any
other name means a file below the URDF's own folder. Links are followed before the position of the
file is checked, so no link can lead out of these folders.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Floats
from cspace.extras import require
from cspace.geometry import solid_covers
from cspace.geometry.covering import Cover, few, joined, within
from cspace.geometry.mesh_solids import triangle_distances, winding_numbers
from cspace.model.robotcheck import RobotFileError
from cspace.model.schema import one_line, shown
from cspace.tolerances import OUTWARD
from cspace.urdf import document as urdf
from cspace.urdf.xml import Element, Source, read_xml


def link_cover(
    shapes: Sequence[urdf.Collision], pose: urdf.Pose, excesses: Sequence[float]
) -> Cover:
    """Cover all shapes of a link, seen from the frame in which the link has the given pose.

    Each shape has an excess. Centres and radii are short decimals, to a thousandth of the excess or
    finer. Radii are enlarged for this rounding and for the rounding of the poses, so the balls
    still cover the link.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        If a shape cannot be covered to that excess.
    """
    covers = []
    for shape, excess in zip(shapes, excesses, strict=True):
        digits = 3 - math.floor(math.log10(excess))
        try:
            cover = _cover(shape.solid, excess - 3 * 10.0**-digits)
        except ValueError as error:
            shape.element.fault(str(error))
        centres = pose.then(shape.pose).places(cover.centres)
        covers.append(_in_decimals(cover._replace(centres=centres), digits))
    return joined(covers)


def _in_decimals(cover: Cover, digits: int) -> Cover:
    """Round centres to a number of decimals, and enlarge the balls to cover as much."""
    centres = np.round(cover.centres, digits) + 0.0  # no -0.0
    moved = np.linalg.norm(centres - cover.centres, axis=1)
    needed = cover.radii + moved + OUTWARD * (np.abs(centres).sum(axis=1) + cover.radii)
    radii = np.round(np.ceil(needed * 10**digits) / 10**digits, digits)
    radii = np.where(radii < needed, np.round(radii + 10.0**-digits, digits), radii)
    more = float((radii - cover.radii + moved).max())
    return Cover(centres, radii, cover.excess + more * (1 + OUTWARD))


UNREAD = "the triangles of this mesh were not read"

THIN = 0.01
"""Part of a shape's longest side that a side counts at least, where its size is taken."""


def size_of(solid: urdf.Solid) -> float:
    """Return the size of a shape: the cube root of the volume of the box about it; length."""
    sides = sides_of(solid)
    return float(np.cbrt(np.maximum(sides, THIN * sides.max()).prod()))


def sides_of(solid: urdf.Solid) -> Floats:
    """Return the sides of the box about a shape, along the axes of its own frame, shape (3,)."""
    if isinstance(solid, urdf.Cuboid):
        return solid.size
    if isinstance(solid, urdf.Triangles):
        return np.asarray(np.ptp(solid.corners.reshape(-1, 3), axis=0))
    if isinstance(solid, urdf.Mesh):
        raise TypeError(UNREAD)
    wide = 2 * solid.radius
    if isinstance(solid, urdf.Sphere):
        return np.full(3, wide)
    caps = wide if isinstance(solid, urdf.Capsule) else 0.0
    return np.array([wide, wide, solid.length + caps])


@lru_cache(maxsize=64)
def _cover(solid: urdf.Solid, excess: float) -> Cover:
    """Cover a shape by balls that stick out of it by an excess at most; a URDF repeats shapes."""
    match solid:
        case urdf.Sphere():
            return solid_covers.ball_cover(solid.radius)
        case urdf.Capsule():
            return solid_covers.capsule_cover(solid.radius, solid.length, excess)
        case urdf.Cylinder():
            return solid_covers.cylinder_cover(solid.radius, solid.length, excess)
        case urdf.Cuboid():
            return solid_covers.box_cover(solid.size, excess)
        case urdf.Triangles():
            return solid_covers.mesh_cover(solid.corners, solid.closed, excess)
        case urdf.Mesh():
            raise TypeError(UNREAD)


# --- balls inside ---------------------------------------------------------------------------------


MOST_INNER = 64
"""Balls inside a link at most."""

SHALLOWER = 1e-9
"""Part of its size and position by which a ball inside a shape is taken smaller, for rounding."""


def inner_balls(
    shapes: Sequence[urdf.Collision], pose: urdf.Pose, places: Floats
) -> tuple[Floats, Floats]:
    """Return balls that lie inside a link, each in one of its shapes.

    Parameters
    ----------
    shapes, pose
        As `link_cover` has them.
    places : ndarray, shape (n, 3)
        Where balls are tried, seen from the same frame as the pose.

    Returns
    -------
    centres : ndarray, shape (k, 3)
    radii : ndarray, shape (k,)
        Above 0; few balls that together contain most of those places that are inside. There are
        none inside a mesh that does not close up.
    """
    deepest = np.zeros(len(places))
    for shape in shapes:
        seen = pose.then(shape.pose).inverse().places(places)
        depths = inner_depths(shape.solid, seen)
        size = np.abs(seen).sum(axis=1) + np.abs(places).sum(axis=1) + np.abs(depths)
        deepest = np.maximum(deepest, depths - SHALLOWER * size)
    inside = deepest > 0
    centres, radii = places[inside], deepest[inside]
    kept = few(within(centres, centres, radii).T, most=MOST_INNER - 1)
    return centres[kept], radii[kept]


def inner_depths(solid: urdf.Solid, places: Floats) -> Floats:
    """Return how far each place is below the surface of a shape; 0 or less outside; shape (n,)."""
    match solid:
        case urdf.Sphere():
            return np.asarray(solid.radius - np.linalg.norm(places, axis=1))
        case urdf.Capsule():
            half = solid.length / 2
            axis = np.clip(places[:, 2], -half, half)[:, None] * [0, 0, 1]
            return np.asarray(solid.radius - np.linalg.norm(places - axis, axis=1))
        case urdf.Cylinder():
            below = solid.length / 2 - np.abs(places[:, 2])
            return np.minimum(solid.radius - np.hypot(places[:, 0], places[:, 1]), below)
        case urdf.Cuboid():
            return np.asarray((solid.size / 2 - np.abs(places)).min(axis=1))
        case urdf.Mesh():
            raise TypeError(UNREAD)
    found = np.zeros(len(places))
    corners = solid.corners.reshape(-1, 3)
    near = ((corners.min(axis=0) < places) & (places < corners.max(axis=0))).all(axis=1)
    if solid.closed and near.any():
        inside = winding_numbers(solid.corners, places[near]) != 0
        found[near] = np.where(inside, triangle_distances(solid.corners, places[near]), 0.0)
    return found


# --- meshes ---------------------------------------------------------------------------------------


KINDS = ("stl", "obj")
"""Endings of meshes that are read: others have parts, units or axes that could be missed."""

LARGEST_MESH = 200_000_000
"""Bytes of a mesh at most."""

MOST_TRIANGLES = 500_000
"""Triangles of a mesh at most."""

STL_HEADER, STL_TRIANGLE = 84, 50
"""Bytes of a binary STL: before the triangles, and of each."""


class Root(NamedTuple):
    """A folder that may contain meshes: a package, or a folder of packages.

    Attributes
    ----------
    folder : Path
    name : str
        Name of the package, where it is given.
    """

    folder: Path
    name: str = ""

    @classmethod
    def named(cls, given: str | Path) -> Root:
        """Return the root of a folder, or of ``NAME=FOLDER``."""
        name, is_named, folder = str(given).partition("=")
        if name and is_named and not Path(given).is_dir():
            return cls(Path(folder), name)
        return cls(Path(given))

    def packages(self, wanted: str) -> Iterator[Path]:
        """Yield the folders here that are the package of that name."""
        if self.name == wanted:
            yield self.folder
        if self.name:
            return
        if wanted in (self.folder.resolve().name, _package_name(self.folder)):
            yield self.folder
        yield self.folder / wanted
        with suppress(OSError):
            inner = sorted(file.parent for file in self.folder.glob("*/package.xml"))
            yield from (folder for folder in inner if _package_name(folder) == wanted)


def _package_name(folder: Path) -> str:
    """Return the name that a package's own file says; empty without such a file."""
    try:
        name = read_xml(folder / "package.xml", "package")[0].child("name")
    except RobotFileError:
        return ""
    return "" if name is None else name.content


def read_mesh(mesh: urdf.Mesh, element: Element, roots: Sequence[Root]) -> urdf.Triangles:
    """Read the mesh of an element.

    Parameters
    ----------
    roots : sequence of Root
        Folders that may contain the file: that of the URDF, then those of packages.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        If the file is missing, is in another folder, has an unknown format, or has numbers that are
        not finite.
    ModuleNotFoundError
        If trimesh is missing; it comes with ``cspace[arms]``.
    """
    require("trimesh")
    path = find_mesh(mesh.filename, element, roots)
    kind = path.suffix.removeprefix(".").lower()
    if kind not in KINDS:
        known = ", ".join(f".{each}" for each in KINDS)
        element.fault(f"{shown(mesh.filename)}: unknown ending; wanted: one of {known}")
    if path.stat().st_size > LARGEST_MESH:
        element.fault(f"{shown(mesh.filename)}: more than {LARGEST_MESH // 10**6} MB")
    content = path.read_bytes()
    try:
        corners, closed = _loaded(content, kind, mesh.scale)
    except Exception as error:  # errors of a parser on files from strangers
        element.fault(f"{shown(mesh.filename)}: not read: {one_line(str(error))}")
    if not len(corners):
        element.fault(f"{shown(mesh.filename)}: 0 triangles: damaged, or not {kind.upper()}")
    if len(corners) > MOST_TRIANGLES:
        text = f"{len(corners)} triangles; wanted: {MOST_TRIANGLES} at most"
        element.fault(f"{shown(mesh.filename)}: {text}")
    if not np.isfinite(corners).all():
        element.fault(f"{shown(mesh.filename)}: a corner is not a finite number")
    return urdf.Triangles(corners, closed, Source.of(path, content))


def find_mesh(name: str, element: Element, roots: Sequence[Root]) -> Path:
    """Return the file that the name of a mesh means; raises as `read_mesh`."""
    scheme, _, rest = name.rpartition("://")
    if scheme not in ("", "file", "package"):
        element.fault(f"filename: {shown(name)}: nothing is fetched; wanted: a file here")
    if scheme == "package":
        package, _, inner = rest.partition("/")
        tried = [folder / inner for root in roots for folder in root.packages(package)]
    else:
        package, tried = "", [roots[0].folder / rest]
    allowed = [root.folder.resolve() for root in roots]
    for path in _resolved(tried, element):
        if not any(path.is_relative_to(root) for root in allowed):
            text = "leads outside of the URDF's folder and of the packages' folders"
            cure = "if a link leads there, name that folder as a package, too"
            element.fault(f"filename: {shown(name)} {text}; {cure}")
        if path.is_file():
            return path
    wanted = f"{package}=FOLDER"
    cure = f"; say where its package is: {one_line(wanted)}" if package else ""
    return element.fault(f"filename: no file {shown(name)}{cure}")


def _resolved(tried: Sequence[Path], element: Element) -> Iterator[Path]:
    """Yield places with their links followed."""
    for path in tried:
        try:
            yield path.resolve()
        except (OSError, RuntimeError):  # RuntimeError in old Pythons, for links in a circle
            element.fault(f"filename: {shown(path.name)}: no place that can be reached")


def _loaded(content: bytes, kind: str, scale: Floats) -> tuple[Floats, bool]:
    """Return the triangles, and whether they form a closed surface; no other file is opened."""
    import trimesh

    options: dict[str, Any] = {"skip_materials": True} if kind == "obj" else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = trimesh.load_mesh(
            io.BytesIO(_in_utf8(content, kind)), file_type=kind, process=False, **options
        )
    vertices = np.asarray(found.vertices, dtype=float) * scale
    faces = np.asarray(found.faces, dtype=int)
    merged = trimesh.Trimesh(vertices, faces, process=False)
    if np.isfinite(vertices).all():
        merged.merge_vertices(merge_tex=True, merge_norm=True)
    closed = bool(merged.is_watertight and merged.is_winding_consistent)
    return np.asarray(vertices[faces]), closed


def _in_utf8(content: bytes, kind: str) -> bytes:
    """Return a mesh in text as UTF-8: names may be in other letters, numbers and keywords are not.

    For other letters the parser calls a library that guesses encodings and may be missing.
    """
    count = int.from_bytes(content[80:84], "little")
    is_binary = kind == "stl" and len(content) == STL_HEADER + STL_TRIANGLE * count
    return content if is_binary else content.decode(errors="replace").encode()
