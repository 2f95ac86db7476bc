"""A row of slices: regions of two joints for several values of a third, the others held."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.model.robot import Held, Robot, real_numbers, refuse_no_robot
from cspace.region.region import Region, find_region
from cspace.tolerances import SAME_POINT

MOST_SLICES = 1000
"""Slices that are made at once: a slip of the keyboard is no work without end."""


@dataclass(frozen=True, eq=False)
class Slices:
    """Regions of the same two joints, one for each value of a third.

    Attributes
    ----------
    robot : Robot
    along : int
        Which joint differs from slice to slice, by index.
    values : ndarray, shape (k,)
        Values of this joint, rad or length, in the given order.
    regions : tuple of Region
    """

    robot: Robot
    along: int
    values: Floats
    regions: tuple[Region, ...]

    def __repr__(self) -> str:
        """Show the slices and the joint on one line."""
        joint, unit = self.robot.joints[self.along].name, self.regions[0].area_unit
        low, high = self.areas.min(), self.areas.max()
        count = len(self.regions)
        return f"<{count} slices along {joint!r}: areas {low:.6g} to {high:.6g} {unit}>"

    def __len__(self) -> int:
        """Count the slices."""
        return len(self.regions)

    def __iter__(self) -> Iterator[Region]:
        """Go through the regions, in the order of `values`."""
        return iter(self.regions)

    @property
    def areas(self) -> Floats:
        """Feasible area of each slice, all components, shape (k,); products of joint units."""
        return np.array([region.area for region in self.regions])

    def holds_home(self, k: int) -> bool:
        """Tell whether the home pose lies in slice `k`: all held joints are at home."""
        held = self.regions[k].problem.held
        return all(abs(value - self.robot.home[j]) <= SAME_POINT for j, value in held.items())


def find_slices(
    robot: Robot,
    along: int | str,
    values: ArrayLike,
    held: Held | None = None,
    progress: Callable[[int], None] | None = None,
) -> Slices:
    """Find the regions of two joints for each value of a third one (eqs. 9-12).

    The paper holds no joint; it names slices as an outlook. Every region is exact, but nothing is
    known between two values.

    Parameters
    ----------
    along : int or str
        The third joint, by index or name.
    values : array_like, shape (k,)
        Rad or length; one beyond the joint's limits has an empty region that names the limit.
    held : mapping of int or str to float, optional
        Values of all other joints but two.
    progress : callable, optional
        Called after each slice with the number of slices done.

    Raises
    ------
    ValueError
        If not exactly two joints are left free, `along` is held or unknown, a value is not a finite
        number, or there are no values or more than a thousand.
    TypeError
        If `robot` is not a `Robot`, such as the name of one.

    Examples
    --------
    The floor bounds the hand of an arm whose wrist is bent down, straight, and bent up:

    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from cspace import find_slices, load_robot
    >>> from cspace.model.robot import HalfSpace, Point
    >>> arm = load_robot("minervabot-v2")
    >>> shoulder, elbow = arm.joints
    >>> wrist = replace(elbow, name="q3", parent=elbow.frame, frame="hand")
    >>> floor = HalfSpace("floor", "tip", np.array([0.0, 0.0, 1.0]), 0.0)
    >>> tip = Point("tip", "hand", np.array([10.0, 0.0, 0.0]))
    >>> robot = replace(
    ...     arm,
    ...     joints=(shoulder, elbow, wrist),
    ...     points=(*arm.points, tip),
    ...     boundaries=(*arm.boundaries, floor),
    ...     home=np.zeros(3),
    ... )
    >>> slices = find_slices(robot, "q3", [-0.5, 0.0, 0.5])
    >>> slices.areas.round(3).tolist()
    [23.459, 24.157, 24.786]
    >>> [len(region.components) for region in slices]
    [5, 5, 5]
    >>> [slices.holds_home(k) for k in range(3)]
    [False, True, False]
    """
    refuse_no_robot("find_slices", robot)
    joint = robot.joint_index(along)
    name, fixed = robot.joints[joint].name, robot.held_indices(held or {})
    if joint in fixed:
        raise ValueError(f"joint {name!r} is held, and slices go along it: leave it out of `held`")
    chosen = real_numbers(values)
    if chosen.ndim != 1 or not 0 < len(chosen) <= MOST_SLICES:
        raise ValueError(
            f"1 to {MOST_SLICES} values of {name!r} in a row are wanted, found shape {chosen.shape}"
        )
    regions = []
    for value in chosen.tolist():
        regions.append(find_region(robot, {**fixed, joint: value}))
        if progress is not None:
            progress(len(regions))
    return Slices(robot, joint, chosen, tuple(regions))
