"""Certificates: proofs that every configuration of a set keeps every boundary (not in the paper).

The search here is floating point and untrusted: what it finds is written down, and the checkers
(`check`, `check_arb`) decide. See `forms.bending` for the bound, `statements` for the sets.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound import check
from qbound.boundary.functions import clearance
from qbound.export.formats import json_text
from qbound.forms.bending import second_order, worst_edges
from qbound.forms.harmonic import HarmonicForm
from qbound.geometry.simplices import halved
from qbound.model.robot import BodyPair, Boundary, Parallelogram, Robot
from qbound.model.robotfile import parse_robot
from qbound.proofs.boxes import search_box
from qbound.proofs.cells import Cell, cells_of
from qbound.proofs.features import (
    Features,
    Parts,
    all_features,
    asked_distance,
    is_of_bodies,
    parts_of,
)
from qbound.proofs.forest import Forest, Search, Tell, silent
from qbound.proofs.grammar import GRAMMAR, GRAMMAR_OF_BODIES, read_statement
from qbound.proofs.grammar_robot import read_robot
from qbound.proofs.minorant import Bound
from qbound.proofs.separating import Simplices, box_cell, search_features, together
from qbound.proofs.statements import (
    Statement,
    decimal,
    home_vertices,
    inner_polygon,
    scaled_polygon,
    units,
    wider,
)
from qbound.proofs.triangulation import CrossesItself
from qbound.proofs.verdict import Verdict
from qbound.proofs.witness import Evidence, Witness, beyond_limits, deepest, witness
from qbound.tolerances import NEGLIGIBLE

Floats = NDArray[np.float64]

MOST_CELLS = 200_000
"""Cells that a search opens for one boundary before it gives up."""

FIRST_LOOK = 1000
"""Cells opened for one boundary at first: enough to see that most sets are not safe."""

SEARCHING = 0.99
"""Part of the work that is told of as the search; the rest is the check of what it found."""

DEEPEST = 60
"""Cuts on top of each other before a search gives up; the checkers follow 120."""


PER_ARC = (12, 48, 192)
"""Points on each arc of a region, in turn, until its polygon is proved."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """The answer about a statement.

    Attributes
    ----------
    verdict : Verdict
        The first two are confirmed in exact arithmetic by `check.check`.
    text : str
        The file, JSON; empty where undecided.
    said : str
        What the checker says of the file; where undecided, what is left.
    searches : dict of str to Search
        By the name of the boundary.
    witness : Witness or None
    """

    verdict: Verdict
    text: str
    said: str
    searches: dict[str, Search] = field(default_factory=dict)
    witness: Witness | None = None

    @property
    def leaves(self) -> int:
        """Number of cells of the proof."""
        return sum(search.leaves for search in self.searches.values())


def no_certificate(robot: Robot) -> str:
    """Say why no certificate can hold a robot; empty where one can."""
    count = len(robot.joints)
    if count > check.MAX_JOINTS:
        return f"certificates take at most {check.MAX_JOINTS} joints; this robot has {count}"
    if any(isinstance(joint, Parallelogram) for joint in robot.joints):
        return "certificates know no parallelogram"
    return ""


def _certifiable(text: str) -> Robot:
    """Read a robot, and refuse it before any work if no certificate can hold it."""
    robot = parse_robot(tomllib.loads(text))
    reason = no_certificate(robot)
    if reason:
        raise ValueError(reason)
    return robot


def certify(
    text: str,
    statement: Statement,
    *,
    most: int = MOST_CELLS,
    bound: Bound = second_order,
    tell: Tell = silent,
) -> Certificate:
    """Prove or refute that every boundary in use holds all over a set.

    Parameters
    ----------
    text : str
        The robot file, see `robotfile.robot_text`.
    statement : dict
        From `statements`.
    most : int
        Cells that are opened for one boundary before the answer is "undecided".
    bound : callable
        The lower bound on a simplex; the checkers only follow `minorant.second_order`. A box has
        its own, see `boxes`.
    tell : callable
        Told how far it is, from 0 to 1.

    Raises
    ------
    ValueError
        If robot or statement is none that a certificate can hold, in a sentence that says why.

    Examples
    --------
    >>> from qbound.model.robotfile import robot_text
    >>> from qbound.proofs.statements import box
    >>> text, _ = robot_text("minervabot-v2")
    >>> answer = certify(text, box(["-10", "-10"], ["10", "10"]))  # in degrees, as the file
    >>> answer.verdict.value, answer.leaves
    ('proved', 5)

    Nobody has to believe it: the checker stands alone, and says whether the statement is refuted.

    >>> check.check(answer.text)[0]
    False

    What is not safe is refuted, with a configuration that violates a boundary:

    >>> answer = certify(text, box(["-10", "-10"], ["90", "10"]))
    >>> answer.verdict.value, answer.witness is not None
    ('refuted', True)
    """
    robot = _certifiable(text)
    exact = read_robot(text)
    cells = cells_of(read_statement(statement, exact), GRAMMAR)
    parts = parts_of(robot, exact)
    evidence = beyond_limits(exact, statement, cells)
    if evidence is not None:
        return _refuted(text, robot, statement, cells, evidence, parts)
    corners = [cell.corners for cell in cells]
    for few in (min(most, FIRST_LOOK), most):
        searches = search_all(
            robot, statement, corners, few, bound, lambda part: tell(SEARCHING * part), parts=parts
        )
        verdict = _verdict(searches)
        if verdict is not Verdict.UNDECIDED:
            break
    if verdict is Verdict.UNDECIDED:
        return Certificate(verdict, "", _left(searches), searches)
    if verdict is Verdict.PROVED:
        proof = {name: list(found.trees) for name, found in searches.items()}
        return _confirmed(text, statement, verdict, searches, parts, proof=proof)
    violated = {name: f.violation for name, f in searches.items() if f.violation is not None}
    evidence = deepest(robot, statement, cells, violated, parts)
    return _refuted(text, robot, statement, cells, evidence, parts, searches)


def certify_region(
    text: str,
    inset: float,
    margin: str = "0",
    held: Mapping[int, float] | None = None,
    tell: Tell = silent,
) -> Certificate:
    """Prove home's component but for a strip along its arcs; see `statements.inner_polygon`.

    It is safe by its definition. So a polygon that crosses itself or is refuted was drawn through
    too few points, and says nothing of the component: it is drawn again through more, and what is
    left in the end is undecided.
    """
    robot = _certifiable(text)
    for per_arc in PER_ARC:
        with suppress(CrossesItself):
            statement = inner_polygon(robot, inset, per_arc, margin, held)
            answer = certify(text, statement, tell=tell)
            if answer.verdict is not Verdict.REFUTED:
                return answer
    why = "undecided: the polygon through points of the region's arcs leaves the region or crosses"
    return Certificate(Verdict.UNDECIDED, "", f"{why} itself; another inset may do")


def _refuted(
    text: str,
    robot: Robot,
    statement: Statement,
    cells: Sequence[Cell],
    evidence: Evidence,
    parts: Parts | None,
    searches: dict[str, Search] | None = None,
) -> Certificate:
    """Write a refutation, and say how deep its witness lies."""
    answer = _confirmed(text, statement, Verdict.REFUTED, searches or {}, parts, **evidence)
    return replace(answer, witness=witness(robot, statement, cells, evidence, parts))


def _verdict(searches: dict[str, Search]) -> Verdict:
    """Return the answer of searches, which nothing has confirmed."""
    refuted = any(found.violation is not None for found in searches.values())
    return Verdict.of(not any(found.left for found in searches.values()), refuted)


def search_all(
    robot: Robot,
    statement: Statement,
    cells: Sequence[Any],
    most: int,
    bound: Bound = second_order,
    tell: Tell = silent,
    *,
    parts: Parts | None = None,
) -> dict[str, Search]:
    """Search every boundary in use that can be violated at all.

    Parameters
    ----------
    cells : sequence of sequence of point
        Corners of simplices; of a box the low and the high one. In the file's units.
    parts : mapping, optional
        From `parts_of`; needed of a robot with pairs of bodies.
    """
    corners = np.array(cells, dtype=float) * units(robot)
    forms, bodies = _forms(robot, statement), _between_bodies(robot, statement)
    count, found = len(forms) + len(bodies), {}
    for k, (name, form) in enumerate(forms.items()):
        told = partial(_tell_of_all, tell, k, count)
        if statement["set"] == "box":
            found[name] = search_box(form, corners[0, 0], corners[0, 1], most, told)
        else:
            found[name] = search(form, corners, most, bound, told)
    for k, (asked, boundary) in enumerate(bodies, len(forms)):
        told = partial(_tell_of_all, tell, k, count)
        features = all_features(asked, boundary, parts or {})
        found[boundary.name] = _search_bodies(features, corners, statement["set"], most, told)
    return found


def _search_bodies(
    features: Sequence[Features], corners: Floats, kind: str, most: int, tell: Tell
) -> Search:
    """Search all pairs of parts of two bodies, or the places of one above a plane."""
    cells = box_cell(corners[0, 0], corners[0, 1]) if kind == "box" else Simplices(corners)
    found = []
    for k, pair in enumerate(features):
        told = partial(_tell_of_all, tell, k, len(features))
        found.append(search_features(pair, cells, most, told))
        if found[-1].violation is not None:
            break
    return together(found)


def _tell_of_all(tell: Tell, k: int, count: int, part: float) -> None:
    tell((k + part) / count)


def search(
    form: HarmonicForm,
    cells: Floats,
    most: int,
    bound: Bound = second_order,
    tell: Tell = silent,
) -> Search:
    """Cut cells across the edge that bends most until the bound is positive on each.

    Parameters
    ----------
    cells : ndarray, shape (N, k, n)
        Corners of simplices, rad or length.
    """
    slack = NEGLIGIBLE * np.abs(form.waves.amplitudes).sum()
    forest = Forest(len(cells))
    numbers, roots, parts = np.arange(len(cells)), np.arange(len(cells)), np.ones(len(cells))
    leaves, opened = 0, 0
    for _ in range(DEEPEST):
        centres = form(cells.mean(axis=1))
        if len(cells) and centres.min() < -slack:
            worst, left = int(centres.argmin()), float(parts.sum() / forest.size)
            violation = int(roots[worst]), cells[worst].mean(axis=0)
            return Search((), leaves, len(cells), left, violation)
        proved = bound(form, cells) > slack
        forest.close(numbers[proved])
        leaves, opened = leaves + int(proved.sum()), opened + len(cells)
        cells, numbers, roots, parts = (x[~proved] for x in (cells, numbers, roots, parts))
        tell(1 - float(parts.sum()) / forest.size)
        if not len(cells) or opened > most:
            break
        edges = worst_edges(form, cells)
        cells, numbers = halved(cells, edges), forest.cut(numbers, edges)
        roots, parts = np.repeat(roots, 2), np.repeat(parts / 2, 2)
    return Search(forest.trees(), leaves, len(cells), float(parts.sum() / max(forest.size, 1)))


def leaves(cells: Floats, trees: Sequence[str]) -> Floats:
    """Return the simplices on which a proof rests, shape (N, k, n), from its cells and trees."""
    found = []
    for cell, tree in zip(cells, trees, strict=True):
        todo = [cell]
        for letter in tree:
            top = todo.pop()
            if letter == ".":
                found.append(top)
            else:
                edge = np.array([ord(letter) - ord("a")])
                todo += list(halved(top[None], edge)[::-1])
    return np.array(found)


# --- what is asked for ----------------------------------------------------------------------------


def _forms(robot: Robot, statement: Statement) -> dict[str, HarmonicForm]:
    """Forms of the boundaries of points in use, by name; without those that nothing can violate."""
    asked = wider(robot, statement)
    return {
        boundary.name: clearance(asked, boundary)
        for boundary in asked.used
        if not is_of_bodies(boundary) and asked.least_distance(boundary) != 0
    }


def _between_bodies(robot: Robot, statement: Statement) -> list[tuple[Robot, Boundary]]:
    """Return the boundaries of bodies that anything can violate, with the robot that asks."""
    asked = wider(robot, statement)
    bodies = [boundary for boundary in asked.used if is_of_bodies(boundary)]
    return [(asked, boundary) for boundary in bodies if _can_be_violated(asked, boundary)]


def _can_be_violated(robot: Robot, boundary: Boundary) -> bool:
    """Tell whether it needs a proof: what has no inside is 0 apart, but for two segments."""
    if not isinstance(boundary, BodyPair):
        return True
    bodies = [robot.body(name) for name in boundary.bodies]
    corners = sum(len(body.shape.places) for body in bodies)
    return corners > 3 or asked_distance(robot, boundary) != 0


# --- the file -------------------------------------------------------------------------------------


def _confirmed(
    robot: str,
    statement: Statement,
    verdict: Verdict,
    searches: dict[str, Search],
    parts: Parts | None = None,
    **evidence: Any,
) -> Certificate:
    """Write the file of grammar 2, or of bodies, and hand it to the checker."""
    if parts is not None:
        evidence = {"parts": parts, **evidence}
    grammar = GRAMMAR if parts is None else GRAMMAR_OF_BODIES
    found = confirmed(robot, grammar, statement, verdict, **evidence)
    return replace(found, searches=searches)


def confirmed(
    robot: str, grammar: int, statement: Statement, verdict: Verdict, **evidence: Any
) -> Certificate:
    """Write a file and hand it to the checker: what that does not confirm is not answered."""
    content = {
        "schema": f"qbound/certificate/{grammar}",
        "verdict": verdict,
        "statement": statement,
        "robot": robot,
        "sha256": check.digest(robot),
        **evidence,
    }
    text = json_text(content)
    try:
        said = check.check(text).said
    except ValueError as error:
        said = f"not confirmed in exact arithmetic: {error}"
        return Certificate(Verdict.UNDECIDED, "", said)
    return Certificate(verdict, text, said)


def _left(searches: dict[str, Search]) -> str:
    lines = [
        f"{name}: {found.left} cells, {100 * found.part_left:.3g} % of the set"
        for name, found in searches.items()
        if found.left
    ]
    return "undecided: " + "; ".join(lines)


# --- the largest safe scale -----------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Bracket:
    """Two scales of the polygon of home's vertices, the lower proved safe, the upper refuted.

    Attributes
    ----------
    safe, unsafe : tuple of str and Certificate
        The scale as a decimal, and its answer; ("", None) where no such scale was found.
    """

    safe: tuple[str, Certificate | None]
    unsafe: tuple[str, Certificate | None]


def bracket_scale(text: str, *, width: float = 1e-9, highest: float = 1.0) -> Bracket:
    """Enclose the largest safe scale about the centroid of the area between a proof and a witness.

    Parameters
    ----------
    width : float
        Halving stops here, or where the answer is undecided.
    highest : float
        Scales above it are not tried.
    """
    robot = _certifiable(text)
    corners, parts = home_vertices(robot), parts_of(robot, read_robot(text))
    low, high, tries = 0.0, 0.0, highest
    while low < highest and (not low or not high or high - low > width) and tries > width:
        answer = _tried(robot, scaled_polygon(robot, corners, tries), parts)
        if answer is Verdict.UNDECIDED:
            break
        low, high = (tries, high) if answer is Verdict.PROVED else (low, tries)
        tries = round((low + high) / 2, 12)
    return Bracket(*(_at_scale(text, robot, corners, scale) for scale in (low, high)))


def _tried(robot: Robot, statement: Statement, parts: Parts | None) -> Verdict:
    loop = statement["points"][0]
    cells = [[loop[k] for k in triangle] for triangle in statement["triangles"]]
    return _verdict(search_all(robot, statement, cells, 20 * FIRST_LOOK, parts=parts))


def _at_scale(
    text: str, robot: Robot, corners: Floats, scale: float
) -> tuple[str, Certificate | None]:
    if not scale:
        return "", None
    return decimal(scale), certify(text, scaled_polygon(robot, corners, scale))
