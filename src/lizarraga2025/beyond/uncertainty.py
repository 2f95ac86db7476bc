"""What the printed digits leave open of chapters 11 to 13, and the record of all chapters.

Usage: python -m lizarraga2025.beyond.uncertainty FILE
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, Final

import numpy as np

from cspace import find_region, load_robot
from cspace.boundary.functions import clearance
from cspace.model.robot import Robot
from cspace.region import Component, clearance_problem, margins
from cspace.workspace.areas import find_workspace
from cspace.workspace.planar import planar_arm
from lizarraga2025 import printed, uncertainty
from lizarraga2025.beyond.evidence import with_clearance, with_whole_bodies
from lizarraga2025.recorded import DRAWS
from lizarraga2025.results import write_json
from lizarraga2025.uncertainty import Value, Values, chapters_2_to_9, corrected, study
from qbound import window_region
from qbound.circle import circle_roots

SCHEMA: Final = "qbound/input-uncertainty/1"
DEG2: Final = np.degrees(1) ** 2


def every_chapter(robot: Robot) -> Values:
    """Return the results of chapters 2 to 9 and the headline numbers of chapters 11 to 13."""
    found = chapters_2_to_9(robot)
    for part in (_bodies, _regions, _workspace):
        found |= part(robot, found)
    return found


def _bodies(robot: Robot, before: Values) -> Values:
    """Chapter 11: bodies stay as they were rebuilt, while joints and points move."""
    found: Values = {}
    axes: dict[str, Any] = {"0": [0.0, 1.0], "1": robot.joints[1].origin[[0, 2]]}
    axes["2"] = robot.point("3").at[[0, 2]]
    points = {"0": ("8", "6"), "1": ("9", "7", "12", "10"), "2": ("13", "11")}
    for frame, names in points.items():
        unit = axes[frame] / np.linalg.norm(axes[frame])
        places = np.array([robot.point(name).at[[0, 2]] for name in names])
        along, across = places @ unit, places @ [unit[1], -unit[0]]
        half = np.abs(across).mean()
        ends = along.reshape(-1, 2).mean(axis=1).repeat(2)
        misfit = np.hypot(along - ends, np.abs(across) - half)
        found[f"fit.{frame}"] = Value([half, *sorted(set(ends)), misfit.max()])
    by_whole = find_region(with_whole_bodies(robot))
    area, sides = by_whole.area, _sides(by_whole.home_component)
    lost = area - before["paper.area"].value
    found["printed.area.bodies"] = Value(area, sides)
    found["area.bodies.degrees"] = Value(area * DEG2, sides)
    found["free.bodies.floor"] = Value(100 * area / (2 * np.pi) ** 2, sides)
    found["printed.lost"] = Value(lost, sides + before["paper.area"].decided_by)
    found["lost.degrees.paper"] = Value(lost * DEG2, sides + before["paper.area"].decided_by)
    return found


def _sides(component: Component) -> tuple[str, ...]:
    return tuple(sorted(arc.boundary for loop in component.loops for arc in loop))


def _regions(robot: Robot, _: Values) -> Values:
    region = find_region(robot)
    home, parts = region.home_component, region.components
    sides = tuple(name for part in parts for name in _sides(part))
    found = {"clearance.components": Value(len(parts))}
    found["clearance.area"] = Value(home.area, _sides(home))
    found["clearance.area.deg"] = Value(home.area * DEG2, _sides(home))
    found["clearance.centroid"] = Value(np.degrees(np.asarray(home.centroid)), _sides(home))
    found["clearance.area.all"] = Value(region.area, sides)
    found["clearance.area.others"] = Value(region.area - home.area, sides)
    found["clearance.share"] = Value(100 * region.area / (2 * np.pi) ** 2, sides)
    found["clearance.share.home"] = Value(100 * home.area / region.area, sides)
    found["safe.degrees.all"] = Value(region.area * DEG2, sides)
    for i, part in enumerate(parts, start=1):
        names = sorted({arc.boundary for arc in part.loops[0]})
        found[f"component.{i}.boundaries"] = Value(", ".join(names))
        if i > 1:
            found[f"component.{i}.area"] = Value(part.area, _sides(part))
    own = np.array([vertex.q for vertex in home.vertices])
    shift = max(np.hypot(*(own - q).T).min() for q in window_region(robot).polygon)
    found["clearance.vertices.shift"] = Value(np.degrees(shift), _sides(home))
    for pair in robot.used_pairs:
        form = clearance(robot, pair.name)
        c, a, b = form.along(form.joints()[0], robot.home)
        width = 2 * np.pi - 2 * float(circle_roots(a, b, -c).alpha)
        found[f"wall.{pair.name}.width"] = Value(np.degrees(width))
    for gap in (0.1, 0.08, 0.01, 0.001, 0.0):
        thin = find_region(with_clearance(robot, gap))
        walls = tuple(sorted({name for part in thin.components for name in _sides(part)}))
        found[f"clearance.{gap}.components"] = Value(len(thin.components))
        if gap != 0.1:
            found[f"clearance.{gap}.home"] = Value(thin.home_component.area, walls)
    least = min(margin for _, margin in margins(robot, np.radians([20, -45])))
    found["pose.margin"] = Value(least)
    mended = find_region(corrected(robot)).components
    found["mended.area.points"] = Value(window_region(corrected(robot)).area)
    found["areas.minervabot-v2-corrected"] = Value([part.area for part in mended])
    return found


def _workspace(robot: Robot, before: Values) -> Values:
    arm, problem = planar_arm(robot), clearance_problem(robot)
    link_1, both = before["link1.length"].value, before["reach.stretched"].value
    found = {"singular.q2.folded": Value(before["singular.q2"].value + 180)}
    found["reach.folded"] = Value(link_1 - (both - link_1))
    found["safe_and_unsafe.paper"] = before["workspace.covered_once.paper"]
    home = find_workspace(arm, problem, robot.home)
    everywhere = find_workspace(arm, problem, robot.home, every=True)
    for name, value in (
        ("workspace.area.clearance", home.area),
        ("workspace.covered_twice.clearance", home.covered_twice),
        ("workspace.covered_once.clearance", home.area - home.covered_twice),
        ("safe_and_unsafe.clearance", everywhere.area - everywhere.covered_twice),
        ("workspace.area.all.clearance", everywhere.area),
    ):
        found[name] = Value(value, before["clearance.area"].decided_by)
    return found


def record(robot: Robot) -> dict[str, Any]:
    """Return the content of the record."""
    with ProcessPoolExecutor(2) as pool:
        found = study(robot, every_chapter, lambda f, arms: pool.map(f, arms, chunksize=10))
    head = {"schema": SCHEMA, "draws": DRAWS, "seed": uncertainty.SEED}
    head |= {"half_digit": printed.HALF_DIGIT}
    by_choice = [{"id": name, "input_uncertainty": 0.0} for name in uncertainty.BY_CHOICE]
    return head | {"quantities": [*found, *by_choice]}


if __name__ == "__main__":
    write_json(Path(sys.argv[1]), record(load_robot("minervabot-v2")))
