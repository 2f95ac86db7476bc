"""Draw the picture of the front page and of the README: python book/cover.py [FILE].

The region that is feasible by the windows of Table 6, with its six points; and, over the places
that the tool reaches, the tool's path once round these points, scaled as in Figure 7.
Side by side in FILE, one below the other for a phone in FILE's neighbour "...-narrow".
"""

import re
import sys
from io import StringIO
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from cspace import Region, Robot, figures, load_robot
from cspace.figures.workspace import draw_patches
from cspace.region import solve, window_problem
from cspace.workspace.areas import Workspace, find_workspace
from cspace.workspace.planar import planar_arm
from lizarraga2025.choices import SCALE
from lizarraga2025.evidence.joint_region import scaled, vertices
from lizarraga2025.evidence.tool_paths import AROUND, path_through, stretched
from qbound import window_region

TARGET = Path(__file__).parent / "_static" / "cover.svg"
PATH, NUMBER = re.compile(r' d="[^"]*"'), re.compile(r"-?\d+\.\d{3,}")
POSE = np.radians([25.0, -75.0])
LOOP = {"color": "#2f7d4f", "lw": 1.6}


def draw_joint_space(ax: plt.Axes, region: Region) -> None:
    """Draw the region, its six points, the scaled polygon, the singular line and a pose."""
    figures.draw_components(ax, region)
    figures.joint_axes(ax, region.robot)
    ax.axhline(np.degrees(stretched()), color=figures.COLLIDING, ls=":", lw=2)
    ax.plot(*np.degrees(scaled(SCALE)[list(AROUND)]).T, **LOOP)
    corners = np.degrees(vertices())
    ax.plot(*corners.T, "o", color=figures.INK, ms=5, zorder=6)
    for number, corner in enumerate(corners, start=1):
        outward = 11 * np.sign(corner - corners.mean(axis=0))
        name = {"textcoords": "offset points", "ha": "center", "va": "center"}
        ax.annotate(str(number), corner, outward, weight="bold", **name)
    ax.plot(*np.degrees(POSE), "P", color=figures.INK, ms=9, mec="white", zorder=7)
    ax.set_title("Feasible joint values and their six corners")


def draw_plane(ax: plt.Axes, robot: Robot, workspace: Workspace) -> None:
    """Draw the arm and the tool's path over the places that the tool reaches."""
    draw_patches(ax, workspace)
    ax.plot(*path_through(AROUND).tool.T, **LOOP)
    figures.draw_robot(ax, robot, POSE)
    figures.plane_axes(ax, robot, [(-63, 63), (-4, 83)])
    ax.axhline(0, color=figures.INK, lw=1)
    ax.set_title(
        "Where the tool goes: light in one posture, dark\nin two; green: along the scaled polygon"
    )


def save(target: Path, robot: Robot, region: Region, workspace: Workspace, narrow: bool) -> None:
    """Draw both pictures into one file, for a wide page or for a narrow one."""
    rows, columns = (2, 1) if narrow else (1, 2)
    size = (4.6, 7.9) if narrow else (10.4, 4.6)
    widths = [1] if narrow else [1, 1.35]
    heights = [1.25, 1] if narrow else [1]
    figure, (joints, plane) = plt.subplots(
        rows, columns, figsize=size, width_ratios=widths, height_ratios=heights
    )
    draw_joint_space(joints, region)
    draw_plane(plane, robot, workspace)
    buffer = StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    target.write_text(PATH.sub(rounded, buffer.getvalue()), encoding="utf-8")


def rounded(path: re.Match[str]) -> str:
    """Round the points of a path to hundredths of a typographic point: half the bytes."""
    return NUMBER.sub(lambda number: f"{float(number[0]):.2f}", path[0])


def main(target: Path = TARGET) -> None:
    robot = load_robot("minervabot-v2")
    region = solve(window_problem(window_region(robot)))
    workspace = find_workspace(planar_arm(robot), region.problem, robot.home)
    with plt.rc_context(figures.STYLE):
        for file, narrow in ((target, False), (target.with_stem(f"{target.stem}-narrow"), True)):
            save(file, robot, region, workspace, narrow)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET)
