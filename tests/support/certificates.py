"""Certificates of both grammars, found by the checker's own bound: for tests of the checkers."""

import hashlib
import json
from fractions import Fraction
from itertools import combinations
from typing import Any

from qbound import check


def certificate(robot: str, statement: dict[str, Any], grammar: int = 2, depth: int = 14) -> str:
    """Prove a statement, cutting where a cell is longest; `ValueError` where that does not end."""
    ours = check.read_robot(robot)
    read = check.read_statement(statement, grammar, len(ours.joints))
    kinematics, proof, check.Ball.work = check.Kinematics(ours), {}, 0
    for boundary in ours.boundaries:
        gap = boundary.gap(read.margin)
        if boundary.needs_proof(read.margin):
            function = check.function_of(ours, check.boundary_form(kinematics, boundary, gap))
            proof[boundary.name] = [tree(function, cell, depth) for cell in read.cells]
    return text(robot, statement, grammar, verdict="proved", proof=proof)


def text(robot: str, statement: dict[str, Any], grammar: int, **evidence: Any) -> str:
    """Write the file around some evidence."""
    content = {"schema": f"qbound/certificate/{grammar}", "statement": statement, "robot": robot}
    digest = hashlib.sha256(robot.encode()).hexdigest()
    return json.dumps(content | {"sha256": digest} | evidence)


def tree(function: check.Function, cell: check.Cell, depth: int) -> str:
    """Cut a cell until the bound is positive."""
    if check.is_positive(function, cell):
        return "."
    if not depth:
        raise ValueError("not proved")
    letter = longest(cell)
    return letter + "".join(tree(function, half, depth - 1) for half in cell.halves(letter))


def longest(cell: check.Cell) -> str:
    """Return the letter of the longest edge, or of the widest joint."""
    if isinstance(cell, check.Box):
        lengths = [b - a for a, b in zip(cell.low, cell.high, strict=True)]
    else:
        lengths = [squared(p, q) for p, q in combinations(cell.corners, 2)]
    return chr(ord("a") + max(range(len(lengths)), key=lengths.__getitem__))


def squared(p: check.Point, q: check.Point) -> Fraction:
    return sum(((x - y) ** 2 for x, y in zip(p, q, strict=True)), Fraction(0))
