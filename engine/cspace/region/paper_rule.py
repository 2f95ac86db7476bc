"""The paper's rule for the region: the windows of Table 6 make a box, geometric functions cut it.

Every component of a point boundary function allows a joint one full turn, from one meeting of
that component to the next (eq. 39). The intersection of these windows is a box in joint space, and
the half-spaces in use cut its corners. This rule does not ask whether the two points really meet.
The clearance rule does, and the two rules are kept separate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats
from cspace.boundary.evaluator import limit_names
from cspace.boundary.functions import clearance
from cspace.model.robot import Boundary, HalfSpace, Pair, Robot, joint_values
from cspace.printable import printable
from cspace.region.problem import Problem, state
from cspace.tolerances import ZERO_AMPLITUDE
from qbound.boundary import pair_vector
from qbound.circle import TURN, circle_roots, first_from
from qbound.forms import HarmonicForm

AnyBoundary = TypeVar("AnyBoundary", bound=Boundary)

UPPER: Final = 1
LOWER: Final = 2


@dataclass(frozen=True)
class Bound:
    r"""The bound :math:`\beta_{i,j,k}` of boundary i.

    Component j is 1, 2, 3 for x, y, z; k is 1 for the upper bound, 2 for the lower. A joint limit
    (eq. 10) has no component: j is 0, and the boundary is the limit, such as ``q2.lower``.
    """

    boundary: str
    component: int
    k: int

    @property
    def label(self) -> str:
        """The paper's label, such as ``beta_{1,3,1}`` (B1, third, upper), or a limit's name."""
        if not self.component:
            return self.boundary
        index = self.boundary.removeprefix("B")
        return f"beta_{{{index},{self.component},{self.k}}}"


@dataclass(frozen=True)
class Window:
    """The values that one component allows for one joint: a full turn, rad (Table 6)."""

    boundary: str
    component: int
    joint: int
    lower: float
    upper: float


@dataclass(frozen=True, eq=False)
class Box:
    """Intersection of windows and limits: lowest and highest joint values (rad), with bounds."""

    lower: Floats
    upper: Floats
    lower_bounds: tuple[Bound, ...]
    upper_bounds: tuple[Bound, ...]

    def contains(self, q: ArrayLike) -> NDArray[np.bool_]:
        """Tell which configurations, shape (..., n), lie in the box."""
        q = np.asarray(q)
        return np.asarray(((q >= self.lower) & (q <= self.upper)).all(axis=-1))


def windows(robot: Robot) -> list[Window]:
    """Return the window of every component of every point pair in use that reaches zero (Table 6).

    The full turn that holds the home pose is taken; the printed k is of this turn.

    Raises
    ------
    ValueError
        If a pair has not exactly one joint, a revolute one, between its points, or a boundary in
        use is neither a pair nor a half-space.
    """
    return [window for pair in _used(robot, Pair) for window in _pair_windows(robot, pair)]


def box(robot: Robot) -> Box:
    """Intersect all windows, and the joints' own limits (eq. 10) where they have some.

    Raises
    ------
    ValueError
        If a joint has no window, because the paper's rule then says nothing about it; or if windows
        and limits leave no value.
    """
    found = windows(robot)
    sides = (_sides(robot, joint, found) for joint in range(len(robot.joints)))
    lower, upper = zip(*sides, strict=True)
    return Box(
        lower=np.array([value for value, _ in lower]),
        upper=np.array([value for value, _ in upper]),
        lower_bounds=tuple(bound for _, bound in lower),
        upper_bounds=tuple(bound for _, bound in upper),
    )


def feasible(robot: Robot, q: ArrayLike) -> NDArray[np.bool_]:
    """Tell which configurations, shape (..., n), the paper's rule allows."""
    q = joint_values(q, [joint.name for joint in robot.joints])
    inside = box(robot).contains(q)
    for _, form in cuts(robot):
        inside &= form(q) >= 0
    return np.asarray(inside)


def problem(robot: Robot) -> Problem:
    """State the paper's rule for the general engine: the box as limits, half-spaces as forms."""
    region = box(robot)
    ranges = list(zip(region.lower.tolist(), region.upper.tolist(), strict=True))
    sides = zip(region.lower_bounds, region.upper_bounds, strict=True)
    names = [(low.boundary, high.boundary) for low, high in sides]
    return state(robot, [wall for wall, _ in cuts(robot)], ranges, names)


def _pair_windows(robot: Robot, pair: Pair) -> Iterator[Window]:
    vector = pair_vector(robot, pair)
    joints = vector.joints()
    if len(joints) != 1 or robot.kinds[joints[0]] != "revolute":
        raise ValueError(
            f"{printable(pair.name)}: the paper's rule needs one joint between its points, "
            "and a revolute one"
        )
    (joint,) = joints
    rounding = ZERO_AMPLITUDE * np.abs(vector.coefficients).max()
    for component in range(3):
        c0, a, b = vector[component].along(joint, robot.home)
        if np.hypot(a, b) <= rounding:
            continue
        roots = circle_roots(a, b, -c0)
        if roots.count > 0:
            upper = float(first_from(robot.home[joint], roots.q[1]))
            yield Window(pair.name, component + 1, joint, upper - TURN, upper)


def _sides(
    robot: Robot, joint: int, found: list[Window]
) -> tuple[tuple[float, Bound], tuple[float, Bound]]:
    """Return the highest lower end and the lowest upper end of a joint, each with its bound."""
    own, moved = [window for window in found if window.joint == joint], robot.joints[joint]
    if not own:
        raise ValueError(f"no point pair bounds joint {moved.name!r}")
    lower = [(w.lower, Bound(w.boundary, w.component, LOWER)) for w in own]
    upper = [(w.upper, Bound(w.boundary, w.component, UPPER)) for w in own]
    if moved.limits is not None:
        low, high = limit_names(moved.name)
        lower.append((moved.limits[0], Bound(low, 0, LOWER)))
        upper.append((moved.limits[1], Bound(high, 0, UPPER)))
    highest, lowest = max(lower, key=lambda end: end[0]), min(upper, key=lambda end: end[0])
    if highest[0] >= lowest[0]:
        ends = [f"{bound.label} at {np.degrees(x):.4g}°" for x, bound in (highest, lowest)]
        raise ValueError(printable(f"{moved.name}: no room between {' and '.join(ends)}"))
    return highest, lowest


def cuts(robot: Robot) -> list[tuple[HalfSpace, HarmonicForm]]:
    """Return the half-spaces in use and their forms."""
    return [(wall, clearance(robot, wall)) for wall in _used(robot, HalfSpace)]


def _used(robot: Robot, kind: type[AnyBoundary]) -> list[AnyBoundary]:
    """Return the boundaries in use of one type, if the paper's rule knows all of them."""
    used = robot.used
    for boundary in used:
        if not isinstance(boundary, Pair | HalfSpace):
            found = type(boundary).__name__
            raise ValueError(
                f"{printable(boundary.name)}: the paper's rule has no bounds for a {found}"
            )
    return [boundary for boundary in used if isinstance(boundary, kind)]


# --- exact ends -----------------------------------------------------------------------------------


def window_ends(robot: Robot, exact: Robot, joint: int, limits: Any) -> tuple[Any, Any]:
    """Return the highest lower end and the lowest upper end of a joint's windows and limits.

    If two ends are not certainly different, the first one is taken for both.

    Parameters
    ----------
    robot : Robot
        The robot with floats, which determines the windows and their turns.
    exact : Robot
        The same robot with exact numbers.
    limits : pair of balls, optional
        Limits of the joint.
    """
    from flint import arb

    own = [window for window in windows(robot) if window.joint == joint]
    upper = [window_end(exact, window) for window in own]
    lower = [end - 2 * arb.pi() for end in upper]
    if limits is not None:
        lower, upper = [*lower, limits[0]], [*upper, limits[1]]
    low, high = lower[0], upper[0]
    for one, other in zip(lower, upper, strict=True):
        low, high = (one if one > low else low), (other if other < high else high)
    return low, high


def window_end(exact: Robot, window: Window) -> Any:
    r"""Return the upper end of a window as a ball: the root :math:`\theta + \alpha` (eq. 39).

    Raises
    ------
    ValueError
        If it is not certain that the component reaches zero.
    """
    from flint import arb

    pair: Any = exact.boundary(window.boundary)
    component = pair_vector(exact, pair)[window.component - 1]
    still = np.array([arb(0)] * len(exact.joints))
    c, a, b = (x.item() for x in component.along(window.joint, still))
    square = arb(a * a + b * b - c * c)
    if not square >= 0:
        text = "it is not proved that this component reaches zero"
        raise ValueError(f"{printable(window.boundary)}: {text}")
    half = square.sqrt()
    found: Any = arb.atan2(a * half - b * c, -a * c - b * half)
    turns = round((window.upper - float(found)) / (2 * np.pi))
    end: Any = found + 2 * turns * arb.pi()
    return end
