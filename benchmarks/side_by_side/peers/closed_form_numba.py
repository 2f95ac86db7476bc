"""A closed form typed by hand, compiled by numba: a loop, as its user guide's first page has it.

`prange` and `parallel=True` are its documented way to several threads. Its documented faster sines
(Intel's SVML) need a build of llvmlite that the package index does not have.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

import numpy as np
from serve import Missing, serve
from streams import Judge, stream_tasks
from typed import FLOOR, LEAST, REACH


def paper(q1: float, q2: float) -> bool:
    s1, c1 = sin(q1), cos(q1)
    if (11.5 * c1 + 4.91 * s1 - 7.5) ** 2 + (10.0 - 11.5 * s1 + 4.91 * c1) ** 2 < LEAST:
        return False
    if (-1.5 * c1 + 12.41 * s1 + 7.5) ** 2 + (10.0 + 1.5 * s1 + 12.41 * c1) ** 2 < LEAST:
        return False
    s2, c2 = sin(q2), cos(q2)
    if (9.09 * c2 - 5.25 * s2 - 2.82) ** 2 + (10.11 - 9.09 * s2 - 5.25 * c2) ** 2 < LEAST:
        return False
    if (9.0 * c2 + 5.25 * s2 + 10.17) ** 2 + (2.61 - 9.0 * s2 + 5.25 * c2) ** 2 < LEAST:
        return False
    return 22.5 - 15.0 * s1 + 25.98 * c1 - 25.0 * (s1 * c2 + c1 * s2) >= FLOOR


def walls(q1: float, q2: float) -> bool:
    return abs(2.0 * sin(q1) + sin(q1 + q2)) <= REACH


TYPED = {"paper": paper, "walls": walls}


def compiled(threads: int) -> Callable[[str], Judge]:
    """Return the maker of what judges a batch on so many threads."""

    def make(scene: str) -> Judge:
        import numba

        if scene not in TYPED:
            raise Missing(f"nobody has typed a closed form of {scene}")
        numba.set_num_threads(threads)
        free = numba.njit(TYPED[scene])

        def loop(q: np.ndarray, found: np.ndarray) -> None:
            for i in numba.prange(len(q)):
                found[i] = free(q[i, 0], q[i, 1])

        run: Any = numba.njit(parallel=threads > 1)(loop)

        def judge(q: np.ndarray) -> np.ndarray:
            found = np.empty(len(q), dtype=np.bool_)
            run(q, found)
            return found

        return judge

    return make


def one(scene: str) -> Judge:
    import numba

    if scene not in TYPED:
        raise Missing(f"nobody has typed a closed form of {scene}")
    free = numba.njit(TYPED[scene])
    single: Any = numba.njit(lambda q: free(q[0], q[1]))
    return single


if __name__ == "__main__":
    serve("closed form typed by hand, numba", {"numba": "numba"}, stream_tasks(compiled(1), one))
