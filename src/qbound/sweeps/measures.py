"""Which measures has an arm? A table of names and functions; a new measure is one more row.

Areas are exact up to rounding (Theorem 2, cell by cell); pavings are proved brackets and take any
number of joints. The paper has samples in their place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from qbound.design import home_area, region_area, workspace_area
from qbound.model.robot import Robot
from qbound.proofs.exact import exact_problem, exact_robot
from qbound.proofs.paving import Paving, pave
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
    """

    robot: Robot
    held: Mapping[int, float]
    rule: Rule = "clearance"
    tolerance: float = 0.01

    @cached_property
    def region(self) -> Region:
        """The region of the two joints that are not held."""
        return find_region(self.robot, dict(self.held), self.rule)

    @cached_property
    def paving(self) -> Paving:
        """The proved paving of all joints that are not held."""
        return pave(exact_problem(exact_robot(self.robot), self.held), self.tolerance)


@dataclass(frozen=True)
class Measure:
    """What is computed of an arm, in which unit (`unit_of`), and of how many joints.

    Attributes
    ----------
    compute : callable
        From a `Arm` to a number.
    dimension : {"joints", "plane", "one"}
        Product of both joints' units, length squared, or a plain number.
    planar : bool
        Whether exactly two joints must not be held.
    says : str
        What it is, for people.
    """

    compute: Callable[[Arm], float]
    dimension: str
    planar: bool
    says: str


MEASURES: Mapping[str, Measure] = {
    "region.area": Measure(
        lambda arm: region_area(arm.region), "joints", True, "area of all safe components"
    ),
    "region.home.area": Measure(
        lambda arm: home_area(arm.region),
        "joints",
        True,
        "area of the component with the home pose; 0 where home is in none",
    ),
    "region.components": Measure(
        lambda arm: len(arm.region.components), "one", True, "number of safe components"
    ),
    "workspace.area": Measure(
        lambda arm: workspace_area(arm.region),
        "plane",
        True,
        "area of the places that the tool reaches from home; 0 where home is in no component",
    ),
    "paving.inner": Measure(
        lambda arm: rounded_down(arm.paving.inner_fraction),
        "one",
        False,
        "part of the joint range that is proved safe",
    ),
    "paving.outer": Measure(
        lambda arm: -rounded_down(-arm.paving.inner_fraction - arm.paving.undecided_fraction),
        "one",
        False,
        "part of the joint range outside which all is proved unsafe",
    ),
}
"""By the name that a specification uses."""


def unit_of(measure: Measure, robot: Robot, free: list[int]) -> str:
    """Return the unit of a measure of the joints that are not held, by index.

    Examples
    --------
    >>> from qbound import load_robot
    >>> unit_of(MEASURES["region.area"], load_robot("minervabot-v2"), [0, 1])
    'rad^2'
    """
    if measure.dimension == "one":
        return "1"
    if measure.dimension == "plane":
        return f"{robot.length_unit}^2"
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
