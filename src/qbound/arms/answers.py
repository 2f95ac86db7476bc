"""What `why` found, as others read it: sentences, and JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from qbound.arms.links import link_pair
from qbound.arms.separations import Block, JointTravel, Separation
from qbound.arms.why import Why
from qbound.arrays import Floats
from qbound.boundary.evaluator import limit_names
from qbound.export.formats import heading
from qbound.model.robot import Joint, Robot
from qbound.units import amount, joint_text, joint_units, limited_joints, margin_text

DIGITS = {"deg": 2}
"""Decimals of what is shown; of lengths six."""

MOST_SHOWN = 3
"""Pairs of links that a sentence names."""


def why_lines(found: Why) -> Iterator[str]:
    """Say in sentences whether a robot gets from start to goal, and why or why not."""
    if found.answer == "infeasible":
        yield from _infeasible(found)
    elif found.separation is not None:
        yield from _separated(found.robot, found.ends.tolist(), found.separation)
    elif found.answer == "separated":
        yield f"separated{_held(found)}: {found.tried[-1]}"
    elif found.path is not None:
        yield from _connected(found)
    elif found.answer == "connected":
        yield f"connected{_held(found)}: {found.tried[-1]}; no path was found"
    else:
        yield "not decided whether a path joins start and goal; what was tried:"
        yield from (f"- {said}" for said in found.tried)


def why_document(found: Why) -> dict[str, Any]:
    """Return the JSON form, schema qbound/why/1: rad, and lengths in the file's unit."""
    robot = found.robot
    parted, path = found.separation, found.path
    return {
        **heading("qbound/why/1", robot),
        "joints": [joint.name for joint in robot.joints],
        "units": {"joints": joint_units(robot), "length": robot.length_unit},
        "start": found.ends[0].tolist(),
        "goal": found.ends[1].tolist(),
        "answer": found.answer,
        "held": [robot.joints[j].name for j in _held_joints(found)],
        "violated": [
            {"end": ("start", "goal")[k], "boundary": name, "margin": margin}
            for k, name, margin in found.violated
        ],
        "separation": None if parted is None else _separation_document(parted),
        "travel": [_travel_document(travel) for travel in found.travels],
        "path": None if path is None else _path_document(found),
        "tried": list(found.tried),
        "certificate": found.certificate is not None,
    }


# --- sentences ------------------------------------------------------------------------------------


def _infeasible(found: Why) -> Iterator[str]:
    robot, limited = found.robot, limited_joints(found.robot)
    named = {b.name: link_pair(robot, b) for b in robot.used}
    for k, end in enumerate(("start", "goal")):
        worst: dict[str, tuple[str, float]] = {}
        for _, name, margin in (row for row in found.violated if row[0] == k):
            worst.setdefault(named.get(name, name), (name, margin))
        said = [
            f"{links}, by {margin_text(robot, name, -margin, limited)}"
            + (f" (boundary {name})" if links != name else "")
            for links, (name, margin) in list(worst.items())[:MOST_SHOWN]
        ]
        more = f"; and {len(worst) - MOST_SHOWN} more" if len(worst) > MOST_SHOWN else ""
        if said:
            yield f"infeasible: the {end} violates {'; '.join(said)}{more}"


def _separated(robot: Robot, ends: Sequence[Sequence[float]], parted: Separation) -> Iterator[str]:
    travel = parted.travel
    joint = robot.joints[travel.joint]
    one, other = (_shown(joint, robot, q[travel.joint]) for q in ends)
    blocks = [_block_text(robot, joint, block) for block in parted.blocks]
    cannot = f"cannot pass {blocks[0]}"
    if len(blocks) > 1:
        cannot = f"can pass neither {blocks[0]}, nor {blocks[1]}"
    yield (
        f"separated: {joint.name} cannot get from {one} to {other}; whatever the other joints are,"
        f" it {cannot}"
    )
    ranges = ", ".join(
        f"{_span(joint, robot, *span)}{_marks(parted.parts, k)}"
        for k, span in enumerate(travel.free)
    )
    yield f"the travel of {joint.name} falls into {len(travel.free)} ranges: {ranges}"
    yield from _same_posture(robot, joint, ends[1][travel.joint], parted)


def _marks(parts: tuple[int, int], k: int) -> str:
    return " (start)" * (parts[0] == k) + " (goal)" * (parts[1] == k)


def _same_posture(robot: Robot, joint: Joint, goal: float, parted: Separation) -> Iterator[str]:
    """Say where a goal a full turn away lies in the range of the start, within the limits."""
    if not joint.turns or joint.limits is None:
        return
    for k in (-1, 1):
        value = goal + k * math.tau
        if parted.travel.part(value) == parted.parts[0]:
            place = _shown(joint, robot, value)
            yield f"the goal's posture is in the start's range too, at {place}"


def _connected(found: Why) -> Iterator[str]:
    robot, path = found.robot, found.path
    assert path is not None
    legs = len(path) - 1
    kind = "a straight line" if legs == 1 else f"a path of {legs} legs"
    margin = amount(float(found.margin), robot.length_unit)
    least = amount(found.least, robot.length_unit, digits=3)
    clear = f"every boundary keeps {margin} on it, proved (least margin seen: {least})"
    if not robot.used:
        clear = "there is no boundary"
    yield f"connected{_held(found)}: {kind}, {_length(robot, path)} long; {clear}"
    if legs > 1:
        yield from (f"  {joint_text(robot, q)}" for q in path)


def _length(robot: Robot, path: Floats) -> str:
    """Write how long a path is: in angles, and in lengths."""
    units, steps = np.array(joint_units(robot)), np.diff(path, axis=0)
    parts = {u: np.linalg.norm(steps[:, units == u], axis=1).sum() for u in dict.fromkeys(units)}
    return " and ".join(f"{length:.3g} {unit}" for unit, length in parts.items())


def _held_joints(found: Why) -> list[int]:
    if not found.hold:
        return []
    return [j for j in range(len(found.robot.joints)) if j not in found.differing]


def _held(found: Why) -> str:
    names = [found.robot.joints[j].name for j in _held_joints(found)]
    return f", while {', '.join(names)} {'is' if len(names) == 1 else 'are'} held" if names else ""


def _block_text(robot: Robot, joint: Joint, block: Block) -> str:
    span = _span(joint, robot, block.low, block.high, inwards=True)
    return f"{span}, where {_meet(block)}"


def _meet(block: Block) -> str:
    """Say what meets: two links, or what one boundary is about."""
    others = " or others" if len(block.links) > 1 else ""
    if block.links[0] in {each.boundary for each in block.ranges}:
        return f"{block.links[0]}{others} is violated"
    return f"{block.links[0].replace(', ', ' and ')}{others} meet"


def _span(joint: Joint, robot: Robot, low: float, high: float, *, inwards: bool = False) -> str:
    """Write a range; one that is blocked is rounded inwards, one that is free outwards."""
    unit = joint.unit(robot.length_unit, "deg")
    size = 10.0 ** DIGITS.get(unit, 6)
    scale = joint.shown_scale * size
    down, up = (math.ceil, math.floor) if inwards else (math.floor, math.ceil)
    ends = [down(low * scale) / size, up(high * scale) / size]
    if not inwards and joint.limits is not None:
        ends = [
            x * joint.shown_scale if x in joint.limits else end
            for x, end in zip((low, high), ends, strict=True)
        ]
    return f"{ends[0]:.10g} to {ends[1]:.10g} {unit}"


def _shown(joint: Joint, robot: Robot, value: float) -> str:
    unit = joint.unit(robot.length_unit, "deg")
    return amount(value * joint.shown_scale, unit)


# --- JSON -----------------------------------------------------------------------------------------


def _path_document(found: Why) -> dict[str, Any]:
    path = found.path
    assert path is not None
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    least = None if not math.isfinite(found.least) else found.least
    corners = path.tolist()
    return {
        "corners": corners,
        "length": length,
        "proved_margin": float(found.margin),
        "least_margin_seen": least,
    }


def _separation_document(parted: Separation) -> dict[str, Any]:
    return {
        "joint": parted.travel.name,
        "start_range": parted.parts[0],
        "goal_range": parted.parts[1],
        "blocked": [_block_document(block) for block in parted.blocks],
    }


def _travel_document(travel: JointTravel) -> dict[str, Any]:
    return {
        "joint": travel.name,
        "limits": None if travel.limits is None else list(travel.limits),
        "limit_names": None if travel.limits is None else list(limit_names(travel.name)),
        "blocked": [_block_document(block) for block in travel.blocks],
        "free": [list(span) for span in travel.free],
    }


def _block_document(block: Block) -> dict[str, Any]:
    return {
        "from": block.low,
        "to": block.high,
        "links": list(block.links),
        "boundaries": list(dict.fromkeys(each.boundary for each in block.ranges)),
    }
