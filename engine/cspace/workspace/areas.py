"""The exact geometric workspace of two joints: areas by one integral over circles or lines.

The first joint moves the tool rigidly, so the plane falls into circles about its axis (or lines
along its slide), one for each distance u of the second joint from the singularity. On each circle
the places that the arm reaches are intervals: fibres of the region, shifted by a known angle (or
length), one set for each posture. The lengths of their union and intersection, times abs(det J),
integrate to areas; between critical distances the integrand is analytic. Not in the paper, which
samples.

A report gathers what is asked of a workspace: areas, the postures of places, a passage. A passage
leads from one configuration to another within a component, or names the loops that separate them;
the paper's Section 4 asks whether the last link can reach its mirrored pose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats
from cspace.geometry import polygon
from cspace.geometry.arcs import last_before
from cspace.region import Component, NoHomeError, Problem, Region
from cspace.region.arcs import Arc, integrate
from cspace.workspace.layers import Cover, Fibres, Layers, Ranges, find_fibres
from cspace.workspace.planar import (
    AnyTurnError,
    PlanarArm,
    Posture,
    planar_arm,
    postures,
    values_within,
)

SINGULAR = "det J"
"""Name of the singular curve among the boundaries of an aspect."""


@dataclass(frozen=True, eq=False)
class Aspect:
    """A connected part of the region in which det J keeps its sign.

    Attributes
    ----------
    region : Component
        The aspect's boundary in joint space; the arcs named `SINGULAR` are the singular curve.
    component : int
        Index of the region's component that contains the aspect.
    side : int
        Sign of det J.
    image : float
        Area of the places that the tool reaches, each counted once; length squared.
    swept : float
        Integral of abs(det J): more than `image` where full turns reach a place twice.
    """

    region: Component
    component: int
    side: int
    image: float
    swept: float


@dataclass(frozen=True, eq=False)
class Workspace:
    """The places that the tool reaches in feasible postures.

    Attributes
    ----------
    arm : PlanarArm
    region : Fibres
        All components of the region.
    chosen : frozenset of int
        The components whose workspace this is.
    aspects : tuple of Aspect
        Of these components, by falling area of the image.
    area : float
        Area of all places that are reached; length squared.
    covered_twice : float
        Area of the places that are reached in both postures.
    sides : dict of int to float
        Area of the image on each side of the singular curve, by the sign of det J.
    covers : Layers
        The intervals on each circle or line.
    """

    arm: PlanarArm
    region: Fibres
    chosen: frozenset[int]
    aspects: tuple[Aspect, ...]
    area: float
    covered_twice: float
    sides: dict[int, float]
    covers: Layers

    @property
    def singular(self) -> tuple[Arc, ...]:
        """The singular curve inside these components, det J > 0 on its left."""
        arcs = (
            a for part in self.aspects for loop in part.region.loops for a in loop if part.side > 0
        )
        return tuple(arc for arc in arcs if arc.boundary == SINGULAR)

    def postures(self, place: ArrayLike) -> list[tuple[Posture, int | None]]:
        """Return every posture of a place with its component, or None if it is not feasible.

        All full turns within the ranges are listed; a posture that is outside them is listed once,
        as not feasible, unless every value of the first joint gives one. Errors as
        `cspace.workspace.planar.postures`.
        """
        inside, outside = postures(self.arm, place, self.region.problem.ranges), list[Posture]()
        sides = {posture.side for posture in inside}
        with suppress(AnyTurnError):
            outside = [p for p in postures(self.arm, place) if p.side not in sides]
        return [(p, self.region.component_of(p.q)) for p in [*inside, *outside]]

    def safe_postures(self, place: ArrayLike) -> int:
        """Count the feasible postures of a place, 0, 1 or 2, full turns of a joint counted once."""
        return len({p.side for p, owner in self.postures(place) if owner in self.chosen})

    def patches(self) -> list[tuple[int, Floats]]:
        """Cut the workspace into patches that are reached in one posture, or in two.

        Returns
        -------
        list of (int, ndarray of shape (k, 2))
            Number of postures and outline; points of the outline are exact.
        """
        return list(self.covers.patches())


def find_workspace(
    arm: PlanarArm, problem: Problem, home: ArrayLike, *, every: bool = False
) -> Workspace:
    """Return the exact workspace of the component with the home pose, or of every component.

    Parameters
    ----------
    arm : PlanarArm
        Of the same two joints as the problem.
    problem : Problem
        Problem of either rule.
    home : array_like, shape (2,)
    every : bool
        Whether to take all components.

    Raises
    ------
    NoHomeError
        If the home pose is in no component.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> from cspace.workspace.planar import planar_arm
    >>> robot = load_robot("minervabot-v2")
    >>> problem = find_region(robot).problem
    >>> found = find_workspace(planar_arm(robot), problem, robot.home)
    >>> round(found.area, 2), round(found.covered_twice, 2)
    (3391.72, 2491.81)

    A place may be reached in two postures or in one. Out of reach it has none:

    >>> [found.safe_postures(place) for place in ([40.0, 40.0], [0.0, 500.0])]
    [2, 0]
    """
    region = find_fibres(problem, home)
    chosen = frozenset(
        i for i, component in enumerate(region.components) if every or component.contains_home
    )
    if not chosen and not every:
        raise NoHomeError("the home pose is in no component of the region")
    sides = {side: _one_side(arm, problem, home, side) for side in arm.sides}
    owned = {side: _owned(region, part, chosen) for side, part in sides.items()}
    kept = {side: frozenset(own) for side, own in owned.items()}
    covers = Layers(arm, sides, kept, problem.ranges)
    keys = [(side, i) for side in sides for i in sorted(kept[side])]
    area, twice, *rest = covers.areas(
        _reached,
        _twice,
        *(partial(_image, side=side) for side in sides),
        *(partial(_image, side=side, aspect=i) for side, i in keys),
        *(partial(_swept, side=side, aspect=i) for side, i in keys),
    )
    images, swept = rest[len(sides) : len(sides) + len(keys)], rest[len(sides) + len(keys) :]
    aspects = [
        Aspect(sides[side].components[i], owned[side][i], side, *areas)
        for (side, i), *areas in zip(keys, images, swept, strict=True)
    ]
    aspects.sort(key=lambda aspect: -aspect.image)
    by_side = dict(zip(sides, rest, strict=False))
    return Workspace(arm, region, chosen, tuple(aspects), area, twice, by_side, covers)


def _owned(region: Fibres, part: Fibres, chosen: frozenset[int]) -> dict[int, int]:
    """Return the aspects inside chosen components, each with its component."""
    holders = {i: region.component_of(part.inside(i)) for i in range(len(part.components))}
    return {i: k for i, k in holders.items() if k is not None and k in chosen}


def _reached(laid: Cover) -> Floats:
    return laid.reached(laid.safe)


def _twice(laid: Cover) -> Floats:
    return laid.length(laid.held(laid.by(1)) & laid.held(laid.by(-1)))


def _image(laid: Cover, side: int, aspect: int | None = None) -> Floats:
    return laid.reached(laid.by(side, aspect))


def _swept(laid: Cover, side: int, aspect: int) -> Floats:
    return laid.swept(laid.by(side, aspect))


def _mixed(laid: Cover) -> Floats:
    return laid.length(laid.held(laid.safe) & laid.held(~laid.safe))


def overlap(arm: PlanarArm, problem: Problem, home: ArrayLike, square: Ranges) -> float:
    """Return the area of the places that are reached in feasible and in infeasible postures.

    Parameters
    ----------
    square : pair of (low, high) or None
        Range of the joint values that count, such as the range of a sample; None for one full turn.
        A configuration is feasible if it is in any component, infeasible if it is in none.
    """
    sides = {side: _one_side(arm, problem, home, side) for side in arm.sides}
    kept = {side: frozenset(range(len(part.components))) for side, part in sides.items()}
    (area,) = Layers(arm, sides, kept, square).areas(_mixed)
    return area


def area_by_green(arm: PlanarArm, region: Component) -> float:
    """Integrate x dz along the image of a component's boundary: the integral of det J over it.

    This is a second way to compute an aspect's `swept`, with its sign. The first way integrates
    over circles, this one along arcs. Length squared.
    """

    def x_dz(q: Floats, dq: Floats) -> Floats:
        return np.asarray(arm.tool[0](q) * (arm.tool[1].gradient(q) * dq).sum(axis=-1))

    return float(integrate([arc for loop in region.loops for arc in loop], x_dz))


def _one_side(arm: PlanarArm, problem: Problem, home: ArrayLike, side: int) -> Fibres:
    """Find the aspects with one sign of det J: the region with it as one more form."""
    if arm.singularity is None:
        return find_fibres(problem, home)
    return find_fibres(problem.with_form(SINGULAR, side * arm.singular.coefficients), home)


@dataclass(frozen=True, eq=False)
class PlaceReport:
    """A place of the plane and the postures that reach it.

    Attributes
    ----------
    place : tuple of two float
        Length.
    postures : list of (Posture, int or None)
        Each posture with its component; None if it is not feasible.
    safe : int
        Number of feasible postures: 0, 1 or 2.
    """

    place: tuple[float, float]
    postures: list[tuple[Posture, int | None]]
    safe: int


@dataclass(frozen=True, eq=False)
class WorkspaceReport:
    """The workspace of the home component, with answers to the questions about it.

    Attributes
    ----------
    workspace : Workspace
    safe_and_unsafe : float
        Area of the places that are reached in feasible and in infeasible postures; length squared.
    places : list of PlaceReport
    passage : Passage or None
        None if no passage was asked for.
    """

    workspace: Workspace
    safe_and_unsafe: float
    places: list[PlaceReport]
    passage: Passage | None

    @property
    def all_safe(self) -> bool:
        """Whether every place has a feasible posture and the passage, if any, is possible."""
        return all(at.safe for at in self.places) and (not self.passage or self.passage.possible)


def workspace_report(
    region: Region,
    places: Sequence[tuple[float, float]] = (),
    poses: Sequence[ArrayLike] = (),
) -> WorkspaceReport:
    """Find the workspace of the home component, postures of places, a passage between two poses.

    Parameters
    ----------
    places : sequence of (float, float)
        In the plane of motion; length.
    poses : sequence of two array_like, shape (2,), or none
        Start and goal of a passage; rad or length.

    Raises
    ------
    NoHomeError
        If the home pose is in no component.
    ValueError
        If the tool leaves its plane: a ``NoPlanarWorkspaceError``.
    """
    robot, problem = region.robot, region.problem
    arm, home = planar_arm(robot, problem.held), robot.home[list(problem.joints)]
    one, other = (robot.joints[j].limits for j in problem.joints)
    workspace = find_workspace(arm, problem, home)
    return WorkspaceReport(
        workspace,
        overlap(arm, problem, home, (one, other)),
        [PlaceReport(at, workspace.postures(at), workspace.safe_postures(at)) for at in places],
        find_passage(workspace.region, *poses) if poses else None,
    )


# --- passages -------------------------------------------------------------------------------------


Loop = tuple[Arc, ...]


@dataclass(frozen=True, eq=False)
class Exit:
    """Where a straight path leaves the region: the form of `boundary` changes sign there."""

    q: Floats
    boundary: str


@dataclass(frozen=True, eq=False)
class Passage:
    """Answer whether a path joins two configurations, with its reason.

    Attributes
    ----------
    possible : bool
        Whether some path inside the region leads from start to goal.
    start, goal : int or None
        Their components; None where the configuration itself is not feasible.
    loops : tuple of loops of arcs
        If both are feasible and no path exists: loops of the boundary of the start's component.
        Every path to the goal crosses at least one of their arcs.
    exit : Exit or None
        A place where the straight path leaves the region; None if none was found, for example
        because the start is infeasible. If the straight path leaves, another path may still exist.
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
        From `cspace.workspace.layers.find_fibres`. The fibres of one side of the singular curve
        (`Layers.sides`) ask for a path that does not cross the curve.
    start, goal : array_like, shape (2,)
        rad or length. For joints without limits full turns do not count.
    """
    a, b = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    one, other = region.component_of(a), region.component_of(b)
    possible = one is not None and one == other
    loops: tuple[Loop, ...] = ()
    if one is not None and other is not None and not possible:
        loops = _between(region, region.components[one], region.inside(other))
    return Passage(possible, one, other, loops, None if one is None else _exit(region, a, b))


def _between(region: Fibres, component: Component, q: Floats) -> tuple[Loop, ...]:
    """Return the loops of a component that separate it from a configuration in another component.

    A loop that does not go round a joint bounds a disc. If the disc of a hole holds q, the loop of
    that hole separates them. Otherwise q lies beyond the outer loop, or beyond the loops that go
    round a joint.
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
        [x] if limits is not None else values_within("revolute", x, (a, b))
        for x, limits, a, b in zip(q, region.problem.ranges, low, high, strict=True)
    ]
    return [np.array([one, other]) for one in places[0] for other in places[1]]


def _exit(region: Fibres, a: Floats, b: Floats, n: int = 4097) -> Exit | None:
    """Return where the straight path leaves first: checked at n places, then bisected."""
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
