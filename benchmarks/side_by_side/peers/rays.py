"""Ray bisection: from a feasible place, the first way out in each direction.

As users do it: every ray is walked in equal strides until a margin is negative, and that last
stride is halved until it is shorter than the accuracy; all rays at once, many strides at a time.
What is behind a boundary, seen from the start, is not found, and neither is any other component.
"""

from __future__ import annotations

import math

import numpy as np
from closed_form import BLOCK, PlanarArm
from planar import Floats, arm, start
from quality import packed
from serve import Refused, Timed, serve, timed

RAYS = 12.0
"""Rays, times the root of the accuracy: chords between them are as near to a curve as that."""
STRIDE = 0.05
"""Of the walk, rad: what is thinner may be stepped over."""
MOST = 2e8
"""Margins, at most, about: with more it takes over 20 s."""


def region(scene: str, accuracy: float, stride: float = STRIDE) -> Timed:
    """Answer with one polygon about the start of the scene."""
    form, at = arm(scene), np.array(start(scene))
    count = math.ceil(RAYS / math.sqrt(accuracy))
    asked = count * (math.pi / stride + math.log2(1 + stride / accuracy))
    if asked > MOST:
        raise Refused(f"{asked:.2g} margins are more than {MOST:.0e}")

    def work() -> Floats:
        angle = np.arange(count) * (2 * math.pi / count)
        direction = np.stack([np.cos(angle), np.sin(angle)])
        safe, end = _walked(form, at, direction, stride)
        while np.max(end - safe) > accuracy:
            middle = (safe + end) / 2
            free = form.of(at[:, None] + middle * direction) >= 0
            safe, end = np.where(free, middle, safe), np.where(free, end, middle)
        return (at[:, None] + safe * direction).T

    seconds, processor, ring = timed(work)
    return seconds, processor, {"rays": count, "at": list(start(scene)), "rings": packed([[ring]])}


def _walked(form: PlanarArm, at: Floats, direction: Floats, stride: float) -> tuple[Floats, Floats]:
    """Return the last safe distance along each ray and the next, a stride farther or at a limit.

    A ray ends at the limits of a joint, and after a turn of one that has none.
    """
    low, high = form.ranges.T[:, :, None]
    turning = np.array(form.turning)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        to_ends = np.where(direction > 0, high - at[:, None], low - at[:, None]) / direction
        turn = 2 * math.pi / np.abs(direction)
    last = np.where(turning, turn, np.where(direction == 0, np.inf, to_ends)).min(axis=0)
    safe, walking = np.zeros(direction.shape[1]), np.arange(direction.shape[1])
    end = last.copy()
    while len(walking):
        some = np.arange(1, 1 + max(1, BLOCK // len(walking)))
        there = np.minimum(safe[walking, None] + stride * some, last[walking, None])
        q = at[:, None, None] + there * direction[:, walking, None]
        free = (form.of(q.reshape(2, -1)) >= 0).reshape(there.shape)
        count = np.where(free.all(axis=1), free.shape[1], free.argmin(axis=1))
        stopped, row = count < free.shape[1], np.arange(len(walking))
        end[walking[stopped]] = there[row, count - free.shape[1]][stopped]
        safe[walking] = np.where(count > 0, there[row, count - 1], safe[walking])
        walking = walking[~stopped & (safe[walking] < last[walking])]
    return safe, end


if __name__ == "__main__":
    serve("ray bisection", {"numpy": "numpy"}, {"region": region})
