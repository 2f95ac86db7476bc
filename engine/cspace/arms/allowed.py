r"""Allowed collision matrix: pairs of links that meet never or always, with proof.

Other programs draw ten thousand poses and call a pair that was in contact in none of them "never".
Here the proofs use cells that fill the ranges of the joints between both links. The spheres of two
links meet "never" if every form has a bound above zero in each cell, "always" if in each cell one
form has a bound below zero, and "sometimes" if there are two configurations, one with contact and
one without. The bounds are those of `cspace.proofs.exact.bounds` and include rounding. Not in the
paper, whose Table 6 has the case of one joint.

Spheres cover the links and stick out of them. So links whose spheres never meet never meet. That
spheres meet says nothing about the links. Links always meet if a place is inside both at all joint
values: balls that lie inside the shapes (`cspace.urdf.arm.balls_inside`), one of each link, always
overlap. Without the shapes this is not proved.

The forms of two links are those of all pairs of their spheres,
:math:`\beta_{ij} = |B_{ij}|^2 - (r_i + r_j)^2` (eq. 11 without a clearance), in the joints between
both links' frames. If a form does not change with a joint except by rounding, the joint is left
out, and a ball in the constant holds the rounding. A search in floats finds where links come
closest: along one joint every form has its least value in closed form, joint after joint, from the
best of many random configurations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, Final
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from cspace.arms.links import Link, left_out_lines, links
from cspace.arrays import Bools, Floats
from cspace.boundary.balls import Balls
from cspace.boundary.evaluator import stacked
from cspace.export.formats import heading
from cspace.files import MADE
from cspace.forms.harmonic import add_constant
from cspace.model.robot import Joint, Pair, Point, Robot
from cspace.model.robotfile import load_robot
from cspace.printable import printable
from cspace.proofs import Verdict
from cspace.proofs.exact.bounds import BITS, DEEPEST, BoxBounds, Cells, magnitude
from cspace.proofs.exact.numbers import above, arb, ball, balls, below, pi, precision
from cspace.proofs.exact.problem import exact_robot
from cspace.sampling import joint_ranges
from cspace.tolerances import ZERO_AMPLITUDE
from cspace.units import counted, joint_text, joint_units
from qbound.circle import TURN
from qbound.forms import HarmonicForm, Kind, basis

CELLS: Final = 1_000_000
"""Cells at which the search for a proof about two links ends."""


class Contact(StrEnum):
    """What is proved of two links, over the whole joint space."""

    NEVER = "never"
    ALWAYS = "always"
    UNPROVED = "not proved"


class Spheres(StrEnum):
    """Whether the spheres that cover two links meet, over the whole joint space."""

    NEVER = "never"
    ALWAYS = "always"
    SOMETIMES = "sometimes"
    UNDECIDED = "not decided"


@dataclass(frozen=True, eq=False)
class LinkContact:
    """The answer for two links, with its evidence.

    Attributes
    ----------
    links : tuple of str
        Names of the links, the one nearer to the base first.
    contact : Contact
        What is proved of the links themselves.
    spheres : Spheres
        What the balls that cover them do; two balls that touch are in contact.
    neighbours : bool
        Whether at most one joint lies between their frames.
    joints : tuple of int
        The joints that change the distance of at least one pair of balls.
    balls : tuple of str
        The two balls that were found nearest to each other.
    nearest : ndarray, shape (n,)
        Configuration of the whole arm at which they were found, rad and length. It is verified
        where the spheres meet sometimes.
    gap : float
        Length between the surfaces of these balls there; negative by the depth where they overlap.
    apart : ndarray or None, shape (n,)
        A configuration without contact, verified; None where there is none, or none was found.
    proved_gap : float or None
        For "never": a lower bound of the distance of all pairs of balls; length.
    cells : int
        Cells that were bounded, for the spheres.
    """

    links: tuple[str, str]
    contact: Contact
    spheres: Spheres
    neighbours: bool
    joints: tuple[int, ...]
    balls: tuple[str, str]
    nearest: Floats
    gap: float
    apart: Floats | None = None
    proved_gap: float | None = None
    cells: int = 0


def allowed_collisions(
    robot: Robot | str | Path,
    *,
    inside: Sequence[Point] = (),
    cells: int = CELLS,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[LinkContact, ...]:
    """Prove of every two links, covered by balls, that they meet never or always, where they do.

    All pairs of links are taken, neighbours and those without a boundary in the file included, over
    all values of the joints within their limits; a joint without limits turns all the way round.

    Parameters
    ----------
    robot : Robot, str or Path
        What `load_robot` takes: each decimal of a file counts as it is written. Or a robot, whose
        doubles count as the binary fractions that they are.
    inside : sequence of Point
        Balls that lie inside the links' shapes, named LINK/k, as `cspace.urdf.arm.balls_inside`
        returns them. Without them "always" is proved of no pair.
    cells : int
        Largest number of cells for one pair of links; beyond it the pair stays undecided. A larger
        number decides more pairs and takes longer.
    progress : callable
        Told how many pairs are done, of how many.

    Returns
    -------
    tuple of LinkContact
        In the order of the links, from the base outwards.

    Raises
    ------
    ValueError
        As `load_robot`, and if the links are not made of balls (`cspace.arms.links.links`).

    Examples
    --------
    Two fingers on one wheel, a quarter turn apart, and a post that one of them may meet:

    >>> import numpy as np
    >>> from cspace.model.robot import Point, Revolute, Robot
    >>> z = np.array([0.0, 0.0, 1.0])
    >>> wheel = Revolute("turn", "table", "wheel", origin=np.zeros(3), axis=z)
    >>> places = {"long/1": [0.5, 0, 0], "short/1": [0, 0.2, 0]}
    >>> balls = [Point(name, "wheel", np.array(at), 0.0625) for name, at in places.items()]
    >>> post = Point("post/1", "table", np.array([0.5, 0.0, 0.0]), 0.0625)
    >>> points, home = (post, *balls), np.zeros(1)
    >>> arm = Robot("fingers", "m", (wheel,), points, (), "long/1", home, angle_unit="rad")
    >>> for found in allowed_collisions(arm):
    ...     print(*found.links, found.contact, "- spheres:", found.spheres)
    post long not proved - spheres: sometimes
    post short never - spheres: never
    long short never - spheres: never
    """
    plain = robot if isinstance(robot, Robot) else load_robot(robot)
    exact = exact_robot(plain)
    inner = _InnerLinks(plain, inside)
    pairs = list(combinations(links(exact), 2))
    found: list[LinkContact] = []
    for one, other in pairs:
        progress(len(found), len(pairs))
        found.append(_decided(plain, exact, (one, other), inner, cells))
    progress(len(pairs), len(pairs))
    return tuple(found)


def _decided(
    robot: Robot, exact: Robot, pair: tuple[Link, Link], inner: _InnerLinks, cells: int
) -> LinkContact:
    """Decide one pair of links."""
    forms = pair_forms(exact, *pair)
    seen, spheres, proved, opened = _searched(forms, cells)
    nearest = seen.nearest if seen.touching is None else seen.touching
    contact = Contact.NEVER if spheres is Spheres.NEVER else Contact.UNPROVED
    if spheres is Spheres.ALWAYS and inner.always_meet(pair[0].name, pair[1].name, cells):
        contact = Contact.ALWAYS
    return LinkContact(
        links=(pair[0].name, pair[1].name),
        contact=contact,
        spheres=spheres,
        neighbours=abs(pair[0].depth - pair[1].depth) <= 1,
        joints=forms.joints,
        balls=forms.names[seen.form],
        nearest=_whole(robot, forms, nearest),
        gap=seen.gap,
        apart=None if seen.apart is None else _whole(robot, forms, seen.apart),
        proved_gap=proved,
        cells=opened,
    )


def _searched(forms: PairForms, most: int) -> tuple[Witnesses, Spheres, float | None, int]:
    """Look for witnesses of contact and of no contact; prove that a missing one cannot exist."""
    samples = random_configurations(forms)
    seen = Witnesses.of(forms, np.concatenate([samples, closest(forms, samples)]))
    opened = 0
    while seen.touching is None or seen.apart is None:
        left = most - opened
        gap = max(seen.gap, 0) / 2
        never = seen.touching is None
        answer = apart_everywhere(forms, gap, left) if never else touching_everywhere(forms, left)
        opened += answer.cells
        if answer.verdict is Verdict.PROVED:
            return seen, *((Spheres.NEVER, gap) if never else (Spheres.ALWAYS, None)), opened
        before = seen
        seen = before if answer.place is None else before.with_place(forms, answer.place)
        if seen is before:
            return seen, Spheres.UNDECIDED, None, opened
    return seen, Spheres.SOMETIMES, None, opened


def _whole(robot: Robot, forms: PairForms, q: Floats) -> Floats:
    """Return a configuration of the arm, with joints that do not matter at home or mid-range."""
    whole = np.array(robot.home, dtype=float)
    for j, joint in enumerate(robot.joints):
        if joint.limits is not None and not joint.limits[0] <= whole[j] <= joint.limits[1]:
            whole[j] = sum(joint.limits) / 2
    whole[list(forms.joints)] = q
    return whole


# --- balls inside the links -----------------------------------------------------------------------


POSES = 64
"""Random configurations at which balls inside two links have to overlap before a proof is tried."""


class _InnerLinks:
    """Links made of balls that lie inside their shapes, and places of their centres.

    The places are at random configurations, shape (POSES, k, 3), seen from the base; length.
    """

    def __init__(self, robot: Robot, inside: Sequence[Point]) -> None:
        self.links, self.places = dict[str, Link](), dict[str, Floats]()
        if not inside:
            return
        low, high = joint_ranges(robot).T
        q = np.random.default_rng(0).uniform(low, high, (POSES, len(low)))
        inner = replace(robot, points=tuple(inside), boundaries=())
        centres, self.robot = Balls.of(inner).centres(q), exact_robot(inner)
        order = {ball.name: k for k, ball in enumerate(inside)}
        for link in links(self.robot):
            self.links[link.name] = link
            self.places[link.name] = centres[:, [order[ball.name] for ball in link.balls]]

    def always_meet(self, one: str, other: str, cells: int) -> bool:
        """Prove that one ball of each link overlap at all joint values: so the links meet."""
        if one not in self.links or other not in self.links:
            return False
        near, far = self.links[one], self.links[other]
        apart = np.linalg.norm(self.places[one][:, :, None] - self.places[other][:, None], axis=-1)
        radii = [np.array([float(ball.radius) for ball in link.balls]) for link in (near, far)]
        widest = (apart - radii[0][:, None] - radii[1]).max(axis=0)
        k, m = np.unravel_index(widest.argmin(), widest.shape)
        if widest[k, m] >= 0:
            return False
        single = (
            replace(near, balls=near.balls[k : k + 1]),
            replace(far, balls=far.balls[m : m + 1]),
        )
        return touching_everywhere(pair_forms(self.robot, *single), cells).verdict is Verdict.PROVED


# --- the distance of two links, as forms ----------------------------------------------------------


Ends = tuple[tuple[arb, arb], ...]


@dataclass(frozen=True, eq=False)
class PairForms:
    """Clearance forms of all pairs of balls of two links.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        Exact coefficients or balls, in the joints that matter.
    joints : tuple of int
        These joints, by index of the robot.
    ends : tuple of (arb, arb)
        Ranges of these joints; one turn if the range is wider.
    names : tuple of (str, str)
        The balls of each form.
    distances : ndarray, shape (m,)
        Sum of both radii, length.
    """

    forms: HarmonicForm
    joints: tuple[int, ...]
    ends: Ends
    names: tuple[tuple[str, str], ...]
    distances: Floats

    @cached_property
    def floats(self) -> HarmonicForm:
        """The forms in floats."""
        with precision(BITS):
            coefficients = balls(self.forms.coefficients).astype(float)
        return HarmonicForm(coefficients, self.forms.kinds)

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """The ranges in floats, rounded inward, shape (n,) each."""
        with precision(BITS):
            low = [above(a) for a, _ in self.ends]
            high = [below(b) for _, b in self.ends]
        return np.array(low), np.array(high)

    def single(self, k: int) -> PairForms:
        """Return one form alone, in the joints that matter to it."""
        one = replace(
            self, forms=self.forms[[k]], names=self.names[k : k + 1], distances=self.distances[[k]]
        )
        return _without_idle(one)

    def values(self, q: Floats) -> Floats:
        """Return the value of every form in floats, shape (N, n) to (N, m)."""
        return np.broadcast_to(self.floats(q), (len(q), len(self.names)))

    def gaps(self, q: Floats) -> Floats:
        """Return the distances between the balls' surfaces, shape (N, n) to (N, m).

        Negative by the depth where balls overlap; length. For searching only; `gap` is exact.
        """
        d = self.distances
        return np.asarray(np.sqrt(np.maximum(self.values(q) + d * d, 0)) - d)

    def gap(self, q: Floats, k: int) -> float:
        """Return the distance between the surfaces of two balls at one configuration; length.

        The result is right to the last digits. In floats (`gaps`) the distance of two balls with
        one middle is off by the square root of rounding, because the terms of the squared distance
        cancel.
        """
        with precision(BITS):
            place = np.array([ball(x) for x in q.tolist()], dtype=object)
            d = ball(self.distances[k])
            squared = float(np.ravel(balls(self.forms[[k]](place)))[0] + d * d)
        return math.sqrt(max(squared, 0.0)) - float(self.distances[k])

    def exact(self, q: Floats) -> list[arb]:
        """Enclose the value of every form at one configuration, which counts as it is written."""
        with precision(BITS):
            place = np.array([ball(x) for x in q.tolist()], dtype=object)
            return list(np.atleast_1d(balls(self.forms(place))))

    def contains(self, q: Floats) -> bool:
        """Tell whether a configuration is certainly within the ranges."""
        with precision(BITS):
            ends = zip(self.ends, q.tolist(), strict=True)
            return all(bool(low <= ball(x)) and bool(ball(x) <= high) for (low, high), x in ends)


def pair_forms(robot: Robot, one: Link, other: Link) -> PairForms:
    """Return the forms of two links of an exact robot (`proofs.exact.problem.exact_robot`).

    Only the joints between two frames matter, so the chain is cut to a shorter arm. Seen from the
    bar of a parallelogram, the frame that its own joint carries turns back; so the cut is before
    that joint.
    """
    near, far = sorted((one, other), key=lambda link: (link.depth, not _is_bar(robot, link)))
    first = near.depth - (near.frame != far.frame and _is_bar(robot, near))
    joints = robot.joints[first : far.depth]
    pairs = [Pair("", (a.name, b.name), 0) for a in near.balls for b in far.balls]
    if not joints:
        return _at_rest(near, far)
    arm = replace(robot, joints=joints, points=(*near.balls, *far.balls), boundaries=())
    with precision(BITS):
        found = PairForms(
            forms=stacked(arm, pairs),
            joints=tuple(range(first, far.depth)),
            ends=tuple(_ends(joint) for joint in joints),
            names=tuple(pair.points for pair in pairs),
            distances=np.array([float(arm.required_distance(pair)) for pair in pairs]),
        )
    return _without_idle(found)


def _is_bar(robot: Robot, link: Link) -> bool:
    """Tell whether a link is the turning bar of a parallelogram."""
    return link.depth > 0 and link.frame != robot.joints[link.depth - 1].frame


def _at_rest(one: Link, other: Link) -> PairForms:
    """Return the forms of two links fixed to one frame: they are constants."""
    pairs = [(a, b) for a in one.balls for b in other.balls]
    values = [(a.at - b.at) @ (a.at - b.at) - (a.radius + b.radius) ** 2 for a, b in pairs]
    return PairForms(
        forms=HarmonicForm(np.array(values, dtype=object), ()),
        joints=(),
        ends=(),
        names=tuple((a.name, b.name) for a, b in pairs),
        distances=np.array([float(a.radius + b.radius) for a, b in pairs]),
    )


def _ends(joint: Joint) -> tuple[arb, arb]:
    """Return a joint's range; one turn within it if the joint turns by a turn or more."""
    if joint.limits is None:
        return -pi(), pi()
    low, high = map(ball, joint.limits)
    if not (joint.turns and high - low >= 2 * pi()):
        return low, high
    return (-pi(), pi()) if low <= -pi() and pi() <= high else (low, low + 2 * pi())


def _without_idle(pair: PairForms) -> PairForms:
    """Leave out joints that change no form beyond rounding; the constants take in that rounding."""
    forms, kept = pair.forms, list(range(len(pair.joints)))
    with precision(BITS):
        reach = [max(above(abs(low)), above(abs(high))) for low, high in pair.ends]
        for j in reversed(range(len(kept))):
            axis = len(forms.stack) + j
            still, moving = np.split(forms.coefficients, [1], axis=axis)
            rest = np.concatenate([0 * still, moving], axis=axis)
            change = magnitude(HarmonicForm(rest, forms.kinds), reach)
            if (change <= ZERO_AMPLITUDE * magnitude(forms, reach)).all():
                kinds = forms.kinds[:j] + forms.kinds[j + 1 :]
                slack = np.array([ball(0).union(x).union(-x) for x in map(ball, change.tolist())])
                forms = HarmonicForm(add_constant(still.squeeze(axis), slack), kinds)
                del kept[j], reach[j]
    return replace(
        pair,
        forms=forms,
        joints=tuple(pair.joints[j] for j in kept),
        ends=tuple(pair.ends[j] for j in kept),
    )


# --- where two links are nearest ------------------------------------------------------------------


Ints = NDArray[np.intp]

SAMPLES = 2048
"""Random configurations of a pair of links."""

STARTS = 3
"""Of these, the starts for each pair of balls."""

SWEEPS = 40
"""Times that every joint is moved to where the form is least."""


@dataclass(frozen=True, eq=False)
class Witnesses:
    """The nearest configuration and the witnesses that a search found for a pair of links.

    Attributes
    ----------
    nearest : ndarray, shape (n,)
        Where two balls were nearest, by floats.
    form : int
        Index of the form of these two balls.
    gap : float
        Distance between their surfaces; length.
    touching, apart : ndarray or None, shape (n,)
        Configurations with contact and without, verified in exact numbers.
    """

    nearest: Floats
    form: int
    gap: float
    touching: Floats | None = None
    apart: Floats | None = None

    @classmethod
    def of(cls, pair: PairForms, places: Floats) -> Witnesses:
        """Look at configurations, shape (N, n)."""
        gaps = pair.gaps(places)
        at, form = np.unravel_index(gaps.argmin(), gaps.shape)
        nearest, farthest = places[at], places[gaps.min(axis=1).argmax()]
        found = cls(nearest, int(form), pair.gap(nearest, int(form)))
        return replace(
            found,
            touching=nearest if _touches(pair, nearest) else None,
            apart=farthest if _keeps_apart(pair, farthest) else None,
        )

    def with_place(self, pair: PairForms, place: Floats) -> Witnesses:
        """Look at one more configuration and at the closest approach that a descent from it finds.

        Returns the same object if nothing better is found.
        """
        which = np.arange(len(pair.names))
        more = descended(pair, np.repeat(place[None], len(which), axis=0), which)
        new = Witnesses.of(pair, np.concatenate([place[None], more]))
        best = new if new.gap < self.gap else self
        touching = new.touching if self.touching is None else self.touching
        apart = new.apart if self.apart is None else self.apart
        if best is self and touching is self.touching and apart is self.apart:
            return self
        return replace(best, touching=touching, apart=apart)


def _touches(pair: PairForms, q: Floats) -> bool:
    return pair.contains(q) and any(bool(value <= 0) for value in pair.exact(q))


def _keeps_apart(pair: PairForms, q: Floats) -> bool:
    return pair.contains(q) and all(bool(value > 0) for value in pair.exact(q))


def random_configurations(pair: PairForms) -> Floats:
    """Return configurations within the ranges of the joints that matter, shape (N, n)."""
    low, high = pair.box
    return np.asarray(low + (high - low) * np.random.default_rng(0).random((SAMPLES, len(low))))


def closest(pair: PairForms, samples: Floats) -> Floats:
    """Return configurations at which each form is low, one after the other, shape (STARTS m, n).

    These are the best samples, moved joint by joint as long as a form falls.
    """
    order = np.argsort(pair.values(samples), axis=0)[:STARTS]  # (STARTS, m)
    which = np.broadcast_to(np.arange(order.shape[1]), order.shape).ravel()
    return descended(pair, samples[order.ravel()], which)


def descended(pair: PairForms, q: Floats, which: Ints) -> Floats:
    """Move each configuration, joint by joint, to where its form is least, shape (N, n).

    Parameters
    ----------
    which : ndarray of int, shape (N,)
        The form of each configuration.
    """
    q = np.array(q, dtype=float)
    forms = pair.floats[which]
    low, high = pair.box
    for _ in range(SWEEPS):
        before = q.copy()
        for j in range(q.shape[1]):
            along = along_each(forms, j, q)
            q[:, j] = least_place(pair.floats.kinds[j], along, low[j], high[j])
        if np.allclose(q, before, rtol=0, atol=1e-9):
            break
    return q


def along_each(forms: HarmonicForm, joint: int, q: Floats) -> Floats:
    """Return the coefficients of form k along a joint at configuration k, shape (N, 3)."""
    result = np.moveaxis(forms.coefficients, joint + 1, 1)
    for j in reversed([j for j in range(q.shape[1]) if j != joint]):
        result = np.einsum("n...c,nc->n...", result, basis(forms.kinds[j], q[:, j]))
    return np.asarray(result)


def least_place(kind: Kind, along: Floats, low: float, high: float) -> Floats:
    """Return where one-joint forms are least between two limits, shape (N,) (eqs. 30-36).

    Parameters
    ----------
    along : ndarray, shape (N, 3)
        Coefficients on (1, cos q, sin q) or (1, q, q²).
    """
    c1, c2 = along[:, 1], along[:, 2]
    if kind == "revolute":
        inner = np.arctan2(-c2, -c1)
        inner = inner + TURN * np.ceil((low - inner) / TURN)
    else:
        inner = np.divide(-c1, 2 * c2, out=np.full(len(c1), low), where=c2 > 0)
    ends = np.stack([np.full(len(c1), low), np.full(len(c1), high), np.clip(inner, low, high)])
    values = np.einsum("kni,ni->kn", basis(kind, ends), along)
    best = values.argmin(axis=0)
    return np.asarray(ends[best, np.arange(len(c1))])


# --- proofs over all cells ------------------------------------------------------------------------


BATCH: Final = 8192
"""Cells that are bounded at a time."""


@dataclass(frozen=True, eq=False)
class Answer:
    """Outcome of a search for a proof over all cells.

    Attributes
    ----------
    verdict : Verdict
    cells : int
        Number of cells that were bounded.
    place : ndarray or None, shape (n,)
        If refuted: a configuration that refutes, by its value in floats.
    """

    verdict: Verdict
    cells: int
    place: Floats | None = None


def apart_everywhere(pair: PairForms, gap: float, most: int) -> Answer:
    """Prove that all pairs of balls keep a gap over the whole ranges; each pair has its own cells.

    Parameters
    ----------
    gap : float
        Length, 0 or more.
    most : int
        Cells that are bounded at most.
    """
    total = 0
    for k in np.argsort(pair.gaps(_middle(pair)[None])[0]):
        one = pair.single(int(k))
        with precision(BITS):  # positive where the balls keep the gap
            asked = [(ball(d) + ball(gap)) ** 2 - ball(d) ** 2 for d in one.distances.tolist()]
            forms = one.forms - np.array(asked, dtype=object)
        lowered = replace(one, forms=HarmonicForm(forms.coefficients, one.forms.kinds))
        answer = _over_cells(lowered, most - total, apart=True)
        total += answer.cells
        if answer.verdict is not Verdict.PROVED:
            q = _middle(pair)
            if answer.place is not None:
                q[[pair.joints.index(j) for j in one.joints]] = answer.place
            return replace(answer, cells=total, place=None if answer.place is None else q)
    return Answer(Verdict.PROVED, total)


def touching_everywhere(pair: PairForms, most: int) -> Answer:
    """Prove that in each cell of the ranges some pair of balls overlaps, not always the same."""
    return _over_cells(pair, most, apart=False)


def _over_cells(pair: PairForms, most: int, *, apart: bool) -> Answer:
    """Halve cells until each proves, or the centre of one refutes."""

    def told(low: Floats, high: Floats) -> tuple[Bools, Bools]:
        if apart:
            return np.asarray((low > 0).all(axis=1)), np.asarray((low + high < 0).any(axis=1))
        return np.asarray((high < 0).any(axis=1)), np.asarray((low + high > 0).all(axis=1))

    if not pair.joints:  # no joint changes the forms
        signs = np.array([[float(x > 0) - float(x < 0) for x in pair.exact(np.empty(0))]])
        proved, refuted = told(signs, signs)
        return Answer(Verdict.of(bool(proved[0]), bool(refuted[0])), 1, np.empty(0))
    bounds = BoxBounds(pair.forms, pair.ends)
    cells, opened = bounds.whole(), 0
    while len(cells):
        if opened + len(cells) > most or cells.level >= DEEPEST * len(pair.joints):
            return Answer(Verdict.UNDECIDED, opened)
        opened += len(cells)
        left = []
        for part in (cells[k : k + BATCH] for k in range(0, len(cells), BATCH)):
            proved, refuted = told(*bounds.bounds(part))
            if refuted.any():
                low, high = bounds.places(part[refuted][:1])
                return Answer(Verdict.REFUTED, opened, (low[0] + high[0]) / 2)
            left.append(part.index[~proved])
        cells = Cells(cells.level, np.concatenate(left)).halves()
    return Answer(Verdict.PROVED, opened)


def _middle(pair: PairForms) -> Floats:
    low, high = pair.box
    return np.asarray((low + high) / 2)


# --- as others read it: JSON, a table, and the SRDF of motion planners ----------------------------


SHOWN_DIGITS = 4
"""Of lengths in a table."""


def allowed_document(robot: Robot, contacts: Sequence[LinkContact]) -> dict[str, Any]:
    """Return the JSON form of contacts, schema qbound/allowed/2: rad, the file's unit of length."""
    missing = {"left_out": {"pairs": [], "links": list(robot.left_out)}}  # all pairs are looked at
    return {
        **heading("qbound/allowed/2", robot, missing if robot.left_out else {}),
        "joints": [joint.name for joint in robot.joints],
        "units": {"joints": joint_units(robot), "length": robot.length_unit},
        "pairs": [_entry(robot, each) for each in contacts],
    }


def _entry(robot: Robot, contact: LinkContact) -> dict[str, Any]:
    witness = contact.spheres is Spheres.SOMETIMES
    return {
        "links": list(contact.links),
        "contact": contact.contact.value,
        "spheres": contact.spheres.value,
        "neighbours": contact.neighbours,
        "joints": [robot.joints[j].name for j in contact.joints],
        "balls": list(contact.balls),
        "nearest": contact.nearest.tolist(),
        "gap": contact.gap,
        "proved_gap": contact.proved_gap,
        "touching": contact.nearest.tolist() if witness else None,
        "apart": contact.apart.tolist() if witness and contact.apart is not None else None,
        "cells": contact.cells,
    }


def allowed_lines(robot: Robot, contacts: Sequence[LinkContact]) -> Iterator[str]:
    """Yield a table of what is proved of the links, and what else their spheres do; the counts."""
    rows = [(", ".join(map(printable, each.links)), each) for each in contacts]
    wide = max((len(name) for name, _ in rows), default=0)
    for name, each in rows:
        yield f"{name:{wide}}  {each.contact.value:<10}  {evidence(robot, each)}"
    counts = {word: sum(each.contact is word for each in contacts) for word in Contact}
    unproved = counts.pop(Contact.UNPROVED)
    parts = [f"{count} {word.value} in contact" for word, count in counts.items() if count]
    parts += [f"{unproved} not proved"] * bool(unproved)
    yield f"{counted(len(contacts), 'pair')} of links: {', '.join(parts)}"
    if unproved:
        yield "not proved: spheres stick out of the links that they cover; the links may be apart"
    yield from left_out_lines(robot)


def evidence(robot: Robot, contact: LinkContact) -> str:
    """Return a phrase with the evidence of a contact."""
    length = f"{abs(contact.gap):.{SHOWN_DIGITS}g} {robot.length_unit}"
    if contact.contact is Contact.NEVER and contact.proved_gap is not None:
        least = f"{_rounded_down(contact.proved_gap):.{SHOWN_DIGITS}g} {robot.length_unit}"
        return f"{least} apart at least (proved); {length} found"
    if contact.contact is Contact.ALWAYS:
        return "a place is inside both links at all joint values (proved)"
    if contact.spheres is Spheres.SOMETIMES:
        q = contact.nearest[list(contact.joints)]
        return f"spheres meet, {length} deep at {joint_text(robot, q, contact.joints)}"
    if contact.spheres is Spheres.ALWAYS:
        return f"spheres meet at all joint values (proved by {counted(contact.cells, 'cell')})"
    touch = "no contact found" if contact.gap > 0 else "spheres meet"
    return f"{touch}; not decided by {counted(contact.cells, 'cell')}"


def _rounded_down(value: float) -> float:
    """Round a positive number down to the digits that are shown, so that the text stays proved."""
    if not value > 0:
        return 0.0
    step = 10.0 ** (math.floor(math.log10(value)) - SHOWN_DIGITS + 1)
    return math.floor(value / step) * step


def srdf_text(robot: Robot, contacts: Sequence[LinkContact]) -> str:
    """Return the pairs of links that a planner need not check, as SRDF.

    Notes
    -----
    The reason for neighbours that always meet is "Adjacent". A pair of which nothing is proved has
    no line, because a planner must check it.

    Raises
    ------
    ValueError
        If a name has a letter that XML cannot hold.
    """
    root = ET.Element("robot", name=_xml(robot.name))
    for each in contacts:
        reason = disabling_reason(each)
        if reason is not None:
            one, other = map(_xml, each.links)
            ET.SubElement(root, "disable_collisions", link1=one, link2=other, reason=reason)
    ET.indent(root)
    head = f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {MADE} -->\n'
    return f"{head}{ET.tostring(root, encoding='unicode')}\n"


def disabling_reason(contact: LinkContact) -> str | None:
    """Return the SRDF reason why a pair need not be checked; None if it must be checked."""
    if contact.contact is Contact.NEVER:
        return "Never"
    if contact.contact is Contact.ALWAYS:
        return "Adjacent" if contact.neighbours else "Always"
    return None


def _xml(name: str) -> str:
    """Refuse characters that XML 1.0 cannot hold, escaped or not."""
    if any(
        not (x in "\t\n\r" or " " <= x <= "\ud7ff" or "\ue000" <= x <= "\ufffd" or x > "\uffff")
        for x in name
    ):
        raise ValueError(f"{printable(name)}: a name with a letter that XML cannot hold")
    return name
