"""Certificates of both grammars, found by the checker's own bound: for tests of the checkers."""

import hashlib
import json
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import chain, combinations, count
from typing import Any

from qbound import check


def certificate(
    robot: str,
    statement: dict[str, Any],
    grammar: int = 2,
    depth: int = 14,
    parts: dict[str, list[list[int]]] | None = None,
) -> str:
    """Prove a statement, cutting where a cell is longest; `ValueError` where that does not end."""
    ours = check.read_robot(robot)
    read = check.read_statement(statement, grammar, len(ours.joints))
    whole = {name: [[*range(len(body.corners))]] for name, body in ours.outlines.items()}
    proving, check.Ball.work = check.Proving(ours, parts or whole, read.margin), 0
    proof = {
        boundary.name: [
            tree(asked, cell, depth) for asked in proving.asked(boundary) for cell in read.cells
        ]
        for boundary in ours.boundaries
        if boundary.needs_proof(read.margin)
    }
    evidence = {"proof": proof} | ({"parts": parts or whole} if grammar == 3 else {})
    return text(robot, statement, grammar, verdict="proved", **evidence)


def text(robot: str, statement: dict[str, Any], grammar: int, **evidence: Any) -> str:
    """Write the file around some evidence."""
    content = {"schema": f"qbound/certificate/{grammar}", "statement": statement, "robot": robot}
    digest = hashlib.sha256(robot.encode()).hexdigest()
    return json.dumps(content | {"sha256": digest} | evidence)


def tree(asked: check.Asked, cell: check.Cell, depth: int) -> str:
    """Cut a cell until a bound is positive: the only one, or that of a feature."""
    for leaf, functions in leaves(asked):
        if all(check.is_positive(function, cell) for function in functions):
            return leaf
    if not depth:
        raise ValueError("not proved")
    letter = longest(cell)
    return letter + "".join(tree(asked, half, depth - 1) for half in cell.halves(letter))


def leaves(asked: check.Asked) -> Iterator[tuple[str, list[check.Function]]]:
    """Return what may be named at a leaf: nothing, or each feature by its number."""
    for number in chain([None], count()):
        try:
            yield "." if number is None else f"{number}.", asked(number, "")
        except check.Refused:
            if number is not None:
                return


def longest(cell: check.Cell) -> str:
    """Return the letter of the longest edge, or of the widest joint."""
    if isinstance(cell, check.Box):
        lengths = [b - a for a, b in zip(cell.low, cell.high, strict=True)]
    else:
        lengths = [squared(p, q) for p, q in combinations(cell.corners, 2)]
    return chr(ord("a") + max(range(len(lengths)), key=lengths.__getitem__))


def squared(p: check.Point, q: check.Point) -> Fraction:
    return sum(((x - y) ** 2 for x, y in zip(p, q, strict=True)), Fraction(0))


def put(*path: Any) -> Callable[[dict[str, Any]], None]:
    """Return what puts a value, or a function of the old one, at a place of a certificate."""
    *steps, last, value = path

    def change(data: Any) -> None:
        for step in steps:
            data = data[step]
        data[last] = value(data[last]) if callable(value) else value

    return change


def in_robot(old: str, new: str) -> Callable[[dict[str, Any]], None]:
    """Return what changes the robot file of a certificate, and its digest."""

    def change(data: dict[str, Any]) -> None:
        assert old in data["robot"]
        data["robot"] = data["robot"].replace(old, new)
        data["sha256"] = hashlib.sha256(data["robot"].encode()).hexdigest()

    return change
