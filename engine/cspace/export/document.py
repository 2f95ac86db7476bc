"""Regions and workspaces as plain data, for JSON; workspaces in words too."""

from collections.abc import Iterator, Sequence
from typing import Any

from cspace.export.configuration import feature_content
from cspace.export.formats import heading
from cspace.region import Component, NoHomeError, Region, Slices, UnresolvedError
from cspace.region.arcs import Arc
from cspace.tolerances import ROUNDED_AREA
from cspace.units import amount, counted, joint_text
from cspace.workspace.areas import WorkspaceReport, find_workspace
from cspace.workspace.planar import NoPlanarWorkspaceError, planar_arm


def region_document(region: Region) -> dict[str, Any]:
    """Return a region as data for JSON, schema qbound/region/4: rad, the robot's length unit."""
    content = {
        **heading("qbound/region/4", region.robot),
        "joints": list(region.problem.joint_names),
    }
    return content | _region_content(region) | workspace_content(region)


def slices_document(slices: Slices) -> dict[str, Any]:
    """Return a row of slices as data for JSON, schema qbound/slices/2; units as for a region."""
    joints, first = slices.robot.joints, slices.regions[0].problem
    held = {joints[j].name: value for j, value in first.held.items() if j != slices.along}
    rows = zip(slices.values.tolist(), slices.regions, strict=True)
    return {
        **heading("qbound/slices/2", slices.robot),
        "joints": list(first.joint_names),
        "held": held,
        "along": joints[slices.along].name,
        "slices": [{"value": value, **_region_content(region)} for value, region in rows],
    }


def _region_content(region: Region) -> dict[str, Any]:
    content: dict[str, Any] = {
        "home_component": None,
        "feasible_area": None,
        "home": home_content(region),
        "components": [],
        "unresolved": list(region.unresolved),
    }
    if region.unresolved:
        return content
    content["home_component"] = 0 if region.has_home else None
    content["feasible_area"] = region.area
    content["components"] = [_component_content(component) for component in region.components]
    because = {"empty_because": list(region.empty_because)} if region.empty_because else {}
    return content | because


def loop_content(loop: Sequence[Arc]) -> dict[str, Any]:
    """Return a boundary loop as data for JSON."""
    return {"arcs": [_arc_content(arc) for arc in loop]}


def _arc_content(arc: Arc) -> dict[str, Any]:
    return {
        "boundary": arc.boundary,
        **feature_content(arc.feature),
        "branch": arc.branch,
        "from": arc.start.tolist(),
        "to": arc.end.tolist(),
        **({"also": [list(pair) for pair in arc.also]} if arc.also else {}),
    }


def workspace_content(region: Region) -> dict[str, Any]:
    """Return the workspace of the home component, or the reason why there is none."""
    robot, problem = region.robot, region.problem
    try:
        arm = planar_arm(robot, problem.held)
        found = find_workspace(arm, problem, robot.home[list(problem.joints)])
    except (NoPlanarWorkspaceError, NoHomeError, UnresolvedError) as reason:
        return {"workspace": None, "workspace_reason": str(reason)}
    return {"workspace": {"area": found.area, "covered_twice": found.covered_twice}}


def home_content(region: Region) -> dict[str, Any]:
    """Return the home pose, what it violates, and what it touches if it is in no component."""
    problem, robot = region.problem, region.robot
    home = robot.home[list(problem.joints)]
    found = list(zip(region.boundaries, region.margins(home).tolist(), strict=True))
    content = {
        "q": robot.with_held(home, problem.held).tolist(),
        "feasible": all(margin >= 0 for _, margin in found),
        "violated": [{"boundary": name, "margin": m} for name, m in found if m < 0],
    }
    if (
        content["feasible"] and not region.unresolved and not region.has_home
    ):  # what it touches leaves no room
        content["touches"] = [name for name, margin in found if margin == 0]
    return content


def _component_content(component: Component) -> dict[str, Any]:
    return {
        "contains_home": component.contains_home,
        "area": component.area,
        "centroid": None if component.centroid is None else component.centroid.tolist(),
        "wraps": list(component.wraps),
        "vertices": [
            {"q": v.q.tolist(), "boundaries": list(v.boundaries), "error": v.error}
            for v in component.vertices
        ],
        "loops": [loop_content(loop) for loop in component.loops],
    }


# --- workspaces -----------------------------------------------------------------------------------


def workspace_document(report: WorkspaceReport) -> dict[str, Any]:
    """Return the JSON form of a report on a workspace."""
    workspace, region, go = report.workspace, report.workspace.region, report.passage
    left = go and go.exit
    return {
        **heading("qbound/workspace/3", region.robot),
        "joints": list(region.problem.joint_names),
        "length_unit": region.robot.length_unit,
        "plane": workspace.arm.axes.tolist(),
        "workspace": {
            "area": workspace.area,
            "covered_twice": workspace.covered_twice,
            "sides": {f"{side:+d}": area for side, area in workspace.sides.items()},
            "safe_and_unsafe": report.safe_and_unsafe,
        },
        "aspects": [
            {
                "component": aspect.component,
                "side": aspect.side,
                "image": aspect.image,
                "swept": aspect.swept,
                "loops": [loop_content(loop) for loop in aspect.region.loops],
            }
            for aspect in workspace.aspects
        ],
        "at": [
            {
                "place": list(at.place),
                "safe_postures": at.safe,
                "postures": [
                    {"q": posture.q.tolist(), "side": posture.side, "component": component}
                    for posture, component in at.postures
                ],
            }
            for at in report.places
        ],
        "go": go
        and {
            "possible": go.possible,
            "components": [go.start, go.goal],
            "separated_by": [loop_content(loop) for loop in go.loops],
            "straight_path_leaves": left and {"q": left.q.tolist(), "boundary": left.boundary},
        },
    }


def workspace_lines(report: WorkspaceReport) -> Iterator[str]:
    """Yield sentences: the size of a workspace, and the answers to questions about it."""
    workspace, robot = report.workspace, report.workspace.region.robot
    joints, unit = workspace.region.problem.joints, robot.length_unit
    twice = f"{workspace.covered_twice:.9g} {unit}^2 of it in both postures"
    yield f"area {workspace.area:.9g} {unit}^2, {twice}"
    both = amount(report.safe_and_unsafe, f"{unit}^2", ROUNDED_AREA * workspace.area, digits=9)
    yield f"reached in a feasible posture and in an infeasible one: {both}"
    for aspect in workspace.aspects:
        yield f"  det J {'>' if aspect.side > 0 else '<'} 0: image {aspect.image:.9g} {unit}^2"
    for at in report.places:
        x, z = at.place
        yield f"at ({x:g}, {z:g}) {unit}: {counted(at.safe, 'posture')} in home's component"
        for posture, component in at.postures:
            yield f"  {joint_text(robot, posture.q, joints)}: {_state(component)}"
    if (go := report.passage) is not None:
        answer = "yes" if go.possible else "no"
        yield f"go: {answer}, from {_state(go.start)} to {_state(go.goal)}"
        if go.loops:
            what = "the loop" if len(go.loops) == 1 else f"one of {len(go.loops)} loops"
            yield f"  every path crosses {what} of {', '.join(go.boundaries)}"
        if go.exit is not None:
            place = joint_text(robot, go.exit.q, joints)
            yield f"  the straight path leaves at {place}, through {go.exit.boundary}"


def _state(component: int | None) -> str:
    return "not feasible" if component is None else f"component {component}"
