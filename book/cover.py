"""Draw the picture of the front page and of the README: python book/cover.py [FILE].

Left the joint values that are safe, right where the tool goes over them, by the exact workspace.
"""

import re
import sys
from io import StringIO
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from qbound import figures, find_region, load_robot
from qbound.figures.workspace import draw_patches
from qbound.workspace.areas import find_workspace
from qbound.workspace.planar import planar_arm

TARGET = Path(__file__).parent / "_static" / "cover.svg"
PATH, NUMBER = re.compile(r' d="[^"]*"'), re.compile(r"-?\d+\.\d{3,}")
POSE = np.radians([25.0, -75.0])


def draw() -> plt.Figure:
    robot = load_robot("minervabot-v2")
    region = find_region(robot)
    workspace = find_workspace(planar_arm(robot), region.problem, robot.home)
    figure, (joints, space) = plt.subplots(1, 2, figsize=(10.4, 4.6), width_ratios=[1, 1.35])
    figures.draw_components(joints, region)
    figures.joint_axes(joints, robot)
    singular = np.degrees(workspace.arm.singularity[0] - np.pi)
    joints.axhline(singular, color=figures.COLLIDING, ls=":", lw=2)
    joints.plot(*np.degrees(POSE), "P", color=figures.INK, ms=9, mec="white", zorder=7)
    joints.set_title("Safe joint values")
    draw_patches(space, workspace)
    figures.draw_robot(space, robot, POSE)
    figures.plane_axes(space, robot, [(-63, 63), (-4, 83)])
    space.axhline(0, color=figures.INK, lw=1)
    space.set_title("Where the tool goes: light in one posture, dark in two")
    return figure


def main(target: Path = TARGET) -> None:
    buffer = StringIO()
    with plt.rc_context(figures.STYLE):
        draw().savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    plt.close("all")
    target.write_text(PATH.sub(rounded, buffer.getvalue()), encoding="utf-8")


def rounded(path: re.Match[str]) -> str:
    """Round the points of a path to hundredths of a typographic point: half the bytes."""
    return NUMBER.sub(lambda number: f"{float(number[0]):.2f}", path[0])


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET)
