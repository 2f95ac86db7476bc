"""How far a coefficient in floats may be from the exact one: by the lengths that were summed.

A form of degree d is a length to the power d. A slide's value is a length too: its coefficient has
one degree less for each power of it, so that millimetres and metres have the same bound, and there
is none beyond the degree of the form.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.model.robot import Boundary, HalfSpace, Pair, Robot
from qbound.tolerances import ROUNDING


@dataclass(frozen=True)
class Sizes:
    """The lengths that go into the coefficients of a form of two free joints.

    Attributes
    ----------
    length : float
        Sum of them all.
    slides : frozenset of int
        Which of the two free joints slide.
    joints : int
        How many joints they have come through, each with its own rounding.
    """

    length: float
    slides: frozenset[int]
    joints: int

    def further(self, length: float) -> Sizes:
        """Return the sizes with one more length."""
        return replace(self, length=self.length + length)

    def relative(self, degree: int) -> float:
        """Return the error of a coefficient beside its lengths to the power of the degree."""
        return ROUNDING * max(1, degree) * (1 + self.joints / 4)


def coefficient_errors(
    degree: ArrayLike, length: ArrayLike, relative: ArrayLike, slides: Collection[int]
) -> Floats:
    """Return bounds of the errors of the coefficients of forms, shape (..., 3, 3).

    Parameters
    ----------
    degree : array_like of int, shape (...)
        Power of a length that each form is: 0, 1 or 2.
    length : array_like, shape (...)
        Sum of the lengths that go into it.
    relative : array_like, shape (...)
        Error beside that length to the power of the degree.
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
