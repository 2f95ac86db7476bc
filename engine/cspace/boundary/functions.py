"""Boundary functions of points with radii, and bounds of their errors (eqs. 9, 11, 12).

Forms come from the library (`qbound.boundary`): Theorem 1 is derived there. Here radii of balls go
into the distance that a pair keeps and into the height over a wall.

The error bound of a coefficient in floats follows from the lengths that were summed.

A form of degree d is a length to the power d. A slide's value is a length too: its coefficient has
one degree less for each power of it, so that millimetres and metres have the same bound, and there
is none beyond the degree of the form.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import reduce

import numpy as np
from numpy.typing import ArrayLike

import qbound
from cspace.arguments import refuse_type
from cspace.arrays import Array, Floats
from cspace.forms.factors import FACTORS
from cspace.model.robot import Boundary, HalfSpace, Pair, Robot, refuse_no_robot
from cspace.printable import printable
from cspace.tolerances import ROUNDING, ZERO_AMPLITUDE
from qbound.forms import HarmonicForm


def clearance(robot: Robot, boundary: Boundary | str) -> HarmonicForm:
    r"""Return the form that is positive exactly where the boundary is respected (eqs. 9, 11, 12).

    Parameters
    ----------
    robot : Robot
    boundary : Boundary or str
        One of its boundaries, or the name of one.

    Returns
    -------
    HarmonicForm, stack ()
        A pair: :math:`|B|^2 - d_{\min}^2` in length squared, where :math:`d_{\min}` is the two
        radii plus the clearance.
        A half-space: ``normal . r - offset - radius`` in length.

    Raises
    ------
    ValueError
        If the boundary is about bodies.

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
    asked = robot.boundary(boundary) if isinstance(boundary, str) else boundary
    if isinstance(asked, Pair):
        near, far = _near_far(robot, asked)
        apart = replace(asked, points=(near, far), clearance=robot.required_distance(asked))
        return qbound.clearance(robot, apart)
    if isinstance(asked, HalfSpace) and asked.body is None:
        return qbound.clearance(robot, asked) - robot.point(asked.point).radius
    if not isinstance(asked, Boundary):
        refuse_type("boundary", asked, "a boundary of the robot, or its name")
    raise ValueError(_of_bodies(asked))


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
        near, far = map(robot.point, _near_far(robot, boundary))
        observer, rest = near.frame, float(np.linalg.norm(near.at))
    elif isinstance(boundary, HalfSpace) and boundary.body is None:
        far, observer = robot.point(boundary.point), robot.base
        rest = abs(boundary.offset) + far.radius
    else:
        raise ValueError(_of_bodies(boundary))
    steps = robot.steps[robot.steps_to(observer) : robot.steps_to(far.frame)]
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


def _of_bodies(boundary: Boundary) -> str:
    said = f"{printable(boundary.name)} is about whole bodies: it has no single boundary function"
    return f"{said}; margins(robot, q) has its signed distance"


def _near_far(robot: Robot, pair: Pair) -> tuple[str, str]:
    """Return the names of a pair's points, the one nearer to the base first."""
    first, second = pair.points
    depths = [robot.steps_to(robot.point(name).frame) for name in pair.points]
    return (first, second) if depths[0] <= depths[1] else (second, first)


def _outer(left: Array, right: Array) -> Array:
    return np.multiply.outer(left, right)


# --- errors of coefficients -----------------------------------------------------------------------


def coefficient_errors(
    degree: ArrayLike,
    length: ArrayLike,
    joints: int,
    slides: Collection[int],
    doubt: ArrayLike = 0.0,
) -> Floats:
    """Return bounds of the errors of the coefficients of forms, shape (..., 3, 3).

    Parameters
    ----------
    degree : array_like of int, shape (...)
        Degree of each form as a power of a length: 0, 1 or 2.
    length : array_like, shape (...)
        Sum of the lengths that go into each form.
    joints : int
        Number of joints on the way; each adds rounding of its own.
    slides : collection of int
        Which of the two free joints slide.
    doubt : array_like, shape (...)
        Error of what else goes into each form, such as directions; relative.
    """
    degree = np.asarray(degree)
    relative = doubt + ROUNDING * np.maximum(1, degree) * (1 + joints / 4)
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
    return coefficient_errors(degree, length, len(robot.joints), slides)
