"""A judge of URDFs: its own reader and kinematics, and python-fcl on the shapes themselves."""

from __future__ import annotations

from itertools import combinations, product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import fcl
import numpy as np

from engine_support.urdf import rotation, transform

X, Y, Z = np.eye(3)


def depth_or_gap(file: Path, q: dict[str, float]) -> dict[frozenset[str], float]:
    """Return the distance of every two links at values of the joints, m; negative where they meet.

    Where they meet the number is minus the depth as python-fcl measures it.
    """
    root = ET.parse(file).getroot()
    poses, shapes = _poses(root, q), dict[str, list[Any]]()
    for link in root.iter("link"):
        for each in link.iter("collision"):
            pose = poses[link.get("name")] @ _pose(each.find("origin"))
            placed = fcl.Transform(pose[:3, :3], pose[:3, 3])
            solid = fcl.CollisionObject(_solid(next(iter(each.find("geometry")))), placed)
            shapes.setdefault(link.get("name"), []).append(solid)
    return {
        frozenset(pair): min(_gap(a, b) for a, b in product(*(shapes[name] for name in pair)))
        for pair in combinations(shapes, 2)
    }


def _gap(one: Any, other: Any) -> float:
    request, result = fcl.CollisionRequest(enable_contact=True), fcl.CollisionResult()
    if fcl.collide(one, other, request, result):
        return -max(contact.penetration_depth for contact in result.contacts)
    return float(fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))


def _numbers(text: str | None) -> np.ndarray:
    return np.array([float(word) for word in (text or "0 0 0").split()])


def _pose(origin: Any) -> np.ndarray:
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = _numbers(origin.get("rpy"))
    turn = rotation(Z, yaw) @ rotation(Y, pitch) @ rotation(X, roll)
    return transform(turn, _numbers(origin.get("xyz")))


def _poses(root: Any, q: dict[str, float]) -> dict[str, np.ndarray]:
    """Return the pose of every link."""
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


def _motion(joint: Any, q: dict[str, float]) -> np.ndarray:
    if joint.get("type") == "fixed":
        return np.eye(4)
    element, value = joint.find("axis"), q[joint.get("name")]
    axis = X if element is None else _numbers(element.get("xyz"))
    axis = axis / np.linalg.norm(axis)
    if joint.get("type") == "prismatic":
        return transform(np.eye(3), value * axis)
    return transform(rotation(axis, value), np.zeros(3))


def _solid(shape: Any) -> Any:
    if shape.tag == "box":
        return fcl.Box(*_numbers(shape.get("size")))
    radius = float(shape.get("radius"))
    if shape.tag == "sphere":
        return fcl.Sphere(radius)
    kind = {"cylinder": fcl.Cylinder, "capsule": fcl.Capsule}[shape.tag]
    return kind(radius, float(shape.get("length")))
