"""The measures of some arms of a sweep: plain data in, plain data out, on whatever machine.

A measure that cannot be computed of an arm is NaN, and says why. What hangs on the machine (memory,
files, a library that is missing) is no answer about the arm: it is raised, and nothing is kept.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from qbound.design import Path as Place
from qbound.design import varied
from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot
from qbound.printable import printable
from qbound.region import Rule
from qbound.sweeps.measures import MEASURES, Arm
from qbound.version import __version__

OF_THE_MACHINE = (MemoryError, OSError, ImportError)

HELD = "held."
"""What the name of a held joint's value begins with, such as ``held.wrist``."""

Numbers = Mapping[str, float]
"""Values of one arm by their names: as `qbound.design.varied` has them, or of held joints."""


class OtherVersionError(ValueError):
    """A worker that computes with other versions than the sweep was begun with."""


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
    rule, tolerance, fibre, voxel
        As in a specification; None where it says nothing.
    measures : tuple of str
    arms : tuple of dict of str to float
        In the order of the grid, the last varied number first to change.
    versions : dict of str to str
        What the sweep was begun with.
    """

    chunk: tuple[int, ...]
    table: Mapping[str, Any]
    held: Mapping[str, float]
    rule: Rule
    tolerance: float
    fibre: str | None
    voxel: float | None
    measures: tuple[str, ...]
    arms: tuple[Numbers, ...]
    versions: Mapping[str, str]


@dataclass(frozen=True)
class Measured:
    """What was found of a job, arm by arm: a value a measure, and why one is NaN (else empty)."""

    values: list[list[float]]
    reasons: list[str]


def versions() -> dict[str, str]:
    """Return the versions on which the last digits of a measure may hang."""
    return {"qbound": __version__, "numpy": np.__version__}


def measure_job(job: Job) -> Measured:
    """Measure every arm of a job.

    Raises
    ------
    OtherVersionError
        If this process has other versions than the sweep was begun with.
    MemoryError, OSError, ImportError
        What says nothing about an arm.
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
        If that is no robot.
    """
    placed: dict[Place, float] = {n: x for n, x in numbers.items() if not n.startswith(HELD)}
    values = {n.removeprefix(HELD): x for n, x in numbers.items() if n not in placed}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # was said when the sweep began
        robot = varied(parse_robot(job.table), placed)
    held = in_library_units(robot, {**job.held, **values})
    moving = None if job.fibre is None else robot.joint_index(job.fibre)
    return Arm(robot, held, job.rule, job.tolerance, moving, job.voxel)


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
    """Return a measure of an arm; or NaN and why: it is a fault of this arm, the others go on."""
    try:
        with np.errstate(all="ignore"):
            value = float(MEASURES[name].compute(arm))
    except OF_THE_MACHINE:
        raise
    except ValueError as error:  # what the library says of an arm
        return math.nan, printable(error)
    except Exception as error:  # a fault of ours: named, so that it does not look like an answer
        return math.nan, printable(f"{type(error).__name__}: {error}")
    return (value, "") if math.isfinite(value) else (math.nan, f"{value} is no finite number")


def _listed(found: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in found.items())
