"""Drawing: each function draws its data on matplotlib axes and returns the drawn objects.

Joint angles come in radians and are drawn in degrees; lengths are in the robot's unit. No meaning
rests on colour alone: lines differ in dash, points in marker. The colours are those of Okabe and
Ito, which colour-blind readers can tell apart.

Examples
--------
The region of the paper with its curved sides and its numbered corners. In a script,
``ax.figure.savefig("region.png")`` then writes the picture:

>>> from matplotlib.figure import Figure
>>> from qbound import figures, load_robot, window_region
>>> robot = load_robot("minervabot-v2")
>>> ax = Figure().subplots()
>>> figures.joint_axes(ax, robot)
>>> region = window_region(robot)
>>> drawn = figures.draw_region(ax, robot, region.with_points(30, tangents=False))
>>> drawn += figures.draw_vertices(ax, robot, region.polygon)
>>> ax.get_xlabel(), len(drawn)
('$q_1$ / °', 8)
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import count, pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.forms import HarmonicForm
from qbound.robot import Joint, Robot
from qbound.traversal import Traversal
from qbound.workspace import PLANE

Axes = Any
"""Axes of matplotlib, which is imported where it is used."""

FEASIBLE: Final = "#0072B2"
COLLIDING: Final = "#D55E00"
USED: Final = "#007A5E"
UNUSED: Final = "#CC79A7"
SECOND: Final = "#7A4FA3"
INK: Final = "#222222"
BOUNDARIES: Final = ("#3B3EAC", "#1B7837", "#A3195B", "#736000", "#00797D", "#8A3FB5", "#4F2B10")
"""Colours of a robot's boundaries in the order of its file, so of the paper's B1 to B7."""
LINKS: Final = ("#8C8C8C", "#56B4E9", "#C9BF3F", "#009E73")
"""Colours of the outlines of links, by the number of joints between base and link."""

STYLE: Final[dict[str, Any]] = {
    "figure.figsize": (6.4, 4.4),
    "figure.constrained_layout.use": True,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "font.size": 10,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "svg.fonttype": "path",
    "svg.hashsalt": "qbound",
}
"""The style of the book. A fixed salt and no date give the same SVG bytes on every run."""


def use_style() -> None:
    """Set the book's style and, inside Jupyter, SVG figures with the same bytes on every run."""
    import matplotlib as mpl
    from matplotlib_inline.backend_inline import set_matplotlib_formats

    mpl.rcParams.update(STYLE)  # type: ignore[arg-type]
    set_matplotlib_formats(  # type: ignore[no-untyped-call]
        "svg", metadata={"Date": None, "Creator": None}, bbox_inches=None
    )


def boundary_colour(robot: Robot, name: str) -> str:
    """Return the colour that a boundary has in every picture of a robot, by its name."""
    names = [boundary.name for boundary in robot.boundaries]
    return BOUNDARIES[names.index(name) % len(BOUNDARIES)]


# --- axes -----------------------------------------------------------------------------------------


def joint_axes(ax: Axes, robot: Robot, ranges: ArrayLike | None = None) -> None:
    """Label the plane of two joints, in degrees or the unit of length, and set its ranges.

    Parameters
    ----------
    ranges : array_like, shape (2, 2), optional
        Lowest and highest value of each joint, rad or length; default: limits, or one turn.
    """
    from matplotlib.ticker import MultipleLocator

    ends = np.array([joint.range for joint in robot.joints] if ranges is None else ranges)
    drawn = shown(robot, ends.T).T
    ax.set(xlim=tuple(drawn[0]), ylim=tuple(drawn[1]))
    for axis, joint, (low, high) in zip((ax.xaxis, ax.yaxis), robot.joints, drawn, strict=True):
        axis.set_label_text(f"{joint_label(joint)} / {'°' if joint.turns else robot.length_unit}")
        if joint.turns:
            axis.set_major_locator(MultipleLocator(60 if high - low > 180 else 30))
    if robot.kinds[0] == robot.kinds[1]:
        ax.set_aspect("equal")


def joint_label(joint: Joint) -> str:
    """Return a joint's name for a picture: ``q1`` becomes a q with the index 1."""
    return re.sub(r"^([a-zA-Z])(\d)$", r"$\1_\2$", joint.name)


def plane_axes(ax: Axes, robot: Robot, limits: ArrayLike | None = None) -> None:
    """Label the plane of x and z and give both axes one scale.

    Parameters
    ----------
    limits : array_like, shape (2, 2), optional
        Lowest and highest x, lowest and highest z, in the robot's unit of length.
    """
    ax.set(aspect="equal", xlabel=f"$x$ / {robot.length_unit}", ylabel=f"$z$ / {robot.length_unit}")
    if limits is not None:
        (x_low, x_high), (z_low, z_high) = np.asarray(limits)
        ax.set(xlim=(x_low, x_high), ylim=(z_low, z_high))


def legend_below(ax: Axes, columns: int = 3, **style: Any) -> Any:
    """Put the legend under the axes, where it hides nothing."""
    return ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=columns, **style)


# --- the arm --------------------------------------------------------------------------------------


def draw_robot(
    ax: Axes, robot: Robot, q: ArrayLike, points: Sequence[str] = (), alpha: float = 1.0
) -> list[Any]:
    """Draw a planar arm in the plane of x and z at one configuration.

    Drawn are the outlines of its links, the chain, its joints as circles, the tool as a square.

    Parameters
    ----------
    q : array_like, shape (n,)
        Joint values, rad or length.
    points : sequence of str
        Names of points that are marked and labelled too.
    alpha : float
        Opacity of the arm, from 0 to 1.
    """
    frames = robot.frames(np.asarray(q, dtype=float))

    def at(name: str) -> Floats:
        return np.asarray(frames.position(robot.base, name, robot.base)[PLANE], dtype=float)

    artists: list[Any] = []
    for outline in robot.outlines:
        rotation = frames.rotation(robot.base, outline.frame)
        seen = (outline.corners @ rotation.T)[:, PLANE] + at(outline.frame)
        colour = LINKS[len(robot.chain(outline.frame)) % len(LINKS)]
        artists += ax.fill(*seen.T, fc=colour, ec=INK, lw=1, alpha=0.35 * alpha)
    chain = np.array([at(name) for name in (robot.base, *robot.motions, robot.tool)])
    artists += ax.plot(*chain.T, color=INK, lw=2, alpha=alpha, zorder=3)
    artists += ax.plot(*chain[1:-1].T, "o", mfc="white", mec=INK, ms=7, alpha=alpha, zorder=4)
    artists += ax.plot(*chain[-1:].T, "s", color=INK, ms=5, alpha=alpha, zorder=4)
    for i, name in enumerate(points):
        left = i % 2 == 0  # two points that touch have their names on different sides
        shift, side = ((-6, -9), "right") if left else ((6, 4), "left")
        artists += ax.plot(*at(name), "o", color=COLLIDING, ms=5, zorder=5)
        artists.append(_write(ax, name, at(name), shift, ha=side))
    return artists


def draw_arrow(
    ax: Axes, start: ArrayLike, end: ArrayLike, label: str = "", *, colour: str = INK, **style: Any
) -> list[Any]:
    """Draw a labelled vector from `start` to `end`, shape (2,) each, in the units of the axes.

    `style` has further properties of matplotlib's arrows.
    """
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    look = {"arrowstyle": "-|>", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0} | style
    artists: list[Any] = [ax.annotate("", tuple(end), tuple(start), arrowprops=look)]
    if label:
        aside = np.array([-(end - start)[1], (end - start)[0]])
        shift = 10 * aside / max(float(np.hypot(*aside)), 1e-9)
        artists.append(_write(ax, label, (start + end) / 2, shift, ha="center", color=colour))
    return artists


# --- joint space ----------------------------------------------------------------------------------


def shown(robot: Robot, q: ArrayLike) -> Floats:
    """Return joint values, shape (..., n), as they are drawn: in degrees where the joint turns.

    Examples
    --------
    >>> from qbound.figures import shown
    >>> from qbound import load_robot
    >>> shown(load_robot("minervabot-v2"), [np.pi, 0.0]).tolist()
    [180.0, 0.0]
    """
    values = np.array(q, dtype=float)
    for j, joint in enumerate(robot.joints):
        if joint.turns:
            values[..., j] = np.degrees(values[..., j])
    return values


def draw_bound(ax: Axes, robot: Robot, q: ArrayLike, *, used: bool, **style: Any) -> list[Any]:
    """Draw one bound, a curve of joint space, shape (m, 2), solid if used, else dashed.

    `Region.curve` gives q2 of the bound of a half-space over q1.
    """
    look = {"color": USED, "lw": 2} if used else {"color": UNUSED, "lw": 1.2, "ls": "--"}
    return list(ax.plot(*shown(robot, q).T, **(look | style)))


def draw_zero(ax: Axes, robot: Robot, form: HarmonicForm, ranges: ArrayLike, **style: Any) -> Any:
    """Draw the curves on which a form of two joints vanishes; ranges as in `joint_axes`.

    The curves are those of a grid of 601 by 601 points. So this also draws a boundary whose corners
    `Region.corners` does not name.
    """
    (low1, high1), (low2, high2) = np.asarray(ranges)
    q1, q2 = np.meshgrid(np.linspace(low1, high1, 601), np.linspace(low2, high2, 601))
    q = np.stack([q1, q2], axis=-1)
    return ax.contour(*np.moveaxis(shown(robot, q), -1, 0), form(q), levels=[0], **style)


def draw_region(ax: Axes, robot: Robot, vertices: ArrayLike, **style: Any) -> list[Any]:
    """Fill a polygon of joint space, shape (m, 2), rad or length.

    `Region.polygon` has straight edges; `Region.with_points` follows the curves.
    """
    look = {"facecolor": FEASIBLE, "alpha": 0.18, "edgecolor": FEASIBLE, "lw": 1.8} | style
    return list(ax.fill(*shown(robot, vertices).T, **look))


def draw_vertices(
    ax: Axes, robot: Robot, vertices: ArrayLike, labels: Iterable[object] | None = None
) -> list[Any]:
    """Mark vertices, shape (m, 2), rad or length, and number them 1, 2, ..., or label them.

    The numbers stand on the side away from the mean of the vertices.
    """
    p = shown(robot, vertices)
    artists: list[Any] = list(ax.plot(*p.T, "o", color=INK, ms=5, zorder=5))
    return artists + _number(ax, p, p.mean(axis=0), 12, labels)


def draw_path(
    ax: Axes,
    path: ArrayLike,
    stops: ArrayLike,
    *,
    labels: Iterable[object] | None = None,
    distance: float = 12,
    legs: Mapping[int, Mapping[str, Any]] | None = None,
) -> list[Any]:
    """Draw a path with an arrow on each leg and labelled stops.

    Parameters
    ----------
    path : array_like, shape (m, 2)
        Points in the units of the axes, so degrees (`shown`) for joints that turn.
    stops : array_like of int
        Rows at which legs begin and end.
    labels : iterable, optional
        Labels of the stops; default 1, 2, ...
    distance : float
        Distance of a label from its stop, in printer's points; negative: towards the middle.
    legs : mapping of int to style, optional
        Styles of single legs, by number from 0.
    """
    p, rows = np.asarray(path), np.asarray(stops).tolist()
    artists: list[Any] = []
    for i, (start, end) in enumerate(pairwise(rows)):
        look: dict[str, Any] = {"color": FEASIBLE, "lw": 1.8} | dict((legs or {}).get(i, {}))
        artists += ax.plot(*p[start : end + 1].T, **look)
        k = (start + end) // 2
        arrow = {"arrowstyle": "-|>", "color": look["color"], "lw": 1.5, "mutation_scale": 14}
        artists.append(ax.annotate("", tuple(p[k + 1]), tuple(p[k]), arrowprops=arrow))
    closed = np.allclose(p[0], p[-1])
    marked = p[rows[: len(rows) - closed]]
    artists += ax.plot(*marked.T, "o", color=INK, ms=4.5, zorder=5)
    return artists + _number(ax, marked, p.mean(axis=0), distance, labels)


def draw_traversal(
    axes: Sequence[Axes],
    robot: Robot,
    region: ArrayLike,
    path: Traversal,
    *,
    ranges: ArrayLike,
    window: ArrayLike,
    **look: Any,
) -> list[Any]:
    """Draw a traversal in joint space and, beside it, the tool's path and the final pose.

    Parameters
    ----------
    axes : sequence of two axes
        For joint space and for the plane.
    region : array_like, shape (m, 2)
        The polygon behind the path, rad or length.
    path : Traversal
    ranges, window : array_like, shape (2, 2)
        Ranges of the joints, rad or length, and of x and z.
    **look
        Further parameters of `draw_path`.
    """
    joints, plane = axes
    joint_axes(joints, robot, ranges)
    artists = draw_region(joints, robot, region, lw=0)
    artists += draw_path(joints, shown(robot, path.q), path.stops, distance=-13, **look)
    plane_axes(plane, robot, window)
    artists.append(plane.axhline(0, color=INK, lw=1))
    artists += draw_robot(plane, robot, path.q[-1], alpha=0.6)
    return artists + draw_path(plane, path.tool, path.stops, **look)


def draw_sample(ax: Axes, points: ArrayLike, allowed: ArrayLike) -> list[Any]:
    """Scatter points, shape (n, 2): allowed ones as blue dots, the others as orange crosses.

    The points are in the units of the axes, so degrees (`shown`) for joints that turn.
    """
    p, inside = np.asarray(points), np.asarray(allowed, dtype=bool)
    look = {"s": 6, "lw": 0.6, "rasterized": True}
    return [
        ax.scatter(*p[~inside].T, c=COLLIDING, marker="x", label="not allowed", **look),
        ax.scatter(*p[inside].T, c=FEASIBLE, marker=".", label="allowed", **look),
    ]


# --- words ----------------------------------------------------------------------------------------


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> Any:
    """Return a table for a notebook's output, written in Markdown; cells may hold formulas."""
    from IPython.display import Markdown

    lines = [[str(cell) for cell in header], ["---"] * len(header)]
    for row in rows:
        lines.append([_in_a_cell(str(cell).replace("|", r"\|")) for cell in row])
    text = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return Markdown(text)  # type: ignore[no-untyped-call]


def _in_a_cell(text: str) -> str:
    """Write minus signs, except in code and formulas, which are every second part."""
    parts = re.split(r"(`[^`]*`|\$[^$]*\$)", text)
    return "".join(part if i % 2 else minus_signs(part) for i, part in enumerate(parts))


def minus_signs(text: str) -> str:
    """Write a minus sign for every hyphen that begins a number.

    Examples
    --------
    >>> from qbound.figures import minus_signs
    >>> minus_signs("q1 = -30.5°, x-axis, 1e-12")
    'q1 = −30.5°, x-axis, 1e-12'
    """
    return re.sub(r"(?<![\w.-])-(?=\.?\d)", "\N{MINUS SIGN}", text)


def bound_label(label: str) -> str:
    """Write a bound's label, such as ``beta_{1,3,1}``, as mathtext; a limit's name as it is."""
    return f"$\\{label}$" if label.startswith("beta_") else label


def _number(
    ax: Axes, points: Any, middle: Any, distance: float, labels: Iterable[object] | None
) -> list[Any]:
    """Write labels, default 1, 2, ..., beside points, away from the middle."""
    artists = []
    for label, point in zip(labels or count(1), points, strict=False):
        shift = distance * (point - middle) / max(float(np.hypot(*(point - middle))), 1e-9)
        look = {"ha": "center", "va": "center", "weight": "bold"}
        artists.append(_write(ax, str(label), point, shift, **look))
    return artists


def _write(ax: Axes, text: str, point: Any, shift: Any, **style: Any) -> Any:
    """Write a text beside a point, outlined in white, so that lines do not hide it."""
    from matplotlib.patheffects import withStroke

    note = ax.annotate(
        text, tuple(point), tuple(shift), textcoords="offset points", zorder=6, **style
    )
    note.set_path_effects([withStroke(linewidth=3, foreground="white")])
    return note
