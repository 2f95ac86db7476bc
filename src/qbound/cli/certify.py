"""``qbound certify``: prove or refute that a set of configurations is safe, and write the proof."""

from __future__ import annotations

import argparse
import csv
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from qbound.check import number
from qbound.cli.chosen import add_robot
from qbound.cli.values import check_targets, held, joint_value, write_text
from qbound.model.robot import Joint, Robot
from qbound.model.robotfile import parse_robot, robot_text
from qbound.proofs import statements
from qbound.proofs.certify import Bracket, Certificate, bracket_scale, certify

SIDES = ("lower", "upper")
STATUS = {"proved": 0, "refuted": 1, "undecided": 3}


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "certify",
        help="prove that every configuration of a set is safe",
        epilog="example: qbound certify minervabot-v2 --scale 0.96 -o cert.json",
    )
    add_robot(parser)
    sets = parser.add_mutually_exclusive_group()
    sets.add_argument(
        "--scale", metavar="S", help="the polygon of home's vertices, scaled (default 1)"
    )
    sets.add_argument("--region", action="store_true", help="home's region but for --inset")
    sets.add_argument("--box", nargs="+", metavar="q1=-20deg:30deg", help="all joints in ranges")
    sets.add_argument("--path", metavar="CSV", help="straight segments between joint values")
    sets.add_argument("--polygon", metavar="CSV", help="a polygon of joint values, either sense")
    sets.add_argument(
        "--largest-scale", action="store_true", help="a proof and a witness around the largest"
    )
    parser.add_argument(
        "--margin", default="0", metavar="LENGTH", help="to keep beside (default 0)"
    )
    parser.add_argument(
        "--inset", type=float, metavar="LENGTH", help="of --region (default: of the reach, 1 %%)"
    )
    parser.add_argument("--slice", nargs="+", default=[], metavar="q3=20deg", help="hold joints")
    parser.add_argument("-o", "--output", metavar="FILE", help="write the certificate")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Answer; 0 proved, 1 refuted, 3 undecided."""
    if options.output:
        check_targets([options.output])
    text, _ = robot_text(options.robot)
    robot = parse_robot(tomllib.loads(text))
    _check_length(options.margin)
    if options.largest_scale and (options.margin != "0" or options.slice):
        raise ValueError("--largest-scale: for the robot as it is, without --margin and --slice")
    if options.largest_scale:
        return _say_bracket(robot, bracket_scale(text), options.output)
    answer = certify(text, statement(robot, options))
    if options.output and answer.text:
        write_text(options.output, answer.text)
    if options.output != "-" or not answer.text:
        print(f"{answer.said}\n{in_words(robot, answer)}".rstrip())
    return STATUS[answer.verdict]


def statement(robot: Robot, options: argparse.Namespace) -> statements.Statement:
    """State what the options ask for."""
    values = held(robot, options.slice)
    if options.inset is not None and not options.region:
        raise ValueError("--inset: only --region is proved but for an inset")
    if options.box:
        return statements.box(*_ranges(robot, options.box), options.margin)
    if options.path:
        return statements.path(read_points(robot, options.path), options.margin)
    if options.polygon:
        return statements.filled(
            [statements.anticlockwise(read_points(robot, options.polygon))], options.margin
        )
    if options.region:
        inset = statements.usual_inset(robot) if options.inset is None else options.inset
        return statements.inner_polygon(robot, inset, margin=options.margin, held=values)
    scale = float(number(options.scale or "1"))
    return statements.home_polygon(robot, scale, options.margin, values)


def read_points(robot: Robot, file: str) -> list[list[str]]:
    """Read a line of joint values a point, in the file's units; a first line may name joints."""
    try:
        with Path(file).open(newline="", encoding="utf-8-sig") as lines:
            rows = [(i, row) for i, row in enumerate(csv.reader(lines), 1) if any(row)]
    except UnicodeDecodeError:
        raise ValueError(f"{file}: not UTF-8 text") from None
    names = [joint.name for joint in robot.joints]
    if rows and [cell.strip() for cell in rows[0][1]] == names:
        del rows[0]
    return [
        [_decimal(f"{file}, line {i}", cell) for cell in _full(file, i, row, names)]
        for i, row in rows
    ]


def _full(file: str, i: int, row: Sequence[str], names: Sequence[str]) -> Sequence[str]:
    if len(row) != len(names):
        raise ValueError(f"{file}, line {i}: {len(row)} values for {', '.join(names)}")
    return row


def _decimal(where: str, text: str) -> str:
    """Keep a decimal as it is written."""
    try:
        number(text.strip())
    except ValueError:
        raise ValueError(f"{where}: {text!r} is no decimal number") from None
    return text.strip()


def _check_length(margin: str) -> None:
    _decimal("--margin", margin)
    if number(margin) < 0:
        raise ValueError(f"--margin {margin}: a length of 0 or more is wanted")


def _ranges(robot: Robot, texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Read ``q1=-20deg:30deg`` for every joint; one without a range has that of its limits."""
    names, found = [joint.name for joint in robot.joints], dict[str, Sequence[str]]()
    for text in texts:
        name, _, values = text.partition("=")
        if name not in names:
            raise ValueError(f"--box {text}: no joint {name!r}; there are {', '.join(names)}")
        found[name] = values.split(":") if ":" in values else [values, values]
    for joint, unit in zip(robot.joints, statements.units(robot), strict=True):
        if joint.name not in found and joint.limits is None:
            raise ValueError(f"--box: {joint.name} has no limits; give {joint.name}=LOW:HIGH")
        if joint.name not in found and joint.limits is not None:
            found[joint.name] = [statements.decimal(x / unit) for x in joint.limits]
    rows = [list(_ends(robot, j, found[name])) for j, name in enumerate(names)]
    return [low for low, _ in rows], [high for _, high in rows]


def _ends(robot: Robot, j: int, texts: Sequence[str]) -> Iterator[str]:
    """Keep decimals in the file's unit as they are written; convert the others."""
    if len(texts) != 2:
        raise ValueError(f"--box {robot.joints[j].name}: wanted LOW:HIGH, found {':'.join(texts)}")
    own = unit(robot, robot.joints[j])
    for text in texts:
        value = joint_value(robot, j, text)  # refuses what is no value
        plain = text.strip().removesuffix(own)
        exact = not plain.endswith(("deg", "rad"))
        yield plain if exact else statements.decimal(value / statements.units(robot)[j])


def in_words(robot: Robot, answer: Certificate) -> str:
    """Say how large a proof is, or how deep a witness lies."""
    if answer.witness is not None:
        found = answer.witness
        q = zip(robot.joints, found.q, strict=True)
        places = ", ".join(f"{j.name} = {x:.9g} {unit(robot, j)}" for j, x in q)
        limit = {f"{j.name}.{side}": unit(robot, j) for j in robot.joints for side in SIDES}
        return f"depth {found.depth:.9g} {limit.get(found.boundary, robot.length_unit)} at {places}"
    cells = ", ".join(f"{name} {found.leaves}" for name, found in answer.searches.items())
    return f"cells: {answer.leaves} ({cells})" if answer.verdict == "proved" else ""


def unit(robot: Robot, joint: Joint) -> str:
    """Return the file's unit of a joint's values."""
    return robot.angle_unit if joint.kind == "revolute" else robot.length_unit


def _say_bracket(robot: Robot, found: Bracket, output: str | None) -> int:
    """Print both ends; the file is the proof of the lower one."""
    safe, proof = found.safe
    unsafe, refutation = found.unsafe
    if proof is not None and proof.verdict == "proved":
        print(f"scale {safe}: proved\n{in_words(robot, proof)}")
        if output:
            write_text(output, proof.text)
    if refutation is not None and refutation.verdict == "refuted":
        print(f"scale {unsafe}: refuted\n{in_words(robot, refutation)}")
    both = [answer and answer.verdict for answer in (proof, refutation)]
    return 0 if both[0] == "proved" and both[1] in ("refuted", None) else 3
