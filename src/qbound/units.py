"""Units: the library's (rad, length), the robot file's, and what people type and are shown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from qbound.boundary.evaluator import limit_names
from qbound.model.robot import Joint, Robot


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


def amount(value: float, unit: str, rounding: float = 0.0, digits: int = 6) -> str:
    """Write a number with its unit; what rounding alone may have left is 0, within that.

    Examples
    --------
    >>> amount(11.6870436, "cm"), amount(-3.6e-15, "cm", rounding=1e-13)
    ('11.687 cm', '0 cm (within 1e-13 cm)')
    """
    if 0 < rounding >= abs(value):
        return f"0 {unit} (within {rounding:.0e} {unit})"
    space = "" if unit == "°" else " "
    return f"{value:.{digits}g}{space}{unit}"


def limited_joints(robot: Robot) -> dict[str, Joint]:
    """Return the joint that each name of a joint limit belongs to."""
    return {name: joint for joint in robot.joints for name in limit_names(joint.name)}


def margin_text(
    robot: Robot,
    boundary: str,
    margin: float,
    limited: Mapping[str, Joint],
    rounding: float = 0.0,
    *,
    degree: str = "deg",
    digits: int = 6,
) -> str:
    """Write a margin with its unit: a length, or of a limit that of its joint, degrees if it turns.

    Parameters
    ----------
    limited : mapping of str to Joint
        The joint of each boundary that is a limit.
    rounding : float
        A margin no larger is rounding; in the library's unit, as the margin.
    degree : {"deg", "°"}
        As it is written.
    """
    if (joint := limited.get(boundary)) is None:
        return amount(margin, robot.length_unit, rounding, digits)
    scale, unit = joint.shown_scale, joint.unit(robot.length_unit, degree)
    return amount(margin * scale, unit, rounding * scale, digits)


def counted(number: int, one: str, many: str | None = None) -> str:
    """Write a number with what it counts: 1 component, 2 components."""
    return f"{number} {one if number == 1 else many or one + 's'}"
