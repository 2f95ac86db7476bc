"""The specification of a sweep: a TOML file, checked as robot files are, and its robot.

    schema = 1
    robot = "arm.toml"      # seen from this file's folder; or a packaged robot's name
    measure = ["region.area", "workspace.area"]
    vary = [{ number = "joint.elbow.origin.0", from = 0.2, to = 0.6, count = 41 }]

Numbers are named as in `qbound.design.varied`, measures as in `measures`; ``held.wrist`` is the
value of a joint that is held. Optional keys: `also` in a row of `vary`: further numbers that take
its values; `slice`: joints that are held at one value; `rule`; `tolerance` of pavings; `fibre`: the
joint whose travel is measured; `chunk`: how many arms are measured together. Every number is in
the robot file's unit.

The arms of a sweep are a grid with an axis for each row of `vary`, cut into chunks on the last.
"""

from __future__ import annotations

import math
import tomllib
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import UNSET, Meta, UnsetType, field

from qbound.arrays import Floats
from qbound.boundary.balls import Balls
from qbound.boundary.evaluator import forms_bytes
from qbound.design import Path as Place
from qbound.design import varied
from qbound.model.robot import Robot
from qbound.model.robotfile import RobotFileError, load_robot, packaged_robots, robot_table
from qbound.model.rows import Label, Number, Row
from qbound.model.schema import JsonPath, explained, leaves, one_line, place, shown
from qbound.printable import printable
from qbound.proofs.exact.problem import paving_bytes
from qbound.sweeps.measures import HELD, MEASURES, Job, versions

MOST_VARIED = 6
MOST_CELLS = 1_000_000
"""Arms of a sweep at most."""

MeasureName = Literal[
    "region.area",
    "region.home.area",
    "region.components",
    "workspace.area",
    "paving.inner",
    "paving.outer",
    "fibre.length",
    "fibre.home.length",
]


Faults = Iterator[tuple[JsonPath, str]]


class SpecificationError(ValueError):
    """Error of a specification: names the file, the key, what was found, what is allowed."""

    def __init__(self, text: str) -> None:
        """Make the message printable, because names of files and keys come from outside."""
        super().__init__(printable(text))


class VaryRow(Row, kw_only=True):
    """A table of `vary`: a number, and the values that it takes, equally far apart."""

    number: Label
    also: Annotated[list[Label], Meta(description="a list of names of numbers")] = field(
        default_factory=list
    )
    first: Number = field(name="from")
    last: Number = field(name="to")
    count: Annotated[int, Meta(ge=1, le=MOST_CELLS)]

    @property
    def numbers(self) -> list[str]:
        """All numbers that take these values together."""
        return [self.number, *self.also]


class Specification(Row, kw_only=True):
    """A specification of a sweep, schema 1."""

    schema: Literal[1]
    robot: Label
    rule: Literal["clearance", "paper"] = "clearance"
    slice: Annotated[
        dict[str, Number], Meta(description="a table with a number for each joint that is held")
    ] = field(default_factory=dict)
    vary: Annotated[
        list[VaryRow],
        Meta(min_length=1, max_length=MOST_VARIED, description="a list of 1 to 6 tables"),
    ]
    measure: Annotated[
        list[MeasureName], Meta(min_length=1, description="a list of one or more measures")
    ]
    tolerance: Annotated[float, Meta(gt=0, lt=1)] = 0.01
    fibre: Label | UnsetType = UNSET
    chunk: Annotated[int, Meta(ge=1, le=10_000)] = 16


@dataclass(frozen=True, eq=False)
class Study:
    """A specification, and the robot that it names."""

    specification: Specification
    robot: Robot


@cache
def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a specification; ``schemas/sweep.schema.json`` is this."""
    (_,), rows = msgspec.json.schema_components([Specification], ref_template="#/$defs/{name}")
    draft = "https://json-schema.org/draft/2020-12/schema"
    top = rows.pop("Specification") | {"title": "qbound specification of a sweep, schema 1"}
    return {"$schema": draft, **top, "$defs": rows}


def read_specification(path: str | Path) -> Study:
    """Read a specification and the robot file that it names.

    Parameters
    ----------
    path : str or Path
        A file; the robot's path in it is relative to the folder of the file.

    Raises
    ------
    SpecificationError
        The message has the first fault, its place, and what is allowed there.
    qbound.model.robotcheck.RobotFileError
        If the robot file is wrong.
    """
    table = _content(path)
    try:
        specification = msgspec.convert(table, Specification)
    except ValueError as error:
        for where, number in leaves(table):
            if isinstance(number, float) and not math.isfinite(number):
                raise fault(path, table, where, f"{shown(number)} is no finite number") from None
        where, text = explained(str(error), table, json_schema())
        raise fault(path, table, where, text) from None
    source = _robot_source(specification.robot, Path(path).parent)
    try:
        robot = load_robot(source)
    except RobotFileError as error:
        raise SpecificationError(f"{path}: robot: {error}") from None
    study = Study(specification, robot)
    for where, text in _faults(study):
        raise fault(path, table, where, text)
    return study


def fault(path: str | Path, table: Any, where: JsonPath, text: str) -> SpecificationError:
    """Return the error of a fault at a place of a specification."""
    key = place(table, where)
    return SpecificationError(f"{path}: {key}: {text}" if key else f"{path}: {text}")


def _content(path: str | Path) -> dict[str, Any]:
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise SpecificationError(f"{path}: {reason}") from None
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise SpecificationError(f"{path}: not TOML: {error}") from None


def _robot_source(name: str, folder: Path) -> str | Path:
    return name if name in packaged_robots() else folder / name


# --- what types cannot say ------------------------------------------------------------------------


def _faults(study: Study) -> Faults:
    """Yield what is wrong with a specification, each with its place."""
    yield from _number_faults(study)
    yield from _joint_faults(study)
    yield from _measure_faults(study)
    cells = 1
    for i, row in enumerate(study.specification.vary):
        cells *= row.count
        if cells > MOST_CELLS:
            yield ("vary", i, "count"), f"makes {cells} arms; at most {MOST_CELLS}"


def _number_faults(study: Study) -> Faults:
    """Yield numbers that the robot lacks, numbers named twice, and values that do not rise."""
    seen = set()
    for i, row in enumerate(study.specification.vary):
        for k, name in enumerate(row.numbers):
            where = ("vary", i, "number") if k == 0 else ("vary", i, "also", k - 1)
            if text := _place_fault(study.robot, name, row.first):
                yield where, text
            if (key := _key(name)) in seen:
                yield where, f"{one_line(name)} is varied twice"
            seen.add(key)
        if row.last < row.first or (row.last == row.first and row.count > 1):
            yield ("vary", i, "to"), f"{row.last:g} is not above {row.first:g}, the value of 'from'"
        if row.count == 1 and row.first != row.last:
            yield ("vary", i, "count"), "1 value cannot be both 'from' and 'to'; wanted: 2 or more"
        ends = [_robot_fault(study.robot, row, value) for value in (row.first, row.last)]
        if all(ends):
            yield ("vary", i), f"neither end is a robot: {ends[0]}"


def _key(name: str) -> tuple[str | int, ...]:
    """Return a key that is equal for two names of one number."""
    return tuple(int(step) if step.isdecimal() else step for step in name.split("."))


def _place_fault(robot: Robot, name: str, value: float) -> str | None:
    """Return why a name is not the name of a number; the value is not checked."""
    try:
        if name.startswith(HELD):
            robot.joint_index(name.removeprefix(HELD))
        else:
            _varied(robot, {name: value})
    except RobotFileError:
        return None
    except ValueError as error:
        return str(error)
    return None


def _robot_fault(robot: Robot, row: VaryRow, value: float) -> str | None:
    """Return why the robot with this value in a row's numbers is not allowed."""
    placed: list[Place] = [name for name in row.numbers if not name.startswith(HELD)]
    try:
        _varied(robot, dict.fromkeys(placed, value))
    except ValueError as error:
        return str(error)
    return None


def _varied(robot: Robot, numbers: dict[Place, float]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        varied(robot, numbers)


def _joint_faults(study: Study) -> Faults:
    """Yield held joints that do not exist or are held twice."""
    names = [joint.name for joint in study.robot.joints]
    for joint in study.specification.slice:
        if joint not in names:
            known = ", ".join(map(one_line, names))
            yield ("slice", joint), f"no joint {one_line(joint)!r}; there are {known}"
    for i, row in enumerate(study.specification.vary):
        for name in row.numbers:
            if name.removeprefix(HELD) in study.specification.slice and name.startswith(HELD):
                yield ("vary", i), f"{one_line(name)} is varied, and 'slice' holds it"
    if len(held_names(study.specification)) == len(names):
        yield ("slice",), "every joint is held; one or more must move"


def _measure_faults(study: Study) -> Faults:
    """Yield measures that this robot cannot have for any numbers."""
    held = held_names(study.specification)
    free = [joint.name for joint in study.robot.joints if joint.name not in held]
    seen = set()
    for i, name in enumerate(study.specification.measure):
        if name in seen:
            yield ("measure", i), f"{name} is asked for twice"
        seen.add(name)
        needs = MEASURES[name].needs
        if needs == "two joints" and len(free) != 2:
            moving = f"{len(free)} of {len(study.robot.joints)} are not held"
            text = f"{name} takes two joints; {moving} ({', '.join(map(one_line, free))})"
            yield ("measure", i), text
        if study.specification.rule == "paper" and needs != "two joints":
            yield ("measure", i), f"{name} knows the clearance rule only"
        if needs == "a fibre":
            yield from ((("measure", i), f"{name} {text}") for text in _fibre_faults(study))
    if study.specification.rule == "paper" and held:
        yield ("rule",), "the paper's rule knows two joints only: nothing can be held"


def _fibre_faults(study: Study) -> Iterator[str]:
    """Yield the reasons why no arm of a sweep can have a fibre."""
    specification, held = study.specification, held_names(study.specification)
    names = [joint.name for joint in study.robot.joints]
    known = ", ".join(map(one_line, names))
    if specification.fibre is UNSET:
        yield f"takes a joint that moves: set 'fibre' to one of {known}"
    elif specification.fibre not in names:
        yield f"takes 'fibre', and there is no joint {shown(specification.fibre)}; {known}"
    elif specification.fibre in held:
        yield f"takes 'fibre', and {one_line(specification.fibre)} is held"
    try:
        Balls.of(study.robot)
    except ValueError as error:
        yield f"takes points and balls: {error}"


def arm_bytes(study: Study) -> int:
    """Estimate the memory that measuring one arm takes."""
    robot, wanted = study.robot, study.specification
    kinds = {name.partition(".")[0] for name in wanted.measure}
    found = [0]
    if kinds & {"region", "workspace"}:
        found.append(forms_bytes(robot))
    if "paving" in kinds:
        found.append(paving_bytes(len(robot.used), len(robot.free(held_names(wanted)))))
    return max(found)


def held_names(specification: Specification) -> set[str]:
    """Return the joints that are held, at one value or at several."""
    numbers = [name for row in specification.vary for name in row.numbers]
    varied = {name.removeprefix(HELD) for name in numbers if name.startswith(HELD)}
    return varied | set(specification.slice)


# --- the arms of a sweep --------------------------------------------------------------------------


Chunk = tuple[int, ...]


def axes(specification: Specification) -> tuple[Floats, ...]:
    """Return the values of each varied number, in the robot file's unit."""
    return tuple(np.linspace(row.first, row.last, row.count) for row in specification.vary)


def shape(specification: Specification) -> tuple[int, ...]:
    """Return the number of values on each axis."""
    return tuple(row.count for row in specification.vary)


def chunk_shape(specification: Specification) -> tuple[int, ...]:
    """Return how many arms a chunk has on each axis; this does not depend on the workers."""
    *before, last = shape(specification)
    return (*(1 for _ in before), min(last, specification.chunk))


def chunks(specification: Specification) -> Iterator[Chunk]:
    """Yield the index of every chunk, the last axis first to change."""
    return product(*map(range, _chunk_counts(specification)))


def count_chunks(specification: Specification) -> int:
    """Return how many chunks there are."""
    return math.prod(_chunk_counts(specification))


def _chunk_counts(specification: Specification) -> list[int]:
    sizes = zip(shape(specification), chunk_shape(specification), strict=True)
    return [-(-count // size) for count, size in sizes]


def window(specification: Specification, chunk: Chunk) -> tuple[slice, ...]:
    """Return the part of the grid that a chunk covers; the last one on an axis may be smaller."""
    places = zip(chunk, chunk_shape(specification), shape(specification), strict=True)
    return tuple(slice(k * size, min((k + 1) * size, count)) for k, size, count in places)


def job(study: Study, chunk: Chunk) -> Job:
    """Return the job of a chunk, as plain data."""
    specification = study.specification
    parts = zip(axes(specification), window(specification, chunk), strict=True)
    values = product(*(axis[part].tolist() for axis, part in parts))
    return Job(
        chunk=chunk,
        table=robot_table(study.robot),
        held=specification.slice,
        rule=specification.rule,
        tolerance=specification.tolerance,
        fibre=None if specification.fibre is UNSET else specification.fibre,
        measures=tuple(specification.measure),
        arms=tuple(_numbers(study, arm) for arm in values),
        versions=versions(),
    )


def _numbers(study: Study, values: tuple[float, ...]) -> dict[str, float]:
    """Return the numbers, by name, of the arm with these values on the axes."""
    rows = zip(study.specification.vary, values, strict=True)
    return {name: value for row, value in rows for name in row.numbers}
