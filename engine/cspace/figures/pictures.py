"""Whole pictures for a robot file: its region, a pose, a traversal, its workspace; SVG or PNG.

Pictures are returned as bytes, the same on every run; only `plot_region` draws on given axes.
`figures` draws the parts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from cspace import figures
from cspace.arguments import refuse_type
from cspace.arrays import Floats
from cspace.figures.workspace import draw_images, draw_patches, legend
from cspace.model.robot import HalfSpace, Robot
from cspace.order import first_largest
from cspace.paths.traversal import PathReport
from cspace.region import Component, Region, Slices
from cspace.units import amount
from cspace.workspace.areas import Workspace
from qbound.circle import nearest_turn
from qbound.figures import INK, draw_path, minus_signs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PANEL: Final = (5.4, 5.0)
SMALL: Final = (3.2, 3.4)
ACROSS: Final = 5
"""Size of a strip's panels, and how many stand side by side."""
Limits = tuple[float, float]
Line = tuple[float, float, float]
"""Where a half-space that stands upright on the plane cuts it: unit normal and offset."""


def pose_picture(
    robot: Robot,
    q: ArrayLike,
    region: Region | None = None,
    plane: tuple[int, int] | Literal["own"] | None = "own",
    kind: str = "svg",
    numbered: Component | None = None,
) -> bytes:
    """Draw the joint-space region with a pose marked and, beside it, the robot in that pose.

    Obstacles are labelled with their names.

    Parameters
    ----------
    q : array_like, shape (n,)
    region : Region or None
        Region for the panel of joint space; None for no such panel.
    plane : tuple of int, "own" or None
        The coordinates of the robot's panel, 0, 1, 2 for x, y, z; "own": those of the robot's plane
        of motion; None: no such panel.
    kind : {"svg", "png"}
    numbered : Component or None
        The component whose vertices are numbered.
    """
    pose = np.asarray(q, dtype=float)
    plane = figures.drawn_plane(robot) if plane == "own" else plane

    def draw(axes: Sequence[Axes]) -> None:
        if region is not None:
            _pose_panel(axes[0], region, numbered, pose)
        if plane is not None:
            figures.draw_spheres(axes[-1], robot, pose, plane)
            figures.draw_robot(axes[-1], robot, pose, plane=plane)
            figures.name_obstacles(axes[-1], robot, plane)
            axes[-1].set_title(_written(robot, pose))
            _space_panel(axes[-1], robot, plane)

    return picture((region is not None) + (plane is not None), draw, kind)


def traversal_picture(report: PathReport) -> bytes:
    """Draw a traversal in joint space and, beside it, the tool's path and the final pose."""
    region, path, plane = report.route.region, report.route.path, report.plane or (0, 2)
    robot, q = region.robot, path.q[:, list(region.problem.joints)]
    legs = {leg: {"color": INK} for leg in range(len(path.legs))}
    look: dict[str, Any] = {"labels": report.route.stops, "legs": legs}

    def draw(axes: Sequence[Axes]) -> None:
        joints, space = axes
        _joint_panel(joints, region, None, q)
        drawn = q * figures.joint_scales(region)
        draw_path(joints, drawn, path.stops, distance=-13, **look)
        figures.draw_robot(space, robot, path.final_pose, alpha=0.6, plane=plane)
        draw_path(space, path.tool[:, list(plane)], path.stops, **look)
        _space_panel(space, robot, plane)

    return picture(2, draw)


def workspace_picture(workspace: Workspace, unit: str) -> bytes:
    """Draw the places that the tool reaches and their boundaries; `unit` is the unit of lengths."""
    names = ["xyz"[first_largest(np.abs(axis))] for axis in workspace.arm.axes]

    def draw(axes: Sequence[Axes]) -> None:
        (ax,) = axes
        draw_patches(ax, workspace)
        draw_images(ax, workspace)
        ax.set(aspect="equal", xlabel=f"${names[0]}$ / {unit}", ylabel=f"${names[1]}$ / {unit}")
        legend(ax)

    return picture(1, draw, size=(7, 6))


def plot_region(
    region: Region,
    ax: Axes | None = None,
    component: int | None = None,
    unit: Literal["deg", "rad"] = "deg",
    **style: Any,
) -> Axes:
    """Draw a region, with home marked for a robot; arguments as in `cspace.Region.plot`."""
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.subplots()[1]
    if not hasattr(ax, "add_patch"):
        refuse_type("ax", ax, "the Axes of a matplotlib figure")
    chosen = region.components if component is None else (region.components[component],)
    home = np.empty((0, 2)) if region.problem.free_home is None else region.problem.free_home[None]
    _joint_panel(ax, region, next(iter(chosen), None), home, chosen, unit, **style)
    _mark(ax, home * figures.joint_scales(region, unit))
    return ax


def region_picture(region: Region) -> bytes:
    """Return the picture of `plot_region` as bytes."""
    return picture(1, lambda axes: plot_region(region, axes[0]))


def strip_picture(slices: Slices) -> bytes:
    """Draw slices side by side, each with its value and its area, and home where it lies in one."""
    count = len(slices.regions)

    def draw(axes: Sequence[Axes]) -> None:
        for k, (ax, region) in enumerate(zip(axes, slices.regions, strict=True)):
            home = slices.robot.home[None, list(region.problem.joints)][: slices.holds_home(k)]
            _joint_panel(ax, region, None, home)
            _mark(ax, home * figures.joint_scales(region))
            ax.set_title(_slice_title(slices, k))
            for axis, turns in zip((ax.xaxis, ax.yaxis), region.problem.forms.kinds, strict=True):
                if turns == "revolute":
                    axis.set_major_locator(
                        figures.every(np.ptp(axis.get_view_interval()), few=True)
                    )
            below, left = k + ACROSS >= count, k % ACROSS == 0
            ax.tick_params(labelbottom=below, labelleft=left)
            ax.set(**({} if below else {"xlabel": ""}), **({} if left else {"ylabel": ""}))

    return picture(count, draw, size=SMALL, columns=ACROSS)


def _slice_title(slices: Slices, k: int) -> str:
    """Return the title of a slice: its value and its area."""
    joint, region = slices.robot.joints[slices.along], slices.regions[k]
    turn = np.degrees(1.0) if joint.turns else 1.0
    value = amount(
        float(slices.values[k] * turn), joint.unit(slices.robot.length_unit, "°"), digits=4
    )
    area = f"{region.area:#.4g} {region.area_unit.replace('^2', '²')}"
    return minus_signs(f"{figures.as_text(joint.name)} = {value}\n{area}")


def picture(
    panels: int,
    draw: Callable[[Sequence[Axes]], object],
    kind: str = "svg",
    size: tuple[float, float] = PANEL,
    columns: int = 2,
) -> bytes:
    """Draw on panels in the book's style; no date and a fixed salt, so that bytes are equal."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    made = {"Date": None, "Creator": "cspace"} if kind == "svg" else {"Software": "cspace"}
    with mpl.rc_context(figures.STYLE):  # type: ignore[arg-type]
        rows, across = -(-panels // columns), min(panels, columns)
        figure = Figure(figsize=(size[0] * across, size[1] * rows))
        axes = figure.subplots(rows, across, squeeze=False).ravel()
        for spare in axes[panels:]:
            spare.remove()
        draw(axes[:panels].tolist())
        buffer = BytesIO()
        figure.savefig(buffer, format=kind, dpi=160, metadata=made)
    return buffer.getvalue()


def _pose_panel(ax: Axes, region: Region, numbered: Component | None, q: Floats) -> None:
    """Draw all components and mark one configuration."""
    place = q[None, list(region.problem.joints)]
    _joint_panel(ax, region, numbered, place)
    _mark(ax, place * figures.joint_scales(region))


def _mark(ax: Axes, places: Floats) -> None:
    """Mark configurations, shape (k, 2), in the axes' units."""
    ax.plot(*places.T, "P", color=INK, ms=9, mec="white", zorder=7)


def _joint_panel(
    ax: Axes,
    region: Region,
    numbered: Component | None,
    q: Floats,
    chosen: Sequence[Component] | None = None,
    unit: Literal["deg", "rad"] = "deg",
    **style: Any,
) -> None:
    """Draw components over one turn or the limits, and further where `q`, shape (k, 2), goes."""
    problem = region.problem
    scales, ranges = figures.joint_scales(region, unit), problem.ranges
    figures.draw_components(ax, region, chosen, unit, **style)
    if not region.components:
        reason = figures.as_text(", ".join(region.empty_because))
        text = f"No configuration is feasible:\nno room is left by {reason}"
        ax.text(0.5, 0.5, text, transform=ax.transAxes, ha="center", va="center", wrap=True)
    shown = [np.array(ends or (-np.pi, np.pi)) for ends in ranges]
    for k, (axis, ends) in enumerate(zip(("x", "y"), shown, strict=True)):
        values = np.concatenate([ends, q[:, k]]) * scales[k]
        room = 0.03 * np.ptp(values)
        in_degrees = unit == "deg" and problem.forms.kinds[k] == "revolute"
        if in_degrees:
            getattr(ax, f"{axis}axis").set_major_locator(figures.every(np.ptp(values)))
        name, written = problem.joint_names[k], "°" if in_degrees else problem.units[k]
        ax.set(
            **{
                f"{axis}lim": (values.min() - room, values.max() + room),
                f"{axis}label": f"{figures.symbol(name)} / {written}",
            }
        )
    if len(set(problem.forms.kinds)) == 1:
        ax.set_aspect("equal")
    if numbered is not None and numbered.vertices:
        corners = np.array([vertex.q for vertex in numbered.vertices])
        rounds = [ends is None for ends in ranges]  # the copy within one turn is shown there
        corners = np.where(rounds, nearest_turn(corners, 0), corners) * scales
        ax.plot(*corners.T, "o", color=INK, ms=4, zorder=5)
        figures.number_apart(ax, corners, corners.mean(axis=0))


def _space_panel(ax: Axes, robot: Robot, plane: tuple[int, int]) -> None:
    """Label the plane of motion and draw the upright half-spaces over everything else."""
    figures.plane_axes(ax, robot, plane=plane)
    ax.margins(0.12)
    ax.autoscale_view()
    window = ax.get_xlim(), ax.get_ylim()
    for line, names in _lines(robot, plane).items():
        colour = figures.boundary_colour(robot, names[0])
        normal = np.array(line[:2])
        foot, along = line[2] * normal, np.array([-normal[1], normal[0]])
        ax.axline(tuple(foot), tuple(foot + along), color=colour, lw=1.2, ls="--")
        # Write names at the right edge of the window, one above the other, where the line leaves.
        (_, right), (bottom, top), (across, up, offset) = *window, line
        if abs(up) > 0.5 and bottom <= (height := (offset - across * right) / up) <= top:
            text = "\n".join(map(figures.as_text, names))
            look: Any = {"ha": "right", "va": "bottom", "color": colour}
            ax.annotate(
                text, (right, height), (-3, 3), textcoords="offset points", annotation_clip=False,
                **look,
            )  # fmt: skip
    ax.set(xlim=window[0], ylim=window[1])


def _written(robot: Robot, q: Floats) -> str:
    """Joint values for a title, angles in degrees."""
    return ", ".join(
        f"{figures.symbol(joint.name)} = "
        + minus_signs(f"{value * joint.shown_scale:.4g}")
        + ("" if joint.turns else " ")
        + joint.unit(robot.length_unit, "°")
        for joint, value in zip(robot.joints, q, strict=True)
    )


def _lines(robot: Robot, plane: tuple[int, int]) -> dict[Line, list[str]]:
    """Return the lines at which upright half-spaces cut the plane, each with all of its names."""
    lines: dict[Line, list[str]] = {}
    for half_space in robot.used:
        if isinstance(half_space, HalfSpace):
            across, up = np.asarray(half_space.normal, dtype=float)[list(plane)].tolist()
            if np.hypot(across, up) > 1 - 1e-9:
                lines.setdefault((across, up, half_space.offset), []).append(half_space.name)
    return lines
