"""A judge of the region by windows that shares nothing with the libraries that it judges.

It reads the table of a robot file. Points are turned by plain rotation matrices about y, windows
are found by stepping along a joint and halving an interval, areas are counted on grids, and the
tool is sent back to joint values by the law of cosines.
"""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi, sin

import numpy as np

STEPS = 720
"""Steps of a turn at whose ends a sign is looked for."""


class Judge:
    """A planar arm of two joints about y, given by the table of its file, in cm and rad."""

    def __init__(self, table):
        self.joint = [np.array(row["origin"], dtype=float) for row in table["joint"]]
        self.frame = {row["name"]: int(row["frame"]) for row in table["point"]}
        self.at = {row["name"]: np.array(row["at"], dtype=float) for row in table["point"]}
        used = [row for row in table["boundary"] if row.get("used", True)]
        self.pairs = [row["points"] for row in used if row["type"] == "pair"]
        self.walls = [row for row in used if row["type"] == "half-space"]
        self.tool = table["tool"]
        sides = [self.side(0), self.side(1)]
        self.low, self.high = np.array(sides).T

    # --- points

    def position(self, name, q1, q2, observer=0):
        """Return a point, shape (..., 3), seen from frame 0 or 1."""
        r = self.at[name]
        if self.frame[name] == 2:
            r = self.joint[1] + turned(q2, r)
        if self.frame[name] >= 1 and observer == 0:
            r = self.joint[0] + turned(q1, r)
        return r

    def distance(self, pair, q1, q2):
        """Return the distance of the two points of a pair, both seen from the base."""
        one, other = (self.position(name, q1, q2) for name in pair)
        return np.linalg.norm(other - one, axis=-1)

    # --- windows

    def side(self, joint):
        """Return the highest lower end and the lowest upper end of a joint's windows."""
        uppers = []
        for pair in self.pairs:
            near = min(self.frame[name] for name in pair)
            if near == joint:
                uppers += [self.falls(pair, near, j) for j in (0, 2)]
        ends = [end for end in uppers if end is not None]
        return max(ends) - 2 * pi, min(ends)

    def falls(self, pair, near, j):
        """Return the first angle from 0 at which a component falls through zero, or None."""
        one, other = pair

        def component(q):
            a, b = (self.position(n, q, q, observer=near)[j] for n in (one, other))
            return b - a

        steps = [k * 2 * pi / STEPS for k in range(STEPS + 1)]
        for start, end in pairwise(steps):
            if component(start) > 0 >= component(end):
                low, high = start, end
                for _ in range(60):
                    middle = (low + high) / 2
                    low, high = (middle, high) if component(middle) > 0 else (low, middle)
                return (low + high) / 2
        return None

    # --- the region and what the tool reaches from it

    def inside(self, q1, q2):
        """Tell which configurations lie in all windows and keep every half-space in use."""
        found = (self.low[0] <= q1) & (q1 <= self.high[0])
        found = found & (self.low[1] <= q2) & (q2 <= self.high[1])
        for wall in self.walls:
            r = self.position(wall["point"], q1, q2)
            found &= (r * wall["normal"]).sum(axis=-1) >= wall["offset"]
        return found

    def area(self, n):
        """Count the area of the region on a grid of n by n cells of the box, rad²."""
        steps = (self.high - self.low) / n
        q1, q2 = (self.low[i] + steps[i] * (np.arange(n) + 0.5) for i in (0, 1))
        return self.inside(q1[:, None], q2[None]).sum() * steps.prod()

    def workspace(self, n):
        """Count the points of the plane that are reached, and reached twice, on n by n cells."""
        bar, link = np.hypot(*self.joint[1][[0, 2]]), np.hypot(*self.at[self.tool][[0, 2]])
        step = 2 * (bar + link) / n
        x, z = np.meshgrid(*[-(bar + link) + step * (np.arange(n) + 0.5)] * 2)
        cosine = (x * x + z * z - bar**2 - link**2) / (2 * bar * link)
        bend = np.arccos(np.clip(cosine, -1, 1))
        times = np.zeros(x.shape, dtype=int)
        for elbow in (bend, -bend):
            # Angles from z towards x: of the bar, of the link to it, both at joint values 0.
            first = np.arctan2(self.joint[1][0], self.joint[1][2])
            second = np.arctan2(self.at[self.tool][0], self.at[self.tool][2])
            q2 = elbow - second + first
            seen = np.arctan2(x, z) - np.arctan2(link * np.sin(elbow), bar + link * np.cos(elbow))
            q1 = seen - first
            into = [low + (q - low) % (2 * pi) for low, q in zip(self.low, (q1, q2), strict=True)]
            times += self.inside(*into) & (np.abs(cosine) <= 1)
        return (times > 0).sum() * step**2, (times > 1).sum() * step**2


def turned(q, r):
    """Turn a vector, or an array of them, about y by the matrix R_y(q)."""
    if np.ndim(q) == 0:
        matrix = np.array([[cos(q), 0, sin(q)], [0, 1, 0], [-sin(q), 0, cos(q)]])
        return matrix @ r if r.ndim == 1 else r @ matrix.T
    c, s, o, i = np.cos(q), np.sin(q), np.zeros(np.shape(q)), np.ones(np.shape(q))
    rows = [np.stack(row, axis=-1) for row in ((c, o, s), (o, i, o), (-s, o, c))]
    return (np.stack(rows, axis=-2) @ r[..., None])[..., 0]
