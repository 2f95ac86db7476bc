"""URDFs in a few lines, and rotations that no formula of the package has made."""

from __future__ import annotations

from pathlib import Path

import numpy as np

BALL = "<collision><geometry><sphere radius='0.05'/></geometry></collision>"


def link(name: str, inside: str = "") -> str:
    return f"<link name='{name}'>{inside}</link>"


def joint(name: str, parent: str, child: str, kind: str = "revolute", more: str = "") -> str:
    limit = "<limit lower='-1' upper='2' velocity='3'/>" if "<limit" not in more else ""
    ends = f"<parent link='{parent}'/><child link='{child}'/>"
    return f"<joint name='{name}' type='{kind}'>{ends}{limit}{more}</joint>"


def written(folder: Path, *parts: str, name: str = "arm.urdf") -> Path:
    file = folder / name
    file.write_text("<robot name='arm'>\n" + "\n".join(parts) + "\n</robot>\n", encoding="utf-8")
    return file


def three_links(folder: Path, more: str = "", kind: str = "revolute", balls: str = BALL) -> Path:
    links = [link(name, balls) for name in "abc"]
    return written(folder, *links, joint("j", "a", "b"), joint("k", "b", "c", kind, more))


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """By the exponential of a matrix: a series, and no formula of the package."""
    x, y, z = axis / np.linalg.norm(axis)
    generator = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) * angle
    term, total = np.eye(3), np.eye(3)
    for n in range(1, 60):
        term = term @ generator / n
        total = total + term
    return total


def transform(turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, shift
    return matrix


def ring_mesh(outer: float, inner: float, height: float, count: int = 24) -> np.ndarray:
    """Triangles of a closed tube along z, outward."""
    angle = 2 * np.pi * np.arange(count) / count
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    loops = [
        np.column_stack([r * unit, np.full(count, z)])
        for r, z in ((outer, -height), (outer, height), (inner, height), (inner, -height))
    ]
    found = []
    for k in range(4):
        one, two = loops[k], loops[(k + 1) % 4]
        for i in range(count):
            j = (i + 1) % count
            found += [[one[i], one[j], two[j]], [one[i], two[j], two[i]]]
    return np.array(found)
