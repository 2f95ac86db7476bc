"""Units of joint values: the library's (rad, length), the robot file's, and what people type."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from qbound.model.robot import Robot


def joint_units(robot: Robot) -> list[str]:
    """Return the library's unit of each joint's values: ``rad``, or the robot's length unit."""
    return [joint.unit(robot.length_unit) for joint in robot.joints]


def file_units(robot: Robot) -> list[str]:
    """Return the robot file's unit of each joint's values."""
    return [joint.unit(robot.length_unit, robot.angle_unit) for joint in robot.joints]


def parse_joint_value(robot: Robot, j: int, text: str) -> float:
    """Read a joint value: with deg or rad, or a plain number in the robot file's own unit.

    Raises
    ------
    ValueError
        If the text is no finite number with a unit of that joint.
    """
    number, unit = text.strip(), file_units(robot)[j]
    for suffix in ("deg", "rad"):
        if robot.joints[j].turns and number.endswith(suffix):
            number, unit = number.removesuffix(suffix), suffix
            break
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        name, turns = robot.joints[j].name, robot.joints[j].turns
        wanted = "20deg or 0.35rad" if turns else f"0.2, a plain number of {robot.length_unit}"
        raise ValueError(f"{name}: {text.strip()!r} is no value, such as {wanted}")
    return math.radians(value) if unit == "deg" else value


def joint_text(robot: Robot, q: ArrayLike, joints: Iterable[int] | None = None) -> str:
    """Write joint values, of all joints or of some by index, in the units of the robot file.

    Examples
    --------
    >>> from qbound import load_robot
    >>> joint_text(load_robot("minervabot-v2"), [0.5, -1.25])
    'q1 = 28.6479 deg, q2 = -71.6197 deg'
    """
    values = np.asarray(q, dtype=float).tolist()
    units = file_units(robot)
    chosen = range(len(robot.joints)) if joints is None else joints
    return ", ".join(
        f"{robot.joints[j].name} = {math.degrees(x) if units[j] == 'deg' else x:.6g} {units[j]}"
        for j, x in zip(chosen, values, strict=True)
    )
