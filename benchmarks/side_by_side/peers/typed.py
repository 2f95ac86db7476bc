"""The closed form of two scenes, typed by hand: a user who knows that there is one needs no more.

Numbers are those of the robot files; a test holds them to the scenes.
"""

from __future__ import annotations

import numpy as np

LEAST = 0.1**2
FLOOR = 11.32
REACH = 1.83 - 0.5


def paper(q: np.ndarray) -> np.ndarray:
    """Tell where the paper's robot is safe: B1 to B4 and B7."""
    s1, c1, s2, c2 = np.sin(q[:, 0]), np.cos(q[:, 0]), np.sin(q[:, 1]), np.cos(q[:, 1])
    b1 = (11.5 * c1 + 4.91 * s1 - 7.5) ** 2 + (10.0 - 11.5 * s1 + 4.91 * c1) ** 2
    b2 = (-1.5 * c1 + 12.41 * s1 + 7.5) ** 2 + (10.0 + 1.5 * s1 + 12.41 * c1) ** 2
    b3 = (9.09 * c2 - 5.25 * s2 - 2.82) ** 2 + (10.11 - 9.09 * s2 - 5.25 * c2) ** 2
    b4 = (9.0 * c2 + 5.25 * s2 + 10.17) ** 2 + (2.61 - 9.0 * s2 + 5.25 * c2) ** 2
    height = 22.5 - 15.0 * s1 + 25.98 * c1 - 25.0 * (s1 * c2 + c1 * s2)
    free = (b1 >= LEAST) & (b2 >= LEAST) & (b3 >= LEAST) & (b4 >= LEAST)
    return free & (height >= FLOOR)


def walls(q: np.ndarray) -> np.ndarray:
    """Tell where the ball is between the walls."""
    return np.abs(2.0 * np.sin(q[:, 0]) + np.sin(q[:, 0] + q[:, 1])) <= REACH


TYPED = {"paper": paper, "walls": walls}
