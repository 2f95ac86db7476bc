"""What chapter 15 proves of the paper's arm: its rule in exact numbers, and areas of its images.

The windows of Table 6 are balls, and half-spaces cut them. Areas in the plane of the tool are
balls too: of the image of each aspect of a region of two joints.

det J depends on the second joint alone, so it is a boundary like any other: the region of one sign
is proved with it as one more form, and its image has the area of the integral of abs(det J), which
Green's theorem turns into one of q1 det J dq2 along the proved arcs. Not in the paper, which
samples.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Array
from qbound.boundary.functions import position
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import HalfSpace, Robot
from qbound.proofs.exact.numbers import arb, ball, balls, precision, turns
from qbound.proofs.exact.problem import BITS, ExactProblem, exact_state
from qbound.proofs.exact.region import BITS as AREA_BITS
from qbound.proofs.exact.region import ProvedComponent, prove_region
from qbound.proofs.exact.runs import area_under
from qbound.region import Problem, paper_rule, solve
from qbound.region.paper_rule import window_end
from qbound.workspace import planar
from qbound.workspace.areas import SINGULAR


def exact_windows_problem(robot: Robot, exact: Robot) -> ExactProblem:
    """State the paper's rule: the box of all windows, cut by the half-spaces in use (Table 6).

    Parameters
    ----------
    robot : Robot
        With floats: it tells which windows there are and which turn each takes.
    exact : Robot
        The same robot from `exact_robot`.

    Raises
    ------
    ValueError
        If the paper's rule says nothing about the robot, or it is not proved which window binds.
    """
    stated = paper_rule.problem(robot)
    with precision(BITS):
        sides = [_side(robot, exact, joint) for joint in range(len(robot.joints))]
    cuts = [b for b in exact.used if isinstance(b, HalfSpace)]
    return exact_state(exact, cuts, sides, stated.limits)


def _side(robot: Robot, exact: Robot, joint: int) -> tuple[arb, arb]:
    """Return the highest lower end and the lowest upper end of a joint's windows and limits."""
    own = [window for window in paper_rule.windows(robot) if window.joint == joint]
    upper = [window_end(exact, window) for window in own]
    lower = [end - turns(1) for end in upper]
    home = ball(exact.home[joint])
    on_turn = all(x < home < y for x, y in zip(lower, upper, strict=True))
    if limits := exact.joints[joint].limits:  # eq. (10)
        lower, upper = [*lower, ball(limits[0])], [*upper, ball(limits[1])]
    low, high = max(lower, key=float), min(upper, key=float)
    if any(x > low for x in lower) or any(x < high for x in upper) or not on_turn:
        raise ValueError(f"joint {joint + 1}: rounding hides which window binds, or on which turn")
    return low, high


@dataclass(frozen=True, eq=False)
class ProvedImage:
    """A part of a region on which det J keeps its sign, and what the tool sweeps over it.

    Attributes
    ----------
    part : ProvedComponent
    side : int
        Sign of det J.
    swept : arb
        Integral of abs(det J), length squared: the area of the image, a place that is reached on
        two full turns of a joint counted twice.
    """

    part: ProvedComponent
    side: int
    swept: arb


def jacobian_determinant(exact: Robot) -> HarmonicForm:
    """Return det J of the tool in the plane of x and z, in exact numbers: a form of two joints.

    Parameters
    ----------
    exact : Robot
        From `exact_robot`, of two joints.

    Raises
    ------
    ValueError
        If the tool leaves the plane of x and z.
    """
    from flint import fmpq

    with precision(BITS):
        tool = position(exact, exact.tool)
        if not all(c.contains(0) for c in balls(tool[1].derivatives.coefficients).flat):
            raise ValueError(f"{exact.name}: the tool leaves the plane of x and z")
        rational = tool.coefficients[[0, 2]] + fmpq(0)  # whole numbers would be halved to floats
        return planar.jacobian_determinant(HarmonicForm(rational, exact.kinds))


def proved_images(
    exact: ExactProblem, problem: Problem, home: ArrayLike, determinant: HarmonicForm
) -> list[ProvedImage]:
    """Prove the parts of a region on which det J has one sign, and enclose what each sweeps.

    Parameters
    ----------
    exact, problem : ExactProblem and Problem
        The same region, in exact numbers and in floats.
    home : array_like, shape (2,)
    determinant : HarmonicForm
        From `jacobian_determinant`.

    Raises
    ------
    Unproved
        As `prove_region`.
    ValueError
        If a part goes round the first joint, or bodies are to keep apart.
    """
    if exact.bodies:
        raise ValueError("areas of images are proved of boundaries of points alone, not of bodies")
    found, floats = [], balls(determinant.coefficients).astype(float)
    for side in (1, -1):
        one = _with(exact, side * determinant.coefficients)
        other = problem.with_form(SINGULAR, side * floats)
        for part in prove_region(one, solve(other, home)).components:
            with precision(AREA_BITS):
                found.append(ProvedImage(part, side, _swept(one, part)))
    return found


def _swept(problem: ExactProblem, part: ProvedComponent) -> arb:
    total = ball(0)
    for loop in part.loops:
        (p1, p2), (q1, q2) = loop[0].start, loop[-1].end
        if not ((q1 - p1).contains(0) and (q2 - p2).contains(0)):
            raise ValueError("a part of the region goes round a joint: its image is not proved")
        weight = balls(problem.forms.coefficients[-1, 0])
        total += sum((area_under(problem, run, weight) for run in loop), start=ball(0))
    return total


def _with(problem: ExactProblem, coefficients: Array) -> ExactProblem:
    table = np.concatenate([problem.forms.coefficients, coefficients[None]])
    forms = HarmonicForm(table, problem.kinds)
    return replace(problem, forms=forms, names=(*problem.names, SINGULAR))
