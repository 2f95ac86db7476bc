r"""Fibres: the exact feasible intervals of one joint while the others are held, many at once.

Seen from the joint's axis, the centre of a sphere has a radius and a height. A pair is nearest when
both stand in one half-plane through the axis. The pair can touch only if their distance there is
less than the required distance, and few pairs can. For these the forbidden angles are one arc
(Theorem 2). Its half-width is :math:`2 \arctan\sqrt{(d^2 - r_0^2) / (r_\pi^2 - d^2)}`, where d is
the required distance, :math:`r_0` the distance in one half-plane and :math:`r_\pi` that in opposite
ones. Along a slide the forbidden values are one interval.

A fibre gives the whole travel of a joint exactly, with the names of its ends; samples would miss a
thin obstacle. A fibre is not a better way to a volume: in equal time, evenly spread points are as
good (`engine/benchmarks/fibres.py`). Not in the paper.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi, tau
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cspace.arms.links import SPHERES_ONLY, link_pair, on_spheres, unchecked_lines
from cspace.arrays import Bools, Floats, Indices
from cspace.boundary.balls import Balls, blocks, squared_distances
from cspace.boundary.chain import Pose
from cspace.boundary.evaluator import limit_names
from cspace.export.formats import heading
from cspace.geometry import arcs
from cspace.model.robot import Joint, Robot, refuse_no_robot
from cspace.printable import printable
from cspace.units import counted, joint_amount, joint_text

MOST_SHOWN = 10
"""Pairs of links that a sentence names."""


class Interval(NamedTuple):
    """Values that a joint may take, ends included: rad or length.

    Attributes
    ----------
    low, high : float
    below, above : str or None
        The boundary or joint limit at each end; None where nothing ends the interval.
    """

    low: float
    high: float
    below: str | None
    above: str | None


@dataclass(frozen=True, eq=False)
class Fibres:
    """Feasible intervals along one joint, for each of n configurations.

    Attributes
    ----------
    robot : Robot
    joint : int
    offsets : ndarray of int, shape (n + 1,)
        Row i has the intervals ``offsets[i]`` to ``offsets[i + 1]``, ascending.
    low, high : ndarray, shape (m,)
        Their ends, rad or length. Round a joint without limits an interval begins in [-pi, pi) and
        may end beyond pi.
    below, above : ndarray of int, shape (m,)
        What ends the intervals: indices into `names`, -1 where nothing does.
    names : tuple of str
        The boundaries in use, then the joint's two limits.
    """

    robot: Robot
    joint: int
    offsets: Indices
    low: Floats
    high: Floats
    below: Indices
    above: Indices
    names: tuple[str, ...]

    def __repr__(self) -> str:
        """Name the joint and the number of intervals in one line."""
        name = printable(self.robot.joints[self.joint].name)
        rows = counted(len(self), "configuration")
        return f"<Fibres of {name}: {counted(len(self.low), 'interval')} of {rows}>"

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.offsets) - 1

    def __getitem__(self, row: int) -> list[Interval]:
        """Return the intervals of a row."""
        if not -len(self) <= row < len(self):
            raise IndexError(f"row {row} of {len(self)}")
        row %= len(self)
        found = []
        for k in range(*self.offsets[row : row + 2].tolist()):
            ends = (
                None if i == arcs.NONE else self.names[i] for i in (self.below[k], self.above[k])
            )
            found.append(Interval(float(self.low[k]), float(self.high[k]), *ends))
        return found

    @cached_property
    def rows(self) -> Indices:
        """The row of each interval, shape (m,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.offsets))

    @property
    def length(self) -> Floats:
        """How much the joint may move in all, shape (n,)."""
        return np.bincount(self.rows, self.high - self.low, len(self)).astype(float)

    def contains(self, values: ArrayLike) -> Bools:
        """Tell which values of the joint are feasible; modulo a turn where it has no limits.

        Parameters
        ----------
        values : array_like, shape (n,) or (n, k)
            One or several a row.
        """
        values = np.asarray(values, dtype=float)
        if values.shape[:1] != (len(self),) or not np.isfinite(values).all():
            raise ValueError(f"finite values of {len(self)} rows are wanted")
        above = values.reshape(len(self), -1)[self.rows] - self.low[:, None]
        if self.robot.joints[self.joint].limits is None:
            above = np.mod(above, tau)
        inside, column = np.nonzero((above >= 0) & (above <= (self.high - self.low)[:, None]))
        result = np.zeros(values.reshape(len(self), -1).shape, dtype=np.bool_)
        result[self.rows[inside], column] = True
        return result.reshape(values.shape)


def fibres(robot: Robot, joint: int | str, q: ArrayLike) -> Fibres:
    """Return the feasible values of one joint at each of many configurations of the others.

    Parameters
    ----------
    joint : int or str
        By index or by name.
    q : array_like, shape (joints,) or (n, joints)
        rad or length. The entry of the joint itself is not read. If another entry is outside its
        limits, nothing is feasible.

    Raises
    ------
    ValueError
        If the joint does not exist, a boundary is about bodies, or q are not configurations.

    Examples
    --------
    >>> from cspace import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> found = fibres(robot, "q2", [[0.2, 0.0], [1.5, 0.0]])
    >>> [(round(i.low, 4), round(i.high, 4), i.below, i.above) for i in found[0]]
    [(-2.859, 0.7655, 'B4', 'B3'), (0.7846, 3.4127, 'B3', 'B4')]
    >>> found.length.round(4).tolist(), found.contains([-0.5, 0.0]).tolist()
    ([6.2527, 2.9744], [True, False])
    """
    refuse_no_robot("fibres", robot)
    balls, j, q = Balls.of(robot), robot.joint_index(joint), robot.configuration(q)
    q = q.reshape(-1, q.shape[-1])
    outside = ~balls.within_limits(q, but=j)
    found = [arcs.Gaps(*np.zeros((5, 0)))]
    for here, columns in blocks(q):
        gaps = _of_block(balls, j, columns, outside[here])
        found.append(gaps._replace(row=gaps.row + here.start))
    row, low, high, below, above = (np.concatenate(each) for each in zip(*found, strict=True))
    offsets = np.searchsorted(row, np.arange(len(q) + 1))
    start, _ = _range(robot.joints[j])
    names = (*balls.names, *limit_names(robot.joints[j].name))
    ends = below.astype(np.intp), above.astype(np.intp)
    return Fibres(robot, j, offsets, low + start, high + start, *ends, names)


def _range(joint: Joint) -> tuple[float, float | None]:
    """Return the least value and the span; none where the joint turns all the way round."""
    return (
        (-pi, None) if joint.limits is None else (joint.limits[0], np.subtract(*joint.limits[::-1]))
    )


def _of_block(balls: Balls, joint: int, columns: Floats, outside: Bools) -> arcs.Gaps:
    """Return the feasible intervals of some configurations, from the least value on."""
    poses = balls.chain.poses(columns, joint)
    x = balls.chain.places(poses)
    rows = columns.shape[1]
    if x.shape[2] < rows:  # the other joints move no pair
        x = np.broadcast_to(x, (3, x.shape[1], rows))
    outside = outside | _violated(balls, joint, x, poses[0])
    turns = balls.robot.joints[joint].turns
    taken = [
        _of_pairs_turning(balls, joint, x) if turns else _of_pairs_sliding(balls, joint, x),
        _of_walls(balls, joint, x, poses[0]),
        _nothing(np.flatnonzero(outside)),
    ]
    start, span = _range(balls.robot.joints[joint])
    number = np.concatenate([which for which, _ in taken])
    row, low, high = (np.concatenate(each) for each in zip(*(t for _, t in taken), strict=True))
    intervals = arcs.Intervals(row, low - start, high - start)
    gaps = (
        arcs.on_circle(intervals, rows, span) if turns else arcs.on_line(intervals, rows, span or 0)
    )
    # which boundary or limit ends each gap, in place of which interval
    count, number = len(balls.names), np.append(number, arcs.NONE)
    limits = (arcs.NONE, arcs.NONE) if span is None else (count, count + 1)
    below, above = (
        np.where(each == arcs.NONE, limit, number[each])
        for each, limit in zip((gaps.below, gaps.above), limits, strict=True)
    )
    return gaps._replace(below=below, above=above)


Taken = tuple[Indices, arcs.Intervals]
"""The boundary of each forbidden interval, and the interval; modulo a turn of a turning joint."""


def _violated(balls: Balls, joint: int, x: Floats, base: Pose) -> Bools:
    """Tell where a boundary is violated that does not depend on the joint."""
    still = np.setdiff1d(np.arange(len(balls.pairs)), balls.across(joint))
    found = (balls.squared(x, still) < _kept(balls)[still, None]).any(axis=0)
    walls = np.setdiff1d(np.arange(len(balls.walls)), balls.beyond(joint))
    if len(walls):
        heights = balls.walls_along(joint, x, base)[0, walls]
        found |= (heights < -balls.rounding[balls.walls[walls], None]).any(axis=0)
    return np.asarray(found)


def _of_pairs_turning(balls: Balls, joint: int, x: Floats) -> Taken:
    """Return the arcs of a turning joint that pairs forbid."""
    which, kept = balls.across(joint), _kept(balls)
    x, still, moved = balls.about(joint, x, which)
    about = np.stack([x[2], np.hypot(x[0], x[1])])  # height and radius
    nearest = squared_distances(about, still, moved)
    pair, row = np.nonzero(nearest < kept[which, None])
    nearest, near, far, pair = nearest[pair, row], still[pair], moved[pair], which[pair]
    kept = kept[pair]
    farthest = nearest + 4 * about[1, near, row] * about[1, far, row]
    (x1, y1), (x2, y2) = x[:2, near, row], x[:2, far, row]
    centre = np.arctan2(y1 * x2 - x1 * y2, x1 * x2 + y1 * y2)
    half = 2 * np.arctan2(np.sqrt(kept - nearest), np.sqrt(np.maximum(farthest - kept, 0)))
    half[farthest < kept] = np.inf
    used = _not_within_longest(row, centre, half, x.shape[2])
    row, centre, half = row[used], centre[used], half[used]
    low = centre - np.minimum(half, pi)
    return balls.pairs[pair[used]], arcs.Intervals(row, low, centre + half)


def _not_within_longest(row: Indices, centre: Floats, half: Floats, rows: int) -> Indices:
    """Return the arcs outside the longest arc of their row, because sorting costs most."""
    longest = np.zeros(rows)
    np.maximum.at(longest, row, half)
    held = np.zeros(rows)
    is_longest = half == longest[row]
    held[row[is_longest]] = centre[is_longest]
    apart = np.abs(centre - held[row])
    apart = np.minimum(apart, np.abs(tau - apart))
    return np.flatnonzero((apart + half > longest[row]) | (apart == 0))


def _of_pairs_sliding(balls: Balls, joint: int, x: Floats) -> Taken:
    """Return the intervals of a sliding joint that pairs forbid."""
    which, kept = balls.across(joint), _kept(balls)
    nearest = balls.squared(x[:2], which)
    pair, row = np.nonzero(nearest < kept[which, None])
    nearest, pair = nearest[pair, row], which[pair]
    centre = x[2, balls.near[pair], row] - x[2, balls.far[pair], row]
    half = np.sqrt(kept[pair] - nearest)
    return balls.pairs[pair], arcs.Intervals(row, centre - half, centre + half)


def _of_walls(balls: Balls, joint: int, x: Floats, base: Pose) -> Taken:
    """Return the intervals that half-spaces forbid."""
    which = balls.beyond(joint)
    if not len(which):
        return _nothing(np.zeros(0, dtype=np.intp))
    c, a, b = balls.walls_along(joint, x, base)[:, which]
    c = c + balls.rounding[balls.walls[which], None]
    if balls.robot.joints[joint].turns:
        size = np.hypot(a, b)
        wall, row = np.nonzero(c < size)
        a, b, c, size = (each[wall, row] for each in (a, b, c, size))
        half = 2 * np.arctan2(np.sqrt(size - c), np.sqrt(np.maximum(size + c, 0)))
        low = np.arctan2(-b, -a) - half
        high = np.where(c < -size, np.inf, low + 2 * half)
    else:
        wall, row = np.nonzero((a != 0) | (c < 0))
        a, c = a[wall, row], c[wall, row]
        root = np.divide(-c, a, out=np.full(len(a), np.inf), where=a != 0)
        low, high = np.where(a < 0, root, -np.inf), np.where(a < 0, np.inf, root)
    return balls.walls[which][wall], arcs.Intervals(row, low, high)


def _nothing(row: Indices) -> Taken:
    """Return intervals that fill some rows completely and belong to no boundary."""
    far = np.full(len(row), np.inf)
    return np.full(len(row), arcs.NONE), arcs.Intervals(row, -far, far)


def _kept(balls: Balls) -> Floats:
    """Return the squared distance under which a pair is violated, less rounding; shape (pairs,)."""
    return np.asarray(np.square(balls.distance) - balls.rounding[balls.pairs])


# --- as others read it: JSON and sentences --------------------------------------------------------


def fibre_document(fibres: Fibres, q: Sequence[float]) -> dict[str, Any]:
    """Return the JSON form of one fibre, schema qbound/fibre/1; rad or length."""
    robot, joint = fibres.robot, fibres.robot.joints[fibres.joint]
    return {
        **heading("qbound/fibre/1", robot),
        "joint": joint.name,
        "unit": joint.unit(robot.length_unit),
        "q": list(q),
        "contains_q": bool(fibres.contains([q[fibres.joint]])[0]),
        "length": float(fibres.length[0]),
        "intervals": [interval._asdict() for interval in fibres[0]],
        "blocked_by": [] if fibres[0] else blocking(robot, fibres.joint, q),
    }


def fibre_lines(fibres: Fibres, q: Sequence[float]) -> Iterator[str]:
    """Yield lines with the values between which the joint may move, and what ends each interval."""
    robot, joint = fibres.robot, fibres.robot.joints[fibres.joint]
    others = [j for j in range(len(q)) if j != fibres.joint]
    held = joint_text(robot, np.array(q)[others], others)
    yield f"{joint.name}{' with ' if held else ''}{held}"
    for interval in fibres[0]:
        low, high = (joint_amount(robot, joint, x) for x in interval[:2])
        ends = f"{low} ({interval.below}) to {high} ({interval.above})"
        yield f"  {'all the way round' if interval.below is None else ends}"
    if not fibres[0]:
        blocks = blocking(robot, fibres.joint, q)
        names = ", ".join(by_links(robot, blocks))
        yield "  nowhere" + (f"; whatever its value, violated: {names}" if names else "")
        if on_spheres(robot, blocks):
            yield f"  {SPHERES_ONLY}"
    yield from unchecked_lines(robot)


def by_links(robot: Robot, names: Sequence[str]) -> list[str]:
    """Sum up boundaries by pair of links, a few of them, and count the others."""
    pairs = {boundary.name: link_pair(robot, boundary) for boundary in robot.used}
    found = list(dict.fromkeys(pairs.get(name, name) for name in names))
    more = len(found) - MOST_SHOWN
    return found if more <= 0 else [*found[:MOST_SHOWN], f"{more} more"]


def blocking(robot: Robot, joint: int, q: Sequence[float]) -> list[str]:
    """Return the boundaries that are violated at every value of a joint, and others' limits."""
    balls, moving = Balls.of(robot), robot.joints[joint]
    c, a, b = balls.along(joint, q).T
    if moving.turns:
        most = c + np.hypot(a, b)
    else:  # a convex form is greatest at an end
        ends = np.array(moving.limits)[:, None]
        most = (c + a * ends + b * ends**2).max(axis=0)
    names = [name for name, x in zip(balls.names, most < -balls.rounding, strict=True) if x]
    for j, each in enumerate(robot.joints):
        if j != joint and each.limits is not None:
            low, high = each.limits
            names += [f"{each.name}.lower"] * (q[j] < low) + [f"{each.name}.upper"] * (q[j] > high)
    return names
