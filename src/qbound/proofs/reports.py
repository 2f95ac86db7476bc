"""What was proved, as others read it: pavings as JSON, certificates in words."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from textwrap import wrap
from typing import Any

from qbound import check
from qbound.boundary.evaluator import limit_names
from qbound.export.formats import heading
from qbound.model.robot import Robot
from qbound.proofs.balls import above, below
from qbound.proofs.certify import Certificate
from qbound.proofs.columns import ColumnPaving
from qbound.proofs.paving import Paving
from qbound.proofs.verdict import Verdict
from qbound.proofs.witness import Witness
from qbound.units import counted, file_units

COLUMN = ("low", "high", "feasible", "undecided")
"""What a document tells of each column."""

SMALLEST = 1e-300
"""A volume rounded up from zero is below it."""

WIDEST = 100
"""Letters of a line that is read on a terminal."""

MANY = 12
"""Boundaries above which those of balls are summed up by their links."""


def paving_document(robot: Robot, paving: Paving) -> dict[str, Any]:
    """Return the JSON form of a paving, schema qbound/paving/1: cells by level and index.

    A cell of level L has halved joint j (counted from 0) ``(L + n - 1 - j) // n`` times; its index
    counts cells of that width from the lower end of the range.
    """
    inner, outer = paving.bracket
    return {
        **heading("qbound/paving/1", robot),
        "volume": {"inner": below(inner), "outer": above(outer)},
        "undecided": float(paving.undecided_fraction),
        "range": [[float(low), float(high)] for low, high in paving.bounds.ends],
        "cells": {
            word: [{"level": c.level, "index": c.index.tolist()} for c in groups]
            for word, groups in _groups(paving).items()
        },
    }


def paving_lines(robot: Robot, paving: Paving) -> Iterator[str]:
    """Say in sentences what a paving encloses."""
    inner, outer = (float(below(paving.bracket[0])), float(above(paving.bracket[1])))
    undecided = float(paving.undecided_fraction)
    yield from _bracket_lines(_volume_unit(robot, paving.problem.kinds), inner, outer, undecided)
    counts = {word: sum(map(len, cells)) for word, cells in _groups(paving).items()}
    yield ", ".join(f"{counted(count, 'cell')} {word}" for word, count in counts.items())


def columns_document(robot: Robot, paving: ColumnPaving, free: Sequence[int]) -> dict[str, Any]:
    """Return the JSON form of a paving of columns, schema qbound/columns/1; rad, or length.

    A column is a closed cell of all joints but one, the lift, with the volumes over it: what is
    proved feasible, at least, and what is undecided, at most.

    Parameters
    ----------
    free : sequence of int
        Which of the robot's joints move.
    """
    inner, outer = paving.bracket
    names, lift = [robot.joints[j].name for j in free], paving.lift
    return {
        **heading("qbound/columns/1", robot),
        "volume": {"inner": inner, "outer": outer},
        "undecided": paving.undecided_fraction,
        "joints": names,
        "range": [[float(low), float(high)] for low, high in paving.bounds.ends],
        "lift": names[lift],
        "columns": [
            {"from": low, "to": high, "feasible": feasible, "undecided": undecided}
            for low, high, feasible, undecided in zip(
                *(getattr(paving.columns, name).tolist() for name in COLUMN), strict=True
            )
        ],
    }


def columns_lines(robot: Robot, paving: ColumnPaving) -> Iterator[str]:
    """Say in sentences what a paving of columns encloses."""
    unit = _volume_unit(robot, paving.problem.kinds)
    yield from _bracket_lines(unit, *paving.bracket, paving.undecided_fraction)
    yield counted(len(paving.columns), "column")


def _bracket_lines(unit: str, inner: float, outer: float, undecided: float) -> Iterator[str]:
    if not undecided and outer < SMALLEST:
        yield f"volume 0 {unit}: nothing is feasible, proved"
    else:
        yield f"volume between {max(inner, 0.0):.9g} {unit} and {outer:.9g} {unit}"
    yield f"{100 * undecided:.3g} % of the range is undecided"


def _volume_unit(robot: Robot, kinds: Iterable[str]) -> str:
    """Write the product of the joints' units, such as rad^2 cm."""
    units = Counter("rad" if kind == "revolute" else robot.length_unit for kind in kinds)
    return " ".join(unit if n == 1 else f"{unit}^{n}" for unit, n in units.items())


def _groups(paving: Paving) -> dict[str, tuple[Any, ...]]:
    return {
        "feasible": paving.feasible,
        "infeasible": paving.infeasible,
        "undecided": (paving.undecided,),
    }


def folded(text: str) -> Iterator[str]:
    """Break the lines of a checker's answer where they are long, between words or points."""
    for line in text.splitlines():
        whole = re.sub(r", (?=[^()]*\))", ",\u00a0", line)  # a point is not broken
        rows = wrap(whole, WIDEST, subsequent_indent="  ", break_long_words=False)
        yield from (row.replace("\u00a0", " ") for row in rows)


def summed_up(said: str, robot: check.Robot) -> str:
    """Put what a checker says of many balls together, which are called LINK/1, LINK/2: by links.

    Parameters
    ----------
    said : str
        The checker's answer.
    robot : check.Robot
        As the checker read it.
    """
    count = len(robot.boundaries)
    if count <= MANY:
        return said
    lines = said.split("\n")
    first = next(k for k, line in enumerate(lines, 1) if line.startswith("all limits of joints"))
    rows: dict[tuple[str, ...], list[str]] = {}
    for boundary, line in zip(robot.boundaries, lines[first : first + count], strict=True):
        balls = [each.name for each in boundary.things if each.kind == "point" and each.radius]
        links = [name.rpartition("/")[0] for name in balls]
        named = all(links) and len(links) == len(boundary.things)
        what = "balls" if len(links) == 1 else "pairs of balls"
        key = (" and ".join(map(ascii, links)), what, line.rpartition(": ")[2])
        rows.setdefault(key if named else (line,), []).append(line)
    kept = [
        found[0] if len(found) == 1 else f"  {key[0]}: {len(found)} {key[1]}, {key[2]}"
        for key, found in rows.items()
    ]
    return "\n".join([*lines[:first], *kept, *lines[first + count :]])


def certificate_lines(robot: Robot, answer: Certificate) -> Iterator[str]:
    """Say how large a proof is, or how deep a witness lies; nothing where undecided."""
    if answer.witness is not None:
        yield _depth(robot, answer.witness)
    elif answer.verdict is Verdict.PROVED:
        counts = {name: found.leaves for name, found in answer.searches.items()}
        named = ", ".join(f"{name} {count}" for name, count in counts.items())
        if len(counts) > MANY:
            most = max(counts, key=counts.__getitem__)
            named = f"of {len(counts)} boundaries; at most {counts[most]}, of {most}"
        yield f"cells: {answer.leaves} ({named})"


def _depth(robot: Robot, found: Witness) -> str:
    """Write the depth with its unit, a length or that of a joint limit, and the configuration."""
    joints = list(zip(robot.joints, found.q, file_units(robot), strict=True))
    units = {name: unit for joint, _, unit in joints for name in limit_names(joint.name)}
    unit = units.get(found.boundary, robot.length_unit)
    place = ", ".join(f"{joint.name} = {x:.9g} {unit}" for joint, x, unit in joints)
    return f"depth {found.depth:.9g} {unit} at {place}"
