"""The paper's rule in exact numbers: the windows of Table 6 as balls, and what cuts them."""

from __future__ import annotations

from typing import Any

from qbound.boundary.functions import pair_vector
from qbound.model.robot import HalfSpace, Robot
from qbound.proofs.balls import arb, ball, balls, pi, precision, turns
from qbound.proofs.crossings import line_roots
from qbound.proofs.exact import BITS, ExactProblem, exact_state
from qbound.region import paper_rule
from qbound.region.paper_rule import Window


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
    upper = [_upper(exact, window) for window in own]
    lower = [end - turns(1) for end in upper]
    home = ball(exact.home[joint])
    on_turn = all(x < home < y for x, y in zip(lower, upper, strict=True))
    if limits := exact.joints[joint].limits:  # eq. (10)
        lower, upper = [*lower, ball(limits[0])], [*upper, ball(limits[1])]
    low, high = max(lower, key=float), min(upper, key=float)
    if any(x > low for x in lower) or any(x < high for x in upper) or not on_turn:
        raise ValueError(f"joint {joint + 1}: rounding hides which window binds, or on which turn")
    return low, high


def _upper(exact: Robot, window: Window) -> arb:
    """Return the root theta + alpha of a window's component, on the window's turn (eq. 39)."""
    pair: Any = exact.boundary(window.boundary)
    component = pair_vector(exact, pair)[window.component - 1]
    c = balls(component.along(window.joint, [ball(0)] * len(exact.joints)))
    roots = line_roots(exact.kinds[window.joint], c)
    if not roots:
        raise ValueError(f"{window.boundary}: it is not proved that this component reaches zero")
    return roots[-1] + turns(round((window.upper - float(roots[-1])) / float(2 * pi())))
