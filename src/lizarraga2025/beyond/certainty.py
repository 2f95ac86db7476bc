r"""What chapter 15 proves of the paper's arm: its rule in exact numbers, and areas of its images.

The windows of Table 6 are balls, and half-spaces cut them. Areas in the plane of the tool are
balls too: of the image of each aspect of a region of two joints.

det J depends on the second joint alone, so it is a boundary like any other: the region of one sign
is proved with it as one more form, and its image has the area of the integral of abs(det J). Not in
the paper, which samples.

Below them stand lower bounds of a boundary function over simplices of joint space. Certificates
have a bound of their own, on the way of a corner (`inequality`). These three are on the boundary
function, a sum of waves, and are here to compare: by the second derivative, by the range of each
wave, and by the slope.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Array, Floats
from cspace.boundary.functions import clearance
from cspace.forms.bending import second_order, worst_edges
from cspace.forms.harmonic import derivatives, waves
from cspace.geometry import simplices
from cspace.model.robot import HalfSpace, Robot
from cspace.proofs.certificates.statements import Statement, corners_of, units, wider
from cspace.proofs.exact.numbers import arb, ball, balls, precision, turns
from cspace.proofs.exact.problem import BITS, ExactProblem, exact_state
from cspace.proofs.exact.region import ProvedComponent, prove_region
from cspace.proofs.subdivide import Cells, Judged, Search, Simplices, subdivide
from cspace.region import Problem, solve, window_problem
from cspace.region.exact import Exact
from cspace.region.kinds import CROSS
from cspace.region.scene import scene_of
from cspace.tolerances import NEGLIGIBLE
from cspace.workspace import planar
from cspace.workspace.areas import SINGULAR
from qbound import joint_windows, window_region
from qbound.boundary import pair_vector, position
from qbound.forms import HarmonicForm
from qbound.windows import Window


def exact_windows_problem(robot: Robot, exact: Robot) -> ExactProblem:
    """State the rule by windows: the box of all windows, cut by the half-spaces in use (Table 6).

    Parameters
    ----------
    robot : Robot
        With floats: it tells which windows there are and which turn each takes.
    exact : Robot
        The same robot from `exact_robot`.

    Raises
    ------
    ValueError
        If the rule by windows says nothing about the robot, or it is not proved which window binds.
    """
    with precision(BITS):
        sides = [_side(robot, exact, joint) for joint in range(len(robot.joints))]
    cuts = [b for b in exact.used if isinstance(b, HalfSpace)]
    return exact_state(exact, cuts, sides, window_problem(window_region(robot)).limits)


def curve_crossings(problem: Problem) -> int:
    """Count the points at which two boundary curves cross, feasible or not, in exact numbers.

    They lie over the zeros of the resultant of both forms, where two of their roots are one. A form
    that does not depend on the second joint is zero along a whole fibre, and meets every root of
    the other form there.

    Examples
    --------
    >>> from cspace import load_robot
    >>> from cspace.region import clearance_problem
    >>> curve_crossings(clearance_problem(load_robot("minervabot-v2")))
    32
    """
    exact, count = Exact(scene_of(problem, base=0)), 0

    def along(curve: int, t: arb) -> list[arb | None]:
        """Return the real roots over a base value; None stands for the whole fibre."""
        if not exact.scene.lifted[curve]:
            return [None]
        both = (exact.root((curve, slope, 0), t) for slope in (1, -1))
        return [root for root in both if root is not None]

    with exact.flint.ctx.workprec(BITS):
        for i, j in combinations(range(len(problem.names)), 2):
            for event in exact.zeros(CROSS, i, j):
                t = exact.ball(*exact.number(event), BITS)
                for one, other in product(along(i, t), along(j, t)):
                    count += one is None or other is None or one.overlaps(other)
    return count


def _side(robot: Robot, exact: Robot, joint: int) -> tuple[arb, arb]:
    """Return the highest lower end and the lowest upper end of a joint's windows and limits."""
    own = [window for window in joint_windows(robot) if window.joint == joint]
    upper = [_window_end(exact, window) for window in own]
    lower = [end - turns(1) for end in upper]
    home = ball(exact.home[joint])
    on_turn = all(x < home < y for x, y in zip(lower, upper, strict=True))
    if limits := exact.joints[joint].limits:  # eq. (10)
        lower, upper = [*lower, ball(limits[0])], [*upper, ball(limits[1])]
    low, high = max(lower, key=float), min(upper, key=float)
    if any(x > low for x in lower) or any(x < high for x in upper) or not on_turn:
        raise ValueError(f"joint {joint + 1}: rounding hides which window binds, or on which turn")
    return low, high


def _window_end(exact: Robot, window: Window) -> arb:
    r"""Return the upper end of a window as a ball: the root :math:`\theta + \alpha` (eq. 39).

    Raises
    ------
    ValueError
        If it is not certain that the component reaches zero.
    """
    import flint

    component = pair_vector(exact, exact.boundary(window.boundary))[window.component - 1]
    still = np.array([ball(0)] * len(exact.joints))
    c, a, b = (ball(x.item()) for x in component.along(window.joint, still))
    square = a * a + b * b - c * c
    if not square >= 0:
        raise ValueError(f"{window.boundary}: it is not proved that this component reaches zero")
    root = flint.arb.atan2(a * square.sqrt() - b * c, -a * c - b * square.sqrt())
    return root + turns(round((window.upper - float(root)) / (2 * math.pi)))


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
        if not all(c.contains(0) for c in balls(derivatives(tool[1]).coefficients).flat):
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
        If bodies are to keep apart.
    """
    if exact.bodies:
        raise ValueError("areas of images are proved of boundaries of points alone, not of bodies")
    found, floats = [], balls(determinant.coefficients).astype(float)
    for side in (1, -1):
        one = _with(exact, side * determinant.coefficients)
        other = problem.with_form(SINGULAR, side * floats)
        weight = one.forms.coefficients[-1, 0]
        for part in prove_region(one, solve(other, home)).components:
            found.append(ProvedImage(part, side, part.integral(weight)))
    return found


def _with(problem: ExactProblem, coefficients: Array) -> ExactProblem:
    table = np.concatenate([problem.forms.coefficients, coefficients[None]])
    forms = HarmonicForm(table, problem.kinds)
    return replace(problem, forms=forms, names=(*problem.names, SINGULAR))


# --- lower bounds over simplices ------------------------------------------------------------------


__all__ = ["Bound", "leaves", "lipschitz", "natural", "search_all", "second_order"]


Bound = Callable[[HarmonicForm, Floats], Floats]
"""From a form and cells, shape (N, k, n), to a number below the form on each cell, shape (N,)."""


def lipschitz(form: HarmonicForm, cells: Floats) -> Floats:
    r"""Bound by the slope: :math:`\beta(m) - \sum_k |A_k| |w_k \cdot d|`. Revolute joints only."""
    centre, terms = cells.mean(axis=1), waves(form)
    angles = np.abs((cells - centre[:, None]) @ terms.turns.T)
    return np.asarray((form(centre)[:, None] - angles @ np.abs(terms.amplitudes)).min(axis=1))


def natural(form: HarmonicForm, cells: Floats) -> Floats:
    """Bound by interval arithmetic: each wave by its least value on the cell. Revolute joints only.

    Already better than the natural extension of products of sines and cosines, which forgets that
    the factors belong together.
    """
    terms = waves(form)
    phases = cells @ terms.turns.T + np.angle(terms.amplitudes)
    low, high = phases.min(axis=1), phases.max(axis=1)
    trough = np.floor((high - math.pi) / (2 * math.pi)) >= np.ceil((low - math.pi) / (2 * math.pi))
    least = np.where(trough, -1.0, np.minimum(np.cos(low), np.cos(high)))
    return np.asarray(least @ np.abs(terms.amplitudes))


def search_all(
    robot: Robot, statement: Statement, bound: Bound, most: int = 300_000
) -> dict[str, Search]:
    """Cut the triangles of a polygon until a bound is positive on each, for every boundary in use.

    Parameters
    ----------
    robot : Robot
        All of its boundaries in use are about points.
    most : int
        Cells that are opened for one boundary before it is left.
    """
    asked = wider(robot, statement)
    forms = {
        boundary.name: clearance(asked, boundary)
        for boundary in asked.used
        if asked.least_distance(boundary) != 0
    }
    cells = Simplices(np.array(corners_of(statement), dtype=float) * units(robot))
    return {
        name: subdivide(cells, [0], _judge(form, bound), most)[0] for name, form in forms.items()
    }


def _judge(form: HarmonicForm, bound: Bound) -> Callable[[Cells, NDArray[Any]], Judged]:
    slack = NEGLIGIBLE * np.abs(waves(form).amplitudes).sum()

    def judge(cells: Cells, _: NDArray[Any]) -> Judged:
        assert isinstance(cells, Simplices)
        proved = bound(form, cells.corners) > slack
        leaves = ["." if each else "" for each in proved]
        margins = form(cells.centres)
        margins = np.where(margins < -slack, margins, 0)
        return Judged(leaves, worst_edges(form, cells.corners), margins, cells.centres)

    return judge


def leaves(corners: Floats, trees: Sequence[str]) -> Floats:
    """Return the simplices on which a proof rests, shape (M, k, n).

    Parameters
    ----------
    corners : ndarray, shape (N, k, n)
        Of the cells, in any unit.
    trees : sequence of str
        One for each cell.
    """
    found = []
    for cell, tree in zip(corners, trees, strict=True):
        todo = [cell]
        for token in re.findall("[a-z]|[0-9]*[.]", tree):
            top = todo.pop()
            if token.endswith("."):
                found.append(top)
            else:
                todo += [*simplices.halved(top[None], np.array([ord(token) - ord("a")]))[::-1]]
    return np.array(found)
