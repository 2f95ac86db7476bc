"""Parsers of what a user types: joint values, held joints, boxes, places and poses."""

import math
from collections.abc import Mapping, Sequence

from cspace.model.robot import Robot
from cspace.model.rows import LARGEST
from cspace.units import counted, parse_joint_value, parse_length

MOST_PANELS = 100
"""Slices of a strip: more would be no picture."""

LONGEST_INDEX = 9
"""Digits of a joint's index: Python refuses to read thousands of them."""


def configuration(robot: Robot, texts: Sequence[str]) -> list[float]:
    """Read one value for each joint, rad or length."""
    if len(texts) != len(robot.joints):
        names = ", ".join(joint.name for joint in robot.joints)
        values, joints = counted(len(texts), "value"), counted(len(robot.joints), "joint")
        raise ValueError(f"{values} for {joints}: {names}")
    return [parse_joint_value(robot, j, text) for j, text in enumerate(texts)]


def joint(robot: Robot, text: str) -> int | str:
    """Read a joint: a name, or an index where no joint has that name."""
    names = {each.name for each in robot.joints}
    index = text not in names and text.isascii() and text.isdecimal() and len(text) < LONGEST_INDEX
    return int(text) if index else text


def held(robot: Robot, texts: Sequence[str]) -> dict[int, float]:
    """Read ``q3=20deg``; return the held joints, by index, with their values."""
    found: dict[int, float] = {}
    for text in texts:
        j, number = _assigned(robot, "--slice", text)
        if j in found:
            raise ValueError(f"--slice {text}: {robot.joints[j].name!r} is held twice")
        found[j] = parse_joint_value(robot, j, number)
    if len(found) == len(robot.joints):
        raise ValueError("--slice: every joint is held; one or more must move")
    return found


def strip(robot: Robot, text: str, held: Mapping[int, float]) -> tuple[int, list[float]]:
    """Read ``q3=-90deg..90deg:9``; return a joint that is not held, and evenly spaced values.

    ``q3`` alone means 25 values over the joint's limits or one turn.
    """
    if "=" not in text:
        text = f"{text}={_whole_range(robot, text)}"
    j, span = _assigned(robot, "--strip", text)
    ends, _, count = span.partition(":")
    if ".." not in ends or not count.isascii() or not count.isdecimal():
        raise ValueError(f"--strip {text}: wanted NAME=LOW..HIGH:COUNT, as q3=-90deg..90deg:9")
    if j in held:
        raise ValueError(f"--strip {text}: {robot.joints[j].name!r} is held by --slice")
    low, high = (parse_joint_value(robot, j, end) for end in ends.split("..", 1))
    if not 2 <= int(count) <= MOST_PANELS or not low < high:
        raise ValueError(
            f"--strip {text}: from 2 to {MOST_PANELS} values are wanted, the lower end first"
        )
    steps = int(count) - 1
    return j, [low + (high - low) * k / steps for k in range(steps)] + [high]


def box(robot: Robot, texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Read ``q1=-20deg..30deg``, or ``q1=20deg``; return the low and the high end of every joint.

    The ends are decimals in the robot file's units. A joint that is not named has its limits.
    """
    from cspace.proofs.certificates.statements import (
        limits_as_decimals,  # with the decimals of certificates
    )

    found = {}
    for text in texts:
        j, number = _assigned(robot, "--box", text)
        if j in found:
            raise ValueError(f"--box {text}: {robot.joints[j].name!r} has a range twice")
        found[j] = span(number) if span(number)[1:] else [number, number]
    for j, joint in enumerate(robot.joints):
        limits = limits_as_decimals(robot, j)
        if j not in found and limits is None:
            raise ValueError(f"--box: {joint.name} has no limits; give {joint.name}=LOW..HIGH")
        found.setdefault(j, list(limits or ()))
    rows = [_range(robot, j, found[j]) for j in range(len(robot.joints))]
    return [low for low, _ in rows], [high for _, high in rows]


def span(text: str) -> list[str]:
    """Split ``LOW..HIGH``, or ``LOW:HIGH``, at its ends."""
    return text.split(".." if ".." in text else ":")


def place(robot: Robot, text: str) -> tuple[float, float]:
    """Read ``X,Z``: lengths with a unit, or in the robot file's unit."""
    try:
        x, z = (parse_length(each, robot.length_unit, "") for each in text.split(","))
    except ValueError:
        raise ValueError(f"--at {text}: a place is two finite lengths, as --at=-20,40") from None
    if not (abs(x) <= LARGEST and abs(z) <= LARGEST):
        raise ValueError(f"--at {text}: two finite lengths are wanted, {LARGEST:g} at most")
    return x, z


def pose(robot: Robot, joints: Sequence[int], text: str) -> list[float]:
    """Read ``Q1,Q2``: values of some joints by index."""
    numbers = text.split(",")
    if len(numbers) != len(joints):
        raise ValueError(f"--go {text}: {len(joints)} joint values are needed, as 20deg,-45deg")
    return [parse_joint_value(robot, j, number) for j, number in zip(joints, numbers, strict=True)]


def _assigned(robot: Robot, option: str, text: str) -> tuple[int, str]:
    """Read ``NAME=VALUE``: the joint of that name, by index, and the text of the value."""
    names = [joint.name for joint in robot.joints]
    name, _, value = text.partition("=")
    if name not in names:
        raise ValueError(f"{option} {text}: no joint {name!r}; there are {', '.join(names)}")
    return names.index(name), value


def _whole_range(robot: Robot, name: str) -> str:
    """Write a joint's limits, or one turn, as a strip of 25 values."""
    joint = next((joint for joint in robot.joints if joint.name == name), None)
    low, high = (-math.pi, math.pi) if joint is None or joint.limits is None else joint.limits
    unit = "rad" if joint is not None and joint.turns else ""
    return f"{low!r}{unit}..{high!r}{unit}:25"


def _range(robot: Robot, j: int, texts: Sequence[str]) -> tuple[str, str]:
    from cspace.proofs.certificates.statements import joint_decimal

    if len(texts) != 2:
        found = "..".join(texts)
        raise ValueError(f"--box {robot.joints[j].name}: wanted LOW..HIGH, found {found}")
    low, high = (joint_decimal(robot, j, text) for text in texts)
    if float(low) > float(high):
        name, given = robot.joints[j].name, "..".join(texts)
        raise ValueError(f"--box {name}={given}: the low end comes first")
    return low, high
