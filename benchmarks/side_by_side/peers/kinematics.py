"""Places of a scene's points in NumPy, as a user of a collision library would write them."""

from __future__ import annotations

from typing import Any

import numpy as np


def places(told: dict[str, Any], names: list[str], q: np.ndarray) -> np.ndarray:
    """Return where points are, seen from the base, shape (n, points, 3)."""
    turns = {told["base"]: np.broadcast_to(np.eye(3), (len(q), 3, 3))}
    origins = {told["base"]: np.zeros((len(q), 3))}
    for j, joint in enumerate(told["joints"]):
        turn, origin = turns[joint["parent"]], origins[joint["parent"]]
        origins[joint["frame"]] = origin + turn @ np.array(joint["origin"])
        turns[joint["frame"]] = turn @ np.array(joint["mount"]) @ rotation(joint["axis"], q[:, j])
    of_name = {point["name"]: point for point in told["points"]}
    found = np.empty((len(q), len(names), 3))
    for i, name in enumerate(names):
        frame, at = of_name[name]["frame"], np.array(of_name[name]["at"])
        found[:, i] = origins[frame] + turns[frame] @ at
    return found


def rotation(axis: list[float], angle: np.ndarray) -> np.ndarray:
    """Return the turns about an axis, shape (n, 3, 3), by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + s * cross + (1 - c) * (cross @ cross)
