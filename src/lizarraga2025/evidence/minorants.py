r"""Lower bounds of a boundary function over simplices of joint space (not in the paper).

Certificates have a bound of their own, on the way of a corner (`inequality`). These three are on
the boundary function, a sum of waves, and are here to compare: by the second derivative, by the
range of each wave, and by the slope.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.boundary.functions import clearance
from qbound.forms.bending import second_order, worst_edges
from qbound.forms.harmonic import HarmonicForm
from qbound.geometry import simplices
from qbound.model.robot import Robot
from qbound.proofs.certificates.statements import Statement, corners_of, units, wider
from qbound.proofs.subdivide import Cells, Judged, Search, Simplices, subdivide
from qbound.tolerances import NEGLIGIBLE

__all__ = ["Bound", "leaves", "lipschitz", "natural", "search_all", "second_order"]


Bound = Callable[[HarmonicForm, Floats], Floats]
"""From a form and cells, shape (N, k, n), to a number below the form on each cell, shape (N,)."""


def lipschitz(form: HarmonicForm, cells: Floats) -> Floats:
    r"""Bound by the slope: :math:`\beta(m) - \sum_k |A_k| |w_k \cdot d|`. Revolute joints only."""
    centre, waves = cells.mean(axis=1), form.waves
    angles = np.abs((cells - centre[:, None]) @ waves.turns.T)
    return np.asarray((form(centre)[:, None] - angles @ np.abs(waves.amplitudes)).min(axis=1))


def natural(form: HarmonicForm, cells: Floats) -> Floats:
    """Bound by interval arithmetic: each wave by its least value on the cell. Revolute joints only.

    Already better than the natural extension of products of sines and cosines, which forgets that
    the factors belong together.
    """
    waves = form.waves
    phases = cells @ waves.turns.T + np.angle(waves.amplitudes)
    low, high = phases.min(axis=1), phases.max(axis=1)
    trough = np.floor((high - math.pi) / (2 * math.pi)) >= np.ceil((low - math.pi) / (2 * math.pi))
    least = np.where(trough, -1.0, np.minimum(np.cos(low), np.cos(high)))
    return np.asarray(least @ np.abs(waves.amplitudes))


def search_all(
    robot: Robot, statement: Statement, bound: Bound, most: int = 300_000
) -> dict[str, Search]:
    """Cut the triangles of a polygon until a bound is positive on each, for every boundary in use.

    Parameters
    ----------
    robot : Robot
        All of its boundaries in use are about points.
    most : int
        Cells that are opened for one boundary before it is left.
    """
    asked = wider(robot, statement)
    forms = {
        boundary.name: clearance(asked, boundary)
        for boundary in asked.used
        if asked.least_distance(boundary) != 0
    }
    cells = Simplices(np.array(corners_of(statement), dtype=float) * units(robot))
    return {
        name: subdivide(cells, [0], _judge(form, bound), most)[0] for name, form in forms.items()
    }


def _judge(form: HarmonicForm, bound: Bound) -> Callable[[Cells, NDArray[Any]], Judged]:
    slack = NEGLIGIBLE * np.abs(form.waves.amplitudes).sum()

    def judge(cells: Cells, _: NDArray[Any]) -> Judged:
        assert isinstance(cells, Simplices)
        proved = bound(form, cells.corners) > slack
        leaves = ["." if each else "" for each in proved]
        margins = form(cells.centres)
        margins = np.where(margins < -slack, margins, 0)
        return Judged(leaves, worst_edges(form, cells.corners), margins, cells.centres)

    return judge


def leaves(corners: Floats, trees: Sequence[str]) -> Floats:
    """Return the simplices on which a proof rests, shape (M, k, n).

    Parameters
    ----------
    corners : ndarray, shape (N, k, n)
        Of the cells, in any unit.
    trees : sequence of str
        One for each cell.
    """
    found = []
    for cell, tree in zip(corners, trees, strict=True):
        todo = [cell]
        for token in re.findall("[a-z]|[0-9]*[.]", tree):
            top = todo.pop()
            if token.endswith("."):
                found.append(top)
            else:
                todo += [*simplices.halved(top[None], np.array([ord(token) - ord("a")]))[::-1]]
    return np.array(found)
