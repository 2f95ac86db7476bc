"""What this machine can do at most: sines and cosines, and reading memory, with nothing around.

Every kernel takes configurations of two joints and writes one byte for each, compiled by numba to
the processor's widest vectors. ``read`` only adds both values; ``sines`` has both sines and both
cosines, by the polynomials of the Cephes library, of values that stay in the cache; ``both`` has
them of values from memory: no method that needs them in double precision can be faster.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from serve import Timed, serve, timed

IN_CACHE = 8192
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


@lru_cache(maxsize=1)
def kernels() -> dict[tuple[str, int], Any]:
    """Return the compiled kernels, by what they do and their threads."""
    import numba

    fast = {"contract", "nnan", "ninf", "nsz", "arcp"}
    parts = numba.njit(fastmath=fast, inline="always")(sine_cosine)

    def sines(x: np.ndarray, y: np.ndarray, found: np.ndarray) -> None:
        for i in range(len(x)):
            s1, c1 = parts(x[i])
            s2, c2 = parts(y[i])
            found[i] = (s1 > c2) & (c1 > s2)

    def read(x: np.ndarray, y: np.ndarray, found: np.ndarray) -> None:
        for i in range(len(x)):
            found[i] = x[i] + y[i] > 0

    return {
        (name, threads): spread(numba, numba.njit(fastmath=fast)(kernel), threads)
        for name, kernel in {"sines": sines, "read": read}.items()
        for threads in (1, 2)
    }


def spread(numba: Any, kernel: Any, threads: int) -> Callable[..., None]:
    """Return a kernel that works on the rows of its arrays, each some times, on so many threads."""

    def rows(x: np.ndarray, y: np.ndarray, found: np.ndarray, times: int) -> None:
        for row in numba.prange(len(x)):
            for _ in range(times):
                kernel(x[row], y[row], found[row])

    compiled: Callable[..., None] = numba.njit(parallel=threads > 1)(rows)
    return compiled


def limit(scene: str, kind: str, threads: int, count: int) -> Timed:
    """Time one kernel on `count` configurations of two joints; the scene is not looked at."""
    del scene
    if kind == "numpy sines":
        return numpy_sines(count)
    size = IN_CACHE if kind == "sines" else count // threads
    times = count // (size * threads)
    x, y = np.random.default_rng(0).uniform(-np.pi, np.pi, (2, threads, size))
    found = np.empty(x.shape, dtype=np.bool_)
    work = kernels()["read" if kind == "read" else "sines", threads]
    work(x, y, found, 1)
    seconds, processor, _ = timed(lambda: work(x, y, found, times))
    return seconds, processor, {"count": times * size * threads, "threads": threads}


def numpy_sines(count: int) -> Timed:
    """Time NumPy's sine and cosine of both joints, on values that stay in the cache."""
    x = np.random.default_rng(0).uniform(-np.pi, np.pi, 2 * IN_CACHE)
    s, c, times = np.empty_like(x), np.empty_like(x), count // IN_CACHE

    def work() -> None:
        for _ in range(times):
            np.sin(x, out=s)
            np.cos(x, out=c)

    seconds, processor, _ = timed(work)
    return seconds, processor, {"count": times * IN_CACHE, "threads": 1}


if __name__ == "__main__":
    serve("the machine's limit", {"numba": "numba"}, {"limit": limit})
