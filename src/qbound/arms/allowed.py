"""Allowed collision matrix: pairs of links that meet never, always or sometimes, with proof.

Other programs draw ten thousand poses and call a pair that was in contact in none of them "never".
Here the proofs use cells that fill the ranges of the joints between both links. "Never": every form
has a bound above zero in each cell. "Always": in each cell one form has a bound below zero.
"Sometimes": there are two configurations, one with contact and one without. The bounds are those of
`qbound.proofs.exact.bounds` and include rounding. Not in the paper, whose Table 6 has the case
of one joint.

The proofs are about the spheres. If the spheres cover a link, "never" holds for the link too;
"always" and "sometimes" need not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from itertools import combinations
from pathlib import Path
from typing import Final

import numpy as np

from qbound.arms.closest import Witnesses, closest, random_configurations
from qbound.arms.everywhere import apart_everywhere, touching_everywhere
from qbound.arms.links import Link, links
from qbound.arms.pair_forms import PairForms, pair_forms
from qbound.arrays import Floats
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.proofs import Verdict
from qbound.proofs.exact.problem import exact_robot

CELLS: Final = 1_000_000
"""Cells at which the search for a proof about two links ends."""


class Contact(StrEnum):
    """What is known of the contact of two links over the whole joint space."""

    NEVER = "never"
    ALWAYS = "always"
    SOMETIMES = "sometimes"
    UNDECIDED = "not decided"


@dataclass(frozen=True, eq=False)
class LinkContact:
    """What is known of two links, and why.

    Attributes
    ----------
    links : tuple of str
        The one nearer to the base first.
    contact : Contact
        Two balls that touch are in contact.
    neighbours : bool
        Whether there is one joint between their frames, or none.
    joints : tuple of int
        The joints that change the distance of some two balls.
    balls : tuple of str
        The two that were found nearest to each other.
    nearest : ndarray, shape (n,)
        Configuration of the whole arm, rad and length, at which they were; where the contact is
        sometimes, it is verified.
    gap : float
        Length between the surfaces of these balls there; negative by the depth where they overlap.
    apart : ndarray or None, shape (n,)
        A configuration without contact, verified; None where there is none, or none was found.
    proved_gap : float or None
        Of never: a length that no two balls come closer than.
    cells : int
        Cells that were bounded.
    """

    links: tuple[str, str]
    contact: Contact
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
    cells: int = CELLS,
    seed: int = 0,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> tuple[LinkContact, ...]:
    """Decide for every two links of an arm of balls whether they meet never, always or sometimes.

    All pairs of links are taken, neighbours and those without a boundary in the file included, over
    all values of the joints within their limits; a joint without limits turns all the way round.

    Parameters
    ----------
    robot : Robot, str or Path
        What `load_robot` takes: each decimal of a file counts as it is written. Or a robot, whose
        doubles count as the binary fractions that they are.
    cells : int
        Budget of a pair of links; beyond it the pair is not decided. More decide more, slower.
    seed : int
        Of the search for witnesses.
    tell : callable
        Told how many pairs are done, of how many.

    Returns
    -------
    tuple of LinkContact
        In the order of the links, from the base outwards.

    Raises
    ------
    ValueError
        As `load_robot`, and if the links are not made of balls (`qbound.arms.links.links`).

    Examples
    --------
    Two fingers on one wheel, a quarter turn apart, and a post that one of them may meet:

    >>> import numpy as np
    >>> from qbound.model.robot import Point, Revolute, Robot
    >>> z = np.array([0.0, 0.0, 1.0])
    >>> wheel = Revolute("turn", "table", "wheel", np.zeros(3), np.eye(3), z)
    >>> places = {"long/1": [0.5, 0, 0], "short/1": [0, 0.2, 0]}
    >>> balls = [Point(name, "wheel", np.array(at), 0.0625) for name, at in places.items()]
    >>> post = Point("post/1", "table", np.array([0.5, 0.0, 0.0]), 0.0625)
    >>> arm = Robot("two fingers", (wheel,), (post, *balls), (), np.zeros(1), "long/1", "m", "rad")
    >>> for found in allowed_collisions(arm):
    ...     print(*found.links, found.contact)
    post long sometimes
    post short never
    long short never
    """
    exact = exact_robot(robot)
    plain = robot if isinstance(robot, Robot) else load_robot(robot)
    pairs = list(combinations(links(exact), 2))
    found: list[LinkContact] = []
    for one, other in pairs:
        tell(len(found), len(pairs))
        found.append(_decided(plain, exact, (one, other), cells, seed))
    tell(len(pairs), len(pairs))
    return tuple(found)


def _decided(
    robot: Robot, exact: Robot, pair: tuple[Link, Link], cells: int, seed: int
) -> LinkContact:
    """Decide one pair of links."""
    forms = pair_forms(exact, *pair)
    seen, contact, proved, opened = _searched(forms, cells, seed)
    nearest = seen.nearest if seen.touching is None else seen.touching
    return LinkContact(
        links=(pair[0].name, pair[1].name),
        contact=contact,
        neighbours=abs(pair[0].depth - pair[1].depth) <= 1,
        joints=forms.joints,
        balls=forms.names[seen.form],
        nearest=_whole(robot, forms, nearest),
        gap=seen.gap,
        apart=None if seen.apart is None else _whole(robot, forms, seen.apart),
        proved_gap=proved,
        cells=opened,
    )


def _searched(
    forms: PairForms, most: int, seed: int
) -> tuple[Witnesses, Contact, float | None, int]:
    """Look for witnesses of contact and of none, then for a proof that there is none of one."""
    samples = random_configurations(forms, seed)
    seen = Witnesses.of(forms, np.concatenate([samples, closest(forms, samples)]))
    opened = 0
    while seen.touching is None or seen.apart is None:
        left = most - opened
        gap = max(seen.gap, 0) / 2
        never = seen.touching is None
        answer = apart_everywhere(forms, gap, left) if never else touching_everywhere(forms, left)
        opened += answer.cells
        if answer.verdict is Verdict.PROVED:
            return seen, *((Contact.NEVER, gap) if never else (Contact.ALWAYS, None)), opened
        before = seen
        seen = before if answer.place is None else before.with_place(forms, answer.place)
        if seen is before:
            return seen, Contact.UNDECIDED, None, opened
    return seen, Contact.SOMETIMES, None, opened


def _whole(robot: Robot, forms: PairForms, q: Floats) -> Floats:
    """Return a configuration of the arm: what does not matter is at home, or between limits."""
    whole = np.array(robot.home, dtype=float)
    for j, joint in enumerate(robot.joints):
        if joint.limits is not None and not joint.limits[0] <= whole[j] <= joint.limits[1]:
            whole[j] = sum(joint.limits) / 2
    whole[list(forms.joints)] = q
    return whole
