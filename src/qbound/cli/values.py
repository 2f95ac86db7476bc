"""What a user types and what the commands write: joint values in, whole files out."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from qbound import __version__
from qbound.model.robot import Robot

Content = str | bytes | Callable[[Path], object]
"""A text, bytes, or a function that writes the file at a path."""


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
        if names.index(name) in found:
            raise ValueError(f"--slice {text}: {name!r} is held twice")
        found[names.index(name)] = joint_value(robot, names.index(name), number)
    return found


def joint_value(robot: Robot, j: int, text: str) -> float:
    """Read a joint value: with deg or rad, or a plain number in the robot file's own unit."""
    revolute = robot.joints[j].kind == "revolute"
    text = text.strip()
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


def write_all(outputs: Sequence[tuple[str, Content]]) -> None:
    """Write several files, every one whole, or none at all; ``-`` is standard output, written last.

    Drafts are made beside the files and renamed when all of them are complete.
    """
    check_targets([file for file, _ in outputs])
    targets = [(Path(file).resolve(), content) for file, content in outputs if file != "-"]
    drafts = [path.with_name(f".{path.name}.{os.getpid()}.part") for path, _ in targets]
    try:
        for (path, content), draft in zip(targets, drafts, strict=True):
            try:
                _write(draft, content)
            except OSError as error:
                raise ValueError(f"{path}: not written: {error.strerror or error}") from None
        for (path, _), draft in zip(targets, drafts, strict=True):
            draft.replace(path)
    finally:
        for draft in drafts:
            draft.unlink(missing_ok=True)
    for content in (content for file, content in outputs if file == "-"):
        if isinstance(content, bytes):
            sys.stdout.buffer.write(content)
        else:
            print(content, end="")


def check_targets(files: Sequence[str], kinds: Sequence[str] = ()) -> None:
    """Refuse, before any work, files that could not be written.

    Parameters
    ----------
    kinds : sequence of str, optional
        Endings that are allowed, such as ``svg``.

    Raises
    ------
    ValueError
        If two are the same, a folder is missing, a target is no regular file, or an ending unknown.
    """
    seen = set()
    for file in files:
        path = Path(file).resolve() if file != "-" else Path("-")
        if path in seen:
            raise ValueError(f"{file}: two outputs go to this one place")
        seen.add(path)
        if file == "-":
            continue
        if not path.parent.is_dir():
            raise ValueError(f"{file}: No such file or directory: {path.parent}")
        if path.exists() and not path.is_file():
            raise ValueError(f"{file}: is no regular file")
        if kinds and path.suffix.removeprefix(".").lower() not in kinds:
            raise ValueError(
                f"{file}: unknown ending {path.suffix!r}; wanted: .{', .'.join(kinds)}"
            )


def write_text(file: str, text: str) -> None:
    """Write a text whole or not at all; ``-`` is standard output."""
    write_all([(file, text)])


def _write(draft: Path, content: Content) -> None:
    if isinstance(content, str):
        draft.write_text(content, encoding="utf-8", newline="\n")
    elif isinstance(content, bytes):
        draft.write_bytes(content)
    else:
        content(draft)


def json_text(content: Mapping[str, object]) -> str:
    """Return what a command found as JSON, a line an entry."""
    return json.dumps(content, indent=1) + "\n"


def csv_text(header: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """Return comma-separated values with a header; numbers with all their digits."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return buffer.getvalue()


def npz_bytes(arrays: Mapping[str, ArrayLike]) -> bytes:
    """Return arrays as a NumPy .npz file, the same bytes on every run."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **{k: np.asarray(v) for k, v in arrays.items()})
    return buffer.getvalue()


def joint_units(robot: Robot, joints: Iterable[int] | None = None) -> list[str]:
    """Return the unit of each joint's values: ``rad``, or the robot's length unit."""
    chosen = range(len(robot.joints)) if joints is None else joints
    return ["rad" if robot.kinds[j] == "revolute" else robot.length_unit for j in chosen]


def heading(schema: str, robot: Robot, rule: str) -> dict[str, Any]:
    """Return what a JSON of paths or poses begins with: what, of which robot, in which units."""
    return {
        "schema": schema,
        "robot": robot.name,
        "version": __version__,
        "rule": rule,
        "joints": [joint.name for joint in robot.joints],
        "units": {"joints": joint_units(robot), "length": robot.length_unit},
    }


def shown(robot: Robot, j: int, value: float) -> str:
    """Return a joint's name and value, for a reader, in the units of the robot file."""
    joint, unit = robot.joints[j], robot.length_unit
    if joint.kind == "revolute":
        unit = robot.angle_unit
        value = math.degrees(value) if unit == "deg" else value
    return f"{joint.name} = {value:.6g} {unit}"
