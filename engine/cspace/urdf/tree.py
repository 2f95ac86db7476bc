"""The tree of a URDF, a chain in it, and the links that are fixed to each link of the chain.

A chain runs outward from one link to another. Links that fixed joints hold together are one rigid
group. The groups of the chain are 0 (the base), 1 (behind the first joint that moves), and so on.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count
from typing import NoReturn

import numpy as np

from cspace.arrays import Floats
from cspace.model.robotcheck import RobotFileError
from cspace.model.rows import unit_vector
from cspace.model.schema import one_line, shown
from cspace.tolerances import PARALLEL
from cspace.urdf.document import MOVING, OTHERS, Mimic, Pose, Urdf, UrdfJoint
from cspace.urdf.xml import called
from qbound.frames import axis_rotation

MOST_JOINTS = 9
"""Joints of an arm at most: a form has three coefficients to the power of their number."""

MOST_SHOWN = 8
"""Names that a message lists."""


@dataclass(frozen=True, eq=False)
class Bar:
    """The bar of a parallelogram: the link of its first joint, with all links fixed to it.

    Attributes
    ----------
    frame : str
        The link.
    crank : ndarray, shape (3,)
        From the first axis to the second, seen from the link.
    group : dict of str to Pose
    """

    frame: str
    crank: Floats
    group: dict[str, Pose]


@dataclass(frozen=True, eq=False)
class LinkChain:
    """Joints that move, outward, and the rigid groups between them.

    Attributes
    ----------
    joints : tuple of UrdfJoint
    frames : tuple of str
        The base, then the link that each joint moves.
    mounts : tuple of Pose
        Pose of each joint's axes, seen from the frame before it.
    groups : tuple of dict of str to Pose
        For each frame: the links that are fixed in it, with their poses.
    bars : tuple of Bar or None
        The bar of each joint that is a parallelogram; else None.
    tip : str
        The last link.
    """

    joints: tuple[UrdfJoint, ...]
    frames: tuple[str, ...]
    mounts: tuple[Pose, ...]
    groups: tuple[dict[str, Pose], ...]
    bars: tuple[Bar | None, ...]
    tip: str

    def rigid(self) -> Iterator[tuple[int, str, dict[str, Pose]]]:
        """Yield all groups outward, bars too: number, frame, links. Neighbours differ by 1."""
        numbers = count()
        yield next(numbers), self.frames[0], self.groups[0]
        for frame, group, bar in zip(self.frames[1:], self.groups[1:], self.bars, strict=True):
            if bar is not None:
                yield next(numbers), bar.frame, bar.group
            yield next(numbers), frame, group


def locked(urdf: Urdf, limits: Mapping[str, tuple[float, float]]) -> tuple[Urdf, dict[str, float]]:
    """Make joints fixed that their limits lock at one value, and joints that follow these.

    Parameters
    ----------
    limits : mapping of str to pair of float
        Limits in place of the file's, rad or m.

    Returns
    -------
    urdf : Urdf
    values : dict of str to float
        Where each of these joints is held.
    """
    moving = [joint for joint in urdf.joints.values() if joint.type in MOVING]
    values = dict[str, float]()
    for joint in moving:
        ends = limits.get(joint.name, joint.limits)
        if joint.mimic is None and ends is not None and ends[0] == ends[1]:
            values[joint.name] = ends[0]
    found = -1
    while found < len(values):
        found = len(values)
        for joint in moving:
            if joint.mimic is not None and joint.mimic.joint in values:
                value = values[joint.mimic.joint]
                values[joint.name] = joint.mimic.multiplier * value + joint.mimic.offset
    joints = {
        name: _held(joint, values[name]) if name in values else joint
        for name, joint in urdf.joints.items()
    }
    return replace(urdf, joints=joints), values


def _held(joint: UrdfJoint, value: float) -> UrdfJoint:
    """Return a fixed joint: the joint where it has this value."""
    axis = np.array(unit_vector(joint.axis.tolist()))
    pose = joint.pose
    if value and joint.type == "prismatic":
        pose = pose.then(Pose(np.eye(3), value * axis))
    elif value:
        pose = pose.then(Pose(np.asarray(axis_rotation(axis, value), dtype=float), np.zeros(3)))
    return replace(joint, type="fixed", pose=pose, mimic=None)


def find_chain(urdf: Urdf, first: str | None = None, last: str | None = None) -> LinkChain:
    """Find the chain between two links; default: from the root to the last link.

    The last link is the one behind the most moving joints. Of several frames on it the farthest is
    taken, by the fixed joints between; of equals the first of the file.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        If the file is not a tree, a link is unknown or not carried by the other, several links
        could be the last one and none is named, or the chain has no moving joint, too many, or one
        of a type that is not allowed.
    """
    parents = _parents(urdf)
    root = _root(urdf, parents)
    start = _known(urdf, root if first is None else first)
    tip = _last_link(urdf, parents, start) if last is None else _known(urdf, last)
    path = _path(urdf, parents, start, tip)
    moving = [joint for joint in path if joint.type != "fixed"]
    _check_count(urdf, moving, start, tip)
    _check_types(moving)
    joints: list[UrdfJoint] = []
    mounts: list[Pose] = []
    bars: list[Bar | None] = []
    frames, groups = [start], [_group(urdf, start)]
    for joint in moving:
        if joint.mimic is None:
            joints.append(joint)
            mounts.append(groups[-1][joint.parent].then(joint.pose))
            bars.append(None)
            frames.append(joint.child)
            groups.append(_group(urdf, joint.child))
            continue
        follows = bool(joints) and bars[-1] is None
        joints[-1:], bars[-1:], turned = _parallelogram(joints[-1:] * follows, joint, groups[-1])
        frames[-1], groups[-1] = joint.child, _group(urdf, joint.child, turned)
    return LinkChain(tuple(joints), tuple(frames), tuple(mounts), tuple(groups), tuple(bars), tip)


def _parallelogram(
    before: list[UrdfJoint], joint: UrdfJoint, group: dict[str, Pose]
) -> tuple[list[UrdfJoint], list[Bar | None], Pose]:
    """Join a joint with the next one, which turns back by the same angle, into a parallelogram.

    Returns
    -------
    list of one UrdfJoint
        The first joint, within the limits of both.
    list of one Bar
    Pose
        The carried link, seen from the axes of the first joint moved along with it: a fixed
        rotation.
    """
    mimic = joint.mimic
    turning = ("revolute", "continuous")
    if mimic is None or not before or mimic.joint != before[0].name:
        _refuse_mimic(joint)
    first = before[0]
    pose = group[joint.parent].then(joint.pose)
    axis, own = (np.array(unit_vector(each.axis.tolist())) for each in (first, joint))
    sense = float(axis @ (pose.rotation @ own))
    parallel = abs(abs(sense) - 1) <= PARALLEL and joint.type in turning and first.type in turning
    if not parallel or mimic.multiplier * round(sense) != -1:
        _refuse_mimic(joint)
    turned = Pose(pose.rotation @ axis_rotation(own, mimic.offset), np.zeros(3))
    return [_within_both(first, joint, mimic)], [Bar(first.child, pose.origin, group)], turned


def _within_both(first: UrdfJoint, joint: UrdfJoint, mimic: Mimic) -> UrdfJoint:
    """Return the first joint, with limits that also keep the following joint within its own."""
    if joint.limits is None:
        return first
    ends = [(end - mimic.offset) / mimic.multiplier for end in joint.limits]
    low, high = first.limits or (-math.inf, math.inf)
    return replace(first, limits=(max(low, min(ends)), min(high, max(ends))))


def _refuse_mimic(joint: UrdfJoint) -> NoReturn:
    name = shown(joint.mimic.joint if joint.mimic else "")
    if joint.type == "prismatic":
        text = "a slide that follows would move at a rate of its own, which no joint here does"
        joint.element.fault(f"follows joint {name} (mimic); {text}; make one of both fixed")
    wanted = "the joint just before it, on a parallel axis, turned back by the same angle"
    joint.element.fault(f"follows joint {name} (mimic); possible is a parallelogram only: {wanted}")


def _parents(urdf: Urdf) -> dict[str, UrdfJoint]:
    """Return the joint that carries each link but the root."""
    found: dict[str, UrdfJoint] = {}
    for joint in urdf.joints.values():
        for link in (joint.parent, joint.child):
            if link not in urdf.links:
                joint.element.fault(f"no link {shown(link)}; there are {listed(urdf.links)}")
        if (other := found.setdefault(joint.child, joint)) is not joint:
            text = f"link {shown(joint.child)} hangs on joint {shown(other.name)} already"
            joint.element.fault(f"{text}; a URDF is a tree, without closed loops")
    return found


def _root(urdf: Urdf, parents: dict[str, UrdfJoint]) -> str:
    roots = [link for link in urdf.links if link not in parents]
    if not roots:
        raise RobotFileError(f"{called(urdf.file)}: joints run in a circle; a URDF is a tree")
    if len(roots) > 1:
        text = f"{len(roots)} links hang on no joint: {listed(roots)}"
        raise RobotFileError(f"{called(urdf.file)}: {text}; a URDF is one tree with one root")
    for link in urdf.links:
        _path(urdf, parents, roots[0], link)
    return roots[0]


def _path(urdf: Urdf, parents: dict[str, UrdfJoint], start: str, tip: str) -> list[UrdfJoint]:
    """Return the joints from one link outward to another."""
    path: list[UrdfJoint] = []
    seen = {tip}
    while (link := path[-1].parent if path else tip) != start:
        if link not in parents:
            text = f"{shown(tip)} is not carried by {shown(start)}; a chain runs outward"
            raise RobotFileError(f"{called(urdf.file)}: {text}")
        path.append(parents[link])
        if path[-1].parent in seen:
            path[-1].element.fault("closes a circle; a URDF is a tree")
        seen.add(path[-1].parent)
    return path[::-1]


def _last_link(urdf: Urdf, parents: dict[str, UrdfJoint], start: str) -> str:
    """Return the farthest frame of the one rigid link behind the most moving joints."""
    carrying = {joint.parent for joint in urdf.joints.values()}
    leaves = [link for link in urdf.links if link not in carrying]
    paths = {
        leaf: _path(urdf, parents, start, leaf) for leaf in leaves if _carries(parents, start, leaf)
    }
    moving = {leaf: [j for j in path if j.type != "fixed"] for leaf, path in paths.items()}
    most = max(map(len, moving.values()))
    last = [leaf for leaf, joints in moving.items() if len(joints) == most]
    if len({joints[-1].name for leaf in last if (joints := moving[leaf])}) > 1:
        text = f"{len(last)} links could be the last one: {listed(last)}"
        raise RobotFileError(f"{called(urdf.file)}: {text}; name it, or one that carries it")
    return max(last, key=lambda leaf: len(paths[leaf]))


def _carries(parents: dict[str, UrdfJoint], start: str, link: str) -> bool:
    while link != start and link in parents:
        link = parents[link].parent
    return link == start


def _group(urdf: Urdf, frame: str, pose: Pose | None = None) -> dict[str, Pose]:
    """Return all links that fixed joints hold to a link, with their poses in it.

    `pose` is the pose of the link itself; the results are seen from the same frame.
    """
    fixed = [joint for joint in urdf.joints.values() if joint.type == "fixed"]
    group = {frame: Pose.still() if pose is None else pose}
    front = [frame]
    while front:
        link = front.pop()
        for joint in fixed:
            if joint.parent == link and joint.child not in group:
                group[joint.child] = group[link].then(joint.pose)
                front.append(joint.child)
            elif joint.child == link and joint.parent not in group:
                group[joint.parent] = group[link].then(joint.pose.inverse())
                front.append(joint.parent)
    return group


def _check_count(urdf: Urdf, moving: list[UrdfJoint], start: str, tip: str) -> None:
    between = f"between {shown(start)} and {shown(tip)}"
    if not moving:
        raise RobotFileError(f"{called(urdf.file)}: no joint moves {between}")
    if len(moving) > MOST_JOINTS:
        text = f"{len(moving)} joints move {between}; at most {MOST_JOINTS} are possible"
        raise RobotFileError(f"{called(urdf.file)}: {text}: choose another first or last link")


def _check_types(moving: list[UrdfJoint]) -> None:
    for joint in moving:
        if joint.type in OTHERS:
            text = f"a {joint.type} joint has more than one degree of freedom"
            joint.element.fault(f"{text}; a chain has revolute, continuous and prismatic ones")


def _known(urdf: Urdf, link: str) -> str:
    if link not in urdf.links:
        known = listed(urdf.links)
        raise RobotFileError(f"{called(urdf.file)}: no link {shown(link)}; there are {known}")
    return link


def listed(names: Iterable[str]) -> str:
    """Write names, the first few of many."""
    all_names = [one_line(name) for name in names]
    more = f", ... ({len(all_names)} in all)" if len(all_names) > MOST_SHOWN else ""
    return ", ".join(all_names[:MOST_SHOWN]) + more
