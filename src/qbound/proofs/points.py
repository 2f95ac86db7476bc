"""Points of statements as people write them: decimals are kept as they are written."""

from __future__ import annotations

import csv
import re
from decimal import Decimal
from pathlib import Path

from qbound.model.robot import Robot
from qbound.proofs.statements import Point, decimal, units
from qbound.units import MILLIMETRES, file_units, parse_joint_value, split_length

DECIMAL = re.compile(r"-?[0-9]+([.][0-9]+)?([eE][+-]?[0-9]{1,3})?")
"""How a certificate writes a number."""

MOST_DIGITS = 40
"""Digits of such a number."""


def read_points(robot: Robot, file: str) -> list[Point]:
    """Read a line of joint values a point: with units, or in those of the robot file.

    A first line may name the columns: those of the joints are read, q1 or q1_rad, and no others.

    Raises
    ------
    ValueError
        If the file is not UTF-8, or a line has not one number for each joint.
    """
    try:
        with Path(file).open(newline="", encoding="utf-8-sig") as lines:
            rows = [(i, row) for i, row in enumerate(csv.reader(lines), 1) if any(row)]
    except UnicodeDecodeError:
        raise ValueError(f"{file}: not UTF-8 text") from None
    except csv.Error as error:  # a cell of more than 128 kB, say
        raise ValueError(f"{file}: no table of joint values: {error}") from None
    columns = [(j, "") for j in range(len(robot.joints))]
    names = [joint.name for joint in robot.joints]
    first = [cell.strip() for cell in rows[0][1]] if rows else []
    if first and (first == names or all(cell[:1].isalpha() for cell in first)):
        columns = _columns(robot, first, f"{file}, line {rows.pop(0)[0]}")
    elif first and len(first) != len(columns):
        raise ValueError(f"{file}, line {rows[0][0]}: {len(first)} values for {', '.join(names)}")
    return [_point(robot, columns, row, len(first), f"{file}, line {i}") for i, row in rows]


def _columns(robot: Robot, header: list[str], where: str) -> list[tuple[int, str]]:
    """Return the column of each joint, and its unit: q1, or q1_rad as other commands write it."""
    found = []
    for joint in robot.joints:
        units = ("", "deg", "rad") if joint.turns else ("", *MILLIMETRES)
        named = {f"{joint.name}_{unit}" if unit else joint.name: unit for unit in units}
        columns = [(k, named[cell]) for k, cell in enumerate(header) if cell in named]
        if len(columns) != 1:
            wanted = " or ".join(named)
            raise ValueError(
                f"{where}: {len(columns)} columns of {joint.name}; wanted one, {wanted}"
            )
        found += columns
    return found


def _point(
    robot: Robot, columns: list[tuple[int, str]], row: list[str], width: int, where: str
) -> Point:
    if len(row) != width:
        raise ValueError(f"{where}: {len(row)} values, and {width} in the lines above")
    point = []
    for j, (k, unit) in enumerate(columns):
        cell = row[k].strip()
        if not unit and DECIMAL.fullmatch(cell.removeprefix("+")):
            point.append(as_decimal(where, cell))
            continue
        try:
            point.append(joint_decimal(robot, j, cell + unit))
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
    return point


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
