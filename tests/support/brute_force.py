"""Does a certificate say the truth? By many configurations of its set, in floats.

Nothing of the package is used: kinematics turns points one joint after the other, and the inside of
a polygon is where its loops wind around a place. So a certificate is judged by what it says.
"""

import hashlib
import itertools
import json
import math
import tomllib
from typing import Any

import numpy as np
import shapely

Array = np.ndarray
ROUNDING = 1e-9


def tells_the_truth(text: str, seed: int = 0, samples: int = 400) -> bool:
    """Tell whether no sample contradicts a certificate."""
    content = json.loads(text)
    robot = tomllib.loads(content["robot"])
    if hashlib.sha256(content["robot"].encode()).hexdigest() != content["sha256"]:
        return False
    statement = content["statement"]
    if content["verdict"] == "refuted":
        q = witness(content)
        found = margins(robot, statement, q[None])
        return belongs(statement, q) and bool(found[content["boundary"]][0] < ROUNDING)
    rng = np.random.default_rng(seed)
    names = [row["name"] for row in boundaries(robot) if row.get("used", True)]
    names += [f"{j['name']}.{side}" for j in robot["joint"] for side in ("lower", "upper")]
    q = configurations(statement, rng, samples)
    found = margins(robot, statement, q)
    near = ROUNDING * (1 + np.abs(q).max())
    return all(found[name].min() >= -near for name in names)


def margins(robot: dict[str, Any], statement: dict[str, Any], q: Array) -> dict[str, Array]:
    """Return how far every boundary and limit is kept, lengths and joint values of shape (N,)."""
    margin, found = float(statement["margin"]), {}
    points = {row["name"]: row for row in robot["point"]}
    for row in boundaries(robot):
        if "bodies" in row or "body" in row:
            found[row["name"]] = of_bodies(robot, row, q) - margin
            continue
        ends = [points[name] for name in row.get("points", [row.get("point")])]
        places = [place(robot, end, q) for end in ends]
        radii = sum(end.get("radius", 0) for end in ends)
        if row["type"] == "pair":
            a, b = places
            distance = np.linalg.norm(a - b, axis=1) - row.get("clearance", 0)
        else:
            distance = places[0] @ unit(row["normal"]) - row["offset"]
        found[row["name"]] = distance - radii - margin
    for joint, x in zip(robot["joint"], q.T, strict=True):
        low, high = joint.get("limits", (-math.inf, math.inf))
        found |= {f"{joint['name']}.lower": x - low, f"{joint['name']}.upper": high - x}
    return found


# --- bodies ---------------------------------------------------------------------------------------


def bodies(robot: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return all bodies by their names: of links by their frames, obstacles last."""
    frames = [robot["joint"][0]["parent"], *(joint["frame"] for joint in robot["joint"])]
    rows = [(row, row["frame"], 0) for row in robot.get("body", [])]
    rows += [(row, frames[0], 1) for row in robot.get("obstacle", [])]
    found, counts = [], dict.fromkeys(frames, 0)
    for row, frame, last in rows:
        counts[frame] += 1
        usual = frame if counts[frame] == 1 else f"{frame}/{counts[frame]}"
        found.append((last, frames.index(frame), {"name": usual, "frame": frame} | row))
    ordered = sorted(found, key=lambda row: row[:2])
    return {row["name"]: row for _, _, row in ordered}


def boundaries(robot: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the boundaries of the file, and the pairs that `collisions` makes."""
    rows = list(robot.get("boundary", []))
    apart = [set(row["bodies"]) for row in rows if "bodies" in row]
    apart += map(set, robot.get("allowed", []))
    pairs = itertools.combinations(bodies(robot).values(), 2) if "collisions" in robot else ()
    for one, other in pairs:
        names = [one["name"], other["name"]]
        if one["frame"] != other["frame"] and set(names) not in apart:
            row = {"name": ", ".join(names), "type": "bodies", "bodies": names}
            rows.append(row | {"clearance": robot.get("clearance", 0)})
    return rows


def of_bodies(robot: dict[str, Any], row: dict[str, Any], q: Array) -> Array:
    """Return the margins of a pair of bodies, or of a half-space for one; overlap is negative."""
    known = bodies(robot)
    if "body" in row:
        body = known[row["body"]]
        heights = [place(robot, {"frame": body["frame"], "at": corner}, q) @ unit(row["normal"])
                   for corner in corners(robot, body)]  # fmt: skip
        return np.min(heights, axis=0) - row["offset"] - radius(body)
    pair = [known[name] for name in row["bodies"]]
    asked = row.get("clearance", 0) + sum(map(radius, pair))
    one, other = (core(robot, body, q) for body in pair)
    overlap = np.sqrt(shapely.area(shapely.intersection(one, other)))
    return shapely.distance(one, other) - overlap - asked


def radius(body: dict[str, Any]) -> float:
    return body.get("capsule", body.get("disc", {})).get("radius", 0)


def corners(robot: dict[str, Any], body: dict[str, Any]) -> list[list[float]]:
    """Return the corners of a core as three numbers."""
    shape = body.get("capsule", body.get("disc", body.get("polygon")))
    places = [shape[key] for key in ("from", "to", "at") if key in shape] or shape
    flat = int(np.abs(directions(robot, body["frame"])[:, axis_of(robot)]).argmax())
    return [list(np.insert(p, flat, 0.0)) if len(p) == 2 else list(p) for p in places]


def directions(robot: dict[str, Any], frame: str) -> Array:
    """Return the axes of a frame, seen from the base with all joint values 0; rows."""
    still = np.zeros((1, len(robot["joint"])))
    ends = [place(robot, {"frame": frame, "at": at}, still)[0] for at in (*np.eye(3), np.zeros(3))]
    return np.array(ends[:3]) - ends[3]


def axis_of(robot: dict[str, Any]) -> int:
    """Return the coordinate of the base across the plane of motion."""
    normal = np.zeros(3)
    slides = []
    for joint in robot["joint"]:
        axis = unit(joint["axis"]) @ directions(robot, joint["frame"])
        normal += np.abs(axis) * (joint["type"] == "revolute")
        slides += [axis] * (joint["type"] == "prismatic")
    normal = normal if normal.any() else np.cross(slides[0], slides[-1])
    return int(np.abs(normal).argmax())


def core(robot: dict[str, Any], body: dict[str, Any], q: Array) -> Array:
    """Return the core of a body as it is seen along the common axis: shapes, one for each q."""
    seen = np.delete(np.arange(3), axis_of(robot))
    places = [place(robot, {"frame": body["frame"], "at": at}, q) for at in corners(robot, body)]
    rows = np.stack(places, axis=1)[..., seen]
    makers = {1: lambda x: shapely.points(x[:, 0]), 2: shapely.linestrings}
    return makers.get(rows.shape[1], shapely.polygons)(rows)


def place(robot: dict[str, Any], point: dict[str, Any], q: Array) -> Array:
    """Return a point seen from the base, shape (N, 3)."""
    radian = math.pi / 180 if robot["angle_unit"] == "deg" else 1.0
    frames = [robot["joint"][0]["parent"], *(joint["frame"] for joint in robot["joint"])]
    r = np.tile(np.array(point["at"], dtype=float), (len(q), 1))
    depth = frames.index(point["frame"])
    for joint, x in reversed(list(zip(robot["joint"][:depth], q.T[:depth], strict=True))):
        axis = unit(joint["axis"])
        turns = joint["type"] == "revolute"
        r = turned(r, axis, x * radian) if turns else r + x[:, None] * axis
        for fixed, angle in zip(np.eye(3), joint.get("rpy", (0, 0, 0)), strict=True):
            r = turned(
                r, fixed, np.full(len(q), angle * radian)
            )  # roll first, then pitch, then yaw
        r = r + np.array(joint["origin"], dtype=float)
    return r


def turned(r: Array, axis: Array, angle: Array) -> Array:
    """Turn rows about an axis: r cos + (axis x r) sin + axis (axis . r) (1 - cos)."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return r * c + np.cross(axis, r) * s + np.outer(r @ axis, axis) * (1 - c)


def unit(vector: Any) -> Array:
    v = np.array(vector, dtype=float)
    return v / np.abs(v).max() / np.linalg.norm(v / np.abs(v).max())


# --- the set --------------------------------------------------------------------------------------


def loops_of(statement: dict[str, Any]) -> list[Array]:
    return [np.array(loop, dtype=float) for loop in statement["points"]]


def configurations(statement: dict[str, Any], rng: np.random.Generator, samples: int) -> Array:
    """Return configurations of a set, its corners and edges among them."""
    loops = loops_of(statement)
    if statement["set"] == "box":
        [[low, high]] = loops
        corners = np.array(list(itertools.product((0, 1), repeat=len(low))))
        return low + np.concatenate([corners, rng.random((samples, len(low)))]) * (high - low)
    closed = statement["set"] == "polygon"
    lines = [np.concatenate([loop, loop[:1]]) if closed else loop for loop in loops]
    steps = np.linspace(0, 1, max(2, samples // sum(map(len, lines))))[:, None]
    on = [a + steps * (b - a) for line in lines for a, b in itertools.pairwise(line)]
    if closed:
        every = np.concatenate(loops)
        places = every.min(axis=0) + rng.random((samples, every.shape[1])) * np.ptp(every, axis=0)
        on.append(places[winding(loops, places) != 0])
    return np.concatenate(on)


def winding(loops: list[Array], q: Array) -> Array:
    """Return how often loops wind around places, by the turns of the line of sight."""
    free = np.flatnonzero(np.ptp(np.concatenate(loops), axis=0))
    total = np.zeros(len(q))
    for loop in loops:
        z = (loop[None, :, free] - q[:, None, free]) @ np.array([1, 1j])
        total += np.angle(np.roll(z, -1, axis=1) * z.conj()).sum(axis=1)
    return (total / math.tau).round()


def witness(content: dict[str, Any]) -> Array:
    """Return the configuration that a refutation names."""
    if "at" in content:
        return np.array(content["at"], dtype=float)
    statement, number = content["statement"], content["cell"]
    loops = loops_of(statement)
    if statement["set"] == "path":
        cell = [pair for loop in loops for pair in itertools.pairwise(loop)][number]
    elif statement["set"] == "polygon":
        cell = [np.concatenate(loops)[i] for i in statement["triangles"][number]]
    else:
        [[low, high]] = loops
        orders = list(itertools.permutations(np.flatnonzero(low != high)))
        cell = [np.where(np.isin(range(len(low)), orders[number][:k]), high, low)
                for k in range(len(orders[number]) + 1)]  # fmt: skip
    return np.array(content["weights"], dtype=float) @ np.array(cell)


def belongs(statement: dict[str, Any], q: Array) -> bool:
    """Tell whether a configuration is in a set, or as near to it as rounding brings it."""
    loops = loops_of(statement)
    near = ROUNDING * (1 + np.abs(q).max())
    if statement["set"] == "box":
        [[low, high]] = loops
        return bool(np.all(low - near <= q) and np.all(q <= high + near))
    closed = statement["set"] == "polygon"
    lines = [np.concatenate([loop, loop[:1]]) if closed else loop for loop in loops]
    pairs = [pair for line in lines for pair in itertools.pairwise(line)]
    within = closed and bool(winding(loops, q[None])[0])
    return within or min(off(a, b, q) for a, b in pairs) <= near


def off(a: Array, b: Array, q: Array) -> float:
    """Return the distance of a configuration from a segment."""
    length = np.dot(b - a, b - a)
    t = np.clip(np.dot(q - a, b - a) / length, 0, 1) if length else 0.0
    return float(np.linalg.norm(q - a - t * (b - a)))
