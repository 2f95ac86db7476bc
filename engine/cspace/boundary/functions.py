"""Boundary functions: robot + points -> harmonic forms (Theorem 1, eqs. 9-29, Tables 3-5).

A point is propagated along the chain towards an observer; each joint multiplies what is carried so
far by (1, cos q, sin q) or (1, q). Coordinates come out as arrays of coefficients, of numbers or of
symbols: the formulas of the paper are derived here, never typed.

The error bound of a coefficient in floats follows from the lengths that were summed.

A form of degree d is a length to the power d. A slide's value is a length too: its coefficient has
one degree less for each power of it, so that millimetres and metres have the same bound, and there
is none beyond the degree of the form.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import reduce, singledispatch

import numpy as np
from numpy.typing import ArrayLike

from cspace.arguments import refuse_type
from cspace.arrays import Array, Floats, cross
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import HarmonicForm, Kind, add_constant, times_function
from cspace.model.robot import (
    BodyPair,
    Boundary,
    HalfSpace,
    Pair,
    Point,
    Robot,
    Step,
    refuse_no_robot,
)
from cspace.printable import printable
from cspace.tolerances import ROUNDING, ZERO_AMPLITUDE


def position(robot: Robot, point: str, observer: str | None = None) -> HarmonicForm:
    """Return the coordinates of a point seen from a frame that carries it (Table 2, eqs. 20, 21).

    Parameters
    ----------
    observer : str, optional
        Frame; default the base.

    Returns
    -------
    HarmonicForm, shape (3,)
        x, y, z from the observer's origin; length.

    Raises
    ------
    ValueError
        If the observer is not a frame between the base and the point.
    """
    return HarmonicForm(_propagate(robot, point, observer)[0], robot.kinds)


def squared_distance(
    robot: Robot, point: str, observer: str | None = None, centre: ArrayLike = (0, 0, 0)
) -> HarmonicForm:
    r"""Return the squared distance of a point from a place `centre` fixed in the observer's frame.

    It has no products such as :math:`\cos^2 q`: a rotation keeps lengths, so a joint only adds
    twice a dot product. Arguments and errors as in `position`.
    """
    u, squared = _propagate(robot, point, observer)
    centre = np.asarray(centre)
    return HarmonicForm(_from(centre, u, squared), robot.kinds)


def observer(robot: Robot, pair: Pair) -> str:
    """Return the frame a of Theorem 1: that of the pair's point nearer to the base."""
    _, near, _ = _near_far(robot, pair)
    return near.frame


def pair_vector(robot: Robot, pair: Pair) -> HarmonicForm:
    r"""Return :math:`B(q) = r_{a,b} + R_{a,b}\,r_{b,b+m} - r_{a,a+n}` (eq. 16), seen from frame a.

    Returns
    -------
    HarmonicForm, shape (3,)
        :math:`\beta_{i,1}, \beta_{i,2}, \beta_{i,3}`, from the first point named to the
        second; length.

    Notes
    -----
    Eq. (25) shows the same vector from the base, turned by :math:`R_{0,a}`.

    Examples
    --------
    >>> from cspace import load_robot
    >>> from cspace.boundary.functions import pair_vector
    >>> robot = load_robot("minervabot-v2")
    >>> vector = pair_vector(robot, robot.boundary("B1"))
    >>> vector([0.0, 0.0]).round(3).tolist()
    [4.0, 0.0, 14.91]
    """
    sign, near, far = _near_far(robot, pair)
    vector = position(robot, far.name, near.frame) - near.at
    return vector if sign > 0 else -vector


def clearance(robot: Robot, boundary: Boundary | str) -> HarmonicForm:
    r"""Return the form that is positive exactly where the boundary is respected (eqs. 9, 11, 12).

    Parameters
    ----------
    robot : Robot
    boundary : Boundary or str
        One of its boundaries, or the name of one.

    Returns
    -------
    HarmonicForm, shape ()
        A pair: :math:`|B|^2 - d_{\min}^2` in length squared, where :math:`d_{\min}` is the two
        radii plus the clearance.
        A half-space: ``normal . r - offset - radius`` in length.

    Examples
    --------
    >>> from cspace import clearance, load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> floor = clearance(robot, "B7")
    >>> round(float(floor([0.2, -0.5])), 3), floor.gradient([0.2, -0.5]).round(3).tolist()
    (41.05, [-43.746, -23.883])

    The value for a pair is a difference of squares; `cspace.margins` gives lengths:

    >>> pair = clearance(robot, "B1")
    >>> round(float(pair([0.2, -0.5])), 3)
    179.453
    """
    refuse_no_robot("clearance", robot)
    return _clearance(robot.boundary(boundary) if isinstance(boundary, str) else boundary, robot)


def components(robot: Robot, boundary: Boundary) -> HarmonicForm:
    """Return the vector :math:`B_i(q)` of a boundary, point or geometric (eq. 29), shape (3,).

    Examples
    --------
    >>> from cspace import load_robot
    >>> from cspace.boundary.functions import components
    >>> robot = load_robot("minervabot-v2")
    >>> components(robot, robot.boundary("B7"))([0.0, 0.0]).round(3).tolist()
    [0.0, 0.0, 37.16]
    """
    refuse_no_robot("components", robot)
    return _components(boundary, robot)


def margin_of(robot: Robot, boundary: Boundary, value: ArrayLike) -> Array:
    """Return the margin, a length, of a boundary whose clearance form has the value."""
    value, d_min = np.asarray(value), robot.least_distance(boundary)
    if d_min is None:
        return value
    return np.asarray(np.sqrt(np.maximum(value + d_min**2, 0.0)) - d_min)


def term_size(robot: Robot, boundary: Boundary) -> float:
    """Bound the terms whose sum is a boundary's clearance form; rounding is relative to this bound.

    If terms cancel, the coefficients of the form do not show the size of the terms: ``0.3**2 - (0.1
    + 0.2)**2`` is not 0 in floats. The unit is a length; for a pair, whose form is a squared
    distance, a length squared.

    Raises
    ------
    ValueError
        If the boundary is about bodies.
    """
    if isinstance(boundary, Pair):
        _, near, far = _near_far(robot, boundary)
        observer, rest = near.frame, float(np.linalg.norm(near.at))
    elif isinstance(boundary, HalfSpace) and boundary.body is None:
        far, observer = robot.point(boundary.point), robot.base
        rest = abs(boundary.offset) + far.radius
    else:
        raise ValueError(_of_bodies(boundary))
    steps = _steps(robot, far, observer)
    links = sum(float(np.linalg.norm(step.origin)) for step in steps)
    links += sum(robot.joints[step.joint].farthest for step in steps if step.slides)
    size = links + float(np.linalg.norm(far.at)) + rest
    d_min = robot.least_distance(boundary)
    return size if d_min is None else size**2 + d_min**2


def moving_joints(robot: Robot, boundary: Boundary) -> tuple[int, ...]:
    """Return the joints that change a boundary's clearance; if none, it holds always or never.

    A coefficient that is only rounding, compared with the robot's reach, does not count as motion:
    a turn about an oblique axis leaves 1e-16 where exact numbers leave 0.
    """
    form, reach = clearance(robot, boundary), robot.reach
    powers = [np.array(FACTORS[kind].largest(reach), dtype=float) for kind in robot.kinds]
    sizes = np.abs(form.coefficients) * reduce(_outer, powers)
    squared = robot.least_distance(boundary) is not None
    rounding = ZERO_AMPLITUDE * (reach**2 if squared else reach)
    return HarmonicForm(np.where(sizes > rounding, sizes, 0), robot.kinds).joints()


def closest_approach(robot: Robot, pair: Pair) -> tuple[float, float]:
    """Return the joint value at which a pair's points come closest, and their distance there.

    The squared distance is ``c0 + a cos q + b sin q``, least opposite to the direction (a, b).

    Returns
    -------
    q : float
        Value of the one joint between the points, rad, in (-pi, pi].
    distance : float
        Length. If it is not 0, then B = 0 (eq. 17) has no solution.

    Raises
    ------
    ValueError
        If the distance does not depend on exactly one joint, a revolute one.
    """
    form, joints = clearance(robot, pair), moving_joints(robot, pair)
    if len(joints) != 1 or not robot.joints[joints[0]].turns:
        raise ValueError(
            f"{printable(pair.name)}: its distance depends on {len(joints)} joints, not on one turn"
        )
    q = np.array(robot.home)
    _, a, b = form.along(joints[0], q)
    q[joints[0]] = np.arctan2(-b, -a)
    return float(q[joints[0]]), float(np.linalg.norm(pair_vector(robot, pair)(q)))


def geometric_vector(robot: Robot, boundary: HalfSpace) -> HarmonicForm:
    r"""Return the vector of a half-space (Table 5): the selected component, zeros elsewhere.

    It is :math:`B(q) = S\,r_{0,i} - w\,n` with the point i, the wall's offset w and its normal n.
    The selection matrix is :math:`S = n\,n^T`, the paper's :math:`S_x` or :math:`S_z` where n is an
    axis.

    Returns
    -------
    HarmonicForm, shape (3,)
        :math:`\beta_{i,1}, \beta_{i,2}, \beta_{i,3}`; length.
    """
    n = boundary.normal
    return position(robot, boundary.point).dot(np.outer(n, n)) - boundary.offset * n


# --- what each type of boundary has of its own ----------------------------------------------------


@singledispatch
def _clearance(boundary: Boundary, robot: Robot) -> HarmonicForm:
    if not isinstance(boundary, Boundary):
        refuse_type("boundary", boundary, "a boundary of the robot, or its name")
    raise TypeError(
        f"{printable(boundary.name)}: no clearance form for a {type(boundary).__name__}"
    )


@singledispatch
def _components(boundary: Boundary, robot: Robot) -> HarmonicForm:
    if not isinstance(boundary, Boundary):
        refuse_type("boundary", boundary, "a boundary of the robot")
    raise TypeError(
        f"{printable(boundary.name)}: eq. (29) has no row for a {type(boundary).__name__}"
    )


@_clearance.register
def _(boundary: Pair, robot: Robot) -> HarmonicForm:
    _, near, far = _near_far(robot, boundary)
    u, squared = _propagate(robot, far.name, near.frame)
    from_near, d_min = _from(near.at, u, squared), robot.required_distance(boundary)
    return HarmonicForm(add_constant(from_near, -(d_min**2)), robot.kinds)


@_components.register
def _(boundary: Pair, robot: Robot) -> HarmonicForm:
    return pair_vector(robot, boundary)


@_clearance.register
def _(boundary: BodyPair, robot: Robot) -> HarmonicForm:
    raise ValueError(_of_bodies(boundary))


@_components.register
def _(boundary: BodyPair, robot: Robot) -> HarmonicForm:
    raise ValueError(_of_bodies(boundary))


@_clearance.register
def _(boundary: HalfSpace, robot: Robot) -> HarmonicForm:
    if boundary.body is not None:
        raise ValueError(_of_bodies(boundary))
    radius = robot.point(boundary.point).radius
    height = _dot(boundary.normal, _propagate(robot, boundary.point, None)[0])
    return HarmonicForm(add_constant(height, -(boundary.offset + radius)), robot.kinds)


@_components.register
def _(boundary: HalfSpace, robot: Robot) -> HarmonicForm:
    if boundary.body is not None:
        raise ValueError(_of_bodies(boundary))
    return geometric_vector(robot, boundary)


def _of_bodies(boundary: Boundary) -> str:
    said = f"{printable(boundary.name)} is about whole bodies: it has no single boundary function"
    return f"{said}; margins(robot, q) has its signed distance"


# --- a point carried along the chain --------------------------------------------------------------


def _outer(left: Array, right: Array) -> Array:
    return np.multiply.outer(left, right)


def _near_far(robot: Robot, pair: Pair) -> tuple[int, Point, Point]:
    """Return 1, or -1 if the second point is nearer to the base; then the nearer and the other."""
    first, second = (robot.point(name) for name in pair.points)
    if robot.steps_to(first.frame) <= robot.steps_to(second.frame):
        return 1, first, second
    return -1, second, first


def _from(centre: Array, u: Array, squared: Array) -> Array:
    """Return the coefficients of |u - centre|^2, from the coefficients of u and of |u|^2."""
    return add_constant(squared + _dot(-2 * centre, u), centre @ centre)


def _propagate(robot: Robot, name: str, observer: str | None) -> tuple[Array, Array]:
    """Carry the position u of a point, and |u|^2, from its frame to the observer's: coefficients.

    The coefficients of u have shape (3, 3, ..., 3), those of its square (3, ..., 3).
    """
    point = robot.point(name)
    u = np.zeros((3,) + (3,) * len(robot.joints), dtype=point.at.dtype)
    u = add_constant(u, point.at)
    squared = add_constant(np.zeros_like(u[0]), point.at @ point.at)
    passed = set[int]()
    for step in _steps(robot, point, robot.base if observer is None else observer):
        kind = robot.joints[step.joint].kind if step.joint in passed else None
        u, squared = _pass(step, u, squared, kind)
        passed.add(step.joint)
    return u, squared


def _steps(robot: Robot, point: Point, observer: str) -> tuple[Step, ...]:
    """Return the steps between a point and its observer, the point's first."""
    first, last = robot.steps_to(observer), robot.steps_to(point.frame)
    if first > last:
        raise ValueError(f"frame {observer!r} does not carry the point {point.name!r}")
    return robot.steps[first:last][::-1]


def _dot(matrix: Array, u: Array) -> Array:
    """Contract the last axis of a vector or matrix with the first of u, as `tensordot` does."""
    product = np.dot(matrix.reshape(-1, 3), u.reshape(3, -1))
    return np.asarray(product.reshape(matrix.shape[:-1] + u.shape[1:]))


def _pass(step: Step, u: Array, squared: Array, kind: Kind | None) -> tuple[Array, Array]:
    """Express u (and |u|^2) before a step; `kind` is given if u depends on the step's joint."""
    u, squared = (_slide if step.slides else _turn)(step, u, squared, kind)
    moved = _dot(step.mount, u)
    squared = squared + 2 * _dot(step.origin, moved)
    squared = add_constant(squared, step.origin @ step.origin)
    return add_constant(moved, step.origin), squared


def _turn(step: Step, u: Array, squared: Array, kind: Kind | None) -> tuple[Array, Array]:
    """Turn u about a unit axis by Rodrigues' formula: constant, cosine and sine part."""
    axis, j = step.axis, step.joint
    u = u if kind else np.take(u, 0, axis=j + 1)
    along = np.multiply.outer(axis, _dot(axis, u))
    across = cross(axis, u) if step.sense > 0 else -cross(axis, u)
    if not kind:
        return np.stack([along, u - along, across], axis=j + 1), squared
    cosine, sine = (times_function(x, j + 1, k, kind) for x, k in ((u - along, 1), (across, 2)))
    return along + cosine + sine, squared


def _slide(step: Step, u: Array, squared: Array, kind: Kind | None) -> tuple[Array, Array]:
    """Add q times a unit axis to u; |u|^2 gains 2 q axis . u + q^2."""
    axis, j = step.axis * step.sense, step.joint
    gain = times_function(2 * _dot(axis, u), j, 1, kind)
    square = times_function(add_constant(np.zeros_like(squared), 1), j, 2)
    ahead = times_function(add_constant(np.zeros_like(u), axis), j + 1, 1)
    return u + ahead, squared + gain + square


# --- errors of coefficients -----------------------------------------------------------------------


@dataclass(frozen=True)
class Sizes:
    """The lengths that go into the coefficients of a form of two free joints.

    Attributes
    ----------
    length : float
        Sum of all these lengths.
    slides : frozenset of int
        Which of the two free joints slide.
    joints : int
        Number of joints on the way; each adds rounding of its own.
    """

    length: float
    slides: frozenset[int]
    joints: int

    def further(self, length: float) -> Sizes:
        """Return the sizes with one more length."""
        return replace(self, length=self.length + length)

    def relative(self, degree: int) -> float:
        """Return the error of a coefficient, relative to its lengths to the power of the degree."""
        return ROUNDING * max(1, degree) * (1 + self.joints / 4)


def coefficient_errors(
    degree: ArrayLike, length: ArrayLike, relative: ArrayLike, slides: Collection[int]
) -> Floats:
    """Return bounds of the errors of the coefficients of forms, shape (..., 3, 3).

    Parameters
    ----------
    degree : array_like of int, shape (...)
        Degree of each form as a power of a length: 0, 1 or 2.
    length : array_like, shape (...)
        Sum of the lengths that go into each form.
    relative : array_like, shape (...)
        Error relative to that length to the power of the degree.
    slides : collection of int
        Which of the two free joints slide.
    """
    degree, length, relative = (np.asarray(x)[..., None, None] for x in (degree, length, relative))
    powers = np.add.outer(*(np.arange(3) * (joint in slides) for joint in (0, 1)))
    left = degree - powers
    return np.asarray(np.where(left >= 0, length ** np.maximum(left, 0), 0.0) * relative)


def clearance_error(robot: Robot, held: Mapping[int, float], boundary: Boundary) -> Floats:
    """Return bounds of the errors of a clearance form's coefficients, shape (3, 3).

    Parameters
    ----------
    held : mapping of int to float
        Values of all joints but two, by index.
    boundary : Boundary
        A pair of points, or a half-space that bounds a point.
    """
    names: tuple[str, ...] = ()
    asked = 0.0
    if isinstance(boundary, Pair):
        names, asked = boundary.points, boundary.clearance
    elif isinstance(boundary, HalfSpace):
        names, asked = (boundary.point,), abs(boundary.offset)
    places = [robot.point(name).at for name in names]
    lengths = [*(joint.origin for joint in robot.joints), *places]
    length = sum(float(np.linalg.norm(vector)) for vector in lengths)
    length += sum(joint.farthest for joint in robot.joints if joint.turns)  # cranks
    length += sum(abs(value) for j, value in held.items() if not robot.joints[j].turns)
    length += sum(robot.point(name).radius for name in names) + asked
    free = robot.free(held)
    slides = frozenset(k for k, j in enumerate(free) if not robot.joints[j].turns)
    degree = 1 if robot.least_distance(boundary) is None else 2
    relative = Sizes(length, slides, len(robot.joints)).relative(degree)
    return coefficient_errors(degree, length, relative, slides)
