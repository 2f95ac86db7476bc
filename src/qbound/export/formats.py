"""Texts and bytes of files: JSON, comma-separated values, NumPy arrays; the same on every run."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from qbound.model.robot import Robot
from qbound.printable import printable
from qbound.units import joint_units

FORMULA = tuple("=+-@＝＋－＠")
"""What a formula of a spreadsheet begins with; tab and return, others, are escaped as it is."""


def heading(schema: str, robot: Robot) -> dict[str, Any]:
    """Return what every JSON begins with: what it is, of which robot, by which version."""
    from qbound.version import __version__  # slow to find, and few commands say it

    return {"schema": schema, "robot": robot.name, "version": __version__}


def pose_heading(schema: str, robot: Robot, rule: str) -> dict[str, Any]:
    """Return what a JSON of paths or poses begins with: in which units, too."""
    return {
        **heading(schema, robot),
        "rule": rule,
        "joints": [joint.name for joint in robot.joints],
        "units": {"joints": joint_units(robot), "length": robot.length_unit},
    }


def json_text(content: Mapping[str, object], indent: int | None = 1) -> str:
    """Return JSON, a line an entry; on one line where `indent` is None."""
    import json  # as the next, only where it is written: commands start sooner

    return json.dumps(content, indent=indent) + "\n"


def csv_text(header: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """Return comma-separated values with a header; numbers with all their digits.

    Spreadsheets compute a text that begins as a formula does, so an apostrophe goes before it.
    """
    import csv

    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(map(_cell, header))
    writer.writerows(map(_cell, row) for row in rows)
    return buffer.getvalue()


def _cell(value: object) -> object:
    if not isinstance(value, str):
        return value
    text = printable(value)
    return f"'{text}" if text.lstrip().startswith(FORMULA) else text


def pose_columns(robot: Robot) -> list[str]:
    """Return the heads of the columns of joint values and tool places, each with its unit."""
    joints = zip(robot.joints, joint_units(robot), strict=True)
    names = [f"{joint.name}_{unit}" for joint, unit in joints]
    return names + [f"{axis}_{robot.length_unit}" for axis in "xyz"]


def npz_bytes(arrays: Mapping[str, ArrayLike]) -> bytes:
    """Return arrays as a NumPy .npz file, the same bytes on every run."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **{k: np.asarray(v) for k, v in arrays.items()})
    return buffer.getvalue()
