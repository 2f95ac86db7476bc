"""How far are vertices and arcs of a region from the true ones? The same places, in 60 digits.

Nothing of the region's own mathematics takes part: where a point is comes from the chain of joints,
in Arb's numbers, and the true place is found by Newton's method, one joint limit, pair or wall a
row. Distances are those to the solution of exactly the numbers that the robot has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import hypot
from typing import Any

import numpy as np
from closed_form import PlanarArm, Turn
from flint import arb, ctx
from numpy.typing import NDArray

from qbound import Robot, find_region
from qbound.model.robot import HalfSpace, Pair
from qbound.units import limited_joints

Floats = NDArray[np.float64]
Function = Callable[[Sequence[Any]], Any]

DIGITS = 60
PLACES = 41
"""Places on each arc."""
STEP = 1e-7
"""Of the differences that stand for slopes, rad: Newton's method gains some six digits a round."""
ROUNDS = 10
"""Of Newton's method: more than 50 digits."""


def errors(robot: Robot) -> dict[str, Any]:
    """Return how far vertices and arcs of the robot's region are from the true ones, at most; rad.

    Returns
    -------
    dict
        ``vertices`` and ``places`` (how many were looked at), ``vertex_error``, ``arc_error``
        (largest distances), ``digits``.

    Raises
    ------
    TypeError
        If a boundary is neither a pair of points, a wall nor a joint limit.
    """
    region, functions = find_region(robot), functions_of(robot)
    vertices = [
        distance(vertex.q, [functions[name] for name in vertex.boundaries])
        for component in region.components
        for vertex in component.vertices
    ]
    places = [
        distance(q, [functions[arc.boundary]])
        for component in region.components
        for loop in component.loops
        for arc in loop
        for q in arc.at(np.linspace(0, 1, PLACES))
    ]
    return {
        "vertices": len(vertices),
        "places": len(places),
        "vertex_error": max(vertices, default=0.0),
        "arc_error": max(places, default=0.0),
        "digits": DIGITS,
    }


def functions_of(robot: Robot) -> dict[str, Function]:
    """Return what vanishes on each boundary and at each joint limit, by name."""
    form = PlanarArm(robot)
    functions = {boundary.name: _function(form, robot, boundary) for boundary in robot.used}
    limits = {n: joint for n, joint in limited_joints(robot).items() if joint.limits}
    for name, joint in limits.items():
        j, (low, high) = robot.joint_index(joint.name), joint.limits
        end = low if name.endswith("lower") else high
        functions[name] = lambda q, j=j, end=end: q[j] - arb(end)
    return functions


def _function(form: PlanarArm, robot: Robot, boundary: Any) -> Function:
    if isinstance(boundary, HalfSpace):
        point = robot.point(boundary.point)
        normal, level = form.place(boundary.normal), boundary.offset + point.radius

        def height(q: Sequence[Any]) -> Any:
            seen = form.seen(_turns(form, q), (0, robot.depth(point.frame)), form.place(point.at))
            return seen.x * normal.x + seen.y * normal.y - level

        return height
    if isinstance(boundary, Pair):
        points = [robot.point(name) for name in boundary.points]
        one, other = sorted(points, key=lambda point: robot.depth(point.frame))
        frames, to = (robot.depth(one.frame), robot.depth(other.frame)), form.place(one.at)
        apart = arb(robot.required_distance(boundary))

        def distance(q: Sequence[Any]) -> Any:
            seen = form.seen(_turns(form, q), frames, form.place(other.at))
            return (seen.x - to.x) ** 2 + (seen.y - to.y) ** 2 - apart**2

        return distance
    raise TypeError(f"no reference for {boundary!r}")


def _turns(form: PlanarArm, q: Sequence[Any]) -> list[Turn]:
    pairs = zip(form.signs.tolist(), q, strict=True)
    return [Turn(x.cos(), sign * x.sin()) for sign, x in pairs]


def distance(q: Floats, functions: Sequence[Function]) -> float:
    """Return how far a place is from where two functions vanish, or from where one does; rad.

    Of one function the nearest place is looked for along its slope.
    """
    slopes = np.array([_slope(function, q) for function in functions])
    inverse = np.linalg.pinv(slopes)
    ctx.dps = DIGITS
    true = [arb(float(x)) for x in q]
    for _ in range(ROUNDS):
        values = [function(true) for function in functions]
        for j, row in enumerate(inverse):
            step = sum((arb(float(x)) * v for x, v in zip(row, values, strict=True)), arb(0))
            true[j] = (true[j] - step).mid()
    return hypot(*(float(x - arb(float(old))) for x, old in zip(true, q, strict=True)))


def _slope(function: Function, q: Floats) -> list[float]:
    ctx.dps = DIGITS
    result = []
    for j in range(len(q)):
        ends = [[arb(float(x)) + s * STEP * (k == j) for k, x in enumerate(q)] for s in (1, -1)]
        result.append(float(function(ends[0]) - function(ends[1])) / (2 * STEP))
    return result
