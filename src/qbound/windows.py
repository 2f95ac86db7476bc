"""The windows of Table 6: the full turn that a component leaves to a joint, and their intersection.

A component of a point boundary function has two roots in each turn of its joint, or none: it rises
through zero at one and falls through zero at the other. Its window goes from one falling root to
the next (eq. 39); of these turns it is the one that holds the home pose. The rising root inside the
window limits nothing. The windows of all components, intersected, are a box in joint space.

A window asks only when one component vanishes. It does not ask whether the two points meet there,
and does not read the clearance of the pair; `boundary.keeps_clear` does both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Bools, Floats
from qbound.boundary import pair_vector, single_joint
from qbound.circle import TURN, ZERO_AMPLITUDE, first_from, roots_along
from qbound.robot import Robot

UPPER: Final = 1
"""The last index k of an upper bound, in Table 6 the right-bounded function."""
LOWER: Final = 2
"""The last index k of a lower bound, in Table 6 the left-bounded function."""


@dataclass(frozen=True)
class Bound:
    r"""The name of the bound :math:`\beta_{i,j,k}`: boundary, component, and which end.

    Attributes
    ----------
    boundary : str
        Name of boundary i; of a joint's limit (eq. 10) the name of the joint.
    component : int
        j: 1, 2, 3 for x, y, z; 0 for a limit, or a form that is no component.
    k : int
        `UPPER` or `LOWER`.
    """

    boundary: str
    component: int
    k: int

    @property
    def label(self) -> str:
        """The paper's label, such as ``beta_{1,3,1}`` of boundary B1; of a limit ``q2.lower``.

        Examples
        --------
        >>> from qbound.windows import LOWER, UPPER, Bound
        >>> bounds = Bound("B1", 3, UPPER), Bound("Base", 3, UPPER), Bound("q2", 0, LOWER)
        >>> [bound.label for bound in bounds]
        ['beta_{1,3,1}', 'beta_{Base,3,1}', 'q2.lower']
        """
        if not self.component:
            return f"{self.boundary}.{'upper' if self.k == UPPER else 'lower'}"
        number = self.boundary.removeprefix("B")
        index = number if number.isdigit() else self.boundary
        return f"beta_{{{index},{self.component},{self.k}}}"


@dataclass(frozen=True)
class Window:
    """The values that one component leaves to one joint: a full turn that holds home (Table 6).

    Attributes
    ----------
    boundary : str
        Name of the pair.
    component : int
        1, 2 or 3 for x, y or z.
    joint : int
        Number of the joint, from 0.
    lower, upper : float
        Ends, rad: `upper` is the falling root, `lower` the same root a turn earlier. If the joint
        slides there is one root: it is one end, a length, and the other end is infinite.
    other_root : float
        The rising root between the ends, which Table 6 does not list; NaN if the joint slides.
    """

    boundary: str
    component: int
    joint: int
    lower: float
    upper: float
    other_root: float

    def bound(self, k: int) -> Bound:
        """Return the name of the upper (k = 1) or lower (k = 2) end."""
        return Bound(self.boundary, self.component, k)


@dataclass(frozen=True, eq=False)
class Box:
    """Lowest and highest joint values, shape (n,), each with the bound that it comes from.

    Attributes
    ----------
    lower, upper : ndarray, shape (n,)
        Joint values, rad or length.
    lower_bounds, upper_bounds : tuple of Bound
        The names of these values, one for each joint.
    """

    lower: Floats
    upper: Floats
    lower_bounds: tuple[Bound, ...]
    upper_bounds: tuple[Bound, ...]

    def contains(self, q: ArrayLike) -> Bools:
        """Tell which configurations, shape (..., n), lie in the box or on its sides.

        Examples
        --------
        >>> from qbound import load_robot
        >>> from qbound.windows import window_box
        >>> window_box(load_robot("minervabot-v2")).contains([[0.0, 0.0], [0.0, 1.0]]).tolist()
        [True, False]
        """
        q = np.asarray(q)
        return np.asarray(((q >= self.lower) & (q <= self.upper)).all(axis=-1))


def joint_windows(robot: Robot) -> list[Window]:
    r"""Return the window of every component of every pair in use (Table 6).

    A component :math:`a \cos q + b \sin q - c` falls through zero at :math:`\theta + \alpha`, with
    :math:`\theta` and :math:`\alpha = \arccos(c / d)` of Theorem 2, and again each turn later: the
    integer k of eq. (39) counts these roots. The upper end is the first of them from home on. A
    component without a root has no window. A joint that slides keeps the values on home's side of
    the root.

    Returns
    -------
    list of Window
        In the order of the pairs; for each pair in the order x, y, z.

    Raises
    ------
    ValueError
        If there is not one joint between the points of a pair, or a component that a sliding joint
        moves vanishes at home.

    Examples
    --------
    ``beta_{1,1}`` lets the first joint turn up to 76.265°, and down to a full turn less:

    >>> from qbound import joint_windows, load_robot
    >>> from qbound.windows import UPPER
    >>> first = joint_windows(load_robot("minervabot-v2"))[0]
    >>> first.bound(UPPER).label, np.degrees([first.upper, first.lower]).round(3).tolist()
    ('beta_{1,1,1}', [76.265, -283.735])
    """
    found = []
    for pair in robot.used_pairs:
        vector, joint = pair_vector(robot, pair), single_joint(robot, pair)
        largest = np.abs(vector.coefficients).max() if robot.joints[joint].turns else 1.0
        home = float(robot.home[joint])
        for j in range(3):
            _, a, b = vector[j].along(joint, robot.home)
            rising, falling = roots_along(vector[j], joint, robot.home).tolist()
            if np.hypot(a, b) <= ZERO_AMPLITUDE * largest or np.isnan([rising, falling]).all():
                continue  # along the joint's axis the component is constant, or it has no root
            if robot.joints[joint].turns:
                upper = float(first_from(home, falling))
                lower, other_root = upper - TURN, upper - (falling - rising)
            else:
                root, other_root = (falling if np.isnan(rising) else rising), np.nan
                if root == home:
                    raise ValueError(
                        f"{pair.name}: its component {'xyz'[j]} vanishes at home, so neither side "
                        "of the root is home's; cspace does without windows"
                    )
                lower, upper = (root, np.inf) if root < home else (-np.inf, root)
            found.append(Window(pair.name, j + 1, joint, lower, upper, other_root))
    return found


def window_box(robot: Robot) -> Box:
    """Intersect all windows, and the joints' limits (eq. 10) where they have some.

    Raises
    ------
    ValueError
        If nothing bounds a joint, or windows and limits leave it no value or more than a turn.

    Examples
    --------
    The box of the paper reaches up to q1 = 76.22° and q2 = 44.38°:

    >>> from qbound import load_robot
    >>> from qbound.windows import window_box
    >>> box = window_box(load_robot("minervabot-v2"))
    >>> np.degrees(box.upper).round(2).tolist(), [bound.label for bound in box.upper_bounds]
    ([76.22, 44.38], ['beta_{1,3,1}', 'beta_{3,3,1}'])
    """
    windows = joint_windows(robot)
    lows: list[tuple[float, Bound]] = []
    highs: list[tuple[float, Bound]] = []
    for number, joint in enumerate(robot.joints):
        own = [window for window in windows if window.joint == number]
        lower = [(window.lower, window.bound(LOWER)) for window in own]
        upper = [(window.upper, window.bound(UPPER)) for window in own]
        if joint.limits is not None:
            lower.append((joint.limits[0], Bound(joint.name, 0, LOWER)))
            upper.append((joint.limits[1], Bound(joint.name, 0, UPPER)))
        lower = [end for end in lower if np.isfinite(end[0])]
        upper = [end for end in upper if np.isfinite(end[0])]
        if not lower or not upper:
            raise ValueError(
                f"{joint.name}: no window and no limit bounds it on both sides; give it limits"
            )
        low, low_bound = max(lower, key=lambda end: end[0])
        high, high_bound = min(upper, key=lambda end: end[0])
        if low >= high:
            raise ValueError(
                f"{joint.name}: no value is left between {low_bound.label} and {high_bound.label}"
            )
        if joint.turns and high - low > TURN * (1 + 1e-12):
            raise ValueError(
                f"{joint.name}: more than one turn is left, and qbound handles one; "
                "cspace handles more"
            )
        lows.append((low, low_bound))
        highs.append((high, high_bound))
    return Box(
        lower=np.array([value for value, _ in lows]),
        upper=np.array([value for value, _ in highs]),
        lower_bounds=tuple(bound for _, bound in lows),
        upper_bounds=tuple(bound for _, bound in highs),
    )
