"""Measures of an arm: a table of names and functions; a new measure is one more row.

Areas and lengths of fibres are exact up to rounding (Theorem 2, cell by cell). Pavings are proved
brackets and take any number of joints. The volume of reach is an estimate, and so is its error. The
seed of the volume is 0, so the same arm always has the same volume. The paper uses samples instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Literal

import numpy as np

from qbound.arms.fibres import Fibres, fibres
from qbound.arms.reach import Reach, reach
from qbound.design import home_area, region_area, workspace_area
from qbound.model.robot import Robot
from qbound.proofs.exact.problem import exact_problem, exact_robot
from qbound.proofs.subpaving.paving import Paving, pave
from qbound.region import Region, Rule, find_region
from qbound.units import joint_units


@dataclass(frozen=True, eq=False)
class Arm:
    """One arm of a sweep; what several measures share is computed once, where one asks for it.

    Attributes
    ----------
    robot : Robot
    held : dict of int to float
        Values of the joints that are held, rad or length.
    rule : {"clearance", "paper"}
    tolerance : float
        Undecided part of the joint range at which a paving stops.
    moving : int, optional
        The joint whose fibre is asked for.
    voxel : float, optional
        Edge of the voxels of a map of reach, length.
    """

    robot: Robot
    held: Mapping[int, float]
    rule: Rule = "clearance"
    tolerance: float = 0.01
    moving: int | None = None
    voxel: float | None = None

    @cached_property
    def region(self) -> Region:
        """The region of the two joints that are not held."""
        return find_region(self.robot, dict(self.held), self.rule)

    @cached_property
    def paving(self) -> Paving:
        """The proved paving of all joints that are not held."""
        return pave(exact_problem(exact_robot(self.robot), self.held), self.tolerance)

    @cached_property
    def fibre(self) -> Fibres:
        """The free values of the moving joint, the others held or at home."""
        if self.moving is None:
            raise ValueError("no joint is named")
        rest = self.robot.home[self.robot.free(self.held)]
        return fibres(self.robot, self.moving, self.robot.with_held(rest, self.held))

    @cached_property
    def reached(self) -> Reach:
        """The map of the places of the tool, with the seed 0."""
        return reach(self.robot, self.voxel)


Needs = Literal["two joints", "any joints", "a fibre", "every joint"]
"""What a measure is about: two joints that are not held, any number, one that is named, or all."""


@dataclass(frozen=True)
class Measure:
    """What is computed of an arm, in which unit (`unit_of`), and of how many joints.

    Attributes
    ----------
    compute : callable
        From a `Arm` to a number.
    dimension : {"joints", "joint", "plane", "space", "one"}
        Product of both joints' units, the moving joint's, length squared or cubed, or a plain
        number.
    needs : Needs
    says : str
        What it is, for people.
    """

    compute: Callable[[Arm], float]
    dimension: str
    needs: Needs
    says: str


MEASURES: Mapping[str, Measure] = {
    "region.area": Measure(
        lambda arm: region_area(arm.region), "joints", "two joints", "area of all components"
    ),
    "region.home.area": Measure(
        lambda arm: home_area(arm.region),
        "joints",
        "two joints",
        "area of the component with the home pose; 0 where home is in none",
    ),
    "region.components": Measure(
        lambda arm: len(arm.region.components), "one", "two joints", "number of components"
    ),
    "workspace.area": Measure(
        lambda arm: workspace_area(arm.region),
        "plane",
        "two joints",
        "area of the places that the tool reaches from home; 0 where home is in no component",
    ),
    "paving.inner": Measure(
        lambda arm: rounded_down(arm.paving.inner_fraction),
        "one",
        "any joints",
        "part of the joint range that is proved feasible",
    ),
    "paving.outer": Measure(
        lambda arm: -rounded_down(-arm.paving.inner_fraction - arm.paving.undecided_fraction),
        "one",
        "any joints",
        "part of the joint range outside which all is proved infeasible",
    ),
    "fibre.length": Measure(
        lambda arm: float(arm.fibre.length[0]),
        "joint",
        "a fibre",
        "length of all feasible values of the joint `fibre`, the others held or at home",
    ),
    "fibre.home.length": Measure(
        lambda arm: home_length(arm.fibre, arm.robot),
        "joint",
        "a fibre",
        "length of the interval of these in which home is; 0 where it is in none",
    ),
    "reach.volume": Measure(
        lambda arm: arm.reached.volume,
        "space",
        "every joint",
        "estimated volume of the positions that the tool reaches by any feasible configuration",
    ),
    "reach.error": Measure(
        lambda arm: arm.reached.error,
        "space",
        "every joint",
        "estimated error of that volume, no bound",
    ),
}
"""By the name that a specification uses."""


POWERS = {"plane": 2, "space": 3}
"""Of the length unit."""


def home_length(fibre: Fibres, robot: Robot) -> float:
    """Return the length of the interval of a fibre in which the joint's home value is, else 0.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> fibre = fibres(robot, "q2", robot.home)
    >>> [round(i.high - i.low, 4) for i in fibre[0]], round(home_length(fibre, robot), 4)
    ([3.6245, 2.6282], 3.6245)
    """
    above = robot.home[fibre.joint] - fibre.low
    if robot.joints[fibre.joint].limits is None:
        above = np.mod(above, math.tau)
    wide = fibre.high - fibre.low
    return float(wide[(above >= 0) & (above <= wide)].max(initial=0.0))


def unit_of(measure: Measure, robot: Robot, free: list[int], moving: int | None = None) -> str:
    """Return the unit of a measure of the joints that are not held, by index.

    Of a fibre it is the unit of the joint that moves.

    Examples
    --------
    >>> from qbound import load_robot
    >>> unit_of(MEASURES["region.area"], load_robot("minervabot-v2"), [0, 1])
    'rad^2'
    """
    if measure.dimension == "one":
        return "1"
    if measure.dimension in POWERS:
        return f"{robot.length_unit}^{POWERS[measure.dimension]}"
    if moving is not None and measure.dimension == "joint":
        return joint_units(robot)[moving]
    one, other = (joint_units(robot)[j] for j in free)
    return f"{one}^2" if one == other else f"{one} {other}"


def rounded_down(value: Fraction) -> float:
    """Return the largest double that is not above a fraction.

    Examples
    --------
    >>> rounded_down(Fraction(1, 3)) <= Fraction(1, 3) < rounded_down(Fraction(1, 2))
    True
    """
    nearest = float(value)
    return nearest if Fraction(nearest) <= value else math.nextafter(nearest, -math.inf)
