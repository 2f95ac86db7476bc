"""Which links does an arm carry? The tree of a URDF, a chain in it, and what is fixed to each link.

A chain runs outward from one link to another. What fixed joints hold together is one rigid group;
the groups of the chain are 0 (the base), 1 (behind the first joint that moves), and so on.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from qbound.model.robotcheck import RobotFileError
from qbound.model.schema import one_line, shown
from qbound.urdf.document import OTHERS, Urdf, UrdfJoint
from qbound.urdf.poses import Pose

MOST_JOINTS = 9
"""Joints of an arm at most: a form has three coefficients to the power of their number."""

MOST_SHOWN = 8
"""Names that a message lists."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Joints that move, outward, and the rigid groups between them.

    Attributes
    ----------
    joints : tuple of UrdfJoint
    frames : tuple of str
        The base, then the link that each joint moves.
    mounts : tuple of Pose
        Of each joint's axes, seen from the frame before it.
    groups : tuple of dict of str to Pose
        Of each frame: the links that are fixed in it, and where they stand in it.
    tip : str
        The last link.
    """

    joints: tuple[UrdfJoint, ...]
    frames: tuple[str, ...]
    mounts: tuple[Pose, ...]
    groups: tuple[dict[str, Pose], ...]
    tip: str


def find_chain(urdf: Urdf, first: str | None = None, last: str | None = None) -> Chain:
    """Find the chain between two links; default: from the root to the only leaf.

    Raises
    ------
    qbound.model.robotcheck.RobotFileError
        If the file is no tree, a link is unknown or not carried by the other, several leaves could
        be meant, or the chain has no joint that moves, too many, or one of an unfit type.
    """
    parents = _parents(urdf)
    root = _root(urdf, parents)
    start = _known(urdf, root if first is None else first)
    tip = _only_leaf(urdf, parents, start) if last is None else _known(urdf, last)
    path = _path(urdf, parents, start, tip)
    moving = [joint for joint in path if joint.type != "fixed"]
    _check_count(urdf, moving, start, tip)
    _check_types(moving)
    frames = (start, *(joint.child for joint in moving))
    groups = tuple(_group(urdf, frame) for frame in frames)
    mounts = tuple(
        group[joint.parent].then(joint.pose) for group, joint in zip(groups, moving, strict=False)
    )
    return Chain(tuple(moving), frames, mounts, groups, tip)


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
        raise RobotFileError(f"{urdf.file}: joints run in a circle; a URDF is a tree")
    if len(roots) > 1:
        text = f"{len(roots)} links hang on no joint: {listed(roots)}"
        raise RobotFileError(f"{urdf.file}: {text}; a URDF is one tree with one root")
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
            raise RobotFileError(f"{urdf.file}: {text}")
        path.append(parents[link])
        if path[-1].parent in seen:
            path[-1].element.fault("closes a circle; a URDF is a tree")
        seen.add(path[-1].parent)
    return path[::-1]


def _only_leaf(urdf: Urdf, parents: dict[str, UrdfJoint], start: str) -> str:
    """Return the one link, carried by `start`, that carries none."""
    carrying = {joint.parent for joint in urdf.joints.values()}
    leaves = [link for link in urdf.links if link not in carrying]
    leaves = [link for link in leaves if _carries(parents, start, link)]
    if len(leaves) > 1:
        text = f"{len(leaves)} links could be the last one: {listed(leaves)}"
        raise RobotFileError(f"{urdf.file}: {text}; name it (--to LINK)")
    return leaves[0]


def _carries(parents: dict[str, UrdfJoint], start: str, link: str) -> bool:
    while link != start and link in parents:
        link = parents[link].parent
    return link == start


def _group(urdf: Urdf, frame: str) -> dict[str, Pose]:
    """Return all links that fixed joints hold to a link, with their poses in it."""
    fixed = [joint for joint in urdf.joints.values() if joint.type == "fixed"]
    group = {frame: Pose.still()}
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
        raise RobotFileError(f"{urdf.file}: no joint moves {between}")
    if len(moving) > MOST_JOINTS:
        text = f"{len(moving)} joints move {between}; at most {MOST_JOINTS} are possible"
        raise RobotFileError(f"{urdf.file}: {text}: choose a shorter chain (--from LINK --to LINK)")


def _check_types(moving: list[UrdfJoint]) -> None:
    for joint in moving:
        if joint.type in OTHERS:
            text = f"a {joint.type} joint has more than one degree of freedom"
            joint.element.fault(f"{text}; a chain has revolute, continuous and prismatic ones")


def _known(urdf: Urdf, link: str) -> str:
    if link not in urdf.links:
        known = listed(urdf.links)
        raise RobotFileError(f"{urdf.file}: no link {shown(link)}; there are {known}")
    return link


def listed(names: Iterable[str]) -> str:
    """Write names, the first few of many."""
    all_names = [one_line(name) for name in names]
    more = f", ... ({len(all_names)} in all)" if len(all_names) > MOST_SHOWN else ""
    return ", ".join(all_names[:MOST_SHOWN]) + more
