"""Ranges of one joint that something blocks, whatever the other joints do.

Balls of two links of which only one joint changes the distance block a range of that joint, in
closed form (`proofs.subpaving.forbidden`). Where the ranges of all boundaries end, the joint's
travel falls apart: no path leads from one part to another. Limits of two turns may leave three
parts that the eye takes for one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from qbound.arms.links import link_pair
from qbound.forms.factors import first_from
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.proofs.exact.numbers import above, ball, below, pi, precision, turns
from qbound.proofs.subpaving.forbidden import BITS, BlockedRange, blocked_ranges

Span = tuple[float, float]


@dataclass(frozen=True)
class Block:
    """Values of a joint that nothing passes: ranges of single boundaries that overlap.

    Attributes
    ----------
    low, high : float
        rad or length; a block that reaches a limit ends there.
    ranges : tuple of BlockedRange
        What it is made of, by low end; turned by full turns to where they stand here.
    links : tuple of str
        What meets there, as `links.link_pair` has it; the widest range first.
    """

    low: float
    high: float
    ranges: tuple[BlockedRange, ...]
    links: tuple[str, ...]


@dataclass(frozen=True)
class JointTravel:
    """The travel of a joint, and what of it is blocked; not in the paper.

    Attributes
    ----------
    joint : int
    name : str
    limits : (float, float) or None
        None: it turns all the way round.
    blocks : tuple of Block
        Ascending. Round a joint without limits they are listed for one turn, from -pi on.
    free : tuple of (float, float)
        What the blocks leave; round a joint without limits each is unrolled, and the last one ends
        a turn above the first block. Nothing is said of them: other joints may block them.
    """

    joint: int
    name: str
    limits: Span | None
    blocks: tuple[Block, ...]
    free: tuple[Span, ...]

    def part(self, value: float) -> int | None:
        """Return the number of the free range that holds a value, None where it is blocked.

        A joint without limits may be given any turn: the value is brought to the turn that begins
        at the first free range.
        """
        if self.limits is None and self.free:
            value = float(first_from(self.free[0][0], value))
        found = (k for k, (low, high) in enumerate(self.free) if low <= value <= high)
        return next(found, None)


@dataclass(frozen=True)
class Separation:
    """Why no path joins two configurations: a joint cannot pass some blocks.

    Attributes
    ----------
    travel : JointTravel
    parts : (int, int)
        The free ranges of the two values.
    blocks : tuple of Block
        One that lies between them; of a joint without limits two, one on either way round.
    """

    travel: JointTravel
    parts: tuple[int, int]
    blocks: tuple[Block, ...]


def separations(source: str | Path | Robot) -> tuple[JointTravel, ...]:
    """Return the travel of every joint, with what is blocked whatever the other joints are.

    Parameters
    ----------
    source : str, Path or Robot
        What `load_robot` takes, or a robot; numbers count as `exact_robot` has them.

    Returns
    -------
    tuple of JointTravel
        One a joint. Blocks are proved; that there is no other way to separate is not said.

    Raises
    ------
    ValueError
        As `qbound.load_robot` does.

    Notes
    -----
    Not in the paper, but for Theorem 2, which solves each boundary (eqs. 30-38). Boundaries about
    bodies have no form of one joint and are left out: what they block is not seen.

    Examples
    --------
    >>> shoulder, elbow = separations("two-joint-arm-with-walls")
    >>> [(each.boundary, round(each.high, 3)) for each in shoulder.blocks[0].ranges]
    [('elbow, floor', -2.419)]
    >>> len(elbow.blocks)
    0
    """
    robot = source if isinstance(source, Robot) else load_robot(source)
    named = {b.name: link_pair(robot, b) for b in robot.used}
    ranges = blocked_ranges(robot, [named[b.name] for b in robot.used])
    return tuple(
        _travel(robot, j, [r for r in ranges if r.joint == j], named)
        for j in range(len(robot.joints))
    )


def separation(
    travels: Iterable[JointTravel], one: Sequence[float], other: Sequence[float]
) -> Separation | None:
    """Return a joint that cannot get from one configuration to another, if blocks show one.

    Parameters
    ----------
    one, other : sequence of float, shape (n,)
        rad or length.
    """
    for travel in travels:
        parts = travel.part(one[travel.joint]), travel.part(other[travel.joint])
        if parts[0] is None or parts[1] is None or parts[0] == parts[1]:
            continue
        blocks: tuple[Block, ...]
        low, high = sorted((parts[0], parts[1]))
        if travel.limits is None:
            one_way, other_way = ((k + 1) % len(travel.blocks) for k in (low, high))
            blocks = (travel.blocks[one_way], travel.blocks[other_way])
        else:
            free = travel.free
            between = [
                b for b in travel.blocks if free[low][1] <= b.low and b.high <= free[high][0]
            ]
            blocks = (max(between, key=lambda b: b.high - b.low),)
        return Separation(travel, (parts[0], parts[1]), blocks)
    return None


# --- one joint ------------------------------------------------------------------------------------


def _travel(
    robot: Robot, j: int, ranges: Sequence[BlockedRange], named: dict[str, str]
) -> JointTravel:
    joint = robot.joints[j]
    limits = joint.limits
    within = limits or (-math.pi, math.pi)
    shifted = sorted(
        (r for each in ranges for r in _turned(each, within, joint.turns)), key=lambda r: r.low
    )
    if limits is None:
        shifted = [r for r in shifted if -math.pi < r.low <= math.pi]
    blocks = _merged(shifted, named)
    if limits is None:
        blocks = _closed(blocks, named)
        lows = [*(b.low for b in blocks[1:]), *(b.low + math.tau for b in blocks[:1])]
        ends = zip((b.high for b in blocks), lows, strict=True)
        free = [(low, high) for low, high in ends if low < high] if blocks else [within]
        return JointTravel(j, joint.name, None, tuple(blocks), tuple(free))
    edges = [limits[0], *(x for b in blocks for x in (b.low, b.high)), limits[1]]
    pairs = zip(edges[::2], edges[1::2], strict=True)
    free = [(low, high) for low, high in pairs if low < high]
    cut = tuple(
        Block(max(b.low, limits[0]), min(b.high, limits[1]), b.ranges, b.links) for b in blocks
    )
    return JointTravel(j, joint.name, limits, cut, tuple(free))


def _turned(each: BlockedRange, within: Span, turning: bool) -> Iterable[BlockedRange]:
    """Yield a range at every turn at which it meets a span, rounded inwards."""
    if not turning:
        if each.low < within[1] and each.high > within[0]:
            yield each
        return
    first = math.floor((within[0] - each.high) / math.tau)
    last = math.ceil((within[1] - each.low) / math.tau)
    for k in range(first, last + 1):
        with precision(BITS):
            low, high = above(ball(each.low) + turns(k)), below(ball(each.high) + turns(k))
        if low < within[1] and high > within[0]:
            yield BlockedRange(each.joint, low, high, each.boundary)


def _merged(ranges: Sequence[BlockedRange], named: dict[str, str]) -> list[Block]:
    """Put ranges that overlap together."""
    groups = list[list[BlockedRange]]()
    for each in ranges:
        if groups and each.low <= max(r.high for r in groups[-1]):
            groups[-1].append(each)
        else:
            groups.append([each])
    return [_block(group, named) for group in groups]


def _block(group: Sequence[BlockedRange], named: dict[str, str]) -> Block:
    widest = sorted(group, key=lambda r: r.low - r.high)
    links = dict.fromkeys(named[r.boundary] for r in widest)
    return Block(group[0].low, max(r.high for r in group), tuple(group), tuple(links))


def _closed(blocks: list[Block], named: dict[str, str]) -> list[Block]:
    """Close the circle: a last block that reaches a turn on into the first one is one with it."""
    while len(blocks) > 1 and blocks[-1].high - math.tau >= blocks[0].low:
        first = [
            BlockedRange(r.joint, _next_turn(r.low), _next_turn(r.high), r.boundary)
            for r in blocks[0].ranges
        ]
        blocks = [*blocks[1:-1], _block([*blocks[-1].ranges, *first], named)]
    return blocks


def _next_turn(value: float) -> float:
    with precision(BITS):
        return float(ball(value) + 2 * pi())
