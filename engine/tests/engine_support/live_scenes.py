"""Two links among discs and polygons: random scenes, their regions in the page and as a robot file.

All numbers have nine decimals, so that the file and the page have the same scene. A scene with a
slit is one whose number of regions is about to change: an obstacle moves until it does, and stops
within a given way of that place, before or behind it. A passage or a region is nearly closed there.
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cspace.model.robotfile import parse_robot
from cspace.region import find_region
from engine_support.arms import joint
from engine_support.javascript import Script

Scene = dict[str, Any]
TURN = 2 * np.pi
FILES = ("geometry.js", "space.js")
WIDEST, NARROWEST = 1e-2, 1e-6  # m
QUICKLY = """const { Array, JSON, Map, Math, Number, Object, Set, WeakMap } = globalThis;"""
"""Names of the language: Node looks them up ten times faster than those of a scope's own."""
IN_PAGE = """
const placed = ({ name, radius, corners: all }) => {
  const parts = radius ? [all] : convexParts(all);
  return { name, parts: parts.map((corners) => ({ corners, radius })) };
};
const regionsIn = ({ links, obstacles }) => regionsOf(links, obstacles.map(placed), [0, 0]);

/** The last obstacle, within `width` of a place at which the number of regions changes. */
const narrowed = ({ links, obstacles }, way, width, isBehind) => {
  const [last, known] = [obstacles.at(-1), {}];
  const others = obstacles.slice(0, -1).map(placed);
  const moved = (far) => {
    const at = (p) => p.map((v, k) => Number((v + far * way[k]).toFixed(9)));
    return { ...last, corners: last.corners.map(at) };
  };
  const count = (far) => regionsOf(links, [...others, placed(moved(far))], [0, 0], known, 1).length;
  const begun = count(0);
  let [before, behind] = [0, 0.1];
  while (count(behind) === begun) {
    [before, behind] = [behind, behind + 0.1];
    if (behind > 1) return null;
  }
  while (behind - before > width) {
    const middle = (before + behind) / 2;
    if (count(middle) === begun) before = middle;
    else behind = middle;
  }
  return moved(isBehind ? behind : before);
};
"""


@cache
def page() -> Script:
    """Return the scripts that find regions in the page, with the functions above."""
    return Script(QUICKLY, *map(figure_script, FILES), IN_PAGE)


def figure_script(name: str) -> str:
    """Return one of the scripts of live figures."""
    return (resources.files("cspace.explorer") / "figure" / name).read_text("utf-8")


def random_scene(rng: np.random.Generator) -> Scene:
    """Return one to seven obstacles within reach of two links."""
    links = [
        {"length": round(rng.uniform(least, 1), 3), "radius": round(rng.uniform(0.02, 0.1), 3)}
        for least in (0.5, 0.4)
    ]
    return {"links": links, "obstacles": [_obstacle(rng, i) for i in range(rng.integers(1, 8))]}


def scene_with_slit(rng: np.random.Generator, script: Script) -> Scene:
    """Return a scene near a change of its regions."""
    while True:
        scene = random_scene(rng)
        width = NARROWEST * (WIDEST / NARROWEST) ** rng.random()
        angle = rng.uniform(0, TURN)
        last = script(
            "narrowed(scene, way, width, isBehind)",
            scene=scene,
            way=[np.cos(angle), np.sin(angle)],
            width=width,
            isBehind=bool(rng.random() < 0.5),
        )
        if last:
            return scene | {"obstacles": [*scene["obstacles"][:-1], last]}


def scene_in_quarters(rng: np.random.Generator) -> Scene:
    """Return obstacles at multiples of 0.25 m and mirrored ones: much touches or meets exactly."""
    links = [
        {"length": float(rng.choice([0.5, 0.75, 1])), "radius": float(rng.choice([0.05, 0.1]))}
        for _ in range(2)
    ]
    mirror = np.array([1, 1]) if rng.random() < 0.25 else rng.choice([-1, 1], 2)
    obstacles: list[Scene] = []
    for _ in range(rng.integers(1, 5)):
        middle = rng.integers(-6, 7, 2) / 4
        if np.abs(middle).max() < 0.5:
            middle += np.array([1.0, 0.0])
        radius = float(rng.choice([0.1, 0.15, 0.2]))
        corners = np.array([[-1, -1], [1, -1], [0, 0], [1, 1], [-1, 1]]) * rng.choice([1, 2], 2) / 8
        shapes = ([[0, 0]], corners[[0, 1, 3, 4]], corners)
        kind = int(rng.integers(3))
        own = middle + np.array(shapes[kind])
        for place in (own, own * mirror):
            name = f"obstacle {len(obstacles)}"
            size = {"radius": 0 if kind else radius}
            if place is own or not np.array_equal(middle, middle * mirror):
                obstacles.append({"name": name, "corners": place.tolist()} | size)
    return {"links": links, "obstacles": obstacles}


def _obstacle(rng: np.random.Generator, number: int) -> Scene:
    middle = _around(rng.uniform(0.3, 1.9), rng.uniform(0, TURN))
    name = f"obstacle {number}"
    if rng.random() < 0.35:
        radius = round(rng.uniform(0.03, 0.25), 4)
        return {"name": name, "radius": radius, "corners": [middle.round(9).tolist()]}
    count = int(rng.integers(3, 9))
    angles = np.sort(rng.uniform(0, TURN, count))
    while np.diff(angles, append=angles[0] + TURN).max() > 2.6:  # the middle lies well inside
        angles = np.sort(rng.uniform(0, TURN, count))
    corners = middle + _around(0.35 * rng.uniform(0.4, 1, count), angles)
    return {"name": name, "radius": 0, "corners": corners.round(9).tolist()}


def _around(far: Any, angle: Any) -> NDArray[np.float64]:
    return np.stack([far * np.cos(angle), far * np.sin(angle)], axis=-1)


# --- shares of all poses --------------------------------------------------------------------------


def shares_in_page(script: Script, scene: Scene) -> list[float]:
    """Return the share of all poses that each region of the page takes, in order."""
    areas = script("regionsIn(scene).map(({ area }) => area)", scene=scene)
    return sorted(area / TURN**2 for area in areas)


def shares_in_library(scene: Scene) -> list[float]:
    """Return the share of all poses that each component takes, in order."""
    return sorted(one.area / TURN**2 for one in find_region(parse_robot(file_of(scene))).components)


def file_of(scene: Scene) -> Scene:
    """Return the scene as the content of a robot file."""
    first, second = (one["length"] for one in scene["links"])
    joints = [
        joint("revolute", str(i), str(i + 1), [before, 0.0, 0.0], [0.0, 0.0, 1.0])
        for i, before in enumerate((0.0, first))
    ]
    bodies = [
        {
            "name": f"link {i + 1}",
            "frame": str(i + 1),
            "capsule": {"from": [0.0] * 3, "to": [length, 0.0, 0.0], "radius": radius},
        }
        for i, (length, radius) in enumerate(link.values() for link in scene["links"])
    ]
    obstacles = [
        {"name": one["name"]}
        | (
            {"disc": {"at": [*one["corners"][0], 0.0], "radius": one["radius"]}}
            if one["radius"]
            else {"polygon": [[*corner, 0.0] for corner in one["corners"]]}
        )
        for one in scene["obstacles"]
    ]
    return {
        "schema": 1,
        "name": "two links",
        "length_unit": "m",
        "angle_unit": "deg",
        "home": {"q1": 0.0, "q2": 0.0},
        "tool": "tip",
        "collisions": "all",
        "allowed": [["link 1", "link 2"]],
        "joint": joints,
        "point": [{"name": "tip", "frame": "2", "at": [second, 0.0, 0.0]}],
        "body": bodies,
        "obstacle": obstacles,
    }
