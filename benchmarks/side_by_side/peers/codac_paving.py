"""Codac: a paving by separators, as its documentation's example of SIVIA has it.

Importing codac changes the rounding of this process: nothing else is computed here.
"""

from __future__ import annotations

import cmath
from functools import lru_cache
from math import prod
from typing import Any

import numpy as np
from serve import Timed, serve, timed

FINER = 0.7
"""The next size of boxes, where too much was undecided."""


@lru_cache(maxsize=8)
def prepared(name: str) -> tuple[Any, Any, float]:
    """Return the box of joint values, the separator of the region, and the box's volume.

    One separator a boundary, and their intersection. The other documented way, one separator of the
    vector of all, takes longer, and finds nothing where some boundary depends on one joint alone.
    """
    import scenes
    from codac import AnalyticFunction, Interval, IntervalVector, SepInverse, VectorVar, oo

    arm = scenes.robot(name)
    low, high = scenes.ends(arm)
    variable = VectorVar(len(low))
    region = None
    for expression, least in boundaries(arm, variable):
        found = SepInverse(AnalyticFunction([variable], expression), Interval(least, oo))
        region = found if region is None else region & found
    box = IntervalVector([[float(a), float(b)] for a, b in zip(low, high, strict=True)])
    return box, region, float(np.prod(high - low))


def boundaries(arm: Any, variable: Any) -> list[tuple[Any, float]]:
    """Return each boundary function as an expression that is to be at least a number.

    As a sum of waves: each joint stands in it as rarely as can be, and codac's bounds are far
    narrower than of coordinates that are squared and added.
    """
    from codac import cos

    from qbound.boundary.functions import clearance

    found = []
    for boundary in arm.used:
        waves = clearance(arm, boundary).waves
        if waves.powers.any():
            raise ValueError("turning joints only")
        total, constant = None, 0.0
        for amplitude, turns in zip(waves.amplitudes.tolist(), waves.turns.tolist(), strict=True):
            if not any(turns):
                constant += complex(amplitude).real
                continue
            angle = None
            for j, turn in enumerate(turns):
                if turn:
                    joint = variable[j] if turn > 0 else -variable[j]
                    angle = joint if angle is None else angle + joint
            size, phase = cmath.polar(amplitude)
            wave = size * cos(angle + phase)
            total = wave if total is None else total + wave
        if total is not None:
            found.append((total, -constant))
    return found


def paving(scene: str, undecided: float, eps: float) -> Timed:
    """Pave until at most a part of the box is undecided; `eps` is the first size of boxes."""
    from codac import pave

    box, region, volume = prepared(scene)
    while True:
        wall, processor, found = timed(lambda eps=eps: pave(box, region, eps))
        answer = described(found, volume) | {"eps": eps}
        if answer["undecided"] <= undecided:
            return wall, processor, answer
        eps *= FINER


def described(found: Any, volume: float) -> dict[str, Any]:
    """Return the parts that are undecided and inside, and the numbers of boxes."""
    from codac import PavingInOut

    border, inner = found.boxes(PavingInOut.bound), found.boxes(PavingInOut.inner)
    return {
        "undecided": float(sum(map(size, border))) / volume,
        "inner": float(sum(map(size, inner))) / volume,
        "boxes": len(border) + len(inner),
    }


def size(box: Any) -> float:
    """Return the volume of a box."""
    return float(prod(box[i].diam() for i in range(box.size())))


if __name__ == "__main__":
    serve("Codac", {"codac": "codac"}, {"paving": paving})
