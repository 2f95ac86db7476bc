"""Sweeps: measures of the regions of many arms that differ in some numbers; not in the paper.

The specification is a TOML file, checked as robot files are:

    schema = 2
    robot = "arm.toml"      # seen from this file's folder; or a packaged robot's name
    measure = ["region.area", "workspace.area"]
    vary = [{ number = "joint.elbow.origin.0", from = 0.2, to = 0.6, count = 41 }]

Numbers are named as in `cspace.design.varied`, measures as in `MEASURES`; ``held.wrist`` is the
value of a joint that is held. Optional keys: `also` in a row of `vary`: further numbers that take
its values; `slice`: joints that are held at one value. Every number is in the robot file's unit.
The arms are a grid, an axis a row.

The folder of a sweep has two files. ``sweep.json`` says what is swept: another sweep is refused.
``points.jsonl`` has a line of JSON for each finished arm: index, varied numbers, measures (or
null), and the reason of each null. An interrupted sweep goes on after the lines that it has; when
all are there, they are put in the order of the grid, so that the bytes are always the same.

Dask gives the arms to processes. Only this one writes, so workers need no common disk. Dask's
processes send each other code (pickle): anybody who can reach a scheduler can run code on its
workers. The one that is started here listens on this machine only; the user is responsible for any
other.
"""

import json
import math
import os
import signal
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta, field

from cspace import design
from cspace.arrays import Floats
from cspace.extras import require
from cspace.files import read_bytes, write_whole
from cspace.model.robot import Robot
from cspace.model.robotfile import load_robot, packaged_robots, parse_robot, robot_table
from cspace.model.rows import Label, Number, Row
from cspace.model.schema import JsonPath, explained, leaves, one_line, place
from cspace.printable import printable
from cspace.region import Region, find_region
from cspace.version import __version__

MEASURES: Mapping[str, Callable[[Region], float]] = {
    "region.area": design.MEASURES["area"],
    "region.home.area": design.MEASURES["home area"],
    "region.components": lambda region: len(region.components),
    "workspace.area": design.workspace_area,
}
"""By the name that a specification uses; a new one is a row here and a name in `Specification`."""


class SweepError(ValueError):
    """Error of a specification or a folder: names the place, what was found, what is wanted."""

    def __init__(self, text: str) -> None:
        """Make the message printable, because names of files and keys come from outside."""
        super().__init__(printable(text))


# --- the specification ----------------------------------------------------------------------------


MOST_ARMS = 1_000_000
"""Arms of a sweep at most; they take about 0.7 GB of memory."""

HELD = "held."
"""What the name of a held joint's value begins with, such as ``held.wrist``."""


Names = Annotated[list[Label], Meta(description="a list of names of numbers")]
Held = Annotated[dict[str, Number], Meta(description="a table with a number for each held joint")]
MeasureName = Literal["region.area", "region.home.area", "region.components", "workspace.area"]


class VaryRow(Row, kw_only=True):
    """A table of `vary`: a number, and the values that it takes, equally far apart."""

    number: Label
    also: Names = field(default_factory=list)
    first: Number = field(name="from")
    last: Number = field(name="to")
    count: Annotated[int, Meta(ge=1, le=MOST_ARMS)]

    @property
    def numbers(self) -> list[str]:
        """All numbers that take these values together."""
        return [self.number, *self.also]

    @property
    def values(self) -> Floats:
        """The values, in the robot file's unit."""
        return np.linspace(self.first, self.last, self.count)


class Specification(Row, kw_only=True):
    """A specification of a sweep, schema 2."""

    schema: Literal[2]
    robot: Label
    slice: Held = field(default_factory=dict)
    vary: Annotated[list[VaryRow], Meta(min_length=1, max_length=6)]
    measure: Annotated[list[MeasureName], Meta(min_length=1)]

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of values on each axis."""
        return tuple(row.count for row in self.vary)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a specification; ``schemas/sweep.schema.json`` is this."""
    (_,), rows = msgspec.json.schema_components([Specification], ref_template="#/$defs/{name}")
    draft = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": draft, **rows.pop("Specification"), "$defs": rows}


def read_specification(path: str | Path) -> tuple[Specification, Robot]:
    """Read a specification and the robot file that it names.

    Raises
    ------
    SweepError
        The message has the first fault, its place, and what is allowed there.
    """
    try:
        content = read_bytes(path)
    except ValueError as error:
        raise SweepError(f"{path}: {error}") from None
    try:
        table = tomllib.loads(content.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise SweepError(f"{path}: not TOML: {error}") from None
    try:
        asked = msgspec.convert(table, Specification)
        packaged = asked.robot in packaged_robots()
        robot = load_robot(asked.robot if packaged else Path(path).parent / asked.robot)
    except msgspec.ValidationError as error:
        where, text = explained(str(error), table, json_schema())
        raise SweepError(f"{path}: {place(table, where) or 'top level'}: {text}") from None
    except ValueError as error:
        raise SweepError(f"{path}: robot: {error}") from None
    for where, text in _faults(asked, robot):
        raise SweepError(f"{path}: {place(table, where)}: {text}")
    return asked, robot


def _faults(asked: Specification, robot: Robot) -> Iterator[tuple[JsonPath, str]]:
    """Yield what types cannot say: numbers that the robot lacks, axes that do not rise."""
    named = [HELD + name for name in asked.slice]
    if text := _refusal(asked, robot, {}):
        yield ("slice",), text
    for i, row in enumerate(asked.vary):
        named += row.numbers
        ends = [dict.fromkeys(row.numbers, x) for x in (row.first, row.last)]
        refusals = [_refusal(asked, robot, numbers) for numbers in ends]
        if all(refusals):
            yield ("vary", i), refusals[0]
        if row.last < row.first or (row.last == row.first) != (row.count == 1):
            yield ("vary", i), f"{row.count} from {row.first:g} to {row.last:g} do not rise"
    if twice := [name for name in named if named.count(name) > 1]:
        yield ("vary",), f"{one_line(twice[0])} has two values"
    if math.prod(asked.shape) > MOST_ARMS:
        yield ("vary",), f"makes {math.prod(asked.shape)} arms; at most {MOST_ARMS}"
    free = [joint.name for joint in robot.joints if HELD + joint.name not in named]
    if len(free) != 2:
        yield ("measure", 0), f"takes two joints, and {len(free)} are not held"


def _refusal(asked: Specification, robot: Robot, numbers: Mapping[str, float]) -> str:
    """Return why there is no arm with these numbers; empty where there is one."""
    try:
        arm_of(asked, robot_table(robot), numbers)
    except ValueError as error:
        return str(error)
    return ""


# --- one arm, on any machine ----------------------------------------------------------------------


Index = tuple[int, ...]
"""Of an arm on each axis of the grid."""

Arm = tuple[Robot, dict[int, float]]
"""A robot, and the values of its held joints by index, rad or length."""

Lines = Iterator[tuple[Index, bytes]]
"""Arms with their lines of JSON, in any order."""


VERSIONS = {"qbound": __version__, "numpy": np.__version__}
"""Those on which the last digits of a measure may depend."""


def arm_of(asked: Specification, table: Mapping[str, Any], numbers: Mapping[str, float]) -> Arm:
    """Return the robot with these numbers, checked as a file is, and its held joints' values.

    Raises
    ------
    ValueError
        If there is no such robot, or no such joint.
    """
    held = {n.removeprefix(HELD): x for n, x in numbers.items() if n.startswith(HELD)}
    placed: dict[Any, float] = {n: x for n, x in numbers.items() if not n.startswith(HELD)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # shown when the sweep began
        arm = design.varied(parse_robot(table), placed)
    angle = math.radians(1.0) if arm.angle_unit == "deg" else 1.0
    values = [(arm.joint_index(name), x) for name, x in {**asked.slice, **held}.items()]
    return arm, {j: x * arm.joints[j].scale(angle) for j, x in values}


def measured(asked: Specification, table: Mapping[str, Any], wanted: object, index: Index) -> bytes:
    """Measure one arm of a sweep; return its line of JSON, with the reason where a measure fails.

    Raises
    ------
    RuntimeError
        If this process has other versions than the sweep was begun with.
    MemoryError, OSError, ImportError
        Errors of the machine, which say nothing about the arm.
    """
    if wanted != VERSIONS:
        raise RuntimeError(f"a worker has {VERSIONS}; wanted: {wanted}")
    values = {row.number: float(row.values[i]) for row, i in zip(asked.vary, index, strict=True)}
    numbers = {name: values[row.number] for row in asked.vary for name in row.numbers}
    point: dict[str, Any] = {"index": index, **values, **dict.fromkeys(asked.measure), "reason": ""}
    try:
        region = find_region(*arm_of(asked, table, numbers))
        for name in asked.measure:
            point[name] = float(MEASURES[name](region))
    except (MemoryError, OSError, ImportError):
        raise
    except Exception as error:  # no arm ends the sweep of all
        point["reason"] = printable(f"{type(error).__name__}: {error}")
    return json.dumps(point).encode() + b"\n"


# --- the folder -----------------------------------------------------------------------------------


ABOUT, POINTS = "sweep.json", "points.jsonl"


def begin(asked: Specification, robot: Robot, folder: Path) -> dict[Index, bytes]:
    """Make the folder of a sweep, or open it to go on; return the lines of finished arms.

    Raises
    ------
    SweepError
        If it holds something else, which is left as it is.
    OSError
        If the folder cannot be made.
    """
    wanted = {
        "schema": "qbound/sweep/3",
        "versions": VERSIONS,
        "specification": msgspec.to_builtins(asked),
        "robot": robot_table(robot),
    }
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        folder.mkdir(exist_ok=True)
        write_whole(folder / ABOUT, (json.dumps(wanted, indent=1) + "\n").encode())
    try:
        found = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        raise SweepError(f"{folder}: is no sweep; wanted: a folder that is new or empty") from None
    there, here = ({".".join(map(str, at)): x for at, x in leaves(c)} for c in (found, wanted))
    for at in [*here, *there]:
        if here.get(at) != there.get(at):
            values = f"{json.dumps(there.get(at))} there, {json.dumps(here.get(at))} here"
            raise SweepError(f"{folder}: holds another sweep ({at}: {values}); name another folder")
    return _finished(asked, folder / POINTS)


def _finished(asked: Specification, path: Path) -> dict[Index, bytes]:
    """Return the lines of finished arms; a last line that is half written is cut off the file."""
    content = path.read_bytes() if path.exists() else b""
    *rows, half = content.split(b"\n")
    lines: dict[Index, bytes] = {}
    for number, row in enumerate(rows, 1):
        try:
            index = tuple(json.loads(row)["index"])
            np.ravel_multi_index(index, asked.shape)
        except (ValueError, TypeError, KeyError):
            raise SweepError(f"{path}, line {number}: is no arm of this sweep") from None
        lines[index] = row + b"\n"
    if half:
        os.truncate(path, len(content) - len(half))
    return lines


# --- a whole sweep --------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Swept:
    """The results of a sweep.

    Attributes
    ----------
    axes : dict of str to ndarray
        Values of each varied number, in the robot file's unit.
    values : dict of str to ndarray
        Each measure over the grid; NaN where it failed or is missing.
    reasons : dict of tuple of int to str
        Reason of each NaN, by the arm's index on each axis.
    missing : int
        Arms that no worker survived; the sweep can be continued.
    """

    axes: dict[str, Floats]
    values: dict[str, Floats]
    reasons: dict[Index, str]
    missing: int

    def to_xarray(self) -> Any:
        """Return the measures as an `xarray.Dataset` over the varied numbers.

        Raises
        ------
        ModuleNotFoundError
            If xarray is not installed; no extra installs it.
        """
        try:
            xarray = import_module("xarray")
        except ModuleNotFoundError:
            raise ModuleNotFoundError("a dataset takes xarray: pip install xarray") from None
        cells = {name: (list(self.axes), values) for name, values in self.values.items()}
        return xarray.Dataset(cells, coords=self.axes)


def sweep(
    specification: str | Path,
    folder: str | Path,
    scheduler: str | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> Swept:
    """Measure every arm of a specification.

    A second call with the same folder continues: arms that are finished are not measured again.

    Parameters
    ----------
    specification : str or Path
        A file, described above.
    folder : str or Path
        New, empty, or of the same sweep.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``tcp://host:8786``; default: workers of this machine.
    workers : int, optional
        Processes on this machine, where no scheduler is given; default: one for each core.
    progress : callable
        Called with the number of finished arms.

    Raises
    ------
    SweepError
        If the specification is wrong, or the folder holds something else.
    ModuleNotFoundError
        If ``cspace[cluster]`` is not installed.
    OSError
        If the scheduler does not answer, or a file cannot be written.
    """
    require("distributed")
    asked, robot = read_specification(specification)
    lines = begin(asked, robot, Path(folder))
    todo = [index for index in np.ndindex(asked.shape) if index not in lines]
    if todo:
        work = partial(measured, asked, robot_table(robot), VERSIONS)
        with (Path(folder) / POINTS).open("ab", buffering=0) as file:
            for index, line in on_dask(work, todo, scheduler, workers):
                file.write(line)
                lines[index] = line
                progress(len(lines))
        in_order = b"".join(lines[index] for index in np.ndindex(asked.shape) if index in lines)
        write_whole(Path(folder) / POINTS, in_order)
    return _swept(asked, lines)


def _swept(asked: Specification, lines: Mapping[Index, bytes]) -> Swept:
    reasons = {}
    values = {str(name): np.full(asked.shape, np.nan) for name in asked.measure}
    for index in sorted(lines):
        point = json.loads(lines[index])
        for name, array in values.items():
            array[index] = np.nan if point[name] is None else point[name]
        if point["reason"]:
            reasons[index] = point["reason"]
    axes = {row.number: row.values for row in asked.vary}
    return Swept(axes, values, reasons, math.prod(asked.shape) - len(lines))


# --- work on other processes ----------------------------------------------------------------------


AT_ONCE = 1000
"""Arms that are sent to the scheduler at a time."""


def on_dask(work: Any, todo: list[Index], address: str | None, workers: int | None) -> Lines:
    """Run the work on the scheduler at an address, or on workers of this machine.

    Yields arms with their lines, in any order, but not those that no worker survives.

    Raises
    ------
    OSError
        If the scheduler does not answer, or is gone.
    """
    from distributed import Client, KilledWorker, as_completed

    if address is None:
        with ThreadPoolExecutor(1) as pool, pool.submit(_local_cluster, workers).result() as local:
            yield from on_dask(work, todo, local.scheduler_address, workers)
        return
    with Client(address, set_as_default=False) as client:
        for k in range(0, len(todo), AT_ONCE):
            sent = {client.submit(work, arm, pure=False): arm for arm in todo[k : k + AT_ONCE]}
            for future in as_completed(list(sent), loop=client.loop):
                try:  # Dask computes a result again that was lost with its worker
                    yield sent[future], future.result()
                except KilledWorker:
                    pass
                except CancelledError:
                    raise OSError("the scheduler is gone; the same command goes on") from None


def _local_cluster(workers: int | None) -> Any:
    """Start workers that a Ctrl-C does not reach, and a scheduler, on this machine alone.

    A terminal sends the signal to every process, and workers would answer with tracebacks. What a
    thread starts that blocks the signal has it blocked, and so has what takes its place later.
    """
    from distributed import LocalCluster

    resource_tracker.ensure_running()  # else a worker starts it first, which ends the blocking
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",  # a free port: two sweeps may run at one time
        silence_logs="CRITICAL",
    )
