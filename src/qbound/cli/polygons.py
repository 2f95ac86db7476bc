"""Polygons of a region's components as files: CSV, GeoJSON-like JSON, NPZ; deviation stated."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from qbound.cli.values import csv_text, npz_bytes
from qbound.export.polygons import Piece, polygons
from qbound.region import Region

Outlines = list[tuple[list[Piece], float]]


def outlines(region: Region, deviation: float) -> Outlines:
    """Return the polygons of every component with the deviation that was measured."""
    return [polygons(component, deviation) for component in region.components]


def polygon_csv(drawn: Outlines, joints: Sequence[str], units: Sequence[str]) -> str:
    """Return one row a corner: component, piece and ring (0 the outer one, then holes)."""
    columns = [f"{joint}_{unit}" for joint, unit in zip(joints, units, strict=True)]
    rows = (
        [c, p, r, *map(float, corner), drawn[c][1]]
        for c, p, r, ring in _rings(drawn)
        for corner in ring
    )
    return csv_text(["component", "piece", "ring", *columns, "deviation"], rows)


def polygon_json(
    region: Region, drawn: Outlines, joints: Sequence[str], units: Sequence[str]
) -> str:
    """Return a FeatureCollection as GeoJSON has it, in joint values instead of places on Earth.

    Every component is a feature; a ring ends where it begins. A component that goes round a joint
    is cut where that joint is -pi or pi.
    """
    features = [
        {
            "type": "Feature",
            "properties": {
                "component": c,
                "contains_home": component.contains_home,
                "area": component.area,
                "deviation": deviation,
                "wraps": list(component.wraps),
                "joints": list(joints),
                "unit": list(units),
            },
            "geometry": {"type": "MultiPolygon", "coordinates": [_closed(p) for p in pieces]},
        }
        for c, (component, (pieces, deviation)) in enumerate(
            zip(region.components, drawn, strict=True)
        )
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"


def polygon_npz(
    region: Region, drawn: Outlines, joints: Sequence[str], units: Sequence[str]
) -> bytes:
    """Return the corners of all rings in one array, and where each ring starts and belongs.

    Ring i is ``points[start[i]:start[i + 1]]``, of component ``component[i]`` and its piece
    ``piece[i]``; ``ring[i]`` is 0 for an outer one.
    """
    rings = list(_rings(drawn))
    points = np.concatenate([np.empty((0, 2)), *(ring for *_, ring in rings)])
    return npz_bytes(
        {
            "points": points,
            "start": np.cumsum([0, *(len(ring) for *_, ring in rings)]),
            "component": np.array([c for c, *_ in rings], dtype=int),
            "piece": np.array([p for _, p, *_ in rings], dtype=int),
            "ring": np.array([r for _, _, r, _ in rings], dtype=int),
            "area": np.array([component.area for component in region.components]),
            "contains_home": np.array([c.contains_home for c in region.components], dtype=bool),
            "deviation": np.array([deviation for _, deviation in drawn]),
            "joints": np.array(joints),
            "units": np.array(units),
        }
    )


def _rings(drawn: Outlines) -> Iterator[tuple[int, int, int, Any]]:
    for c, (pieces, _) in enumerate(drawn):
        for p, piece in enumerate(pieces):
            for r, ring in enumerate((piece.outer, *piece.holes)):
                yield c, p, r, ring


def _closed(piece: Piece) -> list[list[list[float]]]:
    return [[*ring.tolist(), ring[0].tolist()] for ring in (piece.outer, *piece.holes)]
