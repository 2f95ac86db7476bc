r"""Margins of a sphere model of many joints, by kinematics in place of forms.

A form over n joints is a table of :math:`3^n` numbers, and an arm of six joints has hundreds of
pairs. This module makes no forms. It carries the centres of all spheres along the chain, once for
each configuration, and takes the distance of the two centres of each pair. Along one joint the form
of a pair follows from the places of both spheres about the axis of the joint.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats, Indices
from cspace.boundary.chain import Chain, Pose
from cspace.boundary.evaluator import (
    Evaluator,
    compiled,
    denominators,
    evaluator,
    forms_bytes,
    lengths,
    limit_names,
    stacked,
    with_bodies,
)
from cspace.boundary.poses import bounds_bodies
from cspace.model.robot import Boundary, HalfSpace, Pair, Robot, refuse_no_robot
from cspace.printable import printable
from cspace.tolerances import ROUNDING

BLOCK = 256
"""Configurations a block: the distances of hundreds of pairs stay in the cache."""

DEAR = 2_000_000
"""Coefficients of the forms of all boundaries, :math:`3^n` each, from which on distances along the
chain are sooner known: 12 times as soon for an arm of seven joints and 5,472 pairs, which has six
times as many. With an eighth of `DEAR` forms take half the time of distances; measured."""

ALL = slice(None)


class Balls:
    r"""The points of a robot with their radii, and the pairs and walls that bound them.

    It answers as `cspace.boundary.evaluator` does, by distances in place of forms: margins of eqs.
    (11) and (12), the forms' coefficients along one joint (Theorem 2). A margin that is negative by
    rounding alone is returned as zero.

    Attributes
    ----------
    robot : Robot
    names : tuple of str
        The boundaries in use, in their order; limits have no column.
    chain : Chain
        Of the points, those nearer to the base first.
    pairs, walls : ndarray of int
        Which boundaries are pairs, and which are half-spaces.
    near, far : ndarray of int, shape (pairs,)
        The points of each pair, by their index in `chain.points`, the one nearer to the base first.
    distance : ndarray, shape (pairs,)
        :math:`d_{\min}` of each pair.
    held : ndarray of int, shape (walls,)
        The point that each half-space holds.
    normals, levels : ndarray, shape (walls, 3) and (walls,)
        Of each half-space: a place is feasible where ``normal . place >= level``.
    rounding : ndarray, shape (boundaries,)
        A form, or a height over a wall, that is no farther below zero than this is rounding.

    Examples
    --------
    >>> from cspace import load_robot
    >>> balls = Balls.of(load_robot("minervabot-v2"))
    >>> balls.names
    ('B1', 'B2', 'B3', 'B4', 'B7')
    >>> balls.margins([0.2, -0.5]).round(2).tolist()
    [13.3, 23.91, 12.4, 19.26, 41.05]
    >>> balls.feasible([[0.2, -0.5], [1.5, 0.0]]).tolist()
    [True, False]
    """

    def __init__(self, robot: Robot) -> None:
        refuse_no_robot("Balls", robot)
        self.robot, used = robot, robot.used
        for boundary in used:
            _refuse_bodies(boundary)
        self.names = tuple(boundary.name for boundary in used)
        self.chain = Chain(robot, robot.points)
        self._index = {point.name: i for i, point in enumerate(self.chain.points)}
        pairs = [(k, b) for k, b in enumerate(used) if isinstance(b, Pair)]
        walls = [(k, b) for k, b in enumerate(used) if isinstance(b, HalfSpace)]
        self.pairs, self.walls = _indices(k for k, _ in pairs), _indices(k for k, _ in walls)
        places = [sorted(self._index[name] for name in b.points) for _, b in pairs]
        self.near, self.far = _indices(i for i, _ in places), _indices(j for _, j in places)
        self.distance = np.array([robot.required_distance(b) for _, b in pairs], dtype=float)
        self.held = _indices(self._index[b.point] for _, b in walls)
        radii = np.array([point.radius for point in self.chain.points], dtype=float)
        self.normals = np.array([b.normal for _, b in walls], dtype=float).reshape(-1, 3)
        self.levels = np.array([b.offset for _, b in walls], dtype=float) + radii[self.held]
        self.rounding = self._rounding()
        all_distances = np.full(len(used), np.nan)
        all_distances[self.pairs] = self.distance
        self._denominator = denominators(all_distances)

    @staticmethod
    def of(robot: Robot) -> Balls:
        """Return the sphere model of a robot, made once: the next call returns the same one.

        Raises
        ------
        ValueError
            If a boundary is about bodies.
        """
        return _made(robot)

    def centres(self, q: ArrayLike) -> Floats:
        """Return the places of all points, shape (..., joints) to (..., points, 3); length.

        In the order of the robot's points, seen from the base.
        """
        q = self.robot.configuration(q)
        order = [self._index[point.name] for point in self.robot.points]
        result = np.empty((*q.shape[:-1], len(order), 3))
        flat = result.reshape(-1, len(order), 3)
        for here, columns in blocks(q):
            flat[here] = self._places(columns)[:, order].transpose(2, 1, 0)
        return result

    def margins(self, q: ArrayLike) -> Floats:
        """Return the margin of every boundary, shape (..., joints) to (..., boundaries); length.

        Raises
        ------
        ValueError
            If the last axis has not one value a joint, or one is NaN or infinite.
        """
        q = self.robot.configuration(q)
        result = np.empty((*q.shape[:-1], len(self.names)))
        flat = result.reshape(q[..., 0].size, len(self.names))
        for here, columns in blocks(q):
            values = self._values(self._places(columns))
            flat[here] = lengths(values.T, self.rounding, self._denominator)
        return result

    def feasible(self, q: ArrayLike) -> Bools:
        """Tell where no boundary and no limit is violated, shape (..., joints) to (...).

        By distances in double precision; the evaluator is ten times as quick.

        Raises
        ------
        ValueError
            As `margins`.
        """
        q = self.robot.configuration(q)
        result = self.within_limits(q).reshape(-1)
        floor = -self.rounding[:, None]
        for here, columns in blocks(q):
            values = self._values(self._places(columns))
            result[here] &= (values >= floor).all(axis=0)
        return result.reshape(q.shape[:-1])

    @property
    def margin_rounding(self) -> Floats:
        """Largest margin that can be rounding of a true margin 0, shape (boundaries,)."""
        return lengths(self.rounding.copy(), self.rounding, self._denominator)

    def within_limits(self, q: Floats, but: int | None = None) -> Bools:
        """Tell where all joints, or all but one, are within their limits, shape (...)."""
        result = np.ones(q.shape[:-1], dtype=np.bool_)
        for j, joint in enumerate(self.robot.joints):
            if joint.limits is not None and j != but:
                low, high = joint.limits
                rounding = 2 * ROUNDING * max(abs(low), abs(high))
                result &= (q[..., j] >= low - rounding) & (q[..., j] <= high + rounding)
        return result

    def along(self, joint: int | str, q: ArrayLike) -> Floats:
        """Return the coefficients of every clearance form along one joint, the others held at q.

        They are those of `qbound.forms.HarmonicForm.along`: constant first, of
        (1, cos, sin) or (1, q, q²). A pair with both points on one side of the joint is constant.

        Parameters
        ----------
        joint : int or str
            By index or by name.
        q : array_like, shape (..., joints)
            The entry of the joint itself is not read.

        Returns
        -------
        ndarray, shape (..., boundaries, 3)
            Of pairs length squared, of half-spaces length.
        """
        j, q = self.robot.joint_index(joint), self.robot.configuration(q)
        flat = np.zeros((3, len(self.names), q.size // q.shape[-1]))
        for here, columns in blocks(q):
            poses = self.chain.poses(columns, j)
            x = self.chain.places(poses)
            flat[:, self.pairs, here] = self._pairs_along(j, x)
            flat[:, self.walls, here] = self.walls_along(j, x, poses[0])
        return flat.transpose(2, 1, 0).reshape(*q.shape[:-1], len(self.names), 3)

    def across(self, joint: int) -> Indices:
        """Return the pairs with points on two sides of a joint, by their index in `pairs`."""
        side = self.chain.groups(joint)
        return np.flatnonzero(side[self.near] != side[self.far])

    def beyond(self, joint: int) -> Indices:
        """Return the half-spaces whose point a joint moves, by their index in `walls`."""
        return np.flatnonzero(self.chain.groups(joint)[self.held])

    def walls_along(self, joint: int, x: Floats, base: Pose) -> Floats:
        """Return the heights over all half-spaces as forms of one joint, shape (3, walls, n).

        Parameters
        ----------
        x : ndarray, shape (3, points, n)
            Places seen from the joint (`Chain.places`).
        base : Pose
            Pose of the base, seen from the joint (`Chain.poses`).
        """
        axes, origin = base
        normal, place = self.normals @ axes, x[:, self.held] - origin[:, None]
        fixed = (normal * place).sum(axis=0) - self.levels[:, None]
        moved = np.zeros((3, *fixed.shape))
        side, crank = self.chain.groups(joint)[self.held], self.chain.crank(joint)
        if self.robot.joints[joint].turns:
            x, y, _ = x[:, self.held]
            if crank is not None:  # what the bar carries moves like the end of the bar
                x, y = (np.where(side[:, None] == 2, crank[i], at) for i, at in enumerate((x, y)))
            moved[1] = normal[0] * x + normal[1] * y
            moved[2] = normal[1] * x - normal[0] * y
        else:
            moved[1] = normal[2]
        moved[:, side == 0] = 0
        moved[0] = fixed - (moved[1] if self.robot.joints[joint].turns else 0)
        return moved

    def about(self, joint: int, x: Floats, which: Indices) -> tuple[Floats, Indices, Indices]:
        r"""Return two places for each pair: one that stands still and one that a joint moves.

        They are the places of the points, except for a parallelogram. The end of its bar goes round
        by the crank, :math:`R c`, and what it carries, at x, keeps its orientation. From there, a
        point p before the joint is where :math:`p - (x - c)` is from the turning c; a point b of
        the bar where the turning :math:`b - c` is from :math:`x - c`.

        Parameters
        ----------
        x : ndarray, shape (3, points, n)
            Places seen from the joint (`Chain.places`).
        which : ndarray of int, shape (k,)
            Pairs, with points on two sides of the joint.

        Returns
        -------
        places : ndarray, shape (3, m, n)
        near, far : ndarray of int, shape (k,)
            For each pair, the index of the place that stands still and of the place that is moved.
        """
        near, far, crank = self.near[which], self.far[which], self.chain.crank(joint)
        if crank is None:
            return x, near, far
        side = self.chain.groups(joint)
        before, carried = (side[near] == 0)[:, None], (side[far] == 2)[:, None]
        one, other = x[:, near], x[:, far]
        still = np.where(carried, np.where(before, one - other + crank, other - crank), one)
        moved = np.where(carried, np.where(before, crank, one - crank), other)
        count = np.arange(len(which))
        return np.concatenate([still, moved], axis=1), count, count + len(which)

    def _pairs_along(self, joint: int, x: Floats) -> Floats:
        """Return the forms of all pairs as forms of one joint, shape (3, pairs, n)."""
        forms = np.zeros((3, len(self.pairs), x.shape[2]))
        forms[0] = self.squared(x) - np.square(self.distance)[:, None]
        moving = self.across(joint)
        x, still, moved = self.about(joint, x, moving)
        near, far = x[:, still], x[:, moved]
        if self.robot.joints[joint].turns:
            forms[1, moving] = -2 * (near[0] * far[0] + near[1] * far[1])
            forms[2, moving] = -2 * (near[1] * far[0] - near[0] * far[1])
            forms[0] -= forms[1]
        else:
            forms[1, moving] = 2 * (far[2] - near[2])
            forms[2, moving] = 1
        return forms

    def _places(self, columns: Floats) -> Floats:
        return self.chain.places(self.chain.poses(columns))

    def _values(self, x: Floats) -> Floats:
        """Return the forms of all boundaries, shape (boundaries, n), from places in the base."""
        values = np.empty((len(self.names), x.shape[2]))
        values[self.pairs] = self.squared(x) - np.square(self.distance)[:, None]
        if len(self.walls):
            heights = np.einsum("wc,cwn->wn", self.normals, x[:, self.held])
            values[self.walls] = heights - self.levels[:, None]
        return values

    def squared(self, x: Floats, which: Indices | slice = ALL) -> Floats:
        """Return the squared distances of pairs, all or some by index, shape (pairs, n).

        Parameters
        ----------
        x : ndarray, shape (c, points, n)
            Places (`Chain.places`), or some of their coordinates.
        """
        return squared_distances(x, self.near[which], self.far[which])

    def _rounding(self) -> Floats:
        reach = np.array([self.robot.stretched(point.name) for point in self.chain.points])
        sizes = np.empty(len(self.names))
        between = reach[self.near] + reach[self.far]
        sizes[self.pairs] = np.square(between) + np.square(self.distance)
        sizes[self.walls] = reach[self.held] + np.abs(self.levels)
        return ROUNDING * sizes


def squared_distances(x: Floats, one: Indices, other: Indices) -> Floats:
    """Return squared distances, (k, n), of k pairs of the places x, (c, m, n), by their indices."""
    total = np.zeros((len(one), x.shape[2]))
    for coordinate in x:
        step = coordinate[other]
        step -= coordinate[one]
        step *= step
        total += step
    return total


@lru_cache(maxsize=64)
def _made(robot: Robot) -> Balls:
    return Balls(robot)


def blocks(q: Floats) -> Iterator[tuple[slice, Floats]]:
    """Yield slices of all configurations, in blocks, each with them as columns."""
    flat = q.reshape(-1, q.shape[-1])
    for start in range(0, len(flat), BLOCK):
        here = slice(start, min(start + BLOCK, len(flat)))
        yield here, np.ascontiguousarray(flat[here].T)


def _refuse_bodies(boundary: Boundary) -> None:
    if not isinstance(boundary, Pair | HalfSpace) or getattr(boundary, "body", None) is not None:
        name = printable(boundary.name)
        raise ValueError(
            f"{name}: balls are pairs and half-spaces of points; this is about bodies,"
            " of which cspace region, workspace and why know the way"
        )


class SphereMargins:
    """The margins of a sphere model as columns of an `Evaluator`.

    Attributes
    ----------
    names : tuple of str
    rounding : ndarray, shape (columns,)
        A margin that is no farther below zero than this is rounding.
    """

    def __init__(self, robot: Robot) -> None:
        balls = Balls.of(robot)
        self.names, self.margins = balls.names, balls.margins
        self.rounding = balls.margin_rounding

    def separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell which margins are above `at_least`, shape (..., columns)."""
        return np.asarray(self.margins(q) > np.asarray(at_least))

    def all_separated(self, q: ArrayLike, at_least: ArrayLike = 0.0) -> Bools:
        """Tell where every margin is above `at_least`, shape (...)."""
        return np.asarray(self.separated(q, at_least).all(axis=-1))


def takes_spheres(robot: Robot) -> bool:
    """Tell whether `judge` takes the sphere model of a robot: its forms would cost more."""
    dear = len(robot.used) * 3 ** len(robot.joints) > DEAR
    return dear and not any(bounds_bodies(boundary) for boundary in robot.used)


@lru_cache(maxsize=64)
def judge(robot: Robot, *, limits: bool = True) -> Evaluator:
    """Return what tells the margins of single configurations soonest: by forms, or by spheres.

    Both have the same columns and the same margins, but for their rounding.

    Examples
    --------
    >>> from cspace import load_robot
    >>> judge(load_robot("ur5")).bodies is None  # 193 pairs: 140,697 coefficients
    True
    """
    if not takes_spheres(robot):
        return evaluator(robot, limits=limits)
    ranges = [joint.limits if limits else None for joint in robot.joints]
    names = [limit_names(joint.name) for joint in robot.joints]
    only_limits = compiled(stacked(robot, []), [], [], ranges, names)
    return with_bodies(only_limits, SphereMargins(robot), [b.name for b in robot.used])


def judge_bytes(robot: Robot) -> int:
    """Estimate the memory of what `judge` returns."""
    return 0 if takes_spheres(robot) else forms_bytes(robot)


def _indices(numbers: Iterator[int]) -> Indices:
    return np.fromiter(numbers, dtype=np.intp)
