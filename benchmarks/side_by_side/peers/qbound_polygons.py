"""Our own, drawn: polygons within the accuracy of the arcs, as `Region.to_geojson` has them."""

from __future__ import annotations

from qbound_arcs import warmed
from quality import packed
from serve import Refused, Timed, serve, timed

from qbound import find_region
from qbound.export.outlines import find_outlines

FINEST = 1e-10
"""Deviation, rad, below which it takes over 20 s."""


def region(scene: str, accuracy: float) -> Timed:
    """Answer with polygons within the accuracy."""
    if accuracy < FINEST:
        raise Refused(f"{accuracy:.0e} is finer than {FINEST:.0e}")
    arm = warmed(scene)
    seconds, processor, drawn = timed(lambda: find_outlines(find_region(arm), accuracy))
    pieces = (piece for pieces in drawn.pieces for piece in pieces)
    rings = [(piece.outer, *piece.holes) for piece in pieces]
    return seconds, processor, {"rings": packed(rings)}


if __name__ == "__main__":
    needs = {"numpy": "numpy", "msgspec": "msgspec"}
    serve("qbound, polygons", needs, {"region": region})
