"""Feasible or not, in machine code: hundreds of millions of configurations a second.

It answers as `qbound.boundary.evaluator.Evaluator.feasible`, to the last sign: single precision
with a bound of its error decides who is far from every boundary, and the evaluator all others.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from qbound.arguments import whole_number
from qbound.arrays import Bools, Floats
from qbound.boundary.evaluator import evaluator
from qbound.boundary.machine import SINES, is_programmable, machine, program
from qbound.model.robot import Robot, refuse_no_robot
from qbound.model.values import real_numbers

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
        At most so many work on one call.

    Returns
    -------
    callable
        Configurations, shape (..., joints), to bool, shape (...): the answers of
        `qbound.boundary.evaluator.Evaluator.feasible`, and its errors.

    Raises
    ------
    ModuleNotFoundError
        Without Numba (the extra ``compiled``).
    ValueError
        If there is to be less than one thread.

    Notes
    -----
    The first call ever compiles for a few seconds, once for all robots; later processes find the
    code beside the package, or in the user's cache. Where lengths are beyond single precision, or
    bodies are to be told apart, that is the evaluator's work as before. Not in the paper.

    Examples
    --------
    >>> from qbound import load_robot
    >>> safe = compiled_feasible(load_robot("minervabot-v2"))
    >>> safe([[0.2, -0.5], [1.5, 0.0]]).tolist()
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
        near = np.empty(len(safe), np.int64)  # what is not written takes no memory
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
    """Answer in parts, by several threads; the first error of any is raised."""
    from concurrent.futures import ThreadPoolExecutor

    step = max(SHARE, -(-len(safe) // (4 * threads)))
    parts = [slice(start, start + step) for start in range(0, len(safe), step)]
    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(lambda part: answer(q[part], safe[part]), parts):
            pass
