"""The paper's rule in exact numbers: the windows of Table 6 as balls, and what cuts them."""

from __future__ import annotations

from qbound.model.robot import HalfSpace, Robot
from qbound.proofs.balls import arb, ball, precision, turns
from qbound.proofs.exact import BITS, ExactProblem, exact_state
from qbound.region import paper_rule
from qbound.region.paper_rule import window_end


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
