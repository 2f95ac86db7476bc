"""Passages between two configurations: within a component, or the loops that separate them.

Not in the paper, whose Section 4 asks whether the last link can come to its mirrored pose.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Floats
from qbound.geometry import polygon
from qbound.geometry.arcs import last_before
from qbound.region import Component
from qbound.region.outline import Arc
from qbound.workspace.layers import Fibres
from qbound.workspace.planar import turns_within

Loop = tuple[Arc, ...]


@dataclass(frozen=True, eq=False)
class Exit:
    """Where a straight path leaves the region: the form of `boundary` changes sign there."""

    q: Floats
    boundary: str


@dataclass(frozen=True, eq=False)
class Passage:
    """The answer, with its reason.

    Attributes
    ----------
    possible : bool
        Whether some path inside the region leads from the one to the other.
    start, goal : int or None
        Their components; None where the configuration itself is not safe.
    loops : tuple of loops of arcs
        Where both are safe and no path exists: part of the boundary of the start's component, of
        which every path to the goal crosses at least one arc.
    exit : Exit or None
        A place where the straight path leaves the region; None where none was found, as when the
        start is not safe. A straight path that leaves does not rule out another one.
    """

    possible: bool
    start: int | None
    goal: int | None
    loops: tuple[Loop, ...]
    exit: Exit | None

    @property
    def boundaries(self) -> tuple[str, ...]:
        """Names of the boundaries along the loops, each once."""
        names = (arc.boundary for loop in self.loops for arc in loop)
        return tuple(dict.fromkeys(names))


def find_passage(region: Fibres, start: ArrayLike, goal: ArrayLike) -> Passage:
    """Tell whether the arm can move from one configuration to another without leaving the region.

    Parameters
    ----------
    region : Fibres
        Of `qbound.workspace.layers.find_fibres`; that of one side of the singular curve
        (`Workspace.covers.sides`) asks for a path that does not cross the curve.
    start, goal : array_like, shape (2,)
        rad or length. Joints without limits may turn on: full turns do not count.
    """
    a, b = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    one, other = region.component_of(a), region.component_of(b)
    possible = one is not None and one == other
    loops: tuple[Loop, ...] = ()
    if one is not None and other is not None and not possible:
        loops = _between(region, region.components[one], region.inside(other))
    return Passage(possible, one, other, loops, None if one is None else _exit(region, a, b))


def _between(region: Fibres, component: Component, q: Floats) -> tuple[Loop, ...]:
    """Return the loops of a component that part it from a configuration in another one.

    A loop that does not go round a joint bounds a disc. If the disc of a hole holds q, that loop
    parts them. Otherwise q lies beyond the outer loop, or beyond the loops that go round.
    """
    closed = [loop for loop in component.loops if not _goes_round(loop)]
    holes = [loop for loop in closed if polygon.area(_ring(loop)) < 0]
    for hole in holes:
        if any(polygon.contains(_ring(hole), copy) for copy in _copies(region, q, _ring(hole))):
            return (hole,)
    return tuple(loop for loop in component.loops if all(loop is not hole for hole in holes))


def _ring(loop: Loop) -> Floats:
    return np.concatenate([arc.points for arc in loop])


def _goes_round(loop: Loop) -> bool:
    return bool(np.abs(loop[-1].points[-1] - loop[0].points[0]).max() > math.pi)


def _copies(region: Fibres, q: Floats, ring: Floats) -> list[Floats]:
    """Return q with the full turns of unlimited joints that bring it into a ring's extent."""
    low, high = ring.min(axis=0), ring.max(axis=0)
    places = [
        [x] if limits is not None else turns_within("revolute", x, (a, b))
        for x, limits, a, b in zip(q, region.problem.ranges, low, high, strict=True)
    ]
    return [np.array([one, other]) for one in places[0] for other in places[1]]


def _exit(region: Fibres, a: Floats, b: Floats, n: int = 4097) -> Exit | None:
    """Return where the straight path leaves first, seen at n places of it and then bisected."""
    compiled = region.problem.evaluator

    def margins(t: Floats) -> Floats:
        return compiled.margins(a + t[:, None] * (b - a))

    def inside(t: Floats) -> NDArray[np.bool_]:
        return np.asarray((margins(t) >= 0).all(axis=1))

    t = np.linspace(0, 1, n)
    safe = inside(t)
    if safe.all():
        return None
    row = max(int(safe.argmin()), 1)
    low, high = last_before(inside, t[[row - 1]], t[[row]])
    return Exit(a + low * (b - a), compiled.names[int(margins(high)[0].argmin())])
