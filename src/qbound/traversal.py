"""Traversals: vertices visited in an order, the joint path between them and the tool's path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, permutations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.boundary import position
from qbound.robot import Robot

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Traversal:
    """A path through joint space, straight from vertex to vertex, and what the tool does.

    Attributes
    ----------
    q : ndarray, shape (m, n)
        Joint path, rad or length.
    tool : ndarray, shape (m, 3)
        Tool positions seen from the base; length.
    stops : ndarray of int
        Rows of `q` at which the vertices are visited.
    reach : ndarray, shape (m,)
        Distance of the tool from the origin of the first joint's frame; length.
    """

    q: Floats
    tool: Floats
    stops: NDArray[np.int64]
    reach: Floats

    @property
    def final_pose(self) -> Floats:
        """Joint values at the end, shape (n,)."""
        return np.asarray(self.q[-1])


def traverse(
    robot: Robot, vertices: ArrayLike, *, closed: bool = False, step: float = 0.01
) -> Traversal:
    """Visit vertices in the order given, along straight lines in joint space (Figures 7-9).

    Parameters
    ----------
    vertices : array_like, shape (m, n)
        Joint values, rad or length.
    closed : bool
        Whether to return to the first vertex.
    step : float
        Largest change of any joint from one row to the next.
    """
    stops = np.asarray(vertices, dtype=float)
    if closed:
        stops = np.concatenate([stops, stops[:1]])
    q, rows = _straight(stops, step)
    tool = position(robot, robot.tool)(q)
    shoulder = robot.frames(q).position(robot.base, robot.joints[0].frame, robot.base)
    return Traversal(q, tool, rows, np.linalg.norm(tool - shoulder, axis=-1))


def self_crossings(path: ArrayLike) -> Floats:
    """Return the points at which a plane path crosses itself, shape (k, 2).

    Two pieces cross where each has its ends on different sides of the other. A path that only
    touches itself, as a closed one does at its start, does not cross; nor is a crossing counted
    that passes exactly through a corner.

    Parameters
    ----------
    path : array_like, shape (m, 2)
    """
    p = np.asarray(path, dtype=float)
    start, step = p[:-1], np.diff(p, axis=0)
    gap = start[None, :] - start[:, None]
    turn = _cross(step[:, None], step[None, :])
    with np.errstate(divide="ignore", invalid="ignore"):
        t = _cross(gap, step[None, :]) / turn
        s = _cross(gap, step[:, None]) / turn
    later = np.triu(np.ones(turn.shape, dtype=bool), k=2)
    i, j = np.nonzero(later & (t > 0) & (t < 1) & (s > 0) & (s < 1))
    return np.asarray(start[i] + t[i, j, None] * step[i])


def simple_orders(
    robot: Robot, vertices: ArrayLike, length: int, plane: tuple[int, int] = (0, 2)
) -> list[tuple[int, ...]]:
    """Return the orders of `length` of the vertices whose open tool path does not cross itself.

    Each order is given once, in the direction that starts with the smaller index.
    """
    q = np.asarray(vertices, dtype=float)
    orders = (o for o in permutations(range(len(q)), length) if o[0] < o[-1])
    return [o for o in orders if not len(self_crossings(_tool_path(robot, q, o)[:, plane]))]


def _tool_path(robot: Robot, q: Floats, order: Sequence[int]) -> Floats:
    return traverse(robot, q[list(order)], step=0.03).tool


def _straight(stops: Floats, step: float) -> tuple[Floats, NDArray[np.int64]]:
    """Divide each straight piece evenly, no joint changing by more than `step`."""
    pieces = [
        np.linspace(a, b, max(1, int(np.ceil(np.abs(b - a).max() / step))) + 1)
        for a, b in pairwise(stops)
    ]
    rows = np.cumsum([0, *(len(piece) - 1 for piece in pieces)])
    return np.concatenate([stops[:1], *(piece[1:] for piece in pieces)]), rows


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
