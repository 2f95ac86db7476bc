"""A judge of URDFs: its own reader and kinematics, and python-fcl or coal on the shapes themselves.

Coal is asked where it is installed: it measures how deep shapes are in each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations, product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import trimesh

from engine_support.urdf import rotation, transform

try:
    import coal as library
except ModuleNotFoundError:
    import fcl as library

X, Y, Z = np.eye(3)
LIBRARY = library.__name__


def depth_or_gap(file: Path, q: dict[str, float]) -> dict[frozenset[str], float]:
    """Return the distance of every two links at values of the joints, m; negative where they meet.

    Where they meet the number is minus the depth as the library measures it.
    """
    judge = UrdfJudge(file)
    (found,) = judge.gaps({name: np.array([x]) for name, x in q.items()}, judge.pairs)
    return found


class UrdfJudge:
    """The shapes of a URDF's links.

    Attributes
    ----------
    pairs : list of frozenset of str
        Every two links with shapes.
    limits : dict of str to pair of float
        Hard limits of the joints that have them, rad or m.
    """

    def __init__(self, file: Path) -> None:
        self.root = root = ET.parse(file).getroot()
        self.shapes = dict[str, list[tuple[np.ndarray, Any]]]()
        for link in root.iter("link"):
            for each in link.iter("collision"):
                solid = _solid(next(iter(each.find("geometry"))), file)
                placed = (_pose(each.find("origin")), solid)
                self.shapes.setdefault(link.get("name"), []).append(placed)
        self.pairs = [frozenset(pair) for pair in combinations(self.shapes, 2)]

    @property
    def moving(self) -> list[frozenset[str]]:
        """Every two links with shapes that fixed joints alone do not connect."""
        group = {link.get("name"): {link.get("name")} for link in self.root.iter("link")}
        for joint in self.root.findall("joint"):
            if joint.get("type") == "fixed":
                ends = (joint.find(tag).get("link") for tag in ("parent", "child"))
                joined = set().union(*(group[name] for name in ends))
                group.update(dict.fromkeys(joined, joined))
        return [pair for pair in self.pairs if not any(pair <= each for each in group.values())]

    def gaps(
        self, q: dict[str, np.ndarray], pairs: Iterable[frozenset[str]]
    ) -> Iterator[dict[frozenset[str], float]]:
        """Yield for each pose the distance of pairs of links, negative where they meet."""
        poses = _poses(self.root, q)
        count = max(len(values) for values in q.values())
        placed = {
            link: [(np.broadcast_to(poses[link] @ pose, (count, 4, 4)), x) for pose, x in shapes]
            for link, shapes in self.shapes.items()
        }
        named = [(pair, tuple(pair)) for pair in pairs]
        for k in range(count):
            yield {
                pair: min(
                    _gap(a, p[k], b, r[k]) for (p, a), (r, b) in product(placed[one], placed[other])
                )
                for pair, (one, other) in named
            }


def _gap(one: Any, pose: np.ndarray, other: Any, pose_of_other: np.ndarray) -> float:
    poses = [(p[:3, :3], p[:3, 3]) for p in (pose, pose_of_other)]
    if LIBRARY == "coal":
        a, b = (library.Transform3s(*each) for each in poses)
        result = library.DistanceResult()
        return float(library.distance(one, a, other, b, library.DistanceRequest(), result))
    a, b = (
        library.CollisionObject(shape, library.Transform(*each))
        for shape, each in zip((one, other), poses, strict=True)
    )
    request, result = library.CollisionRequest(enable_contact=True), library.CollisionResult()
    if library.collide(a, b, request, result):
        return -max(contact.penetration_depth for contact in result.contacts)
    return float(library.distance(a, b, library.DistanceRequest(), library.DistanceResult()))


def _numbers(text: str | None) -> np.ndarray:
    return np.array([float(word) for word in (text or "0 0 0").split()])


def _pose(origin: Any) -> np.ndarray:
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = _numbers(origin.get("rpy"))
    turn = rotation(Z, yaw) @ rotation(Y, pitch) @ rotation(X, roll)
    if (quaternion := origin.get("quat_xyzw")) is not None:
        *axis, cosine = _numbers(quaternion)
        turn = rotation(np.array(axis), 2 * np.arctan2(np.linalg.norm(axis), cosine))
    return transform(turn, _numbers(origin.get("xyz")))


def _poses(root: Any, q: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the pose of every link, (4, 4) or (N, 4, 4); joints without a value stay at 0."""
    joints = list(root.findall("joint"))
    children = {joint.find("child").get("link") for joint in joints}
    base = next(link.get("name") for link in root.iter("link") if link.get("name") not in children)
    found = {base: np.eye(4)}
    while left := [j for j in joints if j.find("child").get("link") not in found]:
        for joint in left:
            parent, child = (joint.find(tag).get("link") for tag in ("parent", "child"))
            if parent in found:
                found[child] = found[parent] @ _pose(joint.find("origin")) @ _motion(joint, q)
    return found


def _motion(joint: Any, q: dict[str, np.ndarray]) -> np.ndarray:
    if joint.get("name") not in q:
        return np.eye(4)
    element, values = joint.find("axis"), q[joint.get("name")][:, None, None]
    axis = X if element is None else _numbers(element.get("xyz"))
    found = np.tile(np.eye(4), (len(values), 1, 1))
    if joint.get("type") == "prismatic":
        found[:, :3, 3] = values[:, 0] * axis / np.linalg.norm(axis)
    else:
        found[:, :3, :3] = rotation(axis, values)
    return found


def _solid(shape: Any, file: Path) -> Any:
    if shape.tag == "box":
        return library.Box(*_numbers(shape.get("size")))
    if shape.tag == "mesh":
        (path,) = file.parents[1].rglob(Path(shape.get("filename")).name)
        mesh = trimesh.load_mesh(path)
        return _surface(mesh.vertices * _numbers(shape.get("scale", "1 1 1")), mesh.faces)
    radius = float(shape.get("radius"))
    if shape.tag == "sphere":
        return library.Sphere(radius)
    kind = {"cylinder": library.Cylinder, "capsule": library.Capsule}[shape.tag]
    return kind(radius, float(shape.get("length")))


def _surface(vertices: np.ndarray, faces: np.ndarray) -> Any:
    """Return the triangles of a mesh."""
    if LIBRARY == "fcl":
        model = library.BVHModel()
        model.beginModel(len(vertices), len(faces))
        model.addSubModel(vertices, faces)
    else:
        model = library.BVHModelOBBRSS()
        model.beginModel(len(faces), len(vertices))
        model.addVertices(vertices)
        model.addTriangles(faces.astype(int))
    model.endModel()
    return model
