r"""Feasible or not, in machine code: hundreds of millions of configurations a second.

It answers as `cspace.boundary.evaluator.Evaluator.feasible`, to the last sign: single precision
with a bound of its error decides the configurations that are far from every boundary, and the
evaluator decides all others.

The screen of a table is written as plain Python, which Numba compiles to machine code.

One function serves every robot: a table comes as two arrays (`program`), so that it is compiled
once and kept. `WIDTH` configurations at a time go through all steps in the first cache, each step a
loop that the processor takes sixteen numbers at a time.

Notes
-----
Joint values are brought to half a turn about zero, where the Chebyshev interpolants of degrees 9
and 8 are their sine and cosine, in single precision. The error, in units of :math:`2^{-24}`: of the
cosine 0.8 of the interpolation, 1.1 of the reduction, 0.8 of the square, 2 of the coefficients and
3.5 of Horner's rule, by the sum over its steps of two roundings of each partial result; of the sine
0.1, 1.1, 0.5, 2.4 and 3.9. `SINES` is above both sums. Over every number of single precision from
:math:`2^{-14}` to 32 rad the largest found is 3.3, with products and sums fused.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arguments import whole_number
from cspace.arrays import Bools, Floats, Singles
from cspace.boundary.evaluator import evaluator
from cspace.boundary.screen import Screen
from cspace.extras import require
from cspace.model.robot import Robot, real_numbers, refuse_no_robot

SHARE = 2**16
"""Configurations that are worth a thread, at the least."""

ANSWERS = np.array(False), np.array(True)
"""Of one configuration; made once, as a call takes less than a microsecond."""
for each in ANSWERS:
    each.setflags(write=False)


@lru_cache(maxsize=64)
def compiled_feasible(
    robot: Robot, *, limits: bool = True, threads: int = 1
) -> Callable[[ArrayLike], Bools]:
    """Return a function that tells where a robot keeps clear, as machine code (eqs. 10-12).

    Parameters
    ----------
    limits : bool
        Whether joint limits count.
    threads : int
        Largest number of threads that work on one call.

    Returns
    -------
    callable
        Configurations, shape (..., joints), to bool, shape (...): the answers of
        `cspace.boundary.evaluator.Evaluator.feasible`, and its errors.

    Raises
    ------
    ModuleNotFoundError
        Without Numba (the extra ``compiled``).
    ValueError
        If `threads` is less than 1.

    Notes
    -----
    The first call ever compiles for a few seconds, once for all robots; later processes find the
    code beside the package, or in the user's cache. The evaluator answers as before where lengths
    are beyond single precision, and for bodies. Not in the paper.

    Examples
    --------
    >>> from cspace import load_robot
    >>> feasible = compiled_feasible(load_robot("minervabot-v2"))
    >>> feasible([[0.2, -0.5], [1.5, 0.0]]).tolist()
    [True, False]
    """
    refuse_no_robot("compiled_feasible", robot)
    threads = whole_number("threads", threads, 1)
    (run, run_one), table = machine(), evaluator(robot, limits=limits)
    screen, one = table.screen(SINES), (table.joints,)
    if screen is None or not is_programmable(screen):
        return table.feasible
    plan, numbers = program(screen)

    def answer(q: Floats, safe: Bools) -> None:
        near = np.empty(len(safe), np.int64)  # pages that are not written take no memory
        count = run(q.reshape(-1), plan, numbers, safe, near)
        if count or table.bodies is not None:
            table.completed(q, safe, near[:count])

    def feasible(q: ArrayLike) -> Bools:
        q = np.ascontiguousarray(real_numbers(q))
        if q.shape == one and table.bodies is None:
            found = run_one(q, plan, numbers)
            return table.feasible(q) if found < 0 else ANSWERS[found]
        flat = table.shaped(q).reshape(-1, table.joints)
        safe = np.empty(len(flat), np.bool_)
        if threads == 1 or len(safe) < 2 * SHARE:
            answer(flat, safe)
        else:
            shared(answer, flat, safe, threads)
        return safe.reshape(q.shape[:-1])

    return feasible


def shared(answer: Callable[[Floats, Bools], None], q: Floats, safe: Bools, threads: int) -> None:
    """Answer in parts, by several threads; raise the first error of any thread."""
    from concurrent.futures import ThreadPoolExecutor

    step = max(SHARE, -(-len(safe) // (4 * threads)))
    parts = [slice(start, start + step) for start in range(0, len(safe), step)]
    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(lambda part: answer(q[part], safe[part]), parts):
            pass


# --- the machine code -----------------------------------------------------------------------------


Integers = NDArray[np.int64]
Machine = Callable[[Floats, Integers, Singles, Bools, Integers], int]
MachineOfOne = Callable[[Floats, Integers, Singles], int]

SINES = 12.0
"""Bound of the error of `_cos_sin`, in `cspace.boundary.screen.UNIT`."""

HEAD = 5
"""Entries of a program's order that tell how many there are of each kind."""

WIDTH = 256
"""Configurations at a time: a robot's monomials stay in the first cache."""

SHIFT, PER_HALF = np.float32(1.5 * 2**23), np.float32(1 / np.pi)
"""Added and taken away again, the first rounds to an integer; half turns a radian."""

FARTHEST = 2.0**17
"""Reach of a turning joint, rad, up to which that integer is small enough."""

LAST_BIT = np.int32(31)
"""The number's last bit is moved so far to be its sign."""

HALF_TURN, HALF_TURN_REST = np.float32(3.140625), np.float32(np.pi - 3.140625)
"""Half a turn in two parts; a small integer times the first is exact."""

C0, C1, C2 = np.float32(9.99999953e-1), np.float32(-4.99999047e-1), np.float32(4.16635722e-2)
C3, C4 = np.float32(-1.38536226e-3), np.float32(2.31522567e-5)
S0, S1, S2 = np.float32(9.99999996e-1), np.float32(-1.66666579e-1), np.float32(8.33305009e-3)
S3, S4 = np.float32(-1.98090111e-4), np.float32(2.60509296e-6)
ZERO, ONE, TWO = np.float32(0), np.float32(1), np.float32(2)


def is_programmable(screen: Screen) -> bool:
    """Tell whether `judge` can take the sines of all turning joints over their whole reach."""
    kinds = screen.monomials.factors
    return all(screen.reach[j] <= FARTHEST for j, (kind, _) in kinds if kind == "revolute")


def program(screen: Screen) -> tuple[Integers, Singles]:
    """Return a screen as two arrays, the order of `judge`'s work and its numbers.

    The rows of the scratch are the joint values, then cosine and sine of each joint that turns,
    then products. Each row of the table is its constant and pairs of terms; rows with one pair come
    first, and the head of the order has their number.
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
    rows = sorted(screen.table, key=lambda row: max(2, np.count_nonzero(row[1:])))
    for row in rows:
        terms = [k for k in np.flatnonzero(row).tolist() if k > 0]
        where += [0, *(place[k] for k in terms)]
        weights += row[[0, *terms]].tolist()
        odd = max(0, 2 - len(terms)) or len(terms) % 2
        where, weights = where + odd * [0], weights + odd * [0.0]
        starts.append(len(where))
    single = sum(end - start == 3 for start, end in pairwise(starts))
    head = [joints, len(turning), len(products) // 2, len(rows), single]
    plan = np.array([*head, *turning, *products, *starts, *where], np.int64)
    return plan, np.array([*screen.reach, *weights], np.float32)


def judge(q: Floats, plan: Integers, numbers: Singles, safe: Bools, near: Integers) -> int:
    """Tell which are certainly feasible, as `cspace.boundary.screen.Screen.judge` does.

    Parameters
    ----------
    q : ndarray, shape (n * joints,)
    plan, numbers : ndarray
        The `program`.
    safe : ndarray of bool, shape (n,)
        Written: True where feasible.
    near : ndarray of int, shape (n,)
        Written: its first entries are the indices of the configurations that are too near to
        decide.

    Returns
    -------
    int
        Number of these indices.
    """
    joints, turning, products, count = plan[0], plan[1], plan[2], plan[3]
    reach, weights = numbers[:joints], numbers[joints:]
    pairs = HEAD + turning
    rows = plan[pairs + 2 * products :]
    first = joints + 2 * turning
    least = first + products
    scratch = np.empty((least + 2, WIDTH), np.float32)
    low, found = scratch[least], 0
    for start in range(0, len(safe), WIDTH):
        n = min(WIDTH, len(safe) - start)
        here = q[start * joints : (start + n) * joints]
        _columns(here, joints, n, scratch)
        for i in range(n):
            low[i] = TWO
        for k in range(turning):
            row = joints + 2 * k
            _sines(n, scratch[plan[HEAD + k]], scratch[row], scratch[row + 1])
        for k in range(products):
            one, other = plan[pairs + 2 * k], plan[pairs + 2 * k + 1]
            for i in range(n):
                scratch[first + k, i] = scratch[one, i] * scratch[other, i]
        both = plan[4] // 2
        for k in range(both):
            _two_rows(n, rows, 2 * k, count + 1, weights, scratch, least)
        for k in range(2 * both, count):
            _row(n, rows, k, count + 1, weights, scratch, least)
        _within(n, here, joints, reach, scratch, low)
        found = _told(start, n, low, safe, near, found)
    return int(found)


def judge_one(q: Floats, plan: Integers, numbers: Singles) -> int:
    """Return 1 if a configuration is certainly feasible, 0 if certainly not, -1 if undecided."""
    joints, turning, products = plan[0], plan[1], plan[2]
    weights, pairs = numbers[joints:], plan[HEAD + turning : HEAD + turning + 2 * products]
    rows = plan[HEAD + turning + 2 * products :]
    where = rows[plan[3] + 1 :]
    terms = np.empty(joints + 2 * turning + products, np.float32)
    for j in range(joints):
        terms[j] = q[j]
        if not abs(terms[j]) <= numbers[j]:
            return -1
    for k in range(turning):
        terms[joints + 2 * k], terms[joints + 2 * k + 1] = _cos_sin(terms[plan[HEAD + k]])
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
    """Return cosine and sine by polynomials on half a turn; an odd count of halves negates both."""
    shifted = np.float32(x * PER_HALF + SHIFT)
    turns, odd = shifted - SHIFT, np.int32(shifted.view(np.int32) << LAST_BIT)
    r = (x - turns * HALF_TURN) - turns * HALF_TURN_REST
    z = r * r
    cosine = C0 + z * (C1 + z * (C2 + z * (C3 + z * C4)))
    sine = r * (S0 + z * (S1 + z * (S2 + z * (S3 + z * S4))))
    return _flipped(cosine, odd), _flipped(sine, odd)


def _flipped(x: np.float32, sign: np.int32) -> np.float32:
    """Return a number with its bits flipped where those of the sign are set."""
    return np.int32(np.float32(x).view(np.int32) ^ sign).view(np.float32)


def _two_rows(
    n: int, rows: Integers, k: int, at: int, weights: Singles, scratch: Singles, least: int
) -> None:
    """Lower the least values so far by two rows of the table, each with one pair of terms."""
    one, other = rows[k], rows[k + 1]
    c, a, b = weights[one], weights[one + 1], weights[one + 2]
    d, e, f = weights[other], weights[other + 1], weights[other + 2]
    x, y, u, v = rows[at + one + 1], rows[at + one + 2], rows[at + other + 1], rows[at + other + 2]
    for i in range(n):
        value = min(
            c + a * scratch[x, i] + b * scratch[y, i], d + e * scratch[u, i] + f * scratch[v, i]
        )
        scratch[least, i] = min(value, scratch[least, i])


def _row(
    n: int, rows: Integers, k: int, at: int, weights: Singles, scratch: Singles, least: int
) -> None:
    """Lower the least values so far by a row of the table: a constant and pairs of terms."""
    start, last, sums = rows[k], rows[k + 1] - 2, least + 1
    constant = weights[start]
    for m in range(start + 1, last, 2):
        a, b, one, other = weights[m], weights[m + 1], rows[at + m], rows[at + m + 1]
        if m == start + 1:
            for i in range(n):
                scratch[sums, i] = constant + a * scratch[one, i] + b * scratch[other, i]
        else:
            for i in range(n):
                scratch[sums, i] += a * scratch[one, i] + b * scratch[other, i]
    a, b, one, other = weights[last], weights[last + 1], rows[at + last], rows[at + last + 1]
    if last == start + 1:
        for i in range(n):
            value = constant + a * scratch[one, i] + b * scratch[other, i]
            scratch[least, i] = min(value, scratch[least, i])
    else:
        for i in range(n):
            value = scratch[sums, i] + a * scratch[one, i] + b * scratch[other, i]
            scratch[least, i] = min(value, scratch[least, i])


def _within(n: int, q: Floats, joints: int, reach: Singles, scratch: Singles, low: Singles) -> None:
    """Mark as undecided each configuration with a joint value that is NaN or beyond its reach."""
    shortest, within = min(reach), True
    for i in range(n * joints):
        within &= abs(q[i]) <= shortest
    if not within:
        for j in range(joints):
            for i in range(n):
                if not abs(scratch[j, i]) <= reach[j]:
                    low[i] = ZERO


def _told(start: int, n: int, low: Singles, safe: Bools, near: Integers, found: int) -> int:
    """Write answers; append indices of undecided configurations behind the `found` first ones."""
    here, some = safe[start : start + n], False
    for i in range(n):
        here[i] = low[i] >= ONE
        some |= abs(low[i]) < ONE
    if some:
        for i in range(n):
            if abs(low[i]) < ONE:
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
    steps = (_columns, _flipped, _cos_sin, _sines, _two_rows, _row, _within, _told)
    for step in steps:
        register_jitable(**fast)(step)
    try:
        return tuple(njit(cache=True, nogil=True, **fast)(each) for each in (judge, judge_one))
    except RuntimeError:  # nowhere to keep it
        return tuple(njit(nogil=True, **fast)(each) for each in (judge, judge_one))
