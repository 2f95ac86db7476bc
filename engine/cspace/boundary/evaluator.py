"""Boundary functions compiled once: the margins of one configuration, or of millions.

All forms, and the joint limits as two more rows a joint, are one table over the monomials that
occur in any of them. A configuration costs a sine and a cosine a joint, a product a monomial, and
its share of one matrix product. For many configurations, single precision decides first which are
feasible (`screen`); double precision decides the rest. Boundaries about bodies have no such row:
their columns come from `separation`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Bools, Floats, Indices
from cspace.boundary.functions import clearance, term_size
from cspace.boundary.poses import bounds_bodies
from cspace.boundary.screen import LEAST, SINES, Screen, reaches, screen
from cspace.boundary.separation import BodyMargins
from cspace.forms.factors import VALUE, Monomials, occurring, padded
from cspace.model.robot import Boundary, Robot, real_numbers, refuse_no_robot
from cspace.tolerances import ROUNDING
from qbound.forms import HarmonicForm

Range = tuple[float, float] | None

BLOCK = 8192
"""Configurations a block at most: their monomials stay in the cache between the two passes."""

PRODUCTS = 2**17
"""Products of a block's matrix product, if it can be: a larger one is cut by the library over all
cores, at a cost above its own."""

COUNT_SCREENED = 256
"""Fewer configurations than these are as quick without the screen."""

NO_COLUMNS = np.empty(0, dtype=np.intp)


class Columns(Protocol):
    """Margins that are not forms, such as those of bodies: see `BodyMargins`."""

    names: tuple[str, ...]
    rounding: Floats

    def margins(self, q: ArrayLike) -> Floats:
        """Return all margins, shape (..., columns); length."""

    def separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell which margins are above `at_least`, shape (..., columns)."""

    def all_separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell where every margin is above `at_least`, shape (...)."""


@dataclass(frozen=True, eq=False)
class Evaluator:
    r"""Margins of named boundaries: lengths, then those of the joint limits in joint units.

    A margin is :math:`|B| - d_{\min}` of a pair (eq. 11), computed as
    :math:`\beta / (|B| + d_{\min})` from its form. Where a form is a length already (eq. 12), its
    value is the margin; for a joint limit (eq. 10) the distance to the limit is. The margin of two
    bodies is their signed distance less the clearance. A margin that is negative by rounding alone
    is returned as 0, so that ``margin >= 0`` means feasible.

    Attributes
    ----------
    names : tuple of str
        One a column.
    table : ndarray, shape (rows, monomials)
        One row for each column that is not about bodies.
    monomials : Monomials
    reach : ndarray, shape (joints,)
        Largest absolute joint values for which single precision is tried first.
    distance : ndarray, shape (rows,)
        :math:`d_{\min}` of the pairs; NaN where the value is the margin itself.
    rounding : ndarray, shape (rows,)
        A value that is no farther below zero than this is rounding.
    bodies : BodyMargins or SphereMargins, optional
        Margins of the columns that are no rows: about bodies, or of a sphere model.
    columns : pair of ndarray of int
        Which columns are rows of the table, and which are those of `bodies`.
    """

    names: tuple[str, ...]
    table: Floats
    monomials: Monomials
    reach: Floats
    distance: Floats
    rounding: Floats
    bodies: Columns | None = None
    columns: tuple[Indices, Indices] = field(default=(NO_COLUMNS, NO_COLUMNS))

    def margins(self, q: ArrayLike) -> Floats:
        """Return the margin of every boundary, shape (..., joints) to (..., columns).

        Raises
        ------
        ValueError
            If the last axis has not one value a joint, or one is NaN, infinite or complex.

        Examples
        --------
        >>> import numpy as np
        >>> from cspace import load_robot
        >>> compiled = evaluator(load_robot("pp-portal"))
        >>> margins = compiled.margins([0.0, 490.0])
        >>> compiled.names[0], round(float(margins[0]), 3)
        ('table', 480.0)
        >>> compiled.names[-2:], margins[-2:].tolist()
        (('column.lower', 'column.upper'), [490.0, 10.0])

        Any shape of configurations will do, but each has one value for each joint:

        >>> compiled.margins(np.zeros((4, 3, 2))).shape
        (4, 3, 11)
        >>> compiled.margins([600.0])
        Traceback (most recent call last):
        ValueError: expected 2 joint values on the last axis, found 1
        """
        q = self._checked(q)
        if self.bodies is None:
            return self._of_forms(q)
        return self._columns(self._of_forms(q), self.bodies.margins(q))

    def alone(self, column: int) -> Evaluator:
        """Return the evaluator of one column; of all if it is about bodies."""
        rows = range(len(self.names)) if self.bodies is None else self.columns[0].tolist()
        if column not in rows:
            return self
        k = [rows.index(column)]
        return Evaluator(
            (self.names[column],),
            self.table[k],
            self.monomials,
            self.reach,
            self.distance[k],
            self.rounding[k],
        )

    def at_least(self, q: ArrayLike, least: Floats) -> Bools:
        """Tell which margins are no less than given ones, (..., joints) to (..., columns).

        Discs show for most bodies that they are apart, so this takes much less time than margins.

        Parameters
        ----------
        least : ndarray, shape (columns,)

        Raises
        ------
        ValueError
            As `margins`.
        """
        q = self._checked(q)
        rows, bodies = self.columns
        if self.bodies is None:
            return np.asarray(self._of_forms(q) >= least)
        below = np.nextafter(least[bodies], -np.inf)
        result = np.empty((*q.shape[:-1], len(self.names)), dtype=np.bool_)
        result[..., rows] = self._of_forms(q) >= least[rows]
        result[..., bodies] = self.bodies.separated(q, below)
        return result

    def feasible(self, q: ArrayLike) -> Bools:
        """Tell where no margin is negative, shape (..., joints) to (...); errors as `margins`."""
        q = real_numbers(q)
        if q.ndim == 1 and self.bodies is None:
            return self._one_feasible(self.shaped(q))
        flat = self.shaped(q).reshape(-1, self.joints)
        return self.completed(flat, *self._screened(flat)).reshape(q.shape[:-1])

    def completed(self, q: Floats, result: Bools, near: Indices) -> Bools:
        """Complete the answers of a screen: decide open configurations, then check bodies if any.

        Parameters
        ----------
        q : ndarray, shape (n, joints)
        result : ndarray of bool, shape (n,)
            Whether each configuration is feasible; changed in place.
        near : ndarray of int
            Which configurations the screen did not decide.

        Raises
        ------
        ValueError
            If an undecided configuration has a value that is NaN or infinite.
        """
        if len(near):
            result[near] = self.settled(q[near])
        if self.bodies is not None:
            result[result] = self.bodies.all_separated(q[result], -self.bodies.rounding)
        return result

    def settled(self, q: Floats) -> Bools:
        """Tell where no row of the table is negative, in double precision, (n, joints) to (n,).

        Every other way to answer `feasible` is quicker and leaves undecided configurations to this
        function. All matrix products have one shape, so a sign does not depend on how many
        configurations are asked at once.

        Raises
        ------
        ValueError
            If a joint value is NaN or infinite.
        """
        self._checked(q)
        result = np.empty(len(q), dtype=np.bool_)
        for start in range(0, len(q), BLOCK):
            here = q[start : start + BLOCK]
            rows = self.monomials.of_columns(padded(here, self._width))
            parts = rows.reshape(len(rows), -1, self._width).transpose(1, 0, 2)
            safe = (self._lifted @ parts >= 0).all(axis=1).reshape(-1)
            result[start : start + BLOCK] = safe[: len(here)]
        return result

    def _screened(self, q: Floats) -> tuple[Bools, Indices]:
        """Return which are feasible by single precision, and the indices of undecided ones."""
        screen = self._screen
        if screen is None or len(q) < COUNT_SCREENED:
            return np.empty(len(q), dtype=np.bool_), np.arange(len(q))
        result, undecided = np.empty(len(q), dtype=np.bool_), []
        for start in range(0, len(q), screen.block):
            here = slice(start, start + screen.block)
            result[here], near = screen.judge(q[here])
            undecided.append(start + np.flatnonzero(near))
        return result, np.concatenate(undecided)

    def _one_feasible(self, q: Floats) -> Bools:
        values = q.tolist()
        if all(-r <= x <= r for x, r in zip(values, self._reach, strict=True)):
            least = min(self._certain.dot(self.monomials.of_one(values)).tolist(), default=2.0)
            if abs(least) > 1:
                return np.array(least > 0)
        return self.settled(q[None]).reshape(())

    def _of_forms(self, q: Floats) -> Floats:
        """Return the margins that are not about bodies, shape (..., rows)."""
        if q.ndim == 1:
            return self._lengths(self.table.dot(self.monomials.of_one(q.tolist())))
        flat = q.reshape(-1, self.joints)
        result = np.empty((len(flat), len(self.table)))
        for start in range(0, len(flat), self._block):
            columns = np.ascontiguousarray(flat[start : start + self._block].T)
            values = self.table @ self.monomials.of_columns(columns)
            result[start : start + self._block] = self._lengths(values.T)
        return result.reshape(*q.shape[:-1], len(self.table))

    def _columns(self, rows: Floats, bodies: Floats) -> Floats:
        """Put the values of rows, (..., rows), and of bodies, (..., bodies), into their columns."""
        result = np.empty((*rows.shape[:-1], len(self.names)))
        result[..., self.columns[0]] = rows
        result[..., self.columns[1]] = bodies
        return result

    @property
    def joints(self) -> int:
        """How many values a configuration has."""
        return self.monomials.joints

    def shaped(self, q: Floats) -> Floats:
        """Return configurations, unless the last axis has not one value a joint (ValueError)."""
        if q.shape[-1:] != (self.joints,):
            found = q.shape[-1] if q.ndim else "a bare number"
            raise ValueError(f"expected {self.joints} joint values on the last axis, found {found}")
        return q

    def _checked(self, q: ArrayLike) -> Floats:
        q = self.shaped(real_numbers(q))
        finite = all(map(math.isfinite, q.tolist())) if q.ndim == 1 else np.isfinite(q).all()
        if not finite:
            raise ValueError("a joint value is NaN or infinite")
        return q

    @cached_property
    def margin_rounding(self) -> Floats:
        """Largest margin that can be rounding of a true margin 0, shape (columns,)."""
        of_forms = self._lengths(self.rounding.copy())
        return of_forms if self.bodies is None else self._columns(of_forms, self.bodies.rounding)

    @cached_property
    def sizes(self) -> Floats:
        """Bound of the lengths or angles whose difference each margin is, shape (columns,)."""
        sizes = self.rounding / ROUNDING  # of a pair's form, whose value is a length squared
        sizes = np.where(np.isnan(self.distance), sizes, np.sqrt(sizes))
        return (
            sizes if self.bodies is None else self._columns(sizes, self.bodies.rounding / ROUNDING)
        )

    @cached_property
    def _lifted(self) -> Floats:
        """The table with the rounding added to each constant: feasible is >= 0."""
        table = self.table.copy()
        table[:, 0] += self.rounding
        return table

    @cached_property
    def _denominator(self) -> Denominator:
        return denominators(self.distance)

    def _lengths(self, values: Floats) -> Floats:
        return lengths(values, self.rounding, self._denominator)

    @cached_property
    def _screen(self) -> Screen | None:
        return self.screen()

    def screen(self, sines: float = SINES) -> Screen | None:
        """Return the table in single precision; None where lengths are beyond it.

        Parameters
        ----------
        sines : float
            Error of the sines and cosines that will be taken (`cspace.boundary.screen.UNIT`).
        """
        return screen(self._lifted, self.monomials, self.reach, sines)

    @cached_property
    def _certain(self) -> Floats:
        """The lifted table in units of its rounding, which changes no sign beyond 1 or -1."""
        sizes = self.monomials.sizes(self._reach)
        rows = self._lifted[(self._lifted != 0).any(axis=1)]  # a row of zeros holds everywhere
        bounds = np.maximum(len(sizes) * ROUNDING * (np.abs(rows) @ sizes), LEAST)
        return np.asarray(rows / bounds[:, None])

    @cached_property
    def _reach(self) -> list[float]:
        return [float(reach) for reach in self.reach]

    @cached_property
    def _width(self) -> int:
        """Configurations in one matrix product, if its rounding must always be the same."""
        most = PRODUCTS // max(1, self.table.size)
        return 1 << min(9, max(3, most.bit_length() - 1))

    @cached_property
    def _block(self) -> int:
        """Configurations in one block, if the rounding need not always be the same."""
        return max(256, min(BLOCK, PRODUCTS // max(1, self.table.size)))


def compiled(
    forms: HarmonicForm,
    names: Sequence[str],
    distances: Sequence[float | None],
    ranges: Sequence[Range],
    limits: Sequence[tuple[str, str]],
    spans: Sequence[Range] | None = None,
    terms: Sequence[float] = (),
) -> Evaluator:
    r"""Compile forms and the limits of their joints.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
    names : sequence of str
        One a form.
    distances : sequence of (float or None)
        :math:`d_{\min}` of each pair; None for a form that is a length.
    ranges : sequence of (low, high) or None
        One a joint.
    limits : sequence of (str, str)
        Names of both ends of each range.
    spans : sequence of (low, high) or None, optional
        Range in which most values of each joint will lie; default: the ranges.
    terms : sequence of float, optional
        Size of the terms of each of the first forms (`term_size`), if its coefficients do not show
        it: terms that cancel leave their rounding.
    """
    bounded = [(j, *ends) for j, ends in enumerate(ranges) if ends is not None]
    monomials, place = occurring(forms.coefficients, forms.kinds, [j for j, *_ in bounded])
    table = np.zeros((len(names) + 2 * len(bounded), len(monomials)))
    n = len(forms.kinds)
    indices = np.ravel_multi_index(tuple(zip(*place, strict=True)), (3,) * n)
    coefficients = forms.coefficients.reshape(len(names), 3**n)
    table[: len(names), list(place.values())] = coefficients[:, indices]
    for k, (j, low, high) in enumerate(bounded):
        q, at = 1 + monomials.factors.index((j, VALUE)), len(names) + 2 * k
        table[at : at + 2, [0, q]] = [[-low, 1], [high, -1]]
    sizes = np.zeros(len(table))
    sizes[: len(terms)] = terms
    reach = [1.0 if ends is None else max(map(abs, ends)) for ends in ranges]
    return Evaluator(
        names=(*names, *(name for j, *_ in bounded for name in limits[j])),
        table=table,
        monomials=monomials,
        reach=reaches(forms.kinds, spans or ranges),
        distance=np.array([*distances, *[None] * 2 * len(bounded)], dtype=float),
        rounding=ROUNDING * np.maximum(np.abs(table) @ monomials.sizes(reach), sizes),
    )


def with_bodies(forms: Evaluator, bodies: Columns, order: Sequence[str]) -> Evaluator:
    """Return an evaluator with columns that are no rows of its table, such as those about bodies.

    Parameters
    ----------
    forms : Evaluator
        The evaluator of all other boundaries.
    bodies : BodyMargins or SphereMargins
        For the same number of free joints; without columns it changes nothing.
    order : sequence of str
        Names of the first columns, of both kinds; the other columns of `forms`, such as limits,
        follow.
    """
    if not bodies.names:
        return forms
    names = (*order, *(name for name in forms.names if name not in order))
    place = {name: column for column, name in enumerate(names)}
    rows, about = (
        np.array([place[n] for n in each], np.intp) for each in (forms.names, bodies.names)
    )
    return replace(forms, names=names, bodies=bodies, columns=(rows, about))


@lru_cache(maxsize=64)
def evaluator(robot: Robot, *, limits: bool = True) -> Evaluator:
    """Return the evaluator of a robot: every boundary in use, and the limits of all joints.

    Examples
    --------
    >>> from cspace import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> evaluator(robot).names
    ('B1', 'B2', 'B3', 'B4', 'B7')

    It is compiled once a robot: the next call returns the same one.

    >>> evaluator(robot) is evaluator(robot)
    True
    """
    formed = [boundary for boundary in robot.used if not bounds_bodies(boundary)]
    forms = compiled(
        forms_in_use(robot),
        [boundary.name for boundary in formed],
        [robot.least_distance(boundary) for boundary in formed],
        [joint.limits if limits else None for joint in robot.joints],
        [limit_names(joint.name) for joint in robot.joints],
        [joint.limits for joint in robot.joints],
        [term_size(robot, boundary) for boundary in formed],
    )
    if len(formed) == len(robot.used):
        return forms
    return with_bodies(forms, BodyMargins(robot), [boundary.name for boundary in robot.used])


@lru_cache(maxsize=4)
def forms_in_use(robot: Robot) -> HarmonicForm:
    """Derive the forms of all boundaries in use; all slices of one robot share these forms."""
    return stacked(robot, [boundary for boundary in robot.used if not bounds_bodies(boundary)])


def forms_bytes(robot: Robot) -> int:
    """Estimate the memory of the forms of all boundaries in use, while they are compiled.

    Each has :math:`3^n` coefficients, eight bytes each; the table of them is as large again.

    Examples
    --------
    >>> from cspace import load_robot
    >>> forms_bytes(load_robot("ur5"))  # 193 pairs, six joints
    2251152
    """
    return 16 * len(robot.used) * int(3 ** len(robot.joints))


def stacked(robot: Robot, boundaries: Sequence[Boundary]) -> HarmonicForm:
    """Return the clearance forms of boundaries as one stack, shape (m,)."""
    forms = np.array([clearance(robot, boundary).coefficients for boundary in boundaries])
    return HarmonicForm(forms.reshape(-1, *(3,) * len(robot.joints)), robot.kinds)


def limit_names(joint: str) -> tuple[str, str]:
    """Return the names of a joint's lower and upper limit, as boundaries."""
    return f"{joint}.lower", f"{joint}.upper"


# --- from the value of a form to a margin ---------------------------------------------------------


Denominator = tuple[Floats, Floats, Floats]

NO_DISTANCE = 2.0**-1000
"""Stands for the distance 0 in a denominator: 0 / 0 would be NaN where two points meet."""


def denominators(distance: Floats) -> Denominator:
    r"""Return (a, b, d) of ``sqrt(a value + b) + d``: :math:`|B| + d_{\min}`, or 1 without one.

    Parameters
    ----------
    distance : ndarray
        :math:`d_{\min}` of the pairs; NaN where the value is a length.
    """
    pair = ~np.isnan(distance)
    d = np.where(pair, np.maximum(distance, NO_DISTANCE), 0.0)
    return pair.astype(float), np.where(pair, d * d, 1.0), d


def lengths(values: Floats, rounding: Floats, denominator: Denominator) -> Floats:
    """Return the margins for values of forms, shape (..., m); 0 where negative by rounding alone.

    The values may be changed.
    """
    if values.size and values.min() < 0:
        values[(values < 0) & (values >= -rounding)] = 0
    a, b, d = denominator
    return np.asarray(values / (np.sqrt(np.maximum(a * values + b, 0)) + d))


# --- of any robot ---------------------------------------------------------------------------------


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
        For one configuration, names with margins; for many, an array whose last axis has the
        boundaries in the same order.

    Raises
    ------
    ValueError
        If a joint value is NaN, infinite or complex, or there is not one for each joint.

    Examples
    --------
    >>> from cspace import load_robot, margins
    >>> robot = load_robot("two-joint-arm-with-walls")
    >>> name, margin = min(margins(robot, [0.0, 0.0]), key=lambda item: item[1])
    >>> name, round(margin, 3)
    ('forearm, lamp', 0.131)

    A joint limit is a boundary too, for each joint. A joint exactly at its limit has the margin 0
    and is feasible:

    >>> dict(margins(load_robot("pp-portal"), [0.0, 100.0]))["beam.lower"]
    0.0

    Many configurations are one call:

    >>> margins(robot, [[0.0, 0.0], [0.1, 0.2], [3.0, 0.0]]).min(axis=-1).round(3).tolist()
    [0.131, 0.04, -0.422]
    """
    from cspace.boundary.balls import judge  # which is made of what this module has

    refuse_no_robot("margins", robot)
    table = judge(robot)
    found = table.margins(q)
    return found if found.ndim > 1 else list(zip(table.names, found.tolist(), strict=True))


def violated(robot: Robot, q: Sequence[float] | NDArray[np.float64]) -> list[tuple[str, float]]:
    """Return the negative `margins` of one configuration; an empty list means feasible.

    Examples
    --------
    >>> from cspace import load_robot, violated
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

    What no boundary of the file keeps apart may overlap: `Robot.feasible_by` says what the
    boundaries are about, `Robot.unchecked` has the pairs of links that were not looked at.

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
    >>> from cspace import is_feasible, load_robot
    >>> robot, q = load_robot("ur5"), [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]
    >>> bool(is_feasible(robot, q))
    True

    Nothing touches where the first joint is past its limit of a full turn, and it is infeasible:

    >>> is_feasible(robot, [q, [7.0, *q[1:]]]).tolist()
    [True, False]
    """
    from cspace.boundary.balls import judge

    refuse_no_robot("is_feasible", robot)
    return judge(robot).feasible(q)
