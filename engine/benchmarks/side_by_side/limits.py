"""What this machine can do at most: reading memory, and sines and cosines, with nothing around.

Every kernel takes configurations of two joints from memory and writes one byte for each, compiled
by numba to the processor's widest vectors. ``read`` only adds both values; ``both`` has both sines
and both cosines too, by the polynomials of the Cephes library: no method that needs them in double
precision can be faster.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from asking import Timed, timed

TWO_OVER_PI = 0.6366197723675814
HALF_PI = 1.5707963267948966
HALF_PI_REST = 6.123233995736766e-17


def sine_cosine(x: float) -> tuple[float, float]:
    """Return sine and cosine of a value of a few turns, without a branch."""
    k = np.rint(x * TWO_OVER_PI)
    r = (x - k * HALF_PI) - k * HALF_PI_REST
    z = r * r
    s = 2.7557313621385725e-06 + z * (-2.5050747762857807e-08 + z * 1.5896230157654656e-10)
    s = 8.3333333333221186e-03 + z * (-1.9841269829589539e-04 + z * s)
    s = r + r * z * (-1.6666666666666631e-01 + z * s)
    c = -2.7557314179296740e-07 + z * (2.0875700841974732e-09 + z * -1.1358536521387682e-11)
    c = -1.3888888888873056e-03 + z * (2.4801587288851704e-05 + z * c)
    c = 1.0 - 0.5 * z + z * z * (4.1666666666666593e-02 + z * c)
    odd = k - 2.0 * np.floor(0.5 * k)
    half = np.floor(0.5 * k)
    turn = 1.0 - 2.0 * (half - 2.0 * np.floor(0.5 * half))
    sine = turn * (s + odd * (c - s))
    cosine = turn * (c + odd * (-s - c))
    return sine, cosine


@lru_cache(maxsize=4)
def kernel(kind: str, threads: int) -> Any:
    """Return a compiled kernel that works on the rows of its arrays, one a thread."""
    import numba

    fast = {"contract", "nnan", "ninf", "nsz", "arcp"}
    parts = numba.njit(fastmath=fast, inline="always")(sine_cosine)

    def read(x: np.ndarray, y: np.ndarray, found: np.ndarray) -> None:
        for i in range(len(x)):
            found[i] = x[i] + y[i] > 0

    def both(x: np.ndarray, y: np.ndarray, found: np.ndarray) -> None:
        for i in range(len(x)):
            s1, c1 = parts(x[i])
            s2, c2 = parts(y[i])
            found[i] = (s1 > c2) & (c1 > s2)

    one = numba.njit(fastmath=fast)({"read": read, "both": both}[kind])

    @numba.njit(parallel=threads > 1)
    def rows(x: np.ndarray, y: np.ndarray, found: np.ndarray) -> None:
        for row in numba.prange(len(x)):
            one(x[row], y[row], found[row])

    return rows


def limits(task: str, scene: str, kind: str, threads: int, count: int) -> Timed:
    """Time one kernel on `count` configurations of two joints; there is no scene."""
    x, y = np.random.default_rng(0).uniform(-np.pi, np.pi, (2, threads, count // threads))
    found, work = np.empty(x.shape, dtype=np.bool_), kernel(kind, threads)
    work(x, y, found)
    seconds, processor, _ = timed(lambda: work(x, y, found))
    return seconds, processor, {"count": found.size, "threads": threads}
