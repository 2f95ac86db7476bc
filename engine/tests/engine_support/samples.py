"""Random arms with a leaf, and places of it: what the checker's bounds are compared with."""

import itertools
import random
import tomllib
from fractions import Fraction

import numpy as np

from cspace import check
from engine_support import brute_force
from engine_support.certificates import Draft
from engine_support.claims import box
from engine_support.robot_files import ALL_KINDS, robot_file

WIRE = '[[boundary]]\nname = "wire"\ntype = "pair"\npoints = ["tip", "mid"]\n'


class Sample:
    """A random arm, a leaf, and configurations of it; some joints may take any value."""

    def __init__(self, seed, free_share=0.0, width=1.0):
        self.rng, rng = random.Random(seed), np.random.default_rng(seed)
        unit, count = self.rng.choice(("deg", "rad")), 1 + seed % 4
        text = robot_file(seed, count, ALL_KINDS, unit) + WIRE
        self.table = tomllib.loads(text)
        turns = np.array([row["type"] != "prismatic" for row in self.table["joint"]])
        radian = 180 / np.pi if unit == "deg" else 1
        size = width * np.where(turns, radian, 3)
        low = np.where(turns, 2 * size * rng.uniform(-1, 1, count), rng.uniform(-4, 3, count))
        high = low + size * rng.random(count) * rng.choice([0, 1, 1], count)
        is_free = rng.random(count) < free_share
        is_simplex = seed // 4 % 2
        shares = rng.random((3, count)) if is_simplex else np.array([[0] * count, [1] * count])
        corners = (low + shares * (high - low)).round(3)
        corners[:, is_free] = np.where(turns, 0, 1)[is_free]  # 1 is the middle of a slide
        self.corners = [[Fraction(str(x)) for x in q] for q in corners]
        low, high = corners.min(axis=0), corners.max(axis=0)
        self.draft = Draft(text, box(" ".join(map(str, low)), " ".join(map(str, high))))
        placed = [self.draft.arm.placed(q) for q in self.corners]
        self.cell = (check.Cell if is_simplex else check.Box)(tuple(placed))
        self.middle = corners.mean(axis=0)
        if is_simplex:
            parts = np.concatenate([np.eye(3), rng.dirichlet([0.5] * 3, 60)])
            self.q = parts @ corners
        else:
            ends = np.array([*itertools.product((0, 1), repeat=count)])
            parts = np.concatenate([ends, rng.random((60, count))])
            self.q = corners[0] + parts * (corners[1] - corners[0])
        arm = self.draft.arm
        ranges = {j: arm.whole_range(j) for j in np.flatnonzero(is_free).tolist()}
        free = {j: (high - low + 3) >> 1 for j, (low, high) in ranges.items()}
        self.leaf = check.Leaf(self.draft.steps, self.cell, free)
        self.q = np.repeat(self.q, 20 if free else 1, axis=0)
        whole = np.where(turns, np.pi * radian, 5)  # the limits of slides are -4 and 6
        anything = np.where(turns, 0, 1) + whole * rng.uniform(-1, 1, self.q.shape)
        self.q = np.where(is_free, anything, self.q)

    def corner(self):
        return [round(self.rng.uniform(-9, 9), 3) for _ in range(3)]

    def step_of(self, k):
        """Return the steps of the joints of step k from the middle, in radians or lengths."""
        step = self.draft.steps[k]
        x = step.factor * (self.q - self.middle)[:, step.joint]
        return np.radians(x) if step.turns and self.table["angle_unit"] == "deg" else x

    def seen(self, frame, corner, at):
        """Return a corner of a frame as it is seen from another one, at all samples."""
        names = brute_force.frames_of(self.table)
        rows = [*((names[at], e) for e in (*np.eye(3), np.zeros(3))), (names[frame], corner)]
        found = [brute_force.place(self.table, {"frame": f, "at": e}, self.q) for f, e in rows]
        *axes, origin, r = found
        return np.stack([((axis - origin) * (r - origin)).sum(axis=1) for axis in axes], axis=1)


def in_floats(v, scale):
    return np.array([x / check.ONE for x in v]) * scale
