"""Polygons of a region as others read them: CSV, GeoJSON, NumPy arrays, shapely."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qbound.arrays import Floats
from qbound.export.formats import csv_text, npz_bytes
from qbound.export.polygons import Piece, polygons
from qbound.extras import require
from qbound.region import Region

if TYPE_CHECKING:
    from shapely import MultiPolygon


@dataclass(frozen=True, eq=False)
class Outlines:
    """Polygons of every component of a region, as near to its arcs as was asked for.

    Attributes
    ----------
    region : Region
    pieces : tuple of list of Piece
        Polygons of each component: one, unless it goes round a joint and is cut.
    deviations : tuple of float
        How far each component's arcs are from its polygons at most, in the plane of the joints.
    """

    region: Region
    pieces: tuple[list[Piece], ...]
    deviations: tuple[float, ...]

    def rings(self) -> Iterator[tuple[int, int, int, Floats]]:
        """Yield component, piece and ring by number (ring 0 is the outer one) and the corners."""
        for c, pieces in enumerate(self.pieces):
            for p, piece in enumerate(pieces):
                for r, ring in enumerate((piece.outer, *piece.holes)):
                    yield c, p, r, ring


def find_outlines(region: Region, deviation: float = 1e-3) -> Outlines:
    """Draw polygons through the arcs of every component of a region.

    Parameters
    ----------
    deviation : float
        Largest distance of the polygons from the arcs, in the plane of the two joint values.

    Raises
    ------
    ValueError
        If the deviation is not above zero.
    """
    drawn = [polygons(component, deviation) for component in region.components]
    return Outlines(region, tuple(p for p, _ in drawn), tuple(off for _, off in drawn))


def outlines_csv(drawn: Outlines) -> str:
    """Return one row a corner: component, piece and ring (0 the outer one, then holes)."""
    problem = drawn.region.problem
    joints = zip(problem.joint_names, problem.units, strict=True)
    rows = (
        [c, p, r, *corner, drawn.deviations[c]]
        for c, p, r, ring in drawn.rings()
        for corner in ring.tolist()
    )
    return csv_text(["component", "piece", "ring", *map("_".join, joints), "deviation"], rows)


def outlines_geojson(drawn: Outlines) -> dict[str, Any]:
    """Return a FeatureCollection as GeoJSON has it, in joint values instead of places on Earth.

    Every component is a feature; a ring ends where it begins. A component that goes round a joint
    is cut where that joint is -pi or pi.
    """
    return {
        "type": "FeatureCollection",
        "features": [_feature(drawn, c) for c in range(len(drawn.pieces))],
    }


def outlines_npz(drawn: Outlines) -> bytes:
    """Return the corners of all rings in one array, and where each ring starts and belongs.

    Ring i is ``points[start[i]:start[i + 1]]``, of component ``component[i]`` and its piece
    ``piece[i]``; ``ring[i]`` is 0 for an outer one.
    """
    rings = list(drawn.rings())
    c, p, r = np.array([numbers for *numbers, _ in rings], dtype=int).reshape(-1, 3).T
    components, problem = drawn.region.components, drawn.region.problem
    return npz_bytes(
        {
            "points": np.concatenate([np.empty((0, 2)), *(ring for *_, ring in rings)]),
            "start": np.cumsum([0, *(len(ring) for *_, ring in rings)]),
            "component": c,
            "piece": p,
            "ring": r,
            "area": np.array([component.area for component in components]),
            "contains_home": np.array([part.contains_home for part in components], dtype=bool),
            "deviation": np.array(drawn.deviations),
            "joints": np.array(problem.joint_names),
            "units": np.array(problem.units),
        }
    )


def outlines_shapely(drawn: Outlines, component: int | None = None) -> MultiPolygon:
    """Return the polygons of all components, or of one of them, as one shapely geometry."""
    require("shapely", "a region as a shapely geometry")
    from shapely import MultiPolygon, Polygon

    chosen = drawn.pieces if component is None else (drawn.pieces[component],)
    pieces = (piece for pieces in chosen for piece in pieces)
    return MultiPolygon([Polygon(piece.outer, piece.holes) for piece in pieces])


def _feature(drawn: Outlines, c: int) -> dict[str, Any]:
    component, problem = drawn.region.components[c], drawn.region.problem
    return {
        "type": "Feature",
        "properties": {
            "component": c,
            "contains_home": component.contains_home,
            "area": component.area,
            "deviation": drawn.deviations[c],
            "wraps": list(component.wraps),
            "joints": list(problem.joint_names),
            "unit": list(problem.units),
        },
        "geometry": {
            "type": "MultiPolygon",
            "coordinates": [_closed(piece) for piece in drawn.pieces[c]],
        },
    }


def _closed(piece: Piece) -> list[list[list[float]]]:
    return [[*ring.tolist(), ring[0].tolist()] for ring in (piece.outer, *piece.holes)]
