r"""The screen of a table as machine code: what Numba compiles, as plain Python.

One function serves every robot: a table comes as two arrays (`program`), so that it is compiled
once and kept. `WIDTH` configurations at a time go through all steps in the first cache, each step a
loop that the processor takes sixteen numbers at a time.

Notes
-----
Sine and cosine are polynomials on one turn, the Chebyshev interpolants of degrees 11 and 12 in
single precision. Their error, in units of :math:`2^{-24}`: 1.7 of the interpolation, 4 of the
reduction to one turn, at most 60 of Horner's rule, by the sum over its steps of two roundings of
each partial result; `SINES` is above the sum. Over every number of single precision from
:math:`2^{-14}` to 32 rad the largest found is 9.9, with products and sums fused.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.boundary.screen import Screen
from qbound.extras import require

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]
Machine = Callable[[Floats, Integers, Singles, Bools, Integers], int]
MachineOfOne = Callable[[Floats, Integers, Singles], int]

SINES = 72.0
"""Bound of the error of `_sines` of an exact argument, in `qbound.boundary.screen.UNIT`."""

WIDTH = 256
"""Configurations at a time: a robot's monomials stay in the first cache."""

SHIFT, PER_TURN = np.float32(1.5 * 2**23), np.float32(0.5 / np.pi)
"""Added and taken away again, the first rounds to an integer."""

TURN, TURN_REST = np.float32(6.28125), np.float32(2 * np.pi - 6.28125)
"""A turn in two parts; a small integer times the first is exact."""

C0, C1, C2 = np.float32(9.99999989e-1), np.float32(-4.99999890e-1), np.float32(4.16664874e-2)
C3, C4 = np.float32(-1.38877951e-3), np.float32(2.47697094e-5)
C5, C6 = np.float32(-2.70773821e-7), np.float32(1.72392527e-9)
S0, S1, S2 = np.float32(9.99999594e-1), np.float32(-1.66665513e-1), np.float32(8.33239475e-3)
S3, S4, S5 = np.float32(-1.98084325e-4), np.float32(2.69950095e-6), np.float32(-2.03539944e-8)
ZERO, ONE, TWO = np.float32(0), np.float32(1), np.float32(2)


def program(screen: Screen) -> tuple[Integers, Singles]:
    """Return a screen as two arrays, the order of `judge`'s work and its numbers.

    The rows of the scratch are the joint values, then cosine and sine of each joint that turns,
    then products. Each row of the table is its constant and pairs of terms.
    """
    monomials, joints = screen.monomials, screen.monomials.joints
    turning = sorted({j for j, (kind, _) in monomials.factors if kind == "revolute"})
    first, products, place = joints + 2 * len(turning), list[int](), [0]
    for joint, (kind, i) in monomials.factors:
        if kind == "revolute":
            place.append(joints + 2 * turning.index(joint) + i - 1)
        elif i == 1:
            place.append(joint)
        else:
            place.append(first + len(products) // 2)
            products += joint, joint
    for one, other in monomials.products:
        place.append(first + len(products) // 2)
        products += place[one], place[other]
    starts, where, weights = [0], list[int](), list[float]()
    for row in screen.table:
        terms = [k for k in np.flatnonzero(row).tolist() if k > 0]
        where += [0, *(place[k] for k in terms)]
        weights += row[[0, *terms]].tolist()
        odd = max(0, 2 - len(terms)) or len(terms) % 2
        where, weights = where + odd * [0], weights + odd * [0.0]
        starts.append(len(where))
    head = [joints, len(turning), len(products) // 2, len(screen.table)]
    plan = np.array([*head, *turning, *products, *starts, *where], np.int64)
    return plan, np.array([*screen.reach, *weights], np.float32)


def judge(q: Floats, plan: Integers, numbers: Singles, safe: Bools, near: Integers) -> int:
    """Tell who is certainly feasible, as `qbound.boundary.screen.Screen.judge` does.

    Parameters
    ----------
    q : ndarray, shape (n * joints,)
    plan, numbers : ndarray
        The `program`.
    safe : ndarray of bool, shape (n,)
        Written: True where feasible.
    near : ndarray of int, shape (n,)
        Written: the first entries are the indices of those too near to say.

    Returns
    -------
    int
        How many these are.
    """
    joints, turning, products = plan[0], plan[1], plan[2]
    reach, weights = numbers[:joints], numbers[joints:]
    pairs = plan[4 + turning : 4 + turning + 2 * products]
    rows = plan[4 + turning + 2 * products :]
    scratch = np.empty((joints + 2 * turning + products + 2, WIDTH), np.float32)
    sums, least = scratch[-2], scratch[-1]
    found = 0
    for start in range(0, len(safe), WIDTH):
        n = min(WIDTH, len(safe) - start)
        _columns(q[start * joints : (start + n) * joints], joints, n, scratch)
        for k in range(turning):
            _sines(n, scratch[plan[4 + k]], scratch[joints + 2 * k], scratch[joints + 2 * k + 1])
        for k in range(products):
            one, other = scratch[pairs[2 * k]], scratch[pairs[2 * k + 1]]
            product = scratch[joints + 2 * turning + k]
            for i in range(n):
                product[i] = one[i] * other[i]
        for i in range(n):
            least[i] = TWO
        for k in range(plan[3]):
            first, end = rows[k], rows[k + 1]
            where = rows[plan[3] + 1 + first : plan[3] + 1 + end]
            _row(n, where, weights[first:end], scratch, sums, least)
        for j in range(joints):
            _within(n, reach[j], scratch[j], least)
        found = _told(start, n, least, safe, near, found)
    return int(found)


def judge_one(q: Floats, plan: Integers, numbers: Singles) -> int:
    """Return 1 where one configuration is certainly feasible, 0 where not; -1: too near to say."""
    joints, turning, products = plan[0], plan[1], plan[2]
    weights, pairs = numbers[joints:], plan[4 + turning : 4 + turning + 2 * products]
    rows = plan[4 + turning + 2 * products :]
    where = rows[plan[3] + 1 :]
    terms = np.empty(joints + 2 * turning + products, np.float32)
    for j in range(joints):
        terms[j] = q[j]
        if not abs(terms[j]) <= numbers[j]:
            return -1
    for k in range(turning):
        terms[joints + 2 * k], terms[joints + 2 * k + 1] = _cos_sin(terms[plan[4 + k]])
    for k in range(products):
        terms[joints + 2 * turning + k] = terms[pairs[2 * k]] * terms[pairs[2 * k + 1]]
    least = TWO
    for k in range(plan[3]):
        value = weights[rows[k]]
        for i in range(rows[k] + 1, rows[k + 1]):
            value += weights[i] * terms[where[i]]
        least = min(value, least)
    return int(least >= ONE) if abs(least) >= ONE else -1


def _columns(q: Floats, joints: int, n: int, scratch: Singles) -> None:
    """Write configurations as columns; a stride known beforehand is many times as quick."""
    if joints == 2:
        one, other = scratch[0], scratch[1]
        for i in range(n):
            one[i] = q[2 * i]
            other[i] = q[2 * i + 1]
    else:
        for j in range(joints):
            column = scratch[j]
            for i in range(n):
                column[i] = q[i * joints + j]


def _sines(n: int, x: Singles, cosine: Singles, sine: Singles) -> None:
    for i in range(n):
        cosine[i], sine[i] = _cos_sin(x[i])


def _cos_sin(x: np.float32) -> tuple[np.float32, np.float32]:
    """Return cosine and sine, by polynomials on one turn."""
    turns = (x * PER_TURN + SHIFT) - SHIFT
    r = (x - turns * TURN) - turns * TURN_REST
    z = r * r
    cosine = C0 + z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6)))))
    return cosine, r * (S0 + z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * S5)))))


def _row(
    n: int, where: Integers, weights: Singles, scratch: Singles, sums: Singles, least: Singles
) -> None:
    """Take the least of what there is and a row of the table: a constant and pairs of terms."""
    constant, last = weights[0], len(weights) - 2
    for k in range(1, last, 2):
        a, b, one, other = weights[k], weights[k + 1], scratch[where[k]], scratch[where[k + 1]]
        if k == 1:
            for i in range(n):
                sums[i] = constant + a * one[i] + b * other[i]
        else:
            for i in range(n):
                sums[i] += a * one[i] + b * other[i]
    a, b = weights[last], weights[last + 1]
    one, other = scratch[where[last]], scratch[where[last + 1]]
    if last == 1:
        for i in range(n):
            value = constant + a * one[i] + b * other[i]
            least[i] = min(value, least[i])
    else:
        for i in range(n):
            value = sums[i] + a * one[i] + b * other[i]
            least[i] = min(value, least[i])


def _within(n: int, reach: np.float32, x: Singles, least: Singles) -> None:
    """Make those too near to say whose joint value is beyond its reach, or NaN."""
    for i in range(n):
        least[i] = least[i] if abs(x[i]) <= reach else ZERO


def _told(start: int, n: int, least: Singles, safe: Bools, near: Integers, found: int) -> int:
    """Write answers, and the indices of those too near to say after the `found` first ones."""
    here, count = safe[start : start + n], 0
    for i in range(n):
        here[i] = least[i] >= ONE
        count += abs(least[i]) < ONE
    if count:
        for i in range(n):
            if abs(least[i]) < ONE:
                near[found] = start + i
                found += 1
    return found


@lru_cache(maxsize=1)
def machine() -> tuple[Machine, MachineOfOne]:
    """Return `judge` and `judge_one` as machine code; compiled when called, and kept.

    Raises
    ------
    ModuleNotFoundError
        Without Numba.
    """
    require("numba")
    from numba import njit
    from numba.extending import register_jitable

    fast: dict[str, Any] = {"fastmath": {"contract", "nsz"}, "error_model": "numpy"}
    for step in (_columns, _cos_sin, _sines, _row, _within, _told):
        register_jitable(**fast)(step)
    try:
        return tuple(njit(cache=True, nogil=True, **fast)(each) for each in (judge, judge_one))
    except RuntimeError:  # nowhere to keep it
        return tuple(njit(nogil=True, **fast)(each) for each in (judge, judge_one))
