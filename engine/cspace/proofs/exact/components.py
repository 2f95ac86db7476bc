r"""The structure of a region of two joints, proved: its components, and the loops of each.

The plane is covered by cells on which the free set is empty or a star (`stars`), and so are the
lines between neighbouring cells. Stars are connected. A path that stays free passes from cell to
cell through free places of the lines between them; so the components of the free set are those of
the graph of cells whose common line holds a free place. Nothing is sampled: a component, however
small, is a cell.

Stars have no holes. So for each component the Euler characteristic is the number of cells less that
of the pieces of lines between them plus that of the corners between those (inclusion and
exclusion). The number of its boundary loops is :math:`2 - 2g - \chi`; g is 1 for a component that
goes round both joints independently and 0 for all others.

Joint limits bound the plane. A configuration at a limit counts as free here. This changes neither
the number of components nor the number of loops, because free places inside lie next to it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cspace.arrays import Floats, Ints
from cspace.forms.factors import whole_turns
from cspace.proofs import Unproved
from cspace.proofs.exact.problem import ExactProblem
from cspace.proofs.exact.stars import WHOLE, Stars, Undecided
from cspace.region import Component, Region
from qbound.circle import TURN

Steps = tuple[int, int]

NEAR = 1e-6
"""Gap, in rad or parts of a slide's range, within which arcs meet."""

BESIDE = 1e-7
"""Distance from an arc, in the same, at which one side is free and the other is not."""

OFF = 0.02
"""Largest distance of a proved place of the boundary from the legs of a proposed arc: legs are
chords, up to this far from a curve."""

MOST_TURNS = 10
"""Full turns from zero within which a configuration is looked up: taking them off errs by less than
``2**-46`` rad, because a double of a turn is right to ``2**-51`` and rounding takes ``2**-48``."""


@dataclass(frozen=True, eq=False)
class ProvedPart:
    """A component of the free configurations.

    Attributes
    ----------
    place : ndarray, shape (2,)
        A configuration in it; rad or length.
    wraps : tuple of two bool
        Whether it goes all the way round each joint.
    loops : int
        Number of closed curves of its boundary.
    """

    place: Floats
    wraps: tuple[bool, bool]
    loops: int


@dataclass(frozen=True, eq=False)
class SharedLines:
    """Lines that neighbouring cells share, or pieces of such lines, with free places on them.

    Attributes
    ----------
    cells : ndarray of int, shape (k, 2)
        The cell below and the one above.
    turns : ndarray of int, shape (k, 2)
        Full turns of each joint from the first cell to the second.
    low, high : ndarray of int, shape (k, 2)
        Both ends, in steps of the cell below.
    """

    cells: Ints
    turns: Ints
    low: Ints
    high: Ints


class Structure:
    """The plane of one problem covered by cells, and its components."""

    def __init__(self, problem: ExactProblem) -> None:
        if len(problem.kinds) != 2:
            raise ValueError(f"a region has two joints; here are {len(problem.kinds)}")
        try:
            self.stars = Stars(problem)
            every = self.stars.plane()
            self.cells = every[~every.blocked]
            self.lines = self._lines()
            self.corners = self._corners()
        except Undecided as error:
            raise Unproved(f"{error}: bodies touch there, or a gap has no width") from None
        self.part, self.cycles = self._parts()

    # --- lines and corners between cells --------------------------------------------------------

    def _lines(self) -> SharedLines:
        """Cover the lines between cells."""
        cells = self.cells
        found = np.array(list(self._neighbours()), dtype=np.int64).reshape(-1, 4, 2)
        pairs, turns, low, high = found.swapaxes(0, 1)
        both = cells.star[pairs].all(axis=1)
        fewer = [min((cells.contacts[k] for k in pair), key=len) for pair in pairs[both]]
        cut = self.stars.cut(low[both], high[both], fewer)
        open_lines = SharedLines(pairs[~both], turns[~both], low[~both], high[~both])
        self.pieces = cut[~cut.blocked]
        of = np.flatnonzero(both)[self.pieces.origin]
        return SharedLines(
            np.concatenate([open_lines.cells, pairs[of]]),
            np.concatenate([open_lines.turns, turns[of]]),
            np.concatenate([open_lines.low, self.pieces.low]),
            np.concatenate([open_lines.high, self.pieces.high]),
        )

    def _neighbours(self) -> Iterator[tuple[Steps, Steps, Steps, Steps]]:
        """Yield cells that share a line, the turns between them, and the line's ends."""
        low, high = self.cells.low.tolist(), self.cells.high.tolist()
        for joint, circle in enumerate(self.stars.circles):
            other = 1 - joint
            above = defaultdict(list)
            for k, corner in enumerate(low):
                above[corner[joint]].append((corner[other], k))
            below = defaultdict(list)
            for k, corner in enumerate(high):
                below[corner[joint]].append((low[k][other], k))
            for place, cells in below.items():
                wraps = circle and place == WHOLE
                facing = sorted(above[0 if wraps else place])
                turn = (int(wraps and joint == 0), int(wraps and joint == 1))
                first = 0
                for start, i in sorted(cells):
                    end = high[i][other]
                    while first < len(facing) and high[facing[first][1]][other] <= start:
                        first += 1
                    for begin, j in facing[first:]:
                        if begin >= end:
                            break
                        a, b = max(start, begin), min(end, high[j][other])
                        ends = ((place, a), (place, b)) if joint == 0 else ((a, place), (b, place))
                        yield (i, j), turn, *ends

    def _corners(self) -> dict[Steps, int]:
        """Return the free ends of lines, each with a cell that holds it."""
        ends = np.concatenate([self.lines.low, self.lines.high])
        owner = np.tile(self.lines.cells, (2, 1))
        places = {self._turned(end): k for k, end in enumerate(ends.tolist())}
        chosen = np.array(list(places.values()), dtype=np.int64)
        lists = [min((self.cells.contacts[c] for c in owner[k]), key=len) for k in chosen]
        cut = self.stars.cut(ends[chosen], ends[chosen], lists)
        free = np.zeros(len(chosen), dtype=np.bool_)
        free[cut.origin[~cut.blocked]] = True
        rows = zip(places.items(), free, strict=True)
        return {place: int(owner[k, 0]) for (place, k), is_free in rows if is_free}

    def _turned(self, corner: Sequence[int]) -> Steps:
        """Return a place in steps, on the first turn of each joint that turns all the way round."""
        one, other = (
            0 if circle and x == WHOLE else x
            for circle, x in zip(self.stars.circles, corner, strict=True)
        )
        return one, other

    def _is_within(self, corner: Steps) -> bool:
        """Tell whether a place is not at a joint limit."""
        pairs = zip(self.stars.circles, corner, strict=True)
        return all(circle or 0 < x < WHOLE for circle, x in pairs)

    # --- components -----------------------------------------------------------------------------

    def _parts(self) -> tuple[Ints, list[list[Ints]]]:
        """Return the component of each cell, and the turns of all cycles of each component."""
        count = len(self.cells)
        links: list[list[tuple[int, Ints]]] = [[] for _ in range(count)]
        for (i, j), turn in zip(self.lines.cells.tolist(), self.lines.turns, strict=True):
            links[i].append((j, turn))
            links[j].append((i, -turn))
        part, turned = np.full(count, -1), np.zeros((count, 2), dtype=np.int64)
        cycles: list[list[Ints]] = []
        for start in range(count):
            if part[start] >= 0:
                continue
            part[start], left = len(cycles), [start]
            cycles.append([])
            while left:
                i = left.pop()
                for j, turn in links[i]:
                    if part[j] < 0:
                        part[j], turned[j] = part[i], turned[i] + turn
                        left.append(j)
                    elif (around := turned[i] + turn - turned[j]).any():
                        cycles[-1].append(around)
        return part, cycles

    def parts(self) -> list[ProvedPart]:
        """Return the components."""
        count = len(self.cycles)
        within = [owner for corner, owner in self.corners.items() if self._is_within(corner)]
        cells, lines, corners = (
            np.bincount(self.part[np.array(own, dtype=np.int64)], minlength=count)
            for own in (np.arange(len(self.cells)), self.lines.cells[:, 0], within)
        )
        found = []
        for k, around in enumerate(self.cycles):
            turns = np.array(around, dtype=np.int64).reshape(-1, 2)
            wraps = bool(turns[:, 0].any()), bool(turns[:, 1].any())
            across = np.outer(turns[:, 0], turns[:, 1])
            genus = int((across != across.T).any())
            loops = 2 - 2 * genus - int(cells[k] - lines[k] + corners[k])
            place = self.cells.middle[int((self.part == k).argmax())]
            found.append(ProvedPart(place, wraps, loops))
        return found

    def part_of(self, q: Floats) -> int:
        """Return the component of a configuration, shape (2,); -1 if it is not proved free.

        Cells are proved with a rim as wide as rounding (`stars.ROUNDING`). The rounding of full
        turns has to stay within this rim, so nothing is proved about a configuration more than
        `MOST_TURNS` away.
        """
        stars, cells = self.stars, self.cells
        for joint, circle in enumerate(stars.circles):
            if circle:
                if abs(q[joint]) > MOST_TURNS * TURN:
                    return -1
                q = q.copy()
                q[joint] = stars.first[joint] + (q[joint] - stars.first[joint]) % TURN
        low, high = stars.places(cells.low), stars.places(cells.high)
        for k in np.flatnonzero(((low <= q) & (q <= high)).all(axis=1)).tolist():
            pairs = np.unique(stars.pair[cells.contacts[k]])
            if (stars.signs(np.tile(q, (len(pairs), 1)), pairs) > 0).all():
                return int(self.part[k])
        return -1

    # --- where the boundary is ------------------------------------------------------------------

    def crossed(self) -> tuple[Floats, Ints]:
        """Return every place where the boundary crosses a line between cells, with its component.

        A piece of a line is a star, so the boundary is crossed once between its free place and an
        end that is not free. The crossing is found by halving, in doubles.
        """
        owner = self.part[self.lines.cells[:, 0]]
        uncut = len(owner) - len(self.pieces)
        places, owners = [], []
        for ends in (self.lines.low, self.lines.high):
            corners = [self._turned(end) for end in ends.tolist()]
            free = np.array([corner in self.corners for corner in corners], dtype=np.bool_)
            within = np.array([self._is_within(corner) for corner in corners], dtype=np.bool_)
            shut, at_limit = np.flatnonzero(~free), np.flatnonzero(free & ~within)
            place = self.stars.places(ends)
            places += [place[at_limit], self._between(shut - uncut, place[shut])]
            owners += [owner[at_limit], owner[shut]]
        return np.concatenate(places), np.concatenate(owners)

    def _between(self, shut: Ints, ends: Floats) -> Floats:
        """Return where free places end on the way from the middle of pieces to one end."""
        lists = [np.unique(self.stars.pair[self.pieces.contacts[k]]) for k in shut]
        which = np.repeat(np.arange(len(shut)), [len(pairs) for pairs in lists])
        pairs = np.concatenate([np.zeros(0, dtype=np.int64), *lists])
        free = self.pieces.middle[shut]
        for _ in range(30):
            middle = (free + ends) / 2
            hit = np.zeros(len(shut), dtype=np.bool_)
            hit[which[self.stars.signs(middle[which], pairs) <= 0]] = True
            free, ends = np.where(hit[:, None], free, middle), np.where(hit[:, None], middle, ends)
        return ends


def prove_structure(problem: ExactProblem, region: Region) -> tuple[ProvedPart, ...]:
    """Prove that a region has exactly the proposed components; not in the paper.

    The proof covers the number of components, the loops of each component, the joints that it goes
    round, and which proposed component it is. The proposed arcs are compared with the proof: each
    has the component on its left and nothing free on its right, and an arc is near each place where
    the boundary crosses a line between cells.

    Parameters
    ----------
    problem : ExactProblem
        Of two joints, of any kinds, with bodies or without.
    region : Region
        The result of `find_region` for the same robot in floats.

    Returns
    -------
    tuple of ProvedPart
        In the order of the region's components.

    Raises
    ------
    Unproved
        The message names the first thing that is not proved or differs from the proposal.
    ValueError
        If the problem does not have two joints, or a number is beyond the range of a double.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> from cspace.proofs.exact.problem import exact_problem, exact_robot
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> parts = prove_structure(exact_problem(exact_robot("minervabot-v2")), region)
    >>> [part.loops for part in parts]
    [1, 1, 1, 1, 1]
    """
    structure = Structure(problem)
    parts, proposed = structure.parts(), region.components
    if len(parts) != len(proposed):
        raise Unproved(f"{len(proposed)} components are proposed, {len(parts)} are proved")
    numbers = [_number(structure, component) for component in proposed]
    for k, (number, component) in enumerate(zip(numbers, proposed, strict=True)):
        part = parts[number]
        if number in numbers[:k]:
            raise Unproved("two proposed components are proved to be one")
        if part.loops != len(component.loops):
            raise Unproved(f"{len(component.loops)} loops are proposed, {part.loops} are proved")
        if part.wraps != component.wraps:
            raise Unproved("a component does not go round the joints that are proposed")
    places, owners = structure.crossed()
    for number, component in zip(numbers, proposed, strict=True):
        _near(structure, component, places[owners == number])
    return tuple(parts[number] for number in numbers)


def _number(structure: Structure, component: Component) -> int:
    """Return the proved component that lies along proposed arcs, on their left."""
    found = set()
    for loop in component.loops:
        for arc, after in zip(loop, [*loop[1:], loop[0]], strict=True):
            gap = _scaled(structure, arc.points[-1] - after.points[0], turned=True)
            if np.abs(gap).max() > NEAR:
                raise Unproved(f"{arc.boundary}: no arc goes on at ({_shown(arc.points[-1])})")
            for place, left in _beside(structure, arc.points):
                found.add(structure.part_of(place + left))
                if -1 in found or structure.part_of(place - left) >= 0:
                    raise Unproved(f"{arc.boundary}: no boundary at ({_shown(place)})")
    if not component.loops and len(structure.cycles) == 1:
        return 0
    if len(found) != 1:
        raise Unproved("a proposed component is none, or is more than one")
    return found.pop()


def _beside(structure: Structure, points: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Yield a few inner places of an arc, with a small step to its left."""
    if len(points) == 2:
        points = np.array([points[0], points.mean(axis=0), points[1]])
    scale = _scale(structure)
    for k in sorted({round(part * (len(points) - 1)) for part in (0.3, 0.5, 0.7)}):
        along = (points[k + 1] - points[k - 1]) / scale
        if (length := np.hypot(*along)) > 10 * BESIDE:
            yield points[k], BESIDE / length * np.array([-along[1], along[0]]) * scale


def _near(structure: Structure, component: Component, places: Floats) -> None:
    """Refuse a component with a place on its boundary that no arc is near."""
    none = np.zeros((0, 2))
    lines = [dense(arc.points, 64) for loop in component.loops for arc in loop]
    start = np.concatenate([none, *(line[:-1] for line in lines)])
    end = np.concatenate([none, *(line[1:] for line in lines)])
    along = _scaled(structure, end - start, turned=False)
    length = np.hypot(*along.T)
    for place in places:
        away = _scaled(structure, place - start, turned=True)
        part = np.clip((away * along).sum(axis=1) / np.maximum(length, 1e-300) ** 2, 0, 1)
        gap = np.hypot(*(away - part[:, None] * along).T)
        if not (gap < np.minimum(length / 4, OFF) + NEAR).any():
            raise Unproved(f"a piece of boundary at ({_shown(place)}) is not proposed")


def dense(points: Floats, most: int) -> Floats:
    """Insert places into legs of a polyline that are longer than 1, up to a number for each leg."""
    steps = np.ceil(np.abs(np.diff(points, axis=0)).max(axis=1)).clip(1, most).astype(int)
    pieces = [
        a + (b - a) * np.arange(n)[:, None] / n
        for a, b, n in zip(points[:-1], points[1:], steps, strict=True)
    ]
    return np.concatenate([*pieces, points[-1:]])


def _scale(structure: Structure) -> Floats:
    """Return the unit of each joint's steps: a radian, or a slide's whole range."""
    turns = np.array([kind == "revolute" for kind in structure.stars.kinds])
    return np.where(turns, 1.0, structure.stars.last - structure.stars.first)


def _scaled(structure: Structure, step: Floats, *, turned: bool) -> Floats:
    """Return steps, (..., 2), in these units; the shortest way where a joint turns all the way."""
    if turned:
        step = step - TURN * np.where(structure.stars.circles, whole_turns(step), 0.0)
    return np.asarray(step / _scale(structure))


def _shown(place: Floats) -> str:
    return ", ".join(f"{x:.6g}" for x in place)
