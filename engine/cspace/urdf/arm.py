"""From a URDF to a robot: one chain, its joints, and balls that cover its links.

The text of an imported robot's file: one row on one line, and its origin in a comment on top. Five
hundred pairs of balls would fill thousands of lines if each were a table of its own.
"""

from __future__ import annotations

import math
import textwrap
import warnings
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, count, product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cspace.arguments import refuse_type
from cspace.arrays import Floats
from cspace.extras import require
from cspace.files import MADE
from cspace.model.joints import JOINT_TYPES, Joint
from cspace.model.robot import Pair, Point, Robot
from cspace.model.robotcheck import RobotFileError
from cspace.model.robotfile import parse_robot, robot_table
from cspace.model.rows import unit_vector
from cspace.model.schema import shown
from cspace.printable import printable
from cspace.tolerances import ROUNDING
from cspace.urdf.covers import Root, inner_balls, link_cover, read_mesh, size_of
from cspace.urdf.document import Collision, Mesh, Srdf, Triangles, Urdf, read_srdf, read_urdf
from cspace.urdf.tree import LinkChain, find_chain, listed, locked
from cspace.urdf.xml import PACKAGED, Source, called

Limits = Mapping[str, tuple[float, float]]
Shapes = dict[str, list[Collision]]

EXCESS_PART = 0.1
"""Part of a shape's size by which a ball may stick out of it, unless something else is asked for.

One excess for all would be finer than large arms need, and leave no free pose to small ones."""

LEAST_EXCESS, MOST_EXCESS = 1e-6, 1e3
"""Excess that can be asked for, m."""

MOST_PAIRS = 20_000
"""Pairs of balls of a robot at most."""

MANY_PAIRS = 2_000
"""Pairs of balls above which a coarser cover is proposed: as many as `cspace.check` takes."""

COARSER, COARSEST = 1.25, 12
"""Factor from one excess to the next, and how many are tried, where one makes too many pairs."""


class Ball(NamedTuple):
    """A ball of a cover."""

    point: Point
    link: str
    group: int


Covered = tuple[list[Ball], float, list[tuple[str, str]]]
"""Balls, how far one sticks out at most, and the pairs of balls that are kept apart."""


@dataclass(frozen=True)
class Apart:
    """Which pairs of links are to be kept apart.

    Attributes
    ----------
    joined : frozenset of frozenset of str
        Pairs of links that one moving joint joins directly. They are not kept apart, because they
        usually overlap at the joint, unless the SRDF enables the pair. A link that is only fixed to
        one of them is kept apart from the other.
    srdf : Srdf
        Its disabled pairs are not kept apart.
    """

    joined: frozenset[frozenset[str]]
    srdf: Srdf

    @classmethod
    def of(cls, urdf: Urdf, srdf: Srdf, neighbours: bool) -> Apart:
        """Return the rule for an arm; with `neighbours` no pair is left out for its joint."""
        joints = () if neighbours else urdf.joints.values()
        moving = (joint for joint in joints if joint.type != "fixed")
        return cls(frozenset(frozenset((joint.parent, joint.child)) for joint in moving), srdf)

    def skips(self, one: str, other: str) -> bool:
        """Tell whether a pair is not kept apart because one joint joins both."""
        pair = frozenset((one, other))
        return pair in self.joined and pair not in self.srdf.enabled

    def keeps(self, one: str, other: str) -> bool:
        """Tell whether a pair of links of two rigid groups is to be kept apart."""
        return not self.skips(one, other) and self.srdf.checks(one, other)


@dataclass(frozen=True, eq=False)
class Imported:
    """A robot from a URDF, with the files and notes of the import.

    Attributes
    ----------
    robot : Robot
    chain : LinkChain
    excess : float
        Largest distance by which a ball sticks out of the shape that it covers; m.
    sources : tuple of Source
        The files: URDF, SRDF, meshes.
    notes : tuple of str
        Sentences: how each link is covered, what was left out, whether fewer pairs are enough.
    shapes : dict of str to list of Collision
        The shapes of each link of the chain, meshes read.
    """

    robot: Robot
    chain: LinkChain
    excess: float
    sources: tuple[Source, ...]
    notes: tuple[str, ...]
    shapes: Shapes


def import_urdf(  # noqa: PLR0913  # what a file leaves open
    source: str | Path,
    *,
    chain: tuple[str | None, str | None] | None = None,
    srdf: str | Path | None = None,
    limits: Limits | None = None,
    excess: float | None = None,
    packages: Sequence[str | Path] = (),
    clearance: float = 0.0,
    home: str | None = None,
    neighbours: bool = False,
) -> Imported:
    """Read a URDF, and an SRDF if there is one, as a robot; m and rad.

    Parameters
    ----------
    source : str or Path
        A path, or the name of a packaged file such as ``ur5.urdf``.
    chain : pair of str, optional
        First and last link; None for the root, and for the link behind the most moving joints.
    srdf : str or Path, optional
        The SRDF; its disabled pairs are not kept apart, and its state "home" or "ready" is the home
        pose.
    limits : mapping of str to pair of float, optional
        Limits of joints in place of the file's, rad or m; two equal ones lock a joint.
    excess : float, optional
        Largest distance by which a ball may stick out of the shape that it covers; default: the
        part `EXCESS_PART` of the size of each shape (`cspace.urdf.covers.size_of`), or a larger
        part of it, so that there are `MANY_PAIRS` pairs of balls at most.
    packages : sequence of str or Path
        Folders of packages that may contain meshes, or folders of such folders; ``NAME=FOLDER`` for
        a package of another name than its folder and its ``package.xml`` have. Meshes below the
        URDF's own folder are always allowed. Where links lead out of these folders, name the
        folders to which they lead, too.
    clearance : float
        Clearance that every pair of balls keeps.
    home : str, optional
        Name of a state of the SRDF.
    neighbours : bool
        Whether two links that one moving joint joins directly are kept apart, too. The SRDF may ask
        for this pair by pair, by ``<enable_collisions>``.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        If a file is wrong or describes something that no robot here can be; the message has the
        line.
    ModuleNotFoundError
        If a library of ``cspace[arms]`` is missing.

    Notes
    -----
    Not in the paper. Two links are not kept apart if one moving joint joins them directly, unless
    it is asked for, if they are fixed to each other, or if the SRDF disables the pair. Links that
    are only fixed to one of two neighbours, such as a camera or a tool, are kept apart from the
    other.

    Examples
    --------
    >>> imported = import_urdf("ur5.urdf", srdf="ur5.srdf", excess=0.01)
    >>> len(imported.robot.points) - 1, len(imported.robot.boundaries), imported.excess <= 0.01
    (29, 193, True)
    >>> imported.robot.home.round(3).tolist()
    [0.0, -1.571, 1.571, -1.571, -1.571, 0.0]
    """
    _check_arguments(chain, srdf, limits, excess)
    urdf, held = locked(read_urdf(packaged_or_path(source)), limits or {})
    limits = {name: ends for name, ends in (limits or {}).items() if name not in held}
    links = Srdf() if srdf is None else read_srdf(packaged_or_path(srdf))
    _check_same_arm(urdf, links)
    found = find_chain(urdf, *(chain or (None, None)))
    if excess is not None and not LEAST_EXCESS <= excess <= MOST_EXCESS:
        raise ValueError(f"excess {excess}: {LEAST_EXCESS:g} to {MOST_EXCESS:g} m is wanted")
    _warn_of_other_shapes(urdf, found)
    joints = _joints(urdf, found, limits)
    roots = [Root(urdf.file.parent), *map(Root.named, packages)]
    shapes = _shapes(urdf, found, roots)
    apart = Apart.of(urdf, links, neighbours)
    if excess is None:
        balls, reached, pairs = _balls_by_size(shapes, found, apart)
    else:
        balls, reached, pairs = _balls(shapes, found, apart, lambda _: excess)
    if not balls:
        text = "no link of the chain has a <collision> with a shape, so nothing could be kept apart"
        raise RobotFileError(f"{called(urdf.file)}: {text}")
    few = excess is None or len(pairs) <= MANY_PAIRS
    fewer = "" if few or excess is None else _fewer(shapes, found, apart, excess)
    if len(pairs) > MOST_PAIRS:
        cure = fewer or "allow a larger excess"
        text = f"{len(pairs):,} pairs of balls; at most {MOST_PAIRS:,} are possible: {cure}"
        raise RobotFileError(f"{called(urdf.file)}: {text}; or disable pairs of links in an SRDF")
    robot = Robot(
        name=urdf.name,
        joints=joints,
        points=(_tool(found), *(ball.point for ball in balls)),
        boundaries=tuple(Pair(", ".join(names), names, clearance) for names in pairs),
        home=_home(joints, links, home),
        tool=_tool(found).name,
        length_unit="m",
        angle_unit="deg",  # decimals: quarter turns are exact
        left_out=(*_off_chain(urdf, found), *_bare(urdf, found)),
    )
    try:
        robot = parse_robot(robot_table(robot))
    except RobotFileError as error:
        raise RobotFileError(f"{called(urdf.file)}: {error}") from None
    solids = [shape.solid for each in shapes.values() for shape in each]
    meshes = [solid for solid in solids if isinstance(solid, Triangles)]
    read = filter(None, [urdf.source, links.source, *(mesh.source for mesh in meshes)])
    notes = [*_covered(reached, meshes), *_left_out(urdf, found, apart)]
    if held:
        where = ", ".join(f"{name} at {value:g}" for name, value in held.items())
        notes.append(f"fixed, because limits lock them: {where}")
        if meet := _meet_where_locked(urdf, held, balls, clearance):
            locked_at = (
                "not kept apart, because limits lock the joints between them, and balls meet"
            )
            notes.append(f"{locked_at}: {_listed_pairs(meet)}")
    if soft := [j for j in found.joints if j.soft and j.limits and j.name not in limits]:
        ranges = (f"{j.name} {j.limits[0]:g} to {j.limits[1]:g}" for j in soft if j.limits)
        notes.append(f"soft limits in place of the wider hard ones: {', '.join(ranges)}")
    if fewer:
        most = f"certificates take at most {MANY_PAIRS:,}"
        notes.append(f"{len(pairs):,} pairs of balls, and {most}: {fewer}")
    return Imported(robot, found, reached, tuple(dict.fromkeys(read)), tuple(notes), shapes)


def _check_arguments(chain: object, srdf: object, limits: object, excess: object) -> None:
    """Refuse arguments of other types."""
    pair = isinstance(chain, Sequence) and not isinstance(chain, str) and len(chain) == 2
    if chain is not None and not pair:
        refuse_type("chain", chain, "a first and a last link, such as (None, 'tool0')")
    if srdf is not None and not isinstance(srdf, str | Path):
        refuse_type("srdf", srdf, "the path of an SRDF")
    if excess is not None and not isinstance(excess, float | int):
        refuse_type("excess", excess, "a number of metres")
    if limits is None:
        return
    if not isinstance(limits, Mapping):
        refuse_type("limits", limits, "ranges by joint, such as {'elbow': (-2.0, 2.0)}")
    for joint, ends in limits.items():
        try:
            low, high = map(float, ends)
        except (TypeError, ValueError):
            refuse_type(f"limits of {shown(joint)}", ends, "two numbers")
        if not (math.isfinite(low) and math.isfinite(high)):
            raise ValueError(f"limits of {shown(joint)}: {ends} are no finite numbers")


def _check_same_arm(urdf: Urdf, srdf: Srdf) -> None:
    """Refuse an SRDF that names links or joints, but none of the URDF's."""
    for what, named, known in (
        ("links", srdf.named, urdf.links.keys()),
        ("joints", srdf.joints, urdf.joints.keys()),
    ):
        if srdf.source is not None and named and not named & known:
            said = f"{srdf.source.name} is of another robot: its {what} are {listed(sorted(named))}"
            raise RobotFileError(f"{called(urdf.file)}: {said}; the URDF has {listed(known)}")


def _warn_of_other_shapes(urdf: Urdf, chain: LinkChain) -> None:
    chained = (link for *_, group in chain.rigid() for link in group)
    if other := [link for link in chained if urdf.links[link].other_shapes]:
        said = f"<self_collision_checking> of {', '.join(other)} is not read"
        told = f"{called(urdf.file)}: {said}: the shapes of <collision> are kept apart"
        warnings.warn(printable(told), stacklevel=3)  # at the caller of import_urdf


def packaged_or_path(source: str | Path) -> Path:
    """Return the place of a file, or of a packaged one by its name, such as ``ur5.urdf``."""
    packaged = {file.name for file in PACKAGED.iterdir() if file.suffix in (".urdf", ".srdf")}
    return PACKAGED / str(source) if str(source) in packaged else Path(source)


# --- joints ---------------------------------------------------------------------------------------

TYPES = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
"""From a type of URDF to ours."""


def _joints(urdf: Urdf, chain: LinkChain, limits: Limits) -> tuple[Joint, ...]:
    names = [joint.name for joint in chain.joints]
    for name in limits:
        if name not in names:
            known = listed(names)
            raise RobotFileError(
                f"{called(urdf.file)}: limits of {shown(name)}: the chain has {known}"
            )
    return tuple(_joint(chain, k, limits.get(joint.name)) for k, joint in enumerate(chain.joints))


def _joint(chain: LinkChain, k: int, limits: tuple[float, float] | None) -> Joint:
    joint, mount, bar = chain.joints[k], chain.mounts[k], chain.bars[k]
    chosen = joint.limits if limits is None else limits
    if chosen is None and joint.type != "continuous":
        joint.element.fault(f"a {joint.type} joint without limits; give them for the import")
    if chosen is not None and not chosen[0] < chosen[1]:
        text = f"limits {chosen[0]:g} to {chosen[1]:g} do not rise"
        joint.element.fault(f"{text}; give others for the import")
    more: dict[str, Any] = {} if bar is None else {"crank": bar.crank, "bar": bar.frame}
    return JOINT_TYPES[TYPES[joint.type] if bar is None else "parallelogram"](
        name=joint.name,
        parent=chain.frames[k],
        frame=chain.frames[k + 1],
        origin=mount.origin,
        mount=_plain_turn(mount.rotation),
        axis=unit_vector(joint.axis.tolist()),
        limits=chosen,
        velocity=joint.velocity,
        **more,
    )


def _plain_turn(rotation: Floats) -> Floats:
    """Make entries exact that are 0, 1 or -1 up to the rounding of sines and products."""
    whole = np.rint(rotation)
    return np.asarray(np.where(np.abs(rotation - whole) <= ROUNDING, whole, rotation))


CUT = 1e-3
"""How far a state may be outside of limits, rad or m: by digits that were cut off."""


def _home(joints: Sequence[Joint], srdf: Srdf, wanted: str | None) -> Floats:
    """Return the values of a state, or where it has none zeros, moved into the limits.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        If a value of the state is outside of the limits by more than `CUT`.
    """
    name, state = srdf.home(wanted)
    found = []
    for joint in joints:
        low, high = joint.limits or (-math.inf, math.inf)
        value = state.get(joint.name, 0.0)
        if joint.name in state and not low - CUT <= value <= high + CUT:
            where = f"state {shown(name)}: {joint.name} = {value:g}"
            text = f"{where} is outside of its limits {low:g} to {high:g}; name another state"
            raise RobotFileError(f"{srdf.source.name if srdf.source else 'SRDF'}: {text}")
        found.append(min(max(value, low), high))
    return np.array(found)


# --- points and pairs -----------------------------------------------------------------------------


def _tool(chain: LinkChain) -> Point:
    """Return the origin of the last link; no point may have the name of a frame."""
    frames = {frame for _, frame, _ in chain.rigid()}
    names = _longer_names(chain.tip, "/tool")
    name = next(name for name in names if name not in frames)
    return Point(name, chain.frames[-1], chain.groups[-1][chain.tip].origin)


def _longer_names(name: str, ending: str) -> Iterator[str]:
    """Yield a name, then the name with one ending, two endings and so on."""
    return (name + ending * k for k in count())


def _shapes(urdf: Urdf, chain: LinkChain, roots: Sequence[Root]) -> Shapes:
    """Return the shapes of every link of the chain, meshes read; each file once."""
    read: dict[tuple[str, tuple[float, ...]], Triangles] = {}
    found: Shapes = {}
    for link in (link for *_, group in chain.rigid() for link in group):
        found[link] = []
        for shape in urdf.links[link].collisions:
            solid = shape.solid
            if isinstance(solid, Mesh):
                key = (solid.filename, tuple(solid.scale.tolist()))
                if key not in read:
                    read[key] = read_mesh(solid, shape.element, roots)
                solid = read[key]
            found[link].append(replace(shape, solid=solid))
    return found


def _balls(
    shapes: Shapes, chain: LinkChain, apart: Apart, allowed: Callable[[Collision], float]
) -> Covered:
    """Cover every link of the chain; return the balls, and the largest excess of a ball.

    `allowed` gives the excess of each shape; length.
    """
    balls: list[Ball] = []
    reached = 0.0
    links = {link for *_, group in chain.rigid() for link in group}
    for group, frame, poses in chain.rigid():
        for link, pose in poses.items():
            excesses = [*map(allowed, shapes[link])]
            centres, radii, sticks_out = link_cover(shapes[link], pose, excesses)
            reached = max(reached, sticks_out)
            for name, at, radius in zip(_names(link, links), centres, radii, strict=False):
                balls.append(Ball(Point(name, frame, at, float(radius)), link, group))
    pairs = [
        (one.point.name, other.point.name)
        for one, other in combinations(balls, 2)
        if one.group != other.group and apart.keeps(one.link, other.link)
    ]
    return balls, reached, pairs


def _balls_by_size(shapes: Shapes, chain: LinkChain, apart: Apart) -> Covered:
    """Cover every link by balls whose excess follows its size; return balls, excess and pairs.

    The part of the size grows until there are few enough pairs, and none of the shapes takes too
    many balls or too long. Pairs become fewer by its third power (surfaces) to its sixth (blocks).
    """
    part = EXCESS_PART
    for k in range(COARSEST + 1):

        def allowed(shape: Collision, part: float = part) -> float:
            return max(LEAST_EXCESS, part * size_of(shape.solid))

        try:
            balls, reached, pairs = _balls(shapes, chain, apart, allowed)
        except RobotFileError:
            if k == COARSEST:
                raise
            part *= COARSER
            continue
        if len(pairs) <= MANY_PAIRS:
            break
        part *= max(COARSER, (len(pairs) / MANY_PAIRS) ** 0.25)
    return balls, reached, pairs


def _names(link: str, links: Collection[str]) -> Iterator[str]:
    """Yield names for balls of a link: LINK/1, LINK/2, ..., but for those of links."""
    return (name for i in count(1) if (name := f"{link}/{i}") not in links)


def _fewer(shapes: Shapes, chain: LinkChain, apart: Apart, excess: float) -> str:
    """Name an excess with few enough pairs for a certificate; empty if they are few enough."""
    for _ in range(COARSEST):
        excess = float(f"{COARSER * excess:.2g}")
        fewer = len(_balls(shapes, chain, apart, lambda _, e=excess: e)[2])  # type: ignore[misc]
        if fewer <= MANY_PAIRS:
            return f"an excess of {excess:g} m makes {fewer:,}"
    return ""


def _covered(excess: float, meshes: Sequence[Triangles]) -> Iterator[str]:
    """Yield sentences with what is proved about the balls."""
    most = f"none sticks out of its shape by more than {_rounded_up(excess)} m"
    what = "collision shape is covered by balls (proved)"
    if meshes:
        what = f"{what}, of a mesh its triangles (what they enclose may not be)"
    yield f"every {what}, and {most}"
    if opened := [mesh.source.name for mesh in meshes if not mesh.closed]:
        what = "meshes that do not close up, whose excess is that beyond their hull"
        yield f"{what}: {', '.join(opened)}"


def _rounded_up(length: float) -> str:
    """Write a length in whole micrometres, rounded up."""
    return f"{math.ceil(length * 1e6) / 1e6:.6f}"


def _off_chain(urdf: Urdf, chain: LinkChain) -> list[str]:
    """Return the links with a shape that are not in the chain."""
    held = {link for *_, group in chain.rigid() for link in group}
    return [name for name, link in urdf.links.items() if name not in held and link.collisions]


def _bare(urdf: Urdf, chain: LinkChain) -> list[str]:
    """Return the links of the chain without a collision shape that may be solid.

    These are links with a visual shape, and the frames of groups in which no link has a collision
    shape. Other links without a shape are frames of a solid link.
    """
    links, found = urdf.links, list[str]()
    for _, frame, group in chain.rigid():
        empty = not any(links[name].collisions for name in group)
        for name in group:
            if (name == frame and empty) or (links[name].visible and not links[name].collisions):
                found.append(name)
    return found


def _left_out(urdf: Urdf, chain: LinkChain, apart: Apart) -> Iterator[str]:
    """Yield sentences with what the robot leaves out."""
    if others := _off_chain(urdf, chain):
        yield f"not in the chain, and not kept clear of: {', '.join(others)}"
    if bare := _bare(urdf, chain):
        yield f"without a collision shape: {', '.join(bare)}"
    groups = {link: number for number, _, group in chain.rigid() for link in group}
    solid = [link for link in groups if urdf.links[link].collisions]
    pairs = [p for p in combinations(solid, 2) if groups[p[0]] != groups[p[1]]]
    if neighbours := [p for p in pairs if apart.skips(*p)]:
        yield f"not kept apart, because one joint connects them: {_listed_pairs(neighbours)}"
    if disabled := [p for p in pairs if not apart.skips(*p) and not apart.keeps(*p)]:
        yield f"not kept apart, because the SRDF disables them: {_listed_pairs(disabled)}"
    if strange := sorted(apart.srdf.joints - urdf.joints.keys()):
        yield f"the SRDF's states name joints that the URDF does not have: {', '.join(strange)}"
    if unknown := sorted(apart.srdf.named - urdf.links.keys()):
        yield f"the SRDF names links that the URDF does not have: {', '.join(unknown)}"


def _meet_where_locked(
    urdf: Urdf, held: Collection[str], balls: Sequence[Ball], clearance: float
) -> list[tuple[str, str]]:
    """Return pairs of links that only locked joints fix to each other, and whose balls meet."""
    above = {joint.child: joint for joint in urdf.joints.values()}
    covers = dict[str, list[Ball]]()
    carrier = dict[str, str]()  # the link that carries a link by joints that are fixed in the file
    for ball in balls:
        covers.setdefault(ball.link, []).append(ball)
        link = ball.link
        while link in above and above[link].type == "fixed" and above[link].name not in held:
            link = above[link].parent
        carrier[ball.link] = link
    return [
        (one, other)
        for one, other in combinations(covers, 2)
        if covers[one][0].group == covers[other][0].group
        and carrier[one] != carrier[other]
        and any(
            np.linalg.norm(a.point.at - b.point.at) < a.point.radius + b.point.radius + clearance
            for a, b in product(covers[one], covers[other])
        )
    ]


def _listed_pairs(pairs: Sequence[tuple[str, str]]) -> str:
    return "; ".join(" and ".join(pair) for pair in pairs)


# --- balls inside the links -----------------------------------------------------------------------


ALONG_AXIS = 65
"""Places along the axis of a joint at which a ball inside a link is tried."""

ACROSS = 8
"""The same along each edge of the box about a link's balls."""


def balls_inside(imported: Imported) -> tuple[Point, ...]:
    """Return balls that lie inside the shapes of the links, named LINK/k; not in the paper.

    The robot's own balls stick out of the links. So if these meet, the links may be apart; but if
    two balls of this function meet, the links do. They are tried at the centres of the robot's
    balls, at the places of a grid, and along the axes of the joints, where one place may belong to
    both neighbours at all joint values.

    Examples
    --------
    >>> imported = import_urdf("ur5.urdf", srdf="ur5.srdf", excess=0.01)
    >>> inside = balls_inside(imported)
    >>> radius = max(ball.radius for ball in inside if ball.covers == "upper_arm_link")
    >>> radius < 0.05, round(radius, 6)
    (True, 0.05)
    """
    robot, found = imported.robot, list[Point]()
    links = {link for *_, poses in imported.chain.rigid() for link in poses}
    axes: dict[str, list[tuple[Floats, Floats]]] = {}
    for joint in robot.joints:
        axes.setdefault(joint.parent, []).append((joint.origin, joint.mount @ joint.axis))
        axes.setdefault(joint.labels[0], []).append((np.zeros(3), joint.axis))
    for _, frame, poses in imported.chain.rigid():
        for link, pose in poses.items():
            cover = [point for point in robot.points if point.covers == link]
            if not cover:
                continue
            centres, radii = np.array([p.at for p in cover]), np.array([p.radius for p in cover])
            low = (centres - radii[:, None]).min(axis=0)
            high = (centres + radii[:, None]).max(axis=0)
            steps = np.stack(np.meshgrid(*[np.arange(ACROSS)] * 3, indexing="ij"), axis=-1)
            grid = low + (high - low) * (steps.reshape(-1, 3) + 0.5) / ACROSS
            reach = float(np.linalg.norm(np.maximum(np.abs(low), np.abs(high))))
            along = np.linspace(-reach, reach, ALONG_AXIS)[:, None]
            lines = [origin + along * axis for origin, axis in axes.get(frame, [])]
            places = np.vstack([*lines, centres, grid])
            inner, depths = inner_balls(imported.shapes[link], pose, places)
            found += [
                Point(name, frame, at, float(depth))
                for name, at, depth in zip(_names(link, links), inner, depths, strict=False)
            ]
    return tuple(found)


# --- the text of the robot file -------------------------------------------------------------------


WIDTH = 100
"""Columns of a comment at most."""


def robot_text(imported: Imported) -> str:
    """Return the robot file of an imported robot.

    The first lines are comments: the sources with their digests, the chain, the proved excess, and
    what was left out.

    Raises
    ------
    ModuleNotFoundError
        If tomlkit is missing; it comes with ``cspace[files]``.
    """
    require("tomlkit", "writing a robot file")
    lines = [*_header(imported)]
    for key, value in robot_table(imported.robot).items():
        if isinstance(value, list) and value and isinstance(value[0], Mapping):
            rows = [f"    {_inline(row)}," for row in value]
            lines += ["", f"{key} = [", *rows, "]"]
        else:
            lines.append(f"{key} = {_inline(value)}")
    return "\n".join(lines) + "\n"


def _header(imported: Imported) -> list[str]:
    chain = imported.chain
    texts = [
        f"{MADE} import, lengths in metres, from",
        *(f"  {source.name}, SHA-256 {source.sha256}" for source in imported.sources),
        f"Chain: from {chain.frames[0]} to {chain.tip}.",
        *(f"{note[0].upper()}{note[1:]}." for note in imported.notes),
    ]
    return [line for text in texts for line in _comment(text)]


def _comment(text: str) -> list[str]:
    return textwrap.wrap(
        printable(text),
        WIDTH,
        initial_indent="# ",
        subsequent_indent="#   ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _inline(value: Any) -> str:
    """Write a value on one line."""
    import tomlkit

    if isinstance(value, Mapping):
        pairs = (f"{_key(key)} = {_inline(item)}" for key, item in value.items())
        return f"{{ {', '.join(pairs)} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_inline, value))}]"
    return str(tomlkit.item(value).as_string())


def _key(key: str) -> str:
    """Write a key, in quotes where it needs them."""
    import tomlkit

    return tomlkit.key(key).as_string()
