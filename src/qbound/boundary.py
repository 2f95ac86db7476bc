"""Boundary functions: harmonic forms of a robot's points (Theorem 1, eqs. 9-29, Tables 3-5).

A point is carried along the chain towards an observer: each joint that it passes gives its
coordinates the factors (1, cos q, sin q) or (1, q, q²). So the formulas of eq. (29) are derived
here and never typed. All of them are about points: whole links may touch where every pair of points
keeps apart.

A function that takes a boundary takes a Pair or a HalfSpace; `robot.boundary("B3")` returns one.
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
        A frame c that is the point's frame b or precedes it; default: the base (Table 2).

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
    >>> from qbound import load_robot, position
    >>> position(load_robot("minervabot-v2"))([0.0, 0.0]).round(9).tolist()
    [40.0, 0.0, 48.48]
    """
    return _carried(robot, robot.point(point or robot.tool), observer or robot.base).position


def squared_distance(
    robot: Robot, point: str, observer: str | None = None, centre: ArrayLike = (0, 0, 0)
) -> HarmonicForm:
    r"""Return the form :math:`|r_{c,p} - m|^2 = |r_{c,p}|^2 - 2\,m \cdot r_{c,p} + |m|^2`.

    It is the square of a distance such as that of eq. (11), in the robot's unit of length, squared.

    Parameters
    ----------
    point, observer : str
        As in `position`, with its errors.
    centre : array_like, shape (3,)
        The point m, fixed in the observer's frame c.

    Examples
    --------
    The tool stays 25 cm from joint 2:

    >>> from qbound import load_robot
    >>> from qbound.boundary import squared_distance
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
    Point 10 is fixed to link 1, point 11 to link 2:

    >>> from qbound import load_robot
    >>> from qbound.boundary import observer
    >>> robot = load_robot("minervabot-v2")
    >>> observer(robot, robot.boundary("B3"))
    '1'
    """
    return _nearer_first(robot, pair)[0].frame


def pair_vector(robot: Robot, pair: Pair) -> HarmonicForm:
    r"""Return :math:`B(q) = r_{a,b} + R_{a,b}\,r_{b,b+m} - r_{a,a+n}` (eq. 16), seen from frame a.

    Its three forms are :math:`\beta_{i,1}, \beta_{i,2}, \beta_{i,3}`. The vector goes from the
    first point of the pair to the second. If the second point is the one nearer to the base, the
    sign of eq. (16) changes. Seen from the base the same vector is turned by :math:`R_{0,a}`
    (eq. 25).

    Returns
    -------
    HarmonicForm, stack (3,)
        In the robot's unit of length.

    Raises
    ------
    ValueError
        If neither point's frame precedes the frame of the other point in the chain.

    Examples
    --------
    >>> from qbound import load_robot, pair_vector
    >>> robot = load_robot("minervabot-v2")
    >>> pair_vector(robot, robot.boundary("B1"))([0.0, 0.0]).round(3).tolist()
    [4.0, 0.0, 14.91]
    """
    near, far = _nearer_first(robot, pair)
    found = position(robot, far.name, near.frame) - near.at
    return found if near.name == pair.points[0] else -found


def half_space_vector(robot: Robot, boundary: HalfSpace) -> HarmonicForm:
    r"""Return :math:`B(q) = S\,r_{0,p} - o\,n` with :math:`S = n\,n^T` and the offset o (Table 5).

    For a normal n along an axis, S is the selection matrix :math:`S_x` or :math:`S_z` of Table 5.

    Returns
    -------
    HarmonicForm, stack (3,)
        In the robot's unit of length; with n along z only the third component is not zero.

    Examples
    --------
    >>> from qbound import load_robot
    >>> from qbound.boundary import half_space_vector
    >>> robot = load_robot("minervabot-v2")
    >>> half_space_vector(robot, robot.boundary("B7"))([0.0, 0.0]).round(3).tolist()
    [0.0, 0.0, 37.16]
    """
    selection = np.outer(boundary.normal, boundary.normal)
    return position(robot, boundary.point).dot(selection) - boundary.offset * boundary.normal


def components(robot: Robot, boundary: Boundary) -> HarmonicForm:
    r"""Return the vector :math:`B_i(q) = [\beta_{i,1}, \beta_{i,2}, \beta_{i,3}]` (eq. 29).

    This is `pair_vector` of a Pair, a point boundary function, and `half_space_vector` of a
    HalfSpace, a geometric one.

    Raises
    ------
    TypeError
        If the boundary is neither a Pair nor a HalfSpace.

    Examples
    --------
    ``beta_{3,1} = x_{1,2} - x_{1,10} + x_{2,11} cos(q2) + z_{2,11} sin(q2)`` as a form in q2:

    >>> from qbound import components, load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> c0, a, b = components(robot, robot.boundary("B3"))[0].along(1, [0.0, 0.0])
    >>> float(c0.round(9)), float(a), float(b)
    (-2.82, 9.09, -5.25)
    """
    if isinstance(boundary, Pair):
        return pair_vector(robot, boundary)
    _check_type(boundary)
    return half_space_vector(robot, boundary)


def clearance(robot: Robot, boundary: Boundary) -> HarmonicForm:
    r"""Return the single form that is positive where a boundary is respected (eq. 9).

    It is zero on the boundary and negative beyond. A pair has :math:`|B|^2 - d_{\min}^2`, a length
    squared (eq. 11); a half-space has :math:`n \cdot r_{0,p} - o`, a length (eq. 12). `margins` has
    lengths for both. The attribute `clearance` of a pair is only the number :math:`d_{\min}`.

    Returns
    -------
    HarmonicForm, stack ()

    Raises
    ------
    TypeError
        If the boundary is neither a Pair nor a HalfSpace.

    Examples
    --------
    The height of the tool over its limit:

    >>> from qbound import clearance, load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> round(float(clearance(robot, robot.boundary("B7"))([0.2, -0.5])), 3)
    41.05
    """
    if isinstance(boundary, HalfSpace):
        return position(robot, boundary.point).dot(boundary.normal) - boundary.offset
    _check_type(boundary)
    near, far = _nearer_first(robot, boundary)
    return squared_distance(robot, far.name, near.frame, near.at) - boundary.clearance**2


def margins(robot: Robot, q: ArrayLike) -> dict[str, Array]:
    r"""Return the margin of every boundary in use: a length, positive if respected.

    A pair has :math:`\|r_{a+n,b+m}\| - d_{\min}` (eq. 11), a half-space :math:`n \cdot r_{0,p} - o`
    (eq. 12). Only points are measured, not the outlines of links.

    Parameters
    ----------
    q : array_like, shape (..., n)
        Joint values, rad or length.

    Returns
    -------
    dict of str to ndarray, shape (...)
        By the boundary's name, in the robot's unit of length.

    Examples
    --------
    At the home pose point 10 is 7.83 cm farther from point 11 than its clearance of 0.1 cm:

    >>> from qbound import load_robot, margins
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
    """Tell which configurations respect every boundary in use: eqs. (11) and (12).

    Only points are tested, not the outlines of links, and not the limits of joints (eq. 10).

    Parameters
    ----------
    q : array_like, shape (..., n)
        Joint values, rad or length.

    Returns
    -------
    ndarray of bool, shape (...)

    Examples
    --------
    >>> from qbound import keeps_clear, load_robot
    >>> keeps_clear(load_robot("minervabot-v2"), [[0.0, 0.0], [1.2, 0.8]]).tolist()
    [True, False]
    """
    kept = np.ones(np.shape(q)[:-1], dtype=bool)
    for boundary in robot.used:
        kept &= clearance(robot, boundary)(q) >= 0
    return kept


@dataclass(frozen=True)
class Approach:
    """The configuration at which the two points of a pair come closest.

    Attributes
    ----------
    joint : int
        Number of the one joint between them, from 0.
    q : float
        Value of that joint, rad in (-pi, pi].
    gap : float
        Distance of the points there. If it is not 0, B(q) = 0 (eq. 17) has no solution: the points
        never meet.
    radii : tuple of float
        Distance of each point of the pair from the origin of the joint's frame. In the plane their
        difference is the gap.
    """

    joint: int
    q: float
    gap: float
    radii: tuple[float, float]


def closest_approach(robot: Robot, pair: Pair) -> Approach:
    r"""Return where the points of a pair with one turning joint between them come closest.

    The squared distance :math:`c_0 + a \cos q + b \sin q` (eq. 11, squared) is least at
    :math:`q = \mathrm{atan2}(-b, -a)`, opposite to the direction of (a, b).

    Raises
    ------
    ValueError
        If there is not one joint between the points, or it slides.

    Examples
    --------
    With the printed offsets the points 12 and 13 come within 0.08 cm of each other, not closer:

    >>> from qbound import closest_approach, load_robot
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
    >>> from qbound.boundary import single_joint
    >>> robot = load_robot("minervabot-v2")
    >>> single_joint(robot, robot.boundary("B3"))
    1
    """
    near, far = _nearer_first(robot, pair)
    joints = {motion.joint for motion in robot.chain(far.frame, near.frame)}
    if len(joints) != 1:
        raise ValueError(
            f"{pair.name}: its points are {len(joints)} joints apart, and this needs one joint "
            "between them; "
            + ("cspace handles the regions of such pairs" if joints else "they are on one link")
        )
    return joints.pop()


def _check_type(boundary: object) -> None:
    if not isinstance(boundary, Pair | HalfSpace):
        raise TypeError(
            f"a {type(boundary).__name__} has no single boundary function; a Pair or a HalfSpace "
            "has one, such as robot.boundary('B1')"
        )


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
