"""How far are vertices and arcs of a region from the true ones? The same places, in 60 digits.

Nothing of the region's own mathematics takes part: where a point is comes from the chain of joints,
in Arb's numbers, and the true place is found by Newton's method, one joint limit, pair or wall a
row. Distances are those to the solution of exactly the numbers that the robot has. Where whole
bodies touch, the closed form's margin over its slope stands for them, in doubles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from math import hypot
from typing import Any

import numpy as np
from closed_form import PlanarArm, Turn
from flint import arb, ctx
from numpy.typing import NDArray
from scenes import robot

from qbound import Region, Robot, find_region
from qbound.model.robot import BodyPair, HalfSpace, Pair
from qbound.region.outline import integrate
from qbound.units import limited_joints

Floats = NDArray[np.float64]
Function = Callable[[Sequence[Any]], Any]

DIGITS, DOUBLE = 60, 16
PLACES = 41
"""Places on each arc."""
STEP = 1e-7
"""Of the differences that stand for slopes, rad: Newton's method gains some six digits a round."""
ROUNDS = 10
"""Of Newton's method: more than 50 digits."""


@lru_cache(maxsize=8)
def errors(scene: str) -> dict[str, Any]:
    """Return how far vertices and arcs of a scene's region are from the true ones, at most.

    Returns
    -------
    dict
        ``vertices`` and ``places`` (how many were looked at), ``vertex_error`` and ``arc_error``
        (largest distances, rad), ``digits`` of the numbers that they are held against;
        ``area`` (rad^2), ``area_error``, its difference from the integral along the arcs, over it.
    """
    arm = robot(scene)
    region = find_region(arm)
    vertices = [vertex for component in region.components for vertex in component.vertices]
    loops = [loop for component in region.components for loop in component.loops]
    arcs = [(arc, arc.at(np.linspace(0, 1, PLACES))) for loop in loops for arc in loop]
    if any(isinstance(boundary, BodyPair) for boundary in arm.used):
        digits, form = DOUBLE, PlanarArm(arm)
        corners = [by_margin(form, np.array([vertex.q])) for vertex in vertices]
        places = [by_margin(form, q) for _, q in arcs]
    else:
        digits, functions = DIGITS, functions_of(arm)
        corners = [
            distance(vertex.q, [functions[name] for name in vertex.boundaries])
            for vertex in vertices
        ]
        places = [distance(x, [functions[arc.boundary]]) for arc, q in arcs for x in q]
    return {
        "vertices": len(vertices),
        "places": PLACES * len(arcs),
        "vertex_error": max(corners, default=0.0),
        "arc_error": max(places, default=0.0),
        "digits": digits,
        "area": region.area,
        "area_error": abs(around(region) - region.area) / region.area,
    }


def of_arcs(found: dict[str, Any]) -> dict[str, float]:
    """Return what of the quality of an answer that is arcs is known better than of polygons."""
    far = max(found["vertex_error"], found["arc_error"])
    distances = dict.fromkeys(("missed", "invented", "distance", "typical"), far)
    return distances | {"area": found["area"], "area_error": found["area_error"]}


def around(region: Region) -> float:
    """Return the area by integrals along the arcs: another way than the sum of the cells.

    Raises
    ------
    ValueError
        If a component goes round both joints: then no such integral is its area.
    """
    total = 0.0
    for component in region.components:
        if all(component.wraps):
            raise ValueError("a component goes round both joints")
        along, sign = (0, -1) if component.wraps[0] else (1, 1)
        arcs = [arc for loop in component.loops for arc in loop]
        total += float(integrate(arcs, lambda q, dq, k=along, s=sign: s * q[:, 1 - k] * dq[:, k]))
    return total


def by_margin(form: PlanarArm, q: Floats) -> float:
    """Return how far places are from the boundary at most, rad: margin over slope, in doubles."""
    places = q.T
    low, high = (
        [form.of(places + step * np.eye(2)[j][:, None]) for j in (0, 1)] for step in (-STEP, STEP)
    )
    slope = np.hypot(*(np.array(high) - np.array(low))) / (2 * STEP)
    return float(np.max(np.abs(form.of(places)) / slope))


def functions_of(arm: Robot) -> dict[str, Function]:
    """Return what vanishes on each boundary and at each joint limit, by name."""
    form = PlanarArm(arm)
    functions = {boundary.name: _function(form, arm, boundary) for boundary in arm.used}
    limits = {n: joint for n, joint in limited_joints(arm).items() if joint.limits}
    for name, joint in limits.items():
        j, (low, high) = arm.joint_index(joint.name), joint.limits
        end = low if name.endswith("lower") else high
        functions[name] = lambda q, j=j, end=end: q[j] - arb(end)
    return functions


def _function(form: PlanarArm, arm: Robot, boundary: Any) -> Function:
    if isinstance(boundary, HalfSpace):
        point = arm.point(boundary.point)
        normal, level = form.place(boundary.normal), boundary.offset + point.radius

        def height(q: Sequence[Any]) -> Any:
            seen = form.seen(_turns(form, q), (0, arm.depth(point.frame)), form.place(point.at))
            return seen.x * normal.x + seen.y * normal.y - level

        return height
    if isinstance(boundary, Pair):
        points = [arm.point(name) for name in boundary.points]
        one, other = sorted(points, key=lambda point: arm.depth(point.frame))
        frames, to = (arm.depth(one.frame), arm.depth(other.frame)), form.place(one.at)
        apart = arb(arm.required_distance(boundary))

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
    with ctx.workdps(DIGITS):
        true = [arb(float(x)) for x in q]
        for _ in range(ROUNDS):
            values = [function(true) for function in functions]
            for j, row in enumerate(inverse):
                step = sum((arb(float(x)) * v for x, v in zip(row, values, strict=True)), arb(0))
                true[j] = (true[j] - step).mid()
        return hypot(*(float(x - arb(float(old))) for x, old in zip(true, q, strict=True)))


def _slope(function: Function, q: Floats) -> list[float]:
    result = []
    with ctx.workdps(DIGITS):
        for j in range(len(q)):
            ends = [[arb(float(x)) + s * STEP * (k == j) for k, x in enumerate(q)] for s in (1, -1)]
            result.append(float(function(ends[0]) - function(ends[1])) / (2 * STEP))
    return result
