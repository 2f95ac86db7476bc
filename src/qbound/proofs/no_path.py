"""Certificates that no path leads from one configuration to another: a joint cannot pass a range.

Grammar 4 of the book's page "The certificate". What is written is what the checkers need: a range
of one joint between the two configurations (round a joint without limits one on either way), the
boundary that is violated all over it, and a tree that cuts the range until a bound shows it.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot
from qbound.proofs.blocked import BlockedRange, likely
from qbound.proofs.certify import Certificate, confirmed
from qbound.proofs.grammar import GRAMMAR_OF_NO_PATH, NO_PATH
from qbound.proofs.statements import decimal, units, within_limits
from qbound.proofs.verdict import Verdict
from qbound.tolerances import NEGLIGIBLE

Floats = NDArray[np.float64]

INWARDS = 1e-6
"""Part of a range by which either end is moved inwards: a bound needs room at a root."""

DEEPEST = 60
"""Cuts on top of each other before a search gives up."""


def certify_no_path(
    text: str, one: ArrayLike, other: ArrayLike, ranges: Sequence[BlockedRange]
) -> Certificate:
    """Certify that no path leads from one configuration to another; not in the paper.

    Parameters
    ----------
    text : str
        The robot file, see `robotfile.robot_text`.
    one, other : array_like, shape (n,)
        rad or length; what is written is rounded to decimals.
    ranges : sequence of BlockedRange
        Of one joint: a range between its two values, or, of a joint without limits, two with one
        of the values between them, at any turn.

    Returns
    -------
    Certificate
        Proved, or undecided where the checker does not follow.

    Raises
    ------
    ValueError
        If a configuration is none of the robot's.
    """
    robot = parse_robot(tomllib.loads(text))
    ends = np.stack([robot.configuration(q) for q in (one, other)])
    points = within_limits(robot, ends)
    j = ranges[0].joint
    placed = ranges if robot.joints[j].limits else _around(ends[0, j], ends[1, j], ranges)
    rows = [_row(robot, each) for each in placed]
    statement = {"set": NO_PATH, "margin": "0", "points": [points]}
    proof = {"joint": robot.joints[j].name, "blocked": rows}
    return confirmed(text, GRAMMAR_OF_NO_PATH, statement, Verdict.PROVED, proof=proof)


def _around(start: float, goal: float, ranges: Sequence[BlockedRange]) -> list[BlockedRange]:
    """Turn two ranges to where they lie within the turn above the start, the goal between."""
    turned = []
    for each in ranges:
        back = math.tau * math.floor((each.low - start) / math.tau)
        turned.append(BlockedRange(each.joint, each.low - back, each.high - back, each.boundary))
    return sorted(turned, key=lambda r: r.low)


def _row(robot: Robot, each: BlockedRange) -> dict[str, str]:
    """Write a range as a certificate does, its ends a little inwards."""
    low, high = each.low, each.high
    if not np.isfinite([low, high]).all():  # a slide that a half-space ends
        limits = robot.joints[each.joint].limits or (low, high)
        low, high = max(low, limits[0]), min(high, limits[1])
    room = INWARDS * (high - low)
    unit = units(robot)[each.joint]
    ends = [decimal(x / unit) for x in (low + room, high - room)]
    first, last = (float(x) * unit for x in ends)
    found = likely(robot, [robot.boundary(each.boundary)])
    alone = next((row for _, j, row in found if j == each.joint), np.zeros(3))
    turns, letter = robot.joints[each.joint].turns, chr(ord("a") + each.joint)
    tree = _tree(alone, turns, first, last, letter)
    return {"boundary": each.boundary, "from": ends[0], "to": ends[1], "tree": tree}


def _tree(alone: Floats, turns: bool, low: float, high: float, letter: str, depth: int = 0) -> str:
    """Cut a range until minus the function of one joint is bounded from below by more than 0."""
    c, a, b = alone
    middle, half = (low + high) / 2, (high - low) / 2
    if turns:
        cosine, sine = math.cos(middle), math.sin(middle)
        value, slope = c + a * cosine + b * sine, b * cosine - a * sine
        bend = math.hypot(a, b) * half * half / 2
    else:
        value, slope = c + a * middle + b * middle * middle, a + 2 * b * middle
        bend = abs(b) * half * half
    slack = NEGLIGIBLE * float(np.abs(alone).sum())
    if value + abs(slope) * half + bend < -slack or depth == DEEPEST:
        return "."
    lower = _tree(alone, turns, low, middle, letter, depth + 1)
    return letter + lower + _tree(alone, turns, middle, high, letter, depth + 1)
