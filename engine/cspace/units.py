"""Units: the library's (rad, length), the robot file's, and what people type and are shown."""

import math
from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from cspace.boundary.evaluator import limit_names
from cspace.model.robot import Joint, Robot
from cspace.tolerances import FARTHEST


def joint_units(robot: Robot) -> list[str]:
    """Return the library's unit of each joint's values: ``rad``, or the robot's length unit."""
    return [joint.unit(robot.length_unit) for joint in robot.joints]


def file_units(robot: Robot) -> list[str]:
    """Return the robot file's unit of each joint's values."""
    return [joint.unit(robot.length_unit, robot.angle_unit) for joint in robot.joints]


MILLIMETRES: Final = {"mm": 1, "cm": 10, "m": 1000}
"""Of each unit of length that people type."""


def parse_joint_value(robot: Robot, j: int, text: str) -> float:
    """Read a joint value: with deg, °, rad, mm, cm or m, or a plain number in the file's own unit.

    Raises
    ------
    ValueError
        If the text is not a finite number with a unit of that joint, or an angle beyond `FARTHEST`.

    Examples
    --------
    >>> from cspace import load_robot
    >>> boom = load_robot("rp-telescopic-boom")  # lengths in m
    >>> parse_joint_value(boom, 0, "180°"), parse_joint_value(boom, 1, "30cm")
    (3.141592653589793, 0.3)
    """
    joint = robot.joints[j]
    plain, others = text.strip(), ("mm", "cm", "m") if joint.turns else ("deg", "°", "rad")
    wrong = next((unit for unit in others if plain.endswith(unit)), "")
    if wrong and math.isfinite(_number(plain.removesuffix(wrong))):
        wanted, told = "20deg or 0.35rad", "a length, and this joint turns"
        if not joint.turns:
            wanted = f"0.2, a plain number of {robot.length_unit}, or 20cm"
            told = "an angle, and this joint slides"
        raise ValueError(f"{joint.name}: {plain!r} is no value, such as {wanted}: it is {told}")
    if not joint.turns:
        return parse_length(text, robot.length_unit, joint.name)
    number, unit = text.strip(), robot.angle_unit
    for suffix, meant in (("deg", "deg"), ("°", "deg"), ("rad", "rad")):
        if number.endswith(suffix):
            number, unit = number.removesuffix(suffix), meant
            break
    value = _number(number)
    if not math.isfinite(value):
        raise ValueError(f"{joint.name}: {text.strip()!r} is no value, such as 20deg or 0.35rad")
    angle = math.radians(value) if unit == "deg" else value
    if abs(angle) > FARTHEST:
        raise ValueError(
            f"{joint.name}: {text.strip()}: an angle of {FARTHEST:g} rad at most is wanted"
        )
    return angle


def parse_length(text: str, unit: str, what: str) -> float:
    """Read a length, with a unit or as a plain number, and return it in a unit: mm, cm or m.

    Parameters
    ----------
    what : str
        Name of the length; it begins the sentence of the error.

    Raises
    ------
    ValueError
        If the text is not a finite number, with or without such a unit.

    Examples
    --------
    >>> parse_length("300mm", "m", "excess"), parse_length("0.3", "m", "excess")
    (0.3, 0.3)
    """
    number, own = split_length(text, unit)
    value = _number(number)
    if not math.isfinite(value):
        wanted = f"0.2, a plain number of {unit}, or 20cm"
        raise ValueError(f"{what}: {text.strip()!r} is no value, such as {wanted}")
    return value if own == unit else value * MILLIMETRES[own] / MILLIMETRES[unit]


def split_length(text: str, unit: str) -> tuple[str, str]:
    """Split a length into its number and its unit; `unit` is the default.

    Examples
    --------
    >>> split_length("30cm", "m"), split_length("0.3", "m")
    (('30', 'cm'), ('0.3', 'm'))
    """
    plain = text.strip()
    own = next((u for u in MILLIMETRES if plain.endswith(u)), "")  # m last: all end in it
    return plain.removesuffix(own).rstrip(), own or unit


def _number(text: str) -> float:
    """Read a number; NaN if the text is not a number."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def joint_text(robot: Robot, q: ArrayLike, joints: Iterable[int] | None = None) -> str:
    """Write joint values, of all joints or of some by index, in the units of the robot file.

    Examples
    --------
    >>> from cspace import load_robot
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
    """Write a number with its unit; a number within its rounding is written as 0 within that.

    Examples
    --------
    >>> amount(11.6870436, "cm"), amount(-3.6e-15, "cm", rounding=1e-13)
    ('11.687 cm', '0 cm (within 1e-13 cm)')
    """
    if 0 < rounding >= abs(value):
        return f"0 {unit} (within {rounding:.0e} {unit})"
    space = "" if unit == "°" else " "
    return f"{value:.{digits}g}{space}{unit}"


def joint_amount(
    robot: Robot,
    joint: Joint,
    value: float,
    rounding: float = 0.0,
    degree: str = "deg",
    digits: int = 6,
) -> str:
    """Write a value of a joint, or a difference of two, with its unit: degrees where it turns."""
    scale, unit = joint.shown_scale, joint.unit(robot.length_unit, degree)
    return amount(value * scale, unit, rounding * scale, digits)


def limited_joints(robot: Robot) -> dict[str, Joint]:
    """Return the joint of each joint limit, by the limit's name."""
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
    """Write a margin with its unit: a length; for a limit the joint's unit, in degrees if it turns.

    Parameters
    ----------
    limited : mapping of str to Joint
        The joint of each boundary that is a limit.
    rounding : float
        A margin up to this size is rounding; in the library's unit, as the margin.
    degree : {"deg", "°"}
        How degrees are written.
    """
    if (joint := limited.get(boundary)) is None:
        return amount(margin, robot.length_unit, rounding, digits)
    return joint_amount(robot, joint, margin, rounding, degree, digits)


def counted(number: int, one: str, many: str | None = None) -> str:
    """Write a number with what it counts: 1 component, 2 components."""
    return f"{number} {one if number == 1 else many or one + 's'}"
