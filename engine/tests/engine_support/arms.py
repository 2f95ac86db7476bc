"""Small arms for the explorer, of every kind of joint, each with the joints that are held."""

import numpy as np

from cspace import Robot, load_robot
from cspace.model.robot import Polygon
from cspace.model.robotfile import parse_robot


def joint(kind, parent, frame, origin, axis, **more):
    return {
        "name": f"q{frame}",
        "type": kind,
        "parent": parent,
        "frame": frame,
        "origin": origin,
        "axis": axis,
    } | more


def in_xz(corners) -> Polygon:
    """Return a polygon of the plane of x and z."""
    return Polygon(np.insert(np.asarray(corners, dtype=float), 1, 0.0, axis=1))


def in_metres(name, joints, points, boundaries, home, tool, **more) -> Robot:
    """Return a robot whose lengths are in m and whose angles are in rad."""
    return Robot(
        name=name,
        joints=tuple(joints),
        points=tuple(points),
        boundaries=tuple(boundaries),
        home=np.asarray(home, dtype=float),
        tool=tool,
        length_unit="m",
        angle_unit="rad",
        **more,
    )


def robot_table(joints, home, tool_frame, **more):
    """Return a small planar arm: a tool, a point on the base, a floor, a pair."""
    return {
        "schema": 1,
        "name": "arm",
        "length_unit": "m",
        "angle_unit": "rad",
        "home": home,
        "tool": "t",
        "joint": joints,
        "point": [
            {"name": "t", "frame": tool_frame, "at": [0.7, 0.0, 0.2], "radius": 0.05},
            {"name": "b", "frame": "0", "at": [-0.3, 0.0, 0.4], "radius": 0.1},
        ],
        "boundary": [
            {"name": "P", "type": "pair", "points": ["t", "b"], "clearance": 0.15},
            {
                "name": "F",
                "type": "half-space",
                "point": "t",
                "normal": [0.1, 0.0, 1.0],
                "offset": -0.8,
            },
        ],
    } | more


SIDE = [0.0, 1.0, 0.0]
ALONG = [1.0, 0.0, 0.3]
SLIDE = {"limits": [-0.6, 0.9]}
ORIGINS = [0.2, 0.0, 0.3], [0.9, 0.0, -0.2]


def two_joints(first, second, turn=SIDE):
    kinds = {"R": ("revolute", turn, {}), "P": ("prismatic", ALONG, SLIDE)}
    rows = []
    for i, letter in enumerate(first + second):
        kind, axis, more = kinds[letter]
        axis = [-0.2, 0.0, 1.0] if (i, letter) == (1, "P") else axis
        rows.append(joint(kind, str(i), str(i + 1), ORIGINS[i], axis, **more))
    return parse_robot(robot_table(rows, {"q1": 0.3, "q2": 0.4}, "2"))


def three_joints():
    rows = [joint("revolute", str(i), str(i + 1), [0.5, 0.0, 0.1], SIDE) for i in range(3)]
    return parse_robot(robot_table(rows, {"q1": 0.3, "q2": 0.4, "q3": -0.2}, "3"))


def palletizer(turn=SIDE, last=SIDE):
    """A turn, a parallelogram with a point on its bar, and a wrist."""
    bar = {"crank": [0.6, 0.0, 0.3], "bar": "bar", "limits": [-2.0, 2.5]}
    rows = [
        joint("revolute", "0", "1", ORIGINS[0], turn),
        joint("parallelogram", "1", "2", ORIGINS[1], SIDE, **bar),
        joint("revolute", "2", "3", [0.3, 0.0, 0.1], last),
    ]
    table = robot_table(rows, {"q1": 0.3, "q2": 0.4, "q3": -0.2}, "3")
    table["point"].append({"name": "p", "frame": "bar", "at": [0.4, 0.0, 0.1], "radius": 0.1})
    table["boundary"].append({"name": "Q", "type": "pair", "points": ["t", "p"]})
    table["boundary"].append({"name": "S", "type": "pair", "points": ["p", "b"]})
    return parse_robot(table)


def out_of_plane():
    rows = [
        joint("revolute", "0", "1", ORIGINS[0], [0.3, -0.2, 1.0], rpy=[0.2, -0.4, 0.5]),
        joint("revolute", "1", "2", ORIGINS[1], [0.5, 1.0, -0.7]),
    ]
    return parse_robot(robot_table(rows, {"q1": 0.3, "q2": 0.4}, "2"))


ROBOTS = {
    "paper": lambda: (load_robot("minervabot-v2"), {}),
    "RR": lambda: (two_joints("R", "R"), {}),
    "RR, axes opposed": lambda: (two_joints("R", "R", [0.0, -1.0, 0.0]), {}),
    "RP": lambda: (two_joints("R", "P"), {}),
    "PR": lambda: (two_joints("P", "R"), {}),
    "PP": lambda: (two_joints("P", "P"), {}),
    "3R, first held": lambda: (three_joints(), {0: 0.4}),
    "3R, second held": lambda: (three_joints(), {1: -0.9}),
    "3R, third held": lambda: (three_joints(), {2: 0.7}),
    "parallelogram": lambda: (palletizer(), {2: -0.2}),
}
SPATIAL = {
    "out of the plane": lambda: (out_of_plane(), {}),
    "parallelogram in space": lambda: (palletizer([0.2, 0.3, 1.0], [1.0, 0.0, 0.2]), {0: 0.3}),
}
