"""Workspaces as others read them: as JSON (schema qbound/workspace/2), the same in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from qbound.export.document import loop_content
from qbound.export.formats import heading
from qbound.model.robot import Robot
from qbound.tolerances import ROUNDED_AREA
from qbound.units import amount, counted, joint_text
from qbound.workspace.areas import Aspect, PlaceReport, WorkspaceReport
from qbound.workspace.passage import Passage


def workspace_document(found: WorkspaceReport) -> dict[str, Any]:
    """Return the JSON form of a report on a workspace."""
    workspace, region = found.workspace, found.workspace.region
    return {
        **heading("qbound/workspace/2", region.robot),
        "rule": region.problem.rule,
        "joints": list(region.problem.joint_names),
        "length_unit": region.robot.length_unit,
        "plane": workspace.arm.axes.tolist(),
        "workspace": {
            "area": workspace.area,
            "covered_twice": workspace.covered_twice,
            "sides": {f"{side:+d}": area for side, area in workspace.sides.items()},
            "safe_and_unsafe": found.safe_and_unsafe,
        },
        "aspects": [_aspect(aspect) for aspect in workspace.aspects],
        "at": [_place(at) for at in found.places],
        "go": found.passage and _passage(found.passage),
    }


def workspace_lines(found: WorkspaceReport) -> Iterator[str]:
    """Say in sentences how large a workspace is, and what was asked of it."""
    workspace, robot = found.workspace, found.workspace.region.robot
    joints, unit = workspace.region.problem.joints, robot.length_unit
    twice = f"{workspace.covered_twice:.9g} {unit}^2 of it in both postures"
    yield f"area {workspace.area:.9g} {unit}^2, {twice}"
    both = amount(found.safe_and_unsafe, f"{unit}^2", ROUNDED_AREA * workspace.area, digits=9)
    yield f"reached safely in one posture and unsafely in another: {both}"
    for aspect in workspace.aspects:
        yield f"  det J {'>' if aspect.side > 0 else '<'} 0: image {aspect.image:.9g} {unit}^2"
    for at in found.places:
        x, z = at.place
        yield f"at ({x:g}, {z:g}) {unit}: {counted(at.safe, 'posture')} in home's component"
        for posture, component in at.postures:
            yield f"  {joint_text(robot, posture.q, joints)}: {_state(component)}"
    if found.passage is not None:
        yield from _passage_lines(robot, joints, found.passage)


def _aspect(aspect: Aspect) -> dict[str, Any]:
    return {
        "component": aspect.component,
        "side": aspect.side,
        "image": aspect.image,
        "swept": aspect.swept,
        "loops": [loop_content(loop) for loop in aspect.region.loops],
    }


def _place(at: PlaceReport) -> dict[str, Any]:
    return {
        "place": list(at.place),
        "safe_postures": at.safe,
        "postures": [
            {"q": posture.q.tolist(), "side": posture.side, "component": component}
            for posture, component in at.postures
        ],
    }


def _passage(passage: Passage) -> dict[str, Any]:
    left = passage.exit
    return {
        "possible": passage.possible,
        "components": [passage.start, passage.goal],
        "separated_by": [loop_content(loop) for loop in passage.loops],
        "straight_path_leaves": left and {"q": left.q.tolist(), "boundary": left.boundary},
    }


def _passage_lines(robot: Robot, joints: tuple[int, int], passage: Passage) -> Iterator[str]:
    answer, loops = "yes" if passage.possible else "no", len(passage.loops)
    yield f"go: {answer}, from {_state(passage.start)} to {_state(passage.goal)}"
    if loops:
        what = "the loop" if loops == 1 else f"one of {loops} loops"
        yield f"  every path crosses {what} of {', '.join(passage.boundaries)}"
    if passage.exit is not None:
        place = joint_text(robot, passage.exit.q, joints)
        yield f"  the straight path leaves at {place}, through {passage.exit.boundary}"


def _state(component: int | None) -> str:
    return "not safe" if component is None else f"component {component}"
