"""Certificates that no path leads from one configuration to another while some joints are held.

Grammar 5 of the book's page "The certificate": a tree over the box of the joints that move. On each
leaf with a number one boundary is violated throughout, and these leaves separate the two.
"""

from __future__ import annotations

import re
import tomllib

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound import check
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot
from qbound.proofs.certify import Certificate, confirmed
from qbound.proofs.grammar import GRAMMAR_OF_DISCONNECTED, NO_PATH
from qbound.proofs.paving import Paving
from qbound.proofs.separator import covering, separator
from qbound.proofs.statements import units, within_limits
from qbound.proofs.verdict import Verdict

Floats = NDArray[np.float64]


def certify_disconnected(
    text: str, one: ArrayLike, other: ArrayLike, paving: Paving
) -> Certificate:
    """Certify that no path joins two configurations while the joints that agree are held.

    Not in the paper.

    Parameters
    ----------
    text : str
        The robot file, see `robotfile.robot_text`.
    one, other : array_like, shape (n,)
        rad or length; what is written is rounded to decimals.
    paving : Paving
        Of the joints that move, one to three; it separates the two.

    Returns
    -------
    Certificate
        Proved, or undecided where the checker does not follow.

    Raises
    ------
    ValueError
        If a configuration is none of the robot's, or the paving does not separate the two.
    """
    robot = parse_robot(tomllib.loads(text))
    ends = np.stack([robot.configuration(q) for q in (one, other)])
    free = _free(robot, paving)
    points = within_limits(robot, ends)
    low, high = _box(robot, free)
    kinds = paving.bounds.table.kinds
    forms = HarmonicForm(paving.bounds.table.coefficients[:, 0], kinds)
    found = covering(separator(paving, *ends[:, free]), forms, low, high)
    if found.left:
        return Certificate(Verdict.UNDECIDED, "", f"undecided: {found.left} boxes")
    tree, names = _numbered(found.tree, free, paving.problem.names)
    statement = {"set": NO_PATH, "margin": "0", "points": [points], "free": free}
    proof = {"boundaries": names, "tree": tree}
    return confirmed(text, GRAMMAR_OF_DISCONNECTED, statement, Verdict.PROVED, proof=proof)


def _free(robot: Robot, paving: Paving) -> list[int]:
    """Return the joints of a paving, by the names of their limits."""
    lower = [f"{joint.name}.lower" for joint in robot.joints]
    return [lower.index(name) for name, _ in paving.problem.limits]


def _box(robot: Robot, free: list[int]) -> tuple[Floats, Floats]:
    """Return the box that the checkers cut: limits, or a whole turn and what rounding takes."""
    scale, (first, last) = units(robot), check.WHOLE_TURN[robot.angle_unit]
    rows = [
        robot.joints[j].limits or (float(first) * scale[j], float(last) * scale[j]) for j in free
    ]
    low, high = np.array(rows, dtype=float).T
    return low, high


def _numbered(tree: str, free: list[int], names: tuple[str, ...]) -> tuple[str, list[str]]:
    """Write a tree with the joints of the robot, and the boundaries in order of appearance."""
    used = list(dict.fromkeys(int(k) for k in re.findall("[0-9]+", tree)))

    def token(match: re.Match[str]) -> str:
        found = match.group()
        if found.isdigit():
            return str(used.index(int(found)))
        return chr(ord("a") + free[ord(found) - ord("a")])

    return re.sub("[0-9]+|[a-z]", token, tree), [names[k] for k in used]
