"""Our own: the feasible part of joint space, by exact fibres along one joint over a grid of others.

With two joints it is the region itself.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from closed_form_joints import middles
from scenes import robot
from serve import Refused, Timed, serve, timed

from qbound import find_region
from qbound.arms.fibres import fibres
from qbound.sampling import joint_ranges

MOST = 3e6
"""Fibres, at most: with more it takes over 20 s."""
BLOCK = 8192
"""Fibres at once."""


def part(scene: str, step: float) -> Timed:
    """Answer with the feasible part of joint space."""
    arm = robot(scene)
    if len(arm.joints) == 2:
        find_region(arm)  # what loads at the first call
    ranges = joint_ranges(arm)
    whole = float(np.prod(np.ptp(ranges, axis=1)))
    if len(arm.joints) == 2:
        seconds, processor, region = timed(lambda: find_region(arm))
        return seconds, processor, {"part": region.area / whole}
    counts = [math.ceil(np.ptp(ends) / step) for ends in ranges[:-1]]
    if math.prod(counts) > MOST:
        raise Refused(f"{math.prod(counts):.2g} fibres are more than {MOST:.0e}")

    def work() -> Any:
        axes = [middles(ends, n) for ends, n in zip(ranges[:-1], counts, strict=True)]
        length = 0.0
        for k in range(0, math.prod(counts), BLOCK):
            index = np.unravel_index(np.arange(k, min(k + BLOCK, math.prod(counts))), counts)
            q = np.zeros((len(index[0]), len(arm.joints)))
            q[:, :-1] = np.stack([axis[i] for axis, i in zip(axes, index, strict=True)], axis=1)
            length += float(fibres(arm, len(arm.joints) - 1, q).length.sum())
        return length / math.prod(counts) / float(np.ptp(ranges[-1]))

    seconds, processor, found = timed(work)
    return seconds, processor, {"fibres": math.prod(counts), "part": found}


if __name__ == "__main__":
    needs = {"numpy": "numpy", "msgspec": "msgspec"}
    serve("qbound, fibres", needs, {"part": part})
