"""A judge of poses of a robot file: its own reader, plain matrices and separating axes.

Bodies lie in one plane, whose axis is a coordinate axis of every frame; points and spheres in
space. All arrays begin with the poses. Nothing of the library is used but shapely's triangles.
"""

from __future__ import annotations

import tomllib
from itertools import combinations
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from engine_support.urdf import rotation, transform

Floats = NDArray[np.float64]
Row = dict[str, Any]

FULL_TURN = (-np.pi, np.pi)


class ShapeJudge:
    """The margins of all boundaries of a file, and the gaps of all pairs of bodies.

    Attributes
    ----------
    limits : ndarray, shape (n, 2)
        Of every joint, rad or length; a turn where the file has none.
    size : float
        The largest length of the file: rounding is a part of it.
    """

    def __init__(self, text: str) -> None:
        self.file = file = tomllib.loads(text)
        self.angle = np.pi / 180 if file["angle_unit"] == "deg" else 1.0
        self.base = file["joint"][0]["parent"]
        self.limits = np.array([self._range(row) for row in file["joint"]])
        self.points = {row["name"]: row for row in file["point"]}
        fixed = [row | {"frame": self.base} for row in file.get("obstacle", [])]
        rows = [*file.get("body", []), *fixed]
        self.bodies = {row.get("name", row["frame"]): row for row in rows}
        turning = [row["axis"] for row in file["joint"] if row["type"] != "prismatic"]
        slides = np.abs([row["axis"] for row in file["joint"]]).sum(axis=0)
        across = int(np.argmax(np.abs(turning[0]))) if turning else int(np.argmin(slides))
        self.plane = [k for k in range(3) if k != across]
        lengths = [row["origin"] for row in file["joint"]] + [row["at"] for row in file["point"]]
        corners = [self._parts(row)[0] for row in rows]
        self.size = max(np.abs(np.concatenate([np.ravel(x) for x in (*lengths, *corners)])))

    def margins(self, q: Floats) -> dict[str, Floats]:
        """Return the margin of each boundary in use, and of each limit: what is kept beyond it."""
        frames, found = self._frames(q), dict[str, Floats]()
        for row, values, ends in zip(self.file["joint"], q.T, self.limits, strict=True):
            if "limits" in row:
                found[row["name"]] = np.minimum(values - ends[0], ends[1] - values)
        named = self.file.get("boundary", [])
        for row in named:
            if row.get("used", True):
                found[row["name"]] = self._margin(row, frames)
        if "collisions" in self.file:
            but = [*self.file.get("allowed", []), *(r["bodies"] for r in named if "bodies" in r)]
            for pair in self.pairs - set(map(frozenset, but)):
                clearance = self.file.get("clearance", 0.0)
                found[" | ".join(sorted(pair))] = self._gap(*pair, frames) - clearance
        return found

    @property
    def pairs(self) -> set[frozenset[str]]:
        """Every two bodies on different frames."""
        frame = {name: row["frame"] for name, row in self.bodies.items()}
        return {frozenset(p) for p in combinations(frame, 2) if frame[p[0]] != frame[p[1]]}

    def gaps(self, q: Floats) -> dict[frozenset[str], Floats]:
        """Return the distance of every two bodies on different frames, negative where they meet."""
        frames = self._frames(q)
        return {pair: self._gap(*pair, frames) for pair in self.pairs}

    # --- where things are -------------------------------------------------------------------------

    def _range(self, row: Row) -> tuple[float, float]:
        low, high = row.get("limits", FULL_TURN)
        turns = "limits" in row and row["type"] != "prismatic"
        return (low * self.angle, high * self.angle) if turns else (low, high)

    def _frames(self, q: Floats) -> dict[str, Floats]:
        """Return the pose of every frame, shape (N, 4, 4) each."""
        found = {self.base: np.broadcast_to(np.eye(4), (len(q), 4, 4))}
        for row, value in zip(self.file["joint"], q.T[:, :, None, None], strict=True):
            x, y, z = np.array(row.get("rpy", (0.0, 0.0, 0.0))) * self.angle
            mount = (
                rotation(np.eye(3)[2], z) @ rotation(np.eye(3)[1], y) @ rotation(np.eye(3)[0], x)
            )
            start = found[row["parent"]] @ transform(mount, np.array(row["origin"], dtype=float))
            axis = np.array(row["axis"], dtype=float)
            move = np.broadcast_to(np.eye(4), (len(q), 4, 4)).copy()
            if row["type"] == "prismatic":
                move[:, :3, 3] = value[:, 0] * axis / np.linalg.norm(axis)
            else:
                move[:, :3, :3] = rotation(axis, value)
            if row["type"] == "parallelogram":
                found[row["bar"]] = start @ move
                move[:, :3, 3] = move[:, :3, :3] @ np.array(row["crank"], dtype=float)
                move[:, :3, :3] = np.eye(3)
            found[row["frame"]] = start @ move
        return found

    def _parts(self, row: Row) -> tuple[list[Floats], float]:
        """Return convex cores of a body, seen from its frame, (k, 3) each, and its radius."""
        if "polygon" in row:
            flat = self._flat(row["polygon"])
            cut = shapely.constrained_delaunay_triangles(shapely.Polygon(flat[:, self.plane]))
            parts = [np.array(part.exterior.coords)[:3] for part in cut.geoms]
            return [self._flat(part) for part in parts], 0.0
        shape = row.get("capsule") or row["disc"]
        ends = [shape[key] for key in ("at", "from", "to") if key in shape]
        return [self._flat(ends)], float(shape["radius"])

    def _flat(self, places: Any) -> Floats:
        """Return places in space of places in the plane."""
        places = np.array(places, dtype=float)
        if places.shape[1] == 3:
            return places
        found = np.zeros((len(places), 3))
        found[:, self.plane] = places
        return found

    def _seen(self, places: Floats, frame: Floats) -> Floats:
        """Return places of a frame as (N, k, 3), seen from the base."""
        return places @ frame[:, :3, :3].swapaxes(1, 2) + frame[:, None, :3, 3]

    # --- how far apart they are -------------------------------------------------------------------

    def _margin(self, row: Row, frames: dict[str, Floats]) -> Floats:
        """Return the margin of a boundary of the file."""
        if row["type"] == "bodies":
            return self._gap(*row["bodies"], frames) - row.get("clearance", 0.0)
        spheres = [self.points[name] for name in row.get("points", [row.get("point")]) if name]
        at = [np.array([each["at"]], dtype=float) for each in spheres]
        radii = sum(each.get("radius", 0.0) for each in spheres)
        seen = [self._seen(x, frames[each["frame"]]) for x, each in zip(at, spheres, strict=True)]
        if row["type"] == "pair":
            apart = np.linalg.norm(seen[0] - seen[1], axis=2)[:, 0]
            return apart - radii - row.get("clearance", 0.0)
        if "body" in row:
            body = self.bodies[row["body"]]
            cores, radii = self._parts(body)
            seen = [self._seen(core, frames[body["frame"]]) for core in cores]
        normal = np.array(row["normal"]) / np.linalg.norm(row["normal"])
        return np.min([(x @ normal).min(axis=1) for x in seen], axis=0) - row["offset"] - radii

    def _gap(self, one: str, other: str, frames: dict[str, Floats]) -> Floats:
        """Return the distance of two bodies; of those that meet, minus the deepest parts' depth."""
        rows = self.bodies[one], self.bodies[other]
        (a, r), (b, s) = map(self._parts, rows)
        a, b = ([self._seen(core, frames[row["frame"]])[..., self.plane] for core in cores]
                for cores, row in zip((a, b), rows, strict=True))  # fmt: skip
        return np.min([separation(x, y) for x in a for y in b], axis=0) - r - s


def separation(one: Floats, other: Floats) -> Floats:
    """Return the signed distance of convex cores in the plane, (N, m, 2) and (N, k, 2).

    It is the largest gap along any direction. Apart, that is along the normal of an edge or from
    corner to corner; where they meet, along the normal of an edge.
    """
    edges = np.concatenate([np.roll(x, -1, axis=1) - x for x in (one, other)], axis=1)
    normals = np.stack([-edges[..., 1], edges[..., 0]], axis=-1)
    between = (other[:, None] - one[:, :, None]).reshape(len(one), -1, 2)
    axes = np.concatenate([normals, -normals, between], axis=1)
    length = np.linalg.norm(axes, axis=2, keepdims=True)
    axes = np.divide(axes, length, out=np.zeros_like(axes), where=length > 0)
    along = [np.einsum("nij,nkj->nik", axes, x) for x in (one, other)]
    gap = along[1].min(axis=2) - along[0].max(axis=2)
    return np.where(length[..., 0] > 0, gap, -np.inf).max(axis=1, initial=-np.inf)
