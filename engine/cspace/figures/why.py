"""One picture of an answer of `cspace.arms.why`: why a plan fails, or the margins of a path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cspace import figures
from cspace.arms.separations import JointTravel
from cspace.arms.why import Why, least_margins
from cspace.figures import symbol
from cspace.figures.pictures import picture
from cspace.region import find_region
from qbound.figures import COLLIDING, FEASIBLE, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BAR = 0.5
"""Height of a bar, of which a row is 1."""


def why_picture(why: Why) -> bytes:
    """Draw the margins along a path, a slice of two joints, or the ranges of the joints; as SVG."""
    if why.path is not None:
        return picture(1, lambda axes: draw_margins(axes[0], why), size=(5.0, 3.4))
    if why.separation is None and why.travels and len(why.differing) == 2:
        return picture(1, lambda axes: draw_slice(axes[0], why))
    height = 1.2 + 0.55 * len(why.robot.joints)
    return picture(1, lambda axes: draw_travels(axes[0], why), size=(5.0, height))


def draw_margins(ax: Axes, why: Why) -> None:
    """Draw the least margin to any boundary along a path, and the margin that is proved."""
    if why.path is None:
        raise ValueError("there is no path to draw")
    unit = why.robot.length_unit
    s, margins = least_margins(why.robot, why.path)
    steps = np.linalg.norm(np.diff(why.path, axis=0), axis=1)
    ax.plot(s, margins, color=FEASIBLE, label="least margin")
    ax.axhline(float(why.margin), color=INK, ls="--", lw=1, label="proved")
    for corner in np.cumsum(steps)[:-1]:
        ax.axvline(corner, color="#BBBBBB", lw=0.8)
    ax.set(xlabel="along the path", ylabel=f"margin / {unit}", xlim=(0, s[-1]))
    ax.set_ylim(bottom=0)
    ax.legend(loc="upper right")


def draw_slice(ax: Axes, why: Why) -> None:
    """Draw the region of the two joints in which both ends differ, the others held."""
    robot, moving = why.robot, why.differing
    held = {j: float(x) for j, x in enumerate(why.ends[0]) if j not in moving}
    region = find_region(robot, held)
    figures.draw_components(ax, region)
    scales = np.array([robot.joints[j].shown_scale for j in moving])
    for q, marker, name in zip(why.ends, "os", ("start", "goal"), strict=True):
        place = q[moving] * scales
        ax.plot(*place, marker, color=INK, label=name)
        ax.annotate(name, place, xytext=(6, 6), textcoords="offset points")
    ax.set(**dict(zip(("xlabel", "ylabel"), _labels(why, moving), strict=True)))


def _labels(why: Why, joints: Sequence[int]) -> list[str]:
    rows = [why.robot.joints[j] for j in joints]
    unit = why.robot.length_unit
    return [f"{symbol(joint.name)} / {joint.unit(unit, '°')}" for joint in rows]


def draw_travels(ax: Axes, why: Why) -> None:
    """Draw the travel of each joint as a bar, with blocked ranges and both ends."""
    robot = why.robot
    travels = why.travels or [
        JointTravel(j, joint.name, joint.limits, (), ()) for j, joint in enumerate(robot.joints)
    ]
    turning = [t for t in travels if robot.joints[t.joint].turns]
    shown = turning or list(travels)
    for row, travel in enumerate(shown):
        _draw_travel(ax, why, travel, -row)
    unit = robot.joints[shown[0].joint].unit(robot.length_unit, "°")
    names = [symbol(travel.name) for travel in shown]
    ax.set(
        yticks=[-k for k in range(len(shown))], yticklabels=names, xlabel=f"joint value / {unit}"
    )
    ax.set_ylim(0.6 - len(shown), 0.9)
    ax.grid(axis="y", visible=False)


def _draw_travel(ax: Axes, why: Why, travel: JointTravel, y: float) -> None:
    scale = why.robot.joints[travel.joint].shown_scale
    values = why.ends[:, travel.joint]
    low, high = travel.limits or (min(-np.pi, *values), max(np.pi, *values))
    parted = why.separation is not None and why.separation.travel.joint == travel.joint
    ax.barh(
        y, (high - low) * scale, BAR, low * scale, color=FEASIBLE, alpha=0.6 if parted else 0.25
    )
    for block in travel.blocks:
        for turn in (-1, 0, 1) if travel.limits is None else (0,):
            left, right = (x + turn * 2 * np.pi for x in (block.low, block.high))
            left, right = max(left, low), min(right, high)
            if left < right:
                ax.barh(
                    y, (right - left) * scale, BAR, left * scale, color=COLLIDING, hatch="///",
                    edgecolor="white", lw=0,
                )  # fmt: skip
    for value, marker, name in zip(values, "os", ("start", "goal"), strict=True):
        ax.plot(value * scale, y, marker, color=INK, ms=5)
        if parted or (not why.separation and y == 0):
            ax.annotate(
                name, (value * scale, y + BAR / 2), ha="center", va="bottom",
                xytext=(0, 1), textcoords="offset points",
            )  # fmt: skip
