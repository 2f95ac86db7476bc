"""Texts and bytes of files: JSON, CSV, NumPy arrays; the same bytes on every run."""

import io
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cspace.model.robot import Robot
from cspace.printable import printable
from cspace.units import joint_units

FORMULA = tuple("=+-@＝＋－＠")
"""What a formula of a spreadsheet begins with; tab and return, others, are escaped as it is."""


def heading(
    schema: str, robot: Robot, looked_at: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Return the first entries of every JSON: its schema, robot, version, and what it looks at.

    The last is `left_out_content` unless it is given.
    """
    from cspace.version import __version__  # slow, and few commands need it

    if looked_at is None:
        looked_at = left_out_content(robot)
    return {"schema": schema, "robot": robot.name, "version": __version__, **looked_at}


def left_out_content(robot: Robot) -> dict[str, Any]:
    """Return what feasible looks at, and what no answer about a robot looks at, for its JSON."""
    pairs, links = [list(pair) for pair in robot.unchecked], list(robot.left_out)
    left_out = {"left_out": {"pairs": pairs, "links": links}} if pairs or links else {}
    return {"feasible_by": robot.feasible_by, **left_out}


def pose_heading(schema: str, robot: Robot) -> dict[str, Any]:
    """Return the first entries of a JSON of paths or poses, with the units."""
    return {
        **heading(schema, robot),
        "joints": [joint.name for joint in robot.joints],
        "units": {"joints": joint_units(robot), "length": robot.length_unit},
    }


def json_text(content: Mapping[str, object], indent: int | None = 1) -> str:
    """Return JSON text, one line for each entry; a single line if `indent` is None."""
    import json  # imported late, so that commands start sooner

    return json.dumps(content, indent=indent) + "\n"


def csv_text(header: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """Return comma-separated values with a header; numbers have all their digits.

    An apostrophe is put before a text that begins like a formula, because spreadsheets would
    compute it.
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
