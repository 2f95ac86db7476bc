"""Our own: the whole region as exact arcs, of a robot in memory."""

from __future__ import annotations

from quality import packed, rings_of
from reference import errors
from scenes import robot
from serve import Timed, serve, timed

from qbound import find_region

DRAWN = 1e-6
"""Largest distance (rad) of the polygons by which the answer is compared; they are not timed."""


def region(scene: str, accuracy: float) -> Timed:
    """Answer with the arcs, whatever the accuracy: they have one only, see `reference`."""
    arm = robot(scene)
    seconds, processor, found = timed(lambda: find_region(arm))
    return seconds, processor, {"drawn": DRAWN, "rings": packed(rings_of(found, DRAWN))}


def reference(scene: str) -> Timed:
    """Answer with the distance of vertices and arcs from the same in 60 digits."""
    return timed(lambda: errors(robot(scene)))


if __name__ == "__main__":
    tasks = {"region": region, "reference": reference}
    serve("qbound, arcs", {"numpy": "numpy", "msgspec": "msgspec", "flint": "python-flint"}, tasks)
