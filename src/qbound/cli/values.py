"""What a user types and what the commands write: joint values in, whole files out."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from qbound.robot import Robot


def configuration(robot: Robot, texts: Sequence[str]) -> list[float]:
    """Read one value for each joint, rad or length."""
    if len(texts) != len(robot.joints):
        names = ", ".join(joint.name for joint in robot.joints)
        raise ValueError(f"{len(texts)} values for {len(robot.joints)} joints: {names}")
    return [joint_value(robot, j, text) for j, text in enumerate(texts)]


def held(robot: Robot, texts: Sequence[str]) -> dict[int, float]:
    """Read ``q3=20deg``: the joints that are held, by index, and their values."""
    names = [joint.name for joint in robot.joints]
    found = {}
    for text in texts:
        name, _, number = text.partition("=")
        if name not in names:
            raise ValueError(f"--slice {text}: no joint {name!r}; there are {', '.join(names)}")
        found[names.index(name)] = joint_value(robot, names.index(name), number)
    return found


def joint_value(robot: Robot, j: int, text: str) -> float:
    """Read a joint value: with deg or rad, or a plain number in the robot file's own unit."""
    revolute = robot.joints[j].kind == "revolute"
    number, unit = text, robot.angle_unit if revolute else robot.length_unit
    for suffix in ("deg", "rad"):
        if revolute and text.endswith(suffix):
            number, unit = text.removesuffix(suffix), suffix
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{robot.joints[j].name}: {text!r} is no value, such as 20deg or 0.35rad")
    return math.radians(value) if unit == "deg" else value


def write_whole(file: str, write: Callable[[Path], object]) -> None:
    """Write a file whole or not at all: a draft beside it, then renamed."""
    target = Path(file)
    draft = target.with_name(target.name + ".part")
    try:
        write(draft)
        draft.replace(target)
    finally:
        draft.unlink(missing_ok=True)


def write_text(file: str, text: str) -> None:
    """Write a text whole or not at all; ``-`` is standard output."""
    if file == "-":
        print(text, end="")
    else:
        write_whole(file, lambda draft: draft.write_text(text, encoding="utf-8"))
