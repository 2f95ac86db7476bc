"""Whether an arm can get from one configuration to another, and if not, what is in the way.

Four questions are asked in this order. Does an end violate a boundary? Can one joint not pass a
range (`separations`)? Is there a path (`search`) whose legs can all be proved? Does a paving of up
to three joints, the others held, prove that there is no path? If none of these decides, the answer
is "undecided".
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cspace.arguments import refuse_type, whole_number
from cspace.arms.links import SPHERES_ONLY, link_pair, on_spheres, unchecked_lines
from cspace.arms.search import TRIES, find_path
from cspace.arms.separations import Block, JointTravel, Separation, separation, separations
from cspace.arrays import Floats
from cspace.boundary.balls import judge
from cspace.boundary.evaluator import limit_names
from cspace.boundary.poses import bounds_bodies
from cspace.export.formats import pose_heading
from cspace.model.robot import BodyPair, Boundary, Joint, Robot
from cspace.model.robotfile import load_robot
from cspace.model.shapes import Polygon, Shape
from cspace.printable import printable
from cspace.proofs import Unproved, Verdict
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import Certificate, Subject, certify, no_certificate
from cspace.proofs.certificates.no_path import certify_disconnected, certify_no_path
from cspace.proofs.exact.problem import ExactProblem, exact_problem, exact_robot, paving_bytes
from cspace.proofs.subpaving.connection import Connection, connection
from cspace.proofs.subpaving.paving import Paving
from cspace.region import Region, find_region, violated
from cspace.units import amount, joint_amount, joint_text, joint_units, limited_joints, margin_text

Answer = Literal["connected", "separated", "infeasible", "undecided"]
"""Whether a path joins two configurations, or which end is none that is allowed."""

QUICK = 400
"""Places drawn in a first search, before a paving."""

SEEDS = 3
"""Searches after it, each with other places, before none is made any more."""

AGAIN = 4
"""How often a search is made again because a proof refuted the path that it found."""

FORM = 75
"""Bytes a coefficient of the forms of all joints, with what is computed of each; measured."""

MOST_PAVED = 3
"""Joints that a paving takes."""

FEW_CELLS = 50_000
"""Undecided cells of a paving that is made for a certificate alone, of what is proved before."""

ROUNDING = 1e-12
"""Part of the reach by which a margin that was asked for may be rounded, but in certificates."""

RELAXED = 1e-12
"""Part of the reach by which boundaries are relaxed; far above the rounding of a double."""

KEPT = 0.8
"""Part of the least margin seen along a path for which a proof is tried first."""

ALONG = 400
"""Places of each leg at which margins are looked at."""


@dataclass(frozen=True, eq=False)
class Why:
    """The answer whether a path joins two configurations, with its evidence; not in the paper.

    Attributes
    ----------
    robot : Robot
    ends : ndarray, shape (2, n)
        Start and goal, rad or length.
    answer : {"connected", "separated", "infeasible", "undecided"}
        "separated" where both are feasible and it is proved that no path joins them; with `hold`,
        no path that leaves the held joints where they are.
    hold : bool
        Whether the question is only about paths on which joints with equal values at both ends keep
        this value.
    travels : tuple of JointTravel
        For every joint, the ranges that are blocked for all values of the other joints; empty if an
        end is infeasible.
    violated : tuple of (int, str, float)
        Which end (0, 1), the boundary or limit, and its margin; the worst first.
    separation : Separation or None
        The joint that cannot pass.
    path : ndarray, shape (k, n), or None
        Corners of a path that is proved feasible everywhere, as the certificate has them. Also None
        if a region has both ends in one component but no path was found.
    margin : str
        Length that the path is proved to keep from every boundary: a decimal.
    least : float
        Least margin at many places of the path; sampled, not proved.
    asked : str
        Length that was asked to be kept from every boundary: a decimal.
    unproved : ndarray, shape (k, n), or None
        Where there is no `path`: corners of a path of which many places were looked at and found
        feasible. It is not proved.
    held : Connection or None
        What a paving of the joints in which the ends differ proves, the others held.
    certificate : Certificate or None
        Certificate of the path, of the joint or paving that separates, or of a violated boundary;
        `check` reads it.
    tried : tuple of str
        What was tried, in sentences. If neither a path nor a joint proves the answer, the last
        sentence says what does.
    """

    robot: Robot
    ends: Floats
    answer: Answer
    hold: bool = False
    travels: tuple[JointTravel, ...] = ()
    violated: tuple[tuple[int, str, float], ...] = ()
    separation: Separation | None = None
    path: Floats | None = None
    margin: str = "0"
    least: float = np.nan
    asked: str = "0"
    unproved: Floats | None = None
    held: Connection | None = None
    certificate: Certificate | None = None
    tried: tuple[str, ...] = field(default=())

    def __repr__(self) -> str:
        """Say the answer in a line; `why_lines` says it in sentences."""
        reason = ""
        if self.violated:
            reason = f": {('start', 'goal')[self.violated[0][0]]} violates {self.violated[0][1]}"
        elif self.separation is not None:
            reason = f": {self.separation.travel.name} cannot pass"
        elif self.path is not None:
            reason = f" by a path of {len(self.path)} corners"
        return f"<Why: {self.answer}{printable(reason)}>"

    @property
    def no_certificate(self) -> str:
        """Sentence that says why no certificate can hold this answer; empty if one can."""
        if self.asked != "0" and self.answer != "connected":
            return "only of a path that is proved a certificate has a margin"
        return no_certificate(self.robot, statements.points_of(self.robot, self.ends))

    @property
    def spheres_only(self) -> bool:
        """Whether "infeasible" or "separated" is shown for spheres that cover links, not for links.

        Spheres stick out of the links, so links may pass where spheres do not.
        """
        if self.answer == "infeasible":
            return on_spheres(self.robot, [name for _, name, _ in self.violated])
        if self.answer != "separated":
            return False
        if self.separation is not None:
            blocks = ({each.boundary for each in b.ranges} for b in self.separation.blocks)
            return any(on_spheres(self.robot, names) for names in blocks)
        return any(on_spheres(self.robot, [boundary.name]) for boundary in self.robot.used)

    @property
    def differing(self) -> list[int]:
        """Joints in which the two ends differ, by index."""
        return [int(j) for j in np.flatnonzero(self.ends[0] != self.ends[1])]


def why(
    source: str | Path | Robot,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    seed: int = 0,
    hold: bool = False,
    margin: str = "0",
) -> Why:
    """Tell whether a robot can get from one configuration to another, and why or why not.

    A path is proved to keep the boundaries of the file. Links that no boundary keeps apart may
    meet on it (`Robot.feasible_by`, `Robot.unchecked`).

    Parameters
    ----------
    source : str, Path or Robot
        A robot file, the name of a packaged robot, or a robot.
    start, goal : array_like, shape (n,)
        rad or length. For a joint without limits, values that differ by full turns are the same.
    seed : int
        Seed of the search for a path; the same seed gives the same answer.
    hold : bool
        Ask only about paths on which joints with equal values at both ends keep this value.
    margin : str
        Length to keep from every boundary, a decimal in the unit of the robot file. The question is
        then asked of a robot with so much more clearance.

    Raises
    ------
    ValueError
        If the file is not a robot file, an end is not a configuration of the robot, or the margin
        is no decimal of 0 or more.
    ModuleNotFoundError
        Without the extra `proofs`.

    Notes
    -----
    Not in the paper. A path is returned with a certificate of kind "path", a joint that cannot pass
    and a paving that separates with one of "no path". Some arms cannot be written in a certificate
    (`Why.no_certificate` says why); their paths are found by pavings alone. If a robot was changed,
    or not read from a robot file, the certificate is about the file that `save_robot` writes.

    Examples
    --------
    >>> found = why("minervabot-v2", [0.0, 0.0], [0.2, -0.5])
    >>> found.answer, found.path.shape, found.certificate.verdict.value
    ('connected', (2, 2), 'proved')

    A `Robot` may be given too. One joint of this robot also has ranges that it cannot pass:

    >>> from cspace import load_robot
    >>> found = why(load_robot("minervabot-v2"), [0.0, 0.0], [0.0, 2.3])
    >>> found.answer, found.separation.travel.name
    ('separated', 'q2')

    If no single joint is blocked, boxes of joint values can be in the way:

    >>> found = why("minervabot-v2", [-2.6, 0.2], [1.6, -2.3])
    >>> found.answer, found.separation, found.certificate.verdict.value
    ('separated', None, 'proved')
    """
    seed = whole_number("seed", seed, 0)
    if not isinstance(source, Robot | str | PathLike):
        refuse_type("source", source, "a Robot, a path, or the name of a packaged robot")
    robot = source if isinstance(source, Robot) else load_robot(source)
    subject = Subject(robot)
    ends = np.stack([robot.configuration(q) for q in (start, goal)])
    given, margin = robot, statements.as_decimal("margin", margin)
    if Fraction(margin) < 0:
        raise ValueError(f"margin {margin}: a length of 0 or more is wanted")
    if Fraction(margin):
        rounded = max(float(margin) - ROUNDING * robot.reach, 0)
        robot = statements.with_extra_clearance(robot, rounded)
    else:
        margin = "0"
    asked = _Asked(subject, given, robot, ends, hold, seed, margin)
    bad = [(k, *row) for k, q in enumerate(ends) for row in violated(robot, q)]
    if bad:
        return _infeasible(asked, sorted(bad, key=lambda row: row[2]))
    asked = replace(asked, travels=separations(robot))
    tried = []
    for attempt in _ATTEMPTS:
        found = attempt(asked)
        if isinstance(found, Why):
            return found
        tried += [found] if found else []
    return asked.answer("undecided", tried=tuple(tried))


def why_bytes(robot: Robot) -> int:
    """Estimate the memory of an answer: forms of all joints, and exact ones of a paving's.

    Examples
    --------
    >>> from cspace import load_robot
    >>> why_bytes(load_robot("ur5")) // 10**6  # megabytes
    27
    """
    count, joints = len(robot.used), len(robot.joints)
    return FORM * count * int(3**joints) + paving_bytes(count, min(joints, MOST_PAVED))


@dataclass(frozen=True, eq=False)
class _Asked:
    """The question, and the blocked ranges of the joints.

    `robot` keeps the margin that is asked for, beyond what the robot that is `given` keeps.
    """

    subject: Subject
    given: Robot
    robot: Robot
    ends: Floats
    hold: bool
    seed: int
    margin: str
    travels: tuple[JointTravel, ...] = ()
    unproved: list[Floats] = field(default_factory=list)
    refuted: list[Floats] = field(default_factory=list)

    def answer(self, answer: Answer, **found: Any) -> Why:
        """Return an answer to the question."""
        if self.unproved and "path" not in found:
            found["unproved"] = self.unproved[0]
        return Why(
            self.given, self.ends, answer, self.hold, self.travels, asked=self.margin, **found
        )

    @cached_property
    def no_certificate(self) -> str:
        """Why no certificate can hold the robot and its ends; empty if one can."""
        return no_certificate(self.given, statements.points_of(self.given, self.ends))

    @property
    def paved(self) -> str:
        """Margin that a paving of `robot` proves: the one asked for, less its rounding."""
        less = float(self.margin) - 2 * ROUNDING * self.given.reach
        return repr(max(less, 0.0)) if self.margin != "0" else "0"

    @property
    def cannot_part(self) -> bool:
        """Whether no certificate can say that the ends are infeasible or separated."""
        return bool(self.no_certificate) or self.margin != "0"

    @cached_property
    def moving(self) -> list[int]:
        """Joints that may move; if there are many, only the joints in which the ends differ."""
        n = len(self.robot.joints)
        differ = self.ends[0] != self.ends[1]
        return [j for j in range(n) if differ[j] or (n <= MOST_PAVED and not self.hold)]

    @property
    def all_move(self) -> bool:
        """Whether a proof about the moving joints answers the question."""
        return self.hold or len(self.moving) == len(self.robot.joints)

    @cached_property
    def problem(self) -> ExactProblem:
        """The clearance rule of the moving joints, the others held, in exact numbers.

        Raises
        ------
        Unproved
            If its bodies are not exactly in one plane, or an outline has no convex parts.
        """
        try:
            return exact_problem(exact_robot(self.robot), self.held)
        except ValueError as error:
            raise Unproved(str(error)) from None

    @cached_property
    def region(self) -> Region | None:
        """The region of two moving joints; None of more or fewer."""
        both = len(self.moving) == 2 and self.all_move
        return find_region(self.robot, self.held) if both else None

    @property
    def held(self) -> dict[int, float]:
        joints = range(len(self.robot.joints))
        return {j: float(self.ends[0, j]) for j in joints if j not in self.moving}

    @cached_property
    def components(self) -> list[int | None]:
        """Number of the component that each end lies in; empty if unknown."""
        if self.region is None or self.region.unresolved:
            return []
        return [self.region.component_of(q) for q in self.ends[:, self.moving]]

    @property
    def seems_separated(self) -> bool:
        """Whether the region has the ends in different components."""
        return len(set(self.components)) == 2


# --- an end that violates something ---------------------------------------------------------------


def _infeasible(asked: _Asked, bad: list[tuple[int, str, float]]) -> Why:
    """Certify the worst violation."""
    refuted = None
    if not asked.cannot_part:
        point = statements.points_of(asked.given, asked.ends)[bad[0][0]]
        certificate = certify(asked.subject, statements.box(point, point))
        refuted = certificate if certificate.verdict is Verdict.REFUTED else None
    return asked.answer("infeasible", violated=tuple(bad), certificate=refuted)


# --- a joint that cannot pass ---------------------------------------------------------------------


def _separated(asked: _Asked) -> Why | str:
    parted = separation(asked.travels, *asked.ends.tolist())
    if parted is None:
        said = "no joint has a range between both ends that one boundary blocks by itself"
        bodies = any(bounds_bodies(boundary) for boundary in asked.robot.used)
        return f"{said} (boundaries about bodies were not looked at)" if bodies else said
    proved = None
    if not asked.cannot_part:
        ranges = [max(b.ranges, key=lambda r: r.high - r.low) for b in parted.blocks]
        certificate = certify_no_path(asked.subject, asked.ends[0], asked.ends[1], ranges)
        proved = certificate if certificate.verdict is Verdict.PROVED else None
    return asked.answer("separated", separation=parted, certificate=proved)


# --- a path ---------------------------------------------------------------------------------------


def _joined(asked: _Asked, seeds: int, tries: int) -> Why | str:
    """Search for a path and prove all its legs; a path without a proof is kept, but no answer.

    If the proof refutes a path, no other path goes near the place that shows it.
    """
    reason = asked.no_certificate
    if reason and tries > QUICK:
        return f"no path can be proved: {reason}"
    if asked.seems_separated:
        return ""
    start, goal = asked.ends
    for seed in range(SEEDS * asked.seed, SEEDS * asked.seed + seeds):
        for _ in range(1 + AGAIN):
            path = find_path(
                asked.robot,
                start,
                goal,
                seed,
                tries=tries,
                hold=asked.hold,
                refuted=asked.refuted,
            )
            if path is None:
                break
            known = len(asked.refuted)
            found = _connected(asked, path)
            if found is not None:
                return found
            if len(asked.refuted) == known:
                if least_margins(asked.robot, path)[1].min() >= 0:
                    asked.unproved.append(path)
                break
    none = "none that could be proved" if asked.unproved or asked.refuted else "none"
    return f"a search for a path ({SEEDS} times two growing trees) found {none}"


def _connected(asked: _Asked, path: Floats, held: Connection | None = None) -> Why | None:
    """Certify a path, with its corners as they are written, or take one that a paving holds.

    What refutes the path is added to what is `refuted`.
    """
    robot = asked.given
    if asked.no_certificate:
        if held is None:
            return None
        least = float(least_margins(robot, path)[1].min())
        return asked.answer("connected", path=path, least=least, held=held, margin=asked.paved)
    points = statements.within_limits(robot, path)
    if no_certificate(robot, points):
        return None
    path = np.array(points, dtype=float) * statements.units(robot)
    least = float(least_margins(robot, path)[1].min())
    found = {"path": path, "held": held, "least": least}
    tried = [asked.margin]
    if math.isfinite(least):  # not where only limits bound the arm
        likely = statements.decimal(float(f"{max(KEPT * least, 0):.3g}"))
        if Fraction(likely) > Fraction(asked.margin):
            tried.insert(0, likely)
    for margin in tried:
        certificate = certify(asked.subject, statements.path(points, margin))
        if certificate.verdict is Verdict.PROVED:
            return asked.answer("connected", margin=margin, certificate=certificate, **found)
    if certificate.witness is not None:
        asked.refuted.append(np.array(certificate.witness.q) * statements.units(robot))
    return None


def least_margins(robot: Robot, path: Floats, places: int = ALONG) -> tuple[Floats, Floats]:
    """Return the least margin to any boundary at places along a path, and how far along they are.

    Returns
    -------
    s : ndarray
        Length along the path: the root of the sum of squares of joint values, rad and length.
    margins : ndarray
        Length; infinite without a boundary.
    """
    weights = np.linspace(0, 1, places + 1)[:, None]
    legs = [a + weights * (b - a) for a, b in pairwise(path)]
    q = np.concatenate(legs)
    steps = np.linalg.norm(np.diff(q, axis=0), axis=1)
    s = np.concatenate([[0.0], np.cumsum(steps)])
    margins = judge(robot).margins(q)[:, : len(robot.used)]
    return s, np.asarray(margins.min(axis=1, initial=np.inf))


# --- a region -------------------------------------------------------------------------------------


def _by_region(asked: _Asked) -> Why | str:
    """Answer by the region of two joints: which of its components the ends lie in.

    Which components there are is decided exactly (`cspace.region`). A component is one open set, so
    a path joins any two configurations of its closure. Between two components there is no open way,
    but they may touch, and what touches is feasible. So "separated" is said only if the ends also
    lie in different components where all boundaries are relaxed by `RELAXED`: every feasible
    configuration lies inside this larger region.
    """
    if asked.region is None:
        return ""
    if asked.region.unresolved:
        return f"the region is not decided ({asked.region.unresolved[0]})"
    ends = asked.ends[:, asked.moving]
    one, other = (_surely_in(asked.region, q) for q in ends)
    if one is None or other is None:
        return f"an end lies beside no component or more than one; {_said_of_components(asked)}"
    said = (
        "the components of the region are decided exactly, and start and goal lie in"
        f" {_numbered([one, other])} of it"
    )
    if one == other:
        found = _joined(asked, SEEDS, TRIES)
        return found if isinstance(found, Why) else asked.answer("connected", tried=(said,))
    wider = relaxed(asked.robot)
    if wider is None:
        return f"{said}, which may touch: two polygons are to keep no distance"
    around = find_region(wider, asked.held)
    if around.unresolved:
        return f"{said}, which may touch ({around.unresolved[0]})"
    start, goal = (_surely_in(around, q) for q in ends)
    if start is None or goal is None or start == goal:
        return f"{said}, which touch, or nearly do"
    return asked.answer("separated", certificate=_for_file(asked), tried=(said,))


def _surely_in(region: Region, q: Floats) -> int | None:
    """Return the component whose closure holds a configuration, if no other one is near.

    Places of cells are doubles. So nothing is said within 1e-6 of two components.
    """
    near = {
        int(region.cells.owner[one.cell])
        for one in region.cells.placed(q[[region.base, 1 - region.base]])
    }
    found = region.component_of(q)
    return found if near == {found} else None


def relaxed(robot: Robot) -> Robot | None:
    """Return a robot to which all that touches nothing but boundaries of `robot` is free.

    Distances to be kept are shorter by `RELAXED` of the reach, and half-spaces lie so much farther
    out. Two polygons that are to keep no distance cannot come closer than that; so convex polygons
    are smaller by this part. None if both are not convex, or a distance is shorter than that.
    """
    less = RELAXED * robot.reach
    every = (*robot.bodies, *robot.obstacles)
    convex = {b.name for b in every if isinstance(b.shape, Polygon) and len(b.parts) == 1}
    radius = {b.name: min(part.radius for part in b.parts) for b in every}
    boundaries: list[Boundary] = []
    for boundary in robot.used:
        distance = robot.least_distance(boundary)
        if isinstance(boundary, BodyPair):
            distance = boundary.clearance + sum(radius[name] for name in boundary.bodies)
            if distance == 0 and not convex.isdisjoint(boundary.bodies):
                boundaries.append(boundary)
                continue
        elif distance == 0:  # nothing can violate it
            continue
        if distance is not None and distance <= 2 * less:
            return None
        boundaries.append(boundary.with_extra_clearance(-less))
    bodies, obstacles = (
        tuple(replace(b, shape=_smaller(b.shape)) if b.name in convex else b for b in own)
        for own in (robot.bodies, robot.obstacles)
    )
    return replace(robot, boundaries=tuple(boundaries), bodies=bodies, obstacles=obstacles)


def _smaller(shape: Shape) -> Shape:
    """Return a convex polygon that lies inside another one."""
    middle = shape.places.mean(axis=0)
    return shape.with_numbers(middle + (shape.places - middle) * (1 - RELAXED), 0)


def _for_file(asked: _Asked) -> Certificate | None:
    """Return a certificate that two ends are separated, where a paving of few cells gives one."""
    if asked.cannot_part:
        return None
    start, goal = asked.ends[:, asked.moving]
    found = connection(asked.problem, start, goal, FEW_CELLS)
    return _disconnected(asked, found.paving) if found.answer == "separated" else None


def _said_of_components(asked: _Asked) -> str:
    if not asked.components:
        return "the region does not decide it"
    if None in asked.components:
        return "an end touches and has no room there"
    return f"as doubles place them, start and goal lie in {_numbered(asked.components)} of it"


def _numbered(components: list[int | None]) -> str:
    one, other = components
    return f"components {one} and {other}" if one != other else f"component {one}"


# --- a paving -------------------------------------------------------------------------------------


def _paved(asked: _Asked) -> Why | str:
    """Pave the joints in which the ends differ, the others held; all joints if there are few."""
    robot, ends, moving = asked.robot, asked.ends, asked.moving
    if not 0 < len(moving) <= MOST_PAVED:
        return f"a paving takes {MOST_PAVED} joints; the ends differ in {len(moving)}"
    try:
        found = connection(asked.problem, *ends[:, moving])
    except Unproved as reason:
        return f"no paving was made: {reason}"
    if found.path is not None:
        path = np.tile(ends[0], (len(found.path), 1))
        path[:, moving] = found.path
        connected = _connected(asked, path, found)
        if connected is not None:
            return connected
    said = _said_of_paving(robot, moving, found)
    if found.answer == "separated" and asked.all_move:
        proved = _disconnected(asked, found.paving)
        return asked.answer("separated", held=found, certificate=proved, tried=(said,))
    return said


def _disconnected(asked: _Asked, paving: Paving) -> Certificate | None:
    """Certify that a paving separates; the paving is a proof even without a certificate."""
    if asked.cannot_part:
        return None
    certificate = certify_disconnected(asked.subject, asked.ends[0], asked.ends[1], paving)
    return certificate if certificate.verdict is Verdict.PROVED else None


def _said_of_paving(robot: Robot, moving: list[int], connection: Connection) -> str:
    names = ", ".join(robot.joints[j].name for j in moving)
    cells = f"a paving of {names} ({connection.paving.cells} cells)"
    others = " while the other joints are held" if len(moving) < len(robot.joints) else ""
    if connection.answer == "separated":
        return f"{cells} proves that no path joins both ends{others}"
    if connection.answer == "connected":
        return f"{cells} proves that a path joins both ends{others}"
    return f"{cells} does not decide it{others}"


_ATTEMPTS: tuple[Callable[[_Asked], Why | str], ...] = (
    _separated,
    lambda asked: found if isinstance(found := _joined(asked, 1, QUICK), Why) else "",
    _by_region,
    _paved,
    lambda asked: _joined(asked, SEEDS, TRIES),
)
"""What is tried in turn: each gives an answer, or says in a sentence why it has none."""


# --- as others read it: sentences and JSON --------------------------------------------------------


DIGITS = {"deg": 2}
"""Decimals of what is shown; of lengths six."""

MOST_SHOWN = 3
"""Pairs of links that a sentence names."""


def why_lines(why: Why) -> Iterator[str]:
    """Say in sentences whether a robot gets from start to goal, and why or why not."""
    if why.answer == "infeasible":
        yield from _infeasible_lines(why)
    elif why.separation is not None:
        yield from _separated_lines(why, why.ends.tolist(), why.separation)
    elif why.answer == "separated":
        yield f"separated{_spare(why)}{_held(why)}: {why.tried[-1]}"
    elif why.path is not None:
        yield from _connected_lines(why)
    elif why.answer == "connected":
        none = "no path was found" if why.unproved is None else "no path is proved"
        yield f"connected{_spare(why)}{_held(why)}: {why.tried[-1]}; {none}"
        yield from _unproved_lines(why)
    else:
        yield f"not decided whether a path joins start and goal{_spare(why)}; what was tried:"
        yield from (f"- {said}" for said in why.tried)
        yield from _unproved_lines(why)
    if why.spheres_only:
        yield SPHERES_ONLY
    yield from unchecked_lines(why.robot)


def why_document(why: Why) -> dict[str, Any]:
    """Return the JSON form, schema qbound/why/1: rad, and lengths in the file's unit."""
    robot = why.robot
    parted, path = why.separation, why.path
    seldom: dict[str, Any] = {}
    if why.unproved is not None:
        seldom["unproved_path"] = why.unproved.tolist()
    if why.asked != "0":
        seldom["asked_margin"] = float(why.asked)
    return {
        **pose_heading("qbound/why/1", robot),
        "start": why.ends[0].tolist(),
        "goal": why.ends[1].tolist(),
        "answer": why.answer,
        **({"spheres_only": True} if why.spheres_only else {}),
        "held": [robot.joints[j].name for j in _held_joints(why)],
        "violated": [
            {"end": ("start", "goal")[k], "boundary": name, "margin": margin}
            for k, name, margin in why.violated
        ],
        "separation": parted
        and {
            "joint": parted.travel.name,
            "start_range": parted.parts[0],
            "goal_range": parted.parts[1],
            "blocked": [_block_document(block) for block in parted.blocks],
        },
        "travel": [
            {
                "joint": travel.name,
                "limits": travel.limits and list(travel.limits),
                "limit_names": travel.limits and list(limit_names(travel.name)),
                "blocked": [_block_document(block) for block in travel.blocks],
                "free": [list(span) for span in travel.free],
            }
            for travel in why.travels
        ],
        "path": None
        if path is None
        else {
            "corners": path.tolist(),
            "length": float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()),
            "proved_margin": float(why.margin),
            "least_margin_seen": why.least if math.isfinite(why.least) else None,
        },
        **seldom,
        "tried": list(why.tried),
        "certificate": why.certificate is not None,
    }


# --- sentences ------------------------------------------------------------------------------------


def _infeasible_lines(why: Why) -> Iterator[str]:
    robot, limited = why.robot, limited_joints(why.robot)
    named = {b.name: link_pair(robot, b) for b in robot.used}
    for k, end in enumerate(("start", "goal")):
        worst: dict[str, tuple[str, float]] = {}
        for _, name, margin in (row for row in why.violated if row[0] == k):
            worst.setdefault(named.get(name, name), (name, margin))
        said = [
            f"{links}, by {margin_text(robot, name, -margin, limited)}"
            + (f" (boundary {name})" if links != name else "")
            for links, (name, margin) in list(worst.items())[:MOST_SHOWN]
        ]
        more = f"; and {len(worst) - MOST_SHOWN} more" if len(worst) > MOST_SHOWN else ""
        if said:
            yield f"infeasible{_spare(why)}: the {end} violates {'; '.join(said)}{more}"


def _separated_lines(
    why: Why, ends: Sequence[Sequence[float]], parted: Separation
) -> Iterator[str]:
    robot = why.robot
    travel = parted.travel
    joint = robot.joints[travel.joint]
    one, other = (joint_amount(robot, joint, q[travel.joint]) for q in ends)
    blocks = [_block_text(robot, joint, block) for block in parted.blocks]
    cannot = f"cannot pass {blocks[0]}"
    if len(blocks) > 1:
        cannot = f"can pass neither {blocks[0]}, nor {blocks[1]}"
    yield (
        f"separated{_spare(why)}: {joint.name} cannot get from {one} to {other}; whatever the"
        f" other joints are, it {cannot}"
    )
    ranges = ", ".join(
        _span(joint, robot, *span)
        + " (start)" * (parted.parts[0] == k)
        + " (goal)" * (parted.parts[1] == k)
        for k, span in enumerate(travel.free)
    )
    yield f"the travel of {joint.name} falls into {len(travel.free)} ranges: {ranges}"
    yield from _same_posture(robot, joint, ends[1][travel.joint], parted)


def _same_posture(robot: Robot, joint: Joint, goal: float, parted: Separation) -> Iterator[str]:
    """Name a goal one full turn away that lies in the same free range as the start."""
    if not joint.turns or joint.limits is None:
        return
    for k in (-1, 1):
        value = goal + k * math.tau
        if parted.travel.part(value) == parted.parts[0]:
            place = joint_amount(robot, joint, value)
            yield f"the goal's posture is in the start's range too, at {place}"


def _connected_lines(why: Why) -> Iterator[str]:
    robot, path = why.robot, why.path
    assert path is not None
    legs = len(path) - 1
    kind = "a straight line" if legs == 1 else f"a path of {legs} legs"
    margin = amount(float(why.margin), robot.length_unit)
    least = amount(why.least, robot.length_unit, digits=3)
    clear = f"every boundary keeps {margin} on it, proved (least margin seen: {least})"
    if not robot.used:
        clear = "there is no boundary"
    yield f"connected{_held(why)}: {kind}, {_length(robot, path)} long; {clear}"
    if legs > 1:
        yield from (f"  {joint_text(robot, q)}" for q in path)


def _unproved_lines(why: Why) -> Iterator[str]:
    """Show a path that is not proved, and say so."""
    if why.unproved is None:
        return
    yield "a path that is not proved: nothing is violated at the places that were looked at"
    yield from (f"  {joint_text(why.robot, q)}" for q in why.unproved)


def _spare(why: Why) -> str:
    """Return the margin that was asked for; empty if none was."""
    length = amount(float(why.asked), why.robot.length_unit)
    return f" with {length} to spare" if why.asked != "0" else ""


def _length(robot: Robot, path: Floats) -> str:
    """Write how long a path is: in angles, and in lengths."""
    units, steps = np.array(joint_units(robot)), np.diff(path, axis=0)
    parts = {u: np.linalg.norm(steps[:, units == u], axis=1).sum() for u in dict.fromkeys(units)}
    return " and ".join(f"{length:.3g} {unit}" for unit, length in parts.items())


def _held_joints(why: Why) -> list[int]:
    if not why.hold:
        return []
    return [j for j in range(len(why.robot.joints)) if j not in why.differing]


def _held(why: Why) -> str:
    names = [why.robot.joints[j].name for j in _held_joints(why)]
    return f", while {', '.join(names)} {'is' if len(names) == 1 else 'are'} held" if names else ""


def _block_text(robot: Robot, joint: Joint, block: Block) -> str:
    """Write a blocked range, and which links or boundaries block it."""
    span = _span(joint, robot, block.low, block.high, inwards=True)
    others = " or others" if len(block.links) > 1 else ""
    if block.links[0] in {each.boundary for each in block.ranges}:
        return f"{span}, where {block.links[0]}{others} is violated"
    return f"{span}, where {block.links[0].replace(', ', ' and ')}{others} meet"


def _span(joint: Joint, robot: Robot, low: float, high: float, *, inwards: bool = False) -> str:
    """Write a range; a blocked range is rounded inwards, a free range outwards."""
    unit = joint.unit(robot.length_unit, "deg")
    size = 10.0 ** DIGITS.get(unit, 6)
    scale = joint.shown_scale * size
    down, up = (math.ceil, math.floor) if inwards else (math.floor, math.ceil)
    ends = [down(low * scale) / size, up(high * scale) / size]
    if not inwards and joint.limits is not None:
        ends = [
            x * joint.shown_scale if x in joint.limits else end
            for x, end in zip((low, high), ends, strict=True)
        ]
    return f"{ends[0]:.10g} to {ends[1]:.10g} {unit}"


# --- JSON -----------------------------------------------------------------------------------------


def _block_document(block: Block) -> dict[str, Any]:
    return {
        "from": block.low,
        "to": block.high,
        "links": list(block.links),
        "boundaries": list(dict.fromkeys(each.boundary for each in block.ranges)),
    }
