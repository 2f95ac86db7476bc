"""Certificates: proofs that every configuration of a set keeps every boundary (not in the paper).

The search here uses floating point and is not trusted. Its result is written in the format of the
book's page "The certificate", and the checker decides.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from textwrap import wrap
from typing import Any

from cspace import check
from cspace.arguments import number_above_zero, refuse_type
from cspace.arrays import Floats
from cspace.boundary.evaluator import limit_names
from cspace.export.formats import json_text
from cspace.geometry.convex import exact_parts
from cspace.model.robot import BodyPair, Robot
from cspace.model.robotfile import as_written, parse_robot
from cspace.printable import printable
from cspace.proofs import Verdict
from cspace.proofs.certificates import search as safe
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.inequality import BoundedArm
from cspace.proofs.certificates.witness import (
    Witness,
    beyond_limits,
    cells_of,
    deepest,
    witness,
)
from cspace.proofs.subdivide import Progress, Search, silent
from cspace.units import counted, file_units, joint_text

MOST_CELLS = 200_000
"""Cells that a search opens for one boundary before it gives up."""

FEW_CELLS = 20_000
"""The same for each scale that `bracket_scale` tries."""

SEARCHING = 0.99
"""Part of the work that is told of as the search; the rest is the check of what it found."""

WIDER = 10
"""How often the distance to a scale that is to be refuted is doubled."""

FINEST = 4e-12
"""Least distance of two scales that are told apart: they are written with twelve decimals."""

MOST_NAMED = 5
"""Boundaries that are named as undecided."""

PER_ARC = (12, 48, 192)
"""Points on each arc of a region, in turn, until its polygon is proved."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """The answer about a statement.

    Attributes
    ----------
    verdict : Verdict
        "Proved" and "refuted" are confirmed in exact arithmetic by `check.check`.
    text : str
        The file, JSON; empty where undecided.
    said : str
        The checker's words about the file; if undecided, the cells that are left.
    searches : dict of str to Search
        By the name of the boundary.
    witness : Witness or None
    """

    verdict: Verdict
    text: str
    said: str
    searches: dict[str, Search] = field(default_factory=dict)
    witness: Witness | None = None

    def __repr__(self) -> str:
        """Show on one line what is proved, and how."""
        if self.witness is not None:
            return f"<Certificate: refuted, {printable(self.witness.boundary)} is violated>"
        cells = f", {counted(self.leaves, 'cell')}" if self.searches else ""
        return f"<Certificate: {self.verdict.value}{cells}>"

    @property
    def leaves(self) -> int:
        """Number of cells of the proof."""
        return sum(search.leaves for search in self.searches.values())


def no_certificate(robot: Robot, points: Iterable[Sequence[str]] = ()) -> str:
    """Return why no certificate can hold a robot and some configurations; empty if one can.

    Parameters
    ----------
    points : iterable of sequence of str
        Decimals in the units of the robot file.
    """
    for most, count, what in (
        (check.MAX_JOINTS, len(robot.joints), "joints"),
        (check.MAX_BOUNDARIES, len(robot.used), "boundaries"),
    ):
        if count > most:
            return f"certificates take at most {most:,} {what}; this robot has {count:,}"
    unit = robot.angle_unit
    largest = check.LARGEST_ANGLE[unit]
    for point in points:
        for joint, value in zip(robot.joints, point, strict=True):
            if joint.turns and abs(Fraction(value)) > largest:
                far = f"{printable(joint.name)} is at {value} {unit}"
                return f"certificates take angles of at most {largest} {unit}; {far}"
    return ""


def parts_of(robot: Robot) -> dict[str, list[list[int]]]:
    """Cut all outlines of pairs in use that are not convex, by the name of their body.

    Raises
    ------
    ValueError
        If an outline cannot be cut, or no axis of its frame is along that of the joints.
    """
    pairs = [boundary for boundary in robot.used if isinstance(boundary, BodyPair)]
    found = {}
    for name in dict.fromkeys(name for pair in pairs for name in pair.bodies):
        body = robot.body(name)
        if len(body.shape.places) < 3:
            continue
        own = robot.plane.flat_coordinate(body.frame)
        if own is None:
            raise ValueError(f"{printable(name)}: its frame has no axis along that of the joints")
        rows = [[x for k, x in enumerate(p) if k != own] for p in body.shape.places.tolist()]
        parts = exact_parts([tuple(Fraction(repr(x)) for x in row) for row in rows])
        if len(parts) > 1:
            found[name] = parts
    return found


class Subject:
    """A robot that certificates are about: its text, parts and normal form, computed once.

    Parameters
    ----------
    source : str or Robot
        The text of a robot file; or a robot. Certificates of a robot are about the file that it was
        read from; if the robot was changed, about the file that `save_robot` writes.

    Raises
    ------
    ValueError
        When an attribute is used, if no certificate can hold the robot.
    """

    def __init__(self, source: str | Robot) -> None:
        self._read = None if isinstance(source, str) else as_written(source)
        file = None if self._read is None else self._read.source
        self.text = source if isinstance(source, str) else file.text if file else ""

    @classmethod
    def of(cls, source: str | Robot | Subject) -> Subject:
        """Make a subject of a text or a robot; a subject is returned unchanged.

        Raises
        ------
        TypeError
            If the argument is neither a robot nor the content of a robot file.
        """
        if isinstance(source, Subject):
            return source
        given: object = source
        if not isinstance(given, Robot) and not (isinstance(given, str) and "\n" in given):
            refuse_type("subject", source, "a Robot, or the content of a robot file")
        return cls(source)

    @cached_property
    def robot(self) -> Robot:
        """The robot, refused before any work if no certificate can hold it."""
        robot = parse_robot(self.text) if self._read is None else self._read
        reason = no_certificate(robot)
        if reason:
            raise ValueError(reason)
        return robot

    @cached_property
    def parts(self) -> dict[str, list[list[int]]]:
        """Convex parts of the outlines that are not convex."""
        return parts_of(self.robot)

    @cached_property
    def form(self) -> dict[str, Any]:
        """The normal form."""
        return check.normal_form(self.text, self.parts)

    def written(self, claim: statements.Statement, **evidence: Any) -> str:
        """Return the file of a claim with its proof or witness."""
        content = {
            "schema": check.SCHEMA,
            "claim": claim,
            "parts": self.parts,
            "robot": self.text,
            "sha256": check.digest(check.canonical(self.form)),
            **evidence,
        }
        return json_text(content)

    def confirmed(
        self, claim: statements.Statement, verdict: Verdict, **evidence: Any
    ) -> Certificate:
        """Write a file and give it to the checker; undecided unless the checker confirms it."""
        text = self.written(claim, **evidence)
        try:
            said = check.check(text).said
        except ValueError as error:
            said = f"not confirmed in exact arithmetic: {error}"
            return Certificate(Verdict.UNDECIDED, "", said)
        return Certificate(verdict, text, said)


def certify(
    subject: str | Robot | Subject,
    statement: statements.Statement,
    *,
    most: int = MOST_CELLS,
    progress: Progress = silent,
) -> Certificate:
    """Prove or refute that every boundary in use holds all over a set.

    Parameters
    ----------
    subject : str, Robot or Subject
        The text of a robot file, see `robotfile.robot_text`; or a robot, see `Subject`. One subject
        may serve many statements.
    statement : dict
        A statement made by `statements`.
    most : int
        Cells that are opened for one boundary before the answer is "undecided".
    progress : callable
        Called with the progress, from 0 to 1.

    Raises
    ------
    ValueError
        If no certificate can hold the robot or the statement; the message says why.

    Examples
    --------
    >>> from cspace.model.robotfile import robot_text
    >>> from cspace.proofs.certificates.statements import box
    >>> text, _ = robot_text("minervabot-v2")
    >>> answer = certify(text, box(["-10", "-10"], ["10", "10"]))  # in degrees, as the file
    >>> answer.verdict.value, answer.leaves
    ('proved', 5)

    The checker does not use this library, so anybody can check the file with it:

    >>> check.check(answer.text).refuted
    False

    A statement about an infeasible set is refuted, with a configuration that violates a boundary:

    >>> answer = certify(text, box(["-10", "-10"], ["90", "10"]))
    >>> answer.verdict.value, answer.witness is not None
    ('refuted', True)
    """
    subject = Subject.of(subject)
    try:
        check.read_statement(subject.text, subject.parts, statement)
    except check.Refused as error:
        if "an angle of more than" not in str(error):
            raise
        points = (point for row in statement["points"] for point in row)
        raise ValueError(no_certificate(subject.robot, points)) from None
    arm, searches = BoundedArm(subject.form, Fraction(statement["margin"])), dict[str, Search]()
    evidence = beyond_limits(arm, statement)
    if evidence is None:
        cells = cells_of(arm, statement)
        found, directions = safe.search(arm, cells, most, lambda part: progress(SEARCHING * part))
        searches = by_boundary(arm, found)
        if violated := {k: x.violation for k, x in found.items() if x.violation is not None}:
            evidence = deepest(arm, statement, violated)
    if evidence is not None:
        answer = subject.confirmed(statement, Verdict.REFUTED, witness=evidence)
        return replace(answer, witness=witness(arm, statement, evidence), searches=searches)
    if any(search.left for search in found.values()):
        said = f"undecided: {_left(subject.robot, searches)}"
        return Certificate(Verdict.UNDECIDED, "", said, searches)
    proof = proof_of(arm, found, directions)
    answer = subject.confirmed(statement, Verdict.PROVED, proof=proof)
    return replace(answer, searches=searches)


def proof_of(
    arm: BoundedArm, searches: Mapping[int, Search], directions: list[list[int]]
) -> dict[str, Any]:
    """Return the proof of a set as a certificate writes it."""
    trees = [[*searches[k].trees] if k in searches else [] for k in range(len(arm.names))]
    return {"directions": directions, "trees": trees}


def certify_region(
    subject: str | Robot | Subject,
    inset: float,
    margin: str = "0",
    held: Mapping[int, float] | None = None,
    progress: Progress = silent,
) -> Certificate:
    """Prove home's component except for a strip along its arcs; see `statements.inner_polygon`.

    The component is feasible by its definition. So if a polygon crosses itself or is refuted, it
    was drawn through too few points, and this says nothing about the component. The polygon is
    drawn again through more points. If that does not help, the answer is undecided.
    """
    subject, inset = Subject.of(subject), number_above_zero("inset", inset)
    for per_arc in PER_ARC:
        with suppress(statements.CrossesItself):
            statement = statements.inner_polygon(subject.robot, inset, per_arc, margin, held)
            answer = certify(subject, statement, progress=progress)
            if answer.verdict is not Verdict.REFUTED:
                return answer
    why = "undecided: the polygon through points of the region's arcs leaves the region or crosses"
    return Certificate(Verdict.UNDECIDED, "", f"{why} itself; another inset may do")


def by_boundary(arm: BoundedArm, searches: Mapping[int, Search]) -> dict[str, Search]:
    """Put the searches of all pairs of parts of two bodies together, by name."""
    together = dict[str, Search]()
    for k, own in searches.items():
        found = together.setdefault(arm.names[k], own)
        if found is not own:
            together[arm.names[k]] = Search(
                found.trees + own.trees,
                found.leaves + own.leaves,
                found.left + own.left,
                max(found.part_left, own.part_left),
                found.violation or own.violation,
                own.left_at if found.left_at is None else found.left_at,
            )
    return together


def _left(robot: Robot, searches: dict[str, Search]) -> str:
    """Return a text: the boundaries with undecided cells, their number, one position."""
    lines = [
        f"{name}: {counted(found.left, 'cell')}, {100 * found.part_left:.3g} % of the set,"
        f" as at {joint_text(robot, found.left_at)}"
        for name, found in searches.items()
        if found.left_at is not None
    ]
    more = [f"and {len(lines) - MOST_NAMED} more"] if len(lines) > MOST_NAMED else []
    return "; ".join([*lines[:MOST_NAMED], *more])


# --- the largest feasible scale -------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Bracket:
    """Two scales of the polygon of home's vertices, the lower proved, the upper refuted.

    Attributes
    ----------
    safe, unsafe : tuple of str and Certificate
        The scale as a decimal, with its certificate; ("", None) if no such scale was found.
    undecided : tuple of str
        A scale between them at which halving stopped, and why; ("", "") if it did not stop early.
    """

    safe: tuple[str, Certificate | None]
    unsafe: tuple[str, Certificate | None]
    undecided: tuple[str, str] = ("", "")


def bracket_scale(subject: str | Robot | Subject, *, width: float = 1e-9) -> Bracket:
    """Enclose the largest scale up to 1 about the centroid between a proof and a witness.

    Parameters
    ----------
    width : float
        Halving stops at this width, or at a scale with an undecided answer.

    Raises
    ------
    ValueError
        If the width is less than `FINEST`.
    """
    subject = Subject.of(subject)
    if number_above_zero("width", width) < FINEST:
        raise ValueError(f"width: {width:g}; {FINEST:g} or more is wanted")
    arm, corners = BoundedArm(subject.form), statements.home_vertices(subject.robot)
    low, high, tries, undecided = 0.0, 0.0, 1.0, ("", "")
    while low < 1 and (not low or not high or high - low > width) and tries > width:
        cells = cells_of(arm, statements.scaled_polygon(subject.robot, corners, tries))
        found = by_boundary(arm, safe.search(arm, cells, FEW_CELLS)[0])
        if any(search.violation is not None for search in found.values()):
            high = tries
        elif any(search.left for search in found.values()):
            undecided = statements.decimal(tries), _left(subject.robot, found)
            break
        else:
            low = tries
        tries = round((low + high) / 2, 12)
    lower, upper = (_at_scale(subject, corners, scale) for scale in (low, high))
    for k in range(WIDER if high else 0):  # too shallow for the checker: look deeper
        if upper[1] is None or upper[1].verdict is Verdict.REFUTED:
            break
        upper = _at_scale(subject, corners, round(min(high + 2**k * width, 1.0), 12))
    return Bracket(lower, upper, undecided)


def _at_scale(subject: Subject, corners: Floats, scale: float) -> tuple[str, Certificate | None]:
    if not scale:
        return "", None
    statement = statements.scaled_polygon(subject.robot, corners, scale)
    return statements.decimal(scale), certify(subject, statement)


# --- in words -------------------------------------------------------------------------------------

WIDEST = 100
"""Letters of a line that is read on a terminal."""

MANY = 12
"""Boundaries above which those of balls are summed up by their links."""


def certificate_lines(robot: Robot, answer: Certificate) -> Iterator[str]:
    """Yield the size of a proof or the depth of a witness; nothing if undecided."""
    if (witness := answer.witness) is not None:
        joints = list(zip(robot.joints, witness.q, file_units(robot), strict=True))
        units = {name: unit for joint, _, unit in joints for name in limit_names(joint.name)}
        unit = units.get(witness.boundary, robot.length_unit)
        place = ", ".join(f"{joint.name} = {x:.9g} {unit}" for joint, x, unit in joints)
        yield f"depth {witness.depth:.9g} {unit} at {place}"
    elif answer.verdict is Verdict.PROVED:
        counts = {name: found.leaves for name, found in answer.searches.items()}
        named = ", ".join(f"{name} {count}" for name, count in counts.items())
        if len(counts) > MANY:
            most = max(counts, key=counts.__getitem__)
            named = f"of {len(counts)} boundaries; at most {counts[most]}, of {most}"
        yield f"cells: {answer.leaves} ({named})"


def folded(text: str) -> Iterator[str]:
    """Break long lines of a checker's answer between words or points."""
    for line in text.splitlines():
        whole = re.sub(r", (?=[^()]*\))", ",\u00a0", line)  # points stay whole
        rows = wrap(whole, WIDEST, subsequent_indent="  ", break_long_words=False)
        yield from (row.replace("\u00a0", " ") for row in rows)


def summed_up(said: str, robot: check.Robot) -> str:
    """Shorten a checker's answer: join the balls LINK/1, LINK/2, ... of each link.

    Parameters
    ----------
    said : str
        The checker's answer.
    robot : check.Robot
        As the checker read it.
    """
    if len(robot.boundaries) <= MANY:
        return said
    lines = said.split("\n")
    first = next(k for k, line in enumerate(lines, 1) if line.startswith("all limits of joints"))
    rows: dict[tuple[str, ...], list[str]] = {}
    last = first
    for boundary in robot.boundaries:
        line = lines[last]
        if not line.startswith(f"  {boundary.name!a}: "):
            continue  # of this one nothing is claimed
        last += 1
        balls = [each.name for each in boundary.things if each.kind == "point" and each.radius]
        links = [name.rpartition("/")[0] for name in balls]
        named = all(links) and len(links) == len(boundary.things)
        what = "balls" if len(links) == 1 else "pairs of balls"
        key = (" and ".join(map(ascii, links)), what, line.rpartition(": ")[2])
        rows.setdefault(key if named else (line,), []).append(line)
    kept = [
        found[0] if len(found) == 1 else f"  {key[0]}: {len(found)} {key[1]}, {key[2]}"
        for key, found in rows.items()
    ]
    return "\n".join([*lines[:first], *kept, *lines[last:]])
