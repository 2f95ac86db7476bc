"""Figures: each function draws its data and returns the drawn objects.

Angles come in radians and are drawn in degrees. Colour-blind readers can tell the colours (Okabe
and Ito) apart, and no meaning rests on colour alone: lines differ in dash, points in marker.

This module has the style and the parts of pictures.

- `pictures`: whole pictures for a robot file: its region, a pose, a traversal, its workspace;
- `workspace`: aspects and their images, pavings; `why`: why a plan fails.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from itertools import count, product
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats
from cspace.export.outlines import polygons
from cspace.forms.factors import whole_turns
from cspace.measures.bodies import outline_in_frame, overlaps
from cspace.model.robot import COORDINATES, Joint, Robot
from cspace.order import first_largest
from cspace.printable import printable
from cspace.region import Component, Region
from qbound import figures as small
from qbound.circle import TURN
from qbound.figures import BOUNDARIES as BOUNDARIES
from qbound.figures import COLLIDING as COLLIDING
from qbound.figures import FEASIBLE as FEASIBLE
from qbound.figures import INK as INK
from qbound.figures import SECOND as SECOND
from qbound.figures import UNUSED as UNUSED
from qbound.figures import USED as USED
from qbound.figures import draw_path as draw_path
from qbound.figures import legend_below as legend_below
from qbound.figures import minus_signs as minus_signs
from qbound.figures import table as table
from qbound.figures import use_style as use_style
from qbound.frames import Frames

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes


OVERLAP: Final = "#C1121F"
"""Of links that are inside each other. `COLLIDING`, which is orange, is what a boundary forbids:
nothing else is orange."""
DRAWN: Final = 1e-3
"""Largest deviation of a drawn polygon from its arcs, joint units; a tenth of a line's width."""
LINKS: Final = (*small.LINKS, UNUSED)

STYLE: Final = small.STYLE | {"figure.facecolor": "white", "text.usetex": False}
"""The style of the book, whatever the user's own style says; the same SVG bytes on every run."""


def boundary_colour(robot: Robot, name: str) -> str:
    """Return the colour that a boundary has in every picture of a robot."""
    names = [boundary.name for boundary in robot.boundaries]
    k = names.index(name) if name in names else len(BOUNDARIES)
    return BOUNDARIES[k] if k < len(BOUNDARIES) else FEASIBLE


def joint_axes(
    ax: Axes, robot: Robot, ranges: ArrayLike = ((-np.pi, np.pi), (-np.pi, np.pi))
) -> None:
    """Label the plane of two joints, degrees, and give both axes one scale."""
    (x0, x1), (y0, y1) = np.degrees(np.asarray(ranges))
    one, other = (f"{symbol(joint.name)} / °" for joint in robot.joints[:2])
    ax.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xlabel=one, ylabel=other)
    ax.xaxis.set_major_locator(every(x1 - x0))
    ax.yaxis.set_major_locator(every(y1 - y0))


def plane_axes(
    ax: Axes, robot: Robot, limits: ArrayLike | None = None, plane: tuple[int, int] | None = None
) -> None:
    """Label the plane of motion of a planar arm (`drawn_plane`), and give both axes one scale."""
    axes = drawn_plane(robot) if plane is None else plane
    one, other = (f"${'xyz'[axis]}$ / {robot.length_unit}" for axis in axes)
    ax.set(aspect="equal", xlabel=one, ylabel=other)
    if limits is not None:
        (x0, x1), (z0, z1) = np.asarray(limits)
        ax.set(xlim=(x0, x1), ylim=(z0, z1))


def draw_robot(
    ax: Axes,
    robot: Robot,
    q: ArrayLike,
    *,
    points: Sequence[str] = (),
    bodies: bool = True,
    alpha: float = 1.0,
    plane: tuple[int, int] | None = None,
) -> list[Artist]:
    """Draw a planar arm at one configuration: obstacles, bodies, links, joints, points by name.

    Bodies that are inside each other (`cspace.measures.bodies.overlaps`) are red.

    A joint that turns is a circle; one that slides is a carriage on a rail from its lowest value
    to its highest. A rail on the base is drawn without a link to the base's origin.

    Parameters
    ----------
    q : array_like, shape (n,)
    points : sequence of str
        Points to mark and name.
    plane : tuple of int, optional
        The two coordinates drawn; 0, 1, 2 for x, y, z. Default: those of `drawn_plane`. In other
        planes bodies are not drawn.
    """
    axes = list(drawn_plane(robot) if plane is None else plane)
    frames = robot.frames(np.asarray(q, dtype=float))
    artists: list[Artist] = []
    if bodies and tuple(axes) == drawn_plane(robot):
        deep = {name for pair in overlaps(robot, q) for name in pair}
        artists += _draw_bodies(ax, robot, frames, axes, alpha, deep)
    artists += _draw_chain(ax, robot, frames, axes, alpha)
    # Names alternate left and right, because two points in contact are at one place.
    for i, name in enumerate(points):
        x, z = frames.position(robot.base, name, robot.base)[axes]
        artists += ax.plot(x, z, "o", color=COLLIDING, ms=5, zorder=5)
        left = i % 2 == 0 and len(points) > 1
        shift = (-6, -9) if left else (6, 4)
        text = ax.annotate(as_text(name), (x, z), shift, textcoords="offset points", zorder=6)
        text.set_horizontalalignment("right" if left else "left")
        artists.append(_halo(text))
    return artists


MOST_NAMED: Final = 30
"""Obstacles that are named in a picture: the names of more would cover each other."""


def drawn_plane(robot: Robot) -> tuple[int, int]:
    """Return the two coordinates in which a picture shows an arm; x and z if it is not planar."""
    try:
        return COORDINATES[first_largest(np.abs(robot.plane.normal))]
    except ValueError:
        return 0, 2


def _draw_bodies(
    ax: Axes, robot: Robot, frames: Frames, axes: list[int], alpha: float, deep: set[str]
) -> list[Artist]:
    """Draw the outlines of obstacles and bodies, each in the colour of its frame.

    Bodies that are `deep` in another one are red, with the word "overlap" beside them.
    """
    artists: list[Artist] = []
    for body in (*robot.obstacles, *robot.bodies):
        colour = LINKS[frames.names.index(body.frame) % len(LINKS)]
        if body in robot.obstacles:
            colour = INK
        turn = np.asarray(frames.rotation(robot.base, body.frame), dtype=float)
        corners = outline_in_frame(robot, body) @ turn.T
        seen = corners + frames.position(robot.base, body.frame, robot.base)
        look: dict[str, Any] = {"facecolor": colour, "edgecolor": INK, "lw": 1}
        if body.name in deep:
            look |= {"facecolor": OVERLAP, "edgecolor": OVERLAP}
        artists += ax.fill(*seen[:, axes].T, alpha=0.35 * alpha, **look)
    if deep:
        at: Any = {"xycoords": "axes fraction", "ha": "left", "va": "bottom", "color": OVERLAP}
        artists.append(_halo(ax.annotate("overlap", (0.02, 0.02), weight="bold", **at)))
    return artists


def name_obstacles(ax: Axes, robot: Robot, plane: tuple[int, int]) -> list[Artist]:
    """Write the name of every obstacle on it, unless there are more than `MOST_NAMED`."""
    if plane != drawn_plane(robot) or len(robot.obstacles) > MOST_NAMED:
        return []
    artists: list[Artist] = []
    for body in robot.obstacles:
        corners = outline_in_frame(robot, body)[:, list(plane)]
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        text = ax.annotate(as_text(body.name), tuple(middle), ha="center", va="center", fontsize=8)
        text.set_zorder(6)
        artists.append(_halo(text))
    return artists


def _draw_chain(
    ax: Axes, robot: Robot, frames: Frames, axes: list[int], alpha: float
) -> list[Artist]:
    """Draw the links as one line, a circle where a joint turns, the tool, and the slides."""

    def place(name: str) -> Floats:
        return np.asarray(frames.position(robot.base, name, robot.base)[axes], dtype=float)

    spine, circles, slides = [place(robot.base)], [], []
    for joint in robot.joints:
        if joint.turns:
            circles.append(place(joint.frame))
        else:
            rail = _rail(robot, joint, frames)[:, axes]
            slides.append((rail[1:], place(joint.frame)))
            spine = [] if joint.parent == robot.base else [*spine, rail[0], np.full(2, np.nan)]
        spine.append(place(joint.frame))
    tool = place(robot.tool)
    artists: list[Artist] = []
    artists += ax.plot(*np.array([*spine, tool]).T, color=INK, lw=2, alpha=alpha, zorder=3)
    marks = np.reshape(circles, (-1, 2)).T
    artists += ax.plot(*marks, "o", mfc="white", mec=INK, ms=7, alpha=alpha, zorder=4)
    artists += ax.plot(*tool[:, None], "s", color=INK, ms=5, alpha=alpha, zorder=4)
    for rail, carriage in slides:
        artists += _draw_slide(ax, rail, carriage, alpha)
    return artists


def _rail(robot: Robot, joint: Joint, frames: Frames) -> Floats:
    """Return where a slide is at zero, or as near as possible, and the ends of its rail, (3, 3)."""
    low, high = joint.limits or (0.0, 0.0)
    values = np.array([np.clip(0.0, low, high), low, high])
    places = joint.origin + values[:, None] * (joint.mount @ joint.axis)
    turn = np.asarray(frames.rotation(robot.base, joint.parent), dtype=float)
    return np.asarray(places @ turn.T + frames.position(robot.base, joint.parent, robot.base))


def _draw_slide(ax: Axes, rail: Floats, carriage: Floats, alpha: float) -> list[Artist]:
    """Draw a rail, shape (2, 2), as a hollow bar, and the carriage on it, aligned with the rail."""
    artists: list[Artist] = []
    for colour, width in ((INK, 6.0), ("white", 3.5)):
        look: dict[str, Any] = {"lw": width, "solid_capstyle": "butt", "zorder": 2.5}
        artists += ax.plot(*rail.T, color=colour, alpha=alpha, **look)
    across, up = rail[1] - rail[0]
    square: Any = (4, 0, 45 + math.degrees(math.atan2(up, across)))
    artists += ax.plot(
        *carriage[:, None], marker=square, mfc="white", mec=INK, ms=13, alpha=alpha, zorder=3.5
    )
    return artists


def draw_spheres(
    ax: Axes, robot: Robot, q: ArrayLike, plane: tuple[int, int] | None = None
) -> list[Artist]:
    """Draw every point that has a radius as a disc: those of the base filled, the others open."""
    from matplotlib.patches import Circle

    frames = robot.frames(np.asarray(q, dtype=float))
    axes = list(drawn_plane(robot) if plane is None else plane)
    artists: list[Artist] = []
    for point in (point for point in robot.points if point.radius > 0):
        place = frames.position(robot.base, point.name, robot.base)[axes]
        fixed = point.frame == robot.base
        look: dict[str, Any] = {"fc": INK + "55" if fixed else "none", "ec": INK, "lw": 1}
        artists.append(ax.add_patch(Circle(tuple(place), point.radius, zorder=2, **look)))
    return artists


def number_points(
    ax: Axes,
    places: ArrayLike,
    middle: ArrayLike,
    distance: float = 12,
    labels: Iterable[object] | None = None,
) -> list[Artist]:
    """Write labels (default 1, 2, ...) beside places in axis units, away from `middle`."""
    artists: list[Artist] = []
    for label, place in zip(labels or count(1), np.asarray(places), strict=False):
        away = place - np.asarray(middle)
        shift = distance * away / max(float(np.hypot(*away)), 1e-9)
        text = ax.annotate(
            str(label), tuple(place), tuple(shift), textcoords="offset points", weight="bold"
        )
        text.set(ha="center", va="center", zorder=6)
        artists.append(_halo(text))
    return artists


NUMBER: Final = np.array([14.0, 9.0])
"""Width and height of a number of two digits, in typographic points."""


def number_apart(
    ax: Axes, places: ArrayLike, middle: ArrayLike, distance: float = 12
) -> list[Artist]:
    """Write 1, 2, ... beside places as `number_points`, but turned aside where two would overlap.

    A number that would cover another one at every position is left out. The axes' limits have to be
    set.
    """
    p = np.asarray(places, dtype=float)
    seen = _points_a_unit(ax) * p
    away = p - np.asarray(middle)
    artists: list[Artist] = []
    taken = list(seen)  # the marks, then the labels too
    labels = np.empty((0, 2))
    for k, preferred in enumerate(np.arctan2(away[:, 1], away[:, 0])):
        others = np.array([*taken[:k], *taken[k + 1 :], np.full(2, np.inf)])
        shift = _free_shift(seen[k], others, float(preferred), distance)
        label = seen[k] + shift
        if (np.abs(labels - label) < NUMBER).all(axis=1).any():
            continue
        labels = np.vstack([labels, label])
        taken.append(label)
        artists += number_points(ax, p[k : k + 1], p[k] - shift, distance, [k + 1])
    return artists


def _points_a_unit(ax: Axes) -> Floats:
    """Return the typographic points of a unit of each axis, before the layout is final."""
    across = np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())])
    points = np.array(ax.bbox.size) * 72 / ax.figure.dpi / across
    return np.full(2, points.min()) if ax.get_aspect() != "auto" else points


def _free_shift(place: Floats, others: Floats, preferred: float, distance: float) -> Floats:
    """Return the first shift, turning away from the preferred one, that is clear of the others."""
    turns = np.array([0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, -6, 7, -7, 8]) * math.pi / 8
    shifts = distance * np.stack([np.cos(preferred + turns), np.sin(preferred + turns)], axis=-1)
    gaps = np.linalg.norm((place + shifts)[:, None] - others, axis=-1).min(axis=1)
    clear = gaps >= 1.25 * distance  # two digits are wider than they are high
    return np.asarray(shifts[int(clear.argmax() if clear.any() else gaps.argmax())])


def symbol(name: str) -> str:
    """Write a name of a letter and digits, such as ``q1``, as mathtext, all others as text."""
    if not re.fullmatch("[A-Za-zΑ-Ωα-ω][0-9]*", name):
        return as_text(name)
    return f"${name[0]}_{{{name[1:]}}}$" if name[1:] else f"${name}$"


def as_text(name: str) -> str:
    """Escape a name of a robot file so that matplotlib does not read it as a formula."""
    return printable(name).replace("$", r"\$")


def every(span: float, *, few: bool = False) -> Any:
    """Return ticks at 30 or 60 degrees, depending on the span; farther apart over many turns.

    With `few`, for a small panel, ticks are three times as far apart.
    """
    from matplotlib.ticker import MultipleLocator

    if few:
        return MultipleLocator(180 * np.ceil(span / 1200) if span > 400 else 90)
    return MultipleLocator(60 * np.ceil(span / 600) if span > 180 else 30)


def _halo(text: Any) -> Any:
    """Outline a text in white, so that it reads on lines."""
    from matplotlib.patheffects import withStroke

    text.set_path_effects([withStroke(linewidth=3, foreground="white")])
    return text


def draw_components(
    ax: Axes,
    region: Region,
    chosen: Iterable[Component] | None = None,
    unit: Literal["deg", "rad"] = "deg",
    **style: Any,
) -> list[Artist]:
    """Fill every component, home's in blue, others in grey, with its copies a turn away.

    Parameters
    ----------
    chosen : iterable of Component, optional
        Some of the region's components; default: all.
    unit : {"deg", "rad"}
        Unit of angles.
    **style
        Options of matplotlib's patches; outlines use the edge colour and line width.
    """
    from matplotlib.cbook import normalize_kwargs
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    artists: list[Artist] = []
    scale = joint_scales(region, unit)
    own = normalize_kwargs(style, PathPatch)
    if (both := own.pop("color", None)) is not None:
        own = {"facecolor": both, "edgecolor": both} | own
    label = own.pop("label", None)
    turns = [[0.0] if r else [-TURN, 0.0, TURN] for r in region.problem.ranges]
    rounds = np.array([len(shifts) > 1 for shifts in turns])
    components = region.components if chosen is None else chosen
    for component in reversed([*components]):  # home's comes last, over the others' edges
        colour = FEASIBLE if component.contains_home else "#777777"
        inside_look = {"facecolor": colour, "alpha": 0.25} | own | {"linewidth": 0}
        line = {"color": own.get("edgecolor", colour), "lw": own.get("linewidth", 1.5)}
        pieces, _ = polygons(component, DRAWN)
        rings = [ring for piece in pieces for ring in (piece.outer, *piece.holes)]
        rings = [ring - _turns_off(rings[0], rounds) for ring in rings]
        lines = [np.concatenate([arc.points for arc in loop]) for loop in component.loops]
        lines = [path - _turns_off(path, rounds) for path in lines]
        for shift in (np.array(s) for s in product(*turns)):
            closed = ((np.append(ring, ring[:1], axis=0) + shift) * scale for ring in rings)
            inside = Path.make_compound_path(*(Path(ring, closed=True) for ring in closed))
            artists.append(ax.add_patch(PathPatch(inside, **inside_look)))
            for path in lines:
                artists += ax.plot(*((path + shift) * scale).T, **line)
    if artists and label is not None:
        artists[0].set_label(label)  # one legend entry for all components
    return artists


def _turns_off(points: Floats, rounds: NDArray[np.bool_]) -> Floats:
    """Return the full turns by which points are off the first one, on joints that turn round."""
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    return np.where(rounds, TURN * whole_turns(middle), 0.0)


def joint_scales(region: Region, unit: Literal["deg", "rad"] = "deg") -> Floats:
    """Return degrees per radian for joints that turn, if `unit` is "deg"; else 1. Shape (2,)."""
    if unit not in ("deg", "rad"):
        raise ValueError(f"no unit {unit!r} of angles; there are deg and rad")
    turns = [kind == "revolute" and unit == "deg" for kind in region.problem.forms.kinds]
    return np.where(turns, np.degrees(1.0), 1.0)
