"""Our own: the whole region as exact arcs, from the robot's file."""

from __future__ import annotations

from qbound_arcs import DRAWN, warmed
from quality import packed, rings_of
from serve import Missing, Timed, serve, timed

from qbound import find_region, load_robot

FILES = {"paper": "minervabot-v2"}
"""Scenes that are packaged robot files."""


def region(scene: str, accuracy: float) -> Timed:
    """Answer with the arcs, whatever the accuracy."""
    if scene not in FILES:
        raise Missing(f"{scene} is no packaged file")
    warmed(scene)
    seconds, processor, found = timed(lambda: find_region(load_robot(FILES[scene])))
    return seconds, processor, {"drawn": DRAWN, "rings": packed(rings_of(found, DRAWN))}


if __name__ == "__main__":
    needs = {"numpy": "numpy", "msgspec": "msgspec"}
    serve("qbound, from its file", needs, {"region": region})
