"""The coefficients of a problem's forms as exact numbers, made where floats do not decide."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from qbound.arrays import Array
from qbound.boundary.contacts import Contacts
from qbound.boundary.exact_contacts import ExactContacts, Feature
from qbound.boundary.functions import clearance, pair_vector
from qbound.model.exact import ExactNumbers, frozen, rational, rationals, written_numbers
from qbound.model.robot import Robot
from qbound.printable import printable
from qbound.region.problem import Problem
from qbound.tolerances import ROUNDING, TOUCH

if TYPE_CHECKING:
    import flint

    from qbound.region.paper_rule import Window

    arb = flint.arb

Made = TypeVar("Made")

BITS = 1280
"""Precision of what is no rational; what is left after a few hundred operations is 1,152 bits."""


class ExactRows:
    """Coefficients of the forms of a problem as rationals (fmpq) or balls (arb), one row at a time.

    Nothing is made before it is asked for, and nothing twice. Forms of a robot come from the
    decimals of its file (`qbound.model.exact`); those that stand for themselves, and the values of
    held joints, are the doubles that they are. A row is that of the problem times a positive
    number.

    Parameters
    ----------
    problem : Problem

    Examples
    --------
    >>> from qbound import load_robot
    >>> from qbound.region import clearance_problem
    >>> rows = ExactRows(clearance_problem(load_robot("pp-portal")))
    >>> rows.form(0)[0, 0], rows.range(1)
    (-10, (0, 500.000000000000))
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._made: dict[tuple[str, int], Any] = {}

    def form(self, row: int) -> Array:
        """Return a row of the problem's forms, shape (3, 3), its first joint the first axis."""
        return self._once("form", row, self._form)

    def feature(self, k: int) -> Feature:
        """Return form (3, 3) and side conditions (s, 3, 3) of a row of the problem's contacts.

        There are at most four side conditions, in the order of the contacts' own; the constants
        that stand there for missing ones are left out.
        """
        return self._once("feature", k, self._contacts.feature)

    def range(self, joint: int) -> tuple[arb, arb] | None:
        """Return the ends of the range of free joint 0 or 1; None if it turns all the way round.

        Limits are those of the file. An end of a window of the paper's rule is a root in closed
        form (eq. 39); where balls do not tell that there is one, it is the problem's double.
        """
        return self._once("range", joint, self._range)

    def _once(self, kind: str, row: int, make: Callable[[int], Made]) -> Made:
        if (kind, row) not in self._made:
            with _precision():
                self._made[kind, row] = make(row)
        made: Made = self._made[kind, row]
        return made

    def _form(self, row: int) -> Array:
        problem = self._problem
        boundary = problem.origins[row] if row < len(problem.origins) else None
        if boundary is None or problem.robot is None:
            return rationals(problem.forms.coefficients[row])
        return clearance(self._free_robot, self._numbers.boundary(boundary)).coefficients

    @cached_property
    def _numbers(self) -> ExactNumbers:
        return written_numbers(self._robot)

    @property
    def _robot(self) -> Robot:
        assert self._problem.robot is not None  # forms of their own need none
        return self._problem.robot

    @cached_property
    def _free_robot(self) -> Robot:
        """The robot with exact numbers, without the joints that are held."""
        from flint import arb

        held = {j: arb(value) for j, value in self._problem.held.items()}
        robot = self._numbers.robot
        return frozen(robot, held) if held else robot

    @cached_property
    def _contacts(self) -> ExactContacts:
        problem = self._problem
        return ExactContacts(self._robot, problem.held, problem.bodies, problem.contacts)

    def _range(self, joint: int) -> tuple[arb, arb] | None:
        from flint import arb

        problem = self._problem
        ends = problem.ranges[joint]
        if ends is None:
            return None
        low, high = (arb(rational(end)) for end in ends)
        exact = None if problem.robot is None else self._written_range(problem.joints[joint])
        if exact is None:
            return low, high
        paper = problem.rule == "paper"  # a root that is nearly double is known to half its digits
        one, other = (
            x if abs(float(x) - own) <= (TOUCH if paper else ROUNDING * abs(own)) else arb(own)
            for x, own in zip(exact, map(float, ends), strict=True)
        )
        return one, other

    def _written_range(self, joint: int) -> tuple[arb, arb] | None:
        """Return the ends that the problem's rule has for a joint of the robot."""
        limits: Any = self._numbers.joint(self._robot.joints[joint]).limits
        if self._problem.rule == "paper":
            try:
                return window_ends(self._robot, self._free_robot, joint, limits)
            except ValueError:
                return None
        return limits  # type: ignore[no-any-return]  # balls, of exact numbers


@lru_cache(maxsize=2)
def shared_rows(problem: Problem) -> tuple[ExactRows, Contacts]:
    """Return a problem's exact rows, made once for both bases, and its contacts by their curves.

    Obstacles that stand in line have features of other names with the same form. Doubles propose
    these; they are of one curve where their rationals are the same up to a positive factor. Then
    nothing that they have in common need be told apart.
    """
    from flint import fmpq

    rows, contacts = ExactRows(problem), problem.contacts
    curves, first = np.unique(contacts.curves, return_index=True)
    if not len(first):
        return rows, contacts
    tables = contacts.forms[first].reshape(-1, 9)
    place = np.abs(tables).argmax(axis=1)
    largest = np.abs(np.take_along_axis(tables, place[:, None], axis=1))
    near = np.round(tables / np.where(largest > 0, largest, 1.0) * 2.0**30) + 0.0
    _, alike, count = np.unique(near, axis=0, return_inverse=True, return_counts=True)
    number, known = np.arange(len(first)), dict[Any, int]()
    for k in np.flatnonzero(count[alike] > 1).tolist():
        exact = rows.feature(int(first[k]))[0].reshape(-1)
        if all(isinstance(x, fmpq | int) for x in exact) and exact[place[k]] != 0:
            form = tuple(fmpq(x) / abs(exact[place[k]]) for x in exact)
            number[k] = known.setdefault((int(alike[k]), form), k)
    merged = curves[number][np.searchsorted(curves, contacts.curves)]
    return rows, replace(contacts, curves=merged)


def window_ends(robot: Robot, exact: Robot, joint: int, limits: Any) -> tuple[arb, arb]:
    """Return the highest lower end and the lowest upper end of a joint's windows and limits.

    Of ends that are not certainly apart the first one stands for both.

    Parameters
    ----------
    robot : Robot
        With floats: it tells which windows there are and which turn each takes.
    exact : Robot
        The same robot with exact numbers.
    limits : pair of balls, optional
        Of the joint.
    """
    from flint import arb

    from qbound.region import paper_rule  # few ask for it

    own = [window for window in paper_rule.windows(robot) if window.joint == joint]
    upper = [window_end(exact, window) for window in own]
    lower = [end - 2 * arb.pi() for end in upper]
    if limits is not None:
        lower, upper = [*lower, limits[0]], [*upper, limits[1]]
    low, high = lower[0], upper[0]
    for one, other in zip(lower, upper, strict=True):
        low, high = (one if one > low else low), (other if other < high else high)
    return low, high


def window_end(exact: Robot, window: Window) -> arb:
    r"""Return the upper end of a window as a ball: the root :math:`\theta + \alpha` (eq. 39).

    Raises
    ------
    ValueError
        If it is not certain that the component reaches zero.
    """
    from flint import arb

    pair: Any = exact.boundary(window.boundary)
    component = pair_vector(exact, pair)[window.component - 1]
    c, a, b = component.along(window.joint, [arb(0)] * len(exact.joints))
    square = arb(a * a + b * b - c * c)
    if not square >= 0:
        text = "it is not proved that this component reaches zero"
        raise ValueError(f"{printable(window.boundary)}: {text}")
    half = square.sqrt()
    found: arb = arb.atan2(a * half - b * c, -a * c - b * half)
    turns = round((window.upper - float(found)) / (2 * np.pi))
    end: arb = found + 2 * turns * arb.pi()
    return end


def _precision() -> AbstractContextManager[None]:
    from flint import ctx

    context: AbstractContextManager[None] = ctx.workprec(BITS)
    return context
