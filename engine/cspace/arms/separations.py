"""Ranges of one joint that something blocks, whatever the other joints do.

If only one joint changes the distance of the balls of two links, these balls block a range of that
joint, in closed form (`proofs.subpaving.forbidden`). The blocked ranges of all boundaries cut the
joint's travel into parts, and no path leads from one part to another. A joint with limits two turns
apart may have three parts that look alike.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from cspace.arms.links import link_pair
from cspace.model.robot import Robot
from cspace.model.robotfile import load_robot
from cspace.proofs.exact.numbers import above, ball, below, pi, precision, turns
from cspace.proofs.subpaving.forbidden import BITS, BlockedRange, blocked_ranges
from qbound.circle import first_from

Span = tuple[float, float]


@dataclass(frozen=True)
class Block:
    """A range of joint values that the arm cannot pass: overlapping ranges of single boundaries.

    Attributes
    ----------
    low, high : float
        rad or length; a block that reaches a limit ends there.
    ranges : tuple of BlockedRange
        The single ranges, by low end, shifted by full turns to this block.
    links : tuple of str
        The pairs of links that meet there, named by `links.link_pair`; the widest range first.
    """

    low: float
    high: float
    ranges: tuple[BlockedRange, ...]
    links: tuple[str, ...]


@dataclass(frozen=True)
class JointTravel:
    """The travel of a joint with its blocked parts; not in the paper.

    Attributes
    ----------
    joint : int
    name : str
    limits : (float, float) or None
        None if the joint turns all the way round.
    blocks : tuple of Block
        Ascending. Round a joint without limits they are listed for one turn, from -pi on.
    free : tuple of (float, float)
        The ranges that the blocks leave. Round a joint without limits each range is unrolled, and
        the last one ends a turn above the first block. They need not be feasible, because other
        boundaries may block them together with other joints.
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
    """Proof that no path joins two configurations: blocks of one joint lie between them.

    Attributes
    ----------
    travel : JointTravel
    parts : (int, int)
        The free ranges of the two values.
    blocks : tuple of Block
        A block that lies between them; for a joint without limits two blocks, one on each way
        round.
    """

    travel: JointTravel
    parts: tuple[int, int]
    blocks: tuple[Block, ...]


def separations(source: str | Path | Robot) -> tuple[JointTravel, ...]:
    """Return the travel of every joint, with the ranges blocked for all values of the other joints.

    Parameters
    ----------
    source : str, Path or Robot
        What `load_robot` takes, or a robot; its numbers are read as `exact_robot` reads them.

    Returns
    -------
    tuple of JointTravel
        One for each joint. Blocks are proved. That a joint has no block does not prove that it can
        move freely.

    Raises
    ------
    ValueError
        As `cspace.load_robot` does.

    Notes
    -----
    Not in the paper, but for Theorem 2, which solves each boundary (eqs. 30-38). Boundaries about
    bodies have no form of one joint and are left out, so ranges that they block are not found.

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
    """Return a joint whose blocks separate one configuration from another, or None.

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
    """Yield the copies of a range, shifted by full turns, that meet a span; rounded inwards."""
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
    """Close the circle: join the last block with the first one if it reaches it a turn later."""
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
