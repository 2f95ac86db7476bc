"""Boundary functions with exact numbers, which every proof uses.

Numbers are those of `cspace.model.exact`. The forms that `boundary` derives from these numbers are
exact too, by the same code as for floats.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cspace.boundary.contacts import ExactSeparation, exact_separations
from cspace.boundary.evaluator import limit_names, stacked
from cspace.boundary.poses import bounds_bodies
from cspace.model.exact import ExactNumbers, frozen
from cspace.model.robot import Boundary, Robot
from cspace.model.robotfile import parse_robot, robot_text
from cspace.proofs.exact.numbers import arb, ball, pi, precision
from qbound.forms import HarmonicForm, Kind

BITS = 512
"""Precision of what is no rational: far above that of any proof, so that it never shows."""


@dataclass(frozen=True, eq=False)
class ExactProblem:
    """Forms with exact coefficients, and the ranges of their joints as balls.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        Coefficients (dtype object) are rationals or balls.
    names : tuple of str
        One a form.
    ranges : tuple of (arb, arb) or None
        One a joint; None where it turns all the way round.
    limits : tuple of (str, str)
        Names of the lower and the upper end of each range.
    bodies : tuple of ExactSeparation
        Separating tests of the bodies that are to keep apart.
    """

    forms: HarmonicForm
    names: tuple[str, ...]
    ranges: tuple[tuple[arb, arb] | None, ...]
    limits: tuple[tuple[str, str], ...]
    bodies: tuple[ExactSeparation, ...] = ()

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kind of each joint."""
        return self.forms.kinds

    @property
    def ends(self) -> tuple[tuple[arb, arb], ...]:
        """Ranges as pairs of balls; a full turn starts at -pi."""
        return tuple((-pi(), pi()) if r is None else r for r in self.ranges)


def exact_robot(source: str | Path | Robot) -> Robot:
    """Return a robot whose numbers are exact (dtype object); not in the paper.

    Parameters
    ----------
    source : str, Path or Robot
        A robot file, the name of a packaged robot, or a robot. Each decimal of the file counts as
        it is written. A number that was changed, or that belongs to a robot not read from a file,
        is a double and counts as an exact binary fraction.

    Raises
    ------
    ValueError
        As `load_robot`; also if a number has an exponent beyond the range of doubles.
    """
    with precision(BITS):
        robot = source if isinstance(source, Robot) else parse_robot(*robot_text(source))
        return ExactNumbers(robot, robot.source.exact if robot.source else {}).robot


def exact_problem(robot: Robot, held: Mapping[int, Any] | None = None) -> ExactProblem:
    """State the clearance rule of an exact robot: boundaries in use, and limits (eqs. 10-12).

    Parameters
    ----------
    robot : Robot
        From `exact_robot`.
    held : mapping of int to number, optional
        Values of joints that are held, rad or length: floats or balls.

    Raises
    ------
    ValueError
        If a proof about the bodies that are to keep apart is not possible; see `exact_separations`.
    """
    held = {j: ball(value) for j, value in (held or {}).items()}
    free = [joint for j, joint in enumerate(robot.joints) if j not in held]
    limits = [limit_names(joint.name) for joint in free]
    formed = [boundary for boundary in robot.used if not bounds_bodies(boundary)]
    problem = exact_state(robot, formed, [joint.limits for joint in free], limits, held)
    with precision(BITS):
        return replace(problem, bodies=exact_separations(robot, robot.used, held))


def paving_bytes(boundaries: int, joints: int) -> int:
    """Estimate the memory of exact forms of many joints with their first and second derivatives.

    Each form and each derivative has :math:`3^n` coefficients, of about 250 bytes each (measured).

    Examples
    --------
    >>> paving_bytes(114, 7) // 10**6, paving_bytes(193, 3) // 10**6  # megabytes
    (3552, 16)
    """
    return int(250 * boundaries * 3**joints * (1 + joints + joints**2))


def exact_state(
    robot: Robot,
    used: Sequence[Boundary],
    ranges: Sequence[Any],
    limits: Sequence[tuple[str, str]],
    held: Mapping[int, arb] | None = None,
) -> ExactProblem:
    """Gather the exact clearance forms of some boundaries within given ranges."""
    with precision(BITS):
        forms = stacked(frozen(robot, held) if held else robot, used)
    balls = tuple(None if r is None else (ball(r[0]), ball(r[1])) for r in ranges)
    return ExactProblem(forms, tuple(b.name for b in used), balls, tuple(limits))
