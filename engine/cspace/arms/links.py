"""The links of an arm: the balls of each link, and the two links of a boundary, found by names.

An imported arm has balls named "LINK/1", "LINK/2", ... The frame is that of the link that moves;
a link fixed to it keeps its own name. A ball without a stroke in its name belongs to its frame.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cspace.boundary.balls import Balls
from cspace.model.robot import Boundary, HalfSpace, Pair, Point, Robot
from cspace.printable import printable
from cspace.sampling import joint_ranges, keeps_clear


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid link: its balls, all in one frame.

    Attributes
    ----------
    name, frame : str
    depth : int
        Joints between the base and the frame.
    balls : tuple of Point
        Each with a radius above 0.
    """

    name: str
    frame: str
    depth: int
    balls: tuple[Point, ...]


def link_of(point: Point) -> str:
    """Return the link of a point: its name up to the last stroke, else its frame.

    Examples
    --------
    >>> import numpy as np
    >>> from cspace.model.robot import Point
    >>> link_of(Point("forearm/2", "elbow", np.zeros(3))), link_of(Point("7", "1", np.zeros(3)))
    ('forearm', '1')
    """
    return point.name.rpartition("/")[0] or point.frame


SPHERES_ONLY = (
    "this is shown for the spheres that cover the links, which stick out of them: the links"
    " themselves may be apart"
)
"""Sentence about an answer that `on_spheres` tells of."""


def on_spheres(robot: Robot, names: Iterable[str]) -> bool:
    """Tell whether all boundaries of these names, one or more, are about balls that cover links.

    A limit of a joint is not. Where such a boundary is violated, links need not meet.

    Examples
    --------
    >>> from cspace import load_robot
    >>> robot = load_robot("ur5")
    >>> name = robot.used[0].name
    >>> on_spheres(robot, [name]), on_spheres(robot, [name, "elbow_joint.lower"])
    (True, False)
    """
    named, boundaries = set(names), {boundary.name: boundary for boundary in robot.used}
    return bool(named) and all(_covers_links(robot, boundaries.get(name)) for name in named)


def _covers_links(robot: Robot, boundary: Boundary | None) -> bool:
    if isinstance(boundary, HalfSpace):
        return bool(boundary.point and robot.point(boundary.point).covers)
    if isinstance(boundary, Pair):
        return any(robot.point(name).covers for name in boundary.points)
    return False


MOST_LISTED = 8
"""Pairs of links that a sentence lists."""


def unchecked_lines(robot: Robot) -> Iterator[str]:
    """Yield what no answer about this robot looks at: pairs of links, and links that are missing.

    A line before these says that feasible means allowed by points, or by joint limits alone.

    Examples
    --------
    >>> from cspace import load_robot
    >>> [line] = unchecked_lines(load_robot("ur5"))
    >>> line.partition(";")[0]
    'not checked, because no boundary keeps them apart: base_link and shoulder_link'
    """
    if robot.feasible_by == "points":
        yield "feasible means allowed by the points of this file; whole links are not looked at"
    elif not robot.used:
        yield "feasible means within the joint limits; this file has no boundary in use"
    if pairs := robot.unchecked:
        listed = "; ".join(" and ".join(pair) for pair in pairs[:MOST_LISTED])
        more = f"; ... ({len(pairs)} pairs in all)" if len(pairs) > MOST_LISTED else ""
        yield printable(f"not checked, because no boundary keeps them apart: {listed}{more}")
    yield from left_out_lines(robot)


def left_out_lines(robot: Robot) -> Iterator[str]:
    """Yield a sentence that names the links that the file does not describe, if there are any."""
    if robot.left_out:
        yield printable(f"not checked, because not in the file: {', '.join(robot.left_out)}")


def links(robot: Robot) -> tuple[Link, ...]:
    """Return the links of an arm that have balls, from the base outwards (not in the paper).

    Points without a radius are marks, such as the tool, and belong to no link.

    Raises
    ------
    ValueError
        If the robot has bodies, has no ball, or balls of one link stand in several frames.

    Examples
    --------
    >>> from cspace import load_robot
    >>> [link.name for link in links(load_robot("ur5"))][:3]
    ['base_link', 'shoulder_link', 'upper_arm_link']
    """
    if robot.bodies:
        names = ", ".join(body.name for body in robot.bodies)
        raise ValueError(
            f"links are made of balls here; these bodies are none: {printable(names)};"
            " cspace region finds what they forbid"
        )
    found: dict[str, list[Point]] = {}
    for point in robot.points:
        if point.radius > 0:
            found.setdefault(link_of(point), []).append(point)
    if not found:
        name = printable(robot.name)
        raise ValueError(f"{name}: no link has a ball, that is, a point with a radius")
    made = [_link(robot, name, balls) for name, balls in found.items()]
    return tuple(sorted(made, key=lambda link: link.depth))


POSES = 2_000
"""Random poses at which the cost of a sphere model is counted."""


class LostPoses(NamedTuple):
    """What a sphere model refuses of random poses: counts."""

    poses: int
    refused: int
    meet: int
    """Of the refused poses, those at which balls inside two links meet: so the links do."""


def lost_poses(robot: Robot, inside: Sequence[Point]) -> LostPoses:
    """Count the random poses that the boundaries refuse, and those at which the links meet.

    The difference bounds what is lost because spheres stick out of the links: links may meet where
    no two balls inside them do.

    Parameters
    ----------
    inside : sequence of Point
        Balls that lie inside the links' shapes, named LINK/k.

    Examples
    --------
    >>> from cspace.urdf.arm import balls_inside, import_urdf
    >>> imported = import_urdf("scara.urdf", srdf="scara.srdf")
    >>> lost = lost_poses(imported.robot, balls_inside(imported))
    >>> lost.meet <= lost.refused <= lost.poses
    True
    """
    low, high = joint_ranges(robot).T
    q = np.random.default_rng(0).uniform(low, high, (POSES, len(low)))
    q = q[~keeps_clear(robot, q)]
    pairs = [b.points for b in robot.used if isinstance(b, Pair)]
    kept = {tuple(robot.point(name).covers for name in pair) for pair in pairs}
    centres = Balls.of(replace(robot, points=tuple(inside), boundaries=())).centres(q)
    meet, covers = np.zeros(len(q), dtype=bool), np.array([ball.covers for ball in inside])
    radii = np.array([ball.radius for ball in inside])
    for one, other in kept:
        far = np.flatnonzero(covers == other)
        for k in np.flatnonzero(covers == one):
            apart = np.linalg.norm(centres[:, far] - centres[:, [k]], axis=-1)
            meet |= (apart < radii[far] + radii[k]).any(axis=1)
    return LostPoses(POSES, len(q), int(meet.sum()))


def link_pair(robot: Robot, boundary: Boundary) -> str:
    """Return the names of the two links of a boundary, or the boundary's own name.

    A half-space of a ball is named by its link and the place where its name begins to count balls:
    "floor, forearm/1" and "floor, forearm/2" are both "floor, forearm".
    """
    if isinstance(boundary, Pair):
        points = [robot.point(name) for name in boundary.points]
        if all("/" in point.name for point in points):
            return ", ".join(map(link_of, points))
    if isinstance(boundary, HalfSpace) and "/" in boundary.point:
        return boundary.name.replace(boundary.point, link_of(robot.point(boundary.point)))
    return boundary.name


def _link(robot: Robot, name: str, balls: list[Point]) -> Link:
    frames = list(dict.fromkeys(ball.frame for ball in balls))
    if len(frames) > 1:
        text = f"the balls of link {name} stand in several frames: {', '.join(frames)}"
        raise ValueError(printable(text))
    return Link(name, frames[0], robot.depth(frames[0]), tuple(balls))
