"""Measures of an arm: a table of names and functions; a new measure is one more row.

Areas and lengths of fibres are exact up to rounding (Theorem 2, cell by cell). Pavings are proved
brackets and take any number of joints. The paper uses samples instead.

A worker measures some arms of a sweep, with plain data in and plain data out, on any machine.

A measure that cannot be computed for an arm is NaN, with the reason. An error of the machine
(memory, files, a missing library) says nothing about the arm, so it is raised and nothing is kept.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import numpy as np

from qbound.arms.fibres import Fibres, fibres
from qbound.design import Path as Place
from qbound.design import home_area, region_area, varied, workspace_area
from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot
from qbound.printable import printable
from qbound.proofs.exact.problem import exact_problem, exact_robot
from qbound.proofs.subpaving.paving import Paving, pave
from qbound.region import Region, Rule, find_region
from qbound.units import joint_units
from qbound.version import __version__


@dataclass(frozen=True, eq=False)
class Arm:
    """One arm of a sweep; results that several measures share are computed once, when first needed.

    Attributes
    ----------
    robot : Robot
    held : dict of int to float
        Values of the joints that are held, rad or length.
    rule : {"clearance", "paper"}
    tolerance : float
        Undecided part of the joint range at which a paving stops.
    moving : int, optional
        The joint whose fibre is measured.
    """

    robot: Robot
    held: Mapping[int, float]
    rule: Rule = "clearance"
    tolerance: float = 0.01
    moving: int | None = None

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


Needs = Literal["two joints", "any joints", "a fibre"]
"""What a measure is about: two joints that are not held, any number, or one that is named."""


@dataclass(frozen=True)
class Measure:
    """A measure of an arm: its function, its unit (`unit_of`), and the joints that it needs.

    Attributes
    ----------
    compute : callable
        Function of an `Arm` that returns a number.
    dimension : {"joints", "joint", "plane", "one"}
        Product of both joints' units, the moving joint's, length squared, or a plain number.
    needs : Needs
    says : str
        Description for people.
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
}
"""By the name that a specification uses."""


def home_length(fibre: Fibres, robot: Robot) -> float:
    """Return the length of the fibre's interval that holds the joint's home value, else 0.

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

    For a fibre it is the unit of the moving joint.

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


# --- the measures of some arms --------------------------------------------------------------------


OF_THE_MACHINE = (MemoryError, OSError, ImportError)

HELD = "held."
"""What the name of a held joint's value begins with, such as ``held.wrist``."""

Numbers = Mapping[str, float]
"""Values of one arm by their names: as `qbound.design.varied` has them, or of held joints."""


class OtherVersionError(ValueError):
    """Error of a worker whose versions differ from those with which the sweep was begun."""


@dataclass(frozen=True)
class Job:
    """Arms that are measured together, as plain data.

    Attributes
    ----------
    chunk : tuple of int
        Index of the chunk on each varied number.
    table : dict
        Content of the robot file.
    held : dict of str to float
        Joints that are held at one value, in the file's units.
    rule, tolerance, fibre
        As in a specification; None if it has no such key.
    measures : tuple of str
    arms : tuple of dict of str to float
        In the order of the grid, the last varied number first to change.
    versions : dict of str to str
        Versions with which the sweep was begun.
    """

    chunk: tuple[int, ...]
    table: Mapping[str, Any]
    held: Mapping[str, float]
    rule: Rule
    tolerance: float
    fibre: str | None
    measures: tuple[str, ...]
    arms: tuple[Numbers, ...]
    versions: Mapping[str, str]


@dataclass(frozen=True)
class Measured:
    """Results of a job, arm by arm: values of all measures, and why one is NaN (else empty)."""

    values: list[list[float]]
    reasons: list[str]


def versions() -> dict[str, str]:
    """Return the versions on which the last digits of a measure may depend."""
    return {"qbound": __version__, "numpy": np.__version__}


def measure_job(job: Job) -> Measured:
    """Measure every arm of a job.

    Raises
    ------
    OtherVersionError
        If this process has other versions than the sweep was begun with.
    MemoryError, OSError, ImportError
        Errors of the machine, which say nothing about an arm.
    """
    if (found := versions()) != dict(job.versions):
        raise OtherVersionError(f"a worker has {_listed(found)}; wanted: {_listed(job.versions)}")
    measured = [_measured(job, numbers) for numbers in job.arms]
    return Measured([values for values, _ in measured], [reason for _, reason in measured])


def arm_of(job: Job, numbers: Numbers) -> Arm:
    """Return one arm of a job: its robot with the values put in, checked as a file is.

    Raises
    ------
    qbound.model.robotcheck.RobotFileError
        If the values do not make a robot.
    """
    placed: dict[Place, float] = {n: x for n, x in numbers.items() if not n.startswith(HELD)}
    values = {n.removeprefix(HELD): x for n, x in numbers.items() if n not in placed}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # shown when the sweep began
        robot = varied(parse_robot(job.table), placed)
    held = in_library_units(robot, {**job.held, **values})
    moving = None if job.fibre is None else robot.joint_index(job.fibre)
    return Arm(robot, held, job.rule, job.tolerance, moving)


def in_library_units(robot: Robot, held: Mapping[str, float]) -> dict[int, float]:
    """Return held joints' values, given in the robot file's units, by index in rad or length."""
    angle = math.radians(1.0) if robot.angle_unit == "deg" else 1.0
    joints = ((robot.joint_index(name), value) for name, value in held.items())
    return {j: value * robot.joints[j].scale(angle) for j, value in joints}


def _measured(job: Job, numbers: Numbers) -> tuple[list[float], str]:
    try:
        arm = arm_of(job, numbers)
    except ValueError as error:
        return [math.nan] * len(job.measures), printable(error)
    found = [_value(arm, name) for name in job.measures]
    return [value for value, _ in found], "; ".join(_reasons(job.measures, found))


def _reasons(names: Sequence[str], found: Sequence[tuple[float, str]]) -> Iterator[str]:
    return (f"{name}: {why}" for name, (_, why) in zip(names, found, strict=True) if why)


def _value(arm: Arm, name: str) -> tuple[float, str]:
    """Return a measure of an arm, or NaN and the reason; other arms are still measured."""
    try:
        with np.errstate(all="ignore"):
            value = float(MEASURES[name].compute(arm))
    except OF_THE_MACHINE:
        raise
    except ValueError as error:  # errors of the library about the arm
        return math.nan, printable(error)
    except Exception as error:  # a bug: named, so that it does not look like an answer
        return math.nan, printable(f"{type(error).__name__}: {error}")
    return (value, "") if math.isfinite(value) else (math.nan, f"{value} is no finite number")


def _listed(found: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in found.items())
