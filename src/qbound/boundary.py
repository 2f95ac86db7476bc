"""Boundary functions: harmonic forms of a robot's points (Theorem 1, eqs. 9-29, Tables 3-5).

A point is carried along the chain towards an observer; each joint multiplies what is carried by
(1, cos q, sin q) or (1, q, q²). The formulas of the paper are derived here, never typed. All of
them speak of points: whole links may touch where every pair of points keeps apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Array, Bools
from qbound.forms import HarmonicForm, constant
from qbound.robot import Boundary, HalfSpace, Pair, Point, PointForms, Robot


def position(robot: Robot, point: str | None = None, observer: str | None = None) -> HarmonicForm:
    r"""Return x, y, z of a point as forms: :math:`r_{c,p} = r_{c,b} + R_{c,b}\,r_{b,p}` (eq. 20).

    Parameters
    ----------
    point : str, optional
        Name of a point or frame; default: the tool.
    observer : str, optional
        A frame c that carries the point's frame b; default: the base (Table 2).

    Returns
    -------
    HarmonicForm, stack (3,)
        In the robot's unit of length.

    Raises
    ------
    ValueError
        If a name is unknown, or the observer does not precede the point.

    Examples
    --------
    >>> from qbound import load_robot
    >>> position(load_robot("minervabot-v2"))([0.0, 0.0]).round(9).tolist()
    [40.0, 0.0, 48.48]
    """
    return _carried(robot, robot.point(point or robot.tool), observer or robot.base).position


def squared_distance(
    robot: Robot, point: str, observer: str | None = None, centre: ArrayLike = (0, 0, 0)
) -> HarmonicForm:
    r"""Return the form :math:`|r_{c,p} - m|^2 = |r_{c,p}|^2 - 2\,m \cdot r_{c,p} + |m|^2`.

    Parameters
    ----------
    point, observer : str
        As in `position`, with its errors.
    centre : array_like, shape (3,)
        The point m, fixed in the observer's frame c.

    Examples
    --------
    >>> from qbound import load_robot
    >>> float(squared_distance(load_robot("minervabot-v2"), "3", "2")([0.4, 0.9]).round(9))
    625.0
    """
    found = _carried(robot, robot.point(point), observer or robot.base)
    m = np.asarray(centre)
    return found.squared - found.position.dot(2 * m) + np.asarray(m @ m)


def observer(robot: Robot, pair: Pair) -> str:
    """Return the frame a of Theorem 1: that of the pair's point nearer to the base.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> observer(robot, robot.boundary("B3"))
    '1'
    """
    return _nearer_first(robot, pair)[0].frame


def pair_vector(robot: Robot, pair: Pair) -> HarmonicForm:
    r"""Return :math:`B(q) = r_{a,b} + R_{a,b}\,r_{b,b+m} - r_{a,a+n}` (eq. 16), seen from frame a.

    Its three forms are :math:`\beta_{i,1}, \beta_{i,2}, \beta_{i,3}`, from the first point of the
    pair to the second. Seen from the base the same vector is turned by :math:`R_{0,a}` (eq. 25).

    Returns
    -------
    HarmonicForm, stack (3,)
        In the robot's unit of length.

    Raises
    ------
    ValueError
        If neither of the two points' frames carries the other one.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> pair_vector(robot, robot.boundary("B1"))([0.0, 0.0]).round(3).tolist()
    [4.0, 0.0, 14.91]
    """
    near, far = _nearer_first(robot, pair)
    found = position(robot, far.name, near.frame) - near.at
    return found if near.name == pair.points[0] else -found


def half_space_vector(robot: Robot, boundary: HalfSpace) -> HarmonicForm:
    r"""Return :math:`B(q) = S\,r_{0,p} - o\,n` with :math:`S = n\,n^T` and the offset o (Table 5).

    Returns
    -------
    HarmonicForm, stack (3,)
        In the robot's unit of length; with n along z only the third component is not zero.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> half_space_vector(robot, robot.boundary("B7"))([0.0, 0.0]).round(3).tolist()
    [0.0, 0.0, 37.16]
    """
    selection = np.outer(boundary.normal, boundary.normal)
    return position(robot, boundary.point).dot(selection) - boundary.offset * boundary.normal


def components(robot: Robot, boundary: Boundary) -> HarmonicForm:
    r"""Return the vector :math:`B_i(q) = [\beta_{i,1}, \beta_{i,2}, \beta_{i,3}]` (eq. 29).

    This is `pair_vector` of a point boundary function, `half_space_vector` of a geometric one.

    Examples
    --------
    ``beta_{3,1} = x_{1,2} - x_{1,10} + x_{2,11} cos(q2) + z_{2,11} sin(q2)``:

    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> c0, a, b = components(robot, robot.boundary("B3"))[0].along(1, [0.0, 0.0])
    >>> float(c0.round(9)), float(a), float(b)
    (-2.82, 9.09, -5.25)
    """
    if isinstance(boundary, Pair):
        return pair_vector(robot, boundary)
    return half_space_vector(robot, boundary)


def clearance(robot: Robot, boundary: Boundary) -> HarmonicForm:
    r"""Return the form that is positive exactly where a boundary is respected (eq. 9).

    A pair has :math:`|B|^2 - d_{\min}^2`, a length squared (eq. 11); a half-space has
    :math:`n \cdot r_{0,p} - o`, a length (eq. 12).

    Raises
    ------
    TypeError
        If the boundary is neither a Pair nor a HalfSpace.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> round(float(clearance(robot, robot.boundary("B7"))([0.2, -0.5])), 3)
    41.05
    """
    if isinstance(boundary, HalfSpace):
        return position(robot, boundary.point).dot(boundary.normal) - boundary.offset
    if not isinstance(boundary, Pair):
        raise TypeError(f"a {type(boundary).__name__} has no single boundary function")
    near, far = _nearer_first(robot, boundary)
    return squared_distance(robot, far.name, near.frame, near.at) - boundary.clearance**2


def margins(robot: Robot, q: ArrayLike) -> dict[str, Array]:
    r"""Return the margin of every boundary in use, by points: a length, positive if respected.

    A pair has :math:`\|r_{a+n,b+m}\| - d_{\min}` (eq. 11), a half-space :math:`n \cdot r_{0,p} - o`
    (eq. 12). Outlines of links are not looked at.

    Parameters
    ----------
    q : array_like, shape (..., n)

    Returns
    -------
    dict of str to ndarray, shape (...)
        By the boundary's name.

    Examples
    --------
    >>> from qbound import load_robot
    >>> found = margins(load_robot("minervabot-v2"), [0.0, 0.0])
    >>> {name: round(float(margin), 2) for name, margin in found.items()}
    {'B1': 15.34, 'B2': 23.1, 'B3': 7.83, 'B4': 20.62, 'B7': 37.16}
    """
    found = {}
    for boundary in robot.used:
        value = clearance(robot, boundary)(q)
        if isinstance(boundary, Pair):
            squared = np.maximum(value + boundary.clearance**2, 0)  # not below 0 by rounding
            value = np.asarray(np.sqrt(squared) - boundary.clearance)
        found[boundary.name] = value
    return found


def keeps_clear(robot: Robot, q: ArrayLike) -> Bools:
    """Tell which configurations, shape (..., n), respect every boundary in use, by points.

    These are eqs. (11) and (12). Outlines of links are not looked at.

    Examples
    --------
    >>> from qbound import load_robot
    >>> keeps_clear(load_robot("minervabot-v2"), [[0.0, 0.0], [1.2, 0.8]]).tolist()
    [True, False]
    """
    kept = np.ones(np.shape(q)[:-1], dtype=bool)
    for boundary in robot.used:
        kept &= clearance(robot, boundary)(q) >= 0
    return kept


@dataclass(frozen=True)
class Approach:
    """Where the two points of a pair come closest.

    Attributes
    ----------
    joint : int
        Number of the one joint between them, from 0.
    q : float
        Value of that joint, rad in (-pi, pi].
    gap : float
        Distance of the points there. If it is not 0, B(q) = 0 has no solution.
    radii : tuple of float
        Distance of each point from the joint. In the plane their difference is the gap.
    """

    joint: int
    q: float
    gap: float
    radii: tuple[float, float]


def closest_approach(robot: Robot, pair: Pair) -> Approach:
    r"""Return where the points of a pair with one turning joint between them come closest.

    The squared distance :math:`c_0 + a \cos q + b \sin q` is least opposite to (a, b).

    Raises
    ------
    ValueError
        If there is not one joint between the points, or it slides.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> found = closest_approach(robot, robot.boundary("B4"))
    >>> round(found.gap, 4), round(float(np.degrees(found.q)), 3)
    (0.0802, -164.137)
    """
    joint = single_joint(robot, pair)
    if not robot.joints[joint].turns:
        raise ValueError(f"{pair.name}: the joint {robot.joints[joint].name} slides")
    _, a, b = clearance(robot, pair).along(joint, robot.home)
    q = np.array(robot.home, dtype=float)
    q[joint] = np.arctan2(-b, -a)
    frames, hinge = robot.frames(q), robot.joints[joint].frame
    one, other = (float(np.linalg.norm(frames.position(hinge, p, hinge))) for p in pair.points)
    gap = float(np.linalg.norm(pair_vector(robot, pair)(q)))
    return Approach(joint, float(q[joint]), gap, (one, other))


def single_joint(robot: Robot, pair: Pair) -> int:
    """Return the number of the one joint between the points of a pair, from 0.

    Raises
    ------
    ValueError
        If there is not one joint between them.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> single_joint(robot, robot.boundary("B3"))
    1
    """
    near, far = _nearer_first(robot, pair)
    joints = {motion.joint for motion in robot.chain(far.frame, near.frame)}
    if len(joints) != 1:
        raise ValueError(
            f"{pair.name}: its points are {len(joints)} joints apart, and this needs one joint "
            "between them; cspace handles the regions of such pairs"
        )
    return joints.pop()


def _nearer_first(robot: Robot, pair: Pair) -> tuple[Point, Point]:
    """Return the points a+n and b+m: the one nearer to the base first."""
    first, second = (robot.point(name) for name in pair.points)
    if len(robot.chain(first.frame)) <= len(robot.chain(second.frame)):
        return first, second
    return second, first


def _carried(robot: Robot, point: Point, observer: str) -> PointForms:
    """Carry a point along the chain to the observer's frame (eq. 18)."""
    squared = np.asarray(point.at @ point.at)
    forms = PointForms(constant(point.at, robot.kinds), constant(squared, robot.kinds))
    for motion in robot.chain(point.frame, observer):
        forms = motion.seen_from_parent(forms)
    return forms
