"""Random configurations as files: CSV, NumPy arrays, JSON (schema qbound/sample/1)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from qbound.export.formats import csv_text, npz_bytes, pose_columns, pose_heading
from qbound.model.robot import Robot
from qbound.sampling import Sample, joint_ranges
from qbound.units import joint_units

TEXT: Final = 90
"""Bytes a number takes while it is written as text; measured."""


def sample_bytes(joints: int, count: int, tables: int = 0) -> int:
    """Estimate the memory of a sample: joint values, tool and verdict of each configuration.

    Parameters
    ----------
    tables : int
        Number of texts, CSV or JSON, that are written.

    Examples
    --------
    >>> sample_bytes(2, 10**6) // 10**6, sample_bytes(2, 10**6, tables=1) // 10**6  # megabytes
    (48, 588)
    """
    return count * (joints + 4) * (8 + TEXT * tables)


def sample_csv(robot: Robot, drawn: Sample) -> str:
    """Return one row a configuration: joint values, tool place, and 1 where it is free."""
    rows = zip(drawn.q.tolist(), drawn.tool.tolist(), drawn.free.tolist(), strict=True)
    header = [*pose_columns(robot), "free"]
    return csv_text(header, ([*q, *tool, int(free)] for q, tool, free in rows))


def sample_npz(robot: Robot, drawn: Sample) -> bytes:
    """Return the arrays q, tool and free, with the names of the joints and the units."""
    names = np.array([joint.name for joint in robot.joints])
    units = np.array([*joint_units(robot), robot.length_unit])
    arrays = {"q": drawn.q, "tool": drawn.tool, "free": drawn.free}
    return npz_bytes({**arrays, "joints": names, "units": units})


def sample_document(robot: Robot, drawn: Sample, rule: str, seed: int) -> dict[str, Any]:
    """Return the JSON form of a sample drawn within the joints' ranges with a seed."""
    return {
        **pose_heading("qbound/sample/1", robot, rule),
        "ranges": joint_ranges(robot).tolist(),
        "n": len(drawn.free),
        "seed": seed,
        "free": int(drawn.free.sum()),
        "fraction_free": drawn.fraction_free,
        "standard_error": drawn.standard_error,
        "configurations": {
            "q": drawn.q.tolist(),
            "tool": drawn.tool.tolist(),
            "free": drawn.free.tolist(),
        },
    }
