"""Margins of a robot with any number of joints, limits included, and whether it is feasible."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Bools
from qbound.boundary.evaluator import evaluator
from qbound.model.robot import Robot, refuse_no_robot


@overload
def margins(robot: Robot, q: Sequence[float]) -> list[tuple[str, float]]: ...
@overload
def margins(robot: Robot, q: ArrayLike) -> Any: ...
def margins(robot: Robot, q: ArrayLike) -> Any:
    """Return the margins of configurations to every boundary in use and to every joint limit.

    Margins are lengths for boundaries (``|B| - d_min``, or the depth inside a half-space), joint
    units for limits; negative where violated (eqs. 9-12), 0 where rounding alone makes it so.

    Parameters
    ----------
    robot : Robot
        With any number of joints.
    q : array_like, shape (n,) or (..., n)
        One configuration, or many; rad or length.

    Returns
    -------
    list of (str, float), or ndarray of shape (..., m)
        Of one configuration the boundaries by name; of many an array whose last axis has the
        boundaries in the same order.

    Raises
    ------
    ValueError
        If a joint value is NaN, infinite or complex, or there is not one for each joint.

    Examples
    --------
    >>> from qbound import load_robot, margins
    >>> robot = load_robot("two-joint-arm-with-walls")
    >>> name, margin = min(margins(robot, [0.0, 0.0]), key=lambda item: item[1])
    >>> name, round(margin, 3)
    ('forearm, lamp', 0.131)

    All joints count, however many, and a joint limit is a boundary; on its limit a joint keeps it:

    >>> dict(margins(load_robot("pp-portal"), [0.0, 100.0]))["beam.lower"]
    0.0

    Many configurations are one call:

    >>> margins(robot, [[0.0, 0.0], [0.1, 0.2], [3.0, 0.0]]).min(axis=-1).round(3).tolist()
    [0.131, 0.04, -0.422]
    """
    refuse_no_robot("margins", robot)
    table = evaluator(robot)
    found = table.margins(q)
    return found if found.ndim > 1 else list(zip(table.names, found.tolist(), strict=True))


def violated(robot: Robot, q: Sequence[float] | NDArray[np.float64]) -> list[tuple[str, float]]:
    """Return those of the `margins` of one configuration that are negative; none: feasible.

    Examples
    --------
    >>> from qbound import load_robot, violated
    >>> robot = load_robot("minervabot-v2")
    >>> [(name, round(margin, 3)) for name, margin in violated(robot, [1.5, 0.0])]
    [('B7', -26.882)]
    >>> violated(robot, [0.2, -0.5])
    []
    """
    if np.ndim(q) > 1:
        raise ValueError("one configuration is wanted; for many there are margins and is_feasible")
    return [(name, margin) for name, margin in margins(robot, q) if margin < 0]


def is_feasible(robot: Robot, q: ArrayLike) -> Bools:
    """Tell where configurations keep every boundary in use and every joint limit (eqs. 9-12).

    Parameters
    ----------
    robot : Robot
        With any number of joints.
    q : array_like, shape (..., n)
        One configuration, or millions; rad or length.

    Returns
    -------
    ndarray of bool, shape (...)
        Where no margin is negative.

    Raises
    ------
    ValueError
        If a joint value is NaN, infinite or complex, or there is not one for each joint.

    Examples
    --------
    >>> from qbound import is_feasible, load_robot
    >>> robot, q = load_robot("ur5"), [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]
    >>> bool(is_feasible(robot, q))
    True

    Nothing touches where the first joint is past its limit of a full turn, and it is infeasible:

    >>> is_feasible(robot, [q, [7.0, *q[1:]]]).tolist()
    [True, False]
    """
    refuse_no_robot("is_feasible", robot)
    return evaluator(robot).feasible(q)
