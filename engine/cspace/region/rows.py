"""Exact coefficients of a problem's forms: rationals where the file allows it, else balls.

A joint that is held at an angle is turned by the simplest rational rotation within the rounding of
the angle (`RationalTurn`). So quarter turns are exact, opposite angles stay opposite, and what
coincides in a drawing coincides here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

from cspace.arrays import Array
from cspace.boundary.contacts import ExactContacts
from cspace.boundary.functions import clearance
from cspace.model.exact import (
    ExactNumbers,
    RationalTurn,
    frozen,
    rational,
    rationals,
    written_numbers,
)
from cspace.model.robot import Robot
from cspace.region.problem import Problem
from cspace.tolerances import ROUNDING

BITS = 1280
"""Precision of what is no rational; what is left after a few hundred operations is 1,152 bits."""

Made = TypeVar("Made")


class ExactRows:
    """Coefficients of the forms of a problem, one row at a time, each made once.

    Forms of a robot come from the decimals of its file (`cspace.model.exact`). Other forms count as
    exact doubles. A row is the problem's row times a positive number.

    Parameters
    ----------
    problem : Problem

    Examples
    --------
    >>> from cspace import load_robot
    >>> from cspace.region import clearance_problem
    >>> rows = ExactRows(clearance_problem(load_robot("pp-portal")))
    >>> rows.form(0)[0, 0], rows.range(1)
    (-10, (0, 500.000000000000))
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._made: dict[tuple[str, int], Any] = {}

    def form(self, row: int) -> Array:
        """Return a row of the problem's forms, shape (3, 3), its first joint the first axis."""
        return self._once(self._form, row)

    def feature(self, row: int) -> tuple[Array, Array]:
        """Return form (3, 3) and side conditions (s, 3, 3) of a row of the problem's contacts."""
        return self._once(self._feature, row)

    def range(self, joint: int) -> tuple[Any, Any] | None:
        """Return the ends of a free joint's range as balls; None if it turns all the way round.

        A limit is that of the file. Any other end, such as that of a window, is an exact double.
        """
        return self._once(self._range, joint)

    def _once(self, make: Callable[[int], Made], row: int) -> Made:
        from flint import ctx

        key = make.__name__, row
        if key not in self._made:
            with ctx.workprec(BITS):
                self._made[key] = make(row)
        made: Made = self._made[key]
        return made

    def _form(self, row: int) -> Array:
        problem = self._problem
        boundary = problem.origins[row] if row < len(problem.origins) else None
        if boundary is None or problem.robot is None:
            return rationals(problem.forms.coefficients[row])
        return clearance(self._free_robot, self._numbers.boundary(boundary)).coefficients

    def _feature(self, row: int) -> tuple[Array, Array]:
        return self._contacts.feature(row)

    def _range(self, joint: int) -> tuple[Any, Any] | None:
        from flint import arb

        problem = self._problem
        ends = problem.ranges[joint]
        if ends is None:
            return None
        given = [arb(rational(end)) for end in ends]
        limits = None
        if problem.robot is not None:
            limits = self._numbers.joint(self._robot.joints[problem.joints[joint]]).limits
        if limits is None:
            return given[0], given[1]
        low, high = (
            x if abs(float(x) - float(own)) <= ROUNDING * abs(float(own)) else g
            for x, own, g in zip(limits, ends, given, strict=True)
        )
        return low, high

    @property
    def _robot(self) -> Robot:
        assert self._problem.robot is not None  # forms without a robot need none
        return self._problem.robot

    @cached_property
    def _numbers(self) -> ExactNumbers:
        return written_numbers(self._robot)

    @cached_property
    def _held(self) -> dict[int, Any]:
        """The values of the held joints: a rational turn of an angle, a rational slide."""
        held, joints = self._problem.held, self._robot.joints
        return {j: RationalTurn(v) if joints[j].turns else rational(v) for j, v in held.items()}

    @cached_property
    def _free_robot(self) -> Robot:
        """The robot with exact numbers, without the joints that are held."""
        robot = self._numbers.robot
        return frozen(robot, self._held) if self._held else robot

    @cached_property
    def _contacts(self) -> ExactContacts:
        problem = self._problem
        return ExactContacts(self._robot, self._held, problem.bodies, problem.contacts)
