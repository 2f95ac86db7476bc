"""What the printed digits leave open of chapters 11 to 13, and the record of all chapters.

Usage: python -m lizarraga2025.beyond.uncertainty FILE
"""

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
from lizarraga2025.uncertainty import Numbers, Value, Values, as_values, chapters_2_to_9
from qbound import window_region
from qbound.circle import TURN, circle_roots
from qbound.workspace import PLANE

SCHEMA: Final = "qbound/input-uncertainty/1"
DEG2: Final = np.degrees(1) ** 2


def every_chapter(robot: Robot) -> Values:
    """Return the results of chapters 2 to 9 and the headline numbers of chapters 11 to 13."""
    found = chapters_2_to_9(robot)
    for part in (_bodies, _regions, _workspace):
        found |= as_values(part(robot, found))
    return found


def _bodies(robot: Robot, before: Values) -> Numbers:
    """Chapter 11: bodies stay as they were rebuilt, while joints and points move."""
    found: Numbers = {}
    axes: dict[str, Any] = {"0": [0.0, 1.0], "1": robot.joints[1].origin[PLANE]}
    axes["2"] = robot.point("3").at[PLANE]
    points = {"0": ("8", "6"), "1": ("9", "7", "12", "10"), "2": ("13", "11")}
    for frame, names in points.items():
        unit = axes[frame] / np.linalg.norm(axes[frame])
        places = np.array([robot.point(name).at[PLANE] for name in names])
        along, across = places @ unit, places @ [unit[1], -unit[0]]
        half = np.abs(across).mean()
        ends = along.reshape(-1, 2).mean(axis=1).repeat(2)
        misfit = np.hypot(along - ends, np.abs(across) - half)
        found[f"fit.{frame}"] = [half, *sorted(set(ends)), misfit.max()]
    by_whole, points_alone = find_region(with_whole_bodies(robot)), before["paper.area"]
    area, sides = by_whole.area, _sides(by_whole.home_component)
    found["printed.area.bodies"] = Value(area, sides)
    found["area.bodies.degrees"] = Value(area * DEG2, sides)
    found["free.bodies.floor"] = Value(100 * area / TURN**2, sides)
    lost, sides = area - points_alone.value, sides + points_alone.decided_by
    found["printed.lost"] = Value(lost, sides)
    return found | {"lost.degrees.paper": Value(lost * DEG2, sides)}


def _sides(*parts: Component) -> tuple[str, ...]:
    """Return what bounds some components, part by part, an arc a name."""
    names = (sorted(arc.boundary for loop in part.loops for arc in loop) for part in parts)
    return tuple(name for part in names for name in part)


def _regions(robot: Robot, _: Values) -> Numbers:
    region = find_region(robot)
    home, parts, whole = region.home_component, region.components, region.area
    centre = np.degrees(np.asarray(home.centroid))
    found: Numbers = {"clearance.components": len(parts)}
    found["clearance.area"] = Value(home.area, _sides(home))
    found["clearance.area.deg"] = Value(home.area * DEG2, _sides(home))
    found["clearance.centroid"] = Value(centre, _sides(home))
    of_all = {
        "clearance.area.all": whole,
        "clearance.area.others": whole - home.area,
        "clearance.share": 100 * whole / TURN**2,
        "clearance.share.home": 100 * home.area / whole,
        "safe.degrees.all": whole * DEG2,
    }
    found |= as_values(of_all, _sides(*parts))
    for i, part in enumerate(parts, start=1):
        found[f"component.{i}.boundaries"] = ", ".join(sorted({a.boundary for a in part.loops[0]}))
        if i > 1:
            found[f"component.{i}.area"] = Value(part.area, _sides(part))
    own = np.array([vertex.q for vertex in home.vertices])
    shift = max(np.hypot(*(own - q).T).min() for q in window_region(robot).polygon)
    found["clearance.vertices.shift"] = Value(np.degrees(shift), _sides(home))
    for pair in robot.used_pairs:
        form = clearance(robot, pair.name)
        c, a, b = form.along(form.joints()[0], robot.home)
        width = TURN - 2 * float(circle_roots(a, b, -c).alpha)
        found[f"wall.{pair.name}.width"] = np.degrees(width)
    for gap in (0.1, 0.08, 0.01, 0.001, 0.0):
        thin = find_region(with_clearance(robot, gap))
        walls = tuple(sorted(set(_sides(*thin.components))))
        found[f"clearance.{gap}.components"] = len(thin.components)
        if gap != 0.1:
            found[f"clearance.{gap}.home"] = Value(thin.home_component.area, walls)
    found["pose.margin"] = min(margin for _, margin in margins(robot, np.radians([20, -45])))
    mended = uncertainty.corrected(robot)
    found["mended.area.points"] = window_region(mended).area
    areas = [part.area for part in find_region(mended).components]
    return found | {"areas.minervabot-v2-corrected": areas}


def _workspace(robot: Robot, before: Values) -> Numbers:
    arm, problem = planar_arm(robot), clearance_problem(robot)
    link_1, both = before["link1.length"].value, before["reach.stretched"].value
    found: Numbers = {"singular.q2.folded": before["singular.q2"].value + 180}
    found["reach.folded"] = link_1 - (both - link_1)
    found["safe_and_unsafe.paper"] = before["workspace.covered_once.paper"]
    home = find_workspace(arm, problem, robot.home)
    everywhere = find_workspace(arm, problem, robot.home, every=True)
    areas = {
        "workspace.area.clearance": home.area,
        "workspace.covered_twice.clearance": home.covered_twice,
        "workspace.covered_once.clearance": home.area - home.covered_twice,
        "safe_and_unsafe.clearance": everywhere.area - everywhere.covered_twice,
        "workspace.area.all.clearance": everywhere.area,
    }
    return found | as_values(areas, before["clearance.area"].decided_by)


def record(robot: Robot) -> dict[str, Any]:
    """Return the content of the record."""
    with ProcessPoolExecutor(2) as pool:
        found = uncertainty.study(
            robot, every_chapter, lambda f, arms: pool.map(f, arms, chunksize=10)
        )
    head = {"schema": SCHEMA, "draws": DRAWS, "seed": uncertainty.SEED}
    head |= {"half_digit": printed.HALF_DIGIT}
    by_choice = [{"id": name, "input_uncertainty": 0.0} for name in uncertainty.BY_CHOICE]
    return head | {"quantities": [*found, *by_choice]}


if __name__ == "__main__":
    write_json(Path(sys.argv[1]), record(load_robot("minervabot-v2")))
