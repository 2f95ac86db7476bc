"""A robot with letters for its lengths: its forms are then the formulas that the paper prints.

`with_symbols` makes such a robot, and every function of `boundary` takes it. SymPy is imported only
here and where symbols come in.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from qbound.arrays import Array, whole_numbers
from qbound.robot import Boundary, HalfSpace, Robot


def joint_symbols(robot: Robot) -> tuple[Any, ...]:
    r"""Return a real SymPy symbol for each joint: :math:`q_1, q_2, \ldots`.

    Examples
    --------
    >>> from qbound import load_robot
    >>> from qbound.symbols import joint_symbols
    >>> joint_symbols(load_robot("minervabot-v2"))
    (q_1, q_2)
    """
    import sympy

    names = [re.sub(r"(?<=\D)(\d+)$", r"_\1", joint.name) for joint in robot.joints]
    return tuple(sympy.Symbol(name, real=True) for name in names)


def with_symbols(robot: Robot) -> Robot:
    r"""Return the robot with a symbol in place of every offset that is not zero.

    Offsets of joints and points get the paper's labels :math:`x_{a,b}, y_{a,b}, z_{a,b}` (rule 8 of
    Section 2). The offset of a half-space becomes :math:`x_{\min,1}, x_{\min,2}, \ldots` as in
    Table 5, with the letter of the largest component of its normal. Axes and normals become exact
    numbers where they are whole. `offset_values` has the numbers of the symbols.

    Examples
    --------
    ``beta_{1,1}`` of eq. (29), derived:

    >>> from qbound import components, load_robot
    >>> from qbound.symbols import joint_symbols, with_symbols
    >>> robot = with_symbols(load_robot("minervabot-v2"))
    >>> components(robot, robot.boundary("B1"))[0].symbolic(joint_symbols(robot))
    -x_{0,6} + x_{1,7}*cos(q_1) + z_{1,7}*sin(q_1)
    """
    joints = tuple(
        replace(
            joint,
            origin=_labelled(joint.parent, joint.frame, joint.origin),
            axis=whole_numbers(joint.axis),
            mount=whole_numbers(joint.mount),
        )
        for joint in robot.joints
    )
    points = tuple(replace(p, at=_labelled(p.frame, p.name, p.at)) for p in robot.points)
    boundaries: list[Boundary] = []
    counts = {"x": 0, "y": 0, "z": 0}
    for boundary in robot.boundaries:
        if isinstance(boundary, HalfSpace):
            letter = "xyz"[int(np.argmax(np.abs(boundary.normal)))]
            counts[letter] += 1
            offset: Any = _symbol(f"{letter}_{{min,{counts[letter]}}}")
            normal = whole_numbers(boundary.normal)
            boundaries.append(replace(boundary, normal=normal, offset=offset))
        else:
            boundaries.append(boundary)
    return replace(robot, joints=joints, points=points, boundaries=tuple(boundaries))


def offset_values(robot: Robot) -> dict[Any, float]:
    """Return the value of each symbol of `with_symbols`, in the robot's unit of length.

    Examples
    --------
    The first offset of Table 1:

    >>> from qbound import load_robot
    >>> from qbound.symbols import offset_values
    >>> next(iter(offset_values(load_robot("minervabot-v2")).items()))
    (z_{0,1}, 22.5)
    """
    pairs = zip(_offsets(with_symbols(robot)), _offsets(robot), strict=True)
    return {symbol: float(value) for symbol, value in pairs if symbol != 0}


def with_values(symbolic: Robot, values: Mapping[Any, float]) -> Robot:
    """Put numbers in place of the symbols of `with_symbols`: the same arm with other offsets.

    Parameters
    ----------
    symbolic : Robot
        From `with_symbols`.
    values : mapping of symbol to float
        A value for every symbol, such as `offset_values` with some of them changed.

    Examples
    --------
    The first joint 23 cm above the base:

    >>> from qbound import load_robot
    >>> from qbound.symbols import offset_values, with_symbols, with_values
    >>> robot = load_robot("minervabot-v2")
    >>> values = offset_values(robot)
    >>> one = next(iter(values))
    >>> with_values(with_symbols(robot), values | {one: 23.0}).joints[0].origin.tolist()
    [0.0, 0.0, 23.0]
    """

    def number(x: Any) -> float:
        return float(values.get(x, x))

    def numbers(vector: Array) -> Array:
        return np.array([number(x) for x in vector.flat]).reshape(vector.shape)

    joints = tuple(
        replace(
            joint,
            origin=numbers(joint.origin),
            axis=numbers(joint.axis),
            mount=numbers(joint.mount),
        )
        for joint in symbolic.joints
    )
    points = tuple(replace(point, at=numbers(point.at)) for point in symbolic.points)
    boundaries = tuple(
        replace(b, normal=numbers(b.normal), offset=number(b.offset))
        if isinstance(b, HalfSpace)
        else b
        for b in symbolic.boundaries
    )
    return replace(symbolic, joints=joints, points=points, boundaries=boundaries)


def _offsets(robot: Robot) -> Iterator[Any]:
    """Yield every offset of joints, points and half-spaces in a fixed order."""
    for joint in robot.joints:
        yield from joint.origin
    for point in robot.points:
        yield from point.at
    for boundary in robot.boundaries:
        if isinstance(boundary, HalfSpace):
            yield boundary.offset


def _symbol(name: str) -> Any:
    import sympy

    return sympy.Symbol(name, real=True)


def _labelled(a: str, b: str, vector: Array) -> Array:
    """Return the labels of the components that are not zero, such as ``x_{a,b}``."""
    import sympy

    labels = [f"{letter}_{{{a},{b}}}" for letter in "xyz"]
    pairs = zip(labels, vector, strict=True)
    return np.array([_symbol(n) if x else sympy.S.Zero for n, x in pairs], dtype=object)
