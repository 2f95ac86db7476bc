"""The data of the explorer's page (not in the paper).

Python computes the exact and slow results (components, arcs, the largest feasible scale). The page
gets them as data, together with the coefficients from which it computes everything that moves.
``web/explorer.d.ts`` describes the same data to the scripts that read them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from cspace.arrays import Floats
from cspace.boundary.functions import clearance
from cspace.boundary.poses import bounded_bodies, bounds_bodies
from cspace.export.document import vertex_content, workspace_content
from cspace.geometry import polygon
from cspace.geometry.polygon import flatten
from cspace.measures.bodies import outline_in_frame, overlap_pairs
from cspace.measures.scaling import largest_safe_scale
from cspace.model.robot import BodyPair, Boundary, HalfSpace, Joint, Pair, Robot, Step
from cspace.region import Component, Region, Slices
from cspace.region.outline import Arc
from cspace.tolerances import FLAT_ARC, ZERO_AMPLITUDE
from cspace.version import __version__
from qbound.boundary import position
from qbound.forms import HarmonicForm

Data = dict[str, Any]

OBLIQUE: Final = np.array([0.45, -0.78, 0.44]) / np.linalg.norm([0.45, -0.78, 0.44])
"""Towards who looks at an arm that keeps to no plane: from the front, a little from above."""

IN_PLANE: Final = 1e-6
"""An axis that leans less than this, in rad, is drawn as if it did not."""

Walks = Sequence[Sequence[int]]


def explorer_data(region: Region, walks: Walks = (), row: Slices | None = None) -> Data:
    """Return the data of the explorer's page as JSON (schema qbound/explorer/2).

    Parameters
    ----------
    region : Region
        A region of a robot. A pair of points that windows stand for (`window_problem`) is respected
        if its points do not coincide.
    walks : sequence of sequences of int, optional
        Further orders in which a traversal visits the vertices, by index. An order with an unknown
        vertex is left out.
    row : Slices, optional
        Slices of the same two joints along one of the held joints, including the region itself.

    Returns
    -------
    dict
        Angles in radians, lengths in the robot's unit. A form is a list of terms. A term has a
        coefficient and, for each joint, the index of its factor in (1, cos q, sin q) or (1, q, q²).

    Raises
    ------
    ValueError
        If the region is not of a robot, or the row of slices is not of its joints or does not
        include it.
    """
    robot, problem = region.robot, region.problem
    free = list(problem.joints)
    q = robot.with_held(robot.home[free], problem.held)
    home = region.home_component if region.has_home else None
    views = [_view(robot.joints[j], home, k) for k, j in enumerate(free)]
    tool = position(robot, robot.tool)
    return {
        "schema": "qbound/explorer/2",
        "version": __version__,
        "name": robot.name,
        "feasible_by": robot.feasible_by,
        "safe": robot.whole_links,
        "length_unit": robot.length_unit,
        "free": free,
        "q": q.tolist(),
        "joints": [_joint(joint) for joint in robot.joints],
        "steps": [_step(step) for step in robot.steps],
        "points": [_point(robot, i) for i in range(len(robot.points))],
        "bodies": _bodies(robot),
        "flat": _flat(robot),
        "apart": _apart(robot),
        "boundaries": [_boundary(robot, b, problem.unstated) for b in _listed(robot)],
        "limits": _limits(region, free),
        "tool": [p.name for p in robot.points].index(robot.tool),
        "tool_forms": [_terms(tool[i]) for i in range(3)],
        "reach": robot.stretched(robot.tool),
        "plane": _plane(robot, q, free[0], free[1]),
        "views": views,
        "components": [_component(c, views) for c in region.components],
        "walls": _walls(region),
        "row": None if row is None else _row(region, row, views),
        "polygon": _polygon(region, walks),
        "workspace": workspace_content(region)["workspace"],
    }


# --- the robot -----------------------------------------------------------------------------------


def _joint(joint: Joint) -> Data:
    return {
        "name": joint.name,
        "kind": joint.kind,
        "limits": joint.limits,
        "wraps": joint.limits is None,
    }


def _step(step: Step) -> Data:
    return {
        "joint": step.joint,
        "sense": step.sense,
        "origin": step.origin.tolist(),
        "mount": step.mount.tolist(),
        "axis": step.axis.tolist(),
    }


def _point(robot: Robot, i: int) -> Data:
    point = robot.points[i]
    depth = robot.steps_to(point.frame)
    return {"name": point.name, "frame": depth, "at": point.at.tolist(), "radius": point.radius}


def _bodies(robot: Robot) -> list[Data]:
    """List every body; with its convex parts if the page checks whether it touches another one."""
    about = {body.name for boundary in _listed(robot) for body in bounded_bodies(robot, boundary)}
    about |= {name for pair in overlap_pairs(robot) for name in pair}
    return [
        {
            "name": body.name,
            "frame": robot.steps_to(body.frame),
            "outline": outline_in_frame(robot, body).tolist(),
            "parts": [
                {"corners": part.corners.tolist(), "radius": float(part.radius)}
                for part in (body.parts if body.name in about else ())
            ],
        }
        for body in (*robot.bodies, *robot.obstacles)
    ]


def _flat(robot: Robot) -> list[list[float]] | None:
    """Return the axes of the plane in which bodies keep apart; None if no bodies do."""
    about = any(map(bounds_bodies, _listed(robot))) or overlap_pairs(robot)
    axes: list[list[float]] | None = robot.plane.across.tolist() if about else None
    return axes


def _apart(robot: Robot) -> list[list[int]]:
    """List the pairs of bodies, by index, whose overlap the page shows."""
    order = [body.name for body in (*robot.bodies, *robot.obstacles)]
    return [[order.index(name) for name in pair] for pair in overlap_pairs(robot)]


def _body_boundary(robot: Robot, boundary: Boundary) -> Data:
    """Return the data of a boundary about bodies, which has no single form."""
    order = [body.name for body in (*robot.bodies, *robot.obstacles)]
    about = [order.index(body.name) for body in bounded_bodies(robot, boundary)]
    data = {"name": boundary.name, "used": boundary.used, "points": [], "form": []}
    if isinstance(boundary, BodyPair):
        return data | {"kind": "bodies", "bodies": about, "clearance": boundary.clearance}
    assert isinstance(boundary, HalfSpace)
    wall = {"normal": boundary.normal.tolist(), "offset": boundary.offset, "body": about[0]}
    return data | {"kind": "half-space"} | wall


def _listed(robot: Robot) -> list[Boundary]:
    """Return the boundaries in the order in which the page has them."""
    return list(dict.fromkeys((*robot.boundaries, *robot.used)))


def _boundary(robot: Robot, boundary: Boundary, replaced: set[str]) -> Data:
    if bounds_bodies(boundary):
        return _body_boundary(robot, boundary)
    names = [point.name for point in robot.points]
    data = {"name": boundary.name, "used": boundary.used}
    form = clearance(robot, boundary)
    if isinstance(boundary, HalfSpace):
        offset = boundary.offset + robot.point(boundary.point).radius
        data |= {"kind": "half-space", "points": [names.index(boundary.point)]}
        data |= {"normal": boundary.normal.tolist(), "offset": offset, "body": None}
    elif isinstance(boundary, Pair):
        required = robot.required_distance(boundary)
        if boundary.name in replaced:  # eq. (17): the points must not coincide
            form, required = form + required**2, 0.0
        data |= {"kind": "pair", "points": [names.index(p) for p in boundary.points]}
        data |= {"required": required}
    return data | {"form": _terms(form)}


def _terms(form: HarmonicForm) -> list[list[float]]:
    """List the terms of a form that are not zero: coefficient, then one index a joint."""
    places = np.argwhere(form.coefficients != 0)
    return [[float(form.coefficients[tuple(p)]), *p.tolist()] for p in places]


def _plane(robot: Robot, q: Floats, first: int, second: int) -> Data:
    """Choose the plane to draw: across the turning axis, upright, x to the right.

    The plane is fixed in the frame that carries the first free joint. If both joints move the arm
    out of every plane, the view is oblique, from above.
    """
    frames = robot.frames(q)
    one, other = robot.joints[first], robot.joints[second]
    carrier = frames.rotation(robot.base, one.parent)
    turn = carrier.T @ frames.rotation(robot.base, other.parent)
    axes = [one.mount @ one.axis, turn @ other.mount @ other.axis]
    kinds = [one.kind, other.kind]
    n = _across(axes, kinds)
    up = carrier.T @ np.array([0.0, 0.0, 1.0])
    oblique = not _keeps_to_plane(n, axes, kinds)
    if oblique:
        n = carrier.T @ OBLIQUE
    v = up - (up @ n) * n
    if np.linalg.norm(v) <= 1e-6:
        v = carrier.T @ np.array([0.0, 1.0, 0.0])
        v = v - (v @ n) * n
    v /= np.linalg.norm(v)
    u = np.cross(v, n)
    if (carrier @ u) @ np.array([1.0, 1e-3, 0.0]) < 0:
        u = -u
    view = {"u": u.tolist(), "v": v.tolist(), "n": n.tolist()}
    return {"frame": robot.steps_to(one.parent), **view, "oblique": oblique}


def _keeps_to_plane(n: Floats, axes: Sequence[Floats], kinds: Sequence[str]) -> bool:
    """Tell whether both joints move along the plane: turns about its normal, slides across it."""
    wanted = [1.0 if kind == "revolute" else 0.0 for kind in kinds]
    leans = [abs(abs(n @ a) - w) for a, w in zip(axes, wanted, strict=True)]
    return bool(max(leans) < IN_PLANE)


def _across(axes: Sequence[Floats], kinds: Sequence[str]) -> Floats:
    """Return the normal of the plane of motion: the axis of a turn, or across both slides."""
    for axis, kind in zip(axes, kinds, strict=True):
        if kind == "revolute":
            return np.asarray(axis, dtype=float)
    normal = np.cross(axes[0], axes[1])
    size = np.linalg.norm(normal)
    return np.asarray(normal / size) if size > ZERO_AMPLITUDE else np.array([0.0, 1.0, 0.0])


# --- the region ----------------------------------------------------------------------------------


def _view(joint: Joint, home: Component | None, k: int) -> Data:
    """Choose the range to draw: the limits, or one turn that shows the home component whole."""
    if joint.limits is not None:
        low, high = joint.limits
        return {"low": low, "high": high, "wraps": False}
    middle = 0.0
    if home is not None and not any(home.wraps):
        values = np.concatenate([arc.points[:, k] for loop in home.loops for arc in loop])
        if np.abs(values).max() > np.pi:
            middle = float(values.min() + values.max()) / 2
    return {"low": middle - np.pi, "high": middle + np.pi, "wraps": True}


def _limits(region: Region, free: Sequence[int]) -> list[Data]:
    """List the ends of both ranges; `middle` says which turn of an angle counts."""
    found: list[Data] = []
    for j, bounds, names in zip(free, region.problem.ranges, region.problem.limits, strict=True):
        if bounds is not None:
            for name, side, value in zip(names, (-1, 1), bounds, strict=True):
                row = {"name": name, "joint": j, "side": side, "value": value}
                found.append(row | {"middle": sum(bounds) / 2})
    return found


def _component(component: Component, views: Sequence[Data]) -> Data:
    centroid = component.centroid
    return {
        "home": component.contains_home,
        "area": component.area,
        "centroid": None if centroid is None else centroid.tolist(),
        "wraps": list(component.wraps),
        "loops": [[_arc(arc, views) for arc in loop] for loop in component.loops],
        "vertices": [vertex_content(vertex) for vertex in component.vertices],
    }


def _arc(arc: Arc, views: Sequence[Data]) -> Data:
    """Return as many of an arc's exact points as a drawing needs."""
    deviation = FLAT_ARC * min(view["high"] - view["low"] for view in views)
    s, _ = flatten(arc.at, deviation, len(arc.pieces.roots))
    points = arc.at(s).round(6).tolist()
    row = {"boundary": arc.boundary, "branch": arc.branch, "feature": arc.feature}
    return row | {"points": points}


def _walls(region: Region) -> list[int] | None:
    """List the boundaries that can bound a slice, by index; None if none was ruled out."""
    if not region.irrelevant:
        return None
    out = set(region.irrelevant)
    return [k for k, b in enumerate(_listed(region.robot)) if b.used and b.name not in out]


def _row(region: Region, row: Slices, views: Sequence[Data]) -> Data:
    """Describe a row of slices by rising value of one joint; others are held as in the region."""
    own, problems = region.problem, [each.problem for each in row.regions]
    others = {j: value for j, value in own.held.items() if j != row.along}
    alike = all({**problem.held, **others} == problem.held for problem in problems)
    if row.robot != region.robot or problems[0].joints != own.joints or not alike:
        raise ValueError("the row of slices is of other joints, or of other held values")
    if own.held[row.along] not in row.values.tolist():
        raise ValueError("the region is none of the slices of its row")
    return {
        "joint": row.along,
        "unit": region.area_unit.replace("^2", "²"),
        "slices": [
            {
                "value": float(row.values[k]),
                "walls": _walls(row.regions[k]),
                "components": [_outline(c, views) for c in row.regions[k].components],
            }
            for k in np.argsort(row.values, kind="stable")
        ],
    }


def _outline(component: Component, views: Sequence[Data]) -> Data:
    """Return the part of a component that is drawn for a slice."""
    whole = _component(component, views)
    return {key: whole[key] for key in ("home", "area", "loops")}


def _polygon(region: Region, walks: Walks) -> Data | None:
    """Return the vertex polygon of the home component, its largest feasible scale, its walks."""
    if not region.has_home:
        return None
    home = region.home_component
    if any(home.wraps) or len(home.loops) != 1 or len(home.vertices) < 3:
        return None
    vertices = np.array([vertex.q for vertex in home.vertices])
    problem = region.problem
    names = (*problem.names, *problem.contacts.boundaries)
    try:
        centre = polygon.centroid(vertices)
        largest = largest_safe_scale(vertices, centre, problem.forms, contacts=problem.contacts)
    except (ValueError, ArithmeticError):  # centroid not feasible, or an edge in a wall
        return None
    return {
        "vertices": vertices.tolist(),
        "centroid": centre.tolist(),
        "largest": largest.scale,
        "binds": None if largest.form < 0 else names[largest.form],
        "walks": _orders(len(vertices), walks),
    }


def _orders(m: int, others: Walks) -> list[list[int]]:
    """List orders in which to visit m vertices: once round (Figure 7), and the requested ones."""
    return [[*range(m), 0], *(list(walk) for walk in others if max(walk) < m)]
