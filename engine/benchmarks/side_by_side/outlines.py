"""Who finds the boundary of a region, to an accuracy in rad: exact arcs, rays, and an alpha shape.

Rays and samples ask our evaluator whether a configuration is free, the fastest way that we know of.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from asking import Timed, timed
from scenes import SEED, ends, robot

from cspace import find_region
from cspace.boundary.evaluator import evaluator

RAYS = 12.0
"""Rays, times the root of the accuracy: chords between them are as near to a curve as that."""
STRIDE = 0.05
"""Stride of the walk along a ray, rad: what is thinner may be stepped over."""
FOUND = 20_000
"""Configurations among which a start is looked for where home is not feasible."""


def qbound_arcs(task: str, scene: str, accuracy: float) -> Timed:
    """Answer with the exact arcs of a robot in memory, which have one accuracy only.

    The polygons by which areas are compared are not timed, and 1e-6 rad from the arcs at most;
    ``stated`` is the largest error that the region states of its vertices.
    """
    arm = robot(scene)
    find_region(arm)  # what loads at the first call
    seconds, processor, region = timed(lambda: find_region(arm))
    errors = [vertex.error for part in region.components for vertex in part.vertices]
    answer = {"shape": region.to_shapely(1e-6), "stated": max(errors, default=0.0)}
    return seconds, processor, answer


def rays(task: str, scene: str, accuracy: float) -> Timed:
    """Answer with one polygon about a feasible place: the first way out in each direction.

    As users do it: every ray is walked in equal strides until a configuration is not free, and the
    last stride is halved until it is shorter than the accuracy; all rays at once. What is behind a
    boundary, seen from the start, is not found, and neither is any other component.
    """
    import shapely

    arm = robot(scene)
    free, at, count = evaluator(arm).feasible, start(scene), math.ceil(RAYS / math.sqrt(accuracy))
    low, high = ends(arm)
    turning = np.array([joint.limits is None for joint in arm.joints])

    def work() -> np.ndarray:
        angle = np.arange(count) * (2 * math.pi / count)
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            to_ends = np.where(direction > 0, high - at, low - at) / direction
            turn = 2 * math.pi / np.abs(direction)
        last = np.where(turning, turn, np.where(direction == 0, np.inf, to_ends)).min(axis=1)
        safe, end, walking = np.zeros(count), last.copy(), np.arange(count)
        while len(walking):
            there = np.minimum(safe[walking] + STRIDE, last[walking])
            kept = free(at + there[:, None] * direction[walking])
            end[walking[~kept]], safe[walking[kept]] = there[~kept], there[kept]
            walking = walking[kept & (there < last[walking])]
        while np.max(end - safe) > accuracy:
            middle = (safe + end) / 2
            kept = free(at + middle[:, None] * direction)
            safe, end = np.where(kept, middle, safe), np.where(kept, end, middle)
        return at + safe[:, None] * direction

    free(at[None])
    seconds, processor, ring = timed(work)
    return seconds, processor, {"rays": count, "at": at.tolist(), "shape": shapely.Polygon(ring)}


def start(scene: str) -> np.ndarray:
    """Return a scene's home, or, where that is not feasible, a place with a large margin."""
    arm = robot(scene)
    told, drawn = evaluator(arm), np.random.default_rng(1).uniform(*ends(arm), (FOUND, 2))
    return arm.home if told.feasible(arm.home) else drawn[told.margins(drawn).min(axis=1).argmax()]


def alpha_shape(task: str, scene: str, accuracy: float) -> Timed:
    """Answer with the alpha shape of the free ones of random configurations.

    As its documentation has it: `alphashape.alphashape(points, alpha)`, a shapely geometry ("Using
    a fixed alpha parameter"); to leave alpha away, so that it is optimised, takes far longer still.
    Configurations come as near to each other as the accuracy, on average. Hardly any disc of radius
    ``gap`` has none: of n in an area A a disc of area a has none with probability exp(-n a / A), so
    the largest without has some a = A log(n) / n, and half more of it makes holes rare.
    """
    import alphashape

    arm = robot(scene)
    low, high = ends(arm)
    free, area = evaluator(arm).feasible, float(np.prod(high - low))
    count = math.ceil(area / accuracy**2)
    gap = math.sqrt(1.5 * area * math.log(count) / (math.pi * count))
    turns = [(0.0,) if joint.limits else (0.0, -2 * np.pi, 2 * np.pi) for joint in arm.joints]

    def work() -> object:
        drawn = np.random.default_rng(SEED).uniform(low, high, (count, 2))
        # Repeated beyond the cut of a joint that turns all the way round: else it ends before it.
        every = np.concatenate([drawn[free(drawn)] + np.array(turn) for turn in product(*turns)])
        near = ((every > low - 2 * gap) & (every < high + 2 * gap)).all(axis=1)
        return alphashape.alphashape(every[near], 1 / gap)

    seconds, processor, shape = timed(work)
    return seconds, processor, {"configurations": count, "shape": shape}
