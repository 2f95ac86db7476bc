"""The rings to which a reader brings the tool on the front page, with the answers of `cspace why`.

Each pose that puts the tool on a ring gets its own answer and certificate. The certificates are
written beside the page, so that a reader can check them.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np

from cspace import load_robot
from cspace.arms.why import Why, why
from cspace.arrays import Floats
from cspace.workspace.planar import planar_postures

ROBOT: Final = "two-links-on-a-table"
RINGS: Final = {"A": (0.62, 0.0, 0.0), "B": (-0.1, -0.5, 0.0)}
"""Places of the tool, m: past the post, and behind the triangle and the box."""

FOLDER: Final = "live/certificates"


@cache
def answers(ring: str) -> list[tuple[Floats, Why]]:
    """Return each pose that puts the tool on a ring, to 0.001 degrees, and the answer."""
    robot = load_robot(ROBOT)
    poses = np.radians(np.round(np.degrees(planar_postures(robot, RINGS[ring], {})), 3))
    return [(q, why(ROBOT, robot.home, q)) for q in poses]


def rings() -> list[dict[str, Any]]:
    """Return the rings: place, poses with their answers, a path where there is one."""
    return [_ring(ring, place[:2]) for ring, place in RINGS.items()]


def _ring(ring: str, place: tuple[float, ...]) -> dict[str, Any]:
    found = answers(ring)
    paths = [f.path for _, f in found if f.answer == "connected" and f.path is not None]
    poses = [
        {
            "q": q.tolist(),
            "answer": each.answer,
            "file": None if each.certificate is None else f"_static/{FOLDER}/{ring}-{k}.json",
        }
        for k, (q, each) in enumerate(found, start=1)
    ]
    stops = min(paths, key=len).tolist() if paths else None
    return {"name": ring, "at": list(place), "poses": poses, "path": stops}


def certificates() -> dict[str, str]:
    """Return the certificates by their addresses below ``_static``."""
    return {
        f"{FOLDER}/{ring}-{k}.json": each.certificate.text
        for ring in RINGS
        for k, (_, each) in enumerate(answers(ring), start=1)
        if each.certificate is not None
    }
