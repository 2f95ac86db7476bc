"""Points of statements as people write them: decimals are kept as they are written."""

from __future__ import annotations

import csv
import re
from decimal import Decimal
from pathlib import Path

from qbound.model.robot import Robot
from qbound.proofs.statements import Point, decimal, units
from qbound.units import file_units, parse_joint_value, split_length

DECIMAL = re.compile(r"-?[0-9]+([.][0-9]+)?([eE][+-]?[0-9]{1,3})?")
"""How a certificate writes a number."""

MOST_DIGITS = 40
"""Digits of such a number."""


def read_points(robot: Robot, file: str) -> list[Point]:
    """Read a line of joint values a point, in the robot file's units; a first line may name joints.

    Raises
    ------
    ValueError
        If the file is not UTF-8, or a line has not one decimal number for each joint.
    """
    try:
        with Path(file).open(newline="", encoding="utf-8-sig") as lines:
            rows = [(i, row) for i, row in enumerate(csv.reader(lines), 1) if any(row)]
    except UnicodeDecodeError:
        raise ValueError(f"{file}: not UTF-8 text") from None
    except csv.Error as error:  # a cell of more than 128 kB, say
        raise ValueError(f"{file}: no table of joint values: {error}") from None
    names = [joint.name for joint in robot.joints]
    if rows and [cell.strip() for cell in rows[0][1]] == names:
        del rows[0]
    for i, row in rows:
        if len(row) != len(names):
            raise ValueError(f"{file}, line {i}: {len(row)} values for {', '.join(names)}")
    return [[as_decimal(f"{file}, line {i}", cell) for cell in row] for i, row in rows]


def as_decimal(where: str, text: str) -> str:
    """Return a decimal as it is written; `where` begins the sentence of the error."""
    plain = text.strip().removeprefix("+")
    if not DECIMAL.fullmatch(plain) or sum(map(str.isdigit, plain)) > MOST_DIGITS:
        shown = plain if len(plain) <= MOST_DIGITS else f"{plain[:MOST_DIGITS]}..."
        raise ValueError(f"{where}: {shown!r} is no decimal number of at most {MOST_DIGITS} digits")
    return plain


def length_decimal(robot: Robot, where: str, text: str) -> str:
    """Return a length, such as ``30cm``, as a decimal of the robot file's unit, exactly."""
    number, own = split_length(text, robot.length_unit)
    plain = as_decimal(where, number)
    if own == robot.length_unit:
        return plain
    tens = {"mm": -3, "cm": -2, "m": 0}
    return as_decimal(where, f"{Decimal(plain).scaleb(tens[own] - tens[robot.length_unit]):f}")


def joint_decimal(robot: Robot, j: int, text: str) -> str:
    """Return a joint value, such as ``20deg``, as a decimal of the robot file's unit.

    As it is written if it is in that unit, else converted and rounded.
    """
    value = parse_joint_value(robot, j, text)
    plain = text.strip().removeprefix("+").removesuffix(file_units(robot)[j])
    return plain if DECIMAL.fullmatch(plain) else decimal(value / units(robot)[j])


def limits_as_decimals(robot: Robot, j: int) -> tuple[str, str] | None:
    """Return the limits of a joint as decimals of the robot file's unit; None without limits."""
    limits = robot.joints[j].limits
    if limits is None:
        return None
    low, high = (decimal(end / units(robot)[j]) for end in limits)
    return low, high
