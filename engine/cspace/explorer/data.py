"""The data of a live figure: one robot, two free joints, everything as forms of those two.

The page knows no kinematics. A frame of the arm is eight forms (where its origin and its axes stand
in the picture) and a boundary of points is one, so that the page evaluates ``x' M y``. Mounts,
chains, held joints, parallelograms and slides stay here, and so do the regions.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.boundary.functions import clearance
from cspace.boundary.poses import bounded_bodies, bounds_bodies
from cspace.export.outlines import polygons
from cspace.forms.harmonic import restrict
from cspace.geometry import polygon
from cspace.geometry.polygon import flatten
from cspace.measures.bodies import outline_in_frame, overlap_pairs
from cspace.measures.scaling import largest_safe_scale
from cspace.model.robot import BodyPair, Boundary, HalfSpace, Joint, Pair, Robot
from cspace.region import Component, Region, Slices
from cspace.region.arcs import Arc
from cspace.tolerances import FLAT_ARC, ZERO_AMPLITUDE
from qbound.boundary import pair_vector
from qbound.forms import Kind, basis

Data = dict[str, Any]
Walks = Sequence[Sequence[int]]

OBLIQUE: Final = np.array([0.45, -0.78, 0.44]) / np.linalg.norm([0.45, -0.78, 0.44])
"""Towards who looks at an arm that keeps to no plane: from the front, a little from above."""

IN_PLANE: Final = 1e-6
"""An axis that leans less than this, in rad, is drawn as if it did not."""

SCHEMA: Final = "cspace/figure/1"

NOTHING: Final = 1e-12
"""A coefficient that is smaller, compared with the robot's reach, is rounding."""


def figure_data(region: Region, walks: Walks = (), row: Slices | None = None) -> Data:
    """Return the data of a live figure as JSON (schema cspace/figure/1).

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
        Angles in radians, lengths in the robot's unit. A form is a table of 3 by 3 numbers: rows
        for (1, cos q, sin q) or (1, q, q²) of the first free joint, columns for the second.

    Raises
    ------
    ValueError
        If the region is not of a robot, or the row of slices is not of its joints or does not
        include it.
    """
    robot = region.robot
    return {
        "schema": SCHEMA,
        "name": robot.name,
        "unit": robot.length_unit,
        "reach": robot.stretched(robot.tool),
        "word": _word(robot),
        "toolPoint": [point.name for point in robot.points].index(robot.tool),
        "points": [
            {"name": point.covers or point.name, "frame": robot.steps_to(point.frame)}
            | {"at": point.at.tolist(), "radius": point.radius}
            for point in robot.points
        ],
        "bodies": _bodies(robot),
        "apart": _apart(robot),
        "polygon": _polygon(region, walks),
        "windows": _windows(robot) if region.problem.unstated else [],
        "row": None if row is None else _slices(region, row),
        **_of_slice(region),
    }


def _of_slice(region: Region) -> Data:
    """Return what hangs on the values of held joints: forms, their joints, and the regions."""
    robot, problem = region.robot, region.problem
    first, second = free = list(problem.joints)
    q = robot.with_held(robot.home[free], problem.held)
    plane = _plane(robot, q, first, second)
    across = np.array([plane["u"], plane["v"]])
    across = across @ robot.frames(q).rotation(robot.base, robot.joints[first].parent).T
    home = region.home_component if region.has_home else None
    views = [_view(robot.joints[j], home, k) for k, j in enumerate(free)]
    frames = _frames(robot, free, q, across)
    tool = robot.point(robot.tool)
    elbow = 1 + next(k for k, step in enumerate(robot.steps) if step.joint == second)
    return {
        "home": robot.home[free].tolist(),
        "joints": [
            {"name": robot.joints[j].name, "kind": robot.joints[j].kind}
            | {"unit": robot.length_unit, **view}
            for j, view in zip(free, views, strict=True)
        ],
        "frames": frames.tolist(),
        "tool": _placed(frames[robot.steps_to(tool.frame)], tool.at),
        "elbow": _placed(frames[elbow], [0, 0, 0]),
        "walls": [_wall(region, boundary, q, across) for boundary in _listed(robot)],
        "regions": [_region(region, number, views) for number in range(len(region.components))],
    }


def _word(robot: Robot) -> str:
    """Return the word for a feasible pose: safe only where whole links keep clear of everything."""
    if robot.whole_links:
        return "safe"
    links = {body.name for body in robot.bodies if body.frame != robot.base}
    kept = {frozenset(b.bodies) for b in robot.used if isinstance(b, BodyPair)}
    others = [body.name for body in (*robot.bodies, *robot.obstacles) if body.name not in links]
    if links and others and all(frozenset((a, b)) in kept for a in links for b in others):
        return "clear of obstacles"
    return f"allowed by the {robot.feasible_by}"


# --- the robot -----------------------------------------------------------------------------------


def _names(robot: Robot) -> dict[str, str]:
    """Return what boundaries are called: two balls that cover links by the two links."""
    names = {}
    for boundary in _listed(robot):
        names[boundary.name] = boundary.name
        if isinstance(boundary, Pair):
            covered = [robot.point(name).covers for name in boundary.points]
            if any(covered):
                links = zip(covered, boundary.points, strict=True)
                names[boundary.name] = ", ".join(link or point for link, point in links)
    return names


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


def _apart(robot: Robot) -> list[list[int]]:
    """List the pairs of bodies, by index, whose overlap the page shows."""
    order = [body.name for body in (*robot.bodies, *robot.obstacles)]
    return [[order.index(name) for name in pair] for pair in overlap_pairs(robot)]


def _listed(robot: Robot) -> list[Boundary]:
    """Return the boundaries in the order in which the page has them."""
    return list(dict.fromkeys((*robot.boundaries, *robot.used)))


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
    leans = [abs(abs(n @ a) - (kind == "revolute")) for a, kind in zip(axes, kinds, strict=True)]
    oblique = bool(max(leans) >= IN_PLANE)
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


def _across(axes: Sequence[Floats], kinds: Sequence[str]) -> Floats:
    """Return the normal of the plane of motion: the axis of a turn, or across both slides."""
    for axis, kind in zip(axes, kinds, strict=True):
        if kind == "revolute":
            return np.asarray(axis, dtype=float)
    normal = np.cross(axes[0], axes[1])
    size = np.linalg.norm(normal)
    return np.asarray(normal / size) if size > ZERO_AMPLITUDE else np.array([0.0, 1.0, 0.0])


# --- forms of two joints --------------------------------------------------------------------------


def _inverse_basis(kind: Kind) -> tuple[Floats, Floats]:
    """Return three values of a joint, and the matrix that makes a form of the values there."""
    values = np.array([0.0, 2, -2]) * np.pi / 3 if kind == "revolute" else np.array([0.0, 1, -1])
    return values, np.linalg.inv(basis(kind, values))


def _frames(robot: Robot, free: Sequence[int], q: Floats, across: Floats) -> Floats:
    """Return every frame's axes and origin, seen in the picture, as forms of the free joints.

    Shape (frames, 2, 4, 3, 3): a coordinate of the picture, then three axes and the origin. Three
    values of each joint settle a form.
    """
    (one, to_one), (other, to_other) = (_inverse_basis(robot.kinds[j]) for j in free)
    poses = np.tile(q, (3, 3, 1))
    poses[..., free[0]], poses[..., free[1]] = one[:, None], other
    placed = robot.frames(poses)
    forms = []
    for name in (robot.base, *(step.frame for step in robot.steps)):
        turn = np.broadcast_to(placed.rotation(robot.base, name), (3, 3, 3, 3))
        origin = np.broadcast_to(placed.position(robot.base, name, robot.base), (3, 3, 3))
        seen = across @ np.concatenate([turn, origin[..., None]], axis=-1)
        forms.append(np.einsum("ia,abrc,jb->rcij", to_one, seen, to_other))
    return np.where(np.abs(forms) < NOTHING * robot.stretched(robot.tool), 0.0, forms)


def _placed(frame: Floats, at: ArrayLike) -> list[Any]:
    """Return the place of a point of a frame in the picture, as two forms."""
    placed: list[Any] = np.einsum("rcij,c->rij", frame, [*np.asarray(at), 1.0]).tolist()
    return placed


def _wall(region: Region, boundary: Boundary, q: Floats, across: Floats) -> Data:
    """Return a boundary: whom it keeps apart and by how much, its line in the picture, its form."""
    robot, free = region.robot, list(region.problem.joints)
    points = [point.name for point in robot.points]
    bodies = [body.name for body in (*robot.bodies, *robot.obstacles)]
    wall: Data = {"name": _names(robot)[boundary.name], "used": boundary.used, "points": []}
    wall |= {"bodies": None, "required": 0.0, "line": None, "form": None}
    if isinstance(boundary, HalfSpace):
        wall["line"] = [*(across @ boundary.normal).tolist(), boundary.offset]
    if bounds_bodies(boundary):
        wall["bodies"] = [bodies.index(body.name) for body in bounded_bodies(robot, boundary)]
        return wall | {"required": boundary.clearance if isinstance(boundary, BodyPair) else 0.0}
    form = clearance(robot, boundary)
    if isinstance(boundary, HalfSpace):
        wall["points"] = [points.index(boundary.point)]
        wall["line"][2] += robot.point(boundary.point).radius
    elif isinstance(boundary, Pair):
        wall["points"] = [points.index(name) for name in boundary.points]
        wall["required"] = robot.required_distance(boundary)
        if boundary.name in region.problem.unstated:  # eq. (17): the points must not coincide
            form, wall["required"] = form + wall["required"] ** 2, 0.0
    left = restrict(form, {j: q[j] for j in range(len(q)) if j not in free}).coefficients
    return wall | {"form": (left if free[0] < free[1] else left.T).tolist()}


def _windows(robot: Robot) -> list[Data]:
    """Return the components of Table 6: each vanishes where a cos q + b sin q = c."""
    windows: list[Data] = []
    for boundary in robot.used:
        if not isinstance(boundary, Pair):
            continue
        vector = pair_vector(robot, boundary)
        [joint] = vector.joints()
        for k in range(3):
            c, a, b = (float(value) for value in vector[k].along(joint, robot.home))
            if np.hypot(a, b) > NOTHING * robot.reach:
                component = {"wall": boundary.name, "component": k + 1, "joint": joint}
                windows.append(component | {"a": a, "b": b, "c": -c})
    return windows


# --- regions --------------------------------------------------------------------------------------


def _region(region: Region, number: int, views: Sequence[Data]) -> Data:
    """Return a component: its arcs, and where it goes round a joint the rings that fill it."""
    component, names = region.components[number], _names(region.robot)
    arcs = [
        [
            {"wall": names.get(arc.boundary, arc.boundary), "points": _arc(arc, views)}
            for arc in loop
        ]
        for loop in component.loops
    ]
    rings = None
    if any(component.wraps):
        window = [[view["low"], view["high"]] for view in views]
        deviation = FLAT_ARC * min(high - low for low, high in window)
        pieces, _ = polygons(component, deviation, window)
        rings = [ring.round(6).tolist() for piece in pieces for ring in (piece.outer, *piece.holes)]
    return {
        "home": component.contains_home,
        "area": component.area,
        "centre": _inner(region, number, views),
        "loops": arcs,
        "rings": rings,
    }


def _inner(region: Region, number: int, views: Sequence[Data]) -> list[float] | None:
    """Return a pose inside a component: its centroid, or else the roomiest pose of a grid."""
    component = region.components[number]
    centroid = component.centroid
    if centroid is not None and region.component_of(centroid.tolist()) == number:
        return [float(value) for value in centroid]
    low, high = np.array([[view["low"], view["high"]] for view in views]).T
    if component.loops and not any(component.wraps):
        outline = np.concatenate([arc.points for loop in component.loops for arc in loop])
        low, high = outline.min(axis=0), outline.max(axis=0)
    steps = np.linspace(0.02, 0.98, 41)
    grid = low + (high - low) * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    grid = grid[region.component_of(grid) == number]
    if not len(grid):
        return None
    room = region.margins(grid).min(axis=1, initial=np.inf)
    return [float(value) for value in grid[np.argmax(room)]]


def _slices(region: Region, row: Slices) -> Data:
    """Return a row of slices by rising value of one joint: in what each differs from the region."""
    own, problems = region.problem, [each.problem for each in row.regions]
    others = {j: value for j, value in own.held.items() if j != row.along}
    alike = all({**problem.held, **others} == problem.held for problem in problems)
    if row.robot != region.robot or problems[0].joints != own.joints or not alike:
        raise ValueError("the row of slices is of other joints, or of other held values")
    if own.held[row.along] not in row.values.tolist():
        raise ValueError("the region is none of the slices of its row")
    joint = row.robot.joints[row.along]
    slices = []
    for k in np.argsort(row.values, kind="stable"):
        changed = _of_slice(row.regions[k])
        del changed["joints"]  # their ranges are drawn once
        slices.append({"value": float(row.values[k]), **changed})
    return {
        "joint": joint.name,
        "kind": joint.kind,
        "value": float(own.held[row.along]),
        "slices": slices,
    }


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


def _arc(arc: Arc, views: Sequence[Data]) -> list[list[float]]:
    """Return as many of an arc's exact points as a drawing needs."""
    deviation = FLAT_ARC * min(view["high"] - view["low"] for view in views)
    s, _ = flatten(arc.at, deviation, len(arc.pieces))
    points: list[list[float]] = arc.at(s).round(6).tolist()
    return points


def _polygon(region: Region, walks: Walks) -> Data | None:
    """Return the vertex polygon of the home component, its largest feasible scale, its walks."""
    if not region.has_home:
        return None
    home = region.home_component
    if any(home.wraps) or len(home.loops) != 1 or len(home.vertices) < 3:
        return None
    vertices = np.array([vertex.q for vertex in home.vertices])
    problem = region.problem
    try:
        centre = polygon.centroid(vertices)
        largest = largest_safe_scale(vertices, centre, problem.forms, contacts=problem.contacts)
    except (ValueError, ArithmeticError):  # centroid not feasible, or an edge in a wall
        return None
    return {
        "vertices": vertices.tolist(),
        "centroid": centre.tolist(),
        "largest": largest.scale,
        "walks": [
            [*range(len(vertices)), 0],
            *(list(walk) for walk in walks if max(walk) < len(vertices)),
        ],
    }
