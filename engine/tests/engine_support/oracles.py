"""Independent ways to the same numbers. Nothing here imports the library.

The paper's formulas are expanded by hand, kinematics goes through 4 x 4 matrices, roots are found
by sampling and bisection. What a library function is compared with shares no line with it.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from math import pi
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from cspace.model.robotfile import robot_text

Floats = NDArray[np.float64]
Table = dict[str, Any]

# --- the paper by hand ---------------------------------------------------------------------------

OFFSETS = {
    "z01": 22.5, "x12": 15.0, "z12": 25.98, "x23": 25.0,
    "x06": 7.5, "z06": 12.5, "x17": 11.5, "z17": 4.91,
    "x08": -7.5, "z08": 12.5, "x19": -1.5, "z19": 12.41,
    "x110": 17.82, "z110": 15.87, "x211": 9.09, "z211": -5.25,
    "x112": 4.83, "z112": 23.37, "x213": 9.0, "z213": 5.25,
    "xmin1": 15.0, "xmin2": -15.0, "zmin1": 11.32,
}  # fmt: skip
"""Tables 1 and 3-5, every length in cm."""


def equation_29(q1: Any, q2: Any) -> dict[str, Floats]:
    """The eleven components of eq. (29), expanded by hand."""
    o, sin, cos = OFFSETS, np.sin, np.cos
    x = o["x12"] * cos(q1) + o["z12"] * sin(q1) + o["x23"] * cos(q1 + q2)
    z = o["z01"] - o["x12"] * sin(q1) + o["z12"] * cos(q1) - o["x23"] * sin(q1 + q2)
    lift = o["z01"] - o["z06"]
    return {
        "beta_{1,1}": o["x17"] * cos(q1) + o["z17"] * sin(q1) - o["x06"],
        "beta_{1,3}": o["z17"] * cos(q1) - o["x17"] * sin(q1) + lift,
        "beta_{2,1}": o["x19"] * cos(q1) + o["z19"] * sin(q1) - o["x08"],
        "beta_{2,3}": o["z19"] * cos(q1) - o["x19"] * sin(q1) + o["z01"] - o["z08"],
        "beta_{3,1}": o["x211"] * cos(q2) + o["z211"] * sin(q2) + o["x12"] - o["x110"],
        "beta_{3,3}": o["z211"] * cos(q2) - o["x211"] * sin(q2) + o["z12"] - o["z110"],
        "beta_{4,1}": o["x213"] * cos(q2) + o["z213"] * sin(q2) + o["x12"] - o["x112"],
        "beta_{4,3}": o["z213"] * cos(q2) - o["x213"] * sin(q2) + o["z12"] - o["z112"],
        "beta_{5,1}": x - o["xmin1"],
        "beta_{6,1}": x - o["xmin2"],
        "beta_{7,3}": z - o["zmin1"],
    }


def arctan_of_quotient(n: Any, d: Any) -> Any:
    """The printed tan^-1(n / d), read to the letter."""
    return np.arctan(n / d)


def table_6(arctan: Callable[[Any, Any], Any], q1: Any = 0.0) -> dict[str, Any]:
    """The 22 bounds of Table 6, expanded by hand; rad. Rows 5-7 are functions of q1."""
    o, acos, asin = OFFSETS, _quiet(np.arccos), _quiet(np.arcsin)
    d1, d2 = np.hypot(o["x17"], o["z17"]), np.hypot(o["x19"], o["z19"])
    d3, d4 = np.hypot(o["x211"], o["z211"]), np.hypot(o["x213"], o["z213"])
    row = {
        "1,1": arctan(o["z17"], o["x17"]) + acos(o["x06"] / d1) - pi,
        "1,3": arctan(-o["x17"], o["z17"]) - acos((o["z01"] - o["z06"]) / d1),
        "2,1": arctan(o["z19"], o["x19"]) + acos(o["x08"] / d2) - pi,
        "2,3": arctan(-o["x19"], o["z19"]) - acos((o["z01"] - o["z08"]) / d2),
        "3,1": arctan(o["z211"], o["x211"]) - acos((o["x12"] - o["x110"]) / d3),
        "3,3": arctan(-o["x211"], o["z211"]) - acos((o["z12"] - o["z110"]) / d3),
        "4,1": arctan(o["z213"], o["x213"]) - acos((o["x12"] - o["x112"]) / d4),
        "4,3": arctan(-o["x213"], o["z213"]) - acos((o["z12"] - o["z112"]) / d4),
    }
    elbow_x = o["x12"] * np.cos(q1) + o["z12"] * np.sin(q1)
    elbow_z = o["z12"] * np.cos(q1) - o["x12"] * np.sin(q1)
    u5, u6 = (elbow_x - o["xmin1"]) / o["x23"], (elbow_x - o["xmin2"]) / o["x23"]
    v7 = (o["z01"] - o["zmin1"] + elbow_z) / o["x23"]
    bounds = {f"beta_{{{ij},{k}}}": v + (pi, -pi)[k - 1] for ij, v in row.items() for k in (1, 2)}
    return bounds | {
        "beta_{5,1,1}": pi - q1 - acos(u5),
        "beta_{5,1,2}": -q1 - pi - acos(u5),
        "beta_{6,1,1}": pi - q1 - acos(u6),
        "beta_{6,1,2}": -q1 - pi - acos(u6),
        "beta_{7,3,1}": asin(v7) - q1,
        "beta_{7,3,2}": -q1 - pi - asin(v7),
    }


def _quiet(f: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """The same function with NaN, and no warning, where it has no value."""

    def quiet(x: Any) -> Any:
        with np.errstate(invalid="ignore"):
            return f(x)

    return quiet


# --- robots as plain tables ----------------------------------------------------------------------


def packaged_table(name: str = "minervabot-v2") -> Table:
    """A packaged robot file, read anew: a table that a test may change."""
    return tomllib.loads(robot_text(name)[0])


def row_of(table: Table, kind: str, name: str) -> Table:
    """The joint, point or boundary of that name."""
    (row,) = (r for r in table[kind] if r["name"] == name)
    return row


def in_unit(table: Table, unit: str, scale: float) -> Table:
    """Write the lengths of a robot table in another unit, `scale` of which are one of the old."""
    table["length_unit"] = unit
    for row in table["joint"]:
        row["origin"] = [scale * x for x in row["origin"]]
    for row in table["point"]:
        row["at"] = [scale * x for x in row["at"]]
    for row in table["boundary"]:
        row |= {k: scale * row[k] for k in ("clearance", "offset") if k in row}
    return table


def homogeneous(rotation: Any, origin: Any) -> Floats:
    """The 4 x 4 matrix of a frame."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, origin
    return matrix


def joint_matrix(joint: Table, q: float) -> Floats:
    """Mount, then motion, of one joint of a robot table in radians."""
    mount = homogeneous(
        Rotation.from_euler("xyz", joint.get("rpy", (0.0, 0.0, 0.0))).as_matrix(), joint["origin"]
    )
    axis = np.array(joint["axis"]) / np.linalg.norm(joint["axis"])
    if joint["type"] == "revolute":
        return mount @ homogeneous(Rotation.from_rotvec(axis * q).as_matrix(), np.zeros(3))
    return mount @ homogeneous(np.eye(3), axis * q)


def frame_matrix(table: Table, frame: str, q: Sequence[float]) -> Floats:
    """The 4 x 4 matrix of a frame, seen from the base."""
    matrix = np.eye(4)
    if frame == table["joint"][0]["parent"]:
        return matrix
    for joint, value in zip(table["joint"], q, strict=True):
        matrix = matrix @ joint_matrix(joint, value)
        if joint["frame"] == frame:
            return matrix
    raise KeyError(frame)


def point_seen_from(table: Table, point: str, observer: str, q: Sequence[float]) -> Floats:
    """Coordinates of a point in an observer's frame, through the base and back."""
    row = row_of(table, "point", point)
    seen_from_base = frame_matrix(table, row["frame"], q) @ np.array([*row["at"], 1.0])
    return (np.linalg.inv(frame_matrix(table, observer, q)) @ seen_from_base)[:3]


COUNTS = st.integers(1, 4)
LENGTHS = st.integers(-2000, 2000).map(lambda k: k / 100)
ANGLES = st.integers(-600, 600).map(lambda k: k / 100)
VECTORS = st.lists(LENGTHS, min_size=3, max_size=3)
AXES = st.lists(st.integers(-3, 3), min_size=3, max_size=3).filter(any)
MOUNTS = st.none() | st.lists(ANGLES, min_size=3, max_size=3)
UNIT_AXES = st.sampled_from([[0, 1, 0], [0, 0, -1], [1, 0, 0], [0, -1, 0], [0, 0, 1]])
QUARTER_TURNS = st.lists(st.integers(-4, 4).map(lambda k: k * pi / 2), min_size=3, max_size=3)


@st.composite
def robot_tables(
    draw: st.DrawFn,
    joints: st.SearchStrategy[int] = COUNTS,
    axes: st.SearchStrategy[list[int]] = AXES,
    mounts: st.SearchStrategy[list[float] | None] = MOUNTS,
) -> Table:
    """Any chain of 1 to 4 joints, revolute and prismatic, mounted askew, a point in every frame."""
    n = draw(joints)
    chain = [_any_joint(draw, i, axes, mounts) for i in range(n)]
    points = [{"name": f"p{i}", "frame": str(i), "at": draw(VECTORS)} for i in range(n + 1)]
    return {
        "schema": 1,
        "name": "any chain",
        "length_unit": "cm",
        "angle_unit": "rad",
        "home": {joint["name"]: draw(ANGLES) for joint in chain},
        "tool": f"p{n}",
        "joint": chain,
        "point": points,
        "boundary": [],
    }


def _any_joint(draw: st.DrawFn, i: int, axes: Any, mounts: Any) -> Table:
    joint = {
        "name": f"q{i + 1}",
        "type": draw(st.sampled_from(["revolute", "revolute", "prismatic"])),
        "parent": str(i),
        "frame": str(i + 1),
        "origin": draw(VECTORS),
        "axis": draw(axes),
    }
    if (rpy := draw(mounts)) is not None:
        joint["rpy"] = rpy
    if joint["type"] == "prismatic":
        joint["limits"] = [-10, 10]
    return joint


# --- forms, roots, lengths, crossings ------------------------------------------------------------


def circle_zeros(f: Callable[[Floats], Floats], n: int = 4000) -> list[float]:
    """Simple zeros of a periodic function over one turn: dense sampling, then bisection."""
    q = np.linspace(-pi, pi, n + 1) + 1e-4  # off the special angles
    values = f(q)
    return [
        _bisect(f, q[i], q[i + 1])
        for i in np.nonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)[0]
    ]


def _bisect(f: Callable[[Any], Any], low: float, high: float) -> float:
    falling = f(low) > 0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if (f(middle) > 0) == falling else (low, middle)
    return (low + high) / 2


def angle_gap(a: Any, b: Any) -> Any:
    """Distance of two angles on the circle."""
    return np.abs((np.asarray(a) - b + pi) % (2 * pi) - pi)
