r"""The problem of a region: named forms of two joints, the joints' ranges, and the robot.

Every boundary in use keeps its distance (`clearance_problem`); bodies have features in place of a
form. A region of the small library is a problem too (`window_problem`).

An arm of many joints has hundreds of boundaries, and in one slice only a few bound anything. The
others are proved irrelevant and take no part. Boxes of the two joints' ranges are halved until one
of two facts is known for each box: some kept form is negative all over it, which forbids the box;
or every form that is left out is positive all over it. So the region of the kept forms is the
region of all forms. Bounds are the amplitudes, then the value and slope at a box's middle with the
bound on bending (`bending`). Not in the paper.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import product
from typing import Final, TypeVar

import numpy as np

import qbound
from cspace.arguments import refuse_type
from cspace.arrays import Bools, Floats, Ints
from cspace.boundary.contacts import NO_CONTACTS, Contacts, body_contacts
from cspace.boundary.evaluator import (
    Evaluator,
    Range,
    compiled,
    forms_in_use,
    limit_names,
    stacked,
    with_bodies,
)
from cspace.boundary.functions import clearance, clearance_error, term_size
from cspace.boundary.poses import bounds_bodies
from cspace.boundary.separation import BodyMargins
from cspace.forms.bending import bending
from cspace.forms.harmonic import add_constant, derivatives, refuse_no_form, restrict, size, waves
from cspace.model.robot import Boundary, HalfSpace, Held, Robot
from cspace.printable import printable
from cspace.tolerances import ROUNDING, UNCERTAIN_SIGN
from qbound.circle import TURN
from qbound.forms import HarmonicForm, Kind
from qbound.region import Cut

Given = TypeVar("Given")


@dataclass(frozen=True, eq=False)
class Problem:
    """Forms of two joints with names, and the ranges within which they count.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
    names : tuple of str
        One a form.
    ranges : tuple of two (low, high) or None
        None for a joint that turns all the way round.
    limits : tuple of two (str, str)
        Names of the lower and the upper end of each range.
    distances : tuple of (float or None)
        Required distance of a pair (eq. 11), one for each form; None if the form's value is the
        margin. Forms after the last given entry have None.
    robot : Robot, optional
        The robot of these boundaries; None for forms without a robot.
    joints : tuple of two int
        Which joints of the robot, by index.
    held : dict of int to float
        Values of the other joints, rad or length.
    bodies : tuple of Boundary
        Boundaries about bodies, which have no single form.
    contacts : Contacts
        The contact features of these bodies.
    origins : tuple of (Boundary or None)
        The boundary of each form; None if the form's doubles count as exact. Forms after the last
        given entry have None.

    Raises
    ------
    ValueError
        If there is not one name for each form, or a range is wrong; the message names the place.
    """

    forms: HarmonicForm
    names: tuple[str, ...]
    ranges: tuple[Range, Range]
    limits: tuple[tuple[str, str], tuple[str, str]]
    distances: tuple[float | None, ...] = ()
    robot: Robot | None = None
    joints: tuple[int, int] = (0, 1)
    held: Mapping[int, float] = field(default_factory=dict)
    bodies: tuple[Boundary, ...] = ()
    contacts: Contacts = NO_CONTACTS
    origins: tuple[Boundary | None, ...] = ()

    def __post_init__(self) -> None:
        """Refuse anything that is not a problem of two joints."""
        if not isinstance(self.forms, HarmonicForm):
            refuse_type("forms", self.forms, "a stack of forms, a HarmonicForm")
        refuse_no_form(self.forms)
        for what in ("names", "ranges", "limits"):
            if isinstance(found := getattr(self, what), str) or not isinstance(found, Sequence):
                refuse_type(what, found, "a tuple")
        if len(self.forms.kinds) != 2 or len(self.forms.stack) != 1:
            raise ValueError(
                f"forms: a stack of forms of two joints is wanted, shape (m, 3, 3); found"
                f" {self.forms.coefficients.shape}"
            )
        if len(self.names) != len(self.forms.coefficients):
            raise ValueError(f"names: {len(self.names)} for {len(self.forms.coefficients)} forms")
        for what, pairs in (("ranges", self.ranges), ("limits", self.limits)):
            if len(pairs) != 2:
                raise ValueError(f"{what}: two are wanted, one a joint; found {len(pairs)}")
        for j, (ends, kind) in enumerate(zip(self.ranges, self.forms.kinds, strict=True)):
            _refuse_range(f"ranges[{j}]", ends, kind)

    def __repr__(self) -> str:
        """Show the joints and the robot on one line."""
        of = "" if self.robot is None else f" of {printable(self.robot.name)}"
        joints, count = printable(", ".join(self.joint_names)), len(self.names)
        return f"<Problem{of}: {joints}; {count} forms>"

    def __eq__(self, other: object) -> bool:
        """Tell whether two problems have equal robots, boundaries, ranges and held values.

        Numbers are compared as doubles: the decimals of two files may still differ.
        """
        if not isinstance(other, Problem):
            return NotImplemented
        same = self._key == other._key and self.held == other.held and self.robot == other.robot
        return same and np.array_equal(self.forms.coefficients, other.forms.coefficients)

    def __hash__(self) -> int:
        """Return a number that equal problems share."""
        return hash(self._key)

    @property
    def _key(self) -> tuple[object, ...]:
        bodies = tuple(boundary.name for boundary in self.bodies)
        kinds = self.forms.kinds
        return kinds, self.names, bodies, self.ranges, self.limits, self.joints

    @cached_property
    def evaluator(self) -> Evaluator:
        """The forms and limits, compiled: margins and feasibility of configurations (..., 2)."""
        robot, distances = self.robot, self._each(self.distances)
        origins = self._each(self.origins)
        # Terms have size 0 in a form that is not a clearance of the robot.
        terms = [0.0 if b is None or robot is None else term_size(robot, b) for b in origins]
        forms = compiled(self.forms, self.names, distances, self.ranges, self.limits, terms=terms)
        if robot is None or not self.bodies:
            return forms
        names = {boundary.name for boundary in self.bodies}.union(self.names)
        order = [boundary.name for boundary in robot.used if boundary.name in names]
        return with_bodies(forms, BodyMargins(robot, self.held, self.bodies), order)

    def _each(self, given: tuple[Given | None, ...]) -> tuple[Given | None, ...]:
        """Return one entry for each form: None after the last given one."""
        return *given, *[None] * (len(self.names) - len(given))

    @property
    def unstated(self) -> set[str]:
        """Names of the robot's boundaries in use without a form here: windows stand for them."""
        used = () if self.robot is None else self.robot.used
        stated = {*self.names, *(body.name for body in self.bodies)}
        return {boundary.name for boundary in used} - stated

    @property
    def free_home(self) -> Floats | None:
        """Home values of the two joints; None without a robot."""
        return None if self.robot is None else self.robot.home[list(self.joints)]

    @property
    def joint_names(self) -> tuple[str, str]:
        """Names of the two joints; q1 and q2 without a robot."""
        if self.robot is None:
            return "q1", "q2"
        one, other = (self.robot.joints[j].name for j in self.joints)
        return one, other

    @property
    def units(self) -> tuple[str, str]:
        """Unit of each joint's values: rad, or the robot's length unit."""
        length = "length" if self.robot is None else self.robot.length_unit
        one, other = ("rad" if kind == "revolute" else length for kind in self.forms.kinds)
        return one, other

    @property
    def area_unit(self) -> str:
        """Unit of areas: the product of both joints' units."""
        one, other = self.units
        return f"{one}^2" if one == other else f"{one} {other}"

    def with_form(self, name: str, coefficients: Floats) -> Problem:
        """Return the problem with one more form, of coefficients (3, 3), as its last."""
        table = np.concatenate([self.forms.coefficients, coefficients[None]])
        return replace(self, forms=HarmonicForm(table, self.forms.kinds), names=(*self.names, name))

    def without_bodies(self, dropped: Sequence[str]) -> Problem:
        """Return the problem without some of its boundaries about bodies, by name."""
        bodies = tuple(boundary for boundary in self.bodies if boundary.name not in dropped)
        return replace(self, bodies=bodies, contacts=self.contacts.without(dropped))

    def without(self, dropped: Sequence[int]) -> Problem:
        """Return the problem without some of its forms, by index."""
        if not len(dropped):
            return self
        kept = [k for k in range(len(self.names)) if k not in dropped]
        return replace(
            self,
            forms=self.forms[kept],
            names=tuple(self.names[k] for k in kept),
            distances=tuple(d for k, d in enumerate(self.distances) if k not in dropped),
            origins=tuple(b for k, b in enumerate(self.origins) if k not in dropped),
        )

    @cached_property
    def blocked(self) -> tuple[str, ...]:
        """Names of the forms that leave no room because they depend on neither joint.

        Their constant value is negative or zero. A pair with required distance 0 may touch.
        """
        kept = self._each(self.distances)
        lost = (
            k for k, value in self.constants.items() if value < 0 or (not value and kept[k] != 0)
        )
        return tuple(self.names[k] for k in lost)

    @cached_property
    def searched(self) -> tuple[Problem, tuple[str, ...]]:
        """The problem to search: forms that a joint moves, and of many forms those that can bind.

        Also the names of the forms that were left out because they bind nowhere.
        """
        return without_irrelevant(self.without(list(self.constants)))

    @cached_property
    def errors(self) -> Floats:
        """How far each coefficient of a form may be from the exact one, shape (m, 3, 3).

        Forms whose doubles are exact have no error.
        """
        found = np.zeros_like(self.forms.coefficients)
        for k, boundary in enumerate(self.origins):
            if boundary is not None and self.robot is not None:
                found[k] = clearance_error(self.robot, self.held, boundary)
        return found

    @cached_property
    def constants(self) -> dict[int, float]:
        """The forms that depend on neither joint, by index, and their values.

        A value that is zero up to rounding is zero; such a boundary touches everywhere.
        """
        constant = self.forms.coefficients[:, 0, 0]
        moved = HarmonicForm(add_constant(self.forms.coefficients, -constant), self.forms.kinds)
        reach = [TURN if ends is None else max(map(abs, ends)) for ends in self.ranges]
        rounding = self.evaluator.rounding[: len(self.names)]
        fixed = np.flatnonzero(size(moved, reach) <= rounding)
        values = constant[fixed]
        values = np.where(np.abs(values) <= rounding[fixed], 0.0, values)
        return dict(zip(fixed.tolist(), values.tolist(), strict=True))


def _refuse_range(where: str, ends: Range, kind: Kind) -> None:
    """Refuse ends that are not numbers or are swapped, and a slide without an end."""
    if ends is None:
        if kind == "prismatic":
            raise ValueError(f"{where}: a joint that slides needs a range; None is a full turn")
    elif not np.isfinite(np.asarray(ends, dtype=float)).all():
        raise ValueError(f"{where}: two finite numbers are wanted, found {ends}")
    elif ends[0] > ends[1]:
        raise ValueError(f"{where}: the low end {ends[0]:g} is above the high end {ends[1]:g}")


def clearance_problem(robot: Robot, held: Held | None = None) -> Problem:
    """State that every boundary in use keeps its clearance, and joints their limits (eqs. 10-12).

    Parameters
    ----------
    held : mapping of int or str to float, optional
        Values of the joints that are held, all but two, by index or name; rad or length.

    Raises
    ------
    ValueError
        If not exactly two joints are left free, or `held` names no joint or no finite number.
    """
    values = robot.held_indices(held or {})
    return _slice_problem(robot, values) if values else _whole_problem(robot, id(robot.source))


@lru_cache(maxsize=4)
def _whole_problem(robot: Robot, _source: int) -> Problem:
    """State the problem with no joint held; the result is made once for each robot.

    The cache compares sources too, because equal robots may be written in different decimals.
    """
    return _slice_problem(robot, {})


def _slice_problem(robot: Robot, held: Mapping[int, float]) -> Problem:
    joints = [robot.joints[j] for j in free_pair(robot, held)]
    ranges = [joint.limits for joint in joints]
    return state(robot, robot.used, ranges, [limit_names(joint.name) for joint in joints], held)


def window_problem(region: qbound.Region) -> Problem:
    """State a region of the small library: its box as ranges, its cuts as forms.

    A cut by the clearance of a boundary is exact, from the decimals of the file, and so are limits.
    Other cuts, and the ends of windows, count as exact doubles.

    Parameters
    ----------
    region : qbound.Region
        Of a robot of `cspace.load_robot`.

    Raises
    ------
    ValueError
        If a boundary in use is about a body or a sphere, which the region passes over.

    Examples
    --------
    The region by the windows of Table 6:

    >>> from cspace import load_robot
    >>> from cspace.region import solve
    >>> from qbound import window_region
    >>> solve(window_problem(window_region(load_robot("minervabot-v2"))))
    <Region of MinervaBotV2: 1 component, with home, area 11.7545 rad^2>
    """
    robot, box = region.robot, region.box
    if not isinstance(robot, Robot):
        refuse_type("region.robot", robot, "a Robot of cspace.load_robot")
    for wall in robot.used:
        if bounds_bodies(wall) or (isinstance(wall, HalfSpace) and robot.point(wall.point).radius):
            raise ValueError(f"{printable(wall.name)}: qbound knows points only, without a radius")
    formed = {wall.name: wall for wall in robot.boundaries if not bounds_bodies(wall)}

    def stated(cut: Cut) -> Boundary | None:
        boundary = formed.get(cut.name)
        if boundary is None:
            return None
        own = clearance(robot, boundary).coefficients
        return boundary if np.array_equal(own, cut.form.coefficients) else None

    origins = [stated(cut) for cut in region.cuts]
    low, high = box.lower.tolist(), box.upper.tolist()
    below, above = (
        [bound.boundary if bound.component else bound.label for bound in bounds]
        for bounds in (box.lower_bounds, box.upper_bounds)
    )
    return Problem(
        forms=region.forms,
        names=tuple(cut.name for cut in region.cuts),
        ranges=((low[0], high[0]), (low[1], high[1])),
        limits=((below[0], above[0]), (below[1], above[1])),
        distances=tuple(None if b is None else robot.least_distance(b) for b in origins),
        robot=robot,
        origins=tuple(origins),
    )


def free_pair(robot: Robot, held: Mapping[int, float]) -> tuple[int, int]:
    """Return the two joints that are not held, by index; ValueError if they are not two."""
    free = robot.free(held)
    if len(free) != 2:
        names = ", ".join(joint.name for joint in robot.joints)
        raise ValueError(
            f"a region has two joints; {printable(robot.name)} has {len(free)} that are not held"
            f" (of {printable(names)}): hold all but two"
        )
    return free[0], free[1]


def state(
    robot: Robot,
    used: Sequence[Boundary],
    ranges: Sequence[Range],
    limits: Sequence[tuple[str, str]],
    held: Mapping[int, float] | None = None,
) -> Problem:
    """Gather the clearance forms of some boundaries within given ranges of two joints.

    Limits that held joints violate (eq. 10) come last, as forms that depend on no joint.
    """
    held = held or {}
    one, other = free_pair(robot, held)
    bodies = tuple(boundary for boundary in used if bounds_bodies(boundary))
    formed = [boundary for boundary in used if not bounds_bodies(boundary)]
    every = forms_in_use(robot) if used is robot.used else stacked(robot, formed)
    forms = restrict(every, held)
    beyond = list(_beyond_limits(robot, held))
    constants = np.zeros((len(beyond), 3, 3))
    constants[:, 0, 0] = [margin for _, margin in beyond]
    return Problem(
        forms=HarmonicForm(np.concatenate([forms.coefficients, constants]), forms.kinds),
        names=(*(boundary.name for boundary in formed), *(name for name, _ in beyond)),
        ranges=(ranges[0], ranges[1]),
        limits=(limits[0], limits[1]),
        distances=tuple(robot.least_distance(boundary) for boundary in formed),
        robot=robot,
        joints=(one, other),
        held=dict(held),
        bodies=bodies,
        contacts=body_contacts(robot, held, bodies, ranges),
        origins=tuple(formed),
    )


def _beyond_limits(robot: Robot, held: Mapping[int, float]) -> Iterator[tuple[str, float]]:
    """Yield the limits that held joints violate by more than rounding, and by how much."""
    for j, value in held.items():
        joint = robot.joints[j]
        low, high = joint.limits or (value, value)
        for name, margin in zip(limit_names(joint.name), (value - low, high - value), strict=True):
            if margin < -ROUNDING * abs(value):
                yield name, margin


MANY: Final = 64
"""Forms up to which none is left out: they cost less than the proof."""

ACROSS: Final = 32
"""Boxes along each joint to begin with."""

HALVINGS: Final = 4
"""How often an undecided box is halved both ways; forms that are undecided then are kept."""


def without_irrelevant(problem: Problem) -> tuple[Problem, tuple[str, ...]]:
    """Leave out the forms that bound nothing if there are many forms, and return their names too.

    Returns
    -------
    problem : Problem
        The problem with the same region and fewer forms.
    names : tuple of str
        Names of the forms that are left out, in order; boundaries about bodies are never left out.
    """
    if len(problem.names) <= MANY:
        return problem, ()
    kept = relevant_forms(problem.forms, problem.ranges)
    dropped = np.setdiff1d(np.arange(len(problem.names)), kept).tolist()
    return problem.without(dropped), tuple(problem.names[k] for k in dropped)


def relevant_forms(forms: HarmonicForm, ranges: Sequence[Range]) -> Ints:
    r"""Return the forms that suffice: all are positive exactly where these are (not in the paper).

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Forms of two joints; floats.
    ranges : sequence of two (low, high) or None
        The ranges that count, ends included, rad or length; None for a joint that turns all the way
        round.

    Returns
    -------
    ndarray of int
        Rows, ascending. Each other form is positive, by more than rounding, all over every box on
        which no kept form is negative throughout. Some rows may be needless, because undecided
        forms are kept.

    Notes
    -----
    A form that comes closer to zero than `UNCERTAIN_SIGN` times the size of its terms counts as
    undecided. So bounds are rounded outward by far more than their error.

    Examples
    --------
    A wall, a second wall behind it, and a third one that is never reached:

    >>> import numpy as np
    >>> from qbound import HarmonicForm
    >>> walls = np.zeros((3, 3, 3))
    >>> walls[:, 0, 0], walls[:, 1, 0] = [0.5, 0.7, 2.0], 1.0
    >>> relevant_forms(HarmonicForm(walls, ("revolute", "revolute")), [None, None]).tolist()
    [0]
    """
    ends = [_whole(kind, ends) for kind, ends in zip(forms.kinds, ranges, strict=True)]
    reach = [max(map(abs, pair)) for pair in ends]
    doubt = UNCERTAIN_SIGN * size(forms, reach)
    open_ = np.flatnonzero(_lowest(forms, reach) <= doubt)
    lines = [np.linspace(*pair, 2 * ACROSS + 1)[1::2] for pair in ends]
    middles = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    half = np.array([(high - low) / (2 * ACROSS) for low, high in ends])
    return np.asarray(open_[_needed(forms[open_], doubt[open_], middles, half)])


def _whole(kind: str, ends: Range) -> tuple[float, float]:
    """Return a range, cut to one turn for an angle with a wider one."""
    if kind == "revolute" and (ends is None or ends[1] - ends[0] >= TURN):
        return -math.pi, math.pi
    if ends is None:
        raise ValueError("a sliding joint needs limits")
    return ends


def _lowest(forms: HarmonicForm, reach: Sequence[float]) -> Floats:
    """Bound forms from below by their constant and amplitudes, shape (m,)."""
    terms = waves(forms)
    still = ~(terms.turns.any(axis=1) | terms.powers.any(axis=1))
    sizes = np.abs(terms.amplitudes) * np.prod(np.asarray(reach) ** terms.powers, axis=1)
    constant = terms.amplitudes.real[:, still].sum(axis=1)
    return np.asarray(constant - sizes[:, ~still].sum(axis=1))


def box_bounds(forms: HarmonicForm, middles: Floats, half: Floats) -> tuple[Floats, Floats, Floats]:
    """Return lower bounds, values at the middle and upper bounds of forms on boxes, (n, m) each."""
    values = forms(middles)
    steps = half * np.array([[1.0, 1.0], [1.0, -1.0]])
    boxes = middles if waves(forms).powers.any() else middles[:1]  # bends of angles are constant
    corners = np.concatenate([boxes[:, None] + steps, boxes[:, None] - steps], axis=1)
    steps = np.broadcast_to(steps, (len(boxes), 2, 2))
    bend = bending(forms, corners, steps, upwards=True).max(axis=1) / 2
    change = np.abs(derivatives(forms)(middles)) @ half + bend
    return values - change, values, values + change


def _needed(forms: HarmonicForm, doubt: Floats, middles: Floats, half: Floats) -> Bools:
    """Return forms that suffice on boxes, which are halved both ways where they are undecided.

    Parameters
    ----------
    doubt : ndarray, shape (m,)
        A value that is no farther from zero than this has no sign.
    """
    kept, columns = np.zeros(len(doubt), dtype=np.bool_), np.arange(len(doubt))
    forbidden = [np.zeros((0, len(doubt)), dtype=np.bool_)]
    for depth in range(HALVINGS + 1):
        if not len(middles) or not len(columns):
            break
        low, value, high = box_bounds(forms[columns], middles, half)
        unsure = doubt[columns]
        negative = high < -unsure
        closed = negative.any(axis=1)
        rows = np.zeros((np.count_nonzero(closed), len(doubt)), dtype=np.bool_)
        rows[:, columns] = negative[closed]
        forbidden.append(rows)
        # A form that is the only negative one somewhere bounds the region and cannot be dropped.
        alone = value[(value <= unsure).sum(axis=1) == 1] <= unsure
        kept[columns[alone.any(axis=0)]] = True
        vague = low[~closed] <= unsure
        left = (vague & ~kept[columns]).any(axis=1)
        if depth == HALVINGS:
            kept[columns[vague.any(axis=0)]] = True
        quarters = np.array(list(product((-0.5, 0.5), repeat=2))) * half
        middles = (middles[~closed][left][:, None] + quarters).reshape(-1, 2)
        half, columns = half / 2, columns[vague[left].any(axis=0)]
    rows = np.concatenate(forbidden)
    while len(rows := rows[~(rows & kept).any(axis=1)]):  # each forbidden box has its form
        kept[rows.sum(axis=0).argmax()] = True
    return kept
