"""Our own: the whole region as exact arcs, of a robot in memory."""

from __future__ import annotations

from functools import lru_cache

from quality import packed, rings_of
from scenes import robot
from serve import Timed, serve, timed

from qbound import Robot, find_region

DRAWN = 1e-6
"""Largest distance (rad) of polygons by which areas are compared; they are not timed.

Distances of the arcs are those of the arcs themselves: `reference`.
"""


@lru_cache(maxsize=16)
def warmed(scene: str) -> Robot:
    """Return the robot of a scene; its region has been found once, so that all is loaded."""
    arm = robot(scene)
    find_region(arm)
    return arm


def region(scene: str, accuracy: float) -> Timed:
    """Answer with the arcs, whatever the accuracy: they have one only."""
    arm = warmed(scene)
    seconds, processor, found = timed(lambda: find_region(arm))
    return seconds, processor, {"drawn": DRAWN, "rings": packed(rings_of(found, DRAWN))}


if __name__ == "__main__":
    needs = {"numpy": "numpy", "msgspec": "msgspec"}
    serve("qbound, arcs", needs, {"region": region})
