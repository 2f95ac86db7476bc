"""What was found of an arm, as others read it: JSON and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from qbound.arms.fibres import Fibres, Interval
from qbound.arms.links import link_pair
from qbound.arms.reach import Reach
from qbound.boundary.balls import Balls
from qbound.export.formats import heading, npz_bytes
from qbound.model.robot import Robot
from qbound.units import amount, counted, joint_text

MOST_SHOWN = 10
"""Pairs of links that a sentence names."""


def fibre_document(found: Fibres, q: Sequence[float]) -> dict[str, Any]:
    """Return the JSON form of one fibre, schema qbound/fibre/1; rad or length."""
    robot, joint = found.robot, found.robot.joints[found.joint]
    return {
        **heading("qbound/fibre/1", robot),
        "joint": joint.name,
        "unit": joint.unit(robot.length_unit),
        "q": list(q),
        "contains_q": bool(found.contains([q[found.joint]])[0]),
        "length": float(found.length[0]),
        "intervals": [interval._asdict() for interval in found[0]],
        "blocked_by": [] if found[0] else blocking(robot, found.joint, q),
    }


def fibre_lines(found: Fibres, q: Sequence[float]) -> Iterator[str]:
    """Say between which values the joint may move, and what is there."""
    robot, joint = found.robot, found.robot.joints[found.joint]
    others = [j for j in range(len(q)) if j != found.joint]
    held = joint_text(robot, np.array(q)[others], others)
    yield f"{joint.name}{' with ' if held else ''}{held}"
    for interval in found[0]:
        yield f"  {_interval_text(found, interval)}"
    if not found[0]:
        names = by_links(robot, blocking(robot, found.joint, q))
        yield "  nowhere" + (f"; whatever its value, violated: {', '.join(names)}" if names else "")


def by_links(robot: Robot, names: Sequence[str]) -> list[str]:
    """Sum up boundaries by pair of links, a few of them, and count the others."""
    pairs = {boundary.name: link_pair(robot, boundary) for boundary in robot.used}
    found = list(dict.fromkeys(pairs.get(name, name) for name in names))
    more = len(found) - MOST_SHOWN
    return found if more <= 0 else [*found[:MOST_SHOWN], f"{more} more"]


def blocking(robot: Robot, joint: int, q: Sequence[float]) -> list[str]:
    """Return the boundaries that are violated at every value of a joint, and others' limits."""
    balls, moving = Balls.of(robot), robot.joints[joint]
    c, a, b = balls.along(joint, q).T
    if moving.turns:
        most = c + np.hypot(a, b)
    else:  # a convex form is greatest at an end
        ends = np.array(moving.limits)[:, None]
        most = (c + a * ends + b * ends**2).max(axis=0)
    names = [name for name, x in zip(balls.names, most < -balls.rounding, strict=True) if x]
    for j, each in enumerate(robot.joints):
        if j != joint and each.limits is not None:
            low, high = each.limits
            names += [f"{each.name}.lower"] * (q[j] < low) + [f"{each.name}.upper"] * (q[j] > high)
    return names


def _interval_text(found: Fibres, interval: Interval) -> str:
    joint = found.robot.joints[found.joint]
    unit, scale = joint.unit(found.robot.length_unit, "deg"), joint.shown_scale
    low, high = (amount(x * scale, unit) for x in interval[:2])
    if interval.below is None:
        return "all the way round"
    return f"{low} ({interval.below}) to {high} ({interval.above})"


def reach_document(found: Reach) -> dict[str, Any]:
    """Return the JSON form of a map, schema qbound/reach/1; its voxels are in `reach_npz`."""
    robot = found.robot
    box = found.box
    return {
        **heading("qbound/reach/1", robot),
        "length_unit": robot.length_unit,
        "seed": found.seed,
        "voxel": found.grid.edge,
        "exact_joint": robot.joints[found.joint].name,
        "fibres": found.fibres,
        "voxels": int(found.reached.sum()),
        "box": None if box is None else box.tolist(),
        "volume": {
            "value": found.volume,
            "error": found.error,
            "standard_error": found.standard_error,
            "scrambles": found.volumes[:, 0].tolist(),
            "before_last_round": float(found.volumes[:, 1].mean()),
            "voxels_twice_as_long": float(found.volumes[:, 2].mean()),
            "all_voxels": found.marked_volume,
        },
        "index": None if found.index is None else _index(found),
    }


def reach_lines(found: Reach) -> Iterator[str]:
    """Say how large the map is, and what is exact about it."""
    robot, unit = found.robot, found.robot.length_unit
    if (box := found.box) is None:
        yield "no feasible configuration was found"
        return
    low, high = (", ".join(f"{x:.4g}" for x in corner) for corner in box)
    times = found.chance / found.standard_error if found.standard_error else 0.0
    chance = f"chance alone: {found.chance:.2g}, {times:.3g} standard errors"
    if (box[1] - box[0]).min() < 1.5 * found.grid.edge:  # one layer of voxels
        yield "the tool stays in a plane: it has an area there, which qbound workspace measures"
    else:
        yield f"volume {found.volume:.4g} +- {found.error:.2g} {unit}^3 ({chance})"
        yield "  an estimate, no bound: chance, places that are not found yet, and the voxels' edge"
    yield f"{counted(int(found.reached.sum()), 'voxel')} of {found.grid.edge:g} {unit}"
    yield f"  from ({low}) to ({high}) {unit}"
    if found.index is not None:
        index = _index(found)
        yield f"  reachability index: mean {index['mean']:.3g}, greatest {index['greatest']:.3g}"
    name = robot.joints[found.joint].name
    yield f"{found.fibres} fibres: exact along {name}, the other joints drawn (seed {found.seed})"


def reach_npz(found: Reach) -> bytes:
    """Return the arrays reached and index, with the grid's origin and edge."""
    index = {} if found.index is None else {"index": found.index}
    unit = np.array(found.robot.length_unit)
    grid = {"origin": found.grid.origin, "edge": np.array(found.grid.edge), "unit": unit}
    return npz_bytes({"reached": found.reached, **index, **grid})


def _index(found: Reach) -> dict[str, float]:
    values = np.zeros(1) if found.index is None else found.index[found.reached]
    return {"mean": float(values.mean()), "greatest": float(values.max())}
