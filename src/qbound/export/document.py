"""Closed loops of arcs as JSON: the boundary of a region, of an aspect, between two poses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from qbound.region.arcs import Arc


def loop_content(loop: Sequence[Arc]) -> dict[str, Any]:
    """Return the JSON form of a closed loop: its arcs, with boundary, branch and ends."""
    return {
        "arcs": [
            {
                "boundary": arc.boundary,
                "branch": arc.branch,
                "from": arc.points[0].tolist(),
                "to": arc.points[-1].tolist(),
            }
            for arc in loop
        ]
    }
