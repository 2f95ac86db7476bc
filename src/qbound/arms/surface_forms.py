"""The boundary functions and limits of three joints, whose zeros make a surface.

Of hundreds of boundary functions, only a few come near to 0 in one part of joint space. A bound
over each block of a grid finds these functions. Only their values and slopes are computed there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.boundary.evaluator import limit_names, stacked
from qbound.boundary.poses import bounds_bodies
from qbound.forms.bending import bending
from qbound.forms.factors import TURN, basis
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Robot
from qbound.printable import printable
from qbound.tolerances import NEGLIGIBLE

Ints = NDArray[np.intp]

ON_FORM: Final = 1e-12
"""Value of a form, relative to its size, at which a place is on it: Newton ends in rounding."""

TIED: Final = 1e-9
"""Difference below which the order of functions decides: rounding would, and does so anew on each
kind of processor."""

BLOCK: Final = 4096
"""Places of which all functions are looked at at a time."""

STEPS: Final = 12
"""Of Newton: from a place on a grid each doubles the digits."""


@dataclass(frozen=True, eq=False)
class SurfaceForms:
    """Boundary functions of three joints; where limits close the surface, two more for each joint.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        In the three joints.
    names : tuple of str
        Of the forms, then of the limits.
    walls : tuple of (int, float, float)
        Limits: axis, value, and sign of the side within.
    sizes : ndarray, shape (m + limits,)
        Sizes of the functions' terms, to which values are relative.
    box : ndarray, shape (2, 3)
        Ends of the axes where the surface is open; infinite where it is closed by a limit.
    """

    forms: HarmonicForm
    names: tuple[str, ...]
    walls: tuple[tuple[int, float, float], ...]
    sizes: Floats
    box: Floats

    def relative(self, q: Floats, which: Ints | None = None) -> Floats:
        """Return the values of functions divided by their sizes, shape (N, 3) to (N, count).

        Parameters
        ----------
        which : ndarray of int, optional
            Forms to evaluate; the limits are always.
        """
        rows = self._relative_rows if which is None else self._relative_rows[which]
        values = self._monomials(q) @ rows.T
        if not self.walls:
            return np.asarray(values)
        far = self.sizes[len(self._rows) :]
        walls = zip(self.walls, far, strict=True)
        columns = [side * (q[:, axis] - value) / size for (axis, value, side), size in walls]
        return np.column_stack([values, *columns])

    def least(self, q: Floats) -> tuple[Ints, Floats]:
        """Return at each place the function with the least relative value, and this value.

        Of functions that are equal there up to rounding, the first is taken.
        """
        which, least = np.empty(len(q), dtype=np.intp), np.empty(len(q))
        for start in range(0, len(q), BLOCK):
            values = self.relative(q[start : start + BLOCK])
            which[start : start + BLOCK] = first_least(values, ON_FORM)
            least[start : start + BLOCK] = values.min(axis=1)
        return which, least

    def can_vanish(self, centres: Floats, half: Floats) -> NDArray[np.bool_]:
        """Tell which forms may be 0 or less in boxes, by the bound of second order.

        Parameters
        ----------
        centres : ndarray, shape (N, 3)
        half : ndarray, shape (3,)
            Half widths of each box.

        Returns
        -------
        ndarray of bool, shape (N, m)
        """
        slope = np.abs(self.forms.gradient(centres)) @ half
        bend = bending(
            self.forms, _far_corners(centres, half), half[None, None].repeat(len(centres), 0)
        )
        lowest = self.forms(centres) - slope - bend[:, 0] / 2
        return np.asarray(lowest <= ON_FORM * self.sizes[: len(self._rows)])

    def only(self, which: NDArray[np.bool_]) -> SurfaceForms:
        """Return the functions with only some of the forms, and with all limits."""
        kept = np.concatenate([which, np.ones(len(self.walls), dtype=np.bool_)])
        names = tuple(name for name, keep in zip(self.names, kept, strict=True) if keep)
        return replace(self, forms=self.forms[which], names=names, sizes=self.sizes[kept])

    def of(self, q: Floats, which: Ints) -> tuple[Floats, Floats]:
        """Return value and slope of function number `which` at each place.

        Parameters
        ----------
        q : ndarray, shape (N, 3)
        which : ndarray of int, shape (N, s)

        Returns
        -------
        values : ndarray, shape (N, s)
        slopes : ndarray, shape (N, s, 3)
        """
        count = len(self._rows)
        values, slopes = np.zeros(which.shape), np.zeros((*which.shape, 3))
        if count:
            form, monomials = np.minimum(which, count - 1), self._monomials(q)
            values = np.einsum("nsc,nc->ns", self._rows[form], monomials)
            slopes = np.einsum("nsjc,nc->nsj", self._slopes[form], monomials)
        for k, (axis, value, side) in enumerate(self.walls, start=count):
            here = which == k
            values = np.where(here, side * (q[:, None, axis] - value), values)
            slopes = np.where(here[..., None], side * np.eye(3)[axis], slopes)
        return values, slopes

    def onto(
        self, q: Floats, which: Ints, held: NDArray[np.bool_], step: Floats
    ) -> tuple[Floats, NDArray[np.bool_]]:
        """Move places onto their functions by Newton's method, the shortest way.

        Parameters
        ----------
        q : ndarray, shape (N, 3)
        which : ndarray of int, shape (N, s)
            Functions whose zeros are wanted.
        held : ndarray of bool, shape (N, 3)
            Coordinates that stay.
        step : ndarray, shape (3,)
            Units in which the distance is measured: steps of the grid.

        Returns
        -------
        q : ndarray, shape (N, 3)
        found : ndarray of bool, shape (N,)
            Whether all functions vanish, within two steps of where it began.
        """
        place, held = q.copy(), held.copy()
        for _ in range(STEPS):
            values, slopes = self.of(place, which)
            size = self.sizes[which]
            move = slopes * np.where(held, 0.0, step)[:, None] / size[..., None]
            way = np.linalg.pinv(move, rcond=1e-9) @ (values / size)[..., None]
            moved = place - np.clip(way[..., 0], -1, 1) * step
            place = np.clip(moved, *self.box)
            held |= place != moved  # a place that reaches a border moves on along it
        values, _ = self.of(place, which)
        near = (np.abs(place - q) <= 2 * step).all(axis=1)
        return place, np.asarray(near & (np.abs(values) <= ON_FORM * self.sizes[which]).all(axis=1))

    @cached_property
    def _rows(self) -> Floats:
        return np.asarray(self.forms.coefficients.reshape(-1, 27))

    @cached_property
    def _relative_rows(self) -> Floats:
        return np.asarray(self._rows / self.sizes[: len(self._rows), None])

    @cached_property
    def _slopes(self) -> Floats:
        return np.asarray(self.forms.derivatives.coefficients.reshape(-1, 3, 27))

    def _monomials(self, q: Floats) -> Floats:
        a, b, c = (basis(kind, q[:, j]) for j, kind in enumerate(self.forms.kinds))
        return np.asarray(np.einsum("ni,nj,nk->nijk", a, b, c).reshape(len(q), 27))


def first_least(values: Floats, tied: float) -> Ints:
    """Return the first column of each row that is no further above the least than `tied`."""
    return np.asarray((values <= values.min(axis=1, keepdims=True) + tied).argmax(axis=1))


def settled(values: Floats) -> Floats:
    """Return values with 0 for each value that may be rounding alone and so has no true sign."""
    return np.where(np.abs(values) <= ON_FORM, 0.0, values)


@dataclass(frozen=True)
class Axis:
    """One of the three joints.

    Attributes
    ----------
    joint : int
        By index of the robot.
    ends : tuple of (float, float)
        The limits; of a joint that turns a turn or more, one turn.
    around : bool
        Whether it is such a joint, so that both ends are the same place.
    """

    joint: int
    ends: tuple[float, float]
    around: bool


def axis_of(robot: Robot, joint: int) -> Axis:
    """Return a joint as an axis; of wider limits one turn is taken, about 0 if they contain it."""
    limits, turns = robot.joints[joint].limits, robot.joints[joint].turns
    if limits is None:
        return Axis(joint, (-math.pi, math.pi), True)
    low, high = limits
    if not turns or high - low < TURN - NEGLIGIBLE:
        return Axis(joint, (low, high), False)
    centred = low <= -math.pi and math.pi <= high
    return Axis(joint, (-math.pi, math.pi) if centred else (low, low + TURN), True)


def surface_forms(
    robot: Robot, held: dict[int, float], axes: Sequence[Axis], *, caps: bool
) -> SurfaceForms:
    """Return the functions in use of the three joints that are not held (eqs. 9-12).

    Raises
    ------
    ValueError
        If a boundary is about bodies, which have no single function, or there is none in use.
    """
    about = [boundary.name for boundary in robot.used if bounds_bodies(boundary)]
    if about:
        names = printable(", ".join(about[:3]))
        raise ValueError(f"a surface is made of boundaries about points; about bodies: {names}")
    if not robot.used:
        raise ValueError(f"{printable(robot.name)}: no boundary is in use")
    forms = stacked(robot, robot.used).restrict(held)
    reach = [max(map(abs, axis.ends)) for axis in axes]
    ended = [(k, axis) for k, axis in enumerate(axes) if caps and not axis.around]
    box = np.array([axis.ends for axis in axes]).T
    box[:, [k for k, _ in ended]] = [[-math.inf], [math.inf]]
    return SurfaceForms(
        forms=forms,
        names=(
            *(boundary.name for boundary in robot.used),
            *(name for _, axis in ended for name in limit_names(robot.joints[axis.joint].name)),
        ),
        walls=tuple(
            (k, end, side)
            for k, axis in ended
            for end, side in zip(axis.ends, (1.0, -1.0), strict=True)
        ),
        sizes=np.array([*forms.size(reach), *(1 + reach[k] for k, _ in ended for _ in range(2))]),
        box=box,
    )


def _far_corners(centres: Floats, half: Floats) -> Floats:
    """Return the two corners of each box between which it lies, shape (N, 2, 3)."""
    return np.stack([centres - half, centres + half], axis=1)


# --- on a grid ------------------------------------------------------------------------------------


PLACES: Final = 6
"""Places of the grid that a block has along each axis."""


def grid_values(forms: SurfaceForms, grid: list[Floats]) -> tuple[SurfaceForms, Floats]:
    """Return the functions that may vanish on a grid, and the least of their values on it.

    Parameters
    ----------
    grid : list of ndarray
        Places along each of three axes, in even steps.

    Returns
    -------
    forms : SurfaceForms
    values : ndarray
        Relative to the functions' sizes; 1 where no function can vanish.
    """
    blocks = [range(0, len(places), PLACES) for places in grid]
    starts = list(product(*blocks))
    step = np.array([places[1] - places[0] for places in grid])
    low = np.array([places[0] for places in grid])
    middle = (PLACES - 1) / 2
    centres = low + step * (np.array(starts) + middle)
    active = forms.can_vanish(centres, middle * step)
    used = np.asarray(active.any(axis=0))
    forms, active = forms.only(used), active[:, used]
    values = np.ones([len(places) for places in grid])
    for start, which in zip(starts, active, strict=True):
        if which.any() or forms.walls:
            part = tuple(slice(k, k + PLACES) for k in start)
            axes = [places[each] for places, each in zip(grid, part, strict=True)]
            q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
            found = forms.relative(q.reshape(-1, 3), np.flatnonzero(which)).min(axis=1)
            values[part] = found.reshape(q.shape[:3])
    return forms, settled(values)
