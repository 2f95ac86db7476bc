"""Brute-force test of a certificate: many configurations of its set, in floats.

Nothing of the package is used: kinematics turns points one joint after the other, and the inside of
a polygon is where its loops wind around a place. So a certificate is judged by what it says.
"""

import itertools
import math
import tomllib
from typing import Any

import numpy as np
import shapely
from scipy import sparse
from scipy.sparse import csgraph

Array = np.ndarray
ROUNDING = 1e-9


def tells_the_truth(content: dict[str, Any], seed: int = 0, samples: int = 400) -> bool:
    """Tell whether no sample contradicts a certificate."""
    robot, claim = tomllib.loads(content["robot"]), content["claim"]
    if "witness" in content:
        q = witness(content)
        name = violated(robot, content)
        return belongs(claim, q) and bool(margins(robot, claim, q[None])[name][0] < ROUNDING)
    rng = np.random.default_rng(seed)
    if claim["set"] == "no path":
        return not is_joined(robot, claim, rng, samples)
    q = configurations(claim, rng, samples)
    return bool(kept(robot, claim, q).min() >= -ROUNDING * (1 + np.abs(q).max()))


def kept(robot: dict[str, Any], claim: dict[str, Any], q: Array, limits: bool = True) -> Array:
    """Return the smallest margin of boundaries in use, and of limits, shape (N,)."""
    left_out = {row["name"] for row in boundaries(robot) if not row.get("used", True)}
    sides = [f"{joint['name']}.{side}" for joint in robot["joint"] for side in ("lower", "upper")]
    left_out |= set() if limits else {*sides}
    found = margins(robot, claim, q)
    far = np.full(len(q), math.inf)
    return np.min([far, *(found[name] for name in found if name not in left_out)], axis=0)


def margins(robot: dict[str, Any], claim: dict[str, Any], q: Array) -> dict[str, Array]:
    """Return how far every boundary and limit is kept, lengths and joint values of shape (N,)."""
    margin, found = float(claim["margin"]), {}
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
    frames = frames_of(robot)
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
    common = shapely.intersection(one, other)  # as thick as its area by its outline
    overlap = shapely.area(common) / np.maximum(shapely.length(common), 1e-300)
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
        normal += np.abs(axis) * (joint["type"] != "prismatic")
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


def steps(robot: dict[str, Any]) -> list[tuple[str, int, bool, int, dict[str, Any]]]:
    """Return what leads from frame to frame: its end, joint, kind, sense, and numbers."""
    found = []
    for j, row in enumerate(robot["joint"]):
        bar, turns = row["type"] == "parallelogram", row["type"] != "prismatic"
        found.append((row["bar"] if bar else row["frame"], j, turns, 1, row))
        if bar:
            second = {"origin": row["crank"], "axis": row["axis"]}
            found.append((row["frame"], j, turns, -1, second))
    return found


def frames_of(robot: dict[str, Any]) -> list[str]:
    return [robot["joint"][0]["parent"], *(step[0] for step in steps(robot))]


def place(
    robot: dict[str, Any], point: dict[str, Any], q: Array, still: int = 0, at: Array | None = None
) -> Array:
    """Return a point seen from the base, shape (N, 3); the first steps may be held at a place."""
    radian = math.pi / 180 if robot["angle_unit"] == "deg" else 1.0
    r = np.tile(np.array(point["at"], dtype=float), (len(q), 1))
    count = frames_of(robot).index(point["frame"])
    for k, (_, j, turns, sense, row) in reversed([*enumerate(steps(robot)[:count])]):
        value = q[:, j] if at is None or k >= still else np.full(len(q), at[j])
        axis, x = unit(row["axis"]), sense * value
        r = turned(r, axis, x * radian) if turns else r + x[:, None] * axis
        for fixed, angle in zip(np.eye(3), row.get("rpy", (0, 0, 0)), strict=True):
            r = turned(
                r, fixed, np.full(len(q), angle * radian)
            )  # roll first, then pitch, then yaw
        r = r + np.array(row["origin"], dtype=float)
    return r


def turned(r: Array, axis: Array, angle: Array) -> Array:
    """Turn rows about an axis: r cos + (axis x r) sin + axis (axis . r) (1 - cos)."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return r * c + np.cross(axis, r) * s + np.outer(r @ axis, axis) * (1 - c)


def unit(vector: Any) -> Array:
    v = np.array(vector, dtype=float)
    return v / np.abs(v).max() / np.linalg.norm(v / np.abs(v).max())


# --- the set --------------------------------------------------------------------------------------


def loops_of(claim: dict[str, Any]) -> list[Array]:
    return [np.array(loop, dtype=float) for loop in claim["points"]]


def configurations(claim: dict[str, Any], rng: np.random.Generator, samples: int) -> Array:
    """Return configurations of a set, its corners and edges among them."""
    loops = loops_of(claim)
    if claim["set"] == "box":
        [[low, high]] = loops
        corners = np.array(list(itertools.product((0, 1), repeat=len(low))))
        return low + np.concatenate([corners, rng.random((samples, len(low)))]) * (high - low)
    closed = claim["set"] == "polygon"
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
    claim, found = content["claim"], content["witness"]
    if "at" in found:
        return np.array(found["at"], dtype=float)
    loops, number = loops_of(claim), found["cell"]
    if claim["set"] == "path":
        cell = [pair for loop in loops for pair in itertools.pairwise(loop)][number]
    else:
        cell = [np.concatenate(loops)[i] for i in claim["triangles"][number]]
    return np.array(found["weights"], dtype=float) @ np.array(cell)


def violated(robot: dict[str, Any], content: dict[str, Any]) -> str:
    """Return the name of what a refutation is about; a pair of bodies has its parts one by one."""
    if "limit" in content["witness"]:
        return str(content["witness"]["limit"])
    names = []
    for row in boundaries(robot):
        if row.get("used", True):
            count = math.prod(len(content["parts"].get(b, " ")) for b in row.get("bodies", ()))
            names += [row["name"]] * count
    return str(names[content["witness"]["place"]["keep"]])


def belongs(claim: dict[str, Any], q: Array) -> bool:
    """Tell whether a configuration is in a set, or as near to it as rounding brings it."""
    loops = loops_of(claim)
    near = ROUNDING * (1 + np.abs(q).max())
    if claim["set"] == "box":
        [[low, high]] = loops
        return bool(np.all(low - near <= q) and np.all(q <= high + near))
    closed = claim["set"] == "polygon"
    lines = [np.concatenate([loop, loop[:1]]) if closed else loop for loop in loops]
    pairs = [pair for line in lines for pair in itertools.pairwise(line)]
    within = closed and bool(winding(loops, q[None])[0])
    return within or min(off(a, b, q) for a, b in pairs) <= near


def off(a: Array, b: Array, q: Array) -> float:
    """Return the distance of a configuration from a segment."""
    length = np.dot(b - a, b - a)
    t = np.clip(np.dot(q - a, b - a) / length, 0, 1) if length else 0.0
    return float(np.linalg.norm(q - a - t * (b - a)))


# --- no path --------------------------------------------------------------------------------------


def is_joined(
    robot: dict[str, Any], claim: dict[str, Any], rng: np.random.Generator, samples: int
) -> bool:
    """Tell whether steps on a lattice lead from start to goal and keep everything all the way.

    A place of the lattice is free if nothing can be violated before the middle of a step. Of the
    joints that take any value, some values are tried.
    """
    [[start, goal]] = loops_of(claim)
    moving = [j for j, kind in enumerate(claim["joints"]) if kind == "moves"]
    whole = 360 if robot["angle_unit"] == "deg" else math.tau
    limits = np.array([row.get("limits", (-whole / 2, whole / 2)) for row in robot["joint"]])
    turns = np.array([row["type"] != "prismatic" for row in robot["joint"]])
    count = min(samples, round((40 * samples) ** (1 / len(moving))))
    at = np.indices([count] * len(moving)).reshape(len(moving), -1)
    low, step = limits[moving, 0], np.ptp(limits[moving], axis=1) / (count - 1)
    far = np.where(turns[moving], reach(robot) * math.tau / whole, 1) @ np.diag(step)
    q = np.tile(start, (at.shape[1], 1))
    q[:, moving] = low + at.T * step
    free = np.zeros(len(q), dtype=bool)
    some = [j for j, kind in enumerate(claim["joints"]) if kind == "any"]
    for _ in range(40 if some else 1):
        q[:, some] = rng.uniform(*limits[some].T, (len(q), len(some)))
        free |= kept(robot, claim, q, limits=False) > far.max() / 2
    numbers, edges = np.arange(len(q)).reshape([count] * len(moving)), []
    seams = ["limits" not in robot["joint"][j] for j in moving]
    for axis, seam in enumerate(seams):
        pairs = np.stack([numbers, np.roll(numbers, -1, axis=axis)])
        edges.append(pairs.take(range(count - (not seam)), axis=axis + 1).reshape(2, -1))
    one, other = np.concatenate(edges, axis=1)
    both = free[one] & free[other]
    links = sparse.coo_array((both[both], (one[both], other[both])), shape=(len(q), len(q)))
    _, group = csgraph.connected_components(links, directed=False)

    def node(end: Array) -> int:
        x = np.where(seams, (end[moving] + whole / 2) % whole - whole / 2, end[moving])
        return int(numbers[tuple(np.round((x - low) / step).astype(int))])

    a, b = node(start), node(goal)
    return bool(free[a] and free[b] and group[a] == group[b])


def reach(robot: dict[str, Any]) -> float:
    """Return at least the distance of any place of a robot from any joint."""
    lengths = [np.linalg.norm(row["origin"]) for *_, row in steps(robot)]
    slides = [row for row in robot["joint"] if row["type"] == "prismatic"]
    lengths += [np.abs(row["limits"]).max() for row in slides]
    ends = [row["at"] for row in robot["point"]]
    ends += [p for body in bodies(robot).values() for p in corners(robot, body)]
    return float(np.sum(lengths) + max(map(np.linalg.norm, ends)))
